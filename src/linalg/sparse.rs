//! Compressed sparse rows.

/// Why lists of numbers are not a sparse matrix, or why two do not fit together.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MatrixError {
    /// An entry lies outside the matrix.
    #[error("entry at row {row}, column {column} lies outside a {rows} x {columns} matrix")]
    OutOfRange {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// Rows of the matrix.
        rows: usize,
        /// Columns of the matrix.
        columns: usize,
    },
}

/// A sparse `rows x columns` matrix, stored by rows; columns rise strictly within a row.
#[derive(Debug, Clone, PartialEq)]
pub struct CsrMatrix {
    rows: usize,
    columns: usize,
    offsets: Vec<u32>,
    indices: Vec<u32>,
    values: Vec<f64>,
}

impl CsrMatrix {
    /// Sums triplets `(row, column, value)` into a matrix; duplicates are added in the order given.
    ///
    /// # Errors
    /// [`MatrixError::OutOfRange`] for an entry outside the matrix.
    ///
    /// # Cost
    /// O(t + rows) for t triplets, plus a sort within each row.
    pub fn from_triplets(rows: usize, columns: usize, triplets: &[(u32, u32, f64)]) -> Result<Self, MatrixError> {
        let mut starts = vec![0u32; rows + 1];
        for &(row, column, _) in triplets {
            if row as usize >= rows || column as usize >= columns {
                return Err(MatrixError::OutOfRange { row: row as usize, column: column as usize, rows, columns });
            }
            starts[row as usize + 1] += 1;
        }
        for row in 0..rows {
            starts[row + 1] += starts[row];
        }
        let mut next = starts.clone();
        let mut entries = vec![(0u32, 0.0f64); triplets.len()];
        for &(row, column, value) in triplets {
            let slot = &mut next[row as usize];
            entries[*slot as usize] = (column, value);
            *slot += 1;
        }
        let mut offsets = Vec::with_capacity(rows + 1);
        let mut indices: Vec<u32> = Vec::with_capacity(triplets.len());
        let mut values: Vec<f64> = Vec::with_capacity(triplets.len());
        offsets.push(0);
        for row in 0..rows {
            let slice = &mut entries[starts[row] as usize..starts[row + 1] as usize];
            // Stable, so that equal columns are summed in the order given: same input, same bits.
            slice.sort_by_key(|&(column, _)| column);
            let begin = indices.len();
            for &(column, value) in slice.iter() {
                if indices.len() > begin && indices.last() == Some(&column) {
                    *values.last_mut().expect("a value for every index") += value;
                } else {
                    indices.push(column);
                    values.push(value);
                }
            }
            offsets.push(indices.len() as u32);
        }
        Ok(Self { rows, columns, offsets, indices, values })
    }

    /// Wraps arrays that are known to be in order.
    pub(crate) fn from_parts(rows: usize, columns: usize, offsets: Vec<u32>, indices: Vec<u32>, values: Vec<f64>) -> Self {
        debug_assert_eq!((offsets.len(), indices.len()), (rows + 1, values.len()));
        Self { rows, columns, offsets, indices, values }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of stored entries.
    pub fn entries(&self) -> usize {
        self.values.len()
    }

    /// Columns and values of a row; columns rise.
    pub fn row(&self, row: usize) -> (&[u32], &[f64]) {
        let range = self.offsets[row] as usize..self.offsets[row + 1] as usize;
        (&self.indices[range.clone()], &self.values[range])
    }

    /// Value at (`row`, `column`), zero where nothing is stored.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        let (columns, values) = self.row(row);
        columns.binary_search(&(column as u32)).map_or(0.0, |position| values[position])
    }

    /// `y := A x`.
    ///
    /// # Arguments
    /// * `x`: `columns` numbers; `y`: `rows` numbers, overwritten. Rows run in parallel, each summed in column order,
    ///   so the bits do not depend on the number of threads.
    pub fn multiply_into(&self, x: &[f64], y: &mut [f64]) {
        assert_eq!((x.len(), y.len()), (self.columns, self.rows), "vectors must fit the matrix");
        super::product::each_row(y, |row| {
            let (columns, values) = self.row(row);
            columns.iter().zip(values).map(|(&column, value)| value * x[column as usize]).sum()
        });
    }

    /// `A x` in a new vector.
    pub fn multiply(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.rows];
        self.multiply_into(x, &mut y);
        y
    }

    /// The transpose.
    pub fn transpose(&self) -> Self {
        let mut offsets = vec![0u32; self.columns + 1];
        for &column in &self.indices {
            offsets[column as usize + 1] += 1;
        }
        for column in 0..self.columns {
            offsets[column + 1] += offsets[column];
        }
        let mut next = offsets.clone();
        let mut indices = vec![0; self.indices.len()];
        let mut values = vec![0.0; self.values.len()];
        for row in 0..self.rows {
            let (columns, row_values) = self.row(row);
            for (&column, &value) in columns.iter().zip(row_values) {
                let slot = &mut next[column as usize];
                indices[*slot as usize] = row as u32;
                values[*slot as usize] = value;
                *slot += 1;
            }
        }
        Self { rows: self.columns, columns: self.rows, offsets, indices, values }
    }
}
