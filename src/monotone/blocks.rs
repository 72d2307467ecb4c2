//! Which wanted extrema admit a field at all: the block structure of the mesh.
//!
//! Merge all wanted minima into one node s and all wanted maxima into one node t, and join s and t. A field with
//! exactly the wanted extrema exists if and only if every vertex lies in the biconnected block of the edge s–t: such a
//! block has an *st-numbering*, an order in which every other vertex has a lower and a higher neighbour; and a part that
//! hangs on one node would have its own highest and lowest vertex there, so all its values would have to be equal.
//!
//! Literature: Hopcroft, Tarjan 1973 (blocks by depth-first search); Lempel, Even, Cederbaum 1967 and Tarjan 1986
//! (st-numbering).

use crate::field::{VertexId, VertexOrder};
use crate::mesh::SimplicialComplex;
use crate::morse::WantedExtrema;

const NONE: u32 = u32::MAX;

/// The mesh with all wanted minima merged into node `s` and all wanted maxima into node `t`.
struct Merged {
    /// Node of each vertex: `2 + vertex`, or `S`, or `T`.
    node: Vec<u32>,
    offsets: Vec<u32>,
    neighbours: Vec<u32>,
}

const S: u32 = 0;
const T: u32 = 1;

impl Merged {
    fn new(complex: &SimplicialComplex, wanted: &WantedExtrema) -> Self {
        let n = complex.vertex_count();
        let mut node: Vec<u32> = (0..n as u32).map(|vertex| vertex + 2).collect();
        for &minimum in &wanted.minima {
            node[minimum.index()] = S;
        }
        for &maximum in &wanted.maxima {
            node[maximum.index()] = T;
        }
        let ends = |edge: &[VertexId; 2]| [node[edge[0].index()], node[edge[1].index()]];
        let mut offsets = vec![0u32; n + 3];
        // The edge s–t comes first at both of its ends, so that the search from s follows it at once.
        let joined = || std::iter::once([S, T]).chain(complex.edges().iter().map(ends).filter(|[a, b]| a != b));
        for [a, b] in joined() {
            offsets[a as usize + 1] += 1;
            offsets[b as usize + 1] += 1;
        }
        for slot in 0..n + 2 {
            offsets[slot + 1] += offsets[slot];
        }
        let mut next = offsets.clone();
        let mut neighbours = vec![0u32; offsets[n + 2] as usize];
        for [a, b] in joined() {
            for (from, to) in [(a, b), (b, a)] {
                let slot = &mut next[from as usize];
                neighbours[*slot as usize] = to;
                *slot += 1;
            }
        }
        Self { node, offsets, neighbours }
    }

}

/// Depth-first search from `s`, its first step to `t`.
struct Search {
    /// Nodes in the order of discovery.
    preorder: Vec<u32>,
    /// Time of discovery, `NONE` where the search did not come.
    time: Vec<u32>,
    parent: Vec<u32>,
    /// The earliest node that a node's subtree reaches by at most one edge outside the tree.
    low: Vec<u32>,
}

impl Search {
    fn new(graph: &Merged) -> Self {
        let nodes = graph.node.len() + 2;
        let mut search =
            Self { preorder: Vec::new(), time: vec![NONE; nodes], parent: vec![NONE; nodes], low: vec![NONE; nodes] };
        let mut next: Vec<u32> = graph.offsets[..nodes].to_vec();
        let mut stack = vec![S];
        search.discover(S, NONE);
        while let Some(&node) = stack.last() {
            let slot = next[node as usize];
            if slot == graph.offsets[node as usize + 1] {
                stack.pop();
                let parent = search.parent[node as usize];
                if parent != NONE {
                    let low = search.low[node as usize];
                    search.lower(parent, low);
                }
                continue;
            }
            next[node as usize] += 1;
            let neighbour = graph.neighbours[slot as usize];
            if search.time[neighbour as usize] == NONE {
                search.discover(neighbour, node);
                stack.push(neighbour);
            } else if neighbour != search.parent[node as usize] {
                // Doubled edges to the parent do not matter: they cannot reach above it.
                search.lower(node, neighbour);
            }
        }
        search
    }

    fn discover(&mut self, node: u32, parent: u32) {
        self.time[node as usize] = self.preorder.len() as u32;
        self.parent[node as usize] = parent;
        self.low[node as usize] = node;
        self.preorder.push(node);
    }

    fn lower(&mut self, node: u32, candidate: u32) {
        if self.time[candidate as usize] < self.time[self.low[node as usize] as usize] {
            self.low[node as usize] = candidate;
        }
    }

