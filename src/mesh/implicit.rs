//! Structured grids as triangulations without stored cells.
//!
//! Literature: Freudenthal 1942, *Simplizialzerlegungen von beschränkter Flachheit*; Kuhn 1960, *Some combinatorial
//! lemmas in topology*.

use rayon::prelude::*;

use super::lattice::FreudenthalLattice;
use super::triangulation::{Cell, Corners, Triangulation};
use super::{DomainError, Grid, GridGeometry, MeshError};
use crate::field::VertexId;

/// A grid and its Freudenthal (Kuhn) subdivision, of which nothing but sizes is stored.
///
/// The same triangulation as [`Domain::from_grid`](super::Domain::from_grid) makes without a mask, with the same vertices
/// and the cells in the same order; only their numbers have gaps, see [`FreudenthalLattice`].
///
/// # Example
/// ```
/// use morsmooth::mesh::{Grid, ImplicitGrid, Triangulation};
/// let grid = ImplicitGrid::new(Grid::image([3, 1, 2], [0.0; 3], [1.0; 3]))?; // in the x–z plane
/// assert_eq!([0, 1, 2].map(|dimension| grid.cell_count(dimension)), [6, 9, 4]);
/// # Ok::<(), morsmooth::mesh::DomainError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ImplicitGrid {
    grid: Grid,
    lattice: FreudenthalLattice,
}

impl ImplicitGrid {
    /// Takes a grid with at least one axis that is not flat.
    ///
    /// # Errors
    /// [`DomainError`] if geometry and dimensions do not fit, if there is no cell, with the first point whose
    /// coordinates are not finite, or if the numbers of cells do not fit into 32 bits: from 357 million points on in 3-D, 1.4
    /// thousand million in 2-D.
    ///
    /// # Cost
    /// Constant; linear for a curvilinear grid, whose coordinates are checked in parallel.
    pub fn new(grid: Grid) -> Result<Self, DomainError> {
        grid.check()?;
        let points = grid.point_count();
        if grid.dimension() == 0 || points == 0 {
            return Err(DomainError::Empty { points, cells: grid.cell_count(), masked_points: 0, masked_cells: 0 });
        }
        let most = [1, 1, 3, 12][grid.dimension()];
        if points * most > u32::MAX as usize {
            return Err(MeshError::TooLarge { what: "numbers of cells of the grid", found: points * most }.into());
        }
        if let Some(point) = first_broken_point(&grid) {
            return Err(DomainError::NonFinitePoint { point: point as u32, coordinates: grid.point(point) });
        }
        let lattice = FreudenthalLattice::new(grid.dims);
        Ok(Self { grid, lattice })
    }

    /// The grid, with its geometry.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }
}

/// The first point, of those that tell, with a coordinate that is not finite.
fn first_broken_point(grid: &Grid) -> Option<usize> {
    let is_broken = |&point: &usize| grid.point(point).iter().any(|part| !part.is_finite());
    let [width, height, depth] = grid.dims;
    let last = grid.point_count() - 1;
    match &grid.geometry {
        // Affine: a coordinate that is finite in all corners is so between them.
        GridGeometry::Image { .. } => {
            let corner = |bits: usize| {
                let end = |axis: usize, size: usize| if bits >> axis & 1 == 1 { size - 1 } else { 0 };
                end(0, width) + width * (end(1, height) + height * end(2, depth))
            };
            (0..8).map(corner).find(is_broken)
        }
        GridGeometry::Rectilinear { .. } => {
            let along = (0..width).chain((0..height).map(|j| j * width)).chain((0..depth).map(|k| k * width * height));
            along.into_iter().find(is_broken)
        }
        GridGeometry::Curvilinear { .. } => (0..last + 1).into_par_iter().with_min_len(8192).find_first(is_broken),
    }
}

impl Triangulation for ImplicitGrid {
    fn dimension(&self) -> usize {
        self.lattice.dimension()
    }

    fn vertex_count(&self) -> usize {
        self.lattice.vertex_count()
    }

    fn cell_bound(&self, dimension: usize) -> usize {
        self.lattice.vertex_count() * self.lattice.kinds(dimension)
    }

