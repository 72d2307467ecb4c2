//! The rotation of every element, blended from the rotations of the handles.

use super::DeformError;
use super::rest::CHUNK;
use super::weights::{Weights, side, sign};
use crate::linalg::small::Square;
use crate::mesh::{Pose, Rotation, SimplicialComplex};
use rayon::prelude::*;

/// The rotation of every element from the rotations of the handles and the weights of its corners.
///
/// The weight of a handle in an element is the mean of its weights at the corners, these divided by their sum. If all rotations are
/// about the z axis, angles are blended, `theta_i = sum_h w_h theta_h`: turns beyond 180 degrees count as given. Otherwise
/// quaternions are, `q_i = sum_h ± w_h q_h` scaled to length 1, each with the sign that brings it to the side of the handle with the
/// greatest weight, so that q and -q blend alike. Two handles half a turn apart have two equally short ways; the quaternions as
/// given then decide.
///
/// # Arguments
/// * `complex`: `n` vertices, `m` elements.
/// * `weights`: `n x h`, vertex by vertex; rows need not sum to 1.
/// * `pose`: `h` transforms, of which the rotations are read.
///
/// # Returns
/// One rotation an element, by rows; for a planar mesh with all rotations about z the third axis stays.
///
/// # Errors
/// [`DeformError::Length`]; [`DeformError::Number`] for numbers that are not finite and weights without a positive sum.
///
/// # Cost
/// O(m h), in parallel; the same bits for any number of threads.
///
/// # Source
/// Liu, Gao, Zhu, Sifakis, Kavan 2016, section 3, on rotations from handles; Kavan, Collins, Žára, O'Sullivan 2008 on signs.
pub fn blend(complex: &SimplicialComplex, weights: &[f64], pose: &Pose) -> Result<Vec<Square<3>>, DeformError> {
    let weights = Weights::new(weights, complex.vertex_count(), pose)?;
    let handles = pose.transforms.len();
    let angles = planar_angles(pose);
    let quaternions: Vec<[f64; 4]> = pose.transforms.iter().map(|transform| transform.rotation.quaternion()).collect();
    let elements = (0..complex.simplex_count()).into_par_iter().with_min_len(CHUNK);
    let blended = elements.map_init(
        || vec![0.0; handles],
        |row, element| {
            weights.mean(complex.simplex(element), row);
            match &angles {
                Some(angles) => Rotation::Angle(row.iter().zip(angles).map(|(weight, angle)| weight * angle).sum()),
                None => blend_quaternions(row, &quaternions),
            }
            .matrix()
        },
    );
    Ok(blended.collect())
}

/// The angles of all handles, if all turn about the z axis.
pub(super) fn planar_angles(pose: &Pose) -> Option<Vec<f64>> {
    pose.transforms.iter().map(|transform| transform.rotation.planar_angle()).collect()
}

fn blend_quaternions(row: &[f64], quaternions: &[[f64; 4]]) -> Rotation {
    let weights = || row.iter().copied().enumerate();
    let reference = side(weights(), quaternions).unwrap_or([1.0, 0.0, 0.0, 0.0]);
    let mut sum = [0.0; 4];
    for (handle, weight) in weights() {
        let quaternion = quaternions[handle];
        let weight = weight * sign(reference, quaternion);
        for (slot, part) in sum.iter_mut().zip(quaternion) {
            *slot += weight * part;
        }
    }
    // Negative weights can cancel the sum; the strongest handle is then as good as any.
    let length = sum.iter().map(|part| part * part).sum::<f64>().sqrt();
    Rotation::Quaternion(if length > f64::EPSILON { sum } else { reference })
}
