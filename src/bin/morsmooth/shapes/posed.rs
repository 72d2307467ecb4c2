//! One pose of a shape by the method asked for, with what is known of it.

use clap::{Args, ValueEnum};
use morsmooth::deform::{
    AugmentedOptions, Barrier, BarrierOptions, Blame, Compared, Comparison, DeformError, DeformOptions, DeformSolver, DeformStatus,
    Deformed, Deformer, DetPenaltyOptions, Ending, FactorChoice, Hold, Lagrangian, OnContradiction, RestShape, SolveMethod, SolveOptions,
    rotations, skinning,
};
use morsmooth::mesh::Pose;
use morsmooth::qp::{FactorPrecision, Penalty, Settings};
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::shapes::shape::{Rig, Shape};

/// How a pose is found.
#[derive(Debug, Clone, Args)]
pub struct PoseArgs {
    /// How the shape follows the handles. All but the first are there to compare with, and may invert elements.
    #[arg(long, value_enum, default_value_t = MethodKind::InversionFree)]
    pub method: MethodKind,

    /// How the convex problem of 'inversion-free' is solved; both end at the same optimum.
    #[arg(long, value_enum, default_value_t = SolverKind::Interior)]
    pub solver: SolverKind,

    /// The penalty of '--solver penalty'.
    #[arg(long, value_enum, default_value_t = PenaltyKind::Quadratic)]
    pub penalty: PenaltyKind,

    /// The barrier of '--method lim'.
    #[arg(long, value_enum, default_value_t = BarrierKind::Log)]
    pub barrier: BarrierKind,

    /// Handles hold exactly, not by springs. Handles that contradict each other then have no solution.
    #[arg(long, conflicts_with = "alpha")]
    pub hard: bool,

    /// Stiffness of the springs that draw held vertices to their places.
    #[arg(long, value_name = "ALPHA", default_value_t = 1e4, allow_negative_numbers = true)]
    pub alpha: f64,

    /// Weight of linearised incompressibility, such as 0.3.
    #[arg(long, value_name = "NU", default_value_t = 0.0, allow_negative_numbers = true)]
    pub incompressible: f64,

    /// Rounds in which the rotations of the elements are read anew from the shape, after the first solve.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub rotation_rounds: usize,

    /// Accept a rest shape with folded elements, and turn them right side out.
    #[arg(long)]
    pub untangle: bool,

    /// Memory that the factor of 'inversion-free' may take, such as 8GiB or 500MB; beyond it numbers of 32 bits take the place of 64, with
    /// conjugate gradients in 64 bits.
    #[arg(long, value_name = "SIZE", default_value = "16GiB", value_parser = bytes)]
    pub memory: usize,

    /// The numbers that the factor is made of.
    #[arg(long, value_enum, default_value_t = FactorKind::Automatic)]
    pub factor: FactorKind,

    /// Duality gap, relative to the energy, at which the solver stops.
    #[arg(long, value_name = "GAP", default_value_t = 1e-6, allow_negative_numbers = true)]
    pub gap: f64,

    /// Where handles contradict each other, write the closest shape without inversions that is found.
    #[arg(long)]
    pub keep_best: bool,

    /// Write the output even if elements are inverted, as the methods of comparison leave them.
    #[arg(long)]
    pub keep_unaudited: bool,
}

/// Values of `--method`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodKind {
    /// Least energy without inversions, certified.
    InversionFree,
    /// Least energy, no constraint: one linear system.
    ExRotated,
    /// Linear blend skinning.
    Lbs,
    /// Dual-quaternion skinning.
    Dqs,
    /// Barrier of det F from the rest shape on, as in locally injective mappings.
    Lim,
    /// Penalty of det F itself.
    DetPenalty,
    /// Spectral augmented Lagrangian of the same convex problem.
    Spectral,
    /// PENNON-like augmented Lagrangian of the same convex problem.
    Pennon,
}

/// Values of `--factor`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FactorKind {
    /// By size and memory.
    Automatic,
    /// 64 bits.
    Double,
    /// 32 bits, as the preconditioner of conjugate gradients in 64 bits.
    Single,
}

