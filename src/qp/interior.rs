//! The primal–dual interior point: Mehrotra's predictor and corrector on the condensed normal equations.

use std::time::Instant;

use super::centred::Centre;
use super::certificate::certificate;
use super::elastic::Verdict;
use super::kkt::Measure;
use super::product::{add, largest};
use super::rows::Rows;
use super::scaling::Scaling;
use super::start::{Start, initial};
use super::{Engine, Iterate, Problem, Progress, QpError, QpStatus, Settings, Solution, Timings};

/// A solve that stalls with a larger relative gap than this is begun again from another start.
const RESTART_GAP: f64 = 1e-6;

/// Steps shorter than this, twice in a row, make a contradiction among blocks likely enough to look for.
const BLOCKED: f64 = 0.05;

/// So many short steps in a row end the search for duals that prove it; the elastic problem takes over.
const PATIENCE: usize = 4;

/// So many short steps in a row are enough to begin anew where a point inside every cone is known.
const DETOUR: usize = 3;

/// Relative gap and residuals at which rows are first decided, and the share of them at which they are decided again if that was too soon.
const DECIDABLE: (f64, f64) = (1e-3, 1e-2);

/// What the caller of [`Engine::solve_watched`] knows of a problem.
#[derive(Debug, Clone, Copy, Default)]
pub struct Known<'a> {
    /// x and dual of a nearby problem's solution, as for [`Engine::solve_warm`]; `None` begins at the minimiser without constraints.
    pub warm: Option<(&'a [f64], &'a [f64])>,
    /// A point well inside every cone, n numbers, however far from the optimum. The solve goes on from there if the way from its start is
    /// blocked; no contradiction is looked for.
    pub inside: Option<&'a [f64]>,
}

/// What is shown of an iterate: where the solve stands, and x.
pub(super) type Watch<'a> = dyn FnMut(Progress, &[f64]) + 'a;

/// A direction, or a point, in x, slack and dual.
#[derive(Clone)]
pub(super) struct Triple {
    pub x: Vec<f64>,
    pub s: Vec<f64>,
    pub z: Vec<f64>,
}

impl Triple {
    pub(super) fn zeros(unknowns: usize, rows: usize) -> Self {
        Self { x: vec![0.0; unknowns], s: vec![0.0; rows], z: vec![0.0; rows] }
    }

    pub(super) fn add(&mut self, length: f64, step: &Self) {
        add(&mut self.x, length, &step.x);
        add(&mut self.s, length, &step.s);
        add(&mut self.z, length, &step.z);
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        self.x.copy_from_slice(&other.x);
        self.s.copy_from_slice(&other.s);
        self.z.copy_from_slice(&other.z);
    }

    fn is_finite(&self) -> bool {
        [&self.x, &self.s, &self.z].iter().all(|part| part.iter().all(|value| value.is_finite()))
    }
}

/// One solve in progress: the point, the residuals and all work memory.
pub(super) struct Interior<'a> {
    pub engine: &'a mut Engine,
    pub problem: &'a Problem,
    pub settings: &'a Settings,
    pub rows: Rows,
    /// The given start fulfils every row: whatever the duals seem to say, there is no contradiction.
    pub is_feasible: bool,
    /// What the start was split with, until its first step is done.
    pub centre: Option<Centre>,
    /// A point inside every cone that was not begun at yet.
    pub inside: Option<&'a [f64]>,
    /// The point is the minimiser without rows, fulfils every row, and is therefore the optimum, with multipliers of zero.
    pub is_free: bool,
    /// The elastic problem has been solved already.
    pub is_suspected: bool,
    /// Relative gap and residuals at which rows are next decided.
    pub decide_at: f64,
    /// Relative stationarity at which [`Interior::is_bounded`] was asked last.
    pub bounded_at: f64,
    /// What it found the residual to hide of the gap, relative.
    pub hidden: f64,
    pub point: Triple,
    /// `P x + q - Aᵀ z` on the free unknowns.
    pub stationarity: Vec<f64>,
    /// `A x + b - s`.
    pub primal: Vec<f64>,
    /// Scaling of slacks and duals at the point.
    pub scaling: Scaling,
    /// Dual steps are `goal - V ds`.
    pub goal: Vec<f64>,
    /// Right-hand side of the normal equations; free between two directions.
    pub side: Vec<f64>,
    pub step: Triple,
    pub trial: Triple,
    /// One number a row for whoever needs it.
    pub work: Vec<f64>,
    /// x, z and gap of the first iterate near the solution.
    rough: Option<(Vec<f64>, Vec<f64>, f64)>,
    /// The first solve with the present factor needed no refinement.
    pub is_exact: bool,
    pub solves: usize,
    /// Factorisations of other matrices on behalf of this solve.
    pub elsewhere: usize,
    pub timings: Timings,
}

