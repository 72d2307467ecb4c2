//! The lumped mass.

use super::OperatorError;
use super::error::check_measures;
use super::gradient::{CHUNK, measures};
use crate::mesh::SimplicialComplex;
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
    let vertices = (0..complex.vertex_count()).into_par_iter().with_min_len(CHUNK);
    let mass: Vec<f64> = vertices
        .map(|vertex| complex.star(vertex.into()).iter().map(|&simplex| measures[simplex as usize]).sum::<f64>() / share)
        .collect();
    let lost = |vertex: &usize| !(mass[*vertex].is_normal() || complex.star((*vertex).into()).is_empty());
    match (0..mass.len()).find(lost) {
        Some(vertex) => Err(OperatorError::Scale { quantity: "lumped mass", vertex: vertex.into(), value: mass[vertex] }),
        None => Ok(mass),
    }
}
