//! The separatrices of a simplified field from both sides: what a function with its extrema has to follow.

use crate::field::VertexId;

use super::extremum_graph::{ExtremumGraph, Saddle};

/// The saddles that remain between wanted extrema, and the vertex paths that lead from them to minima and maxima.
///
/// Every path starts in a saddle. Descending paths merge but never part, except in saddles, and so do ascending ones.
/// Whether a descending and an ascending path run through two vertices in contradictory order is for the caller to
/// check: simplification decides about minima and about maxima separately.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Separatrices {
    /// The saddles, by rising vertex.
    pub saddles: Vec<VertexId>,
    /// Paths from a saddle down to a minimum.
    pub descending: Vec<Vec<VertexId>>,
    /// Paths from a saddle up to a maximum.
    pub ascending: Vec<Vec<VertexId>>,
}

/// Collects the saddles that simplification leaves on both sides, with all their separatrices.
///
/// A vertex remains a saddle if it joins two minima or two maxima that are left, or if it is still critical in both
/// gradients, as around a hole or a handle. A saddle of one gradient only that merely closes a cycle went with an
/// extremum of the other kind. A saddle of one side, as on the boundary, gets the one path of the other side that
/// runs through it, so that every saddle has a vertex below it and one above.
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
    let vertices = |saddles: &[Saddle], joins_only: bool| -> Vec<VertexId> {
        let chosen = saddles.iter().filter(|saddle| saddle.joins || !joins_only);
        let mut vertices: Vec<VertexId> = chosen.map(|saddle| saddle.vertex).collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    };
    let (all_below, all_above) = (vertices(&below, false), vertices(&above, false));
    let mut saddles = vertices(&below, true);
    saddles.extend(vertices(&above, true));
    saddles.extend(all_below.iter().filter(|vertex| all_above.binary_search(vertex).is_ok()));
    saddles.sort_unstable();
    saddles.dedup();
    Separatrices {
        descending: paths(minima, &below, &all_below, &saddles),
        ascending: paths(maxima, &above, &all_above, &saddles),
        saddles,
    }
}

/// The paths of one side from the chosen vertices, sorted, each once.
fn paths(
    graph: &ExtremumGraph<'_>,
    saddles: &[Saddle],
    critical: &[VertexId],
    chosen: &[VertexId],
) -> Vec<Vec<VertexId>> {
    let of_saddles = saddles
        .iter()
        .filter(|saddle| chosen.binary_search(&saddle.vertex).is_ok())
        .flat_map(|saddle| saddle.separatrices.iter().cloned());
    let of_others =
        chosen.iter().filter(|vertex| critical.binary_search(vertex).is_err()).map(|&vertex| graph.path(vertex));
    let mut paths: Vec<Vec<VertexId>> = of_saddles.chain(of_others).filter(|path| path.len() > 1).collect();
    paths.sort_unstable();
    // Two critical edges at one saddle share the path that starts with its own pair.
    paths.dedup();
    paths
}
