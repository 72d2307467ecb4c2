//! The rows as the interior point sees them: free unknowns only, and their share of the normal equations.

use crate::linalg::{CsrMatrix, FactorError};

use super::{Certificate, Engine, Problem, QpError};

/// Rows with at least one free unknown; fixed unknowns are folded into the offset.
pub(super) struct Rows {
    /// `rows x n`, no entry at a fixed unknown.
    pub matrix: CsrMatrix,
    /// `b + A g`.
    pub offset: Vec<f64>,
    /// Largest entry of `|A| |g| + |b|`.
    pub offset_size: f64,
    /// The problem's row of each row here.
    pub original: Vec<u32>,
    /// A row without free unknowns that is violated: the problem has no solution.
    pub contradiction: Option<Certificate>,
    starts: Vec<u32>,
    slots: Vec<u32>,
    products: Vec<f64>,
}

impl Rows {
    /// Sorts out the rows and finds the place of every product `a_i a_j` in the engine's values.
    pub fn new(problem: &Problem, engine: &Engine) -> Result<Self, QpError> {
        let constraints = &problem.constraints;
        let fixed = &problem.fixed;
        let mut triplets = Vec::with_capacity(constraints.matrix.entries());
        let (mut offset, mut original) = (Vec::new(), Vec::new());
        let (mut starts, mut slots, mut products) = (vec![0u32], Vec::new(), Vec::new());
        let mut offset_size: f64 = 0.0;
        let mut contradiction = None;
        for row in 0..constraints.offset.len() {
            let (columns, values) = constraints.matrix.row(row);
            let mut sum = constraints.offset[row];
            let mut size = sum.abs();
            let here = original.len() as u32;
            let mut free = 0;
            for (&column, &value) in columns.iter().zip(values) {
                match fixed[column as usize] {
                    Some(known) => {
                        sum += value * known;
                        size += (value * known).abs();
                    }
                    None if value != 0.0 => {
                        triplets.push((here, column, value));
                        free += 1;
                    }
                    None => {}
                }
            }
            if free == 0 {
                if sum < -1e-12 * size && contradiction.is_none() {
                    contradiction =
                        Some(Certificate { rows: vec![row], multipliers: vec![1.0], conflict: sum, residual: 0.0 });
                }
                continue;
            }
            let entries = &triplets[triplets.len() - free..];
            for (position, &(_, first, a)) in entries.iter().enumerate() {
                for &(_, second, b) in &entries[position..] {
                    let slot = engine.symbolic.slot(first as usize, second as usize).map_err(|error| match error {
                        FactorError::OutsidePattern { row: first, column: second } => {
                            QpError::RowOutsidePattern { row, first, second }
                        }
                        other => other.into(),
                    })?;
                    slots.push(slot);
                    products.push(a * b);
                }
            }
            starts.push(slots.len() as u32);
            offset_size = offset_size.max(size);
            offset.push(sum);
            original.push(row as u32);
        }
        let matrix = CsrMatrix::from_triplets(offset.len(), fixed.len(), &triplets).map_err(|_| QpError::Length {
            array: "rows",
            expected: fixed.len(),
            found: constraints.matrix.columns(),
        })?;
        Ok(Self { matrix, offset, offset_size, original, contradiction, starts, slots, products })
    }

    pub fn len(&self) -> usize {
        self.offset.len()
    }

    /// `out := A x` over the free unknowns.
    pub fn image_into(&self, x: &[f64], out: &mut [f64]) {
        self.matrix.multiply_into(x, out);
    }

    /// `out := A x + b`.
    pub fn slack_into(&self, x: &[f64], out: &mut [f64]) {
        self.matrix.multiply_into(x, out);
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
        (0..self.len()).map(size).fold(0.0, f64::max)
    }

    /// `y += a Aᵀ z`, rows in order.
    pub fn add_transposed(&self, a: f64, z: &[f64], y: &mut [f64]) {
        for (row, z) in z.iter().enumerate() {
            let force = a * z;
            let (columns, values) = self.matrix.row(row);
            for (&column, value) in columns.iter().zip(values) {
                y[column as usize] += value * force;
            }
        }
    }

    /// `values += Aᵀ diag(weights) A`, in one pass over the products.
    pub fn add_normal(&self, weights: &[f64], values: &mut [f64]) {
        for (row, weight) in weights.iter().enumerate() {
            for entry in self.starts[row] as usize..self.starts[row + 1] as usize {
                values[self.slots[entry] as usize] += weight * self.products[entry];
            }
        }
    }
}
