//! The hierarchy of cancellations: one computation, the simplified gradient at every threshold.

use std::collections::BTreeMap;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::{Cell, SimplicialComplex};

use super::ascent::{self, BRANCHING, OUTSIDE, Summit};
use super::basins::{BasinHierarchy, BasinMerge};
use super::error::MorseError;
use super::forest::Forest;
use super::gradient::{DiscreteGradient, Pairing, discrete_gradient};
use super::pairs::ExtremumKind;
use super::segmentation::Segmentation;
use super::selection::WantedExtrema;
use super::star::{cofacets, key};

/// Two critical cells of adjacent dimension that cancel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellCancellation {
    /// The critical cell of lower dimension: a minimum, or the saddle below a maximum.
    pub lower: Cell,
    /// The critical cell of higher dimension: the saddle above a minimum, or a maximum.
    pub upper: Cell,
    /// Highest vertex of the extremum of the two.
    pub extremum: VertexId,
    /// Difference of the values at the highest vertices, in the units of the field.
    pub persistence: f64,
    /// Lowest threshold at which the two are cancelled, in the units of the field; `INFINITY` for never. It exceeds
    /// `persistence` for a maximum that rises out of the domain long before it meets a higher one: see
    /// [`MorseHierarchy`].
    pub level: f64,
}

/// The discrete gradient of a field with the list of its cancellations, simplified to any threshold, up and down.
///
/// *What cancels.* Minima with the edges at which they die and, from dimension 2 on, maxima (critical top cells) with the
/// facets at which they die, both by the elder rule in the lower-star filtration, and each by reversing the one V-path
/// between the two. In dimension 3, 1-saddles and 2-saddles are left as they are: their V-paths are mostly many. Across
/// facets of three or more top cells nothing is cancelled.
///
/// *In which order.* By rising persistence, so that every threshold is a prefix of one list and moving between two
/// thresholds costs only the V-paths in between. For a domain with boundary two persistences of a maximum differ: in
/// the sublevel filtration it dies as soon as its hill touches the boundary; in dimension 0 of `-h`, which decides what is
/// kept everywhere in this crate, it dies where its hill meets a higher one. A maximum is cancelled at the larger of
/// the two, so the maxima left in the interior are those of [`extremum_pairs`](super::extremum_pairs). Maxima on the
/// boundary have no critical top cell; [`maxima`](Self::maxima) has them.
///
/// # Example
/// ```
/// use morsmooth::field::VertexOrder;
/// use morsmooth::mesh::SimplicialComplex;
/// use morsmooth::morse::MorseHierarchy;
/// let line = SimplicialComplex::new(1, vec![[0.0; 3]; 5], vec![0, 1, 1, 2, 2, 3, 3, 4])?;
/// let values = [0.0, 3.0, 1.0, 2.0, 1.5];
/// let mut hierarchy = MorseHierarchy::new(&line, &values, &VertexOrder::of_values(&values)?)?;
/// assert_eq!(hierarchy.gradient().critical_counts(), [3, 2, 0, 0]);
/// assert_eq!(hierarchy.at(1.0).critical_counts(), [2, 1, 0, 0]);
/// assert_eq!(hierarchy.at(0.1).critical_counts(), [3, 2, 0, 0]); // and back
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct MorseHierarchy<'a> {
    complex: &'a SimplicialComplex,
    order: &'a VertexOrder,
    gradient: DiscreteGradient,
    minima: BasinHierarchy,
    maxima: BasinHierarchy,
    cancellations: Vec<CellCancellation>,
    /// Places of the cancellations done, in that order.
    done: Vec<usize>,
    choice: Choice,
}

/// What was asked for last.
#[derive(Debug, Clone)]
enum Choice {
    Above(f64),
    Maxima(Vec<VertexId>),
}

impl<'a> MorseHierarchy<'a> {
    /// Builds the discrete gradient and pairs its critical cells.
    ///
    /// # Arguments
    /// * `complex`: `n` vertices, dimension 1, 2 or 3.
    /// * `values`: `n` finite values.
    /// * `order`: the order of the values.
    ///
    /// # Errors
    /// As [`discrete_gradient`], and [`MorseError::ValuesLength`].
    ///
    /// # Cost
    /// Linear in the cells up to the logarithm of the longest V-path and sorts of the critical cells. Parallel but for the
    /// union–find on critical cells; the result does not depend on the number of threads.
    ///
    /// # Source
    /// Forman 1998, theorem 11.1; Edelsbrunner, Harer, Zomorodian 2003; for critical top cells by union–find on their
    /// graph, with the boundary as the eldest: Guillou, Vidal, Tierny 2023, section 4.
    pub fn new(complex: &'a SimplicialComplex, values: &[f64], order: &'a VertexOrder) -> Result<Self, MorseError> {
        let gradient = discrete_gradient(complex, order)?;
        let minima = BasinHierarchy::new(complex, values, order, ExtremumKind::Minimum)?;
        let maxima = BasinHierarchy::new(complex, values, order, ExtremumKind::Maximum)?;
        let mut cancellations = lower_cancellations(complex, &minima);
        if complex.dimension() > 1 {
            cancellations.extend(upper_cancellations(complex, &gradient, values, order, &maxima));
        }
        // Stable: both lists come nested first.
        cancellations.sort_by(|a, b| a.level.total_cmp(&b.level));
        Ok(Self { complex, order, gradient, minima, maxima, cancellations, done: Vec::new(), choice: Choice::Above(f64::NEG_INFINITY) })
    }

