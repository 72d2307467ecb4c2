//! Gradients of linear functions on simplices, and their averages at vertices.

use super::OperatorError;
use super::error::{check_field, check_measures};
use crate::field::VertexId;
use crate::mesh::{SimplicialComplex, cross, dot, minus};
use rayon::prelude::*;

/// Simplices or vertices handled by one parallel task. Any size gives the same result.
pub(super) const CHUNK: usize = 4096;

/// The gradient of a piecewise linear function on every top simplex.
///
/// On curves and surfaces in space it lies in the simplex.
///
/// # Arguments
/// * `complex`: `n` vertices, `m` top simplices, any dimension.
/// * `values`: `n` values, one a vertex.
///
/// # Returns
/// `m x 3`, in `[value / length]`.
///
/// # Errors
/// [`OperatorError::LengthMismatch`], [`OperatorError::NonFinite`], [`OperatorError::ZeroMeasure`].
///
/// # Cost
/// O(m), in parallel.
pub fn gradients(complex: &SimplicialComplex, values: &[f64]) -> Result<Vec<[f64; 3]>, OperatorError> {
    check_field(complex, values.iter().map(|&value| [value]))?;
    check_measures(complex)?;
    let simplices = (0..complex.simplex_count()).into_par_iter().with_min_len(CHUNK);
    Ok(simplices.map(|simplex| combine(&dual_basis(complex, simplex), complex.simplex(simplex), values)).collect())
}

/// The gradient of a piecewise linear function at every vertex: the average over the simplices there, weighted by measure.
///
/// Exact for linear functions on a flat domain; else of first order, of second order inside regular grids.
///
/// # Arguments, Errors, Cost
/// As for [`gradients`].
///
/// # Returns
/// `n x 3`, in `[value / length]`; zero at a vertex without simplices.
pub fn vertex_gradients(complex: &SimplicialComplex, values: &[f64]) -> Result<Vec<[f64; 3]>, OperatorError> {
    check_field(complex, values.iter().map(|&value| [value]))?;
    check_measures(complex)?;
    let measures = measures(complex);
    let gradient = |basis: &[[f64; 3]; 3], corners: &[u32]| [combine(basis, corners, values)];
    let average = |vertex: usize| vertex_average(complex, &measures, vertex, gradient)[0];
    Ok((0..complex.vertex_count()).into_par_iter().with_min_len(CHUNK).map(average).collect())
}

/// The measure of every top simplex.
pub(super) fn measures(complex: &SimplicialComplex) -> Vec<f64> {
    let simplices = (0..complex.simplex_count()).into_par_iter().with_min_len(CHUNK);
    simplices.map(|simplex| complex.measure(simplex)).collect()
}

/// The average of gradients over the simplices at a vertex, weighted by measure.
pub(super) fn vertex_average<const N: usize>(
    complex: &SimplicialComplex,
    measures: &[f64],
    vertex: usize,
    gradients: impl Fn(&[[f64; 3]; 3], &[u32]) -> [[f64; 3]; N],
) -> [[f64; 3]; N] {
    let star = complex.star(VertexId::from(vertex));
    let total: f64 = star.iter().map(|&simplex| measures[simplex as usize]).sum();
    let mut average = [[0.0; 3]; N];
    for &simplex in star {
        let simplex = simplex as usize;
        // A weight of at most 1 cannot overflow, whatever the unit of length.
        let weight = measures[simplex] / total;
        let gradients = gradients(&dual_basis(complex, simplex), complex.simplex(simplex));
        for (sum, gradient) in average.iter_mut().zip(gradients) {
            for (slot, part) in sum.iter_mut().zip(gradient) {
                *slot += weight * part;
            }
        }
    }
    average
}

/// Gradients of the barycentric coordinates of corners 1 to d of a simplex; the rest is zero.
pub(crate) fn dual_basis(complex: &SimplicialComplex, simplex: usize) -> [[f64; 3]; 3] {
    let corners = complex.simplex(simplex);
    let side = |corner: usize| minus(complex.points()[corners[corner] as usize], complex.points()[corners[0] as usize]);
    let over = |vector: [f64; 3], divisor: f64| vector.map(|part| part / divisor);
    const ZERO: [f64; 3] = [0.0; 3];
    match complex.dimension() {
        1 => [over(side(1), dot(side(1), side(1))), ZERO, ZERO],
        2 => {
            let (a, b) = (side(1), side(2));
            let normal = cross(a, b);
            let square = dot(normal, normal);
            [over(cross(b, normal), square), over(cross(normal, a), square), ZERO]
        }
        _ => {
            let (a, b, c) = (side(1), side(2), side(3));
            let determinant = dot(cross(a, b), c);
            [over(cross(b, c), determinant), over(cross(c, a), determinant), over(cross(a, b), determinant)]
        }
    }
}

/// The gradient of the function with these values at the corners.
pub(super) fn combine(basis: &[[f64; 3]; 3], corners: &[u32], values: &[f64]) -> [f64; 3] {
    let mut gradient = [0.0; 3];
    for (dual, &corner) in basis.iter().zip(&corners[1..]) {
        let rise = values[corner as usize] - values[corners[0] as usize];
        for (slot, part) in gradient.iter_mut().zip(dual) {
            *slot += rise * part;
        }
    }
    gradient
}
