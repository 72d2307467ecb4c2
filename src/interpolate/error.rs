//! Why there is no function with the given values.

use crate::field::{FieldError, VertexId};
use crate::linalg::MatrixError;
use crate::mesh::MeshError;
use crate::monotone::RepresentativeError;
use crate::operators::OperatorError;
use crate::qp::QpError;

/// Why boundary values were refused, or a function with them could not be found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InterpolateError {
    /// The order is not 1, 2, 3 or 4.
    #[error("order {found}; expected 1, 2, 3 or 4")]
    Order {
        /// The order asked for.
        found: usize,
    },
    /// A vertex belongs to no simplex, so that nothing determines its value.
    #[error("vertex {vertex} belongs to no simplex; expected every vertex to be a corner of one: leave it out of the mesh")]
    Unreferenced {
        /// The first such vertex.
        vertex: VertexId,
    },
    /// A boundary value stands at a vertex that does not exist.
    #[error("a value is given at vertex {vertex}; expected less than {vertices}")]
    VertexOutOfRange {
        /// The vertex.
        vertex: VertexId,
        /// Number of vertices.
        vertices: usize,
    },
    /// A boundary value is NaN or infinite.
    #[error("the value given at vertex {vertex} is {value}; expected a finite number")]
    NotFinite {
        /// The vertex.
        vertex: VertexId,
        /// The value.
        value: f64,
    },
    /// A vertex is given two different values.
    #[error("vertex {vertex} is given the values {first:?} and {second:?}; expected one value a vertex")]
    TwoValues {
        /// The vertex.
        vertex: VertexId,
        /// The lower value.
        first: f64,
        /// The higher value.
        second: f64,
    },
    /// A connected part of the mesh has no boundary value.
    #[error("the connected part of {vertices} vertices around vertex {vertex} has no value; expected one in every part")]
    PartWithoutValue {
        /// The lowest vertex of the part.
        vertex: VertexId,
        /// Number of its vertices.
        vertices: usize,
    },
    /// A boundary value lies outside the bounds.
    #[error("the value {value:?} given at vertex {vertex} is outside the bounds {low:?} to {high:?}")]
    OutsideBounds {
        /// The vertex.
        vertex: VertexId,
        /// Its value.
        value: f64,
        /// The lower bound.
        low: f64,
        /// The upper bound.
        high: f64,
    },
    /// A part of the mesh in which every function has an extremum of its own.
    #[error(
        "the {vertices} vertices around vertex {vertex} hang on the rest at one vertex, so that every function has an extremum there; \
         expected a value among them"
    )]
    Pinched {
        /// The lowest vertex of the part.
        vertex: VertexId,
        /// Number of its vertices.
        vertices: usize,
    },
    /// Two given values contradict the order that the wanted extrema leave.
    #[error(
        "the values at vertex {low} ({low_value:?}) and vertex {high} ({high_value:?}) contradict each other: the first must stay below \
         the second"
    )]
    Contradiction {
        /// The vertex that must be lower.
        low: VertexId,
        /// The value asked there.
        low_value: f64,
        /// The vertex that must be higher.
        high: VertexId,
        /// The value asked there.
        high_value: f64,
    },
    /// Fewer numbers of the stored width lie between two given values than vertices in a row.
    #[error("no strictly monotone function fits at vertex {vertex}; expected more distance between the given values")]
    NotRepresentable {
        /// The vertex without a value left.
        vertex: VertexId,
    },
    /// The residual, measured in product form, is too large to call the result the minimiser.
    #[error("order {order} is beyond double precision on this mesh: the residual is {residual:.1e}; expected at most {tolerance:.0e}")]
    Inaccurate {
        /// The order.
        order: usize,
        /// Largest gradient at a free vertex, relative to the largest force.
        residual: f64,
        /// What is accepted.
        tolerance: f64,
    },
    /// Nothing bounds a function from one side, so that it has no scale.
    #[error("no {kind} of the connected part around vertex {vertex} has a value; expected a value or an interval for one of them")]
    NoScale {
        /// `minimum` or `maximum`.
        kind: &'static str,
        /// The lowest vertex of the part.
        vertex: VertexId,
    },
    /// What the function is to stay close to, or how close, is out of range.
    #[error("the {what} at {place} is {value}; expected {expected}")]
    Nearness {
        /// `data`, `confidence` or `length`.
        what: &'static str,
        /// The first such vertex; 0 for the length.
        place: usize,
        /// What was found.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// No field has exactly the wanted extrema, or none was found.
    #[error(transparent)]
    Representative(#[from] RepresentativeError),
    /// The coupled problem is too large.
    #[error(
        "all {handles} handles in one problem need a factor of {entries} numbers; expected at most {limit}: \
         use fewer handles or a coarser mesh, or normalise afterwards"
    )]
    TooLarge {
        /// Number of handles.
        handles: usize,
        /// Entries of the factor.
        entries: usize,
        /// Most entries that are tried.
        limit: usize,
    },
    /// The boundary values of the handles do not sum to one at a vertex.
    #[error("the values of the handles sum to {sum:?} at vertex {vertex}; expected 1 for a partition of unity")]
    NoPartition {
        /// The vertex.
        vertex: VertexId,
        /// The sum found.
        sum: f64,
    },
    /// Lists of weights, handles or vertices do not fit together.
    #[error("{found} {what}; expected {expected}")]
    Count {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// The operators could not be assembled.
    #[error(transparent)]
    Operator(#[from] OperatorError),
    /// A value is not finite.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// The mesh with merged vertices could not be built.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A matrix could not be built.
    #[error(transparent)]
    Matrix(#[from] MatrixError),
    /// The solver refused the problem.
    #[error("the problem could not be solved: {0}")]
    Solver(#[from] QpError),
}

/// Largest componentwise backward error, measured in product form, at which a function is called the minimiser.
const RESIDUAL: f64 = 1e-8;

/// The residual of an accurate result.
///
/// # Errors
/// [`InterpolateError::Inaccurate`].
pub(super) fn accepted(order: usize, residual: f64) -> Result<f64, InterpolateError> {
    if residual <= RESIDUAL { Ok(residual) } else { Err(InterpolateError::Inaccurate { order, residual, tolerance: RESIDUAL }) }
}
