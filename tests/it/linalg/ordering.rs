use morsmooth::linalg::{
    CsrMatrix, FactorError, Permutation, SymbolicCholesky, fill_reducing_order, minimum_degree, nested_dissection,
};

use super::grid;

fn assert_permutation(order: &Permutation, size: usize) {
    assert_eq!(order.len(), size);
    // The checked constructor refuses anything else.
    Permutation::new(order.order().to_vec()).unwrap();
}

#[test]
fn every_order_names_each_unknown_once() {
    for (side, dimension) in [(1, 1), (2, 1), (500, 1), (37, 2), (11, 3)] {
        let (matrix, places) = grid(side, dimension);
        assert_permutation(&minimum_degree(&matrix).unwrap(), matrix.rows());
        assert_permutation(&nested_dissection(&matrix, &places).unwrap(), matrix.rows());
    }
}

#[test]
fn dissection_survives_points_that_lie_on_one_another() {
    let (matrix, _) = grid(40, 2);
    let order = nested_dissection(&matrix, &vec![[1.0; 3]; matrix.rows()]).unwrap();
    assert_permutation(&order, matrix.rows());
}

#[test]
fn dissection_fills_no_more_than_minimum_degree_on_large_meshes() {
    // Squared, so that the pattern is the one of a biharmonic energy, whose separators are two layers wide.
    for (side, dimension, room) in [(150, 2, 1.0), (20, 3, 1.0)] {
        let (matrix, places) = grid(side, dimension);
        let squared = matrix.weighted_product(&vec![1.0; matrix.rows()], &matrix);
        let by_degree = SymbolicCholesky::new(&squared, minimum_degree(&squared).unwrap()).unwrap();
        let by_place = SymbolicCholesky::new(&squared, nested_dissection(&squared, &places).unwrap()).unwrap();
        let (degree, place) = (by_degree.factor_flops(), by_place.factor_flops());
        assert!(place <= room * degree, "{dimension}-D: {place:.3e} against {degree:.3e}");
    }
}

#[test]
fn small_problems_are_left_to_minimum_degree() {
    let (matrix, places) = grid(20, 2);
    assert_eq!(fill_reducing_order(&matrix, Some(&places)).unwrap(), minimum_degree(&matrix).unwrap());
}

#[test]
fn what_is_no_permutation_or_no_square_is_refused() {
    assert_eq!(Permutation::new(vec![0, 2, 2]), Err(FactorError::NotAPermutation { index: 2, size: 3 }));
    assert_eq!(Permutation::new(vec![0, 3, 1]), Err(FactorError::NotAPermutation { index: 3, size: 3 }));
    let wide = CsrMatrix::from_triplets(1, 2, &[]).unwrap();
    assert_eq!(minimum_degree(&wide), Err(FactorError::NotSquare { rows: 1, columns: 2 }));
    let (matrix, places) = grid(3, 2);
    assert_eq!(nested_dissection(&matrix, &places[1..]), Err(FactorError::CoordinateCount { expected: 9, found: 8 }));
}
