//! The diagram from the gradient, dimension by dimension.

use rayon::prelude::*;

use crate::field::VertexOrder;
use crate::mesh::Triangulation;

use super::super::error::MorseError;
use super::super::gradient::{DiscreteGradient, discrete_gradient};
use super::critical::CriticalCells;
use super::extrema::{facets_with_tops, minima_with_edges};
use super::landscape::{Landscape, Ranks};
use super::pair::{PersistenceDiagram, PersistencePair};
use super::reduction::Boundary;

/// The persistence diagram, in all dimensions, of the lower-star filtration of a vertex order.
///
/// Coefficients are those modulo 2. The domain may have boundary, any number of components and any topology. Maxima on
/// the boundary are in no pair, since the sublevel sets do not see them; [`extremum_pairs`](crate::morse::extremum_pairs) of
/// both kinds lists all extrema.
///
/// # Arguments
/// * `mesh`: `n` vertices, dimension 1, 2 or 3, explicit or a grid. Vertices without neighbours are left out.
/// * `order`: total order of the `n` vertices; ties were broken by index.
///
/// # Errors
/// Those of [`discrete_gradient`].
///
/// # Cost
/// That of the gradient, and about linear time for dimension 0 and the last one; in three dimensions, the reduction of a
/// sparse matrix of the saddles that are left: 1 to 4 microseconds a pair on noise, but more than linear where tunnels are
/// bounded by very long cycles. Less than 100 bytes a vertex on a noisy 3-D grid, gradient included. Parallel; the result does not depend on the number of threads.
///
/// # Source
/// Guillou, Vidal, Tierny 2023, *Discrete Morse Sandwich: fast computation of persistence diagrams for scalar data*.
///
/// # Example
/// ```
/// use morsmooth::field::{VertexId, VertexOrder};
/// use morsmooth::mesh::SimplicialComplex;
/// use morsmooth::morse::persistence_diagram;
/// let circle = SimplicialComplex::new(1, vec![[0.0; 3]; 4], vec![0, 1, 1, 2, 2, 3, 3, 0])?;
/// let values = [0.0, 3.0, 1.0, 4.0];
/// let diagram = persistence_diagram(&circle, &VertexOrder::of_values(&values)?)?;
/// assert_eq!(diagram.betti_numbers(), [1, 1, 0, 0]); // a component and a tunnel
/// let finite = diagram.pairs().iter().find(|pair| !pair.is_essential()).ok_or("none")?;
/// assert_eq!((finite.birth_vertex, finite.death_vertex), (VertexId(2), Some(VertexId(1))));
/// assert_eq!(finite.persistence(&values), Some(2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn persistence_diagram<T: Triangulation>(mesh: &T, order: &VertexOrder) -> Result<PersistenceDiagram, MorseError> {
    Ok(diagram_of_gradient(mesh, order, &discrete_gradient(mesh, order)?))
}

/// The persistence diagram of a vertex order whose gradient is there already.
///
/// # Arguments
/// * `mesh`, `order`: as in [`persistence_diagram`].
/// * `gradient`: what [`discrete_gradient`] made of the two; one with cancelled pairs does not follow the order and gives
///   a diagram of no meaning.
///
/// # Panics
/// If the order or the gradient is of another number of vertices or cells.
///
/// # Cost
/// As [`persistence_diagram`], without the gradient.
pub fn diagram_of_gradient<T: Triangulation>(
    mesh: &T,
    order: &VertexOrder,
    gradient: &DiscreteGradient,
) -> PersistenceDiagram {
    diagram_of_gradient_by_stage(mesh, order, gradient, &mut |_| {})
}

/// A part of the work for a diagram that is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DiagramStage {
    /// The critical cells are sorted.
    CriticalCells,
    /// Minima are paired.
    Minima,
    /// Top cells are paired.
    TopCells,
    /// What is left between the two is paired.
    Saddles,
    /// The pairs are sorted.
    Pairs,
}

/// [`diagram_of_gradient`] that tells of every stage that is done.
///
/// # Arguments
/// * `mesh`, `order`, `gradient`: as there.
/// * `done`: called after each stage, in the order of [`DiagramStage`].
///
/// # Panics
/// As there.
pub fn diagram_of_gradient_by_stage<T: Triangulation>(
    mesh: &T,
    order: &VertexOrder,
    gradient: &DiscreteGradient,
    done: &mut dyn FnMut(DiagramStage),
) -> PersistenceDiagram {
    let landscape = Landscape::new(mesh, order, gradient);
    let dimension = landscape.dimension();
    let critical: Vec<CriticalCells> = (0..=dimension).map(|dimension| CriticalCells::new(&landscape, dimension)).collect();
    let mut matching = Matching::new(&critical);
    done(DiagramStage::CriticalCells);
    for (minimum, edge) in minima_with_edges(&landscape, &critical[0], &critical[1]).into_iter().enumerate() {
        matching.join(0, minimum, edge);
    }
    done(DiagramStage::Minima);
    if dimension > 1 {
        if landscape.is_dual_a_graph() {
            let facets = facets_with_tops(&landscape, &critical[dimension - 1], &critical[dimension]);
            for (top, facet) in facets.into_iter().enumerate() {
                if let Some(facet) = facet {
                    matching.join(dimension - 1, facet as usize, Some(top as u32));
                }
            }
        } else {
            matching.reduce(&landscape, dimension);
        }
    }
    done(DiagramStage::TopCells);
    if dimension > 2 {
        matching.reduce(&landscape, 2);
    }
    done(DiagramStage::Saddles);
    let diagram = matching.diagram(&landscape);
    done(DiagramStage::Pairs);
    diagram
}

