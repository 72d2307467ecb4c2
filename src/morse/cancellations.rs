//! Which critical cells cancel each other, and at which threshold.

use std::collections::BTreeMap;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::{Cell, Triangulation};

use super::ascent::{self, BRANCHING, OUTSIDE};
use super::basins::{BasinHierarchy, BasinMerge};
use super::diagram::diagram_of_gradient;
use super::forest::Forest;
use super::gradient::DiscreteGradient;
use super::star::{cofacets, key};

/// Two critical cells of adjacent dimension that cancel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellCancellation {
    /// The critical cell of lower dimension.
    pub lower: Cell,
    /// The critical cell of higher dimension.
    pub upper: Cell,
    /// Highest vertex of the extremum of the two; `None` for two saddles.
    pub extremum: Option<VertexId>,
    /// Difference of the values at the highest vertices, in the units of the field.
    pub persistence: f64,
    /// Lowest threshold at which the two are cancelled, in the units of the field; `INFINITY` for never. It exceeds
    /// `persistence` for a maximum that rises out of the domain long before it meets a higher one: see
    /// [`MorseHierarchy`].
    pub level: f64,
}

/// Minima with their edges.
pub(super) fn with_minima<T: Triangulation>(complex: &T, minima: &BasinHierarchy) -> Vec<CellCancellation> {
    let pair = |merge: &BasinMerge| {
        let upper = complex.cell_of(&merge.edge)?;
        Some(CellCancellation {
            lower: Cell::vertex(merge.extremum),
            upper,
            extremum: Some(merge.extremum),
            persistence: merge.persistence,
            level: merge.persistence,
        })
    };
    minima.merges().iter().filter_map(pair).collect()
}

/// Maxima with the facets at which they die: union–find on top cells by falling facet. What has risen out of the domain is
/// older than any maximum.
pub(super) fn with_maxima<T: Triangulation>(
    complex: &T,
    gradient: &DiscreteGradient,
    values: &[f64],
    order: &VertexOrder,
    maxima: &BasinHierarchy,
) -> Vec<CellCancellation> {
    let dimension = complex.dimension();
    let summits = ascent::summits(complex, gradient);
    let mut tops: Vec<([u32; 4], Cell)> =
        gradient.critical_cells(dimension).map(|cell| (key(complex, order, cell), cell)).collect();
    tops.sort_unstable();
    // Set 0 is what lies outside; maxima follow, oldest first, so the smaller number is the elder.
    let number: BTreeMap<u32, u32> = tops.iter().rev().zip(1..).map(|(top, number)| (top.1.index, number)).collect();
    let mut facets: Vec<([u32; 4], Cell)> =
        gradient.critical_cells(dimension - 1).map(|cell| (key(complex, order, cell), cell)).collect();
    facets.sort_unstable();
    let superlevel: BTreeMap<VertexId, f64> = maxima
        .extrema()
        .iter()
        .map(|&maximum| (maximum, f64::INFINITY))
        .chain(maxima.merges().iter().map(|merge| (merge.extremum, merge.persistence)))
        .collect();
    let vertex = |key: &[u32; 4]| order.sequence()[key[0] as usize - 1];
    let mut forest = Forest::new(tops.len() + 1);
    let mut around = Vec::new();
    let mut found = Vec::new();
    for (facet_key, facet) in facets.iter().rev() {
        cofacets(complex, *facet, &mut around);
        let end = |top: Option<&Cell>| match top.map(|top| summits[top.index as usize]) {
            None | Some(OUTSIDE) => Some(0),
            Some(BRANCHING) => None,
            Some(summit) => number.get(&summit).copied(),
        };
        let ([one, other], true) = ([end(around.first()), end(around.get(1))], around.len() <= 2) else { continue };
        let (Some(one), Some(other)) = (one, other) else { continue };
        let (one, other) = (forest.root(one), forest.root(other));
        if one == other {
            continue;
        }
        let (elder, younger) = (one.min(other), one.max(other));
        forest.attach(younger, elder);
        let (top_key, top) = &tops[tops.len() - younger as usize];
        let (saddle, extremum) = (vertex(facet_key), vertex(top_key));
        let persistence = (values[extremum.index()] - values[saddle.index()]).abs();
        let level = superlevel.get(&extremum).map_or(persistence, |&level| level.max(persistence));
        found.push(CellCancellation { lower: *facet, upper: *top, extremum: Some(extremum), persistence, level });
    }
    found
}

/// 1-saddles with 2-saddles of a 3-dimensional domain, by the persistence diagram.
pub(super) fn of_saddles<T: Triangulation>(
    complex: &T,
    gradient: &DiscreteGradient,
    values: &[f64],
    order: &VertexOrder,
) -> Vec<CellCancellation> {
    let diagram = diagram_of_gradient(complex, order, gradient);
    let cancellation = |pair: &super::diagram::PersistencePair| {
        let (upper, persistence) = (pair.death?, pair.persistence(values)?);
        Some(CellCancellation { lower: pair.birth, upper, extremum: None, persistence, level: persistence })
    };
    diagram.of_dimension(1).filter_map(cancellation).collect()
}
