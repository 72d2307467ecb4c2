//! Extremum pairs: which extremum of a field dies at which vertex, by union–find on the vertex order.

use rayon::prelude::*;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::Triangulation;

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
/// Linear up to a sort of the vertices where basins meet and the inverse Ackermann function; 8 bytes a vertex and 12 for
/// each such vertex. Parallel but for linear passes and the union–find on basins; the result does not depend on the
/// number of threads.
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
pub fn extremum_pairs<T: Triangulation>(complex: &T, order: &VertexOrder, kind: ExtremumKind) -> Vec<ExtremumPair> {
    assert_eq!(
        order.len(),
        complex.vertex_count(),
        "the vertex order and the complex must have the same number of vertices"
    );
    minimum_pairs(&kind.descending(order), kind, |vertex| complex.neighbours(vertex))
}

/// Pairs of the minima of `order` on any graph; implicit grids give their neighbours without storing them.
///
/// Vertices are visited by index wherever that is possible: neighbours are near in memory then, in the order of a noisy
/// field they are not.
fn minimum_pairs<I: Iterator<Item = VertexId>>(
    order: &VertexOrder,
    kind: ExtremumKind,
    neighbours: impl Fn(VertexId) -> I + Sync,
) -> Vec<ExtremumPair> {
    let Basins { minima, basin } = basins(order, &neighbours);
    let mut forest = Forest::new(minima.len());
    let mut saddles = vec![None; minima.len()];
    for (rank, one, other) in passes(order, &basin, &neighbours) {
        let (one, other) = (forest.root(one), forest.root(other));
        if one != other {
            // Minima are numbered by rank: the one of lower number is the elder and lives on.
            let (elder, younger) = (one.min(other), one.max(other));
            saddles[younger as usize] = Some(order.sequence()[rank as usize]);
            forest.attach(younger, elder);
        }
    }
    // The name must be the same for minima and maxima, so it is the lowest vertex of all, not of the minima.
    let mut component = vec![VertexId(u32::MAX); minima.len()];
    for (vertex, &basin) in basin.iter().enumerate().filter(|&(_, &basin)| basin != NO_BASIN) {
        let name = &mut component[basin as usize];
        *name = (*name).min(VertexId::from(vertex));
    }
    for place in 0..minima.len() {
        let root = forest.root(place as u32) as usize;
        component[root] = component[root].min(component[place]);
    }
    let mut pairs = Vec::with_capacity(minima.len());
    for (place, &extremum) in minima.iter().enumerate() {
        let component = component[forest.root(place as u32) as usize];
        pairs.push(ExtremumPair { extremum, saddle: saddles[place], kind, component });
    }
    pairs
}

const NO_BASIN: u32 = u32::MAX;

/// The minima by rank, and for every vertex the number of the one in which steepest descent ends.
struct Basins {
    minima: Vec<VertexId>,
    /// `NO_BASIN` for vertices without neighbours.
    basin: Vec<u32>,
}

fn basins<I: Iterator<Item = VertexId>>(order: &VertexOrder, neighbours: &(impl Fn(VertexId) -> I + Sync)) -> Basins {
    let steepest: Vec<VertexId> = (0..order.len())
        .into_par_iter()
        .map(|vertex| {
            let vertex = VertexId::from(vertex);
            neighbours(vertex).fold(vertex, |low, next| if order.is_below(next, low) { next } else { low })
        })
        .collect();
    let is_minimum = |&vertex: &VertexId| steepest[vertex.index()] == vertex && neighbours(vertex).next().is_some();
    let mut minima: Vec<VertexId> = (0..order.len()).into_par_iter().map(VertexId::from).filter(is_minimum).collect();
    minima.par_sort_unstable_by_key(|&vertex| order.rank(vertex));
    let mut basin = vec![NO_BASIN; order.len()];
    for (place, minimum) in minima.iter().enumerate() {
        basin[minimum.index()] = place as u32;
    }
    let mut path = Vec::new();
    for start in 0..order.len() {
        let mut vertex = VertexId::from(start);
        while basin[vertex.index()] == NO_BASIN && steepest[vertex.index()] != vertex {
            path.push(vertex);
            vertex = steepest[vertex.index()];
        }
        for passed in path.drain(..) {
            basin[passed.index()] = basin[vertex.index()];
        }
    }
    Basins { minima, basin }
}

/// Where basins meet: the rank of a vertex, its basin, and another basin among its lower neighbours; by rising rank.
///
/// Components of sublevel sets join only there: all lower neighbours of any other vertex are in one component already.
fn passes<I: Iterator<Item = VertexId>>(
    order: &VertexOrder,
    basin: &[u32],
    neighbours: &(impl Fn(VertexId) -> I + Sync),
) -> Vec<(u32, u32, u32)> {
    let mut passes: Vec<(u32, u32, u32)> = (0..order.len())
        .into_par_iter()
        .fold(Vec::new, |mut passes, vertex| {
            let vertex = VertexId::from(vertex);
            let (rank, own) = (order.rank(vertex), basin[vertex.index()]);
            for below in neighbours(vertex).filter(|&neighbour| order.rank(neighbour) < rank) {
                let pass = (rank, own, basin[below.index()]);
                if pass.2 != own && passes.last() != Some(&pass) {
                    passes.push(pass);
                }
            }
            passes
        })
        .flatten_iter()
        .collect();
    // Passes that are listed twice are the same in every respect, so an unstable sort has one possible result.
    passes.par_sort_unstable();
    passes
}
