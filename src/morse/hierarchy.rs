//! The hierarchy of cancellations: one computation, the simplified gradient at every threshold.

use crate::field::{VertexId, VertexOrder};
use crate::mesh::{Cell, Triangulation};

use super::ascent::{self, Summit};
use super::basins::{BasinHierarchy, BasinMerge};
use super::cancellations::{CellCancellation, of_saddles, with_maxima, with_minima};
use super::connector::unique_path;
use super::error::MorseError;
use super::gradient::{DiscreteGradient, Pairing, discrete_gradient};
use super::pairs::ExtremumKind;
use super::segmentation::Segmentation;
use super::selection::WantedExtrema;
use super::star::cofacets;
use super::v_paths::path_down;

/// What becomes of pairs of a 1-saddle and a 2-saddle in dimension 3.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SaddlePairs {
    /// They stay: only extrema cancel. The separatrices of extrema and the segmentation need no more.
    #[default]
    Keep,
    /// They cancel in their turn where exactly one V-path connects them then; the others stay.
    Cancel,
}

/// The discrete gradient of a field with the list of its cancellations, simplified to any threshold, up and down.
///
/// *What cancels.* Minima with the edges at which they die and, from dimension 2 on, maxima (critical top cells) with the
/// facets at which they die, both by the elder rule in the lower-star filtration, and each by reversing the one V-path
/// between the two. Across facets of three or more top cells nothing is cancelled. In dimension 3, 1-saddles and 2-saddles
/// that are paired in the diagram cancel if that is [asked for](SaddlePairs) and if exactly one V-path connects them when it
/// is their turn; many a pair has more and stays.
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
/// use morsmooth::morse::{MorseHierarchy, SaddlePairs};
/// let line = SimplicialComplex::new(1, vec![[0.0; 3]; 5], vec![0, 1, 1, 2, 2, 3, 3, 4])?;
/// let values = [0.0, 3.0, 1.0, 2.0, 1.5];
/// let order = VertexOrder::of_values(&values)?;
/// let mut hierarchy = MorseHierarchy::new(&line, &values, &order, SaddlePairs::Keep)?;
/// assert_eq!(hierarchy.gradient().critical_counts(), [3, 2, 0, 0]);
/// assert_eq!(hierarchy.at(1.0).critical_counts(), [2, 1, 0, 0]);
/// assert_eq!(hierarchy.at(0.1).critical_counts(), [3, 2, 0, 0]); // and back
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct MorseHierarchy<'a, T> {
    complex: &'a T,
    order: &'a VertexOrder,
    gradient: DiscreteGradient,
    minima: BasinHierarchy,
    maxima: BasinHierarchy,
    cancellations: Vec<CellCancellation>,
    /// What was tried, in that order.
    done: Vec<Trial>,
    choice: Choice,
}

/// A cancellation that was tried.
#[derive(Debug, Clone)]
struct Trial {
    place: usize,
    outcome: Outcome,
}

#[derive(Debug, Clone)]
enum Outcome {
    /// There was no V-path, or more than one.
    Impossible,
    /// The way back is found from the extremum.
    OfExtremum,
    /// The V-path that was reversed, from the edge up.
    OfSaddles(Box<[Cell]>),
}

/// What was asked for last.
#[derive(Debug, Clone)]
enum Choice {
    Above(f64),
    Maxima(Vec<VertexId>),
}

impl<'a, T: Triangulation> MorseHierarchy<'a, T> {
    /// Builds the discrete gradient and pairs its critical cells.
    ///
    /// # Arguments
    /// * `complex`: `n` vertices, dimension 1, 2 or 3.
    /// * `values`: `n` finite values.
    /// * `order`: the order of the values.
    /// * `saddles`: what becomes of pairs of saddles in dimension 3.
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
    pub fn new(
        complex: &'a T,
        values: &[f64],
        order: &'a VertexOrder,
        saddles: SaddlePairs,
    ) -> Result<Self, MorseError> {
        let gradient = discrete_gradient(complex, order)?;
        let minima = BasinHierarchy::new(complex, values, order, ExtremumKind::Minimum)?;
        let maxima = BasinHierarchy::new(complex, values, order, ExtremumKind::Maximum)?;
        let mut cancellations = with_minima(complex, &minima);
        if complex.dimension() > 1 {
            cancellations.extend(with_maxima(complex, &gradient, values, order, &maxima));
        }
        if complex.dimension() == 3 && saddles == SaddlePairs::Cancel {
            cancellations.extend(of_saddles(complex, &gradient, values, order));
        }
        // Stable: the lists of extrema come nested first.
        cancellations.sort_by(|a, b| a.level.total_cmp(&b.level));
        Ok(Self { complex, order, gradient, minima, maxima, cancellations, done: Vec::new(), choice: Choice::Above(f64::NEG_INFINITY) })
    }

