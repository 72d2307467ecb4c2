//! Algebra of 2 x 2 and 3 x 3 matrices against its definitions, also where eigenvalues meet or nearly vanish.

use morsmooth::linalg::small::{
    Square, cholesky, composed, congruence, determinant, from_scaled, identity, inverse, product, scaled_length, singular_values,
    smallest_eigenvalue, square_root, symmetric_eigen, to_scaled, transposed,
};
use proptest::prelude::*;

fn difference<const D: usize>(a: &Square<D>, b: &Square<D>) -> f64 {
    (0..D).flat_map(|i| (0..D).map(move |j| (i, j))).map(|(i, j)| (a[i][j] - b[i][j]).abs()).fold(0.0, f64::max)
}

fn size<const D: usize>(a: &Square<D>) -> f64 {
    difference(a, &[[0.0; D]; D])
}

fn square<const D: usize>(numbers: &[f64]) -> Square<D> {
    std::array::from_fn(|i| std::array::from_fn(|j| numbers[i * D + j]))
}

/// What must hold for any numbers; `exponents` spread the eigenvalues over many decades.
fn laws<const D: usize>(numbers: &[f64], exponents: &[i32]) {
    let g = square::<D>(numbers);
    let symmetric: Square<D> = std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (g[i][j] + g[j][i])));
    let tolerance = 1e-14 * (1.0 + size(&symmetric));

    let (values, vectors) = symmetric_eigen(&symmetric);
    assert!(values.is_sorted());
    assert!(difference(&composed(&values, &vectors), &symmetric) < 4.0 * tolerance);
    assert!(difference(&product(&transposed(&vectors), &vectors), &identity()) < 1e-14);
    assert!((smallest_eigenvalue(&symmetric) - values[0]).abs() < 1e-7 * (1.0 + size(&symmetric)));

    let mut vector = vec![0.0; scaled_length(D)];
    to_scaled(&symmetric, &mut vector);
    assert!(difference(&from_scaled(&vector), &symmetric) < tolerance);
    let trace: f64 = (0..D).map(|i| product(&symmetric, &symmetric)[i][i]).sum();
    assert!((vector.iter().map(|v| v * v).sum::<f64>() - trace).abs() < 1e-13 * (1.0 + trace));

    let svd = singular_values(&g);
    let scaled: Square<D> = std::array::from_fn(|i| std::array::from_fn(|j| svd.left[i][j] * svd.values[j]));
    assert!(difference(&product(&scaled, &transposed(&svd.right)), &g) < 1e-14 * (1.0 + size(&g)));
    assert!((svd.values.iter().product::<f64>() - determinant(&g).abs()).abs() < 1e-13 * (1.0 + size(&g)).powi(3));

    // A definite matrix with known, widely spread eigenvalues.
    let spread: [f64; D] = std::array::from_fn(|i| 10f64.powi(exponents[i]));
    let definite = composed(&spread, &vectors);
    let most = spread.iter().fold(0.0f64, |a, &b| a.max(b));
    let root = square_root(&definite);
    assert!(difference(&product(&root, &root), &definite) < 1e-14 * most);
    if spread.iter().all(|&value| value > 1e-12 * most) {
        let factor = cholesky(&definite).expect("positive definite");
        assert!(difference(&product(&factor, &transposed(&factor)), &definite) < 1e-14 * most);
        let inverted = inverse(&definite).expect("regular");
        let condition = most / spread.iter().fold(f64::INFINITY, |a, &b| a.min(b));
        // Cofactors cancel twice as many digits as the condition number has.
        assert!(difference(&product(&definite, &inverted), &identity()) < 1e-14 * condition * condition + 1e-14);
    }
    // det(S + A) >= det(S) for skew A and S in the cone: why blocks prevent inversions.
    let skew: Square<D> = std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (g[i][j] - g[j][i])));
    let sum: Square<D> = std::array::from_fn(|i| std::array::from_fn(|j| definite[i][j] + skew[i][j]));
    let (with, without) = (determinant(&sum), determinant(&definite));
    assert!(with >= without - 1e-13 * (size(&sum) + most).powi(D as i32), "{with:e} {without:e}");
}

proptest! {
    #[test]
    fn two_by_two(numbers in prop::collection::vec(-3.0..3.0f64, 4), exponents in prop::collection::vec(-9..3i32, 2)) {
        laws::<2>(&numbers, &exponents);
    }

    #[test]
    fn three_by_three(numbers in prop::collection::vec(-3.0..3.0f64, 9), exponents in prop::collection::vec(-9..3i32, 3)) {
        laws::<3>(&numbers, &exponents);
    }
}

#[test]
fn special_matrices() {
    for a in [[[0.0; 3]; 3], identity(), [[1.0; 3]; 3], [[2.0, 1e-300, 0.0], [1e-300, 2.0, 0.0], [0.0, 0.0, -1e200]]] {
        let (values, vectors) = symmetric_eigen(&a);
        assert!(difference(&composed(&values, &vectors), &a) <= 1e-14 * (size(&a) + f64::MIN_POSITIVE));
    }
    assert_eq!(symmetric_eigen(&[[2.0, 0.0], [0.0, 1.0]]).0, [1.0, 2.0]);
    assert_eq!(inverse(&[[1.0, 2.0], [2.0, 4.0]]), None);
    assert_eq!(inverse(&[[0.0, 2.0], [-4.0, 0.0]]), Some([[0.0, -0.25], [0.5, 0.0]]));
    assert_eq!(cholesky(&[[1.0, 2.0], [2.0, 4.0 - 1e-9]]), None);
    assert_eq!(cholesky(&[[f64::NAN, 0.0], [0.0, 1.0]]), None);
    assert_eq!(singular_values(&[[0.0; 2]; 2]).values, [0.0; 2]);
    let turned = congruence(&[[0.0, -1.0], [1.0, 0.0]], &[[1.0, 0.5], [0.5, 3.0]]);
    assert_eq!(turned, [[3.0, -0.5], [-0.5, 1.0]]);
}
