//! The constraints as the interior point sees them: free unknowns only, and their share of the normal equations.
//!
//! The rows of nonnegative cones come first, then those of 2 x 2 blocks, then those of 3 x 3 blocks.

use rayon::prelude::*;

use crate::linalg::small::{from_scaled, scaled_length, symmetric_eigen, to_scaled};
use crate::linalg::{CsrMatrix, FactorError};

use super::blocks::{Blocks, BlocksBuilder, GRAIN};
use super::conflict::contradiction;
use super::scaling::Scaling;
use super::{Certificate, Cone, Engine, Problem, QpError};

/// Constraints with at least one free unknown; fixed unknowns are folded into the offset.
pub(super) struct Rows {
    /// Number of nonnegative rows.
    pub order: usize,
    /// The nonnegative rows, `order x n`, no entry at a fixed unknown.
    pub matrix: CsrMatrix,
    /// The 2 x 2 blocks.
    pub two: Blocks<2, 3>,
    /// The 3 x 3 blocks.
    pub three: Blocks<3, 6>,
    /// `b + A g`.
    pub offset: Vec<f64>,
    /// Largest entry of `|A| |g| + |b|`.
    pub offset_size: f64,
    /// The problem's row of each row here.
    pub original: Vec<u32>,
    /// The problem's constraint (a row or a block) that each row belongs to.
    pub member: Vec<u32>,
    /// A constraint without free unknowns that is violated: the problem has no solution.
    pub contradiction: Option<Certificate>,
    starts: Vec<u32>,
    slots: Vec<u32>,
    products: Vec<f64>,
}

/// One constraint with its fixed unknowns folded in.
struct Member {
    index: usize,
    first: usize,
    order: usize,
    /// (unknown, row in the constraint, coefficient), free unknowns only, sorted.
    entries: Vec<(u32, u32, f64)>,
    offset: [f64; 6],
    size: [f64; 6],
}

impl Member {
    fn read(&mut self, problem: &Problem) {
        let constraints = &problem.constraints;
        self.entries.clear();
        for local in 0..scaled_length(self.order) {
            let row = self.first + local;
            let (columns, values) = constraints.matrix.row(row);
            let mut sum = constraints.offset[row];
            let mut size = sum.abs();
            for (&column, &value) in columns.iter().zip(values) {
                match problem.fixed[column as usize] {
                    Some(known) => {
                        sum += value * known;
                        size += (value * known).abs();
                    }
                    None if value != 0.0 => self.entries.push((column, local as u32, value)),
                    None => {}
                }
            }
            self.offset[local] = sum;
            self.size[local] = size;
        }
        if self.order > 1 {
            self.entries.sort_unstable_by_key(|&(column, row, _)| (column, row));
        }
    }

    /// What a constraint without free unknowns says: nothing, or that there is no solution.
    fn contradiction(&self, rows: usize) -> Option<Certificate> {
        let length = scaled_length(self.order);
        let mut multiplier = [0.0; 6];
        let value = match self.order {
            1 => {
                multiplier[0] = 1.0;
                self.offset[0]
            }
            2 => least::<2>(&self.offset[..length], &mut multiplier[..length]),
            _ => least::<3>(&self.offset[..length], &mut multiplier[..length]),
        };
        let size = self.size[..length].iter().copied().fold(0.0, f64::max);
        let mut ray = vec![0.0; rows];
        ray[self.first..self.first + length].copy_from_slice(&multiplier[..length]);
        (value < -1e-12 * size).then(|| Certificate {
            constraints: vec![self.index],
            multipliers: vec![1.0],
            conflict: value,
            residual: 0.0,
            relaxations: Vec::new(),
            least_objective: None,
            ray,
        })
    }
}

/// Smallest eigenvalue of a scaled vector, and the scaled vector of its projector `v vᵀ`.
fn least<const D: usize>(vector: &[f64], projector: &mut [f64]) -> f64 {
    let (values, vectors) = symmetric_eigen(&from_scaled::<D>(vector));
    let dyad: [[f64; D]; D] = std::array::from_fn(|i| std::array::from_fn(|j| vectors[i][0] * vectors[j][0]));
    to_scaled(&dyad, projector);
    values[0]
}

