//! Functions on one mesh from values at some of its vertices: what depends on the mesh and the order is made once.

use std::time::Instant;

use crate::field::VertexId;
use crate::mesh::SimplicialComplex;
use crate::monotone::{EnergyWeights, Operators, energy_parts};
use crate::morse::WantedExtrema;
use crate::operators::positive_laplacian;
use crate::qp::{Engine, Minimum, Objective, QpStatus, Term};

use super::bounded::{Bounded, Box01, Ending};
use super::boundary::fixed_values;
use super::contraction::Contraction;
use super::controlled::{Controlled, Directions, Frame, Strict};
use super::lanes::in_lanes;
use super::method::{Guide, InterpolateOptions, Mass, Method};
use super::error::{InterpolateError, accepted};

/// A result within this part of the bound, the energy without order constraints, is good enough not to try other directions.
const NEAR_BOUND: f64 = 0.01;
/// A row counts as active if the solution is this much closer to it than the range of the values.
const ACTIVE: f64 = 1e-7;

/// Whether monotone functions keep their frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Frames {
    Kept,
    Dropped,
}

/// What solves of [`Method::Monotone`] begin with, one of each a function.
pub(super) struct Parts {
    pub fixed: Vec<Vec<Option<f64>>>,
    pub harmonic: Vec<Vec<f64>>,
    pub pinned: Vec<Vec<f64>>,
}

/// The values that a function must have.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BoundaryValues {
    /// Vertices and their values, at least one in every connected part of the mesh, in any order.
    pub values: Vec<(VertexId, f64)>,
    /// For [`Method::Monotone`]: the vertices that are to be its only extrema, each with a value. Where absent, the extrema are
    /// those given values that are extrema of the harmonic function through them: weights of handles have their maximum at their own
    /// vertices and their minima at those of the others.
    pub wanted: Option<WantedExtrema>,
}

impl From<Vec<(VertexId, f64)>> for BoundaryValues {
    fn from(values: Vec<(VertexId, f64)>) -> Self {
        Self { values, wanted: None }
    }
}

/// How a function was found.
#[derive(Debug, Clone, PartialEq)]
pub struct InterpolateReport {
    /// `fᵀ (L M⁻¹)^(k-1) L f` for the order k asked for, also where the method is harmonic. `[value² length^(d-2k)]`
    pub energy: f64,
    /// How the solver ended.
    pub status: QpStatus,
    /// Largest gradient of the Lagrangian at a free vertex, measured in product form, relative to the addends it is the sum of: the
    /// componentwise backward error. Linear methods refuse a function with more than 1e-8; of the others the status tells.
    pub residual: f64,
    /// Duality gap relative to the energy; 0 where the method is linear.
    pub gap: f64,
    /// Inequality constraints.
    pub rows: usize,
    /// Inequality constraints on which the function lies.
    pub active_rows: usize,
    /// Iterations of the interior point.
    pub iterations: usize,
    /// Numeric factorisations of its own; functions of a linear method share one.
    pub factorizations: usize,
    /// [`Method::Monotone`]: minima, one vertex for each connected set of equal values.
    pub minima: Vec<VertexId>,
    /// [`Method::Monotone`]: maxima, likewise.
    pub maxima: Vec<VertexId>,
    /// [`Method::Monotone`]: vertices that are constant because a single given value reaches them.
    pub constant: usize,
    /// [`Method::Monotone`]: whether another representative function took the place of the one asked for.
    pub guide_replaced: bool,
    /// [`Method::Monotone`]: energy before the repair, after each round.
    pub rounds: Vec<f64>,
    /// [`Method::Monotone`]: largest move of a value that made the stored numbers strict.
    pub largest_repair: f64,
    /// Wall time of this function alone, in seconds; work that functions share is in none.
    pub seconds: f64,
}

/// A function with the given values.
#[derive(Debug, Clone, PartialEq)]
pub struct Interpolated {
    /// `n` values of the asked width.
    pub values: Vec<f64>,
    /// How it was found.
    pub report: InterpolateReport,
}