/// Which critical cell ends what which one began.
struct Matching<'a> {
    critical: &'a [CriticalCells],
    /// By dimension and place: place of the cell of the next dimension that ends the class begun here.
    deaths: Vec<Vec<Option<u32>>>,
    /// By dimension and place: whether the cell ends a class of the dimension below.
    ends: Vec<Vec<bool>>,
}

impl<'a> Matching<'a> {
    fn new(critical: &'a [CriticalCells]) -> Self {
        let deaths = critical.iter().map(|cells| vec![None; cells.len()]).collect();
        let ends = critical.iter().map(|cells| vec![false; cells.len()]).collect();
        Self { critical, deaths, ends }
    }

    fn join(&mut self, dimension: usize, birth: usize, death: Option<u32>) {
        if let Some(place) = death {
            self.deaths[dimension][birth] = death;
            self.ends[dimension + 1][place as usize] = true;
        }
    }

    /// Pairs by reduction all cells of one dimension that begin no class with cells of the dimension below.
    fn reduce<T: Triangulation>(&mut self, landscape: &Landscape<'_, T>, dimension: usize) {
        let columns = &self.critical[dimension];
        let (rows, is_closed) = (&self.critical[dimension - 1], self.ends[dimension - 1].clone());
        let begins_none = |place: &u32| self.deaths[dimension][*place as usize].is_none();
        let places: Vec<u32> = columns.places().iter().copied().filter(begins_none).collect();
        let pairs = Boundary { landscape, rows, is_closed, columns }.pairs(&places);
        for (row, column) in pairs.into_iter().enumerate() {
            self.join(dimension - 1, row, column);
        }
    }

    fn diagram<T: Triangulation>(self, landscape: &Landscape<'_, T>) -> PersistenceDiagram {
        let (mut critical_counts, mut instant_counts) = ([0; 4], [0; 4]);
        let mut listed = Vec::new();
        for (dimension, cells) in self.critical.iter().enumerate() {
            let births: Vec<PersistencePair> = (0..cells.len())
                .into_par_iter()
                .filter(|&place| !self.ends[dimension][place])
                .filter_map(|place| self.pair(landscape, dimension, place))
                .collect();
            critical_counts[dimension] = cells.len();
            let ending = self.ends[dimension].iter().filter(|&&ends| ends).count();
            instant_counts[dimension] = cells.len() - ending - births.len();
            listed.push(births);
        }
        let pairs = by_birth(landscape, &listed);
        let (dimension, highest_vertex) = (landscape.dimension(), landscape.highest_vertex());
        PersistenceDiagram { dimension, pairs, critical_counts, instant_counts, highest_vertex }
    }

    /// The class that a cell begins, unless it ends at the vertex at which it begins.
    fn pair<T: Triangulation>(
        &self,
        landscape: &Landscape<'_, T>,
        dimension: usize,
        place: usize,
    ) -> Option<PersistencePair> {
        let level = self.critical[dimension].levels()[place];
        let death = self.deaths[dimension][place];
        let death_level = death.map(|place| self.critical[dimension + 1].levels()[place as usize]);
        (death_level != Some(level)).then(|| PersistencePair {
            birth: self.critical[dimension].cell(place as u32),
            death: death.map(|place| self.critical[dimension + 1].cell(place)),
            birth_vertex: landscape.vertex_at(level),
            death_vertex: death_level.map(|level| landscape.vertex_at(level)),
            dimension: dimension as u8,
        })
    }
}

/// Merges lists of pairs that are sorted by birth.
fn by_birth<T: Triangulation>(landscape: &Landscape<'_, T>, lists: &[Vec<PersistencePair>]) -> Vec<PersistencePair> {
    let mut merged = Vec::with_capacity(lists.iter().map(Vec::len).sum());
    let mut heads: Vec<(Ranks, std::slice::Iter<PersistencePair>)> = Vec::new();
    let ranks = |pair: Option<&PersistencePair>| pair.map_or(PAST_ALL, |pair| landscape.ranks(pair.birth));
    for list in lists {
        heads.push((ranks(list.first()), list.iter()));
    }
    while let Some((head, rest)) = heads.iter_mut().min_by_key(|(head, _)| *head) {
        let Some(pair) = rest.next() else { break };
        merged.push(*pair);
        *head = ranks(rest.as_slice().first());
    }
    merged
}

/// Above the ranks of every cell.
const PAST_ALL: Ranks = [u32::MAX; 4];