impl Rows {
    /// Sorts out the constraints and finds the place of every product of coefficients in the engine's values.
    pub fn new(problem: &Problem, engine: &Engine) -> Result<Self, QpError> {
        let constraints = &problem.constraints;
        let unknowns = problem.fixed.len();
        let total = constraints.offset.len();
        let mut triplets = Vec::new();
        let (mut starts, mut pairs, mut products) = (vec![0u32], Vec::new(), Vec::new());
        let mut parts: [Part; 3] = Default::default();
        let blocks = |order: usize| constraints.cones.iter().filter(|cone| cone.order() == order).map(Cone::members).sum();
        let (mut two, mut three) = (BlocksBuilder::new(blocks(2)), BlocksBuilder::new(blocks(3)));
        let mut offset_size: f64 = 0.0;
        let mut alone = None;
        let mut found =
            Member { index: 0, first: 0, order: 1, entries: Vec::new(), offset: [0.0; 6], size: [0.0; 6] };
        for (index, (first, order)) in constraints.member_rows().enumerate() {
            (found.index, found.first, found.order) = (index, first, order);
            found.read(problem);
            if found.entries.is_empty() {
                alone = alone.or_else(|| found.contradiction(total));
                continue;
            }
            let slot = |first: u32, second: u32| slot_of(engine, found.first, (first, second));
            let here = parts[order - 1].offset.len() as u32;
            match order {
                1 => {
                    for (position, &(first, _, a)) in found.entries.iter().enumerate() {
                        triplets.push((here, first, a));
                        for &(second, _, b) in &found.entries[position..] {
                            pairs.push((found.first as u32, first, second));
                            products.push(a * b);
                        }
                    }
                    starts.push(pairs.len() as u32);
                }
                2 => two.push(&found.entries, slot)?,
                _ => three.push(&found.entries, slot)?,
            }
            for local in 0..scaled_length(order) {
                offset_size = offset_size.max(found.size[local]);
                let part = &mut parts[order - 1];
                part.offset.push(found.offset[local]);
                part.original.push((first + local) as u32);
                part.member.push(index as u32);
            }
        }
        let [one, second, third] = parts;
        let order = one.offset.len();
        let matrix = CsrMatrix::from_triplets(order, unknowns, &triplets).map_err(|_| QpError::Length {
            array: "rows",
            expected: unknowns,
            found: constraints.matrix.columns(),
        })?;
        let values = engine.symbolic.entries();
        let start_of_three = order + second.offset.len();
        let mut rows = Self {
            order,
            matrix,
            two: two.finish(order, unknowns, values),
            three: three.finish(start_of_three, unknowns, values),
            offset: [one.offset, second.offset, third.offset].concat(),
            offset_size,
            original: [one.original, second.original, third.original].concat(),
            member: [one.member, second.member, third.member].concat(),
            contradiction: None,
            starts,
            slots: Vec::new(),
            products,
        };
        let slot = |&(row, first, second): &(u32, u32, u32)| slot_of(engine, row as usize, (first, second));
        let (found, slots) = rayon::join(
            || alone.or_else(|| contradiction(&rows)),
            || pairs.par_iter().with_min_len(GRAIN).map(slot).collect::<Result<Vec<u32>, QpError>>(),
        );
        (rows.contradiction, rows.slots) = (found, slots?);
        Ok(rows)
    }

    pub fn len(&self) -> usize {
        self.offset.len()
    }

    /// Sum of the orders of all matrices, a row being one of order 1: what `zᵀ s` is divided by to measure the centre.
    pub fn degree(&self) -> usize {
        self.order + 2 * self.two.len() + 3 * self.three.len()
    }

    /// Whether there are rows only.
    pub fn is_polyhedral(&self) -> bool {
        self.order == self.len()
    }

    /// `out := A x` over the free unknowns.
    pub fn image_into(&self, x: &[f64], out: &mut [f64]) {
        self.matrix.multiply_into(x, &mut out[..self.order]);
        self.two.image_into(x, &mut out[self.two.rows()]);
        self.three.image_into(x, &mut out[self.three.rows()]);
    }

