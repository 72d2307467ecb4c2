//! One iteration of the interior point: scaling, factorisation, predictor, corrector, centrality correctors, step.

use std::time::Instant;

use super::QpError;
use super::interior::{Interior, Triple};
use super::product::{dot, largest};

/// Most of the centring that a predictor may ask for where there are blocks; a cap saves iterations from a good start (measured).
const LARGEST_SIGMA: f64 = 0.1;

/// The same where there are rows only. Centrality correctors keep the point near the centre, and a lower aim saves what a larger one would cost
/// (measured over nine problems of 15,000 and 58,000 unknowns: 96 iterations in all with 0.1, 91 with 0.03, 88 with 0.01; but the hardest one of
/// 250,000 takes 24, 24 and 29).
const LARGEST_SIGMA_OF_ROWS: f64 = 0.03;

/// Below this length of the predictor the point is far from the centre, and centring is worth a whole step.
const BLOCKED: f64 = 0.1;

/// Primal residuals above this share of the slacks count as open: then a blocked predictor asks for more centring.
const OPEN: f64 = 1e-9;

/// Correctors that always pay where there are blocks: a quarter of the iterations (measured).
const BLOCK_CORRECTORS: usize = 2;

/// The same for rows: a fifth to a third of the iterations from 5,000 to 250,000 unknowns (measured).
const ROW_CORRECTORS: usize = 2;

/// How much longer than the step at hand the one is that a corrector aims at, as a share of the step and of a whole one: for rows and for blocks.
/// (Measured on rows, six problems of 15,000 unknowns: 79 iterations in all without correctors, 66 with two at 0.08, 61 with two at 0.3, 62 at 0.8.)
const ASPIRATION: (f64, f64) = (0.3, 0.08);

/// The centre that is aimed at never has a smaller gap than this share of the tolerance: once the gap is closed, the last steps
/// serve the stationarity, and products of slack and dual near zero would only spoil the matrix.
const CLOSED: f64 = 0.03;

/// A relative residual of a Newton direction above which a factor in single precision has done its work.
const POOR: f64 = 1e-6;

/// Most steps of conjugate gradients for a direction.
const STEPS: usize = 4;

/// Where the first solve with a factor leaves a smaller relative residual, no other one with this factor is measured: the next stationarity
/// tells of all of them.
const EXACT: f64 = 1e-8;

