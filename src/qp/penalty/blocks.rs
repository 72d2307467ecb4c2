//! The blocks of the rows as the penalty sees them: value, multipliers, and their share of the Newton matrix.

use super::Penalty;
use super::spectral::expand;
use crate::linalg::{FactorError, sort_and_deduplicate};
use crate::linalg::small::{Square, from_scaled, scaled_length, symmetric_eigen, to_scaled};
use crate::qp::{Engine, Problem, QpError};
use rayon::prelude::*;

/// Blocks summed by one parallel task; fixed, so that the bits do not depend on the number of threads.
const CHUNK: usize = 1024;

/// One order row, or one matrix.
struct Block {
    /// Size of the matrix, 1 to 3.
    size: u8,
    /// Its first row of the problem.
    row: u32,
    /// First of its free columns; the next block's is the end.
    columns: u32,
    /// First of its coefficients, rows by columns.
    coefficients: u32,
    /// First place of its products `a_i a_j`, i <= j, in the engine's values.
    slots: u32,
}

/// All blocks of a problem.
pub(super) struct Blocks {
    blocks: Vec<Block>,
    columns: Vec<u32>,
    coefficients: Vec<f64>,
    slots: Vec<u32>,
    /// w of each block.
    pub weights: Vec<f64>,
    /// rho, a typical value of a row.
    pub unit: f64,
}

/// The penalty at one parameter.
#[derive(Clone, Copy)]
pub(super) struct Level {
    pub penalty: Penalty,
    pub tau: f64,
}

impl Blocks {
    /// Finds the free unknowns of every block and the places of their products.
    pub fn new(problem: &Problem, engine: &Engine) -> Result<Self, QpError> {
        let matrix = &problem.constraints.matrix;
        let (mut columns, mut coefficients, mut slots) = (Vec::<u32>::new(), Vec::new(), Vec::new());
        let mut blocks = Vec::with_capacity(problem.constraints.members() + 1);
        for (row, size) in problem.constraints.member_rows() {
            let rows = row..row + scaled_length(size);
            let first = columns.len();
            blocks.push(Block {
                size: size as u8,
                row: row as u32,
                columns: first as u32,
                coefficients: coefficients.len() as u32,
                slots: slots.len() as u32,
            });
            for entry in rows.clone() {
                let (names, values) = matrix.row(entry);
                let free = names.iter().zip(values).filter(|&(&column, &value)| value != 0.0 && !engine.is_fixed[column as usize]);
                columns.extend(free.map(|(column, _)| column));
            }
            sort_and_deduplicate(&mut columns, first);
            for entry in rows {
                coefficients.extend(columns[first..].iter().map(|&column| matrix.get(entry, column as usize)));
            }
            for (place, &one) in columns[first..].iter().enumerate() {
                for &other in &columns[first + place..] {
                    slots.push(engine.slot(one as usize, other as usize).map_err(|error| match error {
                        FactorError::OutsidePattern { row: first, column: second } => {
                            QpError::RowOutsidePattern { row, first, second }
                        }
                        other => other.into(),
                    })?);
                }
            }
        }
        let row = problem.constraints.offset.len();
        let (columns_end, coefficients_end, slots_end) = (columns.len() as u32, coefficients.len() as u32, slots.len() as u32);
        blocks.push(Block { size: 0, row: row as u32, columns: columns_end, coefficients: coefficients_end, slots: slots_end });
        Ok(Self { blocks, columns, coefficients, slots, weights: Vec::new(), unit: 1.0 })
    }

    pub fn len(&self) -> usize {
        self.blocks.len() - 1
    }

    fn columns(&self, block: usize) -> &[u32] {
        &self.columns[self.blocks[block].columns as usize..self.blocks[block + 1].columns as usize]
    }

    fn coefficients(&self, block: usize) -> &[f64] {
        &self.coefficients[self.blocks[block].coefficients as usize..self.blocks[block + 1].coefficients as usize]
    }

