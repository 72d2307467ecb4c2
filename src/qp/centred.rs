//! A centred start from a point that violates rows: slacks and duals split from the violations by a measured stiffness.

use super::QpError;
use super::interior::Interior;
use super::product::dot;

/// Stiffness of the rows, over the one that would close all violations together. Measured at 15,000 and 58,000 unknowns with
/// and without data: within a factor of ten of the best, iterations vary by one or two.
const STIFFNESS: f64 = 5.0;

/// Slack of a row that is neither violated nor fulfilled, over the root mean square of the violations.
const ROOM: f64 = 1.0;

/// Where no row is violated, the same relative to the mean slack.
const SPARE: f64 = 1e-3;

/// Splits `r = A x + b` into positive slacks and duals with one product `c δ²`:
///
/// ```text
/// s - z/c = r,    s z = c δ²        so   s, z/c = (sqrt(r² + 4 δ²) ± r) / 2
/// ```
///
/// A violated row starts with the force `c |r|` that its violation asks for, a fulfilled one with its slack; no row starts nearer
/// to the boundary than the centre. δ is the typical violation v, and c the stiffness `vᵀv / vᵀ(A P⁻¹ Aᵀ)v` that P sets against
/// closing them: without data a thousandth of what neighbours alone set against it.
///
/// # Cost
/// One solve, and one factorisation unless the factor of P is the last one made.
///
/// # Source
/// Smoothing of `min(s, z/c) = 0`: Kanzow 1996, *Some noninterior continuation methods for linear complementarity problems*.
pub(super) fn split(interior: &mut Interior<'_>) -> Result<(), QpError> {
    let var = |name: &str, d: f64| std::env::var(name).ok().and_then(|t| t.parse::<f64>().ok()).unwrap_or(d);
    let m = interior.rows.len();
    interior.rows.slack_into(&interior.point.x, &mut interior.point.s);
    let r = &interior.point.s;
    let mut violated = 0usize;
    for (violation, r) in interior.work.iter_mut().zip(r) {
        *violation = (-r).max(0.0);
        violated += usize::from(*r < 0.0);
    }
    let square = dot(&interior.work, &interior.work);
    let (room, closing) = if square > 0.0 {
        interior.side.fill(0.0);
        interior.rows.add_transposed(1.0, &interior.work, &mut interior.side);
        interior.engine.mask(&mut interior.side);
        interior.engine.factor_base()?;
        let objective = &interior.problem.objective;
        let (taken, _) = interior.engine.solve_refined(objective, None, &interior.side, &mut interior.step.x, (1e-1, 3));
        interior.solves += taken;
        let mean = interior.work.iter().sum::<f64>() / violated as f64;
        let rms = (square / violated as f64).sqrt();
        if std::env::var("VERBOSE").is_ok() { eprintln!("rms {rms:.2e} mean {mean:.2e}"); }
        (if var("M0", 0.0) > 0.0 { mean } else { rms }, square / dot(&interior.side, &interior.step.x))
    } else {
        (SPARE * r.iter().sum::<f64>() / m as f64, interior.engine.largest_diagonal())
    };
    let room = var("D0", ROOM) * room;
    let stiffness = var("C0", STIFFNESS) * closing;
    if std::env::var("VERBOSE").is_ok() { eprintln!("violated {violated} of {m}, room {room:.1e}, stiffness {stiffness:.2e}, largest diagonal {:.1e}", interior.engine.largest_diagonal()); }
    for (s, z) in interior.point.s.iter_mut().zip(&mut interior.point.z) {
        let r = *s;
        let larger = 0.5 * (r.abs() + r.hypot(2.0 * room));
        let smaller = room * room / larger;
        (*s, *z) = if r >= 0.0 { (larger, stiffness * smaller) } else { (smaller, stiffness * larger) };
    }
    Ok(())
}
