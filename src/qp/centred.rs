//! A centred start from a point that violates rows: slacks and duals split from the violations by a measured stiffness.

use super::QpError;
use super::interior::Interior;
use super::product::dot;

/// Stiffness of a row, over the one that P sets against closing all violations together. Measured (order 2, 15,000 and 58,000 unknowns,
/// with and without data): from 3 to 10 the iterations are the same within one.
const STIFFNESS: f64 = 5.0;

/// Slack and dual of a row on its boundary, over the mean violation, for violations that are closed one by one.
const ROOM: f64 = 1.5;

/// Power of the part of the stiffness of single rows that is met by all violations together, by which there is less room: where
/// violations are collective, closing some closes their neighbours. Measured without data at 58,000 unknowns: 16 iterations,
/// against 21 with the room of single violations.
const COLLECTIVE: f64 = 0.2;

/// The least part of that room: at order 3 without data and 7,396 unknowns 18 iterations, against 28 without a least part.
const LEAST_ROOM: f64 = 0.2;

/// Least gap of the start relative to the objective: few and small violations say little of the rows that closing them will violate.
/// (At 250,000 unknowns with few rows active, a start with a gap of 0.05 took seven short steps to leave its corner.)
const GAP: f64 = 0.5;

/// Where no row is violated, the room over the mean slack.
const SPARE: f64 = 1e-3;

/// A first step shorter than this was blocked: the start had too little room or force.
const FIRST_STEP: f64 = 0.12;

/// More stiffness and room for the start after a blocked one. (Measured with data: 17 instead of 24 factorizations at order 2 and 250,000 unknowns; at
/// order 3 16 instead of 21 at 58,000, 25 instead of 32 at 250,000 and 28 instead of 41 at 1,000,000. Where the first step is longer, from 0 to
/// 7 more.)
const AGAIN: (f64, f64) = (10.0, 3.0);

/// Below this share of the stiffness of single rows, violations are collective altogether. (Measured at order 3 from 15,000 to 250,000 unknowns: without data from
/// 1e-9 to 3e-7, with data from 1e-5 to 3e-3.)
const TOGETHER: f64 = 1e-6;

/// Below this share splitting gets nowhere. (Measured without data: 7 rounds at 3e-7, order 3 and 15,000 unknowns; at 2e-8, order 3 and 58,000 unknowns, and
/// at 2e-9, order 4 and 5,000 unknowns, rows go on changing by the thousand.)
const LEAST_SHARE: f64 = 1e-7;

/// Splits `r = A x + b` into positive slacks and duals with one product `c δ²`:
///
/// ```text
/// s - z/c = r,    s z = c δ²        so   s, z/c = (sqrt(r² + 4 δ²) ± r) / 2
/// ```
///
/// A violated row starts with the force `c |r|` that its violation asks for, a fulfilled one with its slack, and no row off the
/// centre. δ is near the typical violation; c follows from the stiffness `vᵀv / vᵀ(A P⁻¹ Aᵀ)v` that P sets against closing
/// the violations v, which without data is a thousandth of what it sets against closing a single row.
///
/// # Arguments
/// * `unit`: mean size of the slacks; `energy`: objective at the start.
///
/// # Cost
/// One solve, and one factorisation unless the factor of P is the last one made.
///
/// # Source
/// The split smooths `min(s, z/c) = 0`: Kanzow 1996, *Some noninterior continuation methods for linear complementarity problems*.
pub(super) fn split(interior: &mut Interior<'_>, (unit, energy): (f64, f64)) -> Result<(), QpError> {
    let Interior { engine, rows, problem, point, work, side, step, .. } = interior;
    let mut violated = 0u32;
    for (violation, r) in work.iter_mut().zip(&point.s) {
        *violation = (-r).max(0.0);
        violated += u32::from(*r < 0.0);
    }
    let single = match rows.compliance(|unknown| engine.diagonal_of(unknown)) {
        compliance if compliance > 0.0 => rows.len() as f64 / compliance,
        _ => engine.largest_diagonal(),
    };
    let (mut stiffness, mut room, mut share) = (single, SPARE * unit, 1.0);
    if violated > 0 {
        side.fill(0.0);
        rows.add_transposed(1.0, work, side);
        engine.mask(side);
        engine.factor_base()?;
        let (taken, _) = engine.solve_refined(&problem.objective, None, side, &mut step.x, (0.1, 3));
        interior.solves += taken;
        let together = dot(work, work) / dot(side, &step.x);
        if together.is_finite() && together > 0.0 {
            stiffness = STIFFNESS * together.min(single);
            share = (together / single).min(1.0);
            room = ROOM * share.powf(COLLECTIVE).max(LEAST_ROOM) * work.iter().sum::<f64>() / f64::from(violated);
            room = room.max((GAP * energy / (rows.len() as f64 * stiffness)).sqrt());
        }
    }
    let centre = Centre { stiffness, room, share };
    centre.apply(&mut point.s, &mut point.z);
    interior.centre = Some(centre);
    Ok(())
}

/// What slacks and duals were split with.
#[derive(Clone, Copy)]
pub(super) struct Centre {
    stiffness: f64,
    room: f64,
    /// Stiffness against closing all violations together, over that against closing a single one.
    share: f64,
}

impl Centre {
    /// The split to begin again with after a first step of some length, if it was blocked.
    ///
    /// Without data the violations are collective altogether, short first steps are usual, and more of both only takes longer.
    pub fn after(self, length: f64) -> Option<Self> {
        let again = Self { stiffness: AGAIN.0 * self.stiffness, room: AGAIN.1 * self.room, ..self };
        (length < FIRST_STEP && self.share > TOGETHER).then_some(again)
    }

    /// Whether closing some violations closes all of them.
    pub fn is_collective(self) -> bool {
        self.share < LEAST_SHARE
    }

    /// Splits `s = A x + b` into slacks and duals.
    pub fn apply(self, s: &mut [f64], z: &mut [f64]) {
        let Self { stiffness, room, .. } = self;
        for (s, z) in s.iter_mut().zip(z) {
            let r = *s;
            let larger = larger_part(r, room);
            // The smaller part as a quotient, so that it keeps its digits.
            let smaller = room * (room / larger);
            (*s, *z) = if r >= 0.0 { (larger, stiffness * smaller) } else { (smaller, stiffness * larger) };
        }
    }
}

/// The larger of the two positive parts whose difference is r and whose product is the square of `room`.
pub(super) fn larger_part(r: f64, room: f64) -> f64 {
    0.5 * (r.abs() + r.hypot(2.0 * room))
}
