//! The extremum graph: extrema of one kind, the saddles between them, and its simplification.

use std::borrow::Cow;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::{EdgeId, SimplicialComplex};

use super::error::MorseError;
use super::forest::Forest;
use crate::mesh::Cell;
use super::gradient::{DiscreteGradient, discrete_gradient};
use super::pairs::ExtremumKind;

/// A critical edge, from whose ends V-paths lead to two extrema or twice to the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Saddle {
    /// The critical edge.
    pub edge: EdgeId,
    /// The end of the edge that lies higher (for maxima: lower), where sets join: the saddle as a vertex.
    pub vertex: VertexId,
    /// Whether the saddle joins two extrema that nothing below (above) it joins. Otherwise it closes a cycle.
    pub joins: bool,
}

/// A cancelled pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cancellation {
    /// The extremum that is none any more.
    pub extremum: VertexId,
    /// The critical edge that is none any more.
    pub saddle: EdgeId,
    /// The end of the edge that names its value.
    pub saddle_vertex: VertexId,
    /// `|h(saddle_vertex) - h(extremum)|`, in the units of the field.
    pub persistence: f64,
}

/// Extrema of one kind, the saddles between them, and the V-paths that connect them.
///
/// For minima it holds the discrete gradient of `h`, for maxima that of `-h` with reversed ties, so that extrema on
/// the boundary of the domain count and every separatrix is a path of vertices and edges.
#[derive(Debug, Clone)]
pub struct ExtremumGraph<'a> {
    complex: &'a SimplicialComplex,
    kind: ExtremumKind,
    /// The order in which extrema of this kind are minima.
    order: Cow<'a, VertexOrder>,
    gradient: DiscreteGradient,
    cancellations: Vec<Cancellation>,
}

/// What joins at a critical edge.
struct Junction {
    saddle: Saddle,
    /// The extremum that dies here, if any.
    dies: Option<VertexId>,
}

impl<'a> ExtremumGraph<'a> {
    /// Builds the discrete gradient in which extrema of this kind are critical vertices.
    ///
    /// # Errors
    /// As [`discrete_gradient`].
    ///
    /// # Cost
    /// As [`discrete_gradient`].
    pub fn new(complex: &'a SimplicialComplex, order: &'a VertexOrder, kind: ExtremumKind) -> Result<Self, MorseError> {
        let order = kind.descending(order);
        let gradient = discrete_gradient(complex, &order)?;
        Ok(Self { complex, kind, order, gradient, cancellations: Vec::new() })
    }

    /// Which extrema.
    pub fn kind(&self) -> ExtremumKind {
        self.kind
    }

    /// The gradient, simplified as far as the graph is.
    pub fn gradient(&self) -> &DiscreteGradient {
        &self.gradient
    }

    /// What was cancelled, in that order.
    pub fn cancellations(&self) -> &[Cancellation] {
        &self.cancellations
    }

    /// The extrema that are left, by rising index.
    pub fn extrema(&self) -> Vec<VertexId> {
        self.gradient.critical_cells(0).map(|cell| VertexId(cell.index)).collect()
    }

    /// The V-path from a vertex to its extremum, both included.
    ///
    /// In the simplified gradient `h` may rise and fall along it, but no V-path is closed.
    pub fn path(&self, vertex: VertexId) -> Vec<VertexId> {
        self.gradient.descent(self.complex, vertex)
    }

    /// The successor of every vertex on its V-path; `None` at an extremum. All V-paths at once: a forest.
    ///
    /// # Cost
    /// Linear.
    pub fn successors(&self) -> Vec<Option<VertexId>> {
        (0..self.complex.vertex_count())
            .map(|vertex| self.gradient.step(self.complex, vertex.into()).map(|(_, next)| next))
            .collect()
    }

    /// The saddles that are left, lowest first (for maxima: highest first).
    ///
    /// # Cost
    /// Linear in the number of vertices, and a sort of the saddles.
    pub fn saddles(&self) -> Vec<Saddle> {
        self.junctions(|_| true).into_iter().map(|junction| junction.saddle).collect()
    }

    /// The two separatrices of a saddle, each from its vertex to an extremum, both ends included. The second one crosses
    /// the critical edge with its first step.
    ///
    /// Those of a saddle that joins end at different extrema and share its vertex only. Those of different saddles merge
    /// where they meet: but for that first step, every vertex has one [successor](Self::successors).
    ///
    /// # Arguments
    /// * `saddle`: one of [`saddles`](Self::saddles).
    ///
    /// # Cost
    /// Linear in their lengths, which in a simplified field may be much of the domain.
    pub fn separatrices(&self, saddle: &Saddle) -> [Vec<VertexId>; 2] {
        let [a, b] = self.complex.edges()[saddle.edge.0 as usize];
        let mut across = vec![saddle.vertex];
        across.extend(self.path(if a == saddle.vertex { b } else { a }));
        [self.path(saddle.vertex), across]
    }

