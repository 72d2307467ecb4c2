//! Where the interior point begins.

use super::centred::split;
use super::conflict::contradiction;
use super::interior::Interior;
use super::problem::{finite, length};
use super::product::largest;
use super::{Problem, QpError};

/// Smallest slack of a start without a feasible point, relative to the mean violation or slack.
const COLD_FLOOR: f64 = 3e-2;

/// Smallest slack, relative to the mean slack, of a start that is taken as it is: with less room in a row, the first step would
/// end there and the solve with it.
const INSIDE: f64 = 1e-9;

/// Smallest slack and dual of a warm start, relative to the mean slack and to the duals of a cold start.
const WARM_FLOOR: f64 = 1e-4;

/// What the caller knows.
#[derive(Clone, Copy)]
pub(super) enum Start<'a> {
    Cold,
    /// The minimiser without rows again, slacks lifted to one floor: another way into a problem that was left unsolved.
    Lifted,
    Point(&'a [f64]),
    Warm { x: &'a [f64], dual: &'a [f64] },
}

impl Start<'_> {
    pub fn check(&self, problem: &Problem) -> Result<(), QpError> {
        if let Self::Point(x) | Self::Warm { x, .. } = self {
            length("start", x.len(), problem.fixed.len())?;
            finite("start", x)?;
        }
        if let Self::Warm { dual, .. } = self {
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
    if interior.rows.contradiction.is_none() {
        interior.rows.contradiction = contradiction(&interior.rows);
    }
    if interior.rows.contradiction.is_some() {
        return Ok(());
    }
    match start {
        Start::Point(x) | Start::Warm { x, .. } if m > 0 => {
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
    let mean = |values: &[f64]| values.iter().map(|value| value.abs()).sum::<f64>() / m as f64;
    let unit = match mean(&interior.point.s) {
        typical if typical > 0.0 => typical,
        // Every row is exactly tight: any scale of the problem will do.
        _ => interior.rows.offset_size.max(largest(&interior.point.x)).max(f64::MIN_POSITIVE),
    };
    let least = interior.point.s.iter().copied().fold(f64::INFINITY, f64::min);
    interior.is_feasible |= matches!(start, Start::Point(_)) && least >= 0.0;
    let inside = least > INSIDE * unit;
    if interior.rows.is_polyhedral() && matches!(start, Start::Cold | Start::Point(_)) && !(inside && matches!(start, Start::Point(_))) {
        return split(interior);
    }
    let floor = match start {
        // A start well inside the cone is taken as it is.
        Start::Point(_) if inside => 0.0,
        Start::Warm { .. } => WARM_FLOOR * unit,
        _ => COLD_FLOOR * unit,
    };
    for slot in &mut interior.point.s {
        *slot = slot.max(floor);
    }
    // Equal duals whose products with the slacks sum to the objective, an upper bound of what is still to be gained.
    // Duals in proportion to 1/slack would be centred, and need half as many iterations again (measured).
    let objective = &interior.problem.objective;
    let quadratic = objective.quadratic(&interior.point.x, &mut interior.engine.scratch);
    let linear: f64 = objective.linear.iter().zip(&interior.point.x).map(|(q, x)| (q * x).abs()).sum();
    let addends = quadratic + linear + objective.constant.abs();
    let energy = match objective.value(&interior.point.x).abs().max(1e-4 * addends) {
        some if some > 0.0 => some,
        // All is zero at the start: what moving every unknown alone by a typical slack would cost.
        _ => unit * unit * interior.engine.largest_diagonal() * m as f64,
    };
    let share = energy / m as f64;
    let level = share / mean(&interior.point.s);
    interior.point.z.fill(level);
    if let Start::Warm { dual, .. } = start {
        for (row, &original) in interior.rows.original.iter().enumerate() {
            let known = dual[original as usize].max(0.0);
            interior.point.z[row] = known.max(WARM_FLOOR * level);
        }
    }
    Ok(())
}