/// Functions of least energy on one mesh: one ordering and one analysis for any number of them.
///
/// # Example
/// ```
/// use morsmooth::{field::VertexId, interpolate::{Interpolator, Method}, mesh::{Domain, Grid, Mask}};
/// let grid = Grid::image([12, 9, 1], [0.0; 3], [1.0; 3]);
/// let complex = Domain::from_grid(&grid, &Mask::none())?.complex;
/// let mut interpolator = Interpolator::new(&complex, 2)?;
/// let given = vec![(VertexId(0), 0.0), (VertexId(50), 1.0)].into();
/// let smooth = interpolator.solve(Method::Monotone, &given, &Default::default())?;
/// assert_eq!(smooth.values[50], 1.0);
/// assert_eq!(smooth.report.minima, [VertexId(0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Interpolator<'a> {
    complex: &'a SimplicialComplex,
    component: (Vec<u32>, usize),
    operators: Operators,
    order: usize,
    /// The energy of the order asked for.
    smooth: Objective,
    /// Engines for it, all on one analysis.
    engines: Vec<Engine>,
    dirichlet: Objective,
    /// Dirichlet energy with positive edge weights.
    positive: Objective,
    laplace: Engine,
}

impl<'a> Interpolator<'a> {
    /// Assembles the operators and analyses the patterns, with the [`Mass`] of the papers.
    ///
    /// # Arguments
    /// * `order`: k of the energy, 1 to 4.
    ///
    /// # Errors
    /// [`InterpolateError::Order`], [`InterpolateError::Unreferenced`], [`InterpolateError::Operator`].
    ///
    /// # Cost
    /// O(n + m), two fill-reducing orderings and symbolic analyses.
    pub fn new(complex: &'a SimplicialComplex, order: usize) -> Result<Self, InterpolateError> {
        Self::with_mass(complex, order, Mass::default())
    }

    /// As [`Interpolator::new`], with a mass of one's choice.
    ///
    /// # Errors
    /// As [`Interpolator::new`].
    pub fn with_mass(complex: &'a SimplicialComplex, order: usize, mass: Mass) -> Result<Self, InterpolateError> {
        if !(1..=4).contains(&order) {
            return Err(InterpolateError::Order { found: order });
        }
        let mut vertices = (0..complex.vertex_count()).map(VertexId::from);
        if let Some(vertex) = vertices.find(|&vertex| complex.star(vertex).is_empty()) {
            return Err(InterpolateError::Unreferenced { vertex });
        }
        let operators = mass.operators(complex)?;
        let n = complex.vertex_count();
        let chain = |order: usize| {
            let total: f64 = operators.mass.iter().sum();
            // Lengths in units of the spacing: then the energy of a function is of order one whatever the units of the file.
            let spacing = (total / n.max(1) as f64).powf(1.0 / complex.dimension() as f64);
            let term = Term::Chain {
                scale: spacing.powi(2 * order as i32) / total,
                stiffness: operators.laplacian.clone(),
                weights: operators.mass.iter().map(|mass| 1.0 / mass).collect(),
                order,
            };
            Objective { terms: vec![term], linear: vec![0.0; n], constant: 0.0 }
        };
        let (smooth, dirichlet) = (chain(order), chain(1));
        let terms = vec![Term::Matrix(positive_laplacian(complex)?)];
        let positive = Objective { terms, linear: vec![0.0; n], constant: 0.0 };
        let engines = vec![Engine::new(&smooth, None, Some(complex.points()))?];
        let laplace = Engine::new(&dirichlet, None, Some(complex.points()))?;
        let component = complex.components();
        Ok(Self { complex, component, operators, order, smooth, engines, dirichlet, positive, laplace })
    }