/// Reads `8GiB`, `500MB`, `1e9`.
fn bytes(text: &str) -> Result<usize, String> {
    const UNITS: [(&str, f64); 8] =
        [("KiB", 1024.0), ("MiB", 1048576.0), ("GiB", 1073741824.0), ("TiB", 1099511627776.0), ("kB", 1e3), ("MB", 1e6), ("GB", 1e9), ("B", 1.0)];
    let trimmed = text.trim();
    let (digits, unit) = UNITS
        .iter()
        .find_map(|(unit, factor)| trimmed.strip_suffix(unit).map(|digits| (digits, *factor)))
        .unwrap_or((trimmed, 1.0));
    match digits.trim().parse::<f64>() {
        Ok(number) if number * unit >= 1.0 && number.is_finite() => Ok((number * unit) as usize),
        _ => Err(format!("found '{text}'; expected a size such as 8GiB, 500MB or a number of bytes")),
    }
}

/// Values of `--solver`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SolverKind {
    /// Primal–dual interior point.
    Interior,
    /// Penalty continuation, whose iterates are previews.
    Penalty,
}

/// Values of `--penalty`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PenaltyKind {
    /// Clamped square.
    Quadratic,
    /// Clamped cube.
    Cubic,
    /// Logarithm and parabola.
    Spline,
}

/// Values of `--barrier`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BarrierKind {
    /// Logarithmic.
    Log,
    /// Reciprocal, as published.
    Reciprocal,
}

/// What a method says of its result. The audit of the file comes later.
pub enum Verdict {
    /// As asked.
    Good,
    /// Usable, with a warning.
    Warned(String),
    /// Handles contradict each other; whether another shape took the place of the asked one.
    Contradiction(Box<Blame>, bool),
}

/// A posed shape.
pub struct Posed {
    /// A position for every vertex.
    pub points: Vec<[f64; 3]>,
    /// `det F` of every element.
    pub determinants: Vec<f64>,
    /// The smallest eigenvalue of `sym(RᵀF)` of every element.
    pub eigenvalues: Vec<f64>,
    /// Energy over rest measure of every element.
    pub densities: Vec<f64>,
    /// Whether its constraint holds an element back; `None` for methods without.
    pub active: Option<Vec<bool>>,
    /// Largest and mean distance of the held vertices of each handle from where it wants them.
    pub distances: Vec<(f64, f64)>,
    /// What the method says.
    pub verdict: Verdict,
    /// Facts for the report.
    pub told: Value,
    /// Facts for people.
    pub lines: Vec<(&'static str, String)>,
}

/// A function called with the number and the positions of each iterate.
pub type Watch<'w> = &'w mut dyn FnMut(usize, &[f64]);

/// A shape with handles, ready for any number of poses.
pub struct Session<'a> {
    shape: &'a Shape,
    rig: &'a Rig,
    args: &'a PoseArgs,
    engine: Engine,
    /// What was chosen for the linear systems.
    factor: Option<String>,
}

enum Engine {
    Solver(Box<DeformSolver>),
    Other(Box<Deformer>),
}

impl<'a> Session<'a> {
    /// Analyses the shape.
    pub fn new(shape: &'a Shape, rig: &'a Rig, args: &'a PoseArgs) -> Result<Self, Failure> {
        let hold = if args.hard { Hold::Hard } else { Hold::Soft { alpha: args.alpha } };
        let options = DeformOptions { hold, incompressibility: args.incompressible, ..DeformOptions::default() };
        if !(args.gap > 0.0 && args.gap < 1.0) {
            return Err(Failure::usage(format!("found --gap {}; expected a number between 0 and 1", args.gap)));
        }
        let complex = shape.complex();
        let rest = if args.untangle { RestShape::untangled(complex) } else { RestShape::new(complex) };
        let engine = rest.and_then(|rest| match args.method {
            MethodKind::InversionFree => {
                DeformSolver::with_rest(complex, rest, rig.held.clone(), options).map(|solver| Engine::Solver(Box::new(solver)))
            }
            _ => Deformer::with_rest(rest, &rig.held.vertices, options).map(|deformer| Engine::Other(Box::new(deformer))),
        });
        let mut engine = engine.map_err(|error| refusal(shape, &error))?;
        let mut factor = None;
        if let Engine::Solver(solver) = &mut engine {
            factor = Some(choose_factor(solver, args)?);
        }
        Ok(Self { shape, rig, args, engine, factor })
    }

