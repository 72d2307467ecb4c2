//! Optimality of a point and its multipliers, measured on the problem as given.

use super::blocks::Blocks;
use crate::qp::kkt::backward_error;
use crate::qp::product::{Scratch, add, dot, largest};
use crate::qp::{Certificate, Engine, KktResiduals, Problem, Settings};

/// Multipliers below this share of the largest are not named.
const NAMED: f64 = 1e-6;

/// The residuals of a point and its objective.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measured {
    pub objective: f64,
    /// What gaps are relative to.
    pub unit: f64,
    pub kkt: KktResiduals,
}

impl Measured {
    /// The largest residual over its tolerance; at most 1 for an optimal point.
    pub fn merit(&self, settings: &Settings) -> f64 {
        let kkt = &self.kkt;
        let merit = (kkt.duality_gap / settings.relative_gap)
            .max(kkt.primal / settings.residual)
            .max(kkt.stationarity / settings.residual.max(kkt.rounding));
        // NaN must not pass.
        if [kkt.duality_gap, kkt.primal, kkt.stationarity].iter().all(|value| value.is_finite()) { merit } else { f64::INFINITY }
    }
}

/// What gaps are relative to: the objective, or, where its terms cancel, their rounding.
pub(super) fn unit(problem: &Problem, x: &[f64], scratch: &mut Scratch) -> (f64, f64) {
    let objective = &problem.objective;
    let quadratic = objective.quadratic(x, scratch);
    let value = quadratic + dot(&objective.linear, x) + objective.constant;
    let size: f64 = objective.linear.iter().zip(x).map(|(q, x)| (q * x).abs()).sum();
    let unit = value.abs().max(1e-8 * (quadratic + size + objective.constant.abs())).max(f64::MIN_POSITIVE);
    (value, unit)
}

/// The residuals of a point x with `s = A x + b` and multipliers z in the dual cone.
///
/// # Arguments
/// * `forces`: overwritten with `Aᵀ z`.
pub(super) fn measured(
    (engine, problem, blocks): (&Engine, &Problem, &Blocks),
    (x, s, z): (&[f64], &[f64], &[f64]),
    forces: &mut [f64],
) -> Measured {
    let objective = &problem.objective;
    let mut scratch = Scratch::new(x.len());
    let mut balance = vec![0.0; x.len()];
    objective.addends_into(x, &mut balance, &mut scratch);
    engine.mask(&mut balance);
    let mut sizes = balance.clone();
    let addends = largest(&balance);
    let (value, unit) = unit(problem, x, &mut scratch);
    objective.product_into(x, &mut balance, &mut scratch);
    add(&mut balance, 1.0, &objective.linear);
    transposed(problem, z, forces);
    add(&mut balance, -1.0, forces);
    for ((size, force), q) in sizes.iter_mut().zip(&*forces).zip(&objective.linear) {
        *size += force.abs() + q.abs();
    }
    let (mut residual, mut force) = (0.0f64, 0.0f64);
    for (index, &fixed) in engine.is_fixed.iter().enumerate() {
        let off = balance[index].abs();
        if fixed {
            force = force.max(off);
        } else {
            residual = if off.is_nan() { f64::NAN } else { residual.max(off) };
            force = force.max(forces[index].abs()).max(1e-3 * objective.linear[index].abs());
        }
    }
    engine.mask(&mut balance);
    let relative = |value: f64, unit: f64| if value == 0.0 { 0.0 } else { value / unit.max(f64::MIN_POSITIVE) };
    let rows = row_size(problem, x);
    Measured {
        objective: value,
        unit,
        kkt: KktResiduals {
            stationarity: relative(residual, force),
            rounding: relative(4.0 * f64::EPSILON * addends, force),
            backward: backward_error(&balance, &sizes),
            primal: relative(-blocks.violation(s), rows),
            complementarity: relative(blocks.largest_product(s, z), unit),
            // Nothing below an ulp of the objective can be told.
            duality_gap: relative(dot(s, z).abs(), unit).max(f64::EPSILON),
        },
    }
}

/// Largest entry of `|A| |x| + |b|`.
fn row_size(problem: &Problem, x: &[f64]) -> f64 {
    let constraints = &problem.constraints;
    let size = |row: usize| {
        let (columns, values) = constraints.matrix.row(row);
        let sum: f64 = columns.iter().zip(values).map(|(&column, value)| (value * x[column as usize]).abs()).sum();
        sum + constraints.offset[row].abs()
    };
    (0..constraints.offset.len()).map(size).fold(0.0, f64::max)
}

/// `y := Aᵀ z`, rows in order.
pub(super) fn transposed(problem: &Problem, z: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    for (row, &z) in z.iter().enumerate() {
        if z != 0.0 {
            let (columns, values) = problem.constraints.matrix.row(row);
            for (&column, value) in columns.iter().zip(values) {
                y[column as usize] += value * z;
            }
        }
    }
}

/// A proof by the multipliers that no point is in all cones, if they have become one.
///
/// At the minimiser of the penalised energy `Aᵀ z` balances the gradient, which stays, while z grows with tau where rows contradict
/// each other: z over its size tends to a ray with `Aᵀ y = 0` and `yᵀ b < 0`.
pub(super) fn certificate(engine: &Engine, problem: &Problem, x: &[f64], z: &[f64]) -> Option<Certificate> {
    if !z.iter().all(|value| value.is_finite()) {
        return None;
    }
    let mut image = vec![0.0; x.len()];
    transposed(problem, z, &mut image);
    let fixed: f64 = problem.fixed.iter().zip(&image).map(|(fixed, image)| fixed.unwrap_or(0.0) * image).sum();
    let conflict = dot(&problem.constraints.offset, z) + fixed;
    engine.mask(&mut image);
    let sum: f64 = image.iter().map(|value| value.abs()).sum();
    let offset = largest(&problem.constraints.offset);
    // Any x that could still be feasible would lie a million times farther out than the present one and all known values.
    if sum * 1e6 * largest(x).max(offset) >= -conflict {
        return None;
    }
    // The weight of a block is its trace; the diagonal of a scaled vector is at places 0, 2 and 5.
    let weights: Vec<f64> = problem
        .constraints
        .member_rows()
        .map(|(first, order)| [0, 2, 5][..order].iter().map(|place| z[first + place]).sum())
        .collect();
    let top = largest(&weights).max(f64::MIN_POSITIVE);
    let constraints: Vec<usize> = (0..weights.len()).filter(|&member| weights[member] > NAMED * top).collect();
    Some(Certificate {
        multipliers: constraints.iter().map(|&member| weights[member] / top).collect(),
        constraints,
        conflict: conflict / top,
        residual: largest(&image) / top,
        least_objective: None,
        relaxations: Vec::new(),
        ray: z.iter().map(|value| value / top).collect(),
    })
}
