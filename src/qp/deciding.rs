//! The end of a solve with nonnegative rows: each is decided to be active or not, and wrong decisions are mended.
//!
//! An active row has a weight that all but holds it, another one none. With one factor of `P + Aᵀ σ A` a step shows which rows were decided wrongly, and
//! mends them exactly ([`super::mending`]); one or two such steps end at the optimum, complementary to the last bit: a slack or a dual, never both.
//! Where rows are decided too soon, more are wrong than can be mended, and nothing is lost but one factorisation.
//!
//! Sources: Bertsekas 1982 (multipliers and semismooth steps); Bergounioux, Ito and Kunisch 1999 (primal-dual active sets, which mend by factoring anew).

use std::time::Instant;

use super::interior::{Interior, Watch};
use super::kkt::Measure;
use super::mending::Mending;
use super::system::System;
use super::{QpError, QpStatus};

/// Below so many unknowns any way takes less than a millisecond.
const SMALL: usize = 300;

/// Weight of an active row, over the stiffness that P sets against closing it alone. Where hundreds of active rows hang together, all of them yield
/// hundreds of times as far as one. (Measured: with 1e3 some chains at 250,000 unknowns halve their residual with each factorisation.)
const WEIGHT: f64 = 1e6;

/// Weight of another row over that: nothing, and yet a number to divide by.
const NOTHING: f64 = 1e-30;

/// Rows may be decided when so few are likely to be wrong that they can be mended by dense systems of this share of the work of a factorisation.
/// (Measured on nine problems of 15,000 to 250,000 unknowns: 57, 51, 48 and 44 factorisations with 0.01, 0.03, 0.1 and 0.3, but with 0.3
/// up to a half more time at 250,000.)
const DENSE: f64 = 0.1;

/// Most rounds, a factor each.
const ROUNDS: usize = 4;

/// Most steps of a round.
const STEPS: usize = 5;

/// Part of the tolerance of the primal residual that is asked for, since no slack keeps an active row off its bound: to be an end, and not to be worth
/// another step.
const TIGHT: (f64, f64) = (1e-2, 1e-4);

impl Interior<'_> {
    /// Whether rows can be decided here at all: large problems of nonnegative rows. Mending works with differences far below single precision.
    pub(super) fn is_for_deciding(&self) -> bool {
        let is_large = self.point.x.len() >= SMALL;
        self.settings.splitting && is_large && self.rows.is_polyhedral() && !matches!(self.engine.system, System::Single(_))
    }

    /// How many rows may be decided wrongly, about.
    pub(super) fn few(&self) -> usize {
        (DENSE * self.engine.factor_flops()).cbrt() as usize
    }

    /// Optimal, and active rows violated by next to nothing.
    pub(super) fn is_tight(&self, measure: &Measure) -> bool {
        measure.is_optimal(self.settings) && measure.kkt.primal <= TIGHT.0 * self.settings.residual
    }

    /// What P sets against closing each row alone; where P is zero at all its unknowns, its stiffest entry.
    pub(super) fn stiffness(&self) -> Vec<f64> {
        let stiffest = self.engine.largest_diagonal();
        let stiffness = |row| match self.rows.compliance_of(row, |unknown| self.engine.diagonal_of(unknown)) {
            compliance if compliance > 0.0 => 1.0 / compliance,
            _ => stiffest,
        };
        (0..self.rows.len()).map(stiffness).collect()
    }

    /// Solves from the present point with decided rows.
    ///
    /// # Arguments
    /// * `is_active`: the first decision.
    /// * `done`: iterations or rounds so far.
    /// * `progress`: called once, at the end; rounds that may be taken back are not shown.
    ///
    /// # Returns
    /// How it ended and after how many rounds in all; `None` where it got nowhere, with the point, its measure and its residuals as before.
    ///
    /// # Cost
    /// Per round one factorisation, two to eight solves and the mending; one or two rounds where it ends.
    pub(super) fn decide(
        &mut self,
        mut is_active: Vec<bool>,
        done: usize,
        progress: &mut Watch<'_>,
    ) -> Result<Option<(QpStatus, usize)>, QpError> {
        let before = self.point.clone();
        let mut targets = self.stiffness();
        targets.iter_mut().for_each(|target| *target *= WEIGHT);
        for ((s, z), &is_active) in self.point.s.iter_mut().zip(&mut self.point.z).zip(&is_active) {
            *(if is_active { s } else { z }) = 0.0;
        }
        let mut merit = f64::INFINITY;
        let last = (done + ROUNDS).min(self.settings.max_iterations);
        for round in done + 1..=last {
            for ((weight, target), &is_active) in self.scaling.weights.iter_mut().zip(&targets).zip(&is_active) {
                *weight = target * if is_active { 1.0 } else { NOTHING };
            }
            // Whether P or the weights are to blame, the interior point finds out.
            if self.factor().is_err() {
                break;
            }
            let clock = Instant::now();
            let measure = self.mended_steps(&mut is_active, &targets)?;
            self.timings.solve += clock.elapsed().as_secs_f64();
            let Some(measure) = measure else { break };
            if self.is_tight(&measure) {
                progress(measure.progress(round, 1.0), &self.point.x);
                self.hidden = 0.0;
                return Ok(Some((QpStatus::Solved, round)));
            }
            let earlier = std::mem::replace(&mut merit, measure.merit(self.settings));
            if !merit.is_finite() || merit > 0.5 * earlier {
                break;
            }
        }
        self.point = before;
        Measure::of(self);
        Ok(None)
    }

    /// The steps of a round; `None` where too many rows are wrong at once.
    ///
    /// # Arguments
    /// * `is_active`: as the factor has it; overwritten with what the steps found.
    fn mended_steps(&mut self, is_active: &mut Vec<bool>, targets: &[f64]) -> Result<Option<Measure>, QpError> {
        let mut measure = Measure::of(self);
        let mut mending = Mending::new(2 * self.few(), std::mem::take(is_active));
        let mut before = (f64::INFINITY, f64::INFINITY);
        for _ in 0..STEPS {
            self.goal.fill(0.0);
            self.direction()?;
            let is_mended = self.mended_step(&mut mending, targets);
            if !is_mended && mending.is_empty() {
                return Ok(None);
            }
            measure = Measure::of(self);
            let now = (measure.merit(self.settings), measure.kkt.primal);
            let is_exact = self.is_tight(&measure) && now.1 <= TIGHT.1 * self.settings.residual;
            let is_better = now.0 <= 0.5 * before.0 || now.1 <= 0.5 * before.1;
            if !is_mended || is_exact || !is_better {
                break;
            }
            before = now;
        }
        is_active.extend(self.point.z.iter().map(|&z| z > 0.0));
        Ok(Some(measure))
    }
}