    /// A second session on the same analysis.
    pub fn fork(&self) -> Self {
        let engine = match &self.engine {
            Engine::Solver(solver) => Engine::Solver(Box::new(solver.fork())),
            Engine::Other(deformer) => Engine::Other(deformer.clone()),
        };
        Self { shape: self.shape, rig: self.rig, args: self.args, engine, factor: self.factor.clone() }
    }

    /// The rest shape.
    pub fn rest(&self) -> &RestShape {
        self.deformer().rest()
    }

    /// Elements whose orientation at rest is wrong.
    pub fn folded(&self) -> &[usize] {
        self.rest().folded()
    }

    fn deformer(&self) -> &Deformer {
        match &self.engine {
            Engine::Solver(solver) => solver.deformer(),
            Engine::Other(deformer) => deformer,
        }
    }

    /// Finds the shape of a pose.
    pub fn pose(&mut self, pose: &Pose, watch: Watch<'_>) -> Result<Posed, Failure> {
        let (shape, rig, args) = (self.shape, self.rig, self.args);
        let complex = shape.complex();
        let fail = |error: DeformError| refusal(shape, &error);
        let blended = rotations::blend(complex, &rig.weights, pose).map_err(fail)?;
        let targets = rig.targets(complex, pose);
        let deformer = match &mut self.engine {
            Engine::Solver(solver) => {
                let options = solve_options(args);
                let mut each = |at: morsmooth::deform::DeformPreview<'_>| watch(at.iteration, at.positions);
                let deformed = solver.solve(&blended, &targets, &options, &mut each).map_err(fail)?;
                let mut posed = of_deformed(deformed, rig);
                if let Some(factor) = &self.factor {
                    posed.told["factor"] = json!(factor);
                    posed.lines.push(("factor", factor.clone()));
                }
                return Ok(posed);
            }
            Engine::Other(deformer) => deformer,
        };
        let skinned = |points: Result<Vec<[f64; 3]>, DeformError>| -> Result<_, DeformError> {
            let points = points?;
            let dimension = complex.dimension();
            Ok((points.iter().flat_map(|point| point[..dimension].to_vec()).collect::<Vec<f64>>(), None))
        };
        let compared = |ended: Result<Compared, DeformError>| -> Result<_, DeformError> {
            let ended = ended?;
            Ok((ended.positions.clone(), Some(ended)))
        };
        let comparison = Comparison::new(deformer, &blended, &targets).map_err(fail)?;
        let found = match args.method {
            MethodKind::Lbs => skinned(skinning::linear_blend(complex.points(), &rig.weights, pose)),
            MethodKind::Dqs => skinned(skinning::dual_quaternion(complex.points(), &rig.weights, pose)),
            MethodKind::InversionFree | MethodKind::ExRotated => compared(comparison.ex_rotated()),
            MethodKind::Lim => {
                let barrier = if args.barrier == BarrierKind::Log { Barrier::Logarithm } else { Barrier::Reciprocal };
                compared(comparison.locally_injective(&BarrierOptions { barrier, ..BarrierOptions::default() }, watch))
            }
            MethodKind::DetPenalty => compared(comparison.det_penalty(&DetPenaltyOptions::default(), watch)),
            MethodKind::Spectral => compared(comparison.augmented(&AugmentedOptions::new(Lagrangian::Spectral), watch)),
            MethodKind::Pennon => compared(comparison.augmented(&AugmentedOptions::new(Lagrangian::Pennon), watch)),
        };
        let (positions, ended) = found.map_err(fail)?;
        of_other(deformer, (&blended, &targets), positions, ended.as_ref(), rig).map_err(fail)
    }
}

