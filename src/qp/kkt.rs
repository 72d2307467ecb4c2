//! Optimality of a point, measured on the problem as given.

use rayon::prelude::*;

use crate::linalg::small::{from_scaled, scaled_length, smallest_eigenvalue};

use super::blocks::GRAIN;
use super::interior::Interior;
use super::product::{Scratch, add, dot, largest};
use super::{KktResiduals, Progress, Settings};

/// Relative gap and residuals of the iterate that is kept for restarts.
const ROUGH: f64 = 1e-3;

/// The residuals of a point and its objective.
pub(super) struct Measure {
    pub objective: f64,
    /// What gaps are relative to.
    pub unit: f64,
    pub kkt: KktResiduals,
}

impl Measure {
    /// Measures the current point and leaves its residual vectors in the solver.
    pub fn of(interior: &mut Interior<'_>) -> Self {
        let mut stationarity = std::mem::take(&mut interior.stationarity);
        let mut primal = std::mem::take(&mut interior.primal);
        let mut scratch = std::mem::take(&mut interior.engine.scratch);
        let mut force = std::mem::take(&mut interior.side);
        let measure = measured(interior, &mut stationarity, &mut primal, (&mut force, &mut scratch));
        interior.side = force;
        interior.engine.mask(&mut stationarity);
        interior.stationarity = stationarity;
        interior.primal = primal;
        interior.engine.scratch = scratch;
        measure
    }

    /// Measures the current point from nothing, with its backward error.
    pub fn of_point(interior: &Interior<'_>) -> Self {
        let n = interior.point.x.len();
        let mut primal = vec![0.0; interior.rows.len()];
        let (mut stationarity, mut force, mut scratch) = (vec![0.0; n], vec![0.0; n], Scratch::new(n));
        let mut measure = measured(interior, &mut stationarity, &mut primal, (&mut force, &mut scratch));
        interior.engine.mask(&mut stationarity);
        let objective = &interior.problem.objective;
        objective.addends_into(&interior.point.x, &mut force, &mut scratch);
        let mut forces = vec![0.0; n];
        interior.rows.add_transposed(1.0, &interior.point.z, &mut forces);
        for ((size, force), q) in force.iter_mut().zip(&forces).zip(&objective.linear) {
            *size += force.abs() + q.abs();
        }
        measure.kkt.backward = backward_error(&stationarity, &force);
        measure
    }

    pub fn progress(&self, iteration: usize, step: f64) -> Progress {
        let kkt = &self.kkt;
        Progress { iteration, gap: kkt.duality_gap, stationarity: kkt.stationarity, primal: kkt.primal, step }
    }

    /// Whether the dual objective, which no point can be below, exceeds a value; only asked of points near stationarity.
    pub fn is_above(&self, value: f64) -> bool {
        let is_told = self.kkt.stationarity <= ROUGH.max(self.kkt.rounding);
        is_told && self.objective - self.kkt.duality_gap * self.unit > value
    }

    pub fn is_optimal(&self, settings: &Settings) -> bool {
        self.merit(settings) <= 1.0
    }

    /// Near enough to the optimum to know it, far enough from the boundary to restart from.
    pub fn is_rough(&self) -> bool {
        self.kkt.duality_gap.max(self.kkt.stationarity).max(self.kkt.primal) <= ROUGH
    }

    /// The largest residual over its tolerance.
    pub fn merit(&self, settings: &Settings) -> f64 {
        let kkt = &self.kkt;
        (kkt.duality_gap / settings.relative_gap)
            .max(kkt.primal / settings.residual)
            .max(kkt.stationarity / settings.residual.max(kkt.rounding))
    }
}

/// Largest residual over the addends of its own row, NaN if any is.
pub(super) fn backward_error(residual: &[f64], addends: &[f64]) -> f64 {
    let relative = residual.iter().zip(addends).map(|(entry, size)| if *entry == 0.0 { 0.0 } else { entry.abs() / size });
    relative.fold(0.0, |most, value| if value > most || value.is_nan() { value } else { most })
}

