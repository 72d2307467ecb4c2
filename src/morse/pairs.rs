//! Extremum pairs: which extremum of a field dies at which vertex, by union–find on the vertex order.

use rayon::prelude::*;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::SimplicialComplex;

use super::forest::Forest;

/// The two kinds of extrema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ExtremumKind {
    /// Every neighbour is above.
    Minimum,
    /// Every neighbour is below.
    Maximum,
}

impl ExtremumKind {
    /// `minimum` or `maximum`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Minimum => "minimum",
            Self::Maximum => "maximum",
        }
    }

    /// The order in which extrema of this kind are minima: the given one, or the given one turned upside down.
    pub fn descending(self, order: &VertexOrder) -> std::borrow::Cow<'_, VertexOrder> {
        match self {
            Self::Minimum => std::borrow::Cow::Borrowed(order),
            Self::Maximum => std::borrow::Cow::Owned(order.reversed()),
        }
    }
}

/// An extremum and the vertex at which its component of the sublevel (superlevel) sets joins an older one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ExtremumPair {
    /// The minimum or maximum.
    pub extremum: VertexId,
    /// Where it dies; `None` for the lowest minimum and the highest maximum of each component of the domain.
    pub saddle: Option<VertexId>,
    /// Whether `extremum` is a minimum or a maximum.
    pub kind: ExtremumKind,
    /// The component of the domain, named by its vertex of lowest index.
    pub component: VertexId,
}

impl ExtremumPair {
    /// Whether this is the lowest minimum or the highest maximum of its component, which never dies.
    pub fn is_essential(&self) -> bool {
        self.saddle.is_none()
    }

    /// `|h(saddle) - h(extremum)|` in the units of the field; `None` for an essential pair.
    ///
    /// # Arguments
    /// * `values`: the `n` values from which the vertex order was taken.
    pub fn persistence(&self, values: &[f64]) -> Option<f64> {
        self.saddle.map(|saddle| (values[saddle.index()] - values[self.extremum.index()]).abs())
    }
}

/// Pairs every minimum (maximum) with the vertex at which it dies, by the elder rule.
///
/// For minima this is dimension 0 of the lower-star persistence of `h`; for maxima, dimension 0 of `-h` with ties
/// broken by falling index, so that maxima on the boundary of the domain are included. Zero-persistence pairs are
/// included as well, so the extrema listed are all extrema of the order. Only the 1-skeleton is used; vertices
/// without neighbours are no extrema.
///
/// # Arguments
/// * `complex`: `n` vertices, any dimension.
/// * `order`: total order of the `n` vertices.
/// * `kind`: which extrema.
///
/// # Returns
/// One pair an extremum, most extreme first: minima by rising, maxima by falling rank.
///
/// # Panics
/// If `order` is of another number of vertices.
///
/// # Cost
/// Linear up to the inverse Ackermann function and a sort of the saddles; about 12 bytes a vertex. Parallel but for
/// one linear pass and the union–find on the saddles; the result does not depend on the number of threads.
///
/// # Source
/// Edelsbrunner, Letscher, Zomorodian 2002; union–find as in Edelsbrunner and Harer 2010, section VII.2.
///
/// # Example
/// ```
/// use morsmooth::field::{VertexId, VertexOrder};
/// use morsmooth::mesh::SimplicialComplex;
/// use morsmooth::morse::{ExtremumKind, extremum_pairs};
/// let line = SimplicialComplex::new(1, vec![[0.0; 3]; 4], vec![0, 1, 1, 2, 2, 3])?;
/// let order = VertexOrder::of_values(&[0.0, 3.0, 1.0, 2.0])?;
/// let minima = extremum_pairs(&line, &order, ExtremumKind::Minimum);
/// assert_eq!(minima.len(), 2);
/// assert_eq!((minima[0].extremum, minima[0].saddle), (VertexId(0), None));
/// assert_eq!((minima[1].extremum, minima[1].saddle), (VertexId(2), Some(VertexId(1))));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn extremum_pairs(complex: &SimplicialComplex, order: &VertexOrder, kind: ExtremumKind) -> Vec<ExtremumPair> {
    assert_eq!(
        order.len(),
        complex.vertex_count(),
        "the vertex order and the complex must have the same number of vertices"
    );
    minimum_pairs(&kind.descending(order), kind, |vertex| complex.neighbours(vertex).iter().copied())
}

