//! Where the interior point begins.

use super::interior::Interior;
use super::problem::{finite, length};
use super::product::{add, dot, largest};
use super::{Problem, QpError};

/// What the caller knows.
#[derive(Clone, Copy)]
pub(super) enum Start<'a> {
    Cold,
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
    let typical = largest(&interior.point.s).max(interior.rows.offset_size);
    let unit = if typical > 0.0 { typical } else { largest(&interior.point.x).max(1.0) };
    let floor = match start {
        Start::Cold => 1e-2 * unit,
        Start::Point(_) => 1e-10 * unit,
        Start::Warm { .. } => 1e-6 * unit,
    };
    for slot in &mut interior.point.s {
        *slot = slot.max(floor);
    }
    // What the rows cost at most from here: twice the energy above the minimiser without rows.
    let n = interior.point.x.len();
    let mut gradient = vec![0.0; n];
    interior.problem.objective.gradient_into(&interior.point.x, &mut gradient);
    interior.engine.mask(&mut gradient);
    interior.engine.reset_values();
    interior.engine.factor_values()?;
    let mut step = vec![0.0; n];
    let (taken, _) = interior.engine.solve_refined(&interior.problem.objective, None, &gradient, &mut step, (1e-2, 4));
    interior.solves += taken;
    let excess = 0.5 * dot(&gradient, &step);
    let mut value = interior.problem.objective.value(&interior.point.x);
    value = value.abs().max(1e-8 * interior.problem.objective.constant.abs());
    let mu = (if excess > 1e-8 * value { excess } else { 1e-2 * value }).max(f64::MIN_POSITIVE) / m as f64;
    for (z, s) in interior.point.z.iter_mut().zip(&interior.point.s) {
        *z = mu / s;
    }
    if let Start::Warm { dual, .. } = start {
        for (row, &original) in interior.rows.original.iter().enumerate() {
            interior.point.z[row] = interior.point.z[row].max(dual[original as usize]);
        }
    }
    let _ = add;
    Ok(())
}
