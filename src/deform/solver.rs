//! Solves deformations one after the other: the rest shape is analysed once, a moved handle costs iterations only.

use super::{
    Begin, Blame, DeformError, DeformOptions, DeformStatus, Deformed, Deformer, Effort, ElementReport, FactorChoice, HandlePlace, HeldVertices, Hold,
    OnContradiction, RestShape, SolveMethod, SolveOptions, nearest_rotations,
};
use crate::audit::orientations;
use crate::field::Precision;
use crate::linalg::small::{from_scaled, scaled_length, smallest_eigenvalue};
use crate::mesh::SimplicialComplex;
use crate::qp::{Engine, FactorPrecision, Iterate, Known, PenaltyOptions, Problem, QpStatus, Solution};

/// Operations of a factorisation from which single precision pays although it needs more solves.
const HEAVY: f64 = 1e11;

/// Slack, in units of F, from which on no cone counts as active: where nothing is held back all multipliers are tiny alike.
const NEAR: f64 = 1e-3;

/// An iterate of a solve, shown while it runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeformPreview<'a> {
    /// Convex problems solved before this one.
    pub problem: usize,
    /// Iterations of this one.
    pub iteration: usize,
    /// `n x dim` coordinates.
    pub positions: &'a [f64],
    /// Relative duality gap of the interior point; of the penalties, the decrement of the last step.
    pub gap: f64,
    /// tau of the penalties; `None` for the interior point.
    pub tau: Option<f64>,
}

/// A rest shape with handles and everything that can be computed before a handle moves: order of elimination, structure of the
/// factor, stiffness.
///
/// # Example
/// ```
/// use morsmooth::{deform::{DeformOptions, DeformSolver, HeldVertices, SolveOptions}, mesh::SimplicialComplex};
/// // A square of two triangles, held at two corners, is stretched to twice its length along one side.
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let square = SimplicialComplex::new(2, points, vec![0, 1, 2, 0, 2, 3])?;
/// let held = HeldVertices::unnamed(vec![0.into(), 1.into()]);
/// let mut solver = DeformSolver::new(&square, held, DeformOptions::default())?;
/// let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let targets = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
/// let deformed = solver.solve(&[identity; 2], &targets, &SolveOptions::default(), &mut |_| {})?;
/// assert!(deformed.is_certified() && deformed.smallest_determinants()[1] > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct DeformSolver {
    pub(super) complex: SimplicialComplex,
    pub(super) held: HeldVertices,
    pub(super) deformer: Deformer,
    pub(super) engine: Engine,
    /// Near the end of the last solve. Its displacements are counted from targets and rest positions: held vertices move along.
    last: Option<Iterate>,
}

/// A solved problem with its positions.
pub(super) struct Solved {
    pub solution: Solution,
    pub positions: Vec<f64>,
}

impl DeformSolver {
    /// Analyses a mesh with held vertices.
    ///
    /// # Arguments
    /// * `complex`: `n` vertices; triangles in a plane z = constant, or tetrahedra.
    /// * `held`: at least one vertex in every connected part.
    ///
    /// # Errors
    /// As [`Deformer::new`]; [`DeformError::Owner`]; [`DeformError::Engine`].
    ///
    /// # Cost
    /// About one numeric factorisation.
    pub fn new(complex: &SimplicialComplex, held: HeldVertices, options: DeformOptions) -> Result<Self, DeformError> {
        Self::with_rest(complex, RestShape::new(complex)?, held, options)
    }

    /// As [`DeformSolver::new`], with a rest shape of one's own, such as [`RestShape::untangled`].
    ///
    /// # Errors
    /// As [`DeformSolver::new`].
    pub fn with_rest(
        complex: &SimplicialComplex,
        rest: RestShape,
        held: HeldVertices,
        options: DeformOptions,
    ) -> Result<Self, DeformError> {
        held.check()?;
        let deformer = Deformer::with_rest(rest, &held.vertices, options)?;
        let rotations = vec![[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]; complex.simplex_count()];
        let targets: Vec<[f64; 3]> = held.vertices.iter().map(|vertex| complex.points()[vertex.index()]).collect();
        // Rotations and targets move numbers but no pattern.
        let problem = deformer.problem(&rotations, &targets)?;
        let engine = Engine::new(&problem.objective, Some(&problem.constraints.coupling()), Some(&deformer.coordinates()))?;
        Ok(Self { complex: complex.clone(), held, deformer, engine, last: None })
    }

    /// A second solver on the same analysis, for frames side by side.
    ///
    /// # Cost
    /// Memory for one factor; no arithmetic.
    pub fn fork(&self) -> Self {
        Self {
            complex: self.complex.clone(),
            held: self.held.clone(),
            deformer: self.deformer.clone(),
            engine: self.engine.fork(),
            last: None,
        }
    }

    /// The assembled energy and cones.
    pub fn deformer(&self) -> &Deformer {
        &self.deformer
    }

    /// The held vertices.
    pub fn held(&self) -> &HeldVertices {
        &self.held
    }

