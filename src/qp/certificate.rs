//! Proofs that no point satisfies the constraints.

use super::product::{dot, largest};
use super::rows::Rows;

/// Multipliers below this share of the largest are not named.
const NAMED: f64 = 1e-6;

/// Why no point satisfies the constraints: a combination of them that contradicts itself.
///
/// With the ray y in the dual cone (nonnegative on rows, positive semi-definite on blocks), the sum `yᵀ (A x + b)` does not depend on the
/// free unknowns and is negative; no feasible x could make it so. Rows and blocks are named alike, by the number of the
/// constraint: in the order of the cones, a row of a nonnegative cone counts as one and a block as one, so that in a problem of one cone it is
/// the number of the row or of the block.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Certificate {
    /// The constraints that contradict each other, rising.
    pub constraints: Vec<usize>,
    /// The positive multiplier of each of these, of a block the trace; the largest is 1.
    pub multipliers: Vec<f64>,
    /// `yᵀ (A x + b)` with all free unknowns at zero: negative.
    pub conflict: f64,
    /// Largest entry of `Aᵀ y` at a free unknown: zero up to rounding.
    pub residual: f64,
    /// The constraints that had to be relaxed, and by how much (`s + t >= 0`, `S + t I` positive semi-definite), so that the others could hold: few even where the
    /// ray spreads over many. Empty where the ray was found without relaxing.
    pub relaxations: Vec<(usize, f64)>,
    /// y, m numbers.
    #[serde(skip)]
    pub ray: Vec<f64>,
}

impl Certificate {
    /// Names the constraints of a ray over the rows in the solver's order.
    pub(super) fn new(rows: &Rows, ray: &[f64], (conflict, residual): (f64, f64)) -> Self {
        let members = rows.member.iter().map(|&member| member as usize + 1).max().unwrap_or(0);
        let mut weights = vec![0.0; members];
        for row in 0..rows.order {
            weights[rows.member[row] as usize] += ray[row];
        }
        // The diagonal of a scaled vector is at places 0 and 2, and 5.
        for (range, diagonal) in [(rows.two.rows(), &[0, 2][..]), (rows.three.rows(), &[0, 2, 5][..])] {
            let length = if diagonal.len() == 2 { 3 } else { 6 };
            for first in range.step_by(length) {
                weights[rows.member[first] as usize] += diagonal.iter().map(|place| ray[first + place]).sum::<f64>();
            }
        }
        let top = largest(&weights).max(f64::MIN_POSITIVE);
        let constraints: Vec<usize> = (0..members).filter(|&member| weights[member] > NAMED * top).collect();
        let last = rows.original.iter().map(|&row| row as usize + 1).max().unwrap_or(0);
        let mut original = vec![0.0; last];
        for (&row, value) in rows.original.iter().zip(ray) {
            original[row as usize] = value / top;
        }
        Self {
            multipliers: constraints.iter().map(|&member| weights[member] / top).collect(),
            constraints,
            conflict: conflict / top,
            residual: residual / top,
            relaxations: Vec::new(),
            ray: original,
        }
    }
}

/// A certificate from duals that have become a ray, if they have.
///
/// Growing duals with `Aᵀ y` tiny against `-bᵀ y` show that every x violates some row: for x within any ball of radius r around
/// zero, `yᵀ (A x + b) <= r |Aᵀ y|_1 + bᵀ y < 0`.
///
/// # Arguments
/// * `ray`: y in the solver's order of rows; `reach`: the size of the present point and of all known values.
pub(super) fn certificate(rows: &Rows, ray: &[f64], (unknowns, reach): (usize, f64)) -> Option<Certificate> {
    let conflict = dot(&rows.offset, ray);
    if conflict >= 0.0 {
        return None;
    }
    let mut image = vec![0.0; unknowns];
    rows.add_transposed(1.0, ray, &mut image);
    let sum: f64 = image.iter().map(|value| value.abs()).sum();
    // Any x that could still be feasible would lie a million times farther out.
    (sum * 1e6 * reach < -conflict).then(|| Certificate::new(rows, ray, (conflict, largest(&image))))
}
