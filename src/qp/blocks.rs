//! Positive semi-definite blocks of one size as the interior point sees them: free unknowns only, coefficients block by block.

use rayon::prelude::*;

use crate::linalg::small::{Square, from_scaled, product, to_scaled};

use super::scaling::Scaled;

/// Blocks, unknowns or values that one task works on at least.
pub(super) const GRAIN: usize = 1024;

/// Blocks of D x D matrices, R = D (D + 1) / 2 rows each.
pub(super) struct Blocks<const D: usize, const R: usize> {
    /// First row of the first block.
    pub first: usize,
    /// Where the columns of each block begin, and their end.
    starts: Vec<u32>,
    /// Free unknowns of each block, rising.
    columns: Vec<u32>,
    /// The R coefficients of each column.
    coefficients: Vec<[f64; R]>,
    /// The block of each column.
    owners: Vec<u32>,
    /// Where the columns of each unknown begin in `uses`.
    use_starts: Vec<u32>,
    /// The columns of each unknown, rising.
    uses: Vec<u32>,
    /// Where each block's share of the normal equations begins, and their end.
    share_starts: Vec<u32>,
    /// Where the shares of each slot of the engine begin in `gather`; grouped by slot, the sums have one order for any number of threads.
    gather_starts: Vec<u32>,
    /// The shares of each slot, blocks rising.
    gather: Vec<u32>,
    /// The shares themselves.
    shares: Vec<f64>,
}

/// Collects blocks one by one.
pub(super) struct BlocksBuilder<const D: usize, const R: usize> {
    starts: Vec<u32>,
    columns: Vec<u32>,
    coefficients: Vec<[f64; R]>,
    slots: Vec<u32>,
    share_starts: Vec<u32>,
}

impl<const D: usize, const R: usize> BlocksBuilder<D, R> {
    /// Makes room for so many blocks over simplices, exactly: lists of this size must not grow by doubling.
    pub fn new(blocks: usize) -> Self {
        let columns = D * (D + 1);
        let mut starts = Vec::with_capacity(blocks + 1);
        starts.push(0);
        Self {
            share_starts: starts.clone(),
            starts,
            columns: Vec::with_capacity(blocks * columns),
            coefficients: Vec::with_capacity(blocks * columns),
            slots: Vec::with_capacity(blocks * columns * (columns + 1) / 2),
        }
    }

    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Adds a block.
    ///
    /// # Arguments
    /// * `entries`: (unknown, row in the block, coefficient) at free unknowns, sorted by unknown.
    /// * `slot`: place of a pair of unknowns in the engine's values.
    pub fn push<E>(&mut self, entries: &[(u32, u32, f64)], mut slot: impl FnMut(u32, u32) -> Result<u32, E>) -> Result<(), E> {
        let begin = self.columns.len();
        for &(column, row, value) in entries {
            if self.columns.len() == begin || self.columns.last() != Some(&column) {
                self.columns.push(column);
                self.coefficients.push([0.0; R]);
            }
            if let Some(last) = self.coefficients.last_mut() {
                last[row as usize] += value;
            }
        }
        for first in begin..self.columns.len() {
            for second in begin..=first {
                self.slots.push(slot(self.columns[first], self.columns[second])?);
            }
        }
        self.starts.push(self.columns.len() as u32);
        self.share_starts.push(self.slots.len() as u32);
        Ok(())
    }

    /// Sorts what was collected by unknowns and by slots.
    pub fn finish(self, first: usize, unknowns: usize, values: usize) -> Blocks<D, R> {
        let mut owners = vec![0; self.columns.len()];
        for block in 0..self.len() {
            owners[self.starts[block] as usize..self.starts[block + 1] as usize].fill(block as u32);
        }
        let is_empty = self.columns.is_empty();
        let (use_starts, uses) = grouped(&self.columns, if is_empty { 0 } else { unknowns });
        let (gather_starts, gather) = grouped(&self.slots, if is_empty { 0 } else { values });
        Blocks {
            first,
            starts: self.starts,
            columns: self.columns,
            coefficients: self.coefficients,
            owners,
            use_starts,
            uses,
            share_starts: self.share_starts,
            gather_starts,
            gather,
            shares: vec![0.0; self.slots.len()],
        }
    }
}

/// The places of each key, in order: a counting sort.
fn grouped(keys: &[u32], size: usize) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; size + 1];
    for &key in keys {
        starts[key as usize + 1] += 1;
    }
    for key in 0..size {
        starts[key + 1] += starts[key];
    }
    let mut next = starts.clone();
    let mut places = vec![0; keys.len()];
    for (place, &key) in keys.iter().enumerate() {
        places[next[key as usize] as usize] = place as u32;
        next[key as usize] += 1;
    }
    (starts, places)
}

impl<const D: usize, const R: usize> Blocks<D, R> {
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Rows of all blocks.
    pub fn rows(&self) -> std::ops::Range<usize> {
        self.first..self.first + R * self.len()
    }

    fn columns_of(&self, block: usize) -> std::ops::Range<usize> {
        self.starts[block] as usize..self.starts[block + 1] as usize
    }

