//! The domain of a computation: the user's points and cells, masked and subdivided into one simplicial complex.

use super::{CellList, DomainError, Grid, MeshFault, SimplicialComplex, build};
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

/// A simplicial complex made from the user's points and cells, and the way back.
///
/// Vertices are the points of surviving top simplices, in the order of the points. All other points (masked,
/// unreferenced, isolated) are no part of the domain and keep their value in an output.
///
/// Invariants: `point_of_vertex` rises strictly and inverts `vertex_of_point`; there is one cell number a simplex.
#[derive(Debug, Clone)]
pub struct Domain {
    /// The complex.
    pub complex: SimplicialComplex,
    /// What was found and handled while the domain was made.
    pub notes: Vec<MeshFault>,
    pub(super) vertex_of_point: Vec<Option<VertexId>>,
    pub(super) point_of_vertex: Vec<u32>,
    pub(super) cell_of_simplex: Vec<u32>,
}

impl Domain {
    /// Masks and subdivides cells.
    ///
    /// The dimension of the domain is that of the highest cells that the cell mask keeps; lower ones are left out. Polygons
    /// and quads are cut into triangles by a fan from their smallest point number, or by ears where the fan does not
    /// fit; voxels, hexahedra, wedges and pyramids into tetrahedra, with every quadrilateral face cut at its smallest point
    /// number, so that neighbours agree. Simplices that are there twice are used once. The result depends only on the input.
    ///
    /// # Arguments
    /// * `points`: `n x 3` positions, in the units of the file.
    /// * `cells`: point numbers below `n`.
    /// * `mask`: flags for points and cells.
    ///
    /// # Errors
    /// [`DomainError`] with the first cell or point that cannot be used.
    ///
    /// # Cost
    /// O(m) for m simplices of bounded stars, in parallel.
    ///
    /// # Source
    /// Dompierre, Labbé, Vallet, Camarero 1999, *How to subdivide pyramids, prisms and hexahedra into tetrahedra*.
    ///
    /// # Example
    /// ```
    /// use morsmooth::mesh::{CellList, CellShape, Domain, Mask};
    /// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [9.0, 9.0, 9.0]];
    /// let cells = CellList::uniform(CellShape::Quad, 4, &[0, 1, 2, 3]);
    /// let domain = Domain::from_cells(&points, &cells, &Mask::none())?;
    /// assert_eq!(domain.complex.simplices(), [0, 1, 2, 0, 2, 3]);
    /// assert_eq!(domain.vertex_of_point()[4], None); // of no cell
    /// assert_eq!(domain.notes.len(), 1); // says so
    /// # Ok::<(), morsmooth::mesh::DomainError>(())
    /// ```
    pub fn from_cells(points: &[[f64; 3]], cells: &CellList, mask: &Mask) -> Result<Self, DomainError> {
        build::from_cells(points, cells, mask)
    }

    /// Masks and subdivides a structured grid: a polyline, triangles or tetrahedra, by the number of axes that are not
    /// flat.
    ///
    /// Freudenthal subdivision: every square is cut along (i, j)–(i+1, j+1), every cube into the six tetrahedra around
    /// (i, j, k)–(i+1, j+1, k+1). Cells are numbered as VTK numbers them, the first axis fastest.
    ///
    /// # Errors
    /// [`DomainError`] if grid and mask do not fit, if nothing is left, or with the first point that cannot be used.
    ///
    /// # Cost
    /// O(n), in parallel.
    ///
    /// # Source
    /// Freudenthal 1942; Kuhn 1960.
    ///
    /// # Example
    /// ```
    /// use morsmooth::mesh::{Domain, Grid, Mask};
    /// let grid = Grid::image([3, 1, 2], [0.0; 3], [1.0; 3]); // in the x–z plane
    /// let domain = Domain::from_grid(&grid, &Mask::none())?;
    /// assert_eq!(domain.complex.simplex_count(), 4);
    /// # Ok::<(), morsmooth::mesh::DomainError>(())
    /// ```
    pub fn from_grid(grid: &Grid, mask: &Mask) -> Result<Self, DomainError> {
        build::from_grid(grid, mask)
    }

    /// A complex as the domain of its own points and simplices; vertices without simplices are left out, with a note.
    ///
    /// # Errors
    /// [`DomainError::Empty`] without simplices, [`DomainError::NonFinitePoint`].
    ///
    /// # Cost
    /// O(m), in parallel.
    pub fn from_complex(complex: &SimplicialComplex) -> Result<Self, DomainError> {
        build::from_complex(complex)
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