    /// Sets each weight to one over the mean of `a diag(P)⁻¹ aᵀ` over the rows of the block.
    pub fn weigh_by(&mut self, diagonal: &[f64]) {
        let largest = diagonal.iter().fold(0.0, |most: f64, value| most.max(*value));
        // Unknowns without any curvature of their own must not make a weight vanish.
        let floor = if largest > 0.0 { 1e-12 * largest } else { 1.0 };
        let weight = |block: usize| {
            let (columns, coefficients) = (self.columns(block), self.coefficients(block));
            let rows = scaled_length(usize::from(self.blocks[block].size));
            let sum: f64 = coefficients
                .chunks(columns.len().max(1))
                .flat_map(|row| row.iter().zip(columns))
                .map(|(a, &column)| a * a / diagonal[column as usize].max(floor))
                .sum();
            if sum > 0.0 { rows as f64 / sum } else { 1.0 }
        };
        self.weights = (0..self.len()).map(weight).collect();
    }

    /// Sum of a function of each block and its rows, in chunks.
    fn sum(&self, rows: &[f64], of: impl Fn(usize, &[f64]) -> f64 + Sync) -> f64 {
        let slice = |block: usize| &rows[self.blocks[block].row as usize..self.blocks[block + 1].row as usize];
        let chunk = |index: usize| {
            (index * CHUNK..((index + 1) * CHUNK).min(self.len())).map(|block| of(block, slice(block))).sum::<f64>()
        };
        (0..self.len().div_ceil(CHUNK)).into_par_iter().map(chunk).collect::<Vec<f64>>().iter().sum()
    }

    /// The penalty along a line, less that at its start: `sum T(S + t D) - T(S)`.
    pub fn difference(&self, level: Level, (s, d): (&[f64], &[f64]), t: f64) -> f64 {
        self.sum(s, |block, s| {
            let row = self.blocks[block].row as usize;
            let mut moved = [0.0; 6];
            for (slot, (s, d)) in moved.iter_mut().zip(s.iter().zip(&d[row..])) {
                *slot = s + t * d;
            }
            let weight = self.weights[block] * self.unit * self.unit;
            let value = |s: &[f64]| self.eigenvalues(block, s).map(|values| self.value(level, &values)).unwrap_or(f64::INFINITY);
            weight * (value(&moved[..s.len()]) - value(s))
        })
    }

    fn value(&self, level: Level, values: &[f64; 3]) -> f64 {
        values.iter().filter(|value| value.is_finite()).map(|value| level.penalty.value(level.tau, value / self.unit)).sum()
    }

    /// Eigenvalues of a block, padded with infinity; `None` if they are no numbers.
    fn eigenvalues(&self, block: usize, s: &[f64]) -> Option<[f64; 3]> {
        let mut padded = [f64::INFINITY; 3];
        match self.blocks[block].size {
            1 => padded[0] = s[0],
            2 => padded[..2].copy_from_slice(&symmetric_eigen(&from_scaled::<2>(s)).0),
            _ => padded.copy_from_slice(&symmetric_eigen(&from_scaled::<3>(s)).0),
        }
        padded.iter().all(|value| !value.is_nan() && *value != f64::NEG_INFINITY).then_some(padded)
    }

    /// The most negative eigenvalue of all blocks, or 0.
    pub fn violation(&self, s: &[f64]) -> f64 {
        let least = |block: usize| {
            let rows = &s[self.blocks[block].row as usize..self.blocks[block + 1].row as usize];
            self.eigenvalues(block, rows).map_or(f64::NEG_INFINITY, |values| values.into_iter().fold(0.0, f64::min))
        };
        (0..self.len()).into_par_iter().with_min_len(CHUNK).map(least).reduce(|| 0.0, f64::min)
    }

    /// Adds the Hessian of the penalty to the engine's values and writes the multipliers `z = -dT/dS`.
    pub fn linearise(&self, level: Level, s: &[f64], z: &mut [f64], values: &mut [f64]) {
        for block in 0..self.len() {
            let rows = self.blocks[block].row as usize..self.blocks[block + 1].row as usize;
            let (s, z) = (&s[rows.clone()], &mut z[rows]);
            let weight = self.weights[block];
            let mut add = |curvature: f64, direction: &[f64]| self.add_square(block, weight * curvature, direction, values);
            self.expand(block, level, s, z, &mut add);
            z.iter_mut().for_each(|slot| *slot *= -weight * self.unit);
        }
    }