/// Chooses the factor, and says what was chosen and why.
fn choose_factor(solver: &mut DeformSolver, args: &PoseArgs) -> Result<String, Failure> {
    const GIB: f64 = 1073741824.0;
    let choice = match args.factor {
        FactorKind::Automatic => FactorChoice::Automatic,
        FactorKind::Double => FactorChoice::Double,
        FactorKind::Single => FactorChoice::Single,
    };
    solver.choose_factor(choice, args.memory);
    let (flops, [double, single]) = solver.factor_cost();
    let (chosen, size) = match solver.precision() {
        FactorPrecision::Double => ("64 bits", double),
        FactorPrecision::Single => ("32 bits, conjugate gradients in 64", single),
        FactorPrecision::Adaptive => ("32 bits with conjugate gradients in 64 while that pays, then 64 bits", double),
    };
    let told = |bytes: usize| format!("{:.2} GiB", bytes as f64 / GIB);
    if size > args.memory {
        let text = format!("the factor needs {} ({chosen}); --memory allows {}", told(size), told(args.memory));
        return Err(Failure::usage(text).hint("a coarser mesh, or more memory"));
    }
    Ok(format!(
        "direct, {chosen}: {:.2e} nonzeros, {flops:.1e} operations, {} of {} allowed (64 bits would take {})",
        solver.factor_entries() as f64,
        told(size),
        told(args.memory),
        told(double)
    ))
}

fn solve_options(args: &PoseArgs) -> SolveOptions {
    let penalty = match args.penalty {
        PenaltyKind::Quadratic => Penalty::Quadratic,
        PenaltyKind::Cubic => Penalty::Cubic,
        PenaltyKind::Spline => Penalty::Spline,
    };
    SolveOptions {
        method: if args.solver == SolverKind::Interior { SolveMethod::InteriorPoint } else { SolveMethod::Penalty(penalty) },
        settings: Settings { relative_gap: args.gap, ..SolveOptions::default().settings },
        rounds: args.rotation_rounds,
        on_contradiction: if args.keep_best { OnContradiction::KeepBest } else { OnContradiction::Name },
        ..SolveOptions::default()
    }
}

/// An error of the library as one about the file, elements translated to cells.
fn refusal(shape: &Shape, error: &DeformError) -> Failure {
    let failure = Failure::file(&shape.path, error);
    match error {
        DeformError::Inverted { elements } | DeformError::ZeroMeasure { elements, .. } => {
            let cells: Vec<String> = shape.cells_of(elements).iter().take(10).map(u32::to_string).collect();
            let more = if elements.len() > 10 { ", ..." } else { "" };
            failure.hint(format!("cells of the file: {}{more}", cells.join(", ")))
        }
        _ => failure,
    }
}

fn of_deformed(deformed: Deformed, rig: &Rig) -> Posed {
    let distances: Vec<f64> = deformed.handles.iter().map(|handle| handle.distance).collect();
    let certificate = &deformed.certificate;
    let verdict = match &deformed.status {
        DeformStatus::Certified => Verdict::Good,
        DeformStatus::Uncertified => Verdict::Warned(format!(
            "the solver stopped at a gap of {:.1e} (residual {:.1e}): no element is inverted, but the shape is not the certified optimum",
            certificate.duality_gap, certificate.stationarity
        )),
        DeformStatus::Contradiction(blame) => Verdict::Contradiction(Box::new(blame.clone()), deformed.substitute.is_some()),
        DeformStatus::Inverted => Verdict::Warned("the solver left inverted elements".to_owned()),
    };
    let effort = &deformed.effort;
    let problems = if effort.problems == 1 { String::new() } else { format!(" in {} problems", effort.problems) };
    let lines = vec![
        ("status", status_name(&deformed.status).to_owned()),
        ("energy", energy_line(&deformed.energy)),
        (
            "certificate",
            match deformed.is_certified() && deformed.is_without_energy() {
                true => format!("no energy but {:.1e} of the rest measure, and none is below 0", deformed.energy.total() / deformed.rest_measure),
                false => format!(
                    "duality gap {:.1e} of the energy, stationarity {:.1e}, constraints to {:.1e}",
                    certificate.duality_gap, certificate.stationarity, certificate.primal
                ),
            },
        ),
        ("effort", format!("{} factorizations, {} iterations{problems}, {:.2} s", effort.factorizations, effort.iterations, effort.seconds)),
    ];
    let told = json!({
        "status": deformed.status, "substitute": deformed.substitute, "solver": deformed.method, "energy": deformed.energy,
        "rest_measure": deformed.rest_measure,
        "certificate": certificate, "effort": effort,
        "active_constraints": deformed.elements.active.iter().filter(|active| **active).count(),
    });
    Posed {
        distances: by_handle(&distances, rig),
        points: deformed.points,
        determinants: deformed.elements.determinants,
        eigenvalues: deformed.elements.smallest_eigenvalues,
        densities: deformed.elements.energy_densities,
        active: Some(deformed.elements.active),
        verdict,
        told,
        lines,
    }
}

