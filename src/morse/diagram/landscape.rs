//! What the diagram needs to know of a mesh, a vertex order and a discrete gradient.

use rayon::prelude::*;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::SimplicialComplex;

use super::super::gradient::{Cell, DiscreteGradient, Pairing};
use super::super::v_paths;

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
pub(super) struct Landscape<'a> {
    complex: &'a SimplicialComplex,
    order: &'a VertexOrder,
    gradient: &'a DiscreteGradient,
    sides: Vec<[u32; 2]>,
}

const NOBODY: u32 = u32::MAX;
const MANY: u32 = u32::MAX - 1;

impl<'a> Landscape<'a> {
    pub(super) fn new(complex: &'a SimplicialComplex, order: &'a VertexOrder, gradient: &'a DiscreteGradient) -> Self {
        let top = complex.dimension() as u8;
        let mut sides = Vec::new();
        if top > 1 {
            let facets = if top == 2 { complex.edges().len() } else { complex.triangles().len() };
            sides = vec![[NOBODY; 2]; facets];
            for index in 0..complex.simplex_count() as u32 {
                // Top triangles are numbered as triangles, not in the order given.
                for facet in v_paths::facets(complex, Cell { dimension: top, index }) {
                    let slot = &mut sides[facet.index as usize];
                    match slot {
                        [NOBODY, _] => slot[0] = index,
                        [_, NOBODY] => slot[1] = index,
                        _ => *slot = [MANY; 2],
                    }
                }
            }
        }
        Self { complex, order, gradient, sides }
    }

    pub(super) fn dimension(&self) -> usize {
        self.complex.dimension()
    }

    /// One more than the greatest number of a cell.
    pub(super) fn numbers(&self, dimension: usize) -> usize {
        match dimension {
            0 => self.complex.vertex_count(),
            1 => self.complex.edges().len(),
            2 => self.complex.triangles().len(),
            _ => self.complex.simplex_count(),
        }
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
        let index = cell.index as usize;
        let mut fill = |vertices: &[VertexId]| {
            for (slot, &vertex) in ranks.iter_mut().zip(vertices) {
                *slot = self.order.rank(vertex) + 1;
            }
        };
        match cell.dimension {
            0 => fill(&[VertexId(cell.index)]),
            1 => fill(&self.complex.edges()[index]),
            2 => fill(&self.complex.triangles()[index]),
            _ => fill(&[0, 1, 2, 3].map(|corner| VertexId(self.complex.simplex(index)[corner]))),
        }
        ranks.sort_unstable_by(|a, b| b.cmp(a));
        ranks
    }

    pub(super) fn vertex_of_rank(&self, rank_plus_one: u32) -> VertexId {
        self.order.sequence()[rank_plus_one as usize - 1]
    }

    /// Facets of a cell.
    pub(super) fn facets(&self, cell: Cell) -> impl Iterator<Item = Cell> {
        v_paths::facets(self.complex, cell)
    }

    /// Whether every facet of a top cell is on one or two of them.
    pub(super) fn is_dual_a_graph(&self) -> bool {
        self.sides.par_iter().all(|sides| sides[0] != MANY)
    }

    /// The top cells at a facet.
    pub(super) fn sides(&self, facet: u32) -> Sides {
        match self.sides[facet as usize] {
            [MANY, _] => Sides::More,
            [one, NOBODY] => Sides::One(one),
            [one, other] => Sides::Two(one, other),
        }
    }
}
