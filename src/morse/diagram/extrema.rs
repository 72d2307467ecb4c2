//! The first and the last dimension by union–find: minima with critical edges, critical facets with top cells.

use super::super::forest::Forest;
use crate::mesh::{Cell, Triangulation};

use super::super::gradient::Pairing;
use super::critical::CriticalCells;
use super::flow::{Flow, Step};
use super::landscape::{Landscape, Sides};

/// Pairs every minimum but one a component with the critical edge that joins it to a lower one.
///
/// # Returns
/// Place of the edge for every minimum by rising rank; `None` if it never dies.
///
/// # Source
/// Guillou, Vidal, Tierny 2023, section 4.1 (critical edges only, by their two V-paths); the elder rule as in
/// Edelsbrunner, Harer 2010, section VII.2.
pub(super) fn minima_with_edges<T: Triangulation>(
    landscape: &Landscape<'_, T>,
    minima: &CriticalCells,
    edges: &CriticalCells,
) -> Vec<Option<u32>> {
    let flow = Flow::new(landscape.numbers(0), |vertex| match landscape.pairing(Cell { dimension: 0, index: vertex }) {
        Pairing::Up(edge) => {
            let other = landscape.facets(edge).map(|end| end.index).find(|&end| end != vertex);
            Step::On(other.expect("an edge has two ends"))
        }
        _ => Step::End(minima.place(vertex)),
    });
    let arcs = edges.map(|index| {
        let mut ends = landscape.facets(Cell { dimension: 1, index }).map(|end| flow.end(end.index));
        let mut next = || ends.next().expect("an edge has two ends");
        [next(), next()]
    });
    elders(minima.len(), arcs.into_iter().enumerate().map(|(place, ends)| (place as u32, ends)))
}

/// Pairs critical facets with the critical top cells that fill them, on a domain whose facets have one or two sides.
///
/// Dual to [`minima_with_edges`]: top cells are nodes, facets are arcs, from the highest down; beyond the boundary there
/// is one more node, older than all.
///
/// # Returns
/// Place of the facet for every critical top cell by rising order; `None` for the last one of a closed component.
///
/// # Source
/// Guillou, Vidal, Tierny 2023, section 4.2.
pub(super) fn facets_with_tops<T: Triangulation>(
    landscape: &Landscape<'_, T>,
    facets: &CriticalCells,
    tops: &CriticalCells,
) -> Vec<Option<u32>> {
    const OUTSIDE: u32 = 0;
    let dimension = landscape.dimension();
    let count = tops.len() as u32;
    let flow = Flow::new(landscape.numbers(dimension), |top| {
        match landscape.pairing(Cell { dimension: dimension as u8, index: top }) {
            Pairing::Down(facet) => match landscape.sides(facet.index) {
                Sides::Two(one, other) => Step::On(if one == top { other } else { one }),
                Sides::One(_) | Sides::More => Step::End(OUTSIDE),
            },
            _ => Step::End(count - tops.place(top)),
        }
    });
    let arcs = facets.map(|facet| match landscape.sides(facet) {
        Sides::Two(one, other) => [flow.end(one), flow.end(other)],
        Sides::One(one) => [OUTSIDE, flow.end(one)],
        Sides::More => [OUTSIDE; 2],
    });
    let falling = arcs.into_iter().enumerate().rev().map(|(place, ends)| (place as u32, ends));
    let mut paired = elders(tops.len() + 1, falling);
    // Node 0 is the outside, which never dies; top cells follow, highest first.
    paired.remove(0);
    paired.reverse();
    paired
}

/// Joins nodes by arcs in turn; where two sets meet, the one with the greater least node dies.
///
/// # Returns
/// The arc by which each node died.
fn elders(nodes: usize, arcs: impl Iterator<Item = (u32, [u32; 2])>) -> Vec<Option<u32>> {
    let mut forest = Forest::new(nodes);
    let mut deaths = vec![None; nodes];
    for (arc, ends) in arcs {
        let [one, other] = ends.map(|end| forest.root(end));
        if one != other {
            let (elder, younger) = (one.min(other), one.max(other));
            deaths[younger as usize] = Some(arc);
            forest.attach(younger, elder);
        }
    }
    deaths
}
