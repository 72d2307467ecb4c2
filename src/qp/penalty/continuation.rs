//! Algorithm 1: Newton steps at rising penalty parameters.

use super::blocks::{Blocks, Level};
use super::measure::{Measured, certificate, measured, transposed, unit};
use super::{Method, PenaltyOptions, Preview, Until};
use crate::qp::product::{add, dot, largest};
use crate::qp::problem::{finite, length};
use crate::qp::{Engine, Problem, QpError, QpStatus, Settings, Solution, Timings};
use std::time::Instant;

/// Decrement relative to the energy below which its change cannot be told from rounding, and the full step is taken.
const ROUNDING: f64 = 1e-11;

/// Refinements of a step with the Newton matrix in product form.
const REFINEMENTS: usize = 3;

/// From this parameter on the diagonal is shifted, by a relative part that grows with it.
const SHIFTED: f64 = 1e12;

/// Steps beyond the end of a parameter that sharpen a point whose rows and gap are good already.
const POLISH: usize = 3;

/// Trials of a line search; the last is too short to be a step.
const TRIALS: usize = 40;

/// A point with multipliers and how good it is.
struct Candidate {
    x: Vec<f64>,
    z: Vec<f64>,
    measured: Measured,
}

/// One solve in progress.
struct Continuation<'a> {
    engine: &'a mut Engine,
    problem: &'a Problem,
    settings: &'a Settings,
    options: &'a PenaltyOptions,
    blocks: Blocks,
    x: Vec<f64>,
    /// `A x + b`.
    s: Vec<f64>,
    /// `-dT/dS`, after a step with its linear change.
    z: Vec<f64>,
    gradient: Vec<f64>,
    step: Vec<f64>,
    image: Vec<f64>,
    change: Vec<f64>,
    work: [Vec<f64>; 3],
    unit: f64,
    iterations: usize,
    solves: usize,
    timings: Timings,
}

/// How the steps at one parameter ended.
enum Stage {
    Converged,
    OutOfIterations,
    Stuck,
}

