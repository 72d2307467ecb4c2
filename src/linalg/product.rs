//! Products of sparse matrices, and Laplacian products that keep their digits.

use rayon::prelude::*;

use super::CsrMatrix;

/// Vectors below this length are not worth waking a thread for.
const SHORT: usize = 32_768;

/// Fills each entry of y from its index; in parallel where that pays, with the same bits.
pub(super) fn each_row(y: &mut [f64], value: impl Fn(usize) -> f64 + Sync) {
    if y.len() < SHORT || rayon::current_num_threads() == 1 {
        for (row, slot) in y.iter_mut().enumerate() {
            *slot = value(row);
        }
    } else {
        y.par_iter_mut().with_min_len(4096).enumerate().for_each(|(row, slot)| *slot = value(row));
    }
}

impl CsrMatrix {
    /// `y := A x` for a matrix whose rows sum to zero, by differences: `y_i = sum over j != i of A_ij (x_j - x_i)`.
    ///
    /// Where x varies slowly this keeps the digits that `sum of A_ij x_j` cancels. The diagonal is not read.
    ///
    /// # Arguments
    /// * `x`: n numbers; `y`: n numbers, overwritten. Rows run in parallel, each summed in column order.
    pub fn multiply_differences_into(&self, x: &[f64], y: &mut [f64]) {
        assert_eq!((x.len(), y.len()), (self.columns(), self.rows()), "vectors must fit the matrix");
        each_row(y, |row| {
            let here = x[row];
            let (columns, values) = self.row(row);
            // The diagonal adds A_ii (x_i - x_i) = 0.
            columns.iter().zip(values).map(|(&column, value)| value * (x[column as usize] - here)).sum()
        });
    }

    /// `|A| x` with the entries' absolute values: the size of the addends that a product sums.
    pub fn multiply_absolute_into(&self, x: &[f64], y: &mut [f64]) {
        assert_eq!((x.len(), y.len()), (self.columns(), self.rows()), "vectors must fit the matrix");
        each_row(y, |row| {
            let (columns, values) = self.row(row);
            columns.iter().zip(values).map(|(&column, value)| value.abs() * x[column as usize]).sum()
        });
    }

    /// The matrix `A diag(w) B`; every structural entry is stored, zero or not.
    ///
    /// # Arguments
    /// * `weights`: one number for each column of A, which is each row of B.
    ///
    /// # Cost
    /// O(sum over entries of A of the row lengths of B), plus a sort within each row.
    pub fn weighted_product(&self, weights: &[f64], other: &Self) -> Self {
        assert_eq!((self.columns(), weights.len()), (other.rows(), other.rows()), "factors must fit");
        const CHUNK: usize = 2048;
        // The marks name rows, so they may be reused from chunk to chunk.
        let scratch = || (vec![0.0; other.columns()], vec![u32::MAX; other.columns()]);
        let chunks: Vec<(Vec<u32>, Vec<u32>, Vec<f64>)> = (0..self.rows().div_ceil(CHUNK))
            .into_par_iter()
            .map_init(scratch, |(sums, mark), chunk| {
                let (mut counts, mut indices, mut values) = (Vec::new(), Vec::new(), Vec::new());
                for row in chunk * CHUNK..((chunk + 1) * CHUNK).min(self.rows()) {
                    let begin = indices.len();
                    let (middles, left) = self.row(row);
                    for (&middle, &factor) in middles.iter().zip(left) {
                        let factor = factor * weights[middle as usize];
                        let (columns, right) = other.row(middle as usize);
                        for (&column, &value) in columns.iter().zip(right) {
                            let place = column as usize;
                            if mark[place] != row as u32 {
                                mark[place] = row as u32;
                                sums[place] = 0.0;
                                indices.push(column);
                            }
                            sums[place] += factor * value;
                        }
                    }
                    indices[begin..].sort_unstable();
                    values.extend(indices[begin..].iter().map(|&column: &u32| sums[column as usize]));
                    counts.push((indices.len() - begin) as u32);
                }
                (counts, indices, values)
            })
            .collect();
        let mut offsets = vec![0u32];
        let (mut indices, mut values) = (Vec::new(), Vec::new());
        for (counts, chunk_indices, chunk_values) in chunks {
            for count in counts {
                offsets.push(offsets.last().map_or(0, |&last| last) + count);
            }
            indices.extend(chunk_indices);
            values.extend(chunk_values);
        }
        Self::from_parts(self.rows(), other.columns(), offsets, indices, values)
    }

    /// The union of square patterns, diagonal included, with all values zero.
    pub fn union_of_patterns(size: usize, patterns: &[&Self]) -> Self {
        let mut offsets = Vec::with_capacity(size + 1);
        offsets.push(0u32);
        let mut indices = Vec::new();
        for row in 0..size {
            let begin = indices.len();
            indices.push(row as u32);
            for pattern in patterns {
                indices.extend_from_slice(pattern.row(row).0);
            }
            sort_and_deduplicate(&mut indices, begin);
            offsets.push(indices.len() as u32);
        }
        let values = vec![0.0; indices.len()];
        Self::from_parts(size, size, offsets, indices, values)
    }

    /// A matrix without rows.
    pub fn without_rows(columns: usize) -> Self {
        Self::from_parts(0, columns, vec![0], Vec::new(), Vec::new())
    }
}

/// Sorts what a list holds from a place on, and keeps each number there once.
pub(crate) fn sort_and_deduplicate(indices: &mut Vec<u32>, begin: usize) {
    indices[begin..].sort_unstable();
    let mut end = begin;
    for place in begin..indices.len() {
        if place == begin || indices[place] != indices[end - 1] {
            indices[end] = indices[place];
            end += 1;
        }
    }
    indices.truncate(end);
}