impl Interior<'_> {
    /// One iteration, with gaps relative to `unit`; returns the step length, 0 where the point has left the cone by rounding.
    pub(super) fn advance(&mut self, unit: f64) -> Result<f64, QpError> {
        if !self.scaling.update(&self.rows, &self.point) {
            return Ok(0.0);
        }
        self.factor()?;
        let clock = Instant::now();
        let degree = self.rows.degree() as f64;
        let mu = dot(&self.point.s, &self.point.z) / degree;
        // Predictor: the Newton step to complementarity zero.
        for (goal, z) in self.goal.iter_mut().zip(&self.point.z) {
            *goal = -z;
        }
        self.direction()?;
        let reach = self.reach(1.0);
        let mut after = 0.0;
        for row in 0..self.rows.len() {
            after += (self.point.s[row] + reach * self.step.s[row]) * (self.point.z[row] + reach * self.step.z[row]);
        }
        let wanted = (after / degree / mu).powi(3);
        let sigma = if self.rows.is_polyhedral() {
            if reach < BLOCKED { wanted } else { wanted.min(LARGEST_SIGMA_OF_ROWS) }
        } else if largest(&self.primal) > OPEN * self.rows.offset_size.max(largest(&self.point.s)) {
            wanted.max((1.0 - reach).powi(2))
        } else {
            wanted.min(LARGEST_SIGMA)
        };
        let centre = (sigma * mu).max(CLOSED * self.settings.relative_gap * unit / degree);
        // Corrector: centred, with the full second-order term.
        self.scaling.corrected(&self.rows, centre, (&self.point, &self.step), &mut self.goal);
        self.direction()?;
        let mut length = self.reach(self.settings.step_fraction);
        for _ in 0..self.worthwhile_correctors() {
            let longer = self.centrality(centre, length)?;
            match longer {
                Some(reached) => length = reached,
                None => break,
            }
        }
        self.point.add(length, &self.step);
        self.timings.solve += clock.elapsed().as_secs_f64();
        Ok(length)
    }

    /// Factors the normal equations `P + Aᵀ V A` of the present scaling.
    pub(super) fn factor(&mut self) -> Result<(), QpError> {
        let clock = Instant::now();
        self.engine.reset_values();
        self.rows.add_normal(&self.scaling, &mut self.engine.values);
        self.engine.factor_values()?;
        self.is_exact = false;
        self.timings.factor += clock.elapsed().as_secs_f64();
        Ok(())
    }

    /// Counted, not timed, so that the same input gives the same bits.
    fn worthwhile_correctors(&self) -> usize {
        let symbolic = &self.engine.symbolic;
        let correctors = match symbolic.factor_flops() / symbolic.factor_entries().max(1) as f64 {
            ratio if ratio > 2500.0 => 3,
            ratio if ratio > 1000.0 => 2,
            ratio if ratio > 400.0 => 1,
            _ => 0,
        };
        let least = if self.rows.is_polyhedral() { ROW_CORRECTORS } else { BLOCK_CORRECTORS };
        correctors.max(least).min(self.settings.correctors)
    }

    /// The Newton direction for the current residuals and goal.
    pub(super) fn direction(&mut self) -> Result<(), QpError> {
        self.scaling.times(&self.rows, &self.primal, &mut self.trial.s);
        for (slot, goal) in self.trial.s.iter_mut().zip(&self.goal) {
            *slot = goal - *slot;
        }
        for (slot, residual) in self.side.iter_mut().zip(&self.stationarity) {
            *slot = -residual;
        }
        self.rows.add_transposed(1.0, &self.trial.s, &mut self.side);
        self.newton()?;
        self.rows.image_into(&self.step.x, &mut self.step.s);
        for (step, primal) in self.step.s.iter_mut().zip(&self.primal) {
            *step += primal;
        }
        self.dual_step();
        Ok(())
    }

    /// `dz := goal - V ds`.
    fn dual_step(&mut self) {
        self.scaling.times(&self.rows, &self.step.s, &mut self.step.z);
        for (step, goal) in self.step.z.iter_mut().zip(&self.goal) {
            *step = goal - *step;
        }
    }

    fn newton(&mut self) -> Result<(), QpError> {
        // Metrics of blocks lose more digits than weights of rows (measured: 1e-3 stalls at a gap of 3e-8).
        let tolerance = if self.rows.is_polyhedral() { 1e-3 } else { 1e-10 };
        let steps = if self.is_exact { 1 } else { STEPS };
        let rows = Some((&self.rows, &self.scaling, &mut self.work[..]));
        let (taken, reached) =
            self.engine.solve_refined(&self.problem.objective, rows, &self.side, &mut self.step.x, (tolerance, steps));
        self.solves += taken;
        if self.is_exact {
            return Ok(());
        }
        self.is_exact = self.rows.is_polyhedral() && taken == 1 && reached <= EXACT;
        if reached > POOR && self.engine.escalate() {
            self.factor()?;
            return self.newton();
        }
        Ok(())
    }

    /// The longest step, at most 1, that stays within `fraction` of the way to the boundary.
    fn reach(&self, fraction: f64) -> f64 {
        self.scaling.reach(&self.rows, fraction, (&self.point, &self.step))
    }

    /// Gondzio's corrector: pulls outlying complementarity products of a longer trial step back towards the centre.
    /// Keeps the corrected step if it is clearly longer.
    fn centrality(&mut self, centre: f64, length: f64) -> Result<Option<f64>, QpError> {
        if length > 0.95 {
            return Ok(None);
        }
        let more = if self.rows.is_polyhedral() { ASPIRATION.0 } else { ASPIRATION.1 };
        let wanted = ((1.0 + more) * length + more).min(1.0);
        self.scaling.recentred(&self.rows, (centre, wanted), (&self.point, &self.step), &mut self.goal);
        self.side.fill(0.0);
        self.rows.add_transposed(1.0, &self.goal, &mut self.side);
        self.trial.copy_from(&self.step);
        self.newton()?;
        self.rows.image_into(&self.step.x, &mut self.step.s);
        self.dual_step();
        let trial = std::mem::replace(&mut self.trial, Triple::zeros(0, 0));
        self.step.add(1.0, &trial);
        self.trial = trial;
        let reached = self.reach(self.settings.step_fraction);
        if reached >= length + 0.01 {
            return Ok(Some(reached));
        }
        self.step.copy_from(&self.trial);
        Ok(None)
    }
}