    /// For each node outside the block of s–t, the node at which its part of the mesh hangs on; `NONE` inside the block.
    fn hanging(&self) -> Vec<u32> {
        let mut root = vec![NONE; self.time.len()];
        for &node in self.preorder.iter().skip(2) {
            let parent = self.parent[node as usize];
            let cut = parent == S || self.time[self.low[node as usize] as usize] >= self.time[parent as usize];
            root[node as usize] = match root[parent as usize] {
                NONE if cut => node,
                inherited => inherited,
            };
        }
        root
    }
}

/// The parts of the mesh in which the wanted extrema leave no room for a field: each needs an extremum of its own.
///
/// Such a part touches the rest at a single vertex, or touches wanted minima only, or wanted maxima only. On a
/// manifold with at least one wanted minimum and maximum a component there is none; masked grids and polylines have them.
///
/// # Returns
/// The vertices of each such part, by rising index; parts by their lowest vertex.
///
/// # Cost
/// O(n + m).
///
/// # Source
/// Biconnectivity: Hopcroft, Tarjan 1973. That it is sufficient: Lempel, Even, Cederbaum 1967.
pub fn unreachable_regions(complex: &SimplicialComplex, wanted: &WantedExtrema) -> Vec<Vec<VertexId>> {
    let graph = Merged::new(complex, wanted);
    let search = Search::new(&graph);
    let hanging = search.hanging();
    let (component, count) = complex.components();
    // Parts that the search did not reach hold no wanted extremum at all: one region a component.
    let mut region_of = vec![NONE; graph.node.len() + 2 + count];
    let mut regions: Vec<Vec<VertexId>> = Vec::new();
    for vertex in (0..complex.vertex_count()).map(VertexId::from) {
        let node = graph.node[vertex.index()] as usize;
        if node < 2 || complex.neighbours(vertex).is_empty() {
            continue;
        }
        let key = if search.time[node] == NONE {
            graph.node.len() + 2 + component[vertex.index()] as usize
        } else if hanging[node] != NONE {
            hanging[node] as usize
        } else {
            continue;
        };
        if region_of[key] == NONE {
            region_of[key] = regions.len() as u32;
            regions.push(Vec::new());
        }
        regions[region_of[key] as usize].push(vertex);
    }
    regions
}

/// An order with exactly the wanted extrema that exists whenever any does, whatever the field: the last resort.
///
/// All wanted minima come first and all wanted maxima last.
///
/// # Returns
/// `None` if [`unreachable_regions`] is not empty.
///
/// # Cost
/// O(n + m).
///
/// # Source
/// Tarjan 1986, *Two streamlined depth-first search algorithms*, the list form of st-numbering.
pub fn st_numbering(complex: &SimplicialComplex, wanted: &WantedExtrema) -> Option<VertexOrder> {
    if !unreachable_regions(complex, wanted).is_empty() {
        return None;
    }
    let graph = Merged::new(complex, wanted);
    let search = Search::new(&graph);
    // A doubly linked list that starts as s, t; every node is put next to its parent, on the side that its low point asks for.
    let mut before = vec![NONE; graph.node.len() + 2];
    let mut after = vec![NONE; graph.node.len() + 2];
    (after[S as usize], before[T as usize]) = (T, S);
    let mut low_is_before = vec![false; graph.node.len() + 2];
    low_is_before[S as usize] = true;
    for &node in search.preorder.iter().skip(2) {
        let (parent, low) = (search.parent[node as usize], search.low[node as usize]);
        if low_is_before[low as usize] {
            // The low point lies before: the node goes just before its parent, and later nodes must find it after.
            let previous = before[parent as usize];
            (before[node as usize], after[node as usize]) = (previous, parent);
            after[previous as usize] = node;
            before[parent as usize] = node;
            low_is_before[parent as usize] = false;
        } else {
            let following = after[parent as usize];
            (before[node as usize], after[node as usize]) = (parent, following);
            before[following as usize] = node;
            after[parent as usize] = node;
            low_is_before[parent as usize] = true;
        }
    }
    let isolated = (0..complex.vertex_count()).map(VertexId::from).filter(|&v| complex.neighbours(v).is_empty());
    let mut sequence: Vec<VertexId> = isolated.collect();
    sequence.extend(wanted.minima.iter().filter(|&&v| !complex.neighbours(v).is_empty()));
    let mut node = after[S as usize];
    while node != T {
        sequence.push(VertexId(node - 2));
        node = after[node as usize];
    }
    sequence.extend(wanted.maxima.iter().filter(|&&v| !complex.neighbours(v).is_empty()));
    VertexOrder::of_sequence(sequence).ok()
}
