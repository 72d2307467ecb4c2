//! Where the interior point begins.

use crate::linalg::small::{composed, from_scaled, scaled_length, smallest_eigenvalue, symmetric_eigen, to_scaled};

use super::centred::split;
use super::interior::{Interior, Triple};
use super::kkt::Measure;
use super::problem::{finite, length};
use super::product::{dot, largest};
use super::rows::Rows;
use super::{Problem, QpError};

/// Smallest slack of a start without a feasible point, relative to the mean violation or slack.
const COLD_FLOOR: f64 = 3e-2;

/// Smallest slack, relative to the mean slack, of a start that is taken as it is: with less room in a row, the first step would
/// end there and the solve with it.
const INSIDE: f64 = 1e-9;

/// Smallest slack and dual of a warm start, relative to the mean slack and to the duals of a cold start.
const WARM_FLOOR: f64 = 1e-4;

/// What slack times dual starts at where there are blocks, relative to the mean square of the eigenvalues: between these bounds, and twice the violation between
/// them. A start that is nearly feasible needs little room (measured: 5 iterations instead of 8 on a bent bar).
const BLOCK_CENTRE: (f64, f64) = (1e-2, 1e-1);

/// Unit of the duals, relative to the stiffness of the objective as the constraints feel it: the least, and the factor of the squared
/// violation. A start far outside needs strong duals at once (measured: a disc turned by 360 degrees takes 16 iterations with 3000, 31 with 30, and stalls with 3;
/// one turned by 90 degrees takes 8 with 3 and 11 with 3000).
const BLOCK_FORCE: (f64, f64) = (3.0, 1e5);

/// What the caller knows.
#[derive(Clone, Copy)]
pub(super) enum Start<'a> {
    Cold,
    /// The minimiser without rows again, slacks lifted to one floor: another way into a problem that was left unsolved.
    Lifted,
    Point(&'a [f64]),
    /// A point well inside every cone, however far from the optimum.
    Inside(&'a [f64]),
    Warm { x: &'a [f64], dual: &'a [f64] },
    /// A point well inside every cone with duals well inside.
    Relaxed { x: &'a [f64], dual: &'a [f64] },
}

impl Start<'_> {
    pub fn check(&self, problem: &Problem) -> Result<(), QpError> {
        if let Self::Point(x) | Self::Inside(x) | Self::Warm { x, .. } | Self::Relaxed { x, .. } = self {
            length("start", x.len(), problem.fixed.len())?;
            finite("start", x)?;
        }
        if let Self::Warm { dual, .. } | Self::Relaxed { dual, .. } = self {
            length("dual", dual.len(), problem.constraints.offset.len())?;
            finite("dual", dual)?;
        }
        Ok(())
    }
}

/// Sets the first point: x as given or the minimiser without rows, slacks and duals positive.
pub(super) fn initial(interior: &mut Interior<'_>, start: Start<'_>) -> Result<(), QpError> {
    let m = interior.rows.len();
    for (slot, fixed) in interior.point.x.iter_mut().zip(&interior.problem.fixed) {
        *slot = fixed.unwrap_or(0.0);
    }
    if interior.rows.contradiction.is_some() {
        return Ok(());
    }
    match start {
        Start::Point(x) | Start::Inside(x) | Start::Warm { x, .. } | Start::Relaxed { x, .. } if m > 0 => {
            for (index, slot) in interior.point.x.iter_mut().enumerate() {
                if !interior.engine.is_fixed[index] {
                    *slot = x[index];
                }
            }
        }
        _ => {
            let minimum = interior.engine.minimise(&interior.problem.objective, &interior.problem.fixed)?;
            interior.solves += minimum.solves;
            interior.point.x.copy_from_slice(&minimum.x);
        }
    }
    if m == 0 {
        return Ok(());
    }
    interior.rows.slack_into(&interior.point.x, &mut interior.point.s);
    if interior.rows.is_polyhedral() {
        return rows_only(interior, start);
    }
    interior.is_free = matches!(start, Start::Cold) && is_free(interior);
    if interior.is_free {
        return Ok(());
    }
    with_blocks(interior, start);
    Ok(())
}

