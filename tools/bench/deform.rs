//! Deformations by the driver: iterations, factorizations, seconds, certificate and audit, beside clarabel and the paper.
//!
//! ```text
//! cargo run --release --example deform -- SCENE[,SCENE..] [method=ipm|quadratic|cubic|spline] [factor=automatic|double|single]
//!     [memory=GIB] [gap=1e-6] [nu=0] [hard] [best] [rounds=0] [warm] [clarabel] [repeat=N] [verbose]
//! ```
//!
//! Scenes: `quad-80` (`4 cells²` triangles), `swirl-80-270` (cells, degrees), `ball-10` (cubes across), `bar-50-6-170`
//! (folded), `twist-50-6-180`, `stretch-50-6-3`; mesh scenes see `tools/bars/deform.py`. One line of JSON a scene.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

#[path = "clock.rs"]
mod clock;
#[path = "conic.rs"]
mod conic;
#[allow(dead_code)]
#[path = "scenes.rs"]
mod scenes;
#[path = "second_order.rs"]
mod second_order;

use clock::processor_seconds;
use morsmooth::deform::{Begin, DeformOptions, DeformSolver, FactorChoice, HeldVertices, Hold, OnContradiction, SolveMethod, SolveOptions};
use morsmooth::qp::{Penalty, Settings};
use scenes::{Load, Scene};
use second_order::Unknowns;
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    for name in arguments.first().map_or("quad-20", |text| text).split(',') {
        run(name, &scene(name), &arguments);
    }
}

/// The value of `key=value`.
fn value<'a>(arguments: &'a [String], key: &str) -> Option<&'a str> {
    arguments.iter().find_map(|argument| argument.strip_prefix(key)?.strip_prefix('='))
}

fn number(arguments: &[String], key: &str, default: f64) -> f64 {
    value(arguments, key).map_or(default, |text| text.parse().unwrap())
}

fn scene(name: &str) -> Scene {
    let mut parts = name.split('-');
    let kind = parts.next().unwrap();
    let numbers: Vec<f64> = parts.map(|part| part.parse().unwrap()).collect();
    let count = |place: usize| numbers[place] as usize;
    match kind {
        "quad" => scenes::quad(count(0)),
        "swirl" => scenes::swirl(count(0), numbers[1]),
        "ball" => scenes::ball(count(0)),
        "bar" => scenes::bar(count(0), count(1), numbers[2]),
        "twist" => scenes::rod(count(0), count(1), Load::Twist(numbers[2])),
        "lone" => scenes::lone(count(0), numbers[1]),
        "shaken" => scenes::shaken(count(0), numbers[1], numbers[2] as u64),
        "stretch" => scenes::rod(count(0), count(1), Load::Stretch(numbers[2])),
        other => panic!("no scene {other}"),
    }
}

/// Largest resident memory so far, MiB.
fn peak() -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find(|line| line.starts_with("VmHWM")).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|kib| kib.parse::<f64>().ok()).unwrap_or(0.0) / 1024.0
}

