//! The lumped mass.
//!
//! Literature: Meyer, Desbrun, Schröder, Barr 2003, *Discrete differential-geometry operators for triangulated 2-manifolds*.

use super::OperatorError;
use super::error::check_measures;
use super::gradient::{CHUNK, measures};
use crate::field::VertexId;
use crate::mesh::{SimplicialComplex, cross, dot, minus, norm};
use rayon::prelude::*;

/// The barycentric lumped mass: every simplex gives each of its corners an equal share of its measure.
///
/// # Arguments
/// * `complex`: `n` vertices, any dimension.
///
/// # Returns
/// `n` lengths, areas or volumes in `[length^d]`, positive but for vertices without simplices, which have 0. They sum
/// to the measure of the mesh.
///
/// # Errors
/// [`OperatorError::ZeroMeasure`], [`OperatorError::Scale`].
///
/// # Cost
/// O(m), in parallel.
pub fn lumped_mass(complex: &SimplicialComplex) -> Result<Vec<f64>, OperatorError> {
    check_measures(complex)?;
    let measures = measures(complex);
    let share = (complex.dimension() + 1) as f64;
    summed(complex, |vertex| complex.star(vertex).iter().map(|&simplex| measures[simplex as usize]).sum::<f64>() / share)
}

/// The mixed Voronoi mass of triangles: each corner has what lies nearest to it, or, in a triangle with an obtuse angle, half of it at
/// that angle and a quarter at the others. In other dimensions the [`lumped_mass`].
///
/// # Arguments, Returns, Errors, Cost
/// As for [`lumped_mass`].
///
/// # Source
/// Meyer, Desbrun, Schröder, Barr 2003, section 3.3.
pub fn mixed_voronoi_mass(complex: &SimplicialComplex) -> Result<Vec<f64>, OperatorError> {
    if complex.dimension() != 2 {
        return lumped_mass(complex);
    }
    check_measures(complex)?;
    summed(complex, |vertex| complex.star(vertex).iter().map(|&simplex| voronoi_share(complex, simplex as usize, vertex)).sum())
}

/// Area that a corner of a triangle has of it.
fn voronoi_share(complex: &SimplicialComplex, triangle: usize, vertex: VertexId) -> f64 {
    let corners = complex.simplex(triangle);
    let own = corners.iter().position(|&corner| corner == vertex.0).unwrap_or(0);
    let [p, q, r] = [0, 1, 2].map(|step| complex.points()[corners[(own + step) % 3] as usize]);
    let (pq, pr, qr) = (minus(q, p), minus(r, p), minus(r, q));
    let doubled = norm(cross(pq, pr));
    // Dot products at the corners: not positive at an angle that is not acute.
    let (at_p, at_q, at_r) = (dot(pq, pr), -dot(pq, qr), dot(pr, qr));
    if at_p <= 0.0 {
        0.25 * doubled
    } else if at_q <= 0.0 || at_r <= 0.0 {
        0.125 * doubled
    } else {
        // |pq|² cot r + |pr|² cot q, an eighth of it.
        (dot(pq, pq) * at_r + dot(pr, pr) * at_q) / doubled / 8.0
    }
}

/// A mass for every vertex, refused where it is lost to under- or overflow.
fn summed(complex: &SimplicialComplex, mass: impl Fn(VertexId) -> f64 + Sync) -> Result<Vec<f64>, OperatorError> {
    let vertices = (0..complex.vertex_count()).into_par_iter().with_min_len(CHUNK);
    let mass: Vec<f64> = vertices.map(|vertex| mass(vertex.into())).collect();
    let lost = |vertex: &usize| !(mass[*vertex].is_normal() || complex.star((*vertex).into()).is_empty());
    match (0..mass.len()).find(lost) {
        Some(vertex) => Err(OperatorError::Scale { quantity: "lumped mass", vertex: vertex.into(), value: mass[vertex] }),
        None => Ok(mass),
    }
}