    /// Chooses the numbers that the factor is made of.
    ///
    /// # Arguments
    /// * `memory`: bytes that the factor may take; [`FactorChoice::Automatic`] falls back to 32 bits beyond that.
    pub fn choose_factor(&mut self, choice: FactorChoice, memory: usize) {
        let fits = self.engine.factor_bytes(FactorPrecision::Double) <= memory;
        self.engine.set_precision(match choice {
            FactorChoice::Double => FactorPrecision::Double,
            FactorChoice::Single => FactorPrecision::Single,
            FactorChoice::Automatic if !fits => FactorPrecision::Single,
            FactorChoice::Automatic if self.engine.factor_flops() > HEAVY => FactorPrecision::Adaptive,
            FactorChoice::Automatic => FactorPrecision::Double,
        });
    }

    /// Operations of a factorisation, and bytes of a factor in double and in single precision with its work memory, estimated.
    pub fn factor_cost(&self) -> (f64, [usize; 2]) {
        let bytes = [FactorPrecision::Double, FactorPrecision::Single].map(|precision| self.engine.factor_bytes(precision));
        (self.engine.factor_flops(), bytes)
    }

    /// The numbers that the factor is made of.
    pub fn precision(&self) -> FactorPrecision {
        self.engine.precision()
    }

    /// Nonzeros of the factor.
    pub fn factor_entries(&self) -> usize {
        self.engine.factor_entries()
    }

