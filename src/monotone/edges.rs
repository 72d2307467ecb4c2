//! Monotonicity edges: the acyclic digraph along which the field must rise.
//!
//! Literature: Jacobson, Weinkauf, Sorkine 2012, section 3.2, eq. 14, and the end of section 3.3.

use crate::field::{VertexId, VertexOrder};
use crate::mesh::SimplicialComplex;
use crate::morse::WantedExtrema;

/// Which edges of the mesh take the direction of the representative function.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EdgeSet {
    /// The smallest set that suffices: at every vertex the edges to its lowest and its highest neighbour, and all edges at
    /// the wanted extrema.
    #[default]
    Minimal,
    /// Every edge of the mesh.
    All,
}

/// One monotonicity edge: the field must be smaller at `low` than at `high`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct MonotonicityEdge {
    /// The lower end.
    pub low: VertexId,
    /// The higher end.
    pub high: VertexId,
}

/// The monotonicity edges and a topological order of them.
#[derive(Debug, Clone)]
pub struct MonotonicityGraph {
    edges: Vec<MonotonicityEdge>,
    /// Order of the representative function: every edge goes upwards in it, so the digraph has no cycle.
    order: VertexOrder,
    below_offsets: Vec<u32>,
    below: Vec<VertexId>,
    above_offsets: Vec<u32>,
    above: Vec<VertexId>,
}

impl MonotonicityGraph {
    /// Takes the edges from a representative function.
    ///
    /// # Arguments
    /// * `order`: vertex order of the representative function; its extrema are exactly `wanted`.
    ///
    /// # Cost
    /// O(m) for m edges of the mesh.
    ///
    /// # Source
    /// Jacobson, Weinkauf, Sorkine 2012, section 3.3, last paragraph.
    pub fn new(complex: &SimplicialComplex, order: &VertexOrder, wanted: &WantedExtrema, set: EdgeSet) -> Self {
        let directed = |a: VertexId, b: VertexId| match order.is_below(a, b) {
            true => MonotonicityEdge { low: a, high: b },
            false => MonotonicityEdge { low: b, high: a },
        };
        let mut edges: Vec<MonotonicityEdge> = match set {
            EdgeSet::All => complex.edges().iter().map(|&[a, b]| directed(a, b)).collect(),
            EdgeSet::Minimal => {
                let mut edges = Vec::with_capacity(2 * complex.vertex_count());
                let mut is_wanted = vec![false; complex.vertex_count()];
                for &extremum in wanted.minima.iter().chain(&wanted.maxima) {
                    is_wanted[extremum.index()] = true;
                }
                for vertex in (0..complex.vertex_count()).map(VertexId::from) {
                    let neighbours = complex.neighbours(vertex);
                    if is_wanted[vertex.index()] {
                        edges.extend(neighbours.iter().map(|&neighbour| directed(vertex, neighbour)));
                        continue;
                    }
                    let lowest = neighbours.iter().min_by_key(|&&neighbour| order.rank(neighbour));
                    let highest = neighbours.iter().max_by_key(|&&neighbour| order.rank(neighbour));
                    edges.extend(lowest.map(|&neighbour| directed(neighbour, vertex)));
                    edges.extend(highest.map(|&neighbour| directed(vertex, neighbour)));
                }
                edges
            }
        };
        // An edge can be the choice of both of its ends.
        edges.sort_unstable();
        edges.dedup();
        Self::of_edges(edges, order.clone())
    }

    fn of_edges(edges: Vec<MonotonicityEdge>, order: VertexOrder) -> Self {
        let n = order.len();
        let lists = |from: fn(&MonotonicityEdge) -> VertexId, to: fn(&MonotonicityEdge) -> VertexId| {
            let mut offsets = vec![0u32; n + 1];
            for edge in &edges {
                offsets[from(edge).index() + 1] += 1;
            }
            for vertex in 0..n {
                offsets[vertex + 1] += offsets[vertex];
            }
            let mut next = offsets.clone();
            let mut list = vec![VertexId(0); edges.len()];
            for edge in &edges {
                let slot = &mut next[from(edge).index()];
                list[*slot as usize] = to(edge);
                *slot += 1;
            }
            (offsets, list)
        };
        let (below_offsets, below) = lists(|edge| edge.high, |edge| edge.low);
        let (above_offsets, above) = lists(|edge| edge.low, |edge| edge.high);
        Self { edges, order, below_offsets, below, above_offsets, above }
    }

    /// The edges, each once, sorted by their ends.
    pub fn edges(&self) -> &[MonotonicityEdge] {
        &self.edges
    }

    /// The order of the representative function, a topological order of the edges.
    pub fn order(&self) -> &VertexOrder {
        &self.order
    }

    /// Lower ends of the edges that end at `vertex`.
    pub fn below(&self, vertex: VertexId) -> &[VertexId] {
        &self.below[self.below_offsets[vertex.index()] as usize..self.below_offsets[vertex.index() + 1] as usize]
    }

    /// Higher ends of the edges that start at `vertex`.
    pub fn above(&self, vertex: VertexId) -> &[VertexId] {
        &self.above[self.above_offsets[vertex.index()] as usize..self.above_offsets[vertex.index() + 1] as usize]
    }
}
