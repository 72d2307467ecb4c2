//! Splitting: most solves of large problems with nonnegative rows need fewer factorisations in the metric of the interior point than
//! by its steps, which end at the first row that blocks them.
//!
//! The alternating direction method of multipliers with a weight ρ for each row,
//!
//! ```text
//! (P + Aᵀ ρ A) dx = -(P x + q - Aᵀ z) - Aᵀ ρ (A x + b - s),    r = A (x + dx) + b - z/ρ,    s = max(r, 0),    z = ρ max(-r, 0),
//! ```
//!
//! needs a factor for each choice of the weights and a solve for each step, and nothing in it is ever blocked. It converges fast where ρ is large for
//! the rows that will be active and small for the others, which is what the weights z/s of an interior point become. So each round sharpens the
//! weights as if slacks and duals were split from r with a product μ, and a round has a tenth of the product of the one before.
//!
//! Sources: Gabay and Mercier 1976; Boyd, Parikh, Chu, Peleato and Eckstein 2011, *Distributed optimization and statistical learning via the
//! alternating direction method of multipliers*, section 3.4.1 (weights that vary). The weights of a central path are ours.

use std::time::Instant;

use super::centred::larger_part;
use super::interior::{Interior, Watch};
use super::kkt::Measure;
use super::product::{add, dot};
use super::{QpError, QpStatus};

/// Below so many unknowns a factorisation costs little more than the solves that save it.
const SMALL: usize = 4_000;

/// With more rows the rounds are as many as the iterations, or more, if there is data. (Measured at order 2 and 250,000 unknowns: 23 rounds against 17
/// iterations with noisy data, 16 against 14 with data kept smooth; without data 9 against 14.)
const MANY: usize = 150_000;

/// Solves with each factor. (Measured on twelve problems from 15,000 to 250,000 unknowns: with 2 a fifth more factorisations, with 4 a tenth less.)
const SOLVES: usize = 3;

/// The product of a round over that of the one before it: while rows change between active and not, and once few do. (Measured: 0.3 for the first
/// takes a third more rounds; with 0.03 some rows become certain too early, and take long to change.)
const SHARPER: (f64, f64) = (0.1, 1e-2);

/// Few rows, as a share of all.
const FEW: f64 = 1e-3;

/// Largest weight of a row, over the stiffness that P sets against closing it alone: enough for a residual a thousandth at each solve.
const LARGEST: f64 = 1e3;

/// Least weight over the largest one: nothing, and yet a number to divide by.
const LEAST: f64 = 1e-30;

/// A row whose r changes in the last step by more than this share of it is on its way.
const MOVING: f64 = 0.05;

/// A row that moves away from its bound, or deeper into it, has its weight changed by this factor on top; again while rows change, and once few do.
const AHEAD: (f64, f64) = (10.0, 1e3);

/// Most rounds.
const ROUNDS: usize = 30;

/// So many rounds without less open rows, and without a smaller residual, are the end.
const PATIENCE: usize = 4;

/// A primal residual above this, relative as measured, of which three rounds leave more than half, is that of rows that contradict each other, or nearly so:
/// the interior point proves that in fewer factorisations. (Hard problems of order 3 leave more than half of 1e-3 now and then.)
const STUCK: f64 = 1e-2;

/// Part of the tolerance of the primal residual that is asked for, since no slack keeps an active row off its bound.
const TIGHT: f64 = 1e-2;

/// Where the largest residual over its tolerance is below this, it is measured after each solve.
const NEAR: f64 = 1e3;

