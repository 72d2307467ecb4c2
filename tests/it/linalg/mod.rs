//! Orderings, factorisations and products of sparse matrices.

mod cholesky;
mod ordering;
mod product;
mod small;

use morsmooth::linalg::CsrMatrix;

/// The graph Laplacian of a `side^dimension` grid plus the identity, and its places.
pub fn grid(side: usize, dimension: usize) -> (CsrMatrix, Vec<[f64; 3]>) {
    let n = side.pow(dimension as u32);
    let mut triplets = Vec::new();
    let mut places = Vec::new();
    for i in 0..n {
        places.push(std::array::from_fn(|axis| if axis < dimension { (i / side.pow(axis as u32) % side) as f64 } else { 0.0 }));
        triplets.push((i as u32, i as u32, 1.0));
        for axis in 0..dimension {
            let stride = side.pow(axis as u32);
            if i / stride % side + 1 < side {
                let (a, b) = (i as u32, (i + stride) as u32);
                triplets.extend([(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)]);
            }
        }
    }
    (CsrMatrix::from_triplets(n, n, &triplets).unwrap(), places)
}
