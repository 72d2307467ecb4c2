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
//! Once few rows change between active and not, they are decided ([`super::deciding`]), which ends most solves.
//!
//! Sources: Gabay and Mercier 1976; Boyd, Parikh, Chu, Peleato and Eckstein 2011, *Distributed optimization and statistical learning via the
//! alternating direction method of multipliers*, section 3.4.1 (weights that vary). The weights of a central path are ours.

use std::time::Instant;

use super::centred::larger_part;
use super::interior::{Interior, Watch};
use super::kkt::Measure;
use super::product::{add, dot};
use super::{QpError, QpStatus};

/// Solves with each factor while the weights sharpen. (Measured on nine problems of order 2 from 15,000 to 250,000 unknowns, with 2: a tenth more factorisations, the same time.)
const SOLVES: usize = 3;

/// The product of a round over that of the one before it. (Measured: 0.03 and 0.01 take as many rounds or more.)
const SHARPER: f64 = 0.1;

/// Largest weight of a row, over the stiffness that P sets against closing it alone: enough for a residual a thousandth at each solve.
const LARGEST: f64 = 1e3;

/// Least weight over the largest one: nothing, and yet a number to divide by.
const LEAST: f64 = 1e-30;

/// A row whose r changes in the last step by more than this share of it is on its way.
const MOVING: f64 = 0.05;

/// A row that moves away from its bound, or deeper into it, has its weight changed by this factor on top.
const AHEAD: f64 = 10.0;

/// Where rows were decided too soon, they are decided again when this share of as many change.
const FEWER: usize = 4;

/// Most rounds.
const ROUNDS: usize = 30;

/// So many rounds without less open rows, and without a smaller residual, are the end.
const PATIENCE: usize = 4;

/// A primal residual above this, relative as measured, of which three rounds leave more than half, is that of rows that contradict each other, or nearly so:
/// the interior point proves that in fewer factorisations. (Hard problems of order 3 leave more than half of 1e-3 now and then.)
const STUCK: f64 = 1e-2;

impl Interior<'_> {
    /// Solves from the start as it was split, where that is likely to take fewer factorisations than the interior point.
    ///
    /// # Returns
    /// How it ended, `None` where it did not or was not tried, with the start as the point again; and the number of rounds.
    ///
    /// # Cost
    /// One factorisation and three solves a round, and those of [`Interior::decide`]; 3 to 9 factorisations measured.
    pub(super) fn splitting(&mut self, progress: &mut Watch<'_>) -> Result<(Option<QpStatus>, usize), QpError> {
        if !self.is_for_splitting() {
            return Ok((None, 0));
        }
        let start = self.point.clone();
        let ended = self.rounds(progress)?;
        if ended.0.is_none() {
            self.point = start;
        }
        Ok(ended)
    }

    /// Whether rounds are likely to end sooner than iterations: from a start that violates rows, not all of them together.
    fn is_for_splitting(&self) -> bool {
        self.is_for_deciding() && self.centre.is_some_and(|centre| !centre.is_collective())
    }

    /// Rounds to the end, or until they get nowhere.
    fn rounds(&mut self, progress: &mut Watch<'_>) -> Result<(Option<QpStatus>, usize), QpError> {
        let mut measure = Measure::of(self);
        progress(measure.progress(0, 0.0), &self.point.x);
        let mut rounds = self.first_round();
        let mut few = self.few();
        let (mut fewest, mut least, mut idle) = (usize::MAX, f64::INFINITY, 0);
        let mut primal = [f64::INFINITY; 3];
        for round in 1..=ROUNDS {
            if round > self.settings.max_iterations {
                return Ok((Some(QpStatus::IterationLimit), round - 1));
            }
            let mut open = self.rows.len();
            if round > 1 {
                open = rounds.open();
                if open <= few {
                    let decision = rounds.r.iter().map(|&r| r < 0.0).collect();
                    let weights = self.scaling.weights.clone();
                    if let Some((status, rounds)) = self.decide(decision, round - 1, progress)? {
                        return Ok((Some(status), rounds));
                    }
                    self.scaling.weights = weights;
                    few = open / FEWER;
                }
                rounds.sharpen(&mut self.scaling.weights);
            }
            // Whether P or the weights are to blame, the interior point finds out.
            if self.factor().is_err() {
                return Ok((None, round - 1));
            }
            let clock = Instant::now();
            for solve in 1..=SOLVES {
                self.alternate(&mut rounds)?;
                if solve < SOLVES {
                    self.residuals();
                }
            }
            measure = Measure::of(self);
            self.timings.solve += clock.elapsed().as_secs_f64();
            progress(measure.progress(round, 1.0), &self.point.x);
            if self.is_tight(&measure) {
                self.hidden = 0.0;
                return Ok((Some(QpStatus::Solved), round));
            }
            if measure.is_above(self.settings.cutoff) {
                return Ok((Some(QpStatus::CutOff), round));
            }
            self.keep_rough(&measure);
            let earlier = std::mem::replace(&mut primal[round % 3], measure.kkt.primal);
            let is_stuck = measure.kkt.primal > STUCK && measure.kkt.primal > 0.5 * earlier;
            let merit = measure.merit(self.settings);
            let is_better = open < fewest || merit < 0.5 * least;
            (fewest, least) = (fewest.min(open), least.min(merit));
            idle = if is_better { 0 } else { idle + 1 };
            if is_stuck || !merit.is_finite() || idle == PATIENCE {
                return Ok((None, round));
            }
        }
        Ok((None, ROUNDS))
    }

    /// The weights of the start.
    fn first_round(&mut self) -> Rounds {
        let m = self.rows.len();
        for ((weight, z), s) in self.scaling.weights.iter_mut().zip(&self.point.z).zip(&self.point.s) {
            *weight = z / s;
        }
        Rounds {
            product: dot(&self.point.s, &self.point.z) / m as f64,
            stiffness: self.stiffness(),
            r: vec![0.0; m],
            before: vec![0.0; m],
            was_active: vec![false; m],
        }
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
    /// What P sets against closing each row alone.
    stiffness: Vec<f64>,
    /// r after the last step: a slack where it is positive, minus a dual over the weight where it is negative.
    r: Vec<f64>,
    /// r after the step before that.
    before: Vec<f64>,
    /// Whether each row was active when the weights were last chosen.
    was_active: Vec<bool>,
}

impl Rounds {
    /// Number of rows that changed between active and not since the weights were last chosen.
    fn open(&self) -> usize {
        self.r.iter().zip(&self.was_active).filter(|(r, was_active)| (**r < 0.0) != **was_active).count()
    }

    /// The weights of the next round.
    fn sharpen(&mut self, weights: &mut [f64]) {
        self.product *= SHARPER;
        let rows = self.r.iter().zip(&self.before).zip(&mut self.was_active).zip(weights).zip(&self.stiffness);
        for ((((&r, before), was_active), weight), &stiffness) in rows {
            let room = (self.product / *weight).sqrt();
            let mut factor = (larger_part(r, room) / room).powi(2);
            let change = r - before;
            if change.abs() > MOVING * r.abs() && change * r > 0.0 {
                factor *= AHEAD;
            }
            let largest = LARGEST * stiffness;
            *weight = if r < 0.0 { (*weight * factor).min(largest) } else { (*weight / factor).max(LEAST * largest) };
            *was_active = r < 0.0;
        }
    }
}