impl Interior<'_> {
    /// Solves from the start as it was split, where that is likely to take fewer factorisations than the interior point.
    ///
    /// # Returns
    /// How it ended, and after how many rounds; `None` where it did not end or was not tried, with the start as the point again.
    ///
    /// # Cost
    /// One factorisation and three solves a round; 7 to 13 rounds measured.
    pub(super) fn splitting(&mut self, progress: &mut Watch<'_>) -> Result<Option<(QpStatus, usize)>, QpError> {
        if !self.is_for_splitting() {
            return Ok(None);
        }
        let start = self.point.clone();
        let ended = self.rounds(progress)?;
        if ended.is_none() {
            self.point = start;
            self.bounded_at = f64::INFINITY;
        }
        Ok(ended)
    }

    /// Rounds to the end, or until they get nowhere.
    fn rounds(&mut self, progress: &mut Watch<'_>) -> Result<Option<(QpStatus, usize)>, QpError> {
        let mut measure = Measure::of(self);
        progress(measure.progress(0, 0.0), &self.point.x);
        let m = self.rows.len();
        let mut rounds = Rounds {
            product: dot(&self.point.s, &self.point.z) / m as f64,
            largest: self.largest_weights(),
            r: vec![0.0; m],
            before: vec![0.0; m],
            was_active: vec![false; m],
        };
        for ((weight, z), s) in self.scaling.weights.iter_mut().zip(&self.point.z).zip(&self.point.s) {
            *weight = z / s;
        }
        let (mut fewest, mut least, mut idle) = (usize::MAX, f64::INFINITY, 0);
        let mut primal = [f64::INFINITY; 3];
        for round in 1..=ROUNDS {
            if round > self.settings.max_iterations {
                return Ok(Some((QpStatus::IterationLimit, round - 1)));
            }
            let open = if round > 1 { rounds.sharpen(&mut self.scaling.weights) } else { m };
            // Whether P or the weights are to blame, the interior point finds out.
            if self.factor().is_err() {
                return Ok(None);
            }
            let clock = Instant::now();
            for solve in 1..=SOLVES {
                self.alternate(&mut rounds)?;
                if solve == SOLVES || measure.merit(self.settings) < NEAR {
                    measure = Measure::of(self);
                    if self.is_tight(&measure) {
                        break;
                    }
                } else {
                    self.residuals();
                }
            }
            self.timings.solve += clock.elapsed().as_secs_f64();
            progress(measure.progress(round, 1.0), &self.point.x);
            if self.is_tight(&measure) {
                self.hidden = 0.0;
                return Ok(Some((QpStatus::Solved, round)));
            }
            if self.is_closed(&measure) && self.is_bounded(&measure)? {
                return Ok(Some((QpStatus::Solved, round)));
            }
            if measure.is_above(self.settings.cutoff) {
                return Ok(Some((QpStatus::CutOff, round)));
            }
            self.keep_rough(&measure);
            let earlier = std::mem::replace(&mut primal[round % 3], measure.kkt.primal);
            let is_stuck = measure.kkt.primal > STUCK && measure.kkt.primal > 0.5 * earlier;
            let merit = measure.merit(self.settings);
            let is_better = open < fewest || merit < 0.5 * least;
            (fewest, least) = (fewest.min(open), least.min(merit));
            idle = if is_better { 0 } else { idle + 1 };
            if is_stuck || !merit.is_finite() || idle == PATIENCE {
                return Ok(None);
            }
        }
        Ok(None)
    }

    /// Whether rounds are likely to end sooner than iterations: large problems of nonnegative rows from a start that violates some.
    fn is_for_splitting(&self) -> bool {
        let is_wanted = self.settings.splitting && self.point.x.len() >= SMALL;
        let is_of_size = self.rows.len() <= MANY || self.problem.objective.linear.iter().all(|&q| q == 0.0);
        is_wanted && is_of_size && self.centre.is_some_and(|centre| !centre.is_collective())
    }

    /// Optimal, and active rows violated by next to nothing.
    fn is_tight(&self, measure: &Measure) -> bool {
        measure.is_optimal(self.settings) && self.is_closed(measure)
    }

    fn is_closed(&self, measure: &Measure) -> bool {
        measure.kkt.primal <= TIGHT * self.settings.residual
    }

    /// The largest weight of each row; where P is zero at all its unknowns, by the stiffest one of the problem.
    fn largest_weights(&self) -> Vec<f64> {
        let stiffest = self.engine.largest_diagonal();
        let stiffness = |row| match self.rows.compliance_of(row, |unknown| self.engine.diagonal_of(unknown)) {
            compliance if compliance > 0.0 => 1.0 / compliance,
            _ => stiffest,
        };
        (0..self.rows.len()).map(|row| LARGEST * stiffness(row)).collect()
    }

    /// One step of the method with the factor at hand; the residuals must be those of the point.
    fn alternate(&mut self, rounds: &mut Rounds) -> Result<(), QpError> {
        self.goal.fill(0.0);
        self.direction()?;
        add(&mut self.point.x, 1.0, &self.step.x);
        std::mem::swap(&mut rounds.before, &mut rounds.r);
        let rows = self.point.s.iter_mut().zip(&mut self.point.z).zip(&self.step.s).zip(&self.scaling.weights).zip(&mut rounds.r);
        for ((((s, z), step), weight), r) in rows {
            *r = *s + step - *z / weight;
            *s = r.max(0.0);
            *z = weight * (-*r).max(0.0);
        }
        Ok(())
    }

    /// Stationarity and primal residual of the point, without their measures.
    fn residuals(&mut self) {
        let objective = &self.problem.objective;
        objective.product_into(&self.point.x, &mut self.stationarity, &mut self.engine.scratch);
        add(&mut self.stationarity, 1.0, &objective.linear);
        self.rows.add_transposed(-1.0, &self.point.z, &mut self.stationarity);
        self.engine.mask(&mut self.stationarity);
        self.rows.slack_into(&self.point.x, &mut self.primal);
        add(&mut self.primal, -1.0, &self.point.s);
    }
}

/// What the rounds keep of each row.
struct Rounds {
    /// Product of slack and dual that the weights of a round belong to.
    product: f64,
    /// Largest weights.
    largest: Vec<f64>,
    /// r after the last step: a slack where it is positive, minus a dual over the weight where it is negative.
    r: Vec<f64>,
    /// r after the step before that.
    before: Vec<f64>,
    /// Whether each row was active when the weights were last chosen.
    was_active: Vec<bool>,
}

impl Rounds {
    /// The weights of the next round; returns the number of rows that changed between active and not since the last one.
    fn sharpen(&mut self, weights: &mut [f64]) -> usize {
        let open = self.r.iter().zip(&self.was_active).filter(|(r, was_active)| (**r < 0.0) != **was_active).count();
        let (sharper, ahead) =
            if open as f64 > FEW * self.r.len() as f64 { (SHARPER.0, AHEAD.0) } else { (SHARPER.1, AHEAD.1) };
        self.product *= sharper;
        let rows = self.r.iter().zip(&self.before).zip(&mut self.was_active).zip(weights).zip(&self.largest);
        for ((((&r, before), was_active), weight), &largest) in rows {
            let room = (self.product / *weight).sqrt();
            let mut factor = (larger_part(r, room) / room).powi(2);
            let change = r - before;
            if change.abs() > MOVING * r.abs() && change * r > 0.0 {
                factor *= ahead;
            }
            *weight = if r < 0.0 { (*weight * factor).min(largest) } else { (*weight / factor).max(LEAST * largest) };
            *was_active = r < 0.0;
        }
        open
    }
}