    /// The complex.
    pub fn complex(&self) -> &'a SimplicialComplex {
        self.complex
    }

    /// The order of its vertices.
    pub fn order(&self) -> &'a VertexOrder {
        self.order
    }

    /// The gradient, simplified as far as it is now.
    pub fn gradient(&self) -> &DiscreteGradient {
        &self.gradient
    }

    /// Basins of the minima.
    pub fn minima(&self) -> &BasinHierarchy {
        &self.minima
    }

    /// Basins of the maxima, those on the boundary included.
    pub fn maxima(&self) -> &BasinHierarchy {
        &self.maxima
    }

    /// All cancellations by rising level.
    pub fn cancellations(&self) -> &[CellCancellation] {
        &self.cancellations
    }

    /// The cancellations that are done now.
    pub fn cancelled(&self) -> impl Iterator<Item = &CellCancellation> {
        self.done.iter().map(|&place| &self.cancellations[place])
    }

    /// Simplifies, or restores, to a threshold: what remains exceeds it strictly. Below 0, nothing is cancelled.
    ///
    /// # Arguments
    /// * `threshold`: in the units of the field.
    ///
    /// # Cost
    /// Linear in the cancellations and in the lengths of the V-paths between the last threshold and this one.
    pub fn at(&mut self, threshold: f64) -> &DiscreteGradient {
        self.choice = Choice::Above(threshold);
        self.retaining(|cancellation| cancellation.level > threshold)
    }

    /// Simplifies to a choice of extrema, such as the most persistent ones.
    ///
    /// # Arguments
    /// * `wanted`: extrema chosen by persistence, by [`select`](super::select). Of equal persistences some may be wanted
    ///   and some not.
    ///
    /// # Cost
    /// As [`at`](Self::at).
    pub fn keeping(&mut self, wanted: &WantedExtrema) -> &DiscreteGradient {
        let is_wanted = |vertex, list: &[VertexId]| list.binary_search(&vertex).is_ok();
        let unwanted = |hierarchy: &BasinHierarchy, list: &[VertexId]| {
            let unwanted = hierarchy.merges().iter().filter(|merge| !is_wanted(merge.extremum, list));
            unwanted.map(|merge| merge.persistence).fold(f64::NEG_INFINITY, f64::max)
        };
        let threshold = unwanted(&self.minima, &wanted.minima).max(unwanted(&self.maxima, &wanted.maxima));
        self.choice = Choice::Maxima(wanted.maxima.clone());
        self.retaining(|cancellation| {
            let list = if cancellation.lower.dimension == 0 { &wanted.minima } else { &wanted.maxima };
            cancellation.level > threshold || is_wanted(cancellation.extremum, list)
        })
    }

    /// Every vertex with its minimum, as far as the hierarchy is simplified now.
    pub fn minimum_segmentation(&self) -> Segmentation {
        self.minima.segmentation(|merge| !self.gradient.is_critical(Cell::vertex(merge.extremum)))
    }

    /// Every vertex with its maximum, as far as the hierarchy is simplified now.
    pub fn maximum_segmentation(&self) -> Segmentation {
        self.maxima.segmentation(|merge| self.is_maximum_merged(merge))
    }

    /// The successor of every vertex on its V-path up to a maximum; a maximum is its own.
    pub(super) fn maximum_successors(&self) -> Vec<u32> {
        self.maxima.successors(|merge| self.is_maximum_merged(merge))
    }

    fn is_maximum_merged(&self, merge: &BasinMerge) -> bool {
        match &self.choice {
            Choice::Above(threshold) => merge.persistence <= *threshold,
            Choice::Maxima(wanted) => wanted.binary_search(&merge.extremum).is_err(),
        }
    }

    /// Does all cancellations but those to be retained, after undoing those that are not among them any more.
    fn retaining(&mut self, retained: impl Fn(&CellCancellation) -> bool) -> &DiscreteGradient {
        let chosen: Vec<usize> = (0..self.cancellations.len())
            .filter(|&place| self.cancellations[place].level.is_finite() && !retained(&self.cancellations[place]))
            .collect();
        let common = self.done.iter().zip(&chosen).take_while(|(done, chosen)| done == chosen).count();
        for place in self.done.split_off(common).into_iter().rev() {
            self.undo(&self.cancellations[place].clone());
        }
        for &place in &chosen[common..] {
            if self.cancel(&self.cancellations[place].clone()) {
                self.done.push(place);
            }
        }
        &self.gradient
    }

    /// Reverses the one V-path between the two cells; does nothing if there is none, or more than one.
    fn cancel(&mut self, pair: &CellCancellation) -> bool {
        if !self.gradient.is_critical(pair.lower) || !self.gradient.is_critical(pair.upper) {
            return false;
        }
        let Some(path) = (match pair.lower.dimension {
            0 => self.path_down(pair),
            _ => self.path_up(pair),
        }) else {
            return false;
        };
        for step in path.chunks_exact(2) {
            self.join(step[0], step[1]);
        }
        true
    }

    /// Restores the V-path that [`cancel`](Self::cancel) has reversed.
    fn undo(&mut self, pair: &CellCancellation) {
        // From the extremum back along the reversed path, which ends in the saddle.
        let (extremum, saddle) =
            if pair.lower.dimension == 0 { (pair.lower, pair.upper) } else { (pair.upper, pair.lower) };
        let mut path = vec![extremum];
        let mut around = Vec::new();
        let mut last = extremum;
        loop {
            let between = match self.gradient.pairing(last) {
                Pairing::Up(cell) | Pairing::Down(cell) => cell,
                Pairing::Critical | Pairing::Outside => return,
            };
            path.push(between);
            if between == saddle {
                break;
            }
            if last.dimension == 0 {
                let [a, b] = self.complex.edges()[between.index as usize];
                last = Cell::vertex(if a.0 == last.index { b } else { a });
            } else {
                cofacets(self.complex, between, &mut around);
                match around.iter().find(|&&cell| cell != last) {
                    Some(&next) => last = next,
                    None => return,
                }
            }
            path.push(last);
        }
        self.gradient.release(extremum);
        self.gradient.release(saddle);
        for step in path[1..path.len() - 1].chunks_exact(2) {
            self.join(step[0], step[1]);
        }
    }

    fn join(&mut self, a: Cell, b: Cell) {
        if a.dimension < b.dimension { self.gradient.pair(a, b) } else { self.gradient.pair(b, a) }
    }

    /// The V-path from an edge down to a minimum, if exactly one of its two leads there.
    fn path_down(&self, pair: &CellCancellation) -> Option<Vec<Cell>> {
        let minimum = VertexId(pair.lower.index);
        let ends = self.complex.edges()[pair.upper.index as usize];
        let leads = ends.map(|end| self.gradient.descent_end(self.complex, end) == minimum);
        let mut vertex = match leads {
            [true, false] => ends[0],
            [false, true] => ends[1],
            _ => return None,
        };
        let mut path = vec![pair.upper, Cell::vertex(vertex)];
        while let Some((edge, next)) = self.gradient.step(self.complex, vertex) {
            path.extend([Cell::edge(edge), Cell::vertex(next)]);
            vertex = next;
        }
        Some(path)
    }

    /// The V-path between a facet and a maximum, if there is exactly one.
    fn path_up(&self, pair: &CellCancellation) -> Option<Vec<Cell>> {
        let mut around = Vec::new();
        cofacets(self.complex, pair.lower, &mut around);
        let mut only = None;
        for &top in &around {
            let (path, summit) = ascent::path(self.complex, &self.gradient, pair.lower, top);
            match summit {
                Summit::Branching => return None,
                Summit::Critical(cell) if cell == pair.upper => {
                    if only.replace(path).is_some() {
                        return None;
                    }
                }
                Summit::Critical(_) | Summit::Boundary(_) => {}
            }
        }
        only
    }
}

/// Minima with their edges.
fn lower_cancellations(complex: &SimplicialComplex, minima: &BasinHierarchy) -> Vec<CellCancellation> {
    let pair = |merge: &BasinMerge| {
        let edge = complex.edge(merge.edge[0], merge.edge[1])?;
        Some(CellCancellation {
            lower: Cell::vertex(merge.extremum),
            upper: Cell::edge(edge),
            extremum: merge.extremum,
            persistence: merge.persistence,
            level: merge.persistence,
        })
    };
    minima.merges().iter().filter_map(pair).collect()
}

/// Maxima with the facets at which they die: union–find on top cells by falling facet. What has risen out of the domain is
/// older than any maximum.
fn upper_cancellations(
    complex: &SimplicialComplex,
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
        found.push(CellCancellation { lower: *facet, upper: *top, extremum, persistence, level });
    }
    found
}