impl Engine {
    /// Solves a problem by penalty continuation.
    ///
    /// # Arguments
    /// * `problem`: objective and rows inside the engine's pattern.
    /// * `start`: x_0; `None` takes the minimiser without rows. Entries at fixed unknowns are ignored.
    /// * `settings`: tolerances of an optimal point; the limit of iterations counts Newton steps.
    /// * `options`: penalty, schedule and line search.
    /// * `preview`: called with every iterate.
    ///
    /// # Returns
    /// The best point over all parameters, by the KKT residuals of the problem as given. [`Solution::slack`] is `A x + b` moved into the
    /// cones, [`Solution::dual`] the multipliers of the penalty. The point may violate rows by the primal residual; with
    /// [`QpStatus::Solved`] by no more than the settings allow.
    ///
    /// # Errors
    /// As [`Engine::solve`], and [`QpError::Option`] for an option out of range.
    ///
    /// # Cost
    /// 20 to 100 numeric factorisations and about two solves for each.
    ///
    /// # Source
    /// Liu et al. 2016, algorithm 1.
    pub fn solve_penalty(
        &mut self,
        problem: &Problem,
        start: Option<&[f64]>,
        settings: &Settings,
        options: &PenaltyOptions,
        preview: &mut dyn FnMut(Preview<'_>),
    ) -> Result<Solution, QpError> {
        let clock = Instant::now();
        problem.check()?;
        options.check(problem.constraints.members())?;
        if let Some(start) = start {
            length("start", start.len(), problem.fixed.len())?;
            finite("start", start)?;
        }
        let before = self.factorizations();
        self.assemble(&problem.objective, &problem.fixed)?;
        let mut blocks = Blocks::new(problem, self)?;
        match &options.weights {
            Some(weights) => blocks.weights.clone_from(weights),
            None => blocks.weigh_by(&self.diagonal_values()),
        }
        let (n, m) = (self.unknowns(), problem.constraints.offset.len());
        let mut run = Continuation {
            engine: self,
            problem,
            settings,
            options,
            blocks,
            x: problem.fixed.iter().map(|fixed| fixed.unwrap_or(0.0)).collect(),
            s: vec![0.0; m],
            z: vec![0.0; m],
            gradient: vec![0.0; n],
            step: vec![0.0; n],
            image: vec![0.0; m],
            change: vec![0.0; m],
            work: std::array::from_fn(|_| vec![0.0; n]),
            unit: 1.0,
            iterations: 0,
            solves: 0,
            timings: Timings::default(),
        };
        run.begin(start)?;
        let (status, best) = run.schedule(preview)?;
        let mut solution = run.finish(status, best);
        solution.factorizations = self.factorizations() - before;
        solution.timings.total = clock.elapsed().as_secs_f64();
        Ok(solution)
    }
}

/// The solution of a problem that is solved once, by either method.
///
/// # Arguments
/// * `method`: interior point, or penalty continuation with its options.
/// * `coordinates`: a place for each unknown, where there is one; see [`Engine::new`].
///
/// # Errors
/// As [`Engine::solve`] and [`Engine::solve_penalty`].
///
/// # Example
/// ```
/// use morsmooth::linalg::CsrMatrix;
/// use morsmooth::qp::{Cone, Constraints, Method, Objective, PenaltyOptions, Problem, QpStatus, Settings, Term, solve_with};
/// // The nearest positive semi-definite matrix to [[1, 2], [2, 1]] is [[1.5, 1.5], [1.5, 1.5]].
/// let target = [1.0, 2.0 * 2f64.sqrt(), 1.0];
/// let objective = Objective {
///     terms: vec![Term::Diagonal(vec![1.0; 3])],
///     linear: target.iter().map(|t| -t).collect(),
///     constant: 5.0,
/// };
/// let matrix = CsrMatrix::from_triplets(3, 3, &[(0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0)])?;
/// let constraints = Constraints { matrix, offset: vec![0.0; 3], cones: vec![Cone::Psd2(1)] };
/// let problem = Problem { objective, fixed: vec![None; 3], constraints };
/// let method = Method::Penalty(PenaltyOptions::default());
/// let solution = solve_with(&problem, &method, None, &Settings::default())?;
/// assert_eq!(solution.status, QpStatus::Solved);
/// assert!((solution.x[0] - 1.5).abs() < 1e-7 && (solution.objective - 0.5).abs() < 1e-7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn solve_with(
    problem: &Problem,
    method: &Method,
    coordinates: Option<&[[f64; 3]]>,
    settings: &Settings,
) -> Result<Solution, QpError> {
    problem.check()?;
    let mut engine = Engine::new(&problem.objective, Some(&problem.constraints.coupling()), coordinates)?;
    match method {
        Method::InteriorPoint => engine.solve(problem, None, settings, &mut |_| {}),
        Method::Penalty(options) => engine.solve_penalty(problem, None, settings, options, &mut |_| {}),
    }
}