    fn image_of(&self, block: usize, x: &[f64]) -> [f64; R] {
        let mut image = [0.0; R];
        for place in self.columns_of(block) {
            let value = x[self.columns[place] as usize];
            for (slot, coefficient) in image.iter_mut().zip(&self.coefficients[place]) {
                *slot += coefficient * value;
            }
        }
        image
    }

    /// `out := A x`, all rows of these blocks.
    pub fn image_into(&self, x: &[f64], out: &mut [f64]) {
        out.par_chunks_mut(R).with_min_len(GRAIN).enumerate().for_each(|(block, out)| {
            out.copy_from_slice(&self.image_of(block, x));
        });
    }

    /// `out := V A x` with the metric of the scaling.
    pub fn metric_image_into(&self, scaled: &[Scaled<D>], x: &[f64], out: &mut [f64]) {
        out.par_chunks_mut(R).zip(scaled).with_min_len(GRAIN).enumerate().for_each(|(block, (out, scaled))| {
            scaled.metric_times(&self.image_of(block, x), out);
        });
    }

    /// Largest entry of `|A| |x|`.
    pub fn largest_image(&self, x: &[f64]) -> f64 {
        let size = |block: usize| {
            let mut image = [0.0; R];
            for place in self.columns_of(block) {
                let value = x[self.columns[place] as usize];
                for (slot, coefficient) in image.iter_mut().zip(&self.coefficients[place]) {
                    *slot += (coefficient * value).abs();
                }
            }
            image.into_iter().fold(0.0, f64::max)
        };
        (0..self.len()).into_par_iter().with_min_len(GRAIN).map(size).reduce(|| 0.0, f64::max)
    }

    /// The trace of `A diag(1/d) Aᵀ`; see [`Rows::compliance`](super::rows::Rows::compliance).
    pub fn compliance(&self, stiffness: impl Fn(usize) -> f64) -> f64 {
        let mut sum = 0.0;
        for (&column, coefficients) in self.columns.iter().zip(&self.coefficients) {
            let d = stiffness(column as usize);
            if d > 0.0 {
                sum += coefficients.iter().map(|a| a * a).sum::<f64>() / d;
            }
        }
        sum
    }

    /// `y += a Aᵀ z`, blocks in order at each unknown.
    ///
    /// # Arguments
    /// * `z`: the rows of these blocks.
    pub fn add_transposed(&self, a: f64, z: &[f64], y: &mut [f64]) {
        if self.len() == 0 {
            return;
        }
        y.par_iter_mut().with_min_len(GRAIN).enumerate().for_each(|(unknown, slot)| {
            let range = self.use_starts[unknown] as usize..self.use_starts[unknown + 1] as usize;
            let mut sum = 0.0;
            for &place in &self.uses[range] {
                let z = &z[R * self.owners[place as usize] as usize..][..R];
                sum += self.coefficients[place as usize].iter().zip(z).map(|(a, z)| a * z).sum::<f64>();
            }
            *slot += a * sum;
        });
    }

    /// `values += Aᵀ V A` with the metric of the scaling.
    pub fn add_normal(&mut self, scaled: &[Scaled<D>], values: &mut [f64]) {
        if self.len() == 0 {
            return;
        }
        let mut shares = std::mem::take(&mut self.shares);
        // Shares of consecutive blocks are consecutive: cut them at the grain.
        let mut tasks = Vec::with_capacity(self.len() / GRAIN + 1);
        let mut rest = &mut shares[..];
        for begin in (0..self.len()).step_by(GRAIN) {
            let end = (begin + GRAIN).min(self.len());
            let (own, others) = rest.split_at_mut((self.share_starts[end] - self.share_starts[begin]) as usize);
            tasks.push((begin..end, own));
            rest = others;
        }
        tasks.into_par_iter().for_each(|(blocks, out)| {
            let mut out = out.iter_mut();
            for block in blocks {
                let columns = &self.coefficients[self.columns_of(block)];
                let metric = scaled[block].metric_rows::<R>();
                for (last, first) in columns.iter().enumerate() {
                    let mut force = [0.0; R];
                    for (coefficient, row) in first.iter().zip(&metric) {
                        force.iter_mut().zip(row).for_each(|(slot, part)| *slot += coefficient * part);
                    }
                    for (second, slot) in columns[..=last].iter().zip(&mut out) {
                        *slot = second.iter().zip(&force).map(|(a, b)| a * b).sum();
                    }
                }
            }
        });
        values.par_iter_mut().with_min_len(GRAIN).enumerate().for_each(|(slot, value)| {
            let range = self.gather_starts[slot] as usize..self.gather_starts[slot + 1] as usize;
            for &place in &self.gather[range] {
                *value += shares[place as usize];
            }
        });
        self.shares = shares;
    }
}

/// `out := svec(Q X Q)` for a scaled vector x of X.
#[inline]
pub(super) fn two_sided<const D: usize>(q: &Square<D>, x: &[f64], out: &mut [f64]) {
    to_scaled(&product(&product(q, &from_scaled(x)), q), out);
}
