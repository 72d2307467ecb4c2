//! Skinning: positions straight from weights and the transforms of handles, without a guarantee against inversions.

use super::DeformError;
use super::rest::CHUNK;
use super::rotations::planar_angles;
use super::weights::{Weights, dot4, side, sign};
use crate::linalg::small::Square;
use crate::mesh::{HandleTransform, Pose, Rotation};
use rayon::prelude::*;

/// Difference of two angles about z, in degrees, from which on dual quaternions are not asked which way to turn: at 360 degrees their sum
/// vanishes, at 350 it keeps a twentieth of its length.
const WIDEST: f64 = 350.0;

/// Linear blend skinning, `x' = sum_h w_h T_h(x)`.
///
/// Cheap, and it shrinks where rotations differ: half way between 0 and 180 degrees everything lies on the axis.
///
/// # Arguments
/// * `points`: `n` rest positions.
/// * `weights`: `n x h`, vertex by vertex. Rows are divided by their sums, so that a pose that moves all handles alike moves all alike.
/// * `pose`: `h` transforms.
///
/// # Returns
/// `n` positions.
///
/// # Errors
/// [`DeformError::Length`]; [`DeformError::Number`] for numbers that are not finite and weights without a positive sum.
///
/// # Cost
/// O(n h), in parallel; the same bits for any number of threads.
pub fn linear_blend(points: &[[f64; 3]], weights: &[f64], pose: &Pose) -> Result<Vec<[f64; 3]>, DeformError> {
    let weights = Weights::new(weights, points.len(), pose)?;
    let motions: Vec<Motion> = pose.transforms.iter().map(Motion::new).collect();
    let moved = points.par_iter().with_min_len(CHUNK).enumerate().map(|(vertex, &point)| {
        let mut sum = [0.0; 3];
        for (handle, weight) in weights.of(vertex) {
            let place = motions[handle].apply(point);
            (0..3).for_each(|axis| sum[axis] += weight * place[axis]);
        }
        sum
    });
    Ok(moved.collect())
}

/// Dual-quaternion skinning: the blend of rigid motions is a rigid motion, so that joints keep their volume.
///
/// Scale comes first, blended linearly about the pivots; what is left of each handle is rigid, a unit dual quaternion
/// `q + e/2 t q`. Their sum by weights, each with the sign that brings q to the side of the handle with the greatest weight, is
/// divided by the length of its first part. The transform of a vertex on which one handle has all the weight is that of the handle.
///
/// If all handles turn about the z axis, signs are those of the half angles as given, so that turns up to 350 degrees from
/// one handle to another go the way that was asked. Where two angles differ by more no dual quaternion can tell; then the angle is blended, `theta = sum_h w_h theta_h`, and each handle turns about its own pivot:
/// `x' = sum_h w_h (pivot_h + R(theta) (x - pivot_h) + translation_h)`.
///
/// # Arguments, Returns, Errors, Cost
/// As for [`linear_blend`].
///
/// # Source
/// Kavan, Collins, Žára, O'Sullivan 2008, *Geometric skinning with approximate dual quaternion blending*, algorithm 1.
pub fn dual_quaternion(points: &[[f64; 3]], weights: &[f64], pose: &Pose) -> Result<Vec<[f64; 3]>, DeformError> {
    let weights = Weights::new(weights, points.len(), pose)?;
    let angles = planar_angles(pose);
    if let Some(angles) = angles.as_ref().filter(|angles| spread(angles).to_degrees() >= WIDEST) {
        return Ok(turns(points, weights, pose, angles));
    }
    let as_given = angles.is_some();
    let mut transforms = pose.transforms.clone();
    for (transform, &angle) in transforms.iter_mut().zip(angles.iter().flatten()) {
        transform.rotation = Rotation::Angle(angle);
    }
    let duals: Vec<Dual> = transforms.iter().map(Dual::new).collect();
    let quaternions: Vec<[f64; 4]> = duals.iter().map(|dual| dual.real).collect();
    let moved = points.par_iter().with_min_len(CHUNK).enumerate().map(|(vertex, &point)| {
        let reference = side(weights.of(vertex), &quaternions).unwrap_or([1.0, 0.0, 0.0, 0.0]);
        let mut blend = Dual { real: [0.0; 4], dual: [0.0; 4] };
        for (handle, weight) in weights.of(vertex) {
            let factor = if as_given { weight } else { weight * sign(reference, quaternions[handle]) };
            for part in 0..4 {
                blend.real[part] += factor * duals[handle].real[part];
                blend.dual[part] += factor * duals[handle].dual[part];
            }
        }
        blend.apply(scaled(point, weights.of(vertex), &pose.transforms))
    });
    Ok(moved.collect())
}