    /// The mesh.
    pub fn complex(&self) -> &'a SimplicialComplex {
        self.complex
    }

    /// k of the energy.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Laplacian and mass.
    pub fn operators(&self) -> &Operators {
        &self.operators
    }

    /// Whether the linear systems of the energy have auxiliary unknowns instead of formed products.
    pub fn is_mixed(&self) -> bool {
        self.engines[0].is_mixed()
    }

    /// Nonzeros of a factor of the energy's matrix.
    pub fn factor_entries(&self) -> usize {
        self.engines[0].factor_entries()
    }

    /// `fᵀ (L M⁻¹)^(k-1) L f`, multiplied through. `[value² length^(d-2k)]`
    ///
    /// # Arguments
    /// * `field`: `n` values.
    pub fn energy(&self, field: &[f64]) -> f64 {
        let weights = EnergyWeights { order: self.order, length: 1.0, confidence: None, smoothness: None };
        2.0 * energy_parts(&self.operators, &[], &weights, field).0
    }

    /// One function.
    ///
    /// # Errors
    /// As [`Interpolator::solve_each`].
    ///
    /// # Cost
    /// Linear methods: one factorisation. [`Method::Bounded`] and [`Method::Monotone`]: one an iteration, 10 to 30, of a matrix with the
    /// pattern of `(L M⁻¹)^(k-1) L`.
    pub fn solve(
        &mut self,
        method: Method,
        given: &BoundaryValues,
        options: &InterpolateOptions,
    ) -> Result<Interpolated, InterpolateError> {
        let mut found = self.solve_each(method, std::slice::from_ref(given), options)?;
        found.pop().ok_or(InterpolateError::Count { what: "functions", found: 0, expected: 1 })
    }

    /// Several functions, the same bits as each alone.
    ///
    /// Functions of a linear method that have values at the same vertices share one factor. The others run side by side, each on a
    /// factor of its own; the analysis is shared by all.
    ///
    /// # Arguments
    /// * `given`: the values of each function.
    ///
    /// # Returns
    /// Functions in the same order. Of [`Method::Monotone`], every function has in the stored width, under plain `<`, no extremum but
    /// plateaus of given values, whatever its status; the status says whether it is also optimal.
    ///
    /// # Errors
    /// [`InterpolateError`].
    ///
    /// # Cost
    /// As [`Interpolator::solve`]; memory for as many factors as functions run at once.
    pub fn solve_each(
        &mut self,
        method: Method,
        given: &[BoundaryValues],
        options: &InterpolateOptions,
    ) -> Result<Vec<Interpolated>, InterpolateError> {
        let fixed = given.iter().map(|given| fixed_values(self.complex, &self.component, &given.values));
        let fixed = fixed.collect::<Result<Vec<_>, _>>()?;
        match method {
            Method::Harmonic => {
                let found = minimisers(&mut self.laplace, &self.dirichlet, &fixed)?;
                found.into_iter().map(|(minimum, seconds)| self.linear(minimum, 1, seconds)).collect()
            }
            Method::Polyharmonic => {
                let found = minimisers(&mut self.engines[0], &self.smooth, &fixed)?;
                found.into_iter().map(|(minimum, seconds)| self.linear(minimum, self.order, seconds)).collect()
            }
            Method::Bounded => {
                let pinned = minimisers(&mut self.engines[0], &self.smooth, &fixed)?;
                self.side_by_side(fixed.len(), options, |this, engine, job| {
                    let clock = Instant::now();
                    let mut found = this.bounded(engine, &fixed[job], &pinned[job].0.x, options)?;
                    found.report.seconds = clock.elapsed().as_secs_f64();
                    Ok(found)
                })
            }
            Method::Monotone => {
                let parts = self.parts(given)?;
                let found = self.monotone_each(given, &parts, (options, Frames::Dropped))?;
                Ok(found.into_iter().map(|(found, _)| found).collect())
            }
        }
    }

    /// Checked values, harmonic functions for positive edge weights, and minimisers of the energy.
    pub(super) fn parts(&mut self, given: &[BoundaryValues]) -> Result<Parts, InterpolateError> {
        let fixed = given.iter().map(|given| fixed_values(self.complex, &self.component, &given.values));
        let fixed = fixed.collect::<Result<Vec<_>, _>>()?;
        let values = |found: Vec<(Minimum, f64)>| found.into_iter().map(|(minimum, _)| minimum.x).collect();
        let harmonic = values(minimisers(&mut self.laplace, &self.positive, &fixed)?);
        let pinned = values(minimisers(&mut self.engines[0], &self.smooth, &fixed)?);
        Ok(Parts { fixed, harmonic, pinned })
    }

    /// The energy as an objective.
    pub(super) fn smooth(&self) -> &Objective {
        &self.smooth
    }

    /// Monotone functions with what keeps them monotone.
    pub(super) fn framed(
        &mut self,
        given: &[BoundaryValues],
        options: &InterpolateOptions,
    ) -> Result<Vec<(Interpolated, Option<Frame>)>, InterpolateError> {
        let parts = self.parts(given)?;
        self.monotone_each(given, &parts, (options, Frames::Kept))
    }

    fn monotone_each(
        &mut self,
        given: &[BoundaryValues],
        parts: &Parts,
        (options, frames): (&InterpolateOptions, Frames),
    ) -> Result<Vec<(Interpolated, Option<Frame>)>, InterpolateError> {
        self.side_by_side(given.len(), options, |this, engine, job| {
            let clock = Instant::now();
            let (pinned, harmonic) = (&parts.pinned[job], &parts.harmonic[job]);
            let wanted = given[job].wanted.as_ref();
            let contraction = Contraction::new(this.complex, &parts.fixed[job], harmonic, wanted)?;
            let (mut found, directions) = this.monotone(engine, &contraction, (pinned, harmonic), options)?;
            found.report.seconds = clock.elapsed().as_secs_f64();
            Ok((found, (frames == Frames::Kept).then_some(Frame { contraction, directions })))
        })
    }

    /// Runs jobs on several engines, which are made for it and dropped afterwards.
    fn side_by_side<T: Send>(
        &mut self,
        jobs: usize,
        options: &InterpolateOptions,
        work: impl Fn(&Self, &mut Engine, usize) -> Result<T, InterpolateError> + Sync,
    ) -> Result<Vec<T>, InterpolateError> {
        let lanes = options.at_once.unwrap_or_else(rayon::current_num_threads).min(jobs).max(1);
        let mut engines = std::mem::take(&mut self.engines);
        while engines.len() < lanes {
            engines.push(engines[0].fork());
        }
        let this = &*self;
        let found = in_lanes(&mut engines, jobs, |engine, job| work(this, engine, job));
        engines.truncate(1);
        self.engines = engines;
        found
    }

    fn linear(&self, minimum: Minimum, order: usize, seconds: f64) -> Result<Interpolated, InterpolateError> {
        let residual = accepted(order, minimum.backward)?;
        let energy = self.energy(&minimum.x);
        let report = InterpolateReport { energy, residual, seconds, ..InterpolateReport::solved() };
        Ok(Interpolated { values: minimum.x, report })
    }

    /// The function of least energy within bounds.
    fn bounded(
        &self,
        engine: &mut Engine,
        fixed: &[Option<f64>],
        near: &[f64],
        options: &InterpolateOptions,
    ) -> Result<Interpolated, InterpolateError> {
        let problem = Box01::new(&self.smooth, self.order, fixed, options)?;
        let Bounded { mut values, rows, active, iterations, ending } = problem.solve(engine, near)?;
        for (value, fixed) in values.iter_mut().zip(fixed) {
            *value = fixed.unwrap_or(*value);
        }
        let shared = InterpolateReport {
            energy: self.energy(&values),
            rows,
            active_rows: active,
            iterations,
            factorizations: iterations,
            ..InterpolateReport::solved()
        };
        let report = match ending {
            Ending::Settled(minimum) => InterpolateReport { residual: minimum.backward, ..shared },
            Ending::Interior(solution) => InterpolateReport {
                residual: solution.kkt.backward,
                gap: solution.kkt.duality_gap,
                factorizations: solution.factorizations,
                status: solution.status,
                ..shared
            },
        };
        Ok(Interpolated { values, report })
    }

    /// The function of least energy without extrema but the contraction's.
    fn monotone(
        &self,
        engine: &mut Engine,
        contraction: &Contraction,
        (pinned, harmonic): (&[f64], &[f64]),
        options: &InterpolateOptions,
    ) -> Result<(Interpolated, Directions), InterpolateError> {
        let held;
        let pinned = match contraction.constant {
            0 => pinned,
            // What is held at a constant value is held there for the smooth function too.
            _ => {
                let fixed: Vec<Option<f64>> =
                    contraction.node.iter().map(|&node| contraction.fixed[node as usize]).collect();
                held = engine.minimise(&self.smooth, &fixed)?.x;
                &held
            }
        };
        let controlled = Controlled::new(contraction, &self.smooth, options);
        let both = [pinned, harmonic];
        let asked: &[&[f64]] = match options.guide {
            Guide::SmoothThenSimplify => &both[..1],
            Guide::Harmonic => &both[1..],
            Guide::Automatic if self.order <= 2 => &both[..1],
            Guide::Automatic => &both,
        };
        let mut strict: Option<Strict> = None;
        let bound = controlled.bound(pinned);
        for field in asked {
            // No other directions could gain more than the distance to the bound.
            if strict.as_ref().is_some_and(|found| found.solution.objective <= (1.0 + NEAR_BOUND) * bound) {
                break;
            }
            let directions = controlled.directions(field, harmonic)?;
            strict = Some(controlled.solve(engine, directions, pinned, strict.take())?);
        }
        let strict = strict.ok_or(InterpolateError::Count { what: "representative functions", found: 0, expected: 1 })?;
        let values = contraction.spread(&strict.nodes);
        let members = |nodes: &[VertexId]| nodes.iter().map(|node| contraction.member[node.index()]).collect();
        let scale = 2.0 * self.energy_unit();
        let report = InterpolateReport {
            energy: self.energy(&values),
            residual: strict.solution.kkt.backward,
            gap: strict.solution.kkt.duality_gap,
            rows: strict.solution.slack.len(),
            active_rows: strict.solution.slack.iter().filter(|&&slack| slack < ACTIVE).count(),
            iterations: strict.iterations,
            factorizations: strict.factorizations,
            minima: members(&contraction.wanted.minima),
            maxima: members(&contraction.wanted.maxima),
            constant: contraction.constant,
            guide_replaced: strict.directions.replaced,
            rounds: strict.rounds.iter().map(|energy| energy * scale).collect(),
            largest_repair: strict.largest_move,
            status: strict.solution.status,
            ..InterpolateReport::solved()
        };
        Ok((Interpolated { values, report }, strict.directions))
    }

    /// The energy whose objective is 1.
    fn energy_unit(&self) -> f64 {
        match &self.smooth.terms[..] {
            [Term::Chain { scale, .. }] => 1.0 / scale,
            _ => 1.0,
        }
    }
}

