//! Curves on a surface as sources, sampled.

use super::error::GeodesicError;
use super::source::SurfacePoint;
use crate::mesh::{SimplicialComplex, minus, norm};

/// Points along a curve so dense that distances from them are distances from the curve but for a known error.
///
/// Distances from the points exceed those from the curve by at most half the spacing, and are never less. Away from the curve the error falls off: at the
/// distance d from a straight part it is at most about `spacing² / (8 d)`.
///
/// # Arguments
/// * `curve`: its corners; each two that follow each other lie in a common triangle, in which the curve is straight.
/// * `spacing`: greatest distance of neighbouring points, in the units of the mesh.
///
/// # Returns
/// The corners and the points between them, along the curve.
///
/// # Errors
/// [`GeodesicError::Number`] for the spacing, [`GeodesicError::NoSource`] without corners, what is wrong with a corner, and
/// [`GeodesicError::CurveOffSurface`].
///
/// # Cost
/// O(k) for k points returned.
pub fn sample_curve(complex: &SimplicialComplex, curve: &[SurfacePoint], spacing: f64) -> Result<Vec<SurfacePoint>, GeodesicError> {
    if !(spacing.is_finite() && spacing > 0.0) {
        return Err(GeodesicError::Number { what: "spacing of a curve", found: spacing });
    }
    if complex.dimension() != 2 {
        return Err(GeodesicError::Dimension { found: complex.dimension() });
    }
    let corners: Result<Vec<_>, _> = curve.iter().enumerate().map(|(number, point)| point.simplest(complex, number)).collect();
    let corners = corners?;
    let mut points = vec![*corners.first().ok_or(GeodesicError::NoSource)?];
    for (first, pair) in corners.windows(2).enumerate() {
        let here = pair[0].triangles(complex);
        let shared = pair[1].triangles(complex).into_iter().find(|triangle| here.contains(triangle));
        let triangle = shared.ok_or(GeodesicError::CurveOffSurface { first })?;
        let ends = [pair[0], pair[1]].map(|end| end.weights_in(complex, triangle));
        let length = norm(minus(pair[1].position(complex), pair[0].position(complex)));
        let steps = (length / spacing).ceil().max(1.0) as usize;
        for step in 1..steps {
            let share = step as f64 / steps as f64;
            let mut weights = [0.0; 3];
            for (corner, weight) in weights.iter_mut().enumerate() {
                *weight = (1.0 - share) * ends[0][corner] + share * ends[1][corner];
            }
            points.push(SurfacePoint::Face { triangle: triangle as usize, weights });
        }
        points.push(pair[1]);
    }
    Ok(points)
}
