//! Why an operator cannot be built.

use super::Derived;
use crate::field::VertexId;
use crate::mesh::{SimplicialComplex, ZERO_MEASURE};

/// Why an operator cannot be built on a complex, or not be applied to a field.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OperatorError {
    /// A simplex has no length, area or volume.
    ///
    /// [`Domain::points_of`](crate::mesh::Domain::points_of) gives the points of the vertices, for a message.
    #[error(
        "simplex {simplex} on vertices {} has zero measure: measure / longest edge^d is {ratio:e}; \
         expected at least {ZERO_MEASURE:e}",
        vertices.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
    )]
    ZeroMeasure {
        /// The first such top simplex.
        simplex: usize,
        /// Its vertices.
        vertices: Vec<VertexId>,
        /// Measure over longest edge to the power of the dimension.
        ratio: f64,
    },
    /// Coordinates so large or small that a product of them leaves the range of numbers.
    #[error("{quantity} at vertex {vertex} is {value}; expected a finite, positive sum: rescale the coordinates")]
    Scale {
        /// "edge weight" or "lumped mass".
        quantity: &'static str,
        /// The first such vertex.
        vertex: VertexId,
        /// The value found.
        value: f64,
    },
    /// A field and the mesh disagree on the number of vertices.
    #[error("field has {found} values for {expected} vertices")]
    LengthMismatch {
        /// Number of vertices.
        expected: usize,
        /// Number of values.
        found: usize,
    },
    /// A component of a field is NaN or infinite.
    #[error("component {component} of the field at vertex {vertex} is {value}; expected a finite number: mask the point")]
    NonFinite {
        /// The first such vertex.
        vertex: VertexId,
        /// The first such component.
        component: usize,
        /// The value found.
        value: f64,
    },
    /// A derived quantity does not exist on this kind of domain.
    #[error("{derived} of a vector field is not defined on this domain: found {found}; expected {expected}")]
    Undefined {
        /// The quantity.
        derived: Derived,
        /// What the domain is, in words.
        found: &'static str,
        /// What it should be, in words.
        expected: &'static str,
    },
}

/// Refuses a complex with a simplex of zero measure.
pub(super) fn check_measures(complex: &SimplicialComplex) -> Result<(), OperatorError> {
    match complex.first_zero_measure() {
        Some((simplex, ratio)) => {
            let vertices = complex.simplex(simplex).iter().map(|&vertex| VertexId(vertex)).collect();
            Err(OperatorError::ZeroMeasure { simplex, vertices, ratio })
        }
        None => Ok(()),
    }
}

/// Refuses a field of another length, or with a component that is not finite.
pub(super) fn check_field<const N: usize>(
    complex: &SimplicialComplex,
    field: impl ExactSizeIterator<Item = [f64; N]>,
) -> Result<(), OperatorError> {
    if field.len() != complex.vertex_count() {
        return Err(OperatorError::LengthMismatch { expected: complex.vertex_count(), found: field.len() });
    }
    for (vertex, parts) in field.enumerate() {
        if let Some(component) = parts.iter().position(|part| !part.is_finite()) {
            return Err(OperatorError::NonFinite { vertex: vertex.into(), component, value: parts[component] });
        }
    }
    Ok(())
}
