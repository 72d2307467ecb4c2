//! What the diagram needs to know of a mesh, a vertex order and a discrete gradient.

use crate::field::{VertexId, VertexOrder};
use crate::mesh::{Cell, Triangulation};

use super::super::gradient::{DiscreteGradient, Pairing};

/// Ranks of the vertices of a cell plus one, highest first, padded with 0. Arrays compare as the field compares the
/// cells: by their vertices from the highest on, a face before its cofaces.
pub(super) type Ranks = [u32; 4];

/// The top cells at a facet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sides {
    /// On the boundary of the domain.
    One(u32),
    /// Between two top cells.
    Two(u32, u32),
    /// The domain is no manifold there.
    More,
}

/// A mesh, an order of its vertices and the gradient of that order.
pub(super) struct Landscape<'a, T> {
    mesh: &'a T,
    order: &'a VertexOrder,
    gradient: &'a DiscreteGradient,
}

impl<'a, T: Triangulation> Landscape<'a, T> {
    pub(super) fn new(mesh: &'a T, order: &'a VertexOrder, gradient: &'a DiscreteGradient) -> Self {
        Self { mesh, order, gradient }
    }

    pub(super) fn dimension(&self) -> usize {
        self.mesh.dimension()
    }

    /// One more than the greatest number of a cell.
    pub(super) fn numbers(&self, dimension: usize) -> usize {
        self.mesh.cell_bound(dimension)
    }

    /// The critical cells of one dimension by rising number.
    pub(super) fn critical(&self, dimension: usize) -> Vec<u32> {
        self.gradient.critical_cells(dimension).map(|cell| cell.index).collect()
    }

    pub(super) fn pairing(&self, cell: Cell) -> Pairing {
        self.gradient.pairing(cell)
    }

    pub(super) fn ranks(&self, cell: Cell) -> Ranks {
        let mut ranks = [0; 4];
        for (slot, vertex) in ranks.iter_mut().zip(self.mesh.cell_vertices(cell)) {
            *slot = self.order.rank(vertex) + 1;
        }
        ranks.sort_unstable_by(|a, b| b.cmp(a));
        ranks
    }

    /// The vertex of a level: of a rank plus one.
    pub(super) fn vertex_at(&self, level: u32) -> VertexId {
        self.order.sequence()[level as usize - 1]
    }

    /// The highest vertex that is no vertex without simplices.
    pub(super) fn highest_vertex(&self) -> Option<VertexId> {
        let is_inside = |&vertex: &VertexId| self.pairing(Cell::vertex(vertex)) != Pairing::Outside;
        self.order.sequence().iter().copied().rev().find(is_inside)
    }

    /// Facets of a cell.
    pub(super) fn facets(&self, cell: Cell) -> impl Iterator<Item = Cell> {
        self.mesh.facets(cell)
    }

    /// Facets of a cell with their levels.
    pub(super) fn facets_with_levels(&self, cell: Cell) -> impl Iterator<Item = (Cell, u32)> {
        let corners = self.mesh.cell_vertices(cell);
        let (mut first, mut second, mut highest) = (0, 0, 0);
        for (place, &corner) in corners.iter().enumerate() {
            let level = self.order.rank(corner) + 1;
            if level > first {
                (first, second, highest) = (level, first, place);
            } else {
                second = second.max(level);
            }
        }
        // Facets come without the last vertex first.
        let lower = corners.len() - 1 - highest;
        self.mesh.facets(cell).enumerate().map(move |(at, facet)| (facet, if at == lower { second } else { first }))
    }

    /// Whether every facet of a top cell is on one or two of them.
    pub(super) fn is_dual_a_graph(&self) -> bool {
        if self.mesh.lattice().is_some() {
            return true;
        }
        let mut sides = vec![0u8; self.numbers(self.dimension() - 1)];
        for facet in self.mesh.cells(self.dimension()).flat_map(|top| self.mesh.facets(top)) {
            let count = &mut sides[facet.index as usize];
            *count = count.saturating_add(1);
        }
        sides.iter().all(|&count| count <= 2)
    }

    /// The top cells at a facet.
    pub(super) fn sides(&self, facet: u32) -> Sides {
        let mut tops = self.mesh.cofacets(Cell { dimension: self.dimension() as u8 - 1, index: facet });
        match (tops.next(), tops.next(), tops.next()) {
            (Some(one), None, _) => Sides::One(one.index),
            (Some(one), Some(other), None) => Sides::Two(one.index, other.index),
            _ => Sides::More,
        }
    }
}
