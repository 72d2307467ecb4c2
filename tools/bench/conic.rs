//! A problem of ours in the arrays that the crate `clarabel` takes, every product formed.

use clarabel::algebra::CscMatrix;
use morsmooth::linalg::CsrMatrix;
use morsmooth::qp::{Problem, Term};

/// P, the sum of the terms.
pub fn quadratic(problem: &Problem) -> CsrMatrix {
    let n = problem.fixed.len();
    let mut triplets = Vec::new();
    let mut push = |matrix: &CsrMatrix, scale: f64| {
        for row in 0..matrix.rows() {
            let (columns, values) = matrix.row(row);
            triplets.extend(columns.iter().zip(values).map(|(&column, &value)| (row as u32, column, scale * value)));
        }
    };
    for term in &problem.objective.terms {
        match term {
            Term::Matrix(matrix) => push(matrix, 1.0),
            Term::Diagonal(diagonal) => {
                let entries: Vec<(u32, u32, f64)> = diagonal.iter().enumerate().map(|(i, &d)| (i as u32, i as u32, d)).collect();
                push(&CsrMatrix::from_triplets(n, n, &entries).unwrap(), 1.0);
            }
            Term::Chain { scale, stiffness, weights, order } => {
                let mut product = stiffness.clone();
                for _ in 1..*order {
                    product = stiffness.weighted_product(weights, &product);
                }
                push(&product, *scale);
            }
        }
    }
    CsrMatrix::from_triplets(n, n, &triplets).unwrap()
}

/// Rows of `A x + s = b`: the fixed unknowns for the zero cone first, then those that are pushed.
pub struct Rows {
    /// Rows of the zero cone.
    pub equalities: usize,
    /// b.
    pub right: Vec<f64>,
    triplets: Vec<(u32, u32, f64)>,
}

impl Rows {
    pub fn of_fixed(problem: &Problem) -> Self {
        let (mut triplets, mut right) = (Vec::new(), Vec::new());
        for (unknown, value) in problem.fixed.iter().enumerate() {
            if let Some(value) = value {
                triplets.push((right.len() as u32, unknown as u32, 1.0));
                right.push(*value);
            }
        }
        Self { equalities: right.len(), right, triplets }
    }

    /// `-a x + s = b` for a sum of rows `a x + b` of the problem, each with its factor.
    pub fn push(&mut self, problem: &Problem, parts: &[(usize, f64)]) {
        let at = self.right.len() as u32;
        let mut offset = 0.0;
        for &(row, factor) in parts {
            let (columns, values) = problem.constraints.matrix.row(row);
            self.triplets.extend(columns.iter().zip(values).map(|(&column, &value)| (at, column, -factor * value)));
            offset += factor * problem.constraints.offset[row];
        }
        self.right.push(offset);
    }

    /// A.
    pub fn matrix(&self, unknowns: usize) -> CsrMatrix {
        CsrMatrix::from_triplets(self.right.len(), unknowns, &self.triplets).unwrap()
    }
}

/// By columns; of a symmetric matrix the upper triangle.
pub fn columns_of(matrix: &CsrMatrix, upper: bool) -> CscMatrix<f64> {
    let by_columns = matrix.transpose();
    let (mut starts, mut indices, mut values) = (vec![0], Vec::new(), Vec::new());
    for column in 0..by_columns.rows() {
        let (rows, entries) = by_columns.row(column);
        for (&row, &value) in rows.iter().zip(entries) {
            if !upper || row as usize <= column {
                indices.push(row as usize);
                values.push(value);
            }
        }
        starts.push(indices.len());
    }
    CscMatrix::new(matrix.rows(), matrix.columns(), starts, indices, values)
}
