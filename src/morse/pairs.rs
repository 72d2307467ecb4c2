//! Extremum pairs: which extremum of a field dies at which vertex, by union–find on the vertex order.

use crate::field::{VertexId, VertexOrder};
use crate::mesh::Triangulation;

use super::sweep::{Age, Basins, basins};
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
/// Linear up to a sort of the vertices whose lower link is not connected and the inverse Ackermann function; 4 bytes a vertex
/// and 12 for each such vertex, 24 while they are sorted. Parallel but for the union–find on basins; the result does not
/// depend on the number of threads.
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
    let age = Age { ranks: order.ranks(), turn: turn_of(kind) };
    let Basins { extrema, passes, components } = basins(complex, age);
    let mut forest = Forest::new(extrema.len());
    let mut saddles = vec![None; extrema.len()];
    for (age, one, other) in passes {
        let (one, other) = (forest.root(one), forest.root(other));
        if one != other {
            // Extrema are numbered by age: the one of lower number is the elder and lives on.
            let (elder, younger) = (one.min(other), one.max(other));
            saddles[younger as usize] = Some(order.sequence()[(age ^ turn_of(kind)) as usize]);
            forest.attach(younger, elder);
        }
    }
    // The name must be the same for minima and maxima, so it is the lowest vertex of all, not of the extrema.
    let mut component = components;
    for place in 0..extrema.len() {
        let root = forest.root(place as u32) as usize;
        component[root] = component[root].min(component[place]);
    }
    let pair = |(place, &extremum): (usize, &VertexId)| {
        let component = component[forest.root(place as u32) as usize];
        ExtremumPair { extremum, saddle: saddles[place], kind, component }
    };
    extrema.iter().enumerate().map(pair).collect()
}

/// What turns ranks around where maxima are the extrema, so that they are the first by the turned ranks.
const fn turn_of(kind: ExtremumKind) -> u32 {
    match kind {
        ExtremumKind::Minimum => 0,
        ExtremumKind::Maximum => u32::MAX,
    }
}