fn run(name: &str, scene: &Scene, arguments: &[String]) {
    let is_asked = |word: &str| arguments.iter().any(|argument| argument == word);
    let options = DeformOptions {
        hold: if is_asked("hard") { Hold::Hard } else { Hold::Soft { alpha: 1e4 } },
        incompressibility: number(arguments, "nu", 0.0),
        ..DeformOptions::default()
    };
    let method = match value(arguments, "method").unwrap_or("ipm") {
        "quadratic" => SolveMethod::Penalty(Penalty::Quadratic),
        "cubic" => SolveMethod::Penalty(Penalty::Cubic),
        "spline" => SolveMethod::Penalty(Penalty::Spline),
        _ => SolveMethod::InteriorPoint,
    };
    let settings = Settings { relative_gap: number(arguments, "gap", 1e-6), ..Settings::default() };
    let solve = SolveOptions {
        method,
        settings,
        rounds: number(arguments, "rounds", 0.0) as usize,
        on_contradiction: if is_asked("best") { OnContradiction::KeepBest } else { OnContradiction::Name },
        ..SolveOptions::default()
    };
    let (clock, wall) = (processor_seconds(), Instant::now());
    let held = HeldVertices::unnamed(scene.handles.clone());
    let mut solver = DeformSolver::new(&scene.complex, held, options).unwrap();
    let factor = match value(arguments, "factor").unwrap_or("automatic") {
        "double" => FactorChoice::Double,
        "single" => FactorChoice::Single,
        _ => FactorChoice::Automatic,
    };
    solver.choose_factor(factor, (number(arguments, "memory", 12.0) * (1u64 << 30) as f64) as usize);
    let (analysis, analysis_wall) = (processor_seconds() - clock, wall.elapsed().as_secs_f64());
    if is_asked("analyse") {
        let (flops, bytes) = solver.factor_cost();
        println!("{name}: {} nonzeros, {flops:.2e} operations, {bytes:?} bytes, {analysis:.2} s", solver.factor_entries());
        return;
    }
    let mut best: Option<(f64, f64, morsmooth::deform::Deformed)> = None;
    for _ in 0..number(arguments, "repeat", 1.0) as usize {
        let (clock, wall) = (processor_seconds(), Instant::now());
        let mut show = |preview: morsmooth::deform::DeformPreview<'_>| {
            if is_asked("verbose") {
                println!("{:3} gap {:.1e} after {:.2} s", preview.iteration, preview.gap, wall.elapsed().as_secs_f64());
            }
        };
        let deformed = solver.solve(&scene.rotations, &scene.targets, &solve, &mut show).unwrap();
        let (processor, wall) = (processor_seconds() - clock, wall.elapsed().as_secs_f64());
        if best.as_ref().is_none_or(|best| processor < best.0) {
            best = Some((processor, wall, deformed));
        }
    }
    let (processor, wall, deformed) = best.unwrap();
    if is_asked("warm") {
        moved_handles(&mut solver, scene, &solve);
    }
    let peer = if is_asked("clarabel") {
        let problem = solver.problem(&scene.rotations, &scene.targets).unwrap();
        let reference = solver.deformer().reference(&scene.targets).unwrap();
        let peer = |unknowns| second_order::clarabel(&problem, &reference, unknowns, deformed.energy.total());
        serde_json::json!({ "displacements": peer(Unknowns::Displacements), "positions": peer(Unknowns::Positions) })
    } else {
        serde_json::Value::Null
    };
    let row = serde_json::json!({
        "scene": name,
        "method": deformed.method,
        "substitute": deformed.substitute,
        "elements": scene.complex.simplex_count(),
        "vertices": scene.complex.vertex_count(),
        "status": deformed.status,
        "iterations": deformed.effort.iterations,
        "factorizations": deformed.effort.factorizations,
        "solves": deformed.effort.solves,
        "factor": solver.precision(),
        "factor_flops": solver.factor_cost().0,
        "factor_bytes": solver.factor_cost().1,
        "factor_entries": deformed.effort.factor_entries,
        "factor_seconds": deformed.effort.factor_seconds,
        "analysis_processor": analysis,
        "analysis_seconds": analysis_wall,
        "processor": processor,
        "seconds": wall,
        "energy": deformed.energy.total(),
        "gap": deformed.certificate.duality_gap,
        "stationarity": deformed.certificate.stationarity,
        "active": deformed.elements.active.iter().filter(|&&active| active).count(),
        "smallest_determinant": deformed.audit[0].smallest,
        "smallest_determinant_single": deformed.audit[1].smallest,
        "inverted": deformed.audit.iter().map(|audit| audit.inverted.len() + audit.degenerate.len()).sum::<usize>(),
        "farthest_handle": deformed.farthest_handle().map_or(0.0, |place| place.distance),
        "peak_mebibytes": peak(),
        "clarabel": peer,
    });
    println!("{row}");
}

/// Moves the handles a little, step by step, and solves cold and warm.
fn moved_handles(solver: &mut DeformSolver, scene: &Scene, options: &SolveOptions) {
    for step in 1..=3 {
        let shift = 0.002 * f64::from(step);
        let targets: Vec<[f64; 3]> = scene
            .targets
            .iter()
            .zip(&scene.handles)
            .map(|(&[x, y, z], vertex)| if [x, y, z] == scene.complex.points()[vertex.index()] { [x, y, z] } else { [x + shift, y, z] })
            .collect();
        let warm = SolveOptions { begin: Begin::Warm, ..*options };
        let next = solver.solve(&scene.rotations, &targets, &warm, &mut |_| {}).unwrap();
        let cold = solver.fork().solve(&scene.rotations, &targets, options, &mut |_| {}).unwrap();
        let off = (next.energy.total() - cold.energy.total()) / cold.energy.total();
        println!(
            "moved by {shift}: {} factorizations cold, {} warm ({}), energies differ by {off:.1e}",
            cold.effort.factorizations,
            next.effort.factorizations,
            next.is_certified()
        );
    }
}
