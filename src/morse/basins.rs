//! Basins of extrema and how they merge: the segmentation of the vertices at every threshold from one computation.

use rayon::prelude::*;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::Triangulation;

use super::error::MorseError;
use super::forest::Forest;
use super::jump::roots;
use super::pairs::ExtremumKind;
use super::segmentation::Segmentation;

const NONE: u32 = u32::MAX;

/// An extremum, and the edge across which its basin joins another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BasinMerge {
    /// The extremum that dies.
    pub extremum: VertexId,
    /// The saddle as a vertex: the end of `edge` that lies higher (for maxima: lower).
    pub saddle: VertexId,
    /// The critical edge: its end in the basin that dies, then its end in the other one.
    pub edge: [VertexId; 2],
    /// `|h(saddle) - h(extremum)|`, in the units of the field.
    pub persistence: f64,
}

/// The basins of all extrema of one kind, and the order in which they merge.
///
/// A vertex belongs to the extremum at the end of its V-path of vertices and edges in the discrete gradient of `h` (for
/// minima) or of `-h` with reversed ties (for maxima). Every such V-path leads from a vertex to its steepest neighbour,
/// so no gradient is built. Extrema on the boundary of the domain count like any other, and every vertex of a simplex has
/// a basin.
///
/// Merges come by rising persistence, nested ones first: cancelling a prefix of them reverses one V-path at a time, as
/// [`ExtremumGraph::simplify`](super::ExtremumGraph::simplify) does. So one computation gives the segmentation at every
/// threshold.
#[derive(Debug, Clone, PartialEq)]
pub struct BasinHierarchy {
    kind: ExtremumKind,
    /// By rising vertex.
    extrema: Vec<VertexId>,
    /// The steepest neighbour; the vertex itself for an extremum or a vertex without neighbours.
    steepest: Vec<u32>,
    /// Place in `extrema` at the end of the V-path; `NONE` for a vertex without neighbours.
    basin: Vec<u32>,
    merges: Vec<BasinMerge>,
}

impl BasinHierarchy {
    /// Finds the basins and pairs every extremum but the essential ones with the edge at which it dies (elder rule).
    ///
    /// # Arguments
    /// * `complex`: `n` vertices, any dimension.
    /// * `values`: the `n` values from which the order was taken.
    /// * `order`: total order of the vertices.
    /// * `kind`: basins of minima or of maxima.
    ///
    /// # Errors
    /// [`MorseError::OrderLength`] and [`MorseError::ValuesLength`].
    ///
    /// # Cost
    /// Linear in the edges up to the logarithm of the longest V-path and a sort of the edges between basins; 8 bytes a
    /// vertex kept. Parallel but for the union–find; the result does not depend on the number of threads.
    ///
    /// # Source
    /// Edelsbrunner, Harer, Zomorodian 2003 (cancellation in order of persistence).
    pub fn new<T: Triangulation>(
        complex: &T,
        values: &[f64],
        order: &VertexOrder,
        kind: ExtremumKind,
    ) -> Result<Self, MorseError> {
        let vertices = complex.vertex_count();
        if order.len() != vertices {
            return Err(MorseError::OrderLength { expected: vertices, found: order.len() });
        }
        if values.len() != vertices {
            return Err(MorseError::ValuesLength { expected: vertices, found: values.len() });
        }
        let order = kind.descending(order);
        let steepest: Vec<u32> = (0..vertices)
            .into_par_iter()
            .map(|vertex| {
                let lowest = |low: VertexId, next: VertexId| if order.is_below(next, low) { next } else { low };
                complex.neighbours(vertex.into()).fold(VertexId::from(vertex), lowest).0
            })
            .collect();
        let is_extremum =
            |vertex: &VertexId| steepest[vertex.index()] == vertex.0 && complex.neighbours(*vertex).next().is_some();
        let extrema: Vec<VertexId> = (0..vertices).into_par_iter().map(VertexId::from).filter(is_extremum).collect();
        let mut place = vec![NONE; vertices];
        for (number, extremum) in extrema.iter().enumerate() {
            place[extremum.index()] = number as u32;
        }
        let basin: Vec<u32> = roots(steepest.clone()).into_par_iter().map(|root| place[root as usize]).collect();
        let merges = merges(complex, values, &order, &extrema, &basin);
        Ok(Self { kind, extrema, steepest, basin, merges })
    }

    /// Which extrema.
    pub fn kind(&self) -> ExtremumKind {
        self.kind
    }

    /// All extrema of the order, by rising vertex.
    pub fn extrema(&self) -> &[VertexId] {
        &self.extrema
    }

    /// All merges, by rising persistence, nested ones first.
    pub fn merges(&self) -> &[BasinMerge] {
        &self.merges
    }

