//! Inversion-free deformation against the methods that Liu 2016 compares it with, on the same meshes.
//!
//! ```text
//! cargo run --release --example comparison -- [table2] [fig10] [fig12] [20,40,60,80]
//! ```
//!
//! `table2`: quads, interior point and penalty continuation beside two augmented Lagrangians (the paper's counts and seconds, on its machine
//! of 2016, in brackets). `fig10`: the barrier method on a swirl. `fig12`: a penalty of det F. Seconds are processor seconds of all threads.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

#[path = "clock.rs"]
mod clock;
#[path = "scenes.rs"]
#[allow(dead_code)]
mod scenes;

use clock::processor_seconds;
use morsmooth::deform::{
    AugmentedOptions, Barrier, BarrierOptions, Compared, Comparison, DeformOptions, Deformer, DetPenaltyOptions, Lagrangian,
};
use morsmooth::qp::{Engine, PenaltyOptions, Settings};
use scenes::Scene;

/// Cells a side; steps and seconds of the paper's method, the spectral method and PENNON there.
const PAPER: [(usize, [(usize, f64); 3]); 4] = [
    (20, [(28, 0.211), (37, 0.231), (52, 0.373)]),
    (40, [(25, 0.606), (64, 1.63), (49, 1.512)]),
    (60, [(34, 1.74), (74, 4.168), (31, 2.754)]),
    (80, [(41, 3.991), (63, 6.313), (35, 5.485)]),
];

/// What a method came to.
struct Row {
    how: String,
    steps: usize,
    seconds: f64,
    energy: f64,
    inverted: usize,
    x: Vec<f64>,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_asked = |word: &str| arguments.iter().any(|argument| argument == word);
    let sizes: Vec<usize> = arguments
        .iter()
        .find(|argument| argument.starts_with(|first: char| first.is_ascii_digit()))
        .map_or(PAPER.map(|row| row.0).to_vec(), |list| list.split(',').map(|size| size.parse().unwrap()).collect());
    let is_all = !["table2", "fig10", "fig12"].iter().any(|word| is_asked(word));
    if is_all || is_asked("table2") {
        table2(&sizes);
    }
    if is_all || is_asked("fig10") {
        figure10();
    }
    if is_all || is_asked("fig12") {
        figure12();
    }
}

fn table2(sizes: &[usize]) {
    println!("| quad | method | steps [paper] | s [paper] | energy over the interior point's | inverted | largest distance to it |");
    println!("|---|---|---|---|---|---|---|");
    for &cells in sizes {
        let scene = scenes::quad(cells);
        let deformer = scene.deformer(DeformOptions::default());
        let comparison = Comparison::new(&deformer, &scene.rotations, &scene.targets).unwrap();
        let augmented = |kind| {
            let clock = processor_seconds();
            let ended = comparison.augmented(&AugmentedOptions::new(kind), &mut |_, _| {}).unwrap();
            row(&ended, clock)
        };
        let paper = PAPER.iter().find(|row| row.0 == cells).map(|row| row.1);
        let exact = interior(&deformer, &scene);
        let rows = [
            ("interior point", None, interior(&deformer, &scene)),
            ("penalty continuation", paper.map(|paper| paper[0]), penalty(&deformer, &scene)),
            ("spectral augmented Lagrangian", paper.map(|paper| paper[1]), augmented(Lagrangian::Spectral)),
            ("PENNON-like", paper.map(|paper| paper[2]), augmented(Lagrangian::Pennon)),
        ];
        for (name, paper, row) in rows {
            print(&format!("{cells} x {cells}"), name, paper, &row, &exact);
        }
    }
}