/// Blending of angles that differ by nearly a turn or more.
fn turns(points: &[[f64; 3]], weights: Weights<'_>, pose: &Pose, angles: &[f64]) -> Vec<[f64; 3]> {
    let moved = points.par_iter().with_min_len(CHUNK).enumerate().map(|(vertex, &point)| {
        let angle = weights.of(vertex).map(|(handle, weight)| weight * angles[handle]).sum();
        let matrix = Rotation::Angle(angle).matrix();
        let mut sum = [0.0; 3];
        for (handle, weight) in weights.of(vertex) {
            let transform = pose.transforms[handle];
            let place = Motion { matrix, transform }.apply(point);
            (0..3).for_each(|axis| sum[axis] += weight * place[axis]);
        }
        sum
    });
    moved.collect()
}

/// Difference of the greatest and the smallest angle.
fn spread(angles: &[f64]) -> f64 {
    let (low, high) = angles.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &angle| (low.min(angle), high.max(angle)));
    high - low
}

/// The point after the scales of the handles, blended linearly.
fn scaled(point: [f64; 3], weights: impl Iterator<Item = (usize, f64)>, transforms: &[HandleTransform]) -> [f64; 3] {
    let mut place = point;
    for (handle, weight) in weights {
        let HandleTransform { scale, pivot, .. } = transforms[handle];
        (0..3).for_each(|axis| place[axis] += weight * (scale - 1.0) * (point[axis] - pivot[axis]));
    }
    place
}

/// A transform with its matrix worked out.
#[derive(Debug, Clone, Copy)]
struct Motion {
    matrix: Square<3>,
    transform: HandleTransform,
}

impl Motion {
    fn new(transform: &HandleTransform) -> Self {
        Self { matrix: transform.rotation.matrix(), transform: *transform }
    }

    fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        let HandleTransform { translation, scale, pivot, .. } = self.transform;
        let offset: [f64; 3] = std::array::from_fn(|axis| point[axis] - pivot[axis]);
        std::array::from_fn(|row| {
            let turned: f64 = (0..3).map(|column| self.matrix[row][column] * offset[column]).sum();
            pivot[row] + scale * turned + translation[row]
        })
    }
}

/// A dual quaternion, each part `[w, x, y, z]`.
#[derive(Debug, Clone, Copy)]
struct Dual {
    real: [f64; 4],
    dual: [f64; 4],
}

impl Dual {
    /// The rigid part of a transform, `x' = R x + t`.
    fn new(transform: &HandleTransform) -> Self {
        let real = transform.rotation.quaternion();
        let rigid = HandleTransform { scale: 1.0, ..*transform };
        let [x, y, z] = rigid.shift();
        let half = times([0.0, x / 2.0, y / 2.0, z / 2.0], real);
        Self { real, dual: half }
    }

    /// Divides by the length of the real part and moves a point.
    fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        let square = dot4(self.real, self.real);
        let [w, x, y, z] = self.real;
        let shift = times(self.dual, [w, -x, -y, -z]);
        let matrix = Rotation::Quaternion(self.real).matrix();
        std::array::from_fn(|row| {
            let turned: f64 = (0..3).map(|column| matrix[row][column] * point[column]).sum();
            turned + 2.0 * shift[row + 1] / square
        })
    }
}

/// The Hamilton product.
fn times([a, b, c, d]: [f64; 4], [e, f, g, h]: [f64; 4]) -> [f64; 4] {
    [
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    ]
}