    /// The complex.
    pub fn complex(&self) -> &'a T {
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
        let is_done = |trial: &&Trial| !matches!(trial.outcome, Outcome::Impossible);
        self.done.iter().filter(is_done).map(|trial| &self.cancellations[trial.place])
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
            cancellation.level > threshold || cancellation.extremum.is_some_and(|vertex| is_wanted(vertex, list))
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
        let common = self.done.iter().zip(&chosen).take_while(|(trial, chosen)| trial.place == **chosen).count();
        for trial in self.done.split_off(common).into_iter().rev() {
            self.undo(&trial);
        }
        for &place in &chosen[common..] {
            let outcome = self.cancel(place);
            self.done.push(Trial { place, outcome });
        }
        &self.gradient
    }

    /// Reverses the one V-path between two cells; does nothing if there is none, or more than one.
    fn cancel(&mut self, place: usize) -> Outcome {
        let pair = self.cancellations[place];
        if !self.gradient.is_critical(pair.lower) || !self.gradient.is_critical(pair.upper) {
            return Outcome::Impossible;
        }
        let path = match (pair.lower.dimension, pair.extremum) {
            (_, None) => unique_path(self.complex, &self.gradient, pair.lower, pair.upper),
            (0, _) => self.path_down(&pair),
            _ => self.path_up(&pair),
        };
        let Some(path) = path else { return Outcome::Impossible };
        for step in path.chunks_exact(2) {
            self.join(step[0], step[1]);
        }
        if pair.extremum.is_some() { Outcome::OfExtremum } else { Outcome::OfSaddles(path.into()) }
    }

    fn undo(&mut self, trial: &Trial) {
        let pair = self.cancellations[trial.place];
        match &trial.outcome {
            Outcome::Impossible => {}
            Outcome::OfExtremum => self.restore_extremum(&pair),
            Outcome::OfSaddles(path) => self.restore(path),
        }
    }

    /// Gives the cells of a reversed V-path their partners of before; both its ends are critical again.
    fn restore(&mut self, path: &[Cell]) {
        let [first, between @ .., last] = path else { return };
        self.gradient.release(*first);
        self.gradient.release(*last);
        for step in between.chunks_exact(2) {
            self.join(step[0], step[1]);
        }
    }

    fn restore_extremum(&mut self, pair: &CellCancellation) {
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
                let ends = self.complex.cell_vertices(between);
                last = Cell::vertex(if ends[0].0 == last.index { ends[1] } else { ends[0] });
            } else {
                cofacets(self.complex, between, &mut around);
                match around.iter().find(|&&cell| cell != last) {
                    Some(&next) => last = next,
                    None => return,
                }
            }
            path.push(last);
        }
        self.restore(&path);
    }

    fn join(&mut self, a: Cell, b: Cell) {
        if a.dimension < b.dimension { self.gradient.pair(a, b) } else { self.gradient.pair(b, a) }
    }

    /// The V-path from an edge down to a minimum, if exactly one of its two leads there.
    fn path_down(&self, pair: &CellCancellation) -> Option<Vec<Cell>> {
        let ends = self.complex.cell_vertices(pair.upper);
        let mut paths: Vec<Vec<Cell>> = ends.iter().map(|&end| path_down(self.complex, &self.gradient, end)).collect();
        paths.retain(|path| path.last() == Some(&pair.lower));
        let mut path = vec![pair.upper];
        path.append(paths.first_mut()?);
        (paths.len() == 1).then_some(path)
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
