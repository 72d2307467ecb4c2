//! Factors of indefinite matrices.

use morsmooth::linalg::{CsrMatrix, FactorError, Lblt, SymbolicCholesky, minimum_degree, nested_dissection};
use proptest::prelude::*;

use super::{grid, values_of};

/// `[H L; L -M]` with the unknowns of a vertex side by side, y before x, and their places.
fn saddle(side: usize, dimension: usize) -> (CsrMatrix, Vec<[f64; 3]>) {
    let (laplacian, places) = grid(side, dimension);
    let mut triplets = Vec::new();
    for row in 0..laplacian.rows() {
        let (columns, values) = laplacian.row(row);
        for (&column, &value) in columns.iter().zip(values) {
            // The identity that the grid adds is taken off again: a singular L.
            let value = if column as usize == row { value - 1.0 } else { value };
            let (y, x) = (2 * row as u32, 2 * column + 1);
            triplets.extend([(y, x, value), (x, y, value)]);
        }
        let y = 2 * row as u32;
        triplets.extend([(y, y, -1.0), (y + 1, y + 1, 1e-3)]);
    }
    let n = 2 * laplacian.rows();
    let places = places.iter().flat_map(|&place| [place, place]).collect();
    (CsrMatrix::from_triplets(n, n, &triplets).unwrap(), places)
}

fn solve(matrix: &CsrMatrix, symbolic: &SymbolicCholesky, sides: &[f64], columns: usize) -> Vec<f64> {
    let mut factor = Lblt::new(symbolic, columns);
    factor.factor(symbolic, &values_of(symbolic, matrix)).unwrap();
    let mut x = sides.to_vec();
    factor.solve_in_place(symbolic, &mut x);
    x
}

/// Largest residual over the largest right-hand side.
fn residual(matrix: &CsrMatrix, x: &[f64], sides: &[f64]) -> f64 {
    let n = matrix.rows();
    let of_one = |(x, b): (&[f64], &[f64])| {
        let size = b.iter().fold(0.0, |most: f64, b| most.max(b.abs()));
        matrix.multiply(x).iter().zip(b).fold(0.0, |most: f64, (y, b)| most.max((y - b).abs())) / size
    };
    x.chunks(n).zip(sides.chunks(n)).map(of_one).fold(0.0, f64::max)
}

#[test]
fn saddle_systems_solve_with_the_same_bits_on_one_and_two_threads() {
    for (side, dimension) in [(7, 2), (120, 2), (15, 3)] {
        let (matrix, places) = saddle(side, dimension);
        let n = matrix.rows();
        let symbolic = SymbolicCholesky::new(&matrix, nested_dissection(&matrix, &places).unwrap()).unwrap();
        let sides: Vec<f64> = (0..3 * n).map(|i| (i as f64 * 0.61).sin()).collect();
        let in_pool = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| (solve(&matrix, &symbolic, &sides, 4), solve(&matrix, &symbolic, &sides[..n], 1)))
        };
        let one = in_pool(1);
        // The solutions grow to a thousand times the sides, times the growth that restricted pivoting allows.
        assert!(residual(&matrix, &one.0, &sides) < 1e-8, "{}", residual(&matrix, &one.0, &sides));
        assert!(residual(&matrix, &one.1, &sides[..n]) < 1e-8);
        assert!(in_pool(2) == one);
    }
}

#[test]
fn a_zero_diagonal_needs_pivots_of_two() {
    let matrix = CsrMatrix::from_triplets(2, 2, &[(0, 1, 2.0), (1, 0, 2.0)]).unwrap();
    let symbolic = SymbolicCholesky::new(&matrix, minimum_degree(&matrix).unwrap()).unwrap();
    assert_eq!(solve(&matrix, &symbolic, &[2.0, 6.0], 1), [3.0, 1.0]);
}

