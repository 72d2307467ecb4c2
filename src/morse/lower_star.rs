//! One lower star of any size: its cells in the order of the field, and their pairing. Small ones have a faster way.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::{Cell, Triangulation};


/// A cell of the lower star of `v`, without `v`: places of its other vertices among the lower neighbours of `v` by
/// rising rank, plus one, highest first, padded with 0. Arrays compare as the field compares the cells: by their
/// vertices from the highest on, a face before its cofaces.
type Key = [u32; 3];

/// Work space for the lower star of one vertex after the other.
///
/// Local cells are numbered by rising key, so the smallest number is the lowest cell.
#[derive(Default)]
pub(super) struct LowerStar {
    /// Lower neighbours and the edges to them, by rising rank.
    below: Vec<(u32, VertexId, Cell)>,
    cells: Vec<(Key, Cell)>,
    /// Local cell of the edge to each lower neighbour.
    edges: Vec<u32>,
    /// Local facets but for the vertex itself: none of an edge, two of a triangle, three of a tetrahedron.
    facets: Vec<[u32; 3]>,
    cofacet_offsets: Vec<u32>,
    cofacets: Vec<u32>,
    /// Facets that are neither paired nor critical yet.
    open_facets: Vec<u8>,
    done: Vec<bool>,
    /// Cells that had exactly one open facet when they were put here.
    one: BinaryHeap<Reverse<u32>>,
    /// Cells without open facets, which no facet can be paired with.
    zero: BinaryHeap<Reverse<u32>>,
}

impl LowerStar {
    /// Gathers the cells whose highest vertex is `vertex`.
    ///
    /// # Arguments
    /// * `owned`: triangles and tetrahedra whose highest vertex is `vertex`.
    pub(super) fn collect<T: Triangulation>(
        &mut self,
        complex: &T,
        order: &VertexOrder,
        vertex: VertexId,
        owned: [&[u32]; 2],
    ) {
        let rank = order.rank(vertex);
        self.below.clear();
        for (neighbour, edge) in complex.neighbours(vertex).zip(complex.cofacets(Cell::vertex(vertex))) {
            if order.rank(neighbour) < rank {
                self.below.push((order.rank(neighbour), neighbour, edge));
            }
        }
        self.below.sort_unstable();
        self.cells.clear();
        for (place, &(_, _, edge)) in self.below.iter().enumerate() {
            self.cells.push(([place as u32 + 1, 0, 0], edge));
        }
        for (dimension, cells) in [2, 3].into_iter().zip(owned) {
            for &index in cells {
                let cell = Cell { dimension, index };
                let key = self.key(order, vertex, complex.cell_vertices(cell).into_iter());
                self.cells.push((key, cell));
            }
        }
        self.cells.sort_unstable();
        self.link();
    }

    fn key(&self, order: &VertexOrder, vertex: VertexId, corners: impl Iterator<Item = VertexId>) -> Key {
        let mut key = [0; 3];
        for (slot, corner) in key.iter_mut().zip(corners.filter(|&corner| corner != vertex)) {
            let rank = order.rank(corner);
            *slot = self.below.partition_point(|&(below, _, _)| below < rank) as u32 + 1;
        }
        key.sort_unstable_by_key(|&place| Reverse(place));
        key
    }

    /// Facets and cofacets of the local cells.
    fn link(&mut self) {
        let len = self.cells.len();
        self.edges.clear();
        self.facets.clear();
        self.cofacet_offsets.clear();
        self.cofacet_offsets.resize(len + 1, 0);
        for (number, &(key, cell)) in self.cells.iter().enumerate() {
            let facets = match cell.dimension {
                1 => {
                    // Edges come by rising place, whatever cells lie between them.
                    self.edges.push(number as u32);
                    [0; 3]
                }
                2 => [self.edges[key[0] as usize - 1], self.edges[key[1] as usize - 1], 0],
                _ => [[key[0], key[1], 0], [key[0], key[2], 0], [key[1], key[2], 0]].map(|facet| {
                    // A triangle comes after the edge to its higher vertex, before the edge to the next one.
                    let first = self.edges[facet[0] as usize - 1];
                    let following = &self.cells[first as usize..number];
                    first + following.partition_point(|&(key, _)| key < facet) as u32
                }),
            };
            for &facet in &facets[..facet_count(cell)] {
                self.cofacet_offsets[facet as usize + 1] += 1;
            }
            self.facets.push(facets);
        }
        for number in 0..len {
            self.cofacet_offsets[number + 1] += self.cofacet_offsets[number];
        }
        self.cofacets.clear();
        self.cofacets.resize(self.cofacet_offsets[len] as usize, 0);
        // Filling from behind turns each end of a range into its start.
        for (number, &(_, cell)) in self.cells.iter().enumerate().rev() {
            for &facet in &self.facets[number][..facet_count(cell)] {
                let slot = &mut self.cofacet_offsets[facet as usize + 1];
                *slot -= 1;
                self.cofacets[*slot as usize] = number as u32;
            }
        }
        self.cofacet_offsets.push(self.cofacets.len() as u32);
        self.open_facets.clear();
        self.open_facets.extend(self.cells.iter().map(|&(_, cell)| facet_count(cell) as u8));
        self.done.clear();
        self.done.resize(len, false);
    }

    /// Pairs the cells; those for which `paired(lower, upper)` is never called are critical.
    pub(super) fn pair(&mut self, vertex: VertexId, mut paired: impl FnMut(Cell, Cell)) {
        self.one.clear();
        self.zero.clear();
        let Some(&(_, steepest)) = self.cells.first() else {
            return;
        };
        paired(Cell::vertex(vertex), steepest);
        for &edge in &self.edges[1..] {
            self.zero.push(Reverse(edge));
        }
        self.close(0);
        self.offer_cofacets(0);
        loop {
            while let Some(Reverse(upper)) = self.one.pop() {
                if self.done[upper as usize] {
                    continue;
                }
                let Some(lower) = self.open_facet(upper) else {
                    self.zero.push(Reverse(upper));
                    continue;
                };
                paired(self.cells[lower as usize].1, self.cells[upper as usize].1);
                self.close(lower);
                self.close(upper);
                self.offer_cofacets(lower);
                self.offer_cofacets(upper);
            }
            match self.zero.pop() {
                Some(Reverse(cell)) if self.done[cell as usize] => {}
                Some(Reverse(critical)) => {
                    self.close(critical);
                    self.offer_cofacets(critical);
                }
                None => return,
            }
        }
    }

    fn cofacets(&self, cell: u32) -> std::ops::Range<usize> {
        self.cofacet_offsets[cell as usize + 1] as usize..self.cofacet_offsets[cell as usize + 2] as usize
    }

    fn close(&mut self, cell: u32) {
        self.done[cell as usize] = true;
        for place in self.cofacets(cell) {
            self.open_facets[self.cofacets[place] as usize] -= 1;
        }
    }

    fn offer_cofacets(&mut self, cell: u32) {
        for place in self.cofacets(cell) {
            let cofacet = self.cofacets[place];
            if self.open_facets[cofacet as usize] == 1 && !self.done[cofacet as usize] {
                self.one.push(Reverse(cofacet));
            }
        }
    }

    fn open_facet(&self, cell: u32) -> Option<u32> {
        let facets = &self.facets[cell as usize][..facet_count(self.cells[cell as usize].1)];
        facets.iter().copied().find(|&facet| !self.done[facet as usize])
    }
}

/// Facets of a cell of a lower star that hold the highest vertex, but for that vertex itself.
fn facet_count(cell: Cell) -> usize {
    if cell.dimension == 1 { 0 } else { cell.dimension as usize }
}
