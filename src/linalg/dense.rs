//! Small dense systems.

use faer::linalg::solvers::{Lblt, SolveCore};
use faer::{Conj, Mat, MatMut, Side};

/// Solves a dense symmetric system, definite or not.
///
/// # Arguments
/// * `entry`: the entry at a row and a column, asked for at and below the diagonal only.
/// * `side`: the right-hand side, overwritten with the solution; infinite or NaN where the matrix is singular.
///
/// # Cost
/// n³/3 multiplications and additions.
///
/// # Source
/// Bunch and Kaufman 1977, through `faer`.
pub fn solve_symmetric(entry: impl Fn(usize, usize) -> f64, side: &mut [f64]) {
    let n = side.len();
    let matrix = Mat::from_fn(n, n, |row, column| if row >= column { entry(row, column) } else { 0.0 });
    let factor = Lblt::new(matrix.as_ref(), Side::Lower);
    factor.solve_in_place_with_conj(Conj::No, MatMut::from_column_major_slice_mut(side, n, 1));
}
