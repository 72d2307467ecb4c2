//! Slacks and multipliers of few rows at once, while all others follow along a straight line.
//!
//! The factor at hand is that of `H = P + Aᵀ ρ A` with the weights that the rows had when it was made. A row may want another one: none if it is to
//! be inactive, its target σ if it is to be active. With a force u on each of these rows on top of those that the weights exert,
//!
//! ```text
//! y = y₀ + G u,    f = z + u - ρ (y - s),    f >= 0,    y + (f - z)/σ >= 0,    one of both zero,
//! ```
//!
//! where y is `A x + b`, G the compliance under H, s and z slack and dual from before: a linear complementarity problem, positive definite since G
//! without the weights is. For rows whose state is given it is a symmetric system in those whose weight is not the one they want,
//!
//! ```text
//! active:  G u + u/(σ - ρ) = -y₀ - s ρ/(σ - ρ),      inactive:  G u - u/ρ = z/ρ - (y₀ - s).
//! ```
//!
//! Sources: Gill, Murray, Saunders and Wright 1990, *A Schur-complement method for sparse quadratic programming*; Kostreva 1978, Júdice and Pires 1994
//! (block principal pivoting: all rows in a wrong state
//! change at once).

use crate::linalg::{Compliance, solve_symmetric};

/// So many exchanges without fewer rows in a wrong state are the end.
const PATIENCE: usize = 12;

/// So many rows in a wrong state are too many to exchange one by one.
const MANY: usize = 8;

/// Shares of a weight, or of a row's stiffness, that are nothing.
const TINY: f64 = 1e-12;

/// A row as it was before, and where the others alone would take it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    /// Weight ρ in the factor.
    pub weight: f64,
    /// Weight σ of an active row.
    pub target: f64,
    /// `A x + b` without additional forces.
    pub value: f64,
    pub slack: f64,
    pub dual: f64,
}

/// Finds the state of each row, and the additional forces.
///
/// # Arguments
/// * `compliance`: G, d x d.
/// * `active`: states to begin with, overwritten.
///
/// # Returns
/// The d forces, and whether every row is in the right state; where rows go on changing, those with the fewest wrong ones.
///
/// # Cost
/// One dense symmetric system for each exchange, at most d x d.
pub(super) fn solve(compliance: &Compliance, rows: &[Row], active: &mut [bool]) -> (Vec<f64>, bool) {
    let mut best = (usize::MAX, active.to_vec(), Vec::new());
    let mut patience = PATIENCE;
    let mut round = 0u32;
    loop {
        let forces = forces_of(compliance, rows, active);
        let is_wrong = |&row: &usize| {
            let Row { weight, target, value, slack, dual } = rows[row];
            let value = value + moved(compliance, row, &forces);
            if active[row] { dual + forces[row] < weight * (value - slack) } else { value < dual / target }
        };
        let mut wrong: Vec<usize> = (0..rows.len()).filter(is_wrong).collect();
        if wrong.is_empty() {
            return (forces, true);
        }
        if wrong.len() < best.0 {
            best = (wrong.len(), active.to_vec(), forces);
            patience = PATIENCE;
        } else if patience == 0 {
            active.copy_from_slice(&best.1);
            return (best.2, false);
        } else {
            patience -= 1;
        }
        // Where all together go in circles: the last one, which always ends (Murty 1974), and of many a half, which ends sooner.
        round += 1;
        if patience <= PATIENCE / 2 {
            let last = wrong[wrong.len() - 1];
            let is_many = wrong.len() > MANY;
            wrong.retain(|&row| if is_many { is_in_half(row, round) } else { row == last });
        }
        wrong.into_iter().for_each(|row| active[row] = !active[row]);
    }
}

/// Another half of the rows in each round, and always the same halves.
fn is_in_half(row: usize, round: u32) -> bool {
    (row as u32 ^ round.wrapping_mul(0x85EB_CA6B)).wrapping_mul(0x9E37_79B9) >> 31 == 0
}

/// The forces of given states.
fn forces_of(compliance: &Compliance, rows: &[Row], active: &[bool]) -> Vec<f64> {
    let mut forces = vec![0.0; rows.len()];
    let mut open = Vec::new();
    for (row, known) in rows.iter().enumerate() {
        // Those that have the weight they want make up for an old slack or dual, and that is all.
        if active[row] && known.weight >= (1.0 - TINY) * known.target {
            forces[row] = -known.weight * known.slack;
        } else if !active[row] && known.weight * compliance.at(row, row) <= TINY {
            forces[row] = known.weight * (known.value - known.slack) - known.dual;
        } else {
            open.push(row);
        }
    }
    let wanted = |&row: &usize| {
        let Row { weight, target, value, slack, dual } = rows[row];
        let wanted = if active[row] { -value - slack * weight / (target - weight) } else { dual / weight - (value - slack) };
        wanted - moved(compliance, row, &forces)
    };
    let mut side: Vec<f64> = open.iter().map(wanted).collect();
    let entry = |i: usize, j: usize| {
        let Row { weight, target, .. } = rows[open[i]];
        let diagonal = match i == j {
            true if active[open[i]] => 1.0 / (target - weight),
            true => -1.0 / weight,
            false => 0.0,
        };
        compliance.at(open[i], open[j]) + diagonal
    };
    solve_symmetric(entry, &mut side);
    for (&row, force) in open.iter().zip(&side) {
        forces[row] = *force;
    }
    forces
}

/// How far the forces move a row.
fn moved(compliance: &Compliance, row: usize, forces: &[f64]) -> f64 {
    let acting = forces.iter().enumerate().filter(|(_, force)| **force != 0.0);
    acting.map(|(other, force)| compliance.at(row, other) * force).sum()
}