    /// Cancels every extremum but the wanted ones, in order of persistence.
    ///
    /// An unwanted extremum dies at the saddle where its component of the sublevel (superlevel) sets first meets one
    /// with a wanted extremum or, among unwanted ones, an elder. With wanted extrema chosen by a persistence
    /// threshold these are the pairs of [`extremum_pairs`](super::extremum_pairs).
    ///
    /// # Arguments
    /// * `values`: the `n` values from which the order was taken.
    /// * `wanted`: extrema that are left; at least one in every component.
    ///
    /// # Returns
    /// What was cancelled now, in that order; [`cancellations`](Self::cancellations) holds all.
    ///
    /// # Errors
    /// [`MorseError::NotAnExtremum`], [`MorseError::ComponentWithout`], [`MorseError::ValuesLength`]; the graph is
    /// then as it was.
    ///
    /// # Cost
    /// Linear in the number of vertices and in the lengths of the reversed V-paths.
    ///
    /// # Source
    /// Forman 1998, theorem 11.1; order of cancellation: Edelsbrunner, Harer, Zomorodian 2003.
    pub fn simplify(&mut self, values: &[f64], wanted: &[VertexId]) -> Result<&[Cancellation], MorseError> {
        let vertices = self.complex.vertex_count();
        if values.len() != vertices {
            return Err(MorseError::ValuesLength { expected: vertices, found: values.len() });
        }
        let mut is_wanted = vec![false; vertices];
        for &vertex in wanted {
            if vertex.index() >= vertices || !self.gradient.is_critical(Cell::vertex(vertex)) {
                return Err(MorseError::NotAnExtremum { vertex });
            }
            is_wanted[vertex.index()] = true;
        }
        let mut planned: Vec<Cancellation> = self
            .junctions(|vertex| is_wanted[vertex.index()])
            .into_iter()
            .filter_map(|junction| {
                let extremum = junction.dies?;
                let Saddle { edge, vertex, .. } = junction.saddle;
                let persistence = (values[vertex.index()] - values[extremum.index()]).abs();
                Some(Cancellation { extremum, saddle: edge, saddle_vertex: vertex, persistence })
            })
            .collect();
        let left = self.extrema().len() - planned.len();
        if left != is_wanted.iter().filter(|&&wanted| wanted).count() {
            return Err(self.component_without(&is_wanted));
        }
        // Junctions come by rising saddle. A pair nested in another one has the lower saddle and no greater
        // persistence, so a stable sort puts it first, as the uniqueness of V-paths needs.
        planned.sort_by(|a, b| a.persistence.total_cmp(&b.persistence));
        let mut gradient = self.gradient.clone();
        for cancellation in &planned {
            gradient.cancel(self.complex, cancellation.saddle, cancellation.extremum)?;
        }
        self.gradient = gradient;
        let before = self.cancellations.len();
        self.cancellations.extend(planned);
        Ok(&self.cancellations[before..])
    }

    /// Names the first component without a wanted extremum.
    fn component_without(&self, is_wanted: &[bool]) -> MorseError {
        let (component, count) = self.complex.components();
        let mut lowest = vec![None; count];
        let mut served = vec![false; count];
        for (vertex, &number) in component.iter().enumerate() {
            lowest[number as usize].get_or_insert(VertexId::from(vertex));
            let isolated = self.complex.neighbours(vertex.into()).is_empty();
            served[number as usize] |= is_wanted[vertex] || isolated;
        }
        let first = served.iter().position(|&served| !served).and_then(|number| lowest[number]);
        MorseError::ComponentWithout { kind: self.kind, component: first.unwrap_or(VertexId(0)) }
    }

    /// What joins at every critical edge, by rising saddle. Of two sets that join, the one whose extremum is not
    /// `eternal` dies; of two such, the younger; of two eternal ones, none.
    fn junctions(&self, eternal: impl Fn(VertexId) -> bool) -> Vec<Junction> {
        let order = &*self.order;
        let mut edges: Vec<(u32, u32, EdgeId, VertexId, VertexId)> = self
            .gradient
            .critical_cells(1)
            .map(|cell| {
                let [a, b] = self.complex.edges()[cell.index as usize];
                let (low, high) = if order.is_below(a, b) { (a, b) } else { (b, a) };
                (order.rank(high), order.rank(low), EdgeId(cell.index), low, high)
            })
            .collect();
        edges.sort_unstable();
        let (extrema, extremum_of) = self.extrema_by_vertex();
        let mut forest = Forest::new(extrema.len());
        let mut junctions = Vec::with_capacity(edges.len());
        for (_, _, edge, low, vertex) in edges {
            let mut roots = [low, vertex].map(|end| forest.root(extremum_of[end.index()]));
            let joins = roots[0] != roots[1];
            let mut junction = Junction { saddle: Saddle { edge, vertex, joins }, dies: None };
            if joins {
                let age = |root: u32| {
                    let extremum = extrema[root as usize];
                    (!eternal(extremum), order.rank(extremum))
                };
                roots.sort_unstable_by_key(|&root| age(root));
                let [elder, younger] = roots;
                forest.attach(younger, elder);
                let extremum = extrema[younger as usize];
                junction.dies = (!eternal(extremum)).then_some(extremum);
            }
            junctions.push(junction);
        }
        junctions
    }

    /// The extrema, and for every vertex the place of the one at the end of its V-path.
    fn extrema_by_vertex(&self) -> (Vec<VertexId>, Vec<u32>) {
        const UNSEEN: u32 = u32::MAX;
        let extrema = self.extrema();
        let mut extremum_of = vec![UNSEEN; self.complex.vertex_count()];
        for (place, extremum) in extrema.iter().enumerate() {
            extremum_of[extremum.index()] = place as u32;
        }
        let mut path = Vec::new();
        for start in 0..extremum_of.len() {
            let mut vertex = VertexId::from(start);
            while extremum_of[vertex.index()] == UNSEEN {
                match self.gradient.step(self.complex, vertex) {
                    Some((_, next)) => {
                        path.push(vertex);
                        vertex = next;
                    }
                    None => break,
                }
            }
            let place = extremum_of[vertex.index()];
            for passed in path.drain(..) {
                extremum_of[passed.index()] = place;
            }
        }
        (extrema, extremum_of)
    }
}