fn of_other(
    deformer: &Deformer,
    (rotations, targets): (&[[[f64; 3]; 3]], &[[f64; 3]]),
    positions: Vec<f64>,
    ended: Option<&Compared>,
    rig: &Rig,
) -> Result<Posed, DeformError> {
    let rest = deformer.rest();
    let dimension = rest.dimension();
    let energy = deformer.energy(rotations, targets, &positions)?;
    let mut points = rest.points().to_vec();
    for (point, place) in points.iter_mut().zip(positions.chunks(dimension)) {
        point[..dimension].copy_from_slice(place);
    }
    let distance = |(vertex, target): (&morsmooth::field::VertexId, &[f64; 3])| {
        let place = points[vertex.index()];
        (0..dimension).map(|axis| (place[axis] - target[axis]).powi(2)).sum::<f64>().sqrt()
    };
    let distances: Vec<f64> = deformer.handles().iter().zip(targets).map(distance).collect();
    let mut lines = vec![("energy", energy_line(&energy))];
    let mut told = json!({ "energy": energy });
    let mut verdict = Verdict::Good;
    if let Some(ended) = ended {
        let how = match ended.ending {
            Ending::Converged => "converged",
            Ending::IterationLimit => "not converged: its steps ran out",
            Ending::Stuck => "not converged: no step makes progress",
        };
        lines.insert(0, ("status", format!("{how} ({} steps, {} rounds)", ended.iterations, ended.rounds)));
        told["status"] = json!(ended.ending);
        told["effort"] = json!({ "factorizations": ended.iterations, "rounds": ended.rounds });
        if ended.ending != Ending::Converged {
            verdict = Verdict::Warned(format!("the method has {how} after {} steps", ended.iterations));
        }
    }
    Ok(Posed {
        determinants: rest.determinants(&positions)?,
        eigenvalues: rest.smallest_eigenvalues(rotations, &positions)?,
        densities: deformer.energy_densities(rotations, &positions)?,
        active: None,
        distances: by_handle(&distances, rig),
        points,
        verdict,
        told,
        lines,
    })
}

fn energy_line(energy: &morsmooth::deform::DeformEnergy) -> String {
    format!("{:.6e} (elastic {:.6e}, volume {:.3e}, handles {:.3e})", energy.total(), energy.elastic, energy.volume, energy.handles)
}

fn status_name(status: &DeformStatus) -> &'static str {
    match status {
        DeformStatus::Certified => "certified optimum",
        DeformStatus::Uncertified => "free of inversions, optimum not certified",
        DeformStatus::Contradiction(_) => "contradiction",
        DeformStatus::Inverted => "inverted elements left",
    }
}

/// Largest and mean distance for each handle.
fn by_handle(distances: &[f64], rig: &Rig) -> Vec<(f64, f64)> {
    let mut found = vec![(0.0f64, 0.0, 0usize); rig.held.names.len()];
    for (&distance, &owner) in distances.iter().zip(&rig.held.owners) {
        let (most, sum, count) = &mut found[owner];
        *most = most.max(distance);
        *sum += distance;
        *count += 1;
    }
    found.into_iter().map(|(most, sum, count)| (most, sum / count.max(1) as f64)).collect()
}