    /// `out := A x + b`.
    pub fn slack_into(&self, x: &[f64], out: &mut [f64]) {
        self.image_into(x, out);
        for (slot, offset) in out.iter_mut().zip(&self.offset) {
            *slot += offset;
        }
    }

    /// Largest entry of `|A| |x|` over the free unknowns.
    pub fn largest_image(&self, x: &[f64]) -> f64 {
        let size = |row: usize| {
            let (columns, values) = self.matrix.row(row);
            columns.iter().zip(values).map(|(&column, value)| (value * x[column as usize]).abs()).sum::<f64>()
        };
        let rows = (0..self.order).map(size).fold(0.0, f64::max);
        rows.max(self.two.largest_image(x)).max(self.three.largest_image(x))
    }

    /// The trace of `A diag(1/d) Aᵀ`: how far the constraints yield to unit forces, each unknown by itself.
    ///
    /// # Arguments
    /// * `stiffness`: d of an unknown; where it is zero, the unknown is left out.
    pub fn compliance(&self, stiffness: impl Fn(usize) -> f64) -> f64 {
        let rows: f64 = (0..self.order).map(|row| self.compliance_of(row, &stiffness)).sum();
        rows + self.two.compliance(&stiffness) + self.three.compliance(&stiffness)
    }

    /// The same of one nonnegative row.
    pub fn compliance_of(&self, row: usize, stiffness: impl Fn(usize) -> f64) -> f64 {
        let (columns, values) = self.matrix.row(row);
        let parts = columns.iter().zip(values).map(|(&column, value)| match stiffness(column as usize) {
            d if d > 0.0 => value * value / d,
            _ => 0.0,
        });
        parts.sum()
    }

    /// `y += a Aᵀ z`, rows in order.
    pub fn add_transposed(&self, a: f64, z: &[f64], y: &mut [f64]) {
        for (row, z) in z[..self.order].iter().enumerate() {
            let force = a * z;
            let (columns, values) = self.matrix.row(row);
            for (&column, value) in columns.iter().zip(values) {
                y[column as usize] += value * force;
            }
        }
        self.two.add_transposed(a, &z[self.two.rows()], y);
        self.three.add_transposed(a, &z[self.three.rows()], y);
    }

    /// `values += Aᵀ V A`, in one pass over the products.
    pub fn add_normal(&mut self, scaling: &Scaling, values: &mut [f64]) {
        for (row, weight) in scaling.weights.iter().enumerate() {
            for entry in self.starts[row] as usize..self.starts[row + 1] as usize {
                values[self.slots[entry] as usize] += weight * self.products[entry];
            }
        }
        self.two.add_normal(&scaling.two, values);
        self.three.add_normal(&scaling.three, values);
    }

    /// `y += Aᵀ V A x`.
    ///
    /// # Arguments
    /// * `work`: one number a row, overwritten.
    pub fn add_normal_product(&self, scaling: &Scaling, x: &[f64], y: &mut [f64], work: &mut [f64]) {
        for (row, weight) in scaling.weights.iter().enumerate() {
            let (columns, values) = self.matrix.row(row);
            let image: f64 = columns.iter().zip(values).map(|(&column, value)| value * x[column as usize]).sum();
            let force = weight * image;
            for (&column, value) in columns.iter().zip(values) {
                y[column as usize] += value * force;
            }
        }
        let (two, three) = (self.two.rows(), self.three.rows());
        self.two.metric_image_into(&scaling.two, x, &mut work[two.clone()]);
        self.two.add_transposed(1.0, &work[two], y);
        self.three.metric_image_into(&scaling.three, x, &mut work[three.clone()]);
        self.three.add_transposed(1.0, &work[three], y);
    }
}

/// Where the product of two unknowns of a row lives in the engine's values.
fn slot_of(engine: &Engine, row: usize, (first, second): (u32, u32)) -> Result<u32, QpError> {
    engine.slot(first as usize, second as usize).map_err(|error| match error {
        FactorError::OutsidePattern { row: first, column: second } => QpError::RowOutsidePattern { row, first, second },
        other => other.into(),
    })
}

/// Rows of one kind of cone.
#[derive(Default)]
struct Part {
    offset: Vec<f64>,
    original: Vec<u32>,
    member: Vec<u32>,
}