fn figure10() {
    println!("\nBarrier of det F (locally injective mappings), swirls of 40 x 40 cells, at most 3000 steps");
    println!("| swirl | method | steps [paper] | s | energy over the interior point's | inverted | largest distance to it |");
    println!("|---|---|---|---|---|---|---|");
    for degrees in [90.0, 180.0] {
        let scene = scenes::swirl(40, degrees);
        let deformer = scene.deformer(DeformOptions::default());
        let comparison = Comparison::new(&deformer, &scene.rotations, &scene.targets).unwrap();
        let exact = interior(&deformer, &scene);
        let what = format!("{degrees} degrees");
        print(&what, "interior point", Some((25, f64::NAN)), &exact, &exact);
        for barrier in [Barrier::Logarithm, Barrier::Reciprocal] {
            let clock = processor_seconds();
            let ended = comparison.locally_injective(&BarrierOptions { barrier, ..Default::default() }, &mut |_, _| {}).unwrap();
            print(&what, &format!("{barrier:?} barrier"), Some((3000, f64::NAN)), &row(&ended, clock), &exact);
        }
    }
}

fn figure12() {
    println!("\nPenalty of det F itself, at most 1000 steps");
    println!("| scene | method | steps [paper] | s | energy over the interior point's | inverted | largest distance to it |");
    println!("|---|---|---|---|---|---|---|");
    for (name, scene) in [("quad 40", scenes::quad(40)), ("swirl 180", scenes::swirl(40, 180.0)), ("ball 10", scenes::ball(10))] {
        let deformer = scene.deformer(DeformOptions::default());
        let comparison = Comparison::new(&deformer, &scene.rotations, &scene.targets).unwrap();
        let exact = interior(&deformer, &scene);
        print(name, "interior point", Some((50, f64::NAN)), &exact, &exact);
        let clock = processor_seconds();
        let ended = comparison.det_penalty(&DetPenaltyOptions::default(), &mut |_, _| {}).unwrap();
        print(name, "penalty of det F", Some((1000, f64::NAN)), &row(&ended, clock), &exact);
    }
}

fn row(ended: &Compared, clock: f64) -> Row {
    Row {
        how: format!("{:?}", ended.ending),
        steps: ended.iterations,
        seconds: processor_seconds() - clock,
        energy: ended.energy.total(),
        inverted: ended.inverted.len(),
        x: ended.positions.clone(),
    }
}

/// A gap of 1e-6, as for the others.
fn settings() -> Settings {
    Settings { relative_gap: 1e-6, residual: 1e-6, ..Settings::default() }
}

fn interior(deformer: &Deformer, scene: &Scene) -> Row {
    solved(deformer, scene, |engine, problem| engine.solve(problem, None, &settings(), &mut |_| {}).unwrap())
}

fn penalty(deformer: &Deformer, scene: &Scene) -> Row {
    let options = PenaltyOptions { weights: Some(deformer.rest().measures().to_vec()), ..PenaltyOptions::default() };
    solved(deformer, scene, |engine, problem| engine.solve_penalty(problem, None, &settings(), &options, &mut |_| {}).unwrap())
}

fn solved(
    deformer: &Deformer,
    scene: &Scene,
    solve: impl Fn(&mut Engine, &morsmooth::qp::Problem) -> morsmooth::qp::Solution,
) -> Row {
    let clock = processor_seconds();
    let problem = deformer.problem(&scene.rotations, &scene.targets).unwrap();
    let mut engine =
        Engine::new(&problem.objective, Some(&problem.constraints.coupling()), Some(&deformer.coordinates())).unwrap();
    let solution = solve(&mut engine, &problem);
    let seconds = processor_seconds() - clock;
    let x = deformer.positions(&scene.targets, &solution.x).unwrap();
    let inverted = deformer.rest().determinants(&x).unwrap().iter().filter(|det| det.is_nan() || **det <= 0.0).count();
    Row { how: format!("{:?}", solution.status), steps: solution.factorizations, seconds, energy: solution.objective, inverted, x }
}

fn print(scene: &str, name: &str, paper: Option<(usize, f64)>, row: &Row, exact: &Row) {
    let told = |number: f64| if number.is_nan() { String::new() } else { format!(" [{number}]") };
    let (steps, seconds) = paper.map_or((String::new(), String::new()), |(steps, seconds)| (format!(" [{steps}]"), told(seconds)));
    let apart = row.x.iter().zip(&exact.x).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!(
        "| {scene} | {name} ({}) | {}{steps} | {:.3}{seconds} | {:.1e} | {} | {apart:.1e} |",
        row.how,
        row.steps,
        row.seconds,
        row.energy / exact.energy - 1.0,
        row.inverted
    );
}
