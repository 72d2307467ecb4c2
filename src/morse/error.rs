//! What the module refuses.

use crate::field::VertexId;
use crate::mesh::EdgeId;

use super::pairs::ExtremumKind;

/// Why a discrete gradient cannot be built or changed as asked, or why a choice of extrema cannot be met.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MorseError {
    /// The vertex order is not one of the complex.
    #[error("vertex order of {found} vertices; expected {expected}, as in the complex")]
    OrderLength {
        /// Number of vertices of the complex.
        expected: usize,
        /// Number of vertices of the order.
        found: usize,
    },
    /// The field is not one of the complex.
    #[error("field of {found} values; expected {expected}, one a vertex")]
    ValuesLength {
        /// Number of vertices.
        expected: usize,
        /// Number of values.
        found: usize,
    },
    /// The complex has more cells of one dimension than the gradient can number.
    #[error("{found} cells of dimension {dimension}; expected at most {limit}")]
    TooManyCells {
        /// Dimension of the cells.
        dimension: usize,
        /// Number of such cells.
        found: usize,
        /// The greatest number that is possible.
        limit: usize,
    },
    /// An edge that should be critical is paired.
    #[error("edge {} is paired in the gradient; expected a critical edge", edge.0)]
    NotCritical {
        /// The edge.
        edge: EdgeId,
    },
    /// No V-path, or more than one, leads from a saddle to an extremum, so that the pair cannot be cancelled.
    #[error("{found} V-paths from edge {} to vertex {extremum}; expected exactly one", saddle.0)]
    PathCount {
        /// The critical edge.
        saddle: EdgeId,
        /// The critical vertex.
        extremum: VertexId,
        /// Number of V-paths between them.
        found: usize,
    },
    /// A threshold is negative or not a number.
    #[error("persistence threshold {found}; expected a finite number that is at least 0")]
    Threshold {
        /// The threshold.
        found: f64,
    },
    /// Fewer extrema are asked for than the components of the domain need.
    #[error("{asked} extrema asked for; expected at least {needed}: one minimum and one maximum in each component")]
    TooFew {
        /// Number of extrema asked for.
        asked: usize,
        /// One minimum and one maximum for every component.
        needed: usize,
    },
    /// More extrema are asked for than the field has.
    #[error("{asked} extrema asked for; expected at most {available}, as many as the field has")]
    TooMany {
        /// Number of extrema asked for.
        asked: usize,
        /// Number of extrema of the field.
        available: usize,
    },
    /// A chosen vertex is no extremum of the field.
    #[error("vertex {vertex} is no minimum or maximum of the field; expected extrema only")]
    NotAnExtremum {
        /// The vertex.
        vertex: VertexId,
    },
    /// A choice leaves a component of the domain without a minimum or without a maximum.
    #[error("the component of vertex {component} keeps no {}; expected one at least", kind.name())]
    ComponentWithout {
        /// The kind of which none is kept.
        kind: ExtremumKind,
        /// The component, named by its vertex of lowest index.
        component: VertexId,
    },
    /// The critical cells contradict the Euler characteristic of the complex: a defect of this program.
    #[error("critical cells {counts:?} alternate to {found}; expected the Euler characteristic {expected}")]
    Euler {
        /// Number of critical cells by dimension.
        counts: [usize; 4],
        /// Their alternating sum.
        found: i64,
        /// Alternating sum of all cells.
        expected: i64,
    },
}