/// Pairs of the minima of `order` on any graph; implicit grids give their neighbours without storing them.
fn minimum_pairs<I: Iterator<Item = VertexId>>(
    order: &VertexOrder,
    kind: ExtremumKind,
    neighbours: impl Fn(VertexId) -> I + Sync,
) -> Vec<ExtremumPair> {
    let basins = basins(order, &neighbours);
    let minima: Vec<VertexId> = order
        .sequence()
        .iter()
        .copied()
        .filter(|&vertex| basins[vertex.index()] == order.rank(vertex) && neighbours(vertex).next().is_some())
        .collect();
    // Of a minimum, by rank, its place in `minima`.
    let mut number = vec![NOT_A_MINIMUM; order.len()];
    for (place, &minimum) in minima.iter().enumerate() {
        number[order.rank(minimum) as usize] = place as u32;
    }
    let mut forest = Forest::new(minima.len());
    let mut saddles = vec![None; minima.len()];
    let mut meeting = Vec::new();
    for vertex in basin_borders(order, &basins, &neighbours) {
        meeting.clear();
        for below in neighbours(vertex).filter(|&neighbour| order.is_below(neighbour, vertex)) {
            meeting.push(forest.root(number[basins[below.index()] as usize]));
        }
        meeting.sort_unstable();
        meeting.dedup();
        // Minima are numbered by rank: the first is the eldest and lives on.
        for &younger in &meeting[1..] {
            saddles[younger as usize] = Some(vertex);
            forest.attach(younger, meeting[0]);
        }
    }
    // The name must be the same for minima and maxima, so it is the lowest vertex of all, not of the minima.
    let mut component = vec![VertexId(u32::MAX); minima.len()];
    for (vertex, &basin) in basins.iter().enumerate() {
        if number[basin as usize] != NOT_A_MINIMUM {
            let name = &mut component[forest.root(number[basin as usize]) as usize];
            *name = (*name).min(VertexId::from(vertex));
        }
    }
    let mut pairs = Vec::with_capacity(minima.len());
    for (place, &extremum) in minima.iter().enumerate() {
        let component = component[forest.root(place as u32) as usize];
        pairs.push(ExtremumPair { extremum, saddle: saddles[place], kind, component });
    }
    pairs
}

const NOT_A_MINIMUM: u32 = u32::MAX;

/// For every vertex the rank of the minimum at the end of its path of steepest descent in rank.
fn basins<I: Iterator<Item = VertexId>>(order: &VertexOrder, neighbours: &(impl Fn(VertexId) -> I + Sync)) -> Vec<u32> {
    let mut basins: Vec<u32> = (0..order.len())
        .into_par_iter()
        .map(|vertex| {
            let vertex = VertexId::from(vertex);
            neighbours(vertex).map(|neighbour| order.rank(neighbour)).fold(order.rank(vertex), u32::min)
        })
        .collect();
    for &vertex in order.sequence() {
        let below = order.sequence()[basins[vertex.index()] as usize];
        basins[vertex.index()] = basins[below.index()];
    }
    basins
}

/// Vertices whose lower neighbours lie in more than one basin, lowest first: all vertices where components may join.
fn basin_borders<I: Iterator<Item = VertexId>>(
    order: &VertexOrder,
    basins: &[u32],
    neighbours: &(impl Fn(VertexId) -> I + Sync),
) -> Vec<VertexId> {
    order
        .sequence()
        .par_iter()
        .copied()
        .filter(|&vertex| {
            let own = basins[vertex.index()];
            neighbours(vertex)
                .any(|neighbour| order.is_below(neighbour, vertex) && basins[neighbour.index()] != own)
        })
        .collect()
}
