//! What can be wrong with a mesh, where it is, and what became of it.

/// Whether a fault stands in the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Severity {
    /// The computation goes on and the guarantees hold; the message says what was done.
    Handled,
    /// Nothing can be computed on this domain; the message says what to change.
    Refused,
}

/// One thing wrong with a mesh, with its place in the user's numbering of points and cells.
///
/// Faults of the shape (edges, faces, vertices, simplices, coordinates) come one a place. Faults that a whole file can
/// be full of come once, with a `count` and the first place.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshFault {
    /// A used point has a coordinate that is NaN or infinite. Refused.
    #[error("point {point} lies at {coordinates:?}; every coordinate must be finite: mask the point or repair it")]
    NonFiniteCoordinates {
        /// The point.
        point: u32,
        /// Its coordinates.
        coordinates: [f64; 3],
    },
    /// A simplex has no length, area or volume. Refused.
    #[error(
        "cell {cell} holds a simplex of zero measure on points {points:?} (measure / longest edge^d = {ratio:e}); \
         mask the cell, or move or merge its points"
    )]
    ZeroMeasure {
        /// The cell.
        cell: u32,
        /// The points of the simplex.
        points: Vec<u32>,
        /// Measure over the longest edge to the power of the dimension; see
        /// [`ZERO_MEASURE`](super::ZERO_MEASURE).
        ratio: f64,
    },
    /// An edge of a surface with more than two triangles. Handled.
    #[error("edge between points {} and {} has {triangles} triangles; kept: extrema and energy count every one of them",
        points[0], points[1])]
    NonManifoldEdge {
        /// The ends of the edge.
        points: [u32; 2],
        /// Triangles at the edge.
        triangles: usize,
    },
    /// A triangle of a volume with more than two tetrahedra. Handled.
    #[error("triangle on points {points:?} has {tetrahedra} tetrahedra; kept: extrema and energy count every one of them")]
    NonManifoldFace {
        /// The corners of the triangle.
        points: [u32; 3],
        /// Tetrahedra at the triangle.
        tetrahedra: usize,
    },
    /// A vertex around which the mesh is no line, disc or ball, nor half of one. Handled.
    ///
    /// Ends of non-manifold edges and corners of non-manifold faces are not listed again.
    #[error("the mesh is pinched or branches at point {point} ({sheets} sheets meet there); kept as it is")]
    NonManifoldVertex {
        /// The point.
        point: u32,
        /// Parts of the star that do not hang together through edges (dimension 2) or triangles (3) at the point; lines at it in
        /// dimension 1. A single sheet in dimension 3 is pinched along an edge or wound round a hole.
        sheets: usize,
    },
    /// Neighbouring simplices that disagree on which side is up. Handled.
    #[error(
        "{count} pairs of neighbouring cells are oriented against each other, first cells {} and {}; \
         kept: nothing computed here depends on the orientation", first[0], first[1]
    )]
    InconsistentOrientation {
        /// Pairs of neighbouring simplices that disagree.
        count: usize,
        /// The cells of the first pair.
        first: [u32; 2],
    },
    /// Different points at the same place. Handled.
    #[error(
        "{count} points lie exactly on an earlier point, first point {second} on point {first}; \
         kept apart: the domain is cut there, merge them if that is not meant"
    )]
    DuplicatePoints {
        /// Points that lie on an earlier one.
        count: usize,
        /// The earlier point of the first such pair.
        first: u32,
        /// The later point of the first such pair.
        second: u32,
    },
    /// Cells that are there twice. Handled.
    #[error("{count} cells repeat simplices of earlier cells, first cell {second} those of cell {first}; used once")]
    DuplicateCells {
        /// Cells of which at least one simplex was left out.
        count: usize,
        /// The earlier cell of the first such pair.
        first: u32,
        /// The later cell of the first such pair.
        second: u32,
    },
    /// Cells that name a point twice, or have too few points for their shape. Handled.
    #[error(
        "{count} cells are collapsed (a point named twice, or too few points), first cell {first}; \
         the simplices with distinct points are used, the others left out"
    )]
    CollapsedCells {
        /// Number of such cells.
        count: usize,
        /// The first.
        first: u32,
    },
    /// Polygons whose outline crosses itself. Handled.
    #[error("{count} polygons cross themselves, first cell {first}; split by a fan, so their triangles overlap")]
    TangledPolygons {
        /// Number of such cells.
        count: usize,
        /// The first.
        first: u32,
    },
    /// Cells of a lower dimension than the domain. Handled.
    #[error(
        "{count} cells of dimension below {dimension}, first cell {first}, stand beside cells of dimension {dimension}; \
         left out of the computation"
    )]
    LowerDimensionalCells {
        /// Number of such cells.
        count: usize,
        /// The first.
        first: u32,
        /// Dimension of the domain.
        dimension: usize,
    },
    /// Points of no cell at all. Handled.
    #[error("{count} points belong to no cell, first point {first}; left out, they keep their value")]
    UnreferencedPoints {
        /// Number of such points.
        count: usize,
        /// The first.
        first: u32,
    },
    /// Points that the mask keeps, but none of whose simplices survived. Handled.
    #[error("{count} unmasked points have no simplex left around them, first point {first}; left out, they keep their value")]
    IsolatedPoints {
        /// Number of such points.
        count: usize,
        /// The first.
        first: u32,
    },
}

impl MeshFault {
    /// Whether the fault was handled or the domain must be refused.
    pub const fn severity(&self) -> Severity {
        match self {
            Self::NonFiniteCoordinates { .. } | Self::ZeroMeasure { .. } => Severity::Refused,
            _ => Severity::Handled,
        }
    }
}