    /// The segmentation when every extremum of at most this persistence is cancelled; below 0, none is.
    ///
    /// # Arguments
    /// * `threshold`: in the units of the field.
    ///
    /// # Cost
    /// Linear, parallel.
    pub fn at(&self, threshold: f64) -> Segmentation {
        self.segmentation(|merge| merge.persistence <= threshold)
    }

    /// The segmentation when the chosen merges are done.
    pub(super) fn segmentation(&self, chosen: impl Fn(&BasinMerge) -> bool) -> Segmentation {
        let place = |vertex: VertexId| self.basin[vertex.index()];
        let mut parent: Vec<u32> = (0..self.extrema.len() as u32).collect();
        for merge in self.merges.iter().filter(|merge| chosen(merge)) {
            parent[place(merge.extremum) as usize] = place(merge.edge[1]);
        }
        let root = roots(parent);
        let mut number = vec![NONE; self.extrema.len()];
        let mut kept = Vec::new();
        for (place, &extremum) in self.extrema.iter().enumerate() {
            if root[place] as usize == place {
                number[place] = kept.len() as u32;
                kept.push(extremum);
            }
        }
        let label = |&basin: &u32| root.get(basin as usize).map_or(NONE, |&root| number[root as usize]);
        Segmentation::new(kept, self.basin.par_iter().map(label).collect())
    }

    /// The successor of every vertex on its V-path when the chosen merges are done; an extremum that is left, or a vertex
    /// without neighbours, is its own.
    ///
    /// # Cost
    /// Linear in the vertices and in the lengths of the reversed V-paths.
    pub(super) fn successors(&self, chosen: impl Fn(&BasinMerge) -> bool) -> Vec<u32> {
        let mut next = self.steepest.clone();
        for merge in self.merges.iter().filter(|merge| chosen(merge)) {
            let (mut vertex, mut before) = (merge.edge[0].0, merge.edge[1].0);
            loop {
                let after = std::mem::replace(&mut next[vertex as usize], before);
                if after == vertex {
                    break;
                }
                (vertex, before) = (after, vertex);
            }
        }
        next
    }
}

/// A lowest edge from a vertex to another basin below it.
///
/// Ordered by the ranks of its ends, which is how the lower-star filtration compares edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Pass {
    high: u32,
    low: u32,
    /// Basin of the higher end.
    own: u32,
    /// Basin of the lower end.
    other: u32,
}

fn merges<T: Triangulation>(
    complex: &T,
    values: &[f64],
    order: &VertexOrder,
    extrema: &[VertexId],
    basin: &[u32],
) -> Vec<BasinMerge> {
    let mut forest = Forest::new(extrema.len());
    // The extremum of a set of basins is that of its root.
    let age = |root: u32| order.rank(extrema[root as usize]);
    let mut merges = Vec::new();
    for pass in passes(complex, order, basin) {
        let [own, other] = [pass.own, pass.other].map(|basin| forest.root(basin));
        if own == other {
            continue;
        }
        let [high, low] = [pass.high, pass.low].map(|rank| order.sequence()[rank as usize]);
        let (younger, elder, edge) = if age(own) > age(other) { (own, other, [high, low]) } else { (other, own, [low, high]) };
        forest.attach(younger, elder);
        let extremum = extrema[younger as usize];
        let persistence = (values[high.index()] - values[extremum.index()]).abs();
        merges.push(BasinMerge { extremum, saddle: high, edge, persistence });
    }
    // Merges come by rising saddle. One nested in another has the lower saddle and no greater persistence, so a stable
    // sort puts it first, as the uniqueness of V-paths needs.
    merges.sort_by(|a, b| a.persistence.total_cmp(&b.persistence));
    merges
}

/// Where basins meet, by rising edge. Components of sublevel sets join only there.
fn passes<T: Triangulation>(complex: &T, order: &VertexOrder, basin: &[u32]) -> Vec<Pass> {
    let mut passes: Vec<Pass> = (0..order.len())
        .into_par_iter()
        .fold(Vec::new, |mut passes: Vec<Pass>, vertex| {
            let (high, own, begin) = (order.ranks()[vertex], basin[vertex], passes.len());
            for neighbour in complex.neighbours(vertex.into()) {
                let (low, other) = (order.rank(neighbour), basin[neighbour.index()]);
                if low > high || other == own {
                    continue;
                }
                match passes[begin..].iter_mut().find(|pass| pass.other == other) {
                    Some(pass) => pass.low = pass.low.min(low),
                    None => passes.push(Pass { high, low, own, other }),
                }
            }
            passes
        })
        .flatten_iter()
        .collect();
    passes.par_sort_unstable();
    passes
}
