//! The separatrices of a simplified field from both sides: what a function with its extrema has to follow.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use crate::field::VertexId;

use super::extremum_graph::{ExtremumGraph, Saddle};

/// The saddles that remain between wanted extrema, and the vertex paths that lead from them to minima and maxima.
///
/// Every path starts in a saddle. Descending paths merge but never part, except in saddles, and so do ascending ones.
///
/// Simplification decides about minima and about maxima separately, so, mostly near a boundary, a descending and an
/// ascending path may run through two vertices in contradictory order; [`order`](Self::order) tells. In the gradients
/// of an order that has the wanted extrema and no others, as flooding makes it, no V-path has been reversed, every path
/// falls or rises in that order, and nothing contradicts.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Separatrices {
    /// The saddles, by rising vertex.
    pub saddles: Vec<VertexId>,
    /// Paths from a saddle down to a minimum.
    pub descending: Vec<Vec<VertexId>>,
    /// Paths from a saddle up to a maximum.
    pub ascending: Vec<Vec<VertexId>>,
}

impl Separatrices {
    /// All vertices on the paths, so listed that descending paths fall and ascending ones rise: the order of any values
    /// that are strictly monotone along every path. `None` if there is none.
    ///
    /// # Returns
    /// The vertices, lowest first; where the paths leave a choice, the vertex of lower index first.
    ///
    /// # Cost
    /// O(p log p) for paths of p vertices in all.
    pub fn order(&self) -> Option<Vec<VertexId>> {
        let falling = self.descending.iter().flat_map(|path| path.windows(2).map(|step| (step[1], step[0])));
        let rising = self.ascending.iter().flat_map(|path| path.windows(2).map(|step| (step[0], step[1])));
        let mut arcs: Vec<(VertexId, VertexId)> = falling.chain(rising).collect();
        arcs.sort_unstable();
        arcs.dedup();
        let mut below: BTreeMap<VertexId, usize> = BTreeMap::new();
        for &(low, high) in &arcs {
            below.entry(low).or_default();
            *below.entry(high).or_default() += 1;
        }
        let mut ready: BinaryHeap<Reverse<VertexId>> =
            below.iter().filter(|&(_, &count)| count == 0).map(|(&vertex, _)| Reverse(vertex)).collect();
        let mut listed = Vec::with_capacity(below.len());
        while let Some(Reverse(vertex)) = ready.pop() {
            listed.push(vertex);
            let first = arcs.partition_point(|&(low, _)| low < vertex);
            for &(_, high) in arcs[first..].iter().take_while(|&&(low, _)| low == vertex) {
                let count = below.entry(high).or_default();
                *count -= 1;
                if *count == 0 {
                    ready.push(Reverse(high));
                }
            }
        }
        (listed.len() == below.len()).then_some(listed)
    }
}

/// Collects the saddles that simplification leaves on both sides, with all their separatrices.
///
/// A vertex remains a saddle if it joins two minima or two maxima that are left, or if it is essential: if it closes a
/// cycle from below and from above that goes around a handle and not around an extremum of the other kind. A saddle of
/// one side, as on the boundary, gets the one path of the other side that runs through it, so that every saddle has a
/// vertex below it and one above, unless it is itself an extremum, as all saddles are in dimension 1.
///
/// # Arguments
/// * `minima`, `maxima`: extremum graphs of one field, simplified to the wanted extrema of either kind.
///
/// # Cost
/// Linear in the number of vertices and in the lengths of the paths.
///
/// # Source
/// Weinkauf, Günther, Tierny 2010; Jacobson, Weinkauf, Sorkine 2012, section 3.3.
pub fn separatrices(minima: &ExtremumGraph<'_>, maxima: &ExtremumGraph<'_>) -> Separatrices {
    let (below, above) = (minima.saddles(), maxima.saddles());
    let (tally_below, tally_above) = (tally(minima, &below), tally(maxima, &above));
    let is_essential = |vertex: VertexId, below: Tally| {
        // On a surface a cycle that closes below around an extremum splits the set above: each closing edge of one
        // side answers to a joining edge of the other, cancelled or not. What has no answer on either side is essential.
        let above = tally_above.get(&vertex).copied().unwrap_or_default();
        below.closes > above.joins && above.closes > below.joins
    };
    let joins = below.iter().chain(&above).filter(|saddle| saddle.joins).map(|saddle| saddle.vertex);
    let essential = tally_below.iter().filter(|&(&vertex, &below)| is_essential(vertex, below));
    let mut saddles: Vec<VertexId> = joins.chain(essential.map(|(&vertex, _)| vertex)).collect();
    saddles.sort_unstable();
    saddles.dedup();
    Separatrices { descending: paths(minima, &below, &saddles), ascending: paths(maxima, &above, &saddles), saddles }
}

/// Critical edges at a vertex before simplification.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    joins: usize,
    closes: usize,
}

fn tally(graph: &ExtremumGraph<'_>, saddles: &[Saddle]) -> BTreeMap<VertexId, Tally> {
    let mut tally: BTreeMap<VertexId, Tally> = BTreeMap::new();
    for saddle in saddles {
        let at_vertex = tally.entry(saddle.vertex).or_default();
        *(if saddle.joins { &mut at_vertex.joins } else { &mut at_vertex.closes }) += 1;
    }
    for cancellation in graph.cancellations() {
        tally.entry(cancellation.saddle_vertex).or_default().joins += 1;
    }
    tally
}

/// The paths of one side from the chosen vertices, sorted, each once.
fn paths(graph: &ExtremumGraph<'_>, saddles: &[Saddle], chosen: &[VertexId]) -> Vec<Vec<VertexId>> {
    let critical: BTreeSet<VertexId> = saddles.iter().map(|saddle| saddle.vertex).collect();
    let of_saddles = saddles
        .iter()
        .filter(|saddle| chosen.binary_search(&saddle.vertex).is_ok())
        .flat_map(|saddle| graph.separatrices(saddle));
    let of_others = chosen.iter().filter(|vertex| !critical.contains(vertex)).map(|&vertex| graph.path(vertex));
    let mut paths: Vec<Vec<VertexId>> = of_saddles.chain(of_others).filter(|path| is_simple(path)).collect();
    paths.sort_unstable();
    // Two critical edges at one saddle share the path that starts with its own pair.
    paths.dedup();
    paths
}

/// Whether a path leaves its saddle for good. In a simplified gradient the V-path across a critical edge that closes a
/// cycle may come back to the saddle; no function is monotone along it.
fn is_simple(path: &[VertexId]) -> bool {
    path.len() > 1 && !path[1..].contains(&path[0])
}
