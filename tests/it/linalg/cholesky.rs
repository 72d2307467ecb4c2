use morsmooth::linalg::{Cholesky, CsrMatrix, FactorError, Permutation, SymbolicCholesky, minimum_degree, nested_dissection};

use super::{grid, values_of};

#[test]
fn solutions_satisfy_the_system_under_every_order() {
    let (matrix, places) = grid(30, 2);
    let n = matrix.rows();
    let orders = [
        Permutation::identity(n),
        Permutation::new((0..n as u32).rev().collect()).unwrap(),
        minimum_degree(&matrix).unwrap(),
        nested_dissection(&matrix, &places).unwrap(),
    ];
    let known: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
    for order in orders {
        let symbolic = SymbolicCholesky::new(&matrix, order).unwrap();
        let mut factor = Cholesky::new(&symbolic, 1);
        factor.factor(&symbolic, &values_of(&symbolic, &matrix)).unwrap();
        let mut x = matrix.multiply(&known);
        factor.solve_in_place(&symbolic, &mut x);
        // The matrix is the identity plus a Laplacian with norm at most 8: condition 9.
        assert!(x.iter().zip(&known).all(|(x, y)| (x - y).abs() < 1e-13));
    }
}

#[test]
fn one_analysis_serves_many_matrices_and_sides() {
    let (matrix, _) = grid(17, 2);
    let n = matrix.rows();
    let symbolic = SymbolicCholesky::new(&matrix, minimum_degree(&matrix).unwrap()).unwrap();
    let mut factor = Cholesky::new(&symbolic, 4);
    let values = values_of(&symbolic, &matrix);
    for scale in [1.0, 1e8, 1e-8] {
        let scaled: Vec<f64> = values.iter().map(|value| scale * value).collect();
        factor.factor(&symbolic, &scaled).unwrap();
        // Eleven sides: two full blocks of four and a rest of three.
        let mut sides: Vec<f64> = (0..11 * n).map(|i| scale * (i as f64 * 0.7).cos()).collect();
        let wanted = sides.clone();
        factor.solve_in_place(&symbolic, &mut sides);
        for (x, b) in sides.chunks(n).zip(wanted.chunks(n)) {
            let image = matrix.multiply(x);
            assert!(image.iter().zip(b).all(|(y, b)| (scale * y - b).abs() < 1e-13 * scale));
        }
    }
}

#[test]
fn a_failed_pivot_names_its_unknown() {
    let matrix = CsrMatrix::from_triplets(3, 3, &[(0, 0, 2.0), (1, 1, -1.0), (2, 2, 3.0)]).unwrap();
    let symbolic = SymbolicCholesky::new(&matrix, Permutation::new(vec![2, 0, 1]).unwrap()).unwrap();
    let mut factor = Cholesky::new(&symbolic, 1);
    let failed = factor.factor(&symbolic, &values_of(&symbolic, &matrix));
    assert_eq!(failed, Err(FactorError::NonPositivePivot { unknown: 1 }));
}

#[test]
fn entries_outside_the_pattern_are_refused() {
    let (matrix, _) = grid(4, 1);
    let symbolic = SymbolicCholesky::new(&matrix, Permutation::identity(4)).unwrap();
    assert_eq!(symbolic.slot(0, 3), Err(FactorError::OutsidePattern { row: 0, column: 3 }));
    assert_eq!(symbolic.slot(0, 1), symbolic.slot(1, 0));
}

#[test]
fn empty_and_single_systems() {
    let none = CsrMatrix::from_triplets(0, 0, &[]).unwrap();
    let symbolic = SymbolicCholesky::new(&none, Permutation::identity(0)).unwrap();
    let mut factor = Cholesky::new(&symbolic, 1);
    factor.factor(&symbolic, &[]).unwrap();
    factor.solve_in_place(&symbolic, &mut []);

    let one = CsrMatrix::from_triplets(1, 1, &[(0, 0, 4.0)]).unwrap();
    let symbolic = SymbolicCholesky::new(&one, Permutation::identity(1)).unwrap();
    let mut factor = Cholesky::new(&symbolic, 1);
    factor.factor(&symbolic, &[4.0]).unwrap();
    let mut x = [2.0];
    factor.solve_in_place(&symbolic, &mut x);
    assert_eq!(x, [0.5]);
}