impl Continuation<'_> {
    /// Sets the first point and the units of rows and energy.
    fn begin(&mut self, start: Option<&[f64]>) -> Result<(), QpError> {
        match start {
            Some(start) => {
                for ((slot, &value), fixed) in self.x.iter_mut().zip(start).zip(&self.problem.fixed) {
                    *slot = fixed.unwrap_or(value);
                }
            }
            None => {
                let minimum = self.engine.minimise(&self.problem.objective, &self.problem.fixed)?;
                self.solves += minimum.solves;
                self.x = minimum.x;
            }
        }
        self.slack();
        let mean = self.s.iter().map(|value| value.abs()).sum::<f64>() / self.s.len().max(1) as f64;
        let known = largest(&self.problem.constraints.offset).max(largest(&self.x));
        self.blocks.unit = [mean, known].into_iter().find(|unit| *unit > 0.0).unwrap_or(1.0);
        Ok(())
    }

    fn slack(&mut self) {
        self.problem.constraints.matrix.multiply_into(&self.x, &mut self.s);
        add(&mut self.s, 1.0, &self.problem.constraints.offset);
    }

    /// All parameters in turn; the status and the best point.
    fn schedule(&mut self, preview: &mut dyn FnMut(Preview<'_>)) -> Result<(QpStatus, Candidate), QpError> {
        preview(Preview { iteration: 0, tau: 0.0, x: &self.x, violation: self.blocks.violation(&self.s), decrement: 0.0 });
        // Where no row is violated, the minimiser without rows is the optimum, with multipliers zero.
        let mut best = self.candidate();
        if self.is_good(&best) {
            return Ok((QpStatus::Solved, best));
        }
        let mut level = Level { penalty: self.options.penalty, tau: self.options.start };
        loop {
            let mut ended = self.stage(level, preview)?;
            let mut here = self.candidate();
            for _ in 0..POLISH {
                let kkt = here.measured.kkt;
                let is_near = kkt.primal <= self.settings.residual && kkt.duality_gap <= self.settings.relative_gap;
                if self.is_good(&here) || !is_near || !matches!(ended, Stage::Converged) {
                    break;
                }
                if self.iterations == self.settings.max_iterations {
                    ended = Stage::OutOfIterations;
                    break;
                }
                self.newton(level)?;
                self.advance(1.0);
                let next = self.candidate();
                if next.measured.merit(self.settings) > 0.5 * here.measured.merit(self.settings) {
                    break;
                }
                here = next;
            }
            if let Some(found) = certificate(self.engine, self.problem, &here.x, &here.z) {
                return Ok((QpStatus::Infeasible(found), here));
            }
            if here.measured.merit(self.settings) <= best.measured.merit(self.settings) {
                best = here;
            }
            let is_good = self.is_good(&best);
            if is_good && self.options.until == Until::Optimal {
                return Ok((QpStatus::Solved, best));
            }
            let is_last = level.tau * self.options.growth > self.options.limit * (1.0 + 1e-9);
            let status = match ended {
                Stage::OutOfIterations => QpStatus::IterationLimit,
                Stage::Stuck => QpStatus::Stalled,
                Stage::Converged if is_last => QpStatus::Stalled,
                Stage::Converged => {
                    level.tau *= self.options.growth;
                    continue;
                }
            };
            return Ok((if is_good { QpStatus::Solved } else { status }, best));
        }
    }

    fn is_good(&self, candidate: &Candidate) -> bool {
        candidate.measured.merit(self.settings) <= 1.0
    }

    /// The present point and multipliers, these moved into the dual cone, measured.
    fn candidate(&mut self) -> Candidate {
        let mut z = self.z.clone();
        self.blocks.project(&mut z);
        let measured = measured((self.engine, self.problem, &self.blocks), (&self.x, &self.s, &z), &mut self.work[0]);
        self.unit = measured.unit;
        Candidate { x: self.x.clone(), z, measured }
    }

    /// Newton steps at one parameter until the decrement is small, or no longer falls for rounding.
    fn stage(&mut self, level: Level, preview: &mut dyn FnMut(Preview<'_>)) -> Result<Stage, QpError> {
        let mut before = f64::INFINITY;
        while self.iterations < self.settings.max_iterations {
            let decrement = self.newton(level)?;
            let relative = decrement / self.unit;
            if !relative.is_finite() {
                return Ok(Stage::Stuck);
            }
            let is_rounding = relative <= ROUNDING;
            let length = if is_rounding { 1.0 } else { self.line_search(level, decrement) };
            self.advance(length);
            let violation = self.blocks.violation(&self.s);
            preview(Preview { iteration: self.iterations, tau: level.tau, x: &self.x, violation, decrement: relative.max(0.0) });
            let is_small = relative <= self.options.tolerance.powi(2);
            if is_small || (is_rounding && relative > 0.25 * before) {
                return Ok(Stage::Converged);
            }
            if length == 0.0 {
                // No decrease can be seen: at the end of what rounding lets through the next parameter may still help.
                return Ok(if relative <= 1e-6 { Stage::Converged } else { Stage::Stuck });
            }
            before = relative;
            self.unit = unit(self.problem, &self.x, &mut self.engine.scratch).1;
        }
        Ok(Stage::OutOfIterations)
    }

    /// The Newton step at the present point; returns `gᵀ H⁻¹ g`.
    fn newton(&mut self, level: Level) -> Result<f64, QpError> {
        let clock = Instant::now();
        self.engine.reset_values();
        self.blocks.linearise(level, &self.s, &mut self.z, &mut self.engine.values);
        if level.tau >= SHIFTED {
            self.engine.shift_values((1e-15 * level.tau / SHIFTED).min(1e-13));
        }
        self.engine.factor_values()?;
        self.iterations += 1;
        self.timings.factor += clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        let [forces, residual, correction] = &mut self.work;
        self.problem.objective.product_into(&self.x, &mut self.gradient, &mut self.engine.scratch);
        add(&mut self.gradient, 1.0, &self.problem.objective.linear);
        transposed(self.problem, &self.z, forces);
        add(&mut self.gradient, -1.0, forces);
        self.engine.mask(&mut self.gradient);
        for (slot, g) in residual.iter_mut().zip(&self.gradient) {
            *slot = -g;
        }
        self.step.fill(0.0);
        let size = largest(residual);
        let mut left = size;
        for _ in 0..=REFINEMENTS {
            correction.copy_from_slice(residual);
            self.engine.system.solve_in_place(&self.engine.symbolic, correction);
            self.engine.mask(correction);
            self.solves += 1;
            add(&mut self.step, 1.0, correction);
            self.problem.constraints.matrix.multiply_into(&self.step, &mut self.image);
            self.blocks.change(level, (&self.s, &self.image), &mut self.change);
            self.problem.objective.product_into(&self.step, residual, &mut self.engine.scratch);
            transposed(self.problem, &self.change, forces);
            for ((slot, force), g) in residual.iter_mut().zip(forces.iter()).zip(&self.gradient) {
                *slot = -g - *slot + force;
            }
            self.engine.mask(residual);
            let now = largest(residual);
            if now <= 1e-13 * size || now > 0.1 * left || !now.is_finite() {
                break;
            }
            left = now;
        }
        self.timings.solve += clock.elapsed().as_secs_f64();
        Ok(-dot(&self.gradient, &self.step))
    }

    /// The first step length of the backtracking that lowers the penalised energy enough; 0 if none does.
    fn line_search(&mut self, level: Level, decrement: f64) -> f64 {
        if decrement <= 0.0 {
            return 0.0;
        }
        let [gradient, ..] = &mut self.work;
        self.problem.objective.product_into(&self.x, gradient, &mut self.engine.scratch);
        add(gradient, 1.0, &self.problem.objective.linear);
        let slope = dot(gradient, &self.step);
        let curvature = self.problem.objective.quadratic(&self.step, &mut self.engine.scratch);
        let line = &self.options.line_search;
        let mut length = 1.0;
        for _ in 0..TRIALS {
            // Differences, term by term: the energy itself would hide them behind its constant.
            let change = length * (slope + length * curvature) + self.blocks.difference(level, (&self.s, &self.image), length);
            if change <= -line.slope * length * decrement {
                return length;
            }
            length *= line.shrink;
        }
        0.0
    }

    /// Takes a step, and with a full one the multipliers that it predicts: they balance the gradient at the new point up to
    /// the accuracy of the solve, while those computed from the new point carry tau times its rounding.
    fn advance(&mut self, length: f64) {
        add(&mut self.x, length, &self.step);
        add(&mut self.z, length, &self.change);
        self.slack();
    }

    fn finish(self, status: QpStatus, best: Candidate) -> Solution {
        let mut slack = self.problem.constraints.matrix.multiply(&best.x);
        add(&mut slack, 1.0, &self.problem.constraints.offset);
        self.blocks.project(&mut slack);
        Solution {
            x: best.x,
            slack,
            dual: best.z,
            restart: None,
            status,
            objective: best.measured.objective,
            kkt: best.measured.kkt,
            iterations: self.iterations,
            factorizations: 0,
            solves: self.solves,
            timings: self.timings,
        }
    }
}