    /// Deforms the shape: solves, reads rotations anew where rounds are asked for, audits.
    ///
    /// # Arguments
    /// * `rotations`: one an element, by rows; in 2-D the leading 2 x 2 block is read.
    /// * `targets`: a place for each held vertex.
    /// * `preview`: called with each iterate.
    ///
    /// # Returns
    /// The shape with its evidence, whatever the end: [`Deformed::status`] says whether it is what was asked for.
    ///
    /// # Errors
    /// As [`Deformer::problem`]; [`DeformError::Engine`].
    ///
    /// # Cost
    /// 10 to 25 numeric factorisations a problem.
    pub fn solve(
        &mut self,
        rotations: &[[[f64; 3]; 3]],
        targets: &[[f64; 3]],
        options: &SolveOptions,
        preview: &mut dyn FnMut(DeformPreview<'_>),
    ) -> Result<Deformed, DeformError> {
        let mut effort = Effort { factor_entries: self.engine.factor_entries(), ..Effort::default() };
        let mut rotations = rotations.to_vec();
        let mut solved = self.decided(&rotations, targets, options, (&mut effort, preview))?;
        for _ in 0..options.rounds {
            if solved.solution.status != QpStatus::Solved {
                break;
            }
            rotations = nearest_rotations(&self.deformer.rest().deformation_gradients(&solved.positions)?);
            let again = SolveOptions { begin: Begin::Cold, ..*options };
            solved = self.decided(&rotations, targets, &again, (&mut effort, preview))?;
        }
        let is_hard = self.deformer.options().hold == Hold::Hard;
        let status = match &solved.solution.status {
            QpStatus::Solved => DeformStatus::Certified,
            QpStatus::Infeasible(found) => {
                DeformStatus::Contradiction(Blame::new(found, self.deformer.rest(), &self.held, is_hard))
            }
            QpStatus::IterationLimit | QpStatus::Stalled | QpStatus::CutOff => DeformStatus::Uncertified,
        };
        if options.on_contradiction == OnContradiction::KeepBest && !self.is_usable(&solved)? {
            return self.closest((&rotations, targets), status, solved, options, (effort, preview));
        }
        self.report(status, (rotations, targets), solved, options, effort)
    }

    /// One convex problem.
    pub(super) fn solve_once(
        &mut self,
        rotations: &[[[f64; 3]; 3]],
        targets: &[[f64; 3]],
        options: &SolveOptions,
        (effort, preview): (&mut Effort, &mut dyn FnMut(DeformPreview<'_>)),
    ) -> Result<Solved, DeformError> {
        let problem = self.deformer.problem(rotations, targets)?;
        let reference = self.deformer.reference(targets)?;
        let count = effort.problems;
        let mut positions = reference.clone();
        let mut show = |iteration: usize, x: &[f64], gap: f64, tau: Option<f64>| {
            for ((slot, base), displacement) in positions.iter_mut().zip(&reference).zip(x) {
                *slot = base + displacement;
            }
            preview(DeformPreview { problem: count, iteration, positions: &positions, gap, tau });
        };
        let solution = match options.method {
            SolveMethod::InteriorPoint => {
                let last = self.last.as_ref().filter(|_| options.begin == Begin::Warm);
                let warm = last.map(|iterate| (&iterate.x[..], &iterate.dual[..]));
                let inside = self.deformer.turned_rest(rotations, &reference)?;
                let known = Known { warm, inside: inside.as_deref() };
                self.engine.solve_watched(&problem, known, &options.settings, &mut |at, x| show(at.iteration, x, at.gap, None))?
            }
            SolveMethod::Penalty(penalty) => {
                let weights = Some(self.deformer.rest().measures().to_vec());
                let penalty = PenaltyOptions { weights, ..PenaltyOptions::with(penalty) };
                let mut each = |at: crate::qp::Preview<'_>| show(at.iteration, at.x, at.decrement, Some(at.tau));
                self.engine.solve_penalty(&problem, None, &options.settings, &penalty, &mut each)?
            }
        };
        if solution.restart.is_some() {
            self.last.clone_from(&solution.restart);
        }
        effort.add(&solution);
        let positions = self.deformer.positions(targets, &solution.x)?;
        Ok(Solved { solution, positions })
    }

    /// Judges the end of a solve.
    pub(super) fn report(
        &self,
        status: DeformStatus,
        (rotations, targets): (Vec<[[f64; 3]; 3]>, &[[f64; 3]]),
        solved: Solved,
        options: &SolveOptions,
        effort: Effort,
    ) -> Result<Deformed, DeformError> {
        let Solved { solution, positions } = solved;
        let rest = self.deformer.rest();
        let dimension = rest.dimension();
        let points: Vec<[f64; 3]> = positions
            .chunks(dimension)
            .zip(rest.points())
            .map(|(place, point)| std::array::from_fn(|axis| if axis < dimension { place[axis] } else { point[axis] }))
            .collect();
        let judge = |precision| orientations(&self.complex, rest.folded(), &points, precision);
        let audit = [judge(Precision::F64)?, judge(Precision::F32)?];
        let is_clean = audit.iter().all(|report| report.is_clean());
        let energy = self.deformer.energy(&rotations, targets, &positions)?;
        let rest_measure = rest.measures().iter().sum();
        let smallest_eigenvalues = rest.smallest_eigenvalues(&rotations, &positions)?;
        let margins = self.deformer.margins(targets);
        let is_inside = smallest_eigenvalues.iter().zip(&margins).all(|(least, margin)| least >= margin);
        let status = match status {
            DeformStatus::Certified | DeformStatus::Uncertified if !is_clean => DeformStatus::Inverted,
            // No energy is below zero: there is nothing to gain, whatever a gap relative to rounding says.
            DeformStatus::Uncertified if is_inside && energy.total() <= Deformed::NO_ENERGY * rest_measure => DeformStatus::Certified,
            other => other,
        };
        let handles = self.held.vertices.iter().zip(targets).map(|(&vertex, &asked)| {
            let achieved = points[vertex.index()];
            let square: f64 = (0..dimension).map(|axis| (achieved[axis] - asked[axis]).powi(2)).sum();
            HandlePlace { vertex, asked, achieved, distance: square.sqrt() }
        });
        let suspects = match &status {
            DeformStatus::Certified => None,
            DeformStatus::Contradiction(blame) => Some(blame.clone()),
            DeformStatus::Uncertified | DeformStatus::Inverted => {
                let short = smallest_eigenvalues.iter().zip(&margins).map(|(least, margin)| margin - least).enumerate();
                Some(Blame::of_elements(short.filter(|&(_, short)| short > 0.0).collect(), rest, &self.held))
            }
        };
        let elements = ElementReport {
            determinants: rest.determinants(&positions)?,
            smallest_eigenvalues,
            energy_densities: self.deformer.energy_densities(&rotations, &positions)?,
            active: active(&solution, dimension),
        };
        Ok(Deformed {
            handles: handles.collect(),
            energy,
            rest_measure,
            certificate: solution.kkt,
            status,
            suspects,
            factor: self.engine.precision(),
            substitute: None,
            elements,
            audit,
            points,
            positions,
            rotations,
            method: options.method,
            effort,
        })
    }

    /// The problem for given rotations and targets, as the engine gets it: for other solvers.
    ///
    /// # Errors
    /// As [`Deformer::problem`].
    pub fn problem(&self, rotations: &[[[f64; 3]; 3]], targets: &[[f64; 3]]) -> Result<Problem, DeformError> {
        self.deformer.problem(rotations, targets)
    }
}

/// Blocks near the boundary of their cone whose multiplier, in units of the largest one, outweighs their slack.
fn active(solution: &Solution, dimension: usize) -> Vec<bool> {
    if dimension == 2 { outweighed::<2>(solution) } else { outweighed::<3>(solution) }
}

fn outweighed<const D: usize>(solution: &Solution) -> Vec<bool> {
    let trace = |block: &[f64]| (1..=D).map(|row| block[scaled_length(row) - 1]).sum::<f64>();
    let blocks = || solution.dual.chunks(scaled_length(D));
    let most = blocks().map(trace).fold(0.0, f64::max);
    let slacks = solution.slack.chunks(scaled_length(D));
    let is_active = |(z, s): (&[f64], &[f64])| {
        let least = smallest_eigenvalue(&from_scaled::<D>(s));
        least < NEAR && trace(z) > most * least
    };
    blocks().zip(slacks).map(is_active).collect()
}
