//! Proofs that no point satisfies the constraints.

use crate::linalg::small::{composed, from_scaled, scaled_length, symmetric_eigen, to_scaled};

use super::system::System;
use super::QpError;
use super::interior::Interior;
use super::product::{add, dot, largest};
use super::rows::Rows;

/// How many times farther out than all that is known a feasible point would have to lie, once multipliers count as a proof.
const FAR: f64 = 1e6;

/// The same where there are blocks, whose rays are irrational and never exact.
const FAR_BLOCKS: f64 = 1e3;

/// What is left of the quadratic form when duals are projected to rays, relative to what the metric feels: it only keeps the matrix regular.
const RESIDUE: f64 = 1e-4;

/// Most refinements of a projection.
const REFINEMENTS: usize = 12;

/// The projection ends at this share of the first residual.
const EXACT: f64 = 1e-12;

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
    /// Largest entry of `Aᵀ y` at a free unknown: zero up to rounding where `least_objective` is `None`.
    pub residual: f64,
    /// The constraints that had to be relaxed, and by how much (`s + t >= 0`, `S + t I` positive semi-definite), so that the others could hold: few even where the
    /// ray spreads over many. Empty where the ray was found without relaxing.
    pub relaxations: Vec<(usize, f64)>,
    /// Where the ray is not exact: no feasible point has a smaller objective than this, thousands of times that of the point found. `None`: the ray is
    /// exact, and there is no feasible point at all.
    pub least_objective: Option<f64>,
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
            least_objective: None,
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
    // Any x that could still be feasible would lie that many times farther out.
    let far = if rows.is_polyhedral() { FAR } else { FAR_BLOCKS };
    (sum * far * reach < -conflict).then(|| Certificate::new(rows, ray, (conflict, largest(&image))))
}

impl Interior<'_> {
    /// A certificate from the duals projected to `Aᵀ y = 0` in the metric of the scaling, which keeps them in the cone where they are
    /// near a ray: blocked steps are certified long before the duals themselves diverge.
    ///
    /// # Cost
    /// One factorisation and a few solves.
    pub(super) fn projected_certificate(&mut self) -> Result<Option<Certificate>, QpError> {
        // The matrix with auxiliary unknowns has no room for the metric alone; blocks never come with chains that need it.
        if matches!(self.engine.system, System::Mixed(_)) || !self.scaling.update(&self.rows, &self.point) {
            return Ok(None);
        }
        let degree = self.rows.degree() as f64;
        // Where a constraint is far from active, its metric is about the centre over the square of its slack.
        let metric = dot(&self.point.s, &self.point.z).max(0.0) / dot(&self.point.s, &self.point.s).max(f64::MIN_POSITIVE);
        let compliance = self.rows.compliance(|unknown| self.engine.diagonal_of(unknown));
        self.engine.reset_values_to(RESIDUE * metric * compliance / degree);
        self.rows.add_normal(&self.scaling, &mut self.engine.values);
        self.engine.factor_values()?;
        let reach = largest(&self.point.x).max(self.rows.offset_size);
        let scale = (self.point.x.len(), reach);
        if let Some(found) = certificate(&self.rows, &self.point.z, scale) {
            return Ok(Some(found));
        }
        let mut ray = self.point.z.clone();
        // Conjugate gradients on Aᵀ V A d = Aᵀ z with the factor as preconditioner; the ray follows each step: y = z - V A d.
        let n = self.point.x.len();
        let (mut search, mut image) = (vec![0.0; n], vec![0.0; n]);
        let mut previous = 0.0;
        self.side.fill(0.0);
        self.rows.add_transposed(1.0, &ray, &mut self.side);
        let wanted = EXACT * largest(&self.side);
        for _ in 0..REFINEMENTS {
            let mut solved = self.side.clone();
            self.engine.system.solve_in_place(&self.engine.symbolic, &mut solved);
            self.solves += 1;
            let product = dot(&self.side, &solved);
            let ratio = if previous > 0.0 { product / previous } else { 0.0 };
            for (slot, value) in search.iter_mut().zip(&solved) {
                *slot = value + ratio * *slot;
            }
            previous = product;
            self.rows.image_into(&search, &mut self.trial.s);
            self.scaling.times(&self.rows, &self.trial.s, &mut self.work);
            let length = product / dot(&self.trial.s, &self.work);
            if !(length.is_finite() && length > 0.0) {
                break;
            }
            add(&mut ray, -length, &self.work);
            image.fill(0.0);
            self.rows.add_transposed(1.0, &self.work, &mut image);
            add(&mut self.side, -length, &image);
            if largest(&self.side) <= wanted {
                break;
            }
        }
        for value in &mut ray[..self.rows.order] {
            *value = value.max(0.0);
        }
        clip::<2>(&mut ray[self.rows.two.rows()]);
        clip::<3>(&mut ray[self.rows.three.rows()]);
        Ok(certificate(&self.rows, &ray, scale))
    }
}

impl Interior<'_> {
    /// The duals as they are.
    pub(super) fn certificate_of_duals(&self) -> Certificate {
        let mut image = vec![0.0; self.point.x.len()];
        self.rows.add_transposed(1.0, &self.point.z, &mut image);
        Certificate::new(&self.rows, &self.point.z, (dot(&self.rows.offset, &self.point.z), largest(&image)))
    }
}

/// Cuts off negative eigenvalues; what that adds to `Aᵀ y` is judged with the rest.
fn clip<const D: usize>(part: &mut [f64]) {
    for block in part.chunks_mut(scaled_length(D)) {
        let (values, vectors) = symmetric_eigen(&from_scaled::<D>(block));
        if values[0] < 0.0 {
            to_scaled(&composed(&values.map(|value| value.max(0.0)), &vectors), block);
        }
    }
}