impl Engine {
    /// Solves a problem to its optimum, or says why not.
    ///
    /// # Arguments
    /// * `problem`: objective and rows inside the engine's pattern.
    /// * `start`: a point with `A x + b` clearly positive in every row is taken as it is. Of any other point, best the minimiser without
    ///   rows, x is taken, and slacks and duals are split from the violations; where [`Engine::minimise`] was the last call, its factor
    ///   serves for that, otherwise it is one factorisation more. `None` computes the minimiser. Entries at fixed unknowns are ignored.
    /// * `settings`: tolerances and limits.
    /// * `progress`: called once an iteration.
    ///
    /// # Returns
    /// The best point with its KKT residuals; [`Solution::status`] says whether it is optimal.
    ///
    /// # Errors
    /// [`QpError`] for a malformed problem, rows outside the pattern, or a form that is not convex.
    ///
    /// # Cost
    /// 3 to 30 numeric factorisations, and three to eight solves for each.
    ///
    /// # Source
    /// Mehrotra 1992; Gondzio 1996 (centrality correctors); Boyd et al. 2011 and Gill et al. 1990 (splitting and deciding, see [`Settings::splitting`]).
    pub fn solve(
        &mut self,
        problem: &Problem,
        start: Option<&[f64]>,
        settings: &Settings,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Solution, QpError> {
        self.run(problem, (start.map_or(Start::Cold, Start::Point), None), settings, &mut |at, _| progress(at))
    }

    /// As [`Engine::solve`], or [`Engine::solve_warm`] where the multipliers of a nearby problem are given, with a look at each iterate.
    ///
    /// # Arguments
    /// * `known`: what is known of the solution and of the feasible set.
    /// * `watch`: called once an iteration with the n numbers of the point.
    ///
    /// # Errors
    /// As [`Engine::solve`].
    pub fn solve_watched(
        &mut self,
        problem: &Problem,
        known: Known<'_>,
        settings: &Settings,
        watch: &mut dyn FnMut(Progress, &[f64]),
    ) -> Result<Solution, QpError> {
        let start = known.warm.map_or(Start::Cold, |(x, dual)| Start::Warm { x, dual });
        if let Some(inside) = known.inside {
            Start::Inside(inside).check(problem)?;
        }
        self.run(problem, (start, known.inside), settings, watch)
    }

    /// Solves a problem from the point and duals of a nearby one (a moved value, the next refinement round).
    ///
    /// # Arguments
    /// * `x`, `dual`: of a previous solution, n and m numbers, best of its [`Solution::restart`]; slacks and duals are lifted off the
    ///   boundary before the first step.
    ///
    /// # Errors
    /// As [`Engine::solve`].
    pub fn solve_warm(
        &mut self,
        problem: &Problem,
        (x, dual): (&[f64], &[f64]),
        settings: &Settings,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Solution, QpError> {
        self.run(problem, (Start::Warm { x, dual }, None), settings, &mut |at, _| progress(at))
    }

    pub(super) fn run(
        &mut self,
        problem: &Problem,
        (start, inside): (Start<'_>, Option<&[f64]>),
        settings: &Settings,
        progress: &mut Watch<'_>,
    ) -> Result<Solution, QpError> {
        let clock = Instant::now();
        problem.check()?;
        start.check(problem)?;
        let before = self.factorizations();
        self.apply_precision();
        self.assemble(&problem.objective, &problem.fixed)?;
        let rows = Rows::new(problem, self)?;
        let (n, m) = (self.unknowns(), rows.len());
        let mut interior = Interior {
            problem,
            settings,
            point: Triple::zeros(n, m),
            stationarity: vec![0.0; n],
            primal: vec![0.0; m],
            scaling: Scaling::new(&rows),
            goal: vec![0.0; m],
            work: vec![0.0; m],
            side: vec![0.0; n],
            step: Triple::zeros(n, m),
            trial: Triple::zeros(n, m),
            rough: None,
            is_exact: false,
            solves: 0,
            elsewhere: 0,
            timings: Timings::default(),
            rows,
            is_feasible: inside.is_some(),
            centre: None,
            inside,
            is_free: false,
            is_suspected: false,
            decide_at: DECIDABLE.0,
            bounded_at: f64::INFINITY,
            hidden: 0.0,
            engine: self,
        };
        initial(&mut interior, start)?;
        let (status, iterations) = match interior.rows.contradiction.take() {
            Some(found) => (QpStatus::Infeasible(found), 0),
            None if m == 0 || interior.is_free => interior.without_rows(progress),
            None => match interior.begin(progress)? {
                (QpStatus::Stalled, iterations) if !interior.rows.is_polyhedral() => interior.resume(iterations, progress)?,
                (QpStatus::Stalled, iterations) => interior.restart(iterations, progress)?,
                ended => ended,
            },
        };
        let elsewhere = interior.elsewhere;
        let mut solution = interior.finish(status, iterations);
        solution.factorizations = self.factorizations() - before + elsewhere;
        solution.timings.total = clock.elapsed().as_secs_f64();
        Ok(solution)
    }
}

/// The solution of a problem that is solved once: [`Engine::new`] with the problem's rows, then [`Engine::solve`].
///
/// # Arguments
/// * `coordinates`: a place for each unknown, where there is one; see [`Engine::new`].
///
/// # Errors
/// As [`Engine::solve`].
///
/// # Example
/// ```
/// use morsmooth::linalg::CsrMatrix;
/// use morsmooth::qp::{Constraints, Objective, Problem, QpStatus, Settings, Term, solve};
/// // The point nearest to (2, 1) with x_0 <= x_1 is (1.5, 1.5).
/// let objective = Objective { terms: vec![Term::Diagonal(vec![1.0, 1.0])], linear: vec![-2.0, -1.0], constant: 2.5 };
/// let order = CsrMatrix::from_triplets(1, 2, &[(0, 0, -1.0), (0, 1, 1.0)])?;
/// let problem = Problem { objective, fixed: vec![None; 2], constraints: Constraints::nonnegative(order, vec![0.0]) };
/// let solution = solve(&problem, None, None, &Settings::default())?;
/// assert_eq!(solution.status, QpStatus::Solved);
/// assert!((solution.x[0] - 1.5).abs() < 1e-6 && (solution.objective - 0.25).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn solve(
    problem: &Problem,
    start: Option<&[f64]>,
    coordinates: Option<&[[f64; 3]]>,
    settings: &Settings,
) -> Result<Solution, QpError> {
    problem.check()?;
    let mut engine = Engine::new(&problem.objective, Some(&problem.constraints.coupling()), coordinates)?;
    engine.solve(problem, start, settings, &mut |_| {})
}

impl Interior<'_> {
    /// Without rows, or where none holds the minimiser back, the start is the optimum already.
    fn without_rows(&mut self, progress: &mut Watch<'_>) -> (QpStatus, usize) {
        let measure = Measure::of(self);
        progress(measure.progress(0, 0.0), &self.point.x);
        (if measure.is_optimal(self.settings) { QpStatus::Solved } else { QpStatus::Stalled }, 0)
    }

    /// Rounds of splitting where they are likely to end sooner, iterations where those have not brought the optimum.
    fn begin(&mut self, progress: &mut Watch<'_>) -> Result<(QpStatus, usize), QpError> {
        match self.splitting(progress)? {
            (Some(status), rounds) => Ok((status, rounds)),
            (None, rounds) => self.iterate(rounds, progress),
        }
    }

    /// Decides rows by an iterate that is near the optimum: active is what has a larger dual than slack, in units of P.
    fn decide_if_near(
        &mut self,
        measure: &Measure,
        iteration: usize,
        progress: &mut Watch<'_>,
    ) -> Result<Option<(QpStatus, usize)>, QpError> {
        let kkt = &measure.kkt;
        if kkt.duality_gap.max(kkt.primal).max(kkt.stationarity) > self.decide_at || !self.is_for_deciding() {
            return Ok(None);
        }
        self.decide_at = DECIDABLE.0.min(DECIDABLE.1 * kkt.duality_gap.max(kkt.primal).max(kkt.stationarity));
        let parts = self.point.s.iter().zip(&self.point.z).zip(self.stiffness());
        let decision = parts.map(|((s, z), stiffness)| *z > stiffness * s).collect();
        self.decide(decision, iteration, progress)
    }

    /// Keeps the first iterate that is near the solution, for restarts.
    pub(super) fn keep_rough(&mut self, measure: &Measure) {
        if self.rough.is_none() && measure.is_rough() {
            self.rough = Some((self.point.x.clone(), self.point.z.clone(), measure.kkt.duality_gap));
        }
    }

    /// Begins once more, elsewhere, after a stall far from the optimum; ends at the better of the two points.
    fn restart(&mut self, iterations: usize, progress: &mut Watch<'_>) -> Result<(QpStatus, usize), QpError> {
        let before = Measure::of(self);
        if before.kkt.duality_gap <= RESTART_GAP || iterations >= self.settings.max_iterations {
            return Ok((QpStatus::Stalled, iterations));
        }
        let stalled = self.point.clone();
        initial(self, Start::Lifted)?;
        self.again(&before, &stalled, iterations, progress)
    }

    /// After a stall on blocks: the elastic problem says whether they contradict each other; if it cannot, its point is the next start.
    fn resume(&mut self, iterations: usize, progress: &mut Watch<'_>) -> Result<(QpStatus, usize), QpError> {
        let before = Measure::of(self);
        let is_near = before.kkt.duality_gap <= RESTART_GAP && before.kkt.primal <= RESTART_GAP;
        if is_near || iterations >= self.settings.max_iterations {
            return Ok((QpStatus::Stalled, iterations));
        }
        let stalled = self.point.clone();
        if let Some(inside) = self.inside.take() {
            initial(self, Start::Inside(inside))?;
            return self.again(&before, &stalled, iterations, progress);
        }
        let verdict = if self.is_feasible { Verdict::Near(stalled.x.clone()) } else { self.elastic()? };
        let near = match verdict {
            Verdict::Infeasible(found) => return Ok((QpStatus::Infeasible(found), iterations)),
            Verdict::Near(x) => x,
        };
        // The elastic problem is solved once; a second blockade is the end.
        self.is_suspected = true;
        initial(self, Start::Point(&near))?;
        self.again(&before, &stalled, iterations, progress)
    }

    /// Iterates from a new start; ends at the better of the two points.
    fn again(
        &mut self,
        before: &Measure,
        stalled: &Triple,
        iterations: usize,
        progress: &mut Watch<'_>,
    ) -> Result<(QpStatus, usize), QpError> {
        let (status, iterations) = self.iterate(iterations, progress)?;
        let is_open = matches!(status, QpStatus::Stalled | QpStatus::IterationLimit);
        if is_open && Measure::of(self).merit(self.settings) >= before.merit(self.settings) {
            self.point.copy_from(stalled);
        }
        Ok((status, iterations))
    }

    /// Iterates from the present point, counting from `first`.
    fn iterate(&mut self, first: usize, progress: &mut Watch<'_>) -> Result<(QpStatus, usize), QpError> {
        let mut best = self.point.clone();
        let mut best_merit = f64::INFINITY;
        let mut without_progress = 0;
        let mut length = 0.0;
        let mut blocked = 0;
        for iteration in first..=self.settings.max_iterations {
            let measure = Measure::of(self);
            // What was shown before this start is shown once.
            if iteration > first || first == 0 {
                progress(measure.progress(iteration, length), &self.point.x);
            }
            let merit = measure.merit(self.settings);
            if merit < best_merit {
                without_progress = if merit < 0.9 * best_merit { 0 } else { without_progress + 1 };
                best.copy_from(&self.point);
                best_merit = merit;
            } else {
                without_progress += 1;
            }
            self.keep_rough(&measure);
            if measure.is_optimal(self.settings) {
                self.hidden = 0.0;
                return Ok((QpStatus::Solved, iteration));
            }
            if self.is_bounded(&measure)? {
                return Ok((QpStatus::Solved, iteration));
            }
            if measure.is_above(self.settings.cutoff) {
                return Ok((QpStatus::CutOff, iteration));
            }
            let reach = largest(&self.point.x).max(self.rows.offset_size);
            let scale = (self.point.x.len(), reach);
            if !self.is_feasible && let Some(found) = certificate(&self.rows, &self.point.z, scale) {
                return Ok((QpStatus::Infeasible(found), iteration));
            }
            if iteration == self.settings.max_iterations {
                return Ok((QpStatus::IterationLimit, iteration));
            }
            if let Some(ended) = self.decide_if_near(&measure, iteration, progress)? {
                return Ok(ended);
            }
            blocked = if length < BLOCKED && iteration > first { blocked + 1 } else { 0 };
            if blocked >= DETOUR && self.inside.is_some() {
                return Ok((QpStatus::Stalled, iteration));
            }
            if blocked >= 2 && !self.rows.is_polyhedral() && !self.is_feasible {
                if blocked == 2 && let Some(found) = self.projected_certificate()? {
                    return Ok((QpStatus::Infeasible(found), iteration));
                }
                if blocked >= if self.is_suspected { 2 * PATIENCE } else { PATIENCE } {
                    return Ok((QpStatus::Stalled, iteration));
                }
            }
            length = if without_progress > 15 { 0.0 } else { self.advance(measure.unit)? };
            if let Some(centre) = self.centre.take().and_then(|centre| centre.after(length)) {
                self.point.x.copy_from_slice(&best.x);
                self.rows.slack_into(&self.point.x, &mut self.point.s);
                centre.apply(&mut self.point.s, &mut self.point.z);
                best_merit = f64::INFINITY;
                continue;
            }
            if length < 1e-9 || !self.point.is_finite() {
                self.point.copy_from(&best);
                Measure::of(self);
                return Ok((QpStatus::Stalled, iteration + 1));
            }
        }
        Ok((QpStatus::IterationLimit, self.settings.max_iterations))
    }

    fn finish(self, status: QpStatus, iterations: usize) -> Solution {
        let mut measure = Measure::of_point(&self);
        if status == QpStatus::Solved {
            measure.kkt.duality_gap += self.hidden;
        }
        let total = self.problem.constraints.offset.len();
        let mut slack = self.problem.constraints.matrix.multiply(&self.point.x);
        add(&mut slack, 1.0, &self.problem.constraints.offset);
        let mut dual = vec![0.0; total];
        let decided = || (self.point.x.clone(), self.point.z.clone(), measure.kkt.duality_gap);
        let rough = self.rough.or_else(|| (status == QpStatus::Solved).then(decided));
        let mut restart = rough.map(|(x, z, gap)| (Iterate { x, dual: vec![0.0; total], gap }, z));
        for (row, &original) in self.rows.original.iter().enumerate() {
            slack[original as usize] = self.point.s[row];
            dual[original as usize] = self.point.z[row];
            if let Some((iterate, z)) = &mut restart {
                iterate.dual[original as usize] = z[row];
            }
        }
        Solution {
            slack,
            dual,
            restart: restart.map(|(iterate, _)| iterate),
            status,
            objective: measure.objective,
            kkt: measure.kkt,
            iterations,
            factorizations: 0,
            solves: self.solves,
            timings: self.timings,
            x: self.point.x,
        }
    }
}
