//! Why points and cells are not a domain.

use super::{CellShape, MeshError};

/// Why points and cells are not a domain.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DomainError {
    /// No simplex is left.
    #[error(
        "the domain is empty: {points} points, {cells} cells, of which the mask removes {masked_points} points and \
         {masked_cells} cells, and no line, triangle or tetrahedron is left"
    )]
    Empty {
        /// Points of the input.
        points: usize,
        /// Cells of the input.
        cells: usize,
        /// Points that the mask removes.
        masked_points: usize,
        /// Cells that the mask removes.
        masked_cells: usize,
    },
    /// A mask does not fit the points or cells.
    #[error("the mask has {found} flags for {expected} {what}")]
    MaskLength {
        /// "points" or "cells".
        what: &'static str,
        /// Number of points or cells.
        expected: usize,
        /// Number of flags.
        found: usize,
    },
    /// The offsets of a cell list do not cut its connectivity into cells.
    #[error("cell offsets are inconsistent at cell {cell}: {found}; expected {expected}")]
    Offsets {
        /// The first cell whose end is wrong.
        cell: usize,
        /// What was found, in words.
        found: String,
        /// What was expected, in words.
        expected: String,
    },
    /// A cell names a point that does not exist.
    #[error("cell {cell} names point {point}; expected less than {points}")]
    PointOutOfRange {
        /// The cell.
        cell: usize,
        /// The point that it names.
        point: u32,
        /// Number of points.
        points: usize,
    },
    /// A cell of a fixed shape has another number of corners.
    #[error("cell {cell} ({shape:?}) has {found} corners; expected {expected}")]
    CornerCount {
        /// The cell.
        cell: usize,
        /// Its shape.
        shape: CellShape,
        /// Corners that the shape has.
        expected: usize,
        /// Corners that the cell has.
        found: usize,
    },
    /// A cell has a shape without a subdivision.
    #[error(
        "cell {cell} has VTK type {vtk_type}; expected a linear cell (types 1 to 14): tetrahedralise or linearise it, or mask it"
    )]
    UnsupportedCell {
        /// The first such cell.
        cell: usize,
        /// Its VTK cell type.
        vtk_type: u8,
    },
    /// A used point has a coordinate that is NaN or infinite.
    #[error("point {point} lies at {coordinates:?}; expected finite coordinates: mask the point or repair it")]
    NonFinitePoint {
        /// The first such point.
        point: u32,
        /// Its coordinates.
        coordinates: [f64; 3],
    },
    /// The geometry of a grid does not fit its dimensions.
    #[error("the geometry of the grid has {found} points along axis {axis} (3: in all); expected {expected}")]
    GridShape {
        /// Axis 0, 1 or 2; 3 for the list of all points.
        axis: usize,
        /// Points by `dims`.
        expected: usize,
        /// Points by the geometry.
        found: i64,
    },
    /// The complex could not be built; in practice, more vertices or corners than 32-bit numbers can name.
    #[error(transparent)]
    Complex(#[from] MeshError),
}
