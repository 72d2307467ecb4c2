use morsmooth::linalg::CsrMatrix;

#[test]
fn weighted_products_agree_with_dense_ones() {
    let a = CsrMatrix::from_triplets(2, 3, &[(0, 0, 1.0), (0, 2, 2.0), (1, 1, -3.0)]).unwrap();
    let b = CsrMatrix::from_triplets(3, 2, &[(0, 1, 5.0), (1, 0, 7.0), (2, 1, 1.0)]).unwrap();
    let product = a.weighted_product(&[1.0, 10.0, 100.0], &b);
    // Row 0: 1 * 1 * 5 + 2 * 100 * 1; row 1: -3 * 10 * 7.
    assert_eq!((product.get(0, 1), product.get(1, 0), product.entries()), (205.0, -210.0, 2));
}

#[test]
fn products_by_differences_kill_constants_exactly() {
    // Weights that no sum cancels exactly.
    let w = [0.1, 0.7, 1.3];
    let mut triplets = Vec::new();
    for (i, w) in w.into_iter().enumerate() {
        let (a, b) = (i as u32, i as u32 + 1);
        triplets.extend([(a, b, -w), (b, a, -w), (a, a, w), (b, b, w)]);
    }
    let laplacian = CsrMatrix::from_triplets(4, 4, &triplets).unwrap();
    let mut image = [1.0; 4];
    laplacian.multiply_differences_into(&[0.1; 4], &mut image);
    assert_eq!(image, [0.0; 4]);
    let x = [1.0, 2.0, -1.0, 0.5];
    laplacian.multiply_differences_into(&x, &mut image);
    assert!(image.iter().zip(laplacian.multiply(&x)).all(|(y, z)| (y - z).abs() < 1e-15 * 16.0));
}

#[test]
fn unions_of_patterns_hold_the_diagonal_and_every_entry_once() {
    let a = CsrMatrix::from_triplets(3, 3, &[(0, 1, 1.0), (1, 0, 1.0)]).unwrap();
    let b = CsrMatrix::from_triplets(3, 3, &[(0, 1, 1.0), (2, 0, 1.0)]).unwrap();
    let union = CsrMatrix::union_of_patterns(3, &[&a, &b]);
    assert_eq!((union.row(0).0, union.row(1).0, union.row(2).0), (&[0, 1][..], &[0, 1][..], &[0, 2][..]));
}