/// Whether the minimiser without rows lies in every cone: then it is the optimum, and any iterate inside the cones would only lose its digits.
///
/// Leaves multipliers of zero where it does. Asked where there are blocks only: of deformations, those that turn nothing inside out.
fn is_free(interior: &mut Interior<'_>) -> bool {
    let Interior { rows, point, .. } = interior;
    let is_inside = point.s[..rows.order].iter().all(|&s| s >= 0.0)
        && point.s[rows.two.rows()].chunks(scaled_length(2)).all(|s| smallest_eigenvalue(&from_scaled::<2>(s)) >= 0.0)
        && point.s[rows.three.rows()].chunks(scaled_length(3)).all(|s| smallest_eigenvalue(&from_scaled::<3>(s)) >= 0.0);
    point.z.fill(0.0);
    is_inside && Measure::of(interior).is_optimal(interior.settings)
}

/// Slacks and duals where there are nonnegative rows only.
fn rows_only(interior: &mut Interior<'_>, start: Start<'_>) -> Result<(), QpError> {
    let m = interior.rows.len();
    let mean = |values: &[f64]| values.iter().map(|value| value.abs()).sum::<f64>() / m as f64;
    let unit = match mean(&interior.point.s) {
        typical if typical > 0.0 => typical,
        // Every row is exactly tight: any scale of the problem will do.
        _ => interior.rows.offset_size.max(largest(&interior.point.x)).max(f64::MIN_POSITIVE),
    };
    let least = interior.point.s.iter().copied().fold(f64::INFINITY, f64::min);
    interior.is_feasible |= matches!(start, Start::Point(_) | Start::Inside(_)) && least >= 0.0;
    let inside = least > INSIDE * unit;
    if matches!(start, Start::Cold) || (matches!(start, Start::Point(_) | Start::Inside(_)) && !inside) {
        let energy = to_gain(interior, unit);
        return split(interior, (unit, energy));
    }
    let floor = match start {
        // A start well inside the cone is taken as it is.
        Start::Point(_) | Start::Inside(_) => 0.0,
        Start::Warm { .. } => WARM_FLOOR * unit,
        _ => COLD_FLOOR * unit,
    };
    for slot in &mut interior.point.s {
        *slot = slot.max(floor);
    }
    // Equal duals whose products with the slacks sum to the objective, an upper bound of what is still to be gained.
    // Duals in proportion to 1/slack would be centred, and need half as many iterations again (measured).
    let energy = to_gain(interior, unit);
    let share = energy / m as f64;
    let level = share / mean(&interior.point.s);
    interior.point.z.fill(level);
    if let Start::Warm { dual, .. } = start {
        for (row, &original) in interior.rows.original.iter().enumerate() {
            let known = dual[original as usize].max(0.0);
            interior.point.z[row] = known.max(WARM_FLOOR * level);
        }
        // Which rows are active is known as well as it ever was.
        interior.decide_at = f64::INFINITY;
    }
    Ok(())
}

/// An upper bound, roughly, of what the objective can still gain: its value at the start.
fn to_gain(interior: &mut Interior<'_>, unit: f64) -> f64 {
    let objective = &interior.problem.objective;
    let quadratic = objective.quadratic(&interior.point.x, &mut interior.engine.scratch);
    let linear: f64 = objective.linear.iter().zip(&interior.point.x).map(|(q, x)| (q * x).abs()).sum();
    let addends = quadratic + linear + objective.constant.abs();
    match objective.value(&interior.point.x).abs().max(1e-4 * addends) {
        some if some > 0.0 => some,
        // All is zero at the start: what moving every unknown alone by a typical slack would cost.
        _ => unit * unit * interior.engine.largest_diagonal() * interior.rows.len() as f64,
    }
}

