//! Rotations read from deformation gradients, and the mean of rotations.

use super::rest::CHUNK;
use crate::linalg::small::{Square, singular_values};
use crate::mesh::cross;
use rayon::prelude::*;

/// The rotation nearest to every deformation gradient: R of the signed polar decomposition.
///
/// With `F = U diag(σ) Vᵀ`, `R = U diag(1, .., det(U Vᵀ)) Vᵀ`, the sign at the smallest singular value. Where F is not inverted,
/// `sym(RᵀF)` is positive definite, so that a shape without inversions stays feasible with its own rotations.
///
/// # Arguments
/// * `gradients`: F of every element, as [`RestShape::deformation_gradients`](super::RestShape::deformation_gradients) gives them.
///
/// # Cost
/// O(m), in parallel.
///
/// # Source
/// Kovalsky, Aigerman, Basri, Lipman 2014, section 4; Irving, Teran, Fedkiw 2004 (signed singular values).
pub fn nearest_rotations(gradients: &[[[f64; 3]; 3]]) -> Vec<[[f64; 3]; 3]> {
    gradients.par_iter().with_min_len(CHUNK).map(nearest_rotation).collect()
}

/// The rotation nearest to a matrix.
pub(super) fn nearest_rotation(matrix: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    // In 2-D the third axis is that of the plane, whatever the stretches in it.
    if matrix[2] == [0.0, 0.0, 1.0] && matrix[0][2] == 0.0 && matrix[1][2] == 0.0 {
        let (cosine, sine) = (matrix[0][0] + matrix[1][1], matrix[1][0] - matrix[0][1]);
        let size = cosine.hypot(sine);
        let (c, s) = if size > 0.0 { (cosine / size, sine / size) } else { (1.0, 0.0) };
        return [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
    }
    let svd = singular_values::<3>(matrix);
    let mut place = [0, 1, 2];
    place.sort_by(|&a, &b| svd.values[b].total_cmp(&svd.values[a]));
    let [first, second, _] = place;
    if svd.values[first].is_nan() || svd.values[second] <= 1e-14 * svd.values[first] {
        // A line or a point has no nearest rotation.
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    }
    // Both bases are completed to right-handed ones: that puts the sign at the smallest value.
    let column = |of: &Square<3>, j: usize| [of[0][j], of[1][j], of[2][j]];
    let (a, b) = (column(&svd.left, first), column(&svd.left, second));
    let (c, d) = (column(&svd.right, first), column(&svd.right, second));
    let (normal, other) = (cross(a, b), cross(c, d));
    std::array::from_fn(|i| std::array::from_fn(|j| a[i] * c[j] + b[i] * d[j] + normal[i] * other[j]))
}

/// The rotation nearest to the weighted sum of rotations.
///
/// # Arguments
/// * `weights`: one a rotation, not negative.
pub(super) fn mean_rotation(rotations: &[[[f64; 3]; 3]], weights: &[f64]) -> [[f64; 3]; 3] {
    let mut sum = [[0.0; 3]; 3];
    for (rotation, weight) in rotations.iter().zip(weights) {
        for (row, turned) in sum.iter_mut().zip(rotation) {
            row.iter_mut().zip(turned).for_each(|(slot, part)| *slot += weight * part);
        }
    }
    if sum[0][2] == 0.0 && sum[1][2] == 0.0 && sum[2][0] == 0.0 && sum[2][1] == 0.0 {
        sum[2] = [0.0, 0.0, 1.0];
    }
    nearest_rotation(&sum)
}