impl InterpolateReport {
    /// That of a solve without inequalities.
    pub(super) fn solved() -> Self {
        Self {
            energy: 0.0,
            status: QpStatus::Solved,
            residual: 0.0,
            gap: 0.0,
            rows: 0,
            active_rows: 0,
            iterations: 0,
            factorizations: 0,
            minima: Vec::new(),
            maxima: Vec::new(),
            constant: 0,
            guide_replaced: false,
            rounds: Vec::new(),
            largest_repair: 0.0,
            seconds: 0.0,
        }
    }
}

/// Minimisers for several sets of values; neighbours in the list with values at the same vertices share one factor. With the seconds of each.
fn minimisers(
    engine: &mut Engine,
    objective: &Objective,
    fixed: &[Vec<Option<f64>>],
) -> Result<Vec<(Minimum, f64)>, InterpolateError> {
    let mut found = Vec::with_capacity(fixed.len());
    let are_alike = |a: &Vec<Option<f64>>, b: &Vec<Option<f64>>| a.iter().zip(b).all(|(a, b)| a.is_some() == b.is_some());
    for alike in fixed.chunk_by(are_alike) {
        let mut pinned = engine.pin(objective, &alike[0])?;
        for fixed in alike {
            let clock = Instant::now();
            let minimum = pinned.minimise_at(fixed)?;
            found.push((minimum, clock.elapsed().as_secs_f64()));
        }
    }
    Ok(found)
}
