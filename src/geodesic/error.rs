//! Why a distance cannot be computed.

use crate::field::VertexId;
use crate::linalg::{FactorError, MatrixError};
use crate::operators::OperatorError;

/// Why a distance cannot be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeodesicError {
    /// Exact distances are defined here on surfaces only.
    #[error("a complex of dimension {found}; expected triangles (dimension 2) for exact distances")]
    Dimension {
        /// Dimension of the complex.
        found: usize,
    },
    /// More than two triangles share an edge, so that a straight line across it has no continuation.
    #[error("the edge {}-{} has {triangles} triangles; expected at most 2 for exact distances", vertices[0].0, vertices[1].0)]
    NonManifoldEdge {
        /// Its ends, the lower first.
        vertices: [VertexId; 2],
        /// How many triangles it has.
        triangles: usize,
    },
    /// More sides of triangles than 31-bit numbers can name.
    #[error("{found} triangles; at most {most} can be handled")]
    TooLarge {
        /// How many there are.
        found: usize,
        /// How many there may be.
        most: usize,
    },
    /// No source.
    #[error("found no source; expected at least one")]
    NoSource,
    /// A source vertex that does not exist.
    #[error("source {source_number} is vertex {}; expected less than {vertices}", vertex.0)]
    SourceVertex {
        /// Place in the list of sources.
        source_number: usize,
        /// The vertex.
        vertex: VertexId,
        /// Number of vertices.
        vertices: usize,
    },
    /// A source vertex without any triangle or tetrahedron.
    #[error("source {source_number} is vertex {}, which is in no simplex; expected a vertex of the mesh", vertex.0)]
    IsolatedSource {
        /// Place in the list of sources.
        source_number: usize,
        /// The vertex.
        vertex: VertexId,
    },
    /// A source on an edge or in a face that does not exist.
    #[error("source {source_number} lies on {what} {found}; expected less than {count}")]
    SourceCell {
        /// Place in the list of sources.
        source_number: usize,
        /// `edge` or `face`.
        what: &'static str,
        /// The number given.
        found: usize,
        /// How many there are.
        count: usize,
    },
    /// The weights of a source are not the coordinates of a point of its edge or face.
    #[error("source {source_number} has the weights {weights:?}; expected numbers not below 0 with sum 1")]
    SourceWeights {
        /// Place in the list of sources.
        source_number: usize,
        /// The weights given.
        weights: Vec<f64>,
    },
    /// A curve has a part that leaves the surface.
    #[error("the points {first} and {} of the curve lie in no common triangle; expected a curve on the surface", first + 1)]
    CurveOffSurface {
        /// Place of the first of the two points.
        first: usize,
    },
    /// A length, tolerance or coefficient is not positive and finite.
    #[error("the {what} is {found}; expected a positive finite number")]
    Number {
        /// What it is.
        what: &'static str,
        /// Its value.
        found: f64,
    },
    /// So little heat arrives somewhere that its direction is lost.
    #[error("no heat arrives at vertex {}; expected some everywhere: take a longer time or the exact method", vertex.0)]
    HeatVanished {
        /// The first such vertex.
        vertex: VertexId,
    },
    /// A triangle or tetrahedron has no area or volume, or the operators of the heat method could not be built.
    #[error(transparent)]
    Operator(#[from] OperatorError),
    /// A matrix of the heat method could not be built.
    #[error(transparent)]
    Matrix(#[from] MatrixError),
    /// A matrix of the heat method could not be factored.
    #[error(transparent)]
    Factor(#[from] FactorError),
}