    fn is_cell(&self, cell: Cell) -> bool {
        let dimension = cell.dimension as usize;
        if cell.index as usize >= self.cell_bound(dimension) {
            return false;
        }
        let (anchor, kind) = self.lattice.anchor(cell);
        self.lattice.rims(anchor) >> 3 & self.lattice.extent(dimension, kind) == 0
    }

    fn cell_count(&self, dimension: usize) -> usize {
        let sizes = self.lattice.sizes();
        let of_kind = |kind: usize| {
            let extent = self.lattice.extent(dimension, kind);
            (0..3).map(|axis| (sizes[axis] - u32::from(extent >> axis & 1)) as usize).product::<usize>()
        };
        (0..self.lattice.kinds(dimension)).map(of_kind).sum()
    }

    fn cell_vertices(&self, cell: Cell) -> Corners {
        self.lattice.corners(cell)
    }

    fn cell_of(&self, vertices: &[VertexId]) -> Option<Cell> {
        let dimension = vertices.len().checked_sub(1)?;
        let mut corners = [VertexId(0); 4];
        corners.get_mut(..=dimension)?.copy_from_slice(vertices);
        corners[..=dimension].sort_unstable();
        let anchor = corners[0];
        (0..self.lattice.kinds(dimension))
            .map(|kind| self.lattice.cell(dimension, anchor, kind))
            .find(|&cell| self.is_cell(cell) && *self.lattice.corners(cell) == corners[..=dimension])
    }

    fn facets(&self, cell: Cell) -> impl Iterator<Item = Cell> {
        let (anchor, kind) = self.lattice.anchor(cell);
        let lattice = self.lattice;
        lattice.stencil().facets[cell.dimension as usize][kind].iter().map(move |place| lattice.at(anchor, place))
    }

    fn cofacets(&self, cell: Cell) -> impl Iterator<Item = Cell> {
        let (anchor, kind) = self.lattice.anchor(cell);
        let lattice = self.lattice;
        let rims = lattice.rims(anchor);
        let places = lattice.stencil().cofacets[cell.dimension as usize][kind].iter();
        places.filter(move |place| place.not_at & rims == 0).map(move |place| lattice.at(anchor, place))
    }

    fn star_cells(&self, vertex: VertexId) -> impl Iterator<Item = Cell> {
        let lattice = self.lattice;
        let rims = lattice.rims(vertex);
        let places = lattice.stencil().star.iter().filter(move |place| place.not_at & rims == 0);
        places.map(move |place| lattice.at(vertex, place))
    }

    fn neighbours(&self, vertex: VertexId) -> impl Iterator<Item = VertexId> {
        let rims = self.lattice.rims(vertex);
        let steps = self.lattice.steps();
        let sets = 1u8..1 << self.lattice.dimension();
        let before = sets.clone().rev().filter(move |set| set & rims == 0).map(move |set| vertex.0 - steps[set as usize]);
        let after = sets.filter(move |set| set << 3 & rims == 0).map(move |set| vertex.0 + steps[set as usize]);
        before.chain(after).map(VertexId)
    }

    fn link_edges(&self, vertex: VertexId) -> impl Iterator<Item = [VertexId; 2]> {
        self.star_cells(vertex).filter(|cell| cell.dimension == 2).map(move |triangle| {
            match *self.lattice.corners(triangle) {
                [a, b, c] if a == vertex => [b, c],
                [a, b, c] if b == vertex => [a, c],
                [a, b, ..] => [a, b],
                _ => [vertex; 2],
            }
        })
    }

    fn is_on_boundary(&self, cell: Cell) -> bool {
        let (anchor, kind) = self.lattice.anchor(cell);
        let rims = self.lattice.rims(anchor);
        (rims | rims >> 3) & 7 & !self.lattice.extent(cell.dimension.into(), kind) != 0
    }

    fn point(&self, vertex: VertexId) -> [f64; 3] {
        self.grid.point(vertex.index())
    }

    fn lattice(&self) -> Option<FreudenthalLattice> {
        Some(self.lattice)
    }
}
