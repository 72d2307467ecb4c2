//! The lower stars of an explicit complex with few neighbours, listed so that cells are found by masks.

use crate::field::{VertexId, VertexOrder};
use crate::mesh::{Cell, Triangulation};

use super::mask_star::{LOWER, LowerLink};

/// The lower star of one vertex after the other. `W` is told every pair.
pub(super) struct SmallStar<W> {
    paired: W,
    vertex: u32,
    /// By rank.
    edges: [u32; LOWER],
    adjacent: [u16; LOWER],
    /// By two neighbours in any order; read only where they are adjacent.
    triangles: [[u32; LOWER]; LOWER],
    thirds: [[u16; LOWER]; LOWER],
    /// With their neighbours as sets.
    tetrahedra: Vec<(u16, u32)>,
}

impl<W: Fn(Cell, Cell)> SmallStar<W> {
    pub(super) fn new(paired: W) -> Self {
        Self {
            paired,
            vertex: 0,
            edges: [0; LOWER],
            adjacent: [0; LOWER],
            triangles: [[0; LOWER]; LOWER],
            thirds: [[0; LOWER]; LOWER],
            tetrahedra: Vec::new(),
        }
    }

    /// Turns to a vertex and returns the number of its lower neighbours; `None` if they are too many.
    ///
    /// # Arguments
    /// * `owned`: triangles and tetrahedra whose highest vertex is `vertex`.
    pub(super) fn turn_to<T: Triangulation>(
        &mut self,
        complex: &T,
        order: &VertexOrder,
        vertex: VertexId,
        owned: [&[u32]; 2],
    ) -> Option<usize> {
        let own = order.rank(vertex);
        let mut below = [(u32::MAX, 0); LOWER];
        let mut count = 0;
        for (neighbour, edge) in complex.neighbours(vertex).zip(complex.cofacets(Cell::vertex(vertex))) {
            let rank = order.rank(neighbour);
            if rank < own {
                *below.get_mut(count)? = (rank, edge.index);
                count += 1;
            }
        }
        below[..count].sort_unstable();
        self.vertex = vertex.0;
        for (slot, &(_, edge)) in self.edges.iter_mut().zip(&below) {
            *slot = edge;
        }
        self.adjacent = [0; LOWER];
        self.thirds = [[0; LOWER]; LOWER];
        self.tetrahedra.clear();
        let places = |cell: Cell| {
            let mut places = [0; 3];
            let others = complex.cell_vertices(cell).into_iter().filter(|&corner| corner != vertex);
            for (place, corner) in places.iter_mut().zip(others) {
                let rank = order.rank(corner);
                *place = below.iter().fold(0, |sum: usize, &(other, _)| sum.wrapping_add((other < rank).into())) % LOWER;
            }
            places
        };
        for &index in owned[0] {
            let [a, b, _] = places(Cell { dimension: 2, index });
            self.adjacent[a] |= 1 << b;
            self.adjacent[b] |= 1 << a;
            self.triangles[a][b] = index;
            self.triangles[b][a] = index;
        }
        for &index in owned[1] {
            let [a, b, c] = places(Cell { dimension: 3, index });
            for (x, y, third) in [(a, b, c), (a, c, b), (b, c, a)] {
                self.thirds[x][y] |= 1 << third;
                self.thirds[y][x] |= 1 << third;
            }
            self.tetrahedra.push((1 << a | 1 << b | 1 << c, index));
        }
        Some(count)
    }
}

impl<W: Fn(Cell, Cell)> LowerLink for SmallStar<W> {
    fn adjacent(&self, a: usize) -> u16 {
        self.adjacent[a]
    }

    fn thirds(&self, a: usize, b: usize) -> u16 {
        self.thirds[a][b]
    }

    fn pair_vertex(&self) {
        (self.paired)(Cell { dimension: 0, index: self.vertex }, Cell { dimension: 1, index: self.edges[0] });
    }

    fn pair_edge(&self, edge: usize, other: usize) {
        let triangle = Cell { dimension: 2, index: self.triangles[edge][other] };
        (self.paired)(Cell { dimension: 1, index: self.edges[edge] }, triangle);
    }

    fn pair_triangle(&self, [a, b]: [usize; 2], third: usize) {
        let set = 1 << a | 1 << b | 1 << third;
        if let Some(&(_, index)) = self.tetrahedra.iter().find(|&&(other, _)| other == set) {
            (self.paired)(Cell { dimension: 2, index: self.triangles[a][b] }, Cell { dimension: 3, index });
        }
    }
}