/// Slacks and duals where there are blocks: every eigenvalue of `A x + b` is split into the difference of a slack and a dual with one product.
fn with_blocks(interior: &mut Interior<'_>, start: Start<'_>) {
    let Interior { rows, point, engine, .. } = interior;
    let degree = rows.degree() as f64;
    if let Start::Warm { dual, .. } | Start::Relaxed { dual, .. } = start {
        interior.is_feasible |= matches!(start, Start::Relaxed { .. });
        let Interior { rows, point, .. } = interior;
        warm_blocks(rows, point, dual);
        return;
    }
    let size = (dot(&point.s, &point.s) / degree).sqrt();
    let size = if size > 0.0 { size } else { rows.offset_size.max(largest(&point.x)).max(f64::MIN_POSITIVE) };
    let (two, three) = (rows.two.rows(), rows.three.rows());
    let outside: f64 = point.s[..rows.order].iter().map(|s| s.min(0.0).powi(2)).sum::<f64>()
        + outside::<2>(&point.s[two.clone()])
        + outside::<3>(&point.s[three.clone()]);
    // Root mean square of the negative eigenvalues against that of all, between 0 and 1.
    let violation = (outside / degree).sqrt() / size;
    let compliance = rows.compliance(|unknown| engine.diagonal_of(unknown));
    let stiffness = if compliance > 0.0 { rows.len() as f64 / compliance } else { engine.largest_diagonal() };
    let force = stiffness * (BLOCK_FORCE.1 * violation * violation).max(BLOCK_FORCE.0);
    let centre = match start {
        // No violation tells how much room the way from here needs (measured: a ring around a bunny takes 18 iterations, 29 with the least).
        Start::Inside(_) => BLOCK_CENTRE.1,
        _ => (2.0 * violation).clamp(BLOCK_CENTRE.0, BLOCK_CENTRE.1),
    } * size * size;
    let split = |value: f64| {
        let root = (value * value + 4.0 * centre).sqrt();
        // The smaller part as a quotient, so that it keeps its digits.
        if value >= 0.0 {
            let slack = 0.5 * (value + root);
            (slack, centre / slack)
        } else {
            let dual = 0.5 * (root - value);
            (centre / dual, dual)
        }
    };
    let mut least = f64::INFINITY;
    for row in 0..rows.order {
        least = least.min(point.s[row]);
        let (slack, dual) = split(point.s[row]);
        (point.s[row], point.z[row]) = (slack, force * dual);
    }
    least = least.min(split_blocks::<2>(&mut point.s[two.clone()], &mut point.z[two], split));
    least = least.min(split_blocks::<3>(&mut point.s[three.clone()], &mut point.z[three], split));
    for z in &mut point.z[rows.order..] {
        *z *= force;
    }
    interior.is_feasible |= matches!(start, Start::Point(_) | Start::Inside(_)) && least >= 0.0;
}

/// Slacks and duals of a nearby problem: their eigenvalues are lifted off the boundary.
fn warm_blocks(rows: &Rows, point: &mut Triple, dual: &[f64]) {
    let degree = rows.degree() as f64;
    for (z, &original) in point.z.iter_mut().zip(&rows.original) {
        *z = dual[original as usize];
    }
    for part in [&mut point.s, &mut point.z] {
        let size = (dot(part, part) / degree).sqrt();
        let floor = WARM_FLOOR * if size > 0.0 { size } else { 1.0 };
        for value in &mut part[..rows.order] {
            *value = value.max(floor);
        }
        lift::<2>(&mut part[rows.two.rows()], floor);
        lift::<3>(&mut part[rows.three.rows()], floor);
    }
}

/// Lifts all eigenvalues to a floor.
fn lift<const D: usize>(part: &mut [f64], floor: f64) {
    for block in part.chunks_mut(scaled_length(D)) {
        let (values, vectors) = symmetric_eigen(&from_scaled::<D>(block));
        if values[0] < floor {
            to_scaled(&composed(&values.map(|value| value.max(floor)), &vectors), block);
        }
    }
}

/// Sum of the squares of the negative eigenvalues.
fn outside<const D: usize>(s: &[f64]) -> f64 {
    let squares = |s: &[f64]| symmetric_eigen(&from_scaled::<D>(s)).0.map(|value| value.min(0.0).powi(2)).iter().sum::<f64>();
    s.chunks(scaled_length(D)).map(squares).sum()
}

/// Splits the eigenvalues of each block; returns the smallest one.
fn split_blocks<const D: usize>(s: &mut [f64], z: &mut [f64], split: impl Fn(f64) -> (f64, f64)) -> f64 {
    let length = scaled_length(D);
    let mut least = f64::INFINITY;
    for (s, z) in s.chunks_mut(length).zip(z.chunks_mut(length)) {
        let (values, vectors) = symmetric_eigen(&from_scaled::<D>(s));
        least = least.min(values[0]);
        to_scaled(&composed(&values.map(|value| split(value).0), &vectors), s);
        to_scaled(&composed(&values.map(|value| split(value).1), &vectors), z);
    }
    least
}