fn measured(
    interior: &Interior<'_>,
    stationarity: &mut [f64],
    primal: &mut [f64],
    (force, scratch): (&mut [f64], &mut Scratch),
) -> Measure {
    let Interior { problem, rows, point, engine, .. } = interior;
    let objective = &problem.objective;
    let quadratic = objective.quadratic(&point.x, scratch);
    let linear = dot(&objective.linear, &point.x);
    let value = quadratic + linear + objective.constant;
    let size: f64 = objective.linear.iter().zip(&point.x).map(|(q, x)| (q * x).abs()).sum();
    // Where the terms cancel, their rounding is the unit in which a gap can be told at all.
    let unit = value.abs().max(1e-8 * (quadratic + size + objective.constant.abs())).max(f64::MIN_POSITIVE);

    // The addends first, since the gradient overwrites the same vector.
    objective.addends_into(&point.x, stationarity, scratch);
    engine.mask(stationarity);
    let addends = largest(stationarity);
    objective.product_into(&point.x, stationarity, scratch);
    let mut source: f64 = 0.0;
    for (index, (slot, q)) in stationarity.iter_mut().zip(&objective.linear).enumerate() {
        *slot += q;
        if !engine.is_fixed[index] {
            source = source.max(q.abs());
        }
    }
    force.fill(0.0);
    rows.add_transposed(1.0, &point.z, force);
    add(stationarity, -1.0, force);
    let (mut residual, mut reaction) = (0.0f64, 0.0f64);
    for (slot, &fixed) in stationarity.iter().zip(&engine.is_fixed) {
        let most = if fixed { &mut reaction } else { &mut residual };
        if slot.abs() > *most || slot.is_nan() {
            *most = slot.abs();
        }
    }
    let force = largest(force).max(reaction).max(1e-3 * source);
    let relative = |value: f64, unit: f64| if value == 0.0 { 0.0 } else { value / unit.max(f64::MIN_POSITIVE) };

    rows.slack_into(&point.x, primal);
    let (mut gap, mut most, mut violation) = (0.0f64, 0.0f64, 0.0f64);
    for (value, z) in primal.iter().zip(&point.z) {
        gap += z * value;
    }
    for ((value, s), z) in primal[..rows.order].iter().zip(&point.s).zip(&point.z) {
        most = most.max(s * z);
        violation = violation.max(-value);
    }
    for (part, worst) in
        [(rows.two.rows(), worst_block::<2> as fn(_, _, _) -> _), (rows.three.rows(), worst_block::<3> as fn(_, _, _) -> _)]
    {
        let (product, outside): (f64, f64) = worst(&primal[part.clone()], &point.s[part.clone()], &point.z[part]);
        most = most.max(product);
        violation = violation.max(outside);
    }
    for (value, s) in primal.iter_mut().zip(&point.s) {
        *value -= s;
        violation = violation.max(value.abs());
    }
    let row_size = rows.offset_size + rows.largest_image(&point.x);
    Measure {
        objective: value,
        unit,
        kkt: KktResiduals {
            stationarity: relative(residual, force),
            rounding: relative(4.0 * f64::EPSILON * addends, force),
            // Worth a pass of its own only at the end.
            backward: f64::NAN,
            primal: relative(violation, row_size),
            complementarity: relative(most, unit),
            // Nothing below an ulp of the objective can be told.
            duality_gap: if rows.len() == 0 { 0.0 } else { relative(gap.abs(), unit).max(f64::EPSILON) },
        },
    }
}

/// The largest trace of a slack times its dual, and the deepest negative eigenvalue of `A x + b`.
fn worst_block<const D: usize>(values: &[f64], s: &[f64], z: &[f64]) -> (f64, f64) {
    let length = scaled_length(D);
    values
        .par_chunks(length)
        .zip(s.par_chunks(length))
        .zip(z.par_chunks(length))
        .with_min_len(GRAIN)
        .map(|((value, s), z)| (dot(s, z), -smallest_eigenvalue(&from_scaled::<D>(value))))
        .reduce(|| (0.0, 0.0), |one, other| (one.0.max(other.0), one.1.max(other.1)))
}
