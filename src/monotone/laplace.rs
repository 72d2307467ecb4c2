//! Laplace's equation with values given at some vertices.

use crate::field::VertexId;
use crate::linalg::CsrMatrix;
use crate::mesh::SimplicialComplex;
use crate::qp::{Engine, Objective, QpError, Term};

/// The function of least Dirichlet energy with some values fixed; isolated vertices get 0.
///
/// # Arguments
/// * `laplacian`: `n x n`, with positive edge weights where the maximum principle is wanted.
/// * `fixed`: `n` entries, at least one in every component.
///
/// # Errors
/// [`QpError`] if a component has no fixed value.
///
/// # Cost
/// One sparse factorisation.
pub(super) fn laplace(
    complex: &SimplicialComplex,
    laplacian: &CsrMatrix,
    fixed: &[Option<f64>],
) -> Result<Vec<f64>, QpError> {
    let n = complex.vertex_count();
    let objective =
        Objective { terms: vec![Term::Matrix(laplacian.clone())], linear: vec![0.0; n], constant: 0.0 };
    let fixed: Vec<Option<f64>> = fixed
        .iter()
        .enumerate()
        .map(|(vertex, &value)| match complex.neighbours(VertexId::from(vertex)).is_empty() {
            true => Some(0.0),
            false => value,
        })
        .collect();
    let mut engine = Engine::new(&objective, None, Some(complex.points()))?;
    Ok(engine.minimise(&objective, &fixed)?.x)
}
