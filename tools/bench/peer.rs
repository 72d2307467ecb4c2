//! The same problem in the crate `clarabel`, with the product formed.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SupportedConeT, ZeroConeT};
use morsmooth::linalg::CsrMatrix;
use morsmooth::qp::{Problem, Term};

/// Iterations, seconds and the energy of the point found, by the engine's product form.
pub fn clarabel(problem: &Problem) -> (u32, f64, f64) {
    let n = problem.fixed.len();
    let mut triplets = Vec::new();
    for term in &problem.objective.terms {
        match term {
            Term::Matrix(matrix) => push(&mut triplets, matrix, 1.0),
            Term::Diagonal(diagonal) => triplets.extend(diagonal.iter().enumerate().map(|(i, &d)| (i as u32, i as u32, d))),
            Term::Chain { scale, stiffness, weights, order } => {
                let mut product = stiffness.clone();
                for _ in 1..*order {
                    product = stiffness.weighted_product(weights, &product);
                }
                push(&mut triplets, &product, *scale);
            }
        }
    }
    let quadratic = CsrMatrix::from_triplets(n, n, &triplets).unwrap();
    // Fixed unknowns as zero-cone rows, then -A x + s = b with s >= 0.
    let mut rows = Vec::new();
    let mut right = Vec::new();
    for (i, value) in problem.fixed.iter().enumerate() {
        if let Some(value) = value {
            rows.push((right.len() as u32, i as u32, 1.0));
            right.push(*value);
        }
    }
    let equalities = right.len();
    for (row, &offset) in problem.constraints.offset.iter().enumerate() {
        let (columns, values) = problem.constraints.matrix.row(row);
        rows.extend(columns.iter().zip(values).map(|(&column, &value)| (right.len() as u32, column, -value)));
        right.push(offset);
    }
    let matrix = CsrMatrix::from_triplets(right.len(), n, &rows).unwrap();
    let cones: [SupportedConeT<f64>; 2] = [ZeroConeT(equalities), NonnegativeConeT(right.len() - equalities)];
    let settings = DefaultSettingsBuilder::default().verbose(false).tol_gap_abs(1e-14).max_threads(1u32).build().unwrap();
    let clock = std::time::Instant::now();
    let mut solver =
        DefaultSolver::new(&columns_of(&quadratic, true), &problem.objective.linear, &columns_of(&matrix, false), &right, &cones, settings)
            .unwrap();
    solver.solve();
    let seconds = clock.elapsed().as_secs_f64();
    (solver.solution.iterations, seconds, problem.objective.value(&solver.solution.x))
}

/// The lower triangle mirrored into the upper one.
fn push(triplets: &mut Vec<(u32, u32, f64)>, matrix: &CsrMatrix, scale: f64) {
    for row in 0..matrix.rows() {
        let (columns, values) = matrix.row(row);
        triplets.extend(columns.iter().zip(values).map(|(&column, &value)| (row as u32, column, scale * value)));
    }
}

fn columns_of(matrix: &CsrMatrix, upper: bool) -> CscMatrix<f64> {
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