    /// `out := -T''(S)[D]`, the change of the multipliers along D.
    pub fn change(&self, level: Level, (s, d): (&[f64], &[f64]), out: &mut [f64]) {
        let mut ignored = [0.0; 6];
        for block in 0..self.len() {
            let rows = self.blocks[block].row as usize..self.blocks[block + 1].row as usize;
            let (s, d, out) = (&s[rows.clone()], &d[rows.clone()], &mut out[rows]);
            out.fill(0.0);
            let ignored = &mut ignored[..s.len()];
            let weight = self.weights[block];
            let mut add = |curvature: f64, direction: &[f64]| {
                let along: f64 = direction.iter().zip(d).map(|(u, d)| u * d).sum();
                for (slot, u) in out.iter_mut().zip(direction) {
                    *slot -= weight * curvature * along * u;
                }
            };
            self.expand(block, level, s, ignored, &mut add);
        }
    }

    /// Slope and curvatures of the penalty of one block in the unit rho.
    fn expand(&self, block: usize, Level { penalty, tau }: Level, s: &[f64], slope: &mut [f64], add: &mut impl FnMut(f64, &[f64])) {
        let mut scaled = [0.0; 6];
        let scaled = &mut scaled[..s.len()];
        for (slot, s) in scaled.iter_mut().zip(s) {
            *slot = s / self.unit;
        }
        match self.blocks[block].size {
            1 => expand::<1>(penalty, tau, scaled, slope, add),
            2 => expand::<2>(penalty, tau, scaled, slope, add),
            _ => expand::<3>(penalty, tau, scaled, slope, add),
        }
    }

    /// `values += curvature (Aᵀu) (Aᵀu)ᵀ` over the rows A of a block.
    fn add_square(&self, block: usize, curvature: f64, direction: &[f64], values: &mut [f64]) {
        // A block of a mesh has at most 12 free unknowns; blocks with more are handled in pieces of the heap.
        let columns = self.columns(block).len();
        let mut short = [0.0; 16];
        let mut long = Vec::new();
        let image: &mut [f64] = if columns <= short.len() {
            &mut short[..columns]
        } else {
            long.resize(columns, 0.0);
            &mut long
        };
        for (u, row) in direction.iter().zip(self.coefficients(block).chunks(columns.max(1))) {
            for (slot, a) in image.iter_mut().zip(row) {
                *slot += u * a;
            }
        }
        let mut slot = self.blocks[block].slots as usize;
        for (place, one) in image.iter().enumerate() {
            let scaled = curvature * one;
            for other in &image[place..] {
                values[self.slots[slot] as usize] += scaled * other;
                slot += 1;
            }
        }
    }

    /// Splits rows into the nearest point of the cones and what is missing: `s := max(s, 0)` by eigenvalues.
    pub fn project(&self, s: &mut [f64]) {
        for block in 0..self.len() {
            let rows = &mut s[self.blocks[block].row as usize..self.blocks[block + 1].row as usize];
            match self.blocks[block].size {
                1 => rows[0] = rows[0].max(0.0),
                2 => projected::<2>(rows),
                _ => projected::<3>(rows),
            }
        }
    }

    /// Largest absolute product of two points of the rows in one block.
    pub fn largest_product(&self, s: &[f64], z: &[f64]) -> f64 {
        let product = |block: usize| {
            let rows = self.blocks[block].row as usize..self.blocks[block + 1].row as usize;
            s[rows.clone()].iter().zip(&z[rows]).map(|(s, z)| s * z).sum::<f64>().abs()
        };
        (0..self.len()).map(product).fold(0.0, f64::max)
    }
}

fn projected<const D: usize>(rows: &mut [f64]) {
    let (values, vectors) = symmetric_eigen(&from_scaled::<D>(rows));
    if values.iter().all(|value| *value >= 0.0) {
        return;
    }
    let square: Square<D> = std::array::from_fn(|a| {
        std::array::from_fn(|b| (0..D).map(|i| vectors[a][i] * values[i].max(0.0) * vectors[b][i]).sum())
    });
    to_scaled(&square, rows);
}
