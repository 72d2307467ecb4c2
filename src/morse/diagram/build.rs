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
/// the boundary are in no pair, since the sublevel sets do not see them; [`extremum_pairs`](super::extremum_pairs) of
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
/// sparse matrix of the saddles that are left. Parallel; the result does not depend on the number of threads.
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
/// * `done`: called after each stage.
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
        let mut pairs: Vec<(Ranks, PersistencePair)> = Vec::new();
        let (mut critical_counts, mut instant_counts) = ([0; 4], [0; 4]);
        for (dimension, cells) in self.critical.iter().enumerate() {
            critical_counts[dimension] = cells.len();
            let listed = pairs.len();
            let births = (0..cells.len()).into_par_iter().filter(|&place| !self.ends[dimension][place]);
            pairs.par_extend(births.filter_map(|place| {
                let birth = cells.cell(place as u32);
                let ranks = landscape.ranks(birth);
                let death = self.deaths[dimension][place].map(|place| self.critical[dimension + 1].cell(place));
                let level = death.map(|death| landscape.level(death));
                let pair = PersistencePair {
                    birth,
                    death,
                    birth_vertex: landscape.vertex_at(ranks[0]),
                    death_vertex: level.map(|level| landscape.vertex_at(level)),
                    dimension: dimension as u8,
                };
                (level != Some(ranks[0])).then_some((ranks, pair))
            }));
            let births = self.ends[dimension].iter().filter(|&&ends| !ends).count();
            instant_counts[dimension] = births - (pairs.len() - listed);
        }
        // No two cells have the same vertices, so an unstable sort has one possible result.
        pairs.par_sort_unstable_by_key(|&(ranks, _)| ranks);
        let pairs = pairs.into_iter().map(|(_, pair)| pair).collect();
        let (dimension, highest_vertex) = (landscape.dimension(), landscape.highest_vertex());
        PersistenceDiagram { dimension, pairs, critical_counts, instant_counts, highest_vertex }
    }
}
