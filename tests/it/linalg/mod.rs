//! Orderings, factorisations and products of sparse matrices.

mod cholesky;
mod compliance;
mod factors;
mod indefinite;
mod ordering;
mod product;
mod small;

use morsmooth::linalg::{CsrMatrix, SymbolicCholesky};

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

/// The matrix times itself: the pattern of a biharmonic energy.
pub fn squared(matrix: &CsrMatrix) -> CsrMatrix {
    matrix.weighted_product(&vec![1.0; matrix.rows()], matrix)
}

/// The values of a symmetric matrix in the places of an analysed pattern.
pub fn values_of(symbolic: &SymbolicCholesky, matrix: &CsrMatrix) -> Vec<f64> {
    let mut values = vec![0.0; symbolic.entries()];
    for row in 0..matrix.rows() {
        let (columns, entries) = matrix.row(row);
        for (&column, &entry) in columns.iter().zip(entries) {
            if symbolic.is_stored(row, column as usize) {
                values[symbolic.slot(row, column as usize).unwrap() as usize] = entry;
            }
        }
    }
    values
}
