//! What an algorithm sees of a triangulation, whether its incidences are stored or computed.

use crate::field::{VertexId, VertexOrder};

use super::{EdgeId, FreudenthalLattice, TriangleId};

/// A cell of a triangulation, by dimension and number.
///
/// Cells of a [`SimplicialComplex`](super::SimplicialComplex) are numbered as its lists are: vertices, edges and triangles,
/// and for dimension 3 the top simplices. Those of an [`ImplicitGrid`](super::ImplicitGrid) have gaps between their
/// numbers and are otherwise in the same order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Cell {
    /// 0, 1, 2 or 3.
    pub dimension: u8,
    /// Place among the cells of this dimension.
    pub index: u32,
}

impl Cell {
    /// A cell of dimension 0.
    pub const fn vertex(vertex: VertexId) -> Self {
        Self { dimension: 0, index: vertex.0 }
    }

    /// A cell of dimension 1.
    pub const fn edge(edge: EdgeId) -> Self {
        Self { dimension: 1, index: edge.0 }
    }

    /// A cell of dimension 2.
    pub const fn triangle(triangle: TriangleId) -> Self {
        Self { dimension: 2, index: triangle.0 }
    }

    /// The highest vertex, the one in whose lower star the cell lies.
    pub fn highest_vertex<T: Triangulation>(self, triangulation: &T, order: &VertexOrder) -> VertexId {
        let corners = triangulation.cell_vertices(self);
        corners[1..].iter().fold(corners[0], |high, &next| if order.is_below(high, next) { next } else { high })
    }
}

/// The vertices of one cell by rising index: one to four, read as a slice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Corners {
    vertices: [VertexId; 4],
    count: u8,
}

impl Corners {
    /// The first `count` of four vertices, sorted.
    pub(super) fn sorted(mut vertices: [VertexId; 4], count: usize) -> Self {
        vertices[..count].sort_unstable();
        Self::rising(vertices, count)
    }

    /// The first `count` of four vertices, which rise.
    pub(super) fn rising(vertices: [VertexId; 4], count: usize) -> Self {
        debug_assert!(vertices[..count].is_sorted());
        Self { vertices, count: count as u8 }
    }
}

impl std::ops::Deref for Corners {
    type Target = [VertexId];

    fn deref(&self) -> &[VertexId] {
        &self.vertices[..self.count as usize]
    }
}

impl IntoIterator for Corners {
    type Item = VertexId;
    type IntoIter = std::iter::Take<std::array::IntoIter<VertexId, 4>>;

    fn into_iter(self) -> Self::IntoIter {
        self.vertices.into_iter().take(self.count as usize)
    }
}

/// A pure simplicial complex of dimension 1, 2 or 3, by its cells and their incidences.
///
/// Cells are named by dimension and number; numbers may leave gaps. All lists of cells come by rising number, all lists of
/// vertices by rising index, so that two triangulations with the same cells in the same order give the same results.
pub trait Triangulation: Sync {
    /// 1, 2 or 3.
    fn dimension(&self) -> usize;

    /// Number of vertices, those of no simplex included.
    fn vertex_count(&self) -> usize;

    /// Numbers of cells of a dimension are less than this; 0 above the dimension of the triangulation.
    fn cell_bound(&self, dimension: usize) -> usize;

    /// Whether a number below [`cell_bound`](Self::cell_bound) names a cell.
    fn is_cell(&self, cell: Cell) -> bool;

    /// Number of cells of a dimension; 0 above the dimension of the triangulation.
    fn cell_count(&self, dimension: usize) -> usize;

    /// The cells of a dimension by rising number.
    fn cells(&self, dimension: usize) -> impl Iterator<Item = Cell> {
        (0..self.cell_bound(dimension) as u32)
            .map(move |index| Cell { dimension: dimension as u8, index })
            .filter(|&cell| self.is_cell(cell))
    }

    /// The vertices of a cell by rising index.
    fn cell_vertices(&self, cell: Cell) -> Corners;

    /// The cell on some vertices, which may come in any order; `None` if there is none.
    fn cell_of(&self, vertices: &[VertexId]) -> Option<Cell>;

    /// The faces of a cell of the next lower dimension, by rising number: without the last vertex first.
    fn facets(&self, cell: Cell) -> impl Iterator<Item = Cell>;

    /// The cells of the next higher dimension of which a cell is a face, by rising number.
    fn cofacets(&self, cell: Cell) -> impl Iterator<Item = Cell>;

    /// All cells with a vertex, from the vertex itself by rising dimension, then number.
    fn star_cells(&self, vertex: VertexId) -> impl Iterator<Item = Cell>;

    /// The cells whose highest vertex is `vertex`, itself first, by rising dimension, then number.
    fn lower_star(&self, vertex: VertexId, order: &VertexOrder) -> impl Iterator<Item = Cell> {
        let is_lower = move |other: VertexId| other == vertex || order.is_below(other, vertex);
        self.star_cells(vertex).filter(move |&cell| self.cell_vertices(cell).iter().all(|&corner| is_lower(corner)))
    }

    /// The vertices that share an edge with a vertex, by rising index.
    fn neighbours(&self, vertex: VertexId) -> impl Iterator<Item = VertexId>;

    /// The edges of the link of a vertex, each at least once: pairs of neighbours that form a triangle with it.
    fn link_edges(&self, vertex: VertexId) -> impl Iterator<Item = [VertexId; 2]>;

    /// Whether a cell is a face of a cell of dimension d-1 that lies in exactly one top cell; never true of a top cell.
    fn is_on_boundary(&self, cell: Cell) -> bool;

    /// Position of a vertex, in the units of the file.
    fn point(&self, vertex: VertexId) -> [f64; 3];

    /// Mean of the positions of the vertices of a cell.
    fn barycentre(&self, cell: Cell) -> [f64; 3] {
        let corners = self.cell_vertices(cell);
        let mut sum = [0.0; 3];
        for &corner in corners.iter() {
            let point = self.point(corner);
            for axis in 0..3 {
                sum[axis] += point[axis];
            }
        }
        sum.map(|part| part / corners.len() as f64)
    }

    /// The lattice, of a triangulation that is the Freudenthal subdivision of a whole grid: for algorithms with a shorter
    /// way there.
    fn lattice(&self) -> Option<FreudenthalLattice> {
        None
    }
}