#[test]
fn singular_matrices_are_refused_by_name() {
    let matrix = CsrMatrix::from_triplets(3, 3, &[(0, 0, 1.0), (2, 2, -1.0)]).unwrap();
    let symbolic = SymbolicCholesky::new(&matrix, minimum_degree(&matrix).unwrap()).unwrap();
    let failed = Lblt::new(&symbolic, 1).factor(&symbolic, &values_of(&symbolic, &matrix));
    assert!(matches!(failed, Err(FactorError::SingularPivot { unknown: 1 } | FactorError::OutsidePattern { .. })), "{failed:?}");
    let spoilt = vec![f64::NAN; symbolic.entries()];
    assert!(matches!(Lblt::new(&symbolic, 1).factor(&symbolic, &spoilt), Err(FactorError::SingularPivot { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Dominant diagonals of either sign: stable under any order.
    #[test]
    fn random_signs_solve(n in 1usize..100, pairs in proptest::collection::vec((0usize..100, 0usize..100, -1.0f64..1.0), 0..300), count in 1usize..6) {
        let sign = |i: usize| if i.is_multiple_of(3) { -1.0 } else { 1.0 };
        let mut triplets: Vec<(u32, u32, f64)> = (0..n as u32).map(|i| (i, i, 0.5 * sign(i as usize))).collect();
        for (i, j, value) in pairs {
            let (i, j) = (i % n, j % n);
            let (a, b) = (i as u32, j as u32);
            if a != b {
                triplets.extend([(a, b, value), (b, a, value), (a, a, sign(i) * value.abs()), (b, b, sign(j) * value.abs())]);
            }
        }
        let matrix = CsrMatrix::from_triplets(n, n, &triplets).unwrap();
        let symbolic = SymbolicCholesky::new(&matrix, minimum_degree(&matrix).unwrap()).unwrap();
        let sides: Vec<f64> = (0..n * count).map(|i| (i as f64 * 0.61).sin() + 1.5).collect();
        prop_assert!(residual(&matrix, &solve(&matrix, &symbolic, &sides, 8), &sides) < 1e-11);
    }
}

#[test]
fn pivots_within_one_supernode_keep_all_digits() {
    // Full matrices without a diagonal to lean on: one supernode, so that every pivot may be sought everywhere.
    for n in [3usize, 8, 30, 120] {
        let mut triplets = Vec::new();
        for i in 0..n {
            for j in 0..n {
                let (low, high) = (i.min(j) as f64, i.max(j) as f64);
                let value = if i == j && i % 3 != 0 { 0.0 } else { (low * 12.9898 + high * 78.233).sin() * 10f64.powi((i + j) as i32 % 4) };
                triplets.push((i as u32, j as u32, value));
            }
        }
        let matrix = CsrMatrix::from_triplets(n, n, &triplets).unwrap();
        let symbolic = SymbolicCholesky::new(&matrix, minimum_degree(&matrix).unwrap()).unwrap();
        let sides: Vec<f64> = (0..2 * n).map(|i| (i as f64 * 0.61).sin()).collect();
        let found = residual(&matrix, &solve(&matrix, &symbolic, &sides, 2), &sides);
        assert!(found < 1e-9, "{n}: {found:e}");
    }
}

#[test]
fn nothing_of_the_last_matrix_is_left_in_the_next_factor() {
    // The first needs pivots of two everywhere, the second none.
    let matrix = |diagonal: f64| {
        let mut triplets = Vec::new();
        for i in 0..40u32 {
            triplets.push((i, i, diagonal));
            for j in [i + 1, i + 2] {
                if j < 40 {
                    triplets.extend([(i, j, 1.0 + f64::from(i)), (j, i, 1.0 + f64::from(i))]);
                }
            }
        }
        CsrMatrix::from_triplets(40, 40, &triplets).unwrap()
    };
    let symbolic = SymbolicCholesky::new(&matrix(1.0), minimum_degree(&matrix(1.0)).unwrap()).unwrap();
    let mut factor = Lblt::new(&symbolic, 1);
    let sides: Vec<f64> = (0..40).map(|i| (i as f64 * 0.61).sin()).collect();
    for diagonal in [0.0, 1e3, 0.0, -1e3] {
        let matrix = matrix(diagonal);
        factor.factor(&symbolic, &values_of(&symbolic, &matrix)).unwrap();
        let mut x = sides.clone();
        factor.solve_in_place(&symbolic, &mut x);
        assert!(residual(&matrix, &x, &sides) < 1e-9);
    }
}
