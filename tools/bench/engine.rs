//! The engine against one factorisation plus one solve, on one thread and on two, and against clarabel.
//!
//! ```text
//! cargo run --release --example engine -- [sides 71,123,241] [orders 2] [cases data,nodata,smooth] [clarabel] [warm] [excess] [four] [inside] [two]
//! ```
//!
//! Sides 123, 241, 500 and 1000 have 15,129, 58,081, 250,000 and 1,000,000 vertices. Seconds on one thread are processor seconds, honest
//! on a machine that others use too; what two threads gain is wall time against wall time and wants a quiet machine. The solve begins at the
//! minimiser without rows, which a caller needs anyway for the order of the vertices and whose factor the engine still holds; its
//! cost is the floor. `inside` begins at a strictly feasible point instead; `four` solves four problems side by side; `two` makes one
//! solve on two threads and nothing else.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

#[path = "clock.rs"]
mod clock;
#[path = "conic.rs"]
mod conic;
#[path = "peer.rs"]
mod peer;
#[path = "problems.rs"]
mod problems;

use clock::processor_seconds;
use std::sync::OnceLock;
use std::time::Instant;

use morsmooth::qp::{Engine, Progress, QpStatus, Settings, Solution};
use rayon::prelude::*;
use problems::{Case, instance};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let list = |index: usize, default: &str| -> Vec<String> {
        arguments.get(index).map_or(default, |text| text).split(',').map(str::to_owned).collect()
    };
    let with_peer = arguments.iter().any(|argument| argument == "clarabel");
    println!("| n | k | case | rows | nnz(L) | analysis s | factor + solve s | iterations | factorizations | solves | s | x (factor + solve) | x with the minimiser | wall s, 1 thread, 2 threads, gain | same bits | gap | stationarity (rounding) | primal | energy | peak MiB | clarabel: iterations, s, energy rel. |");
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for side in list(0, "71,123,241") {
        for order in list(1, "2") {
            for case in list(2, "data,nodata,smooth") {
                let case = match case.as_str() {
                    "nodata" => Case::NoData,
                    "smooth" => Case::Smooth,
                    _ => Case::Data,
                };
                run(side.parse().unwrap(), order.parse().unwrap(), case, with_peer);
            }
        }
    }
}

/// What the stationarity residual r adds to the gap at most: half of r' inverse(P) r, relative to the objective.
fn excess(engine: &mut Engine, made: &problems::Instance, solution: &morsmooth::qp::Solution) {
    let problem = &made.problem;
    let mut residual = vec![0.0; problem.fixed.len()];
    problem.objective.gradient_into(&solution.x, &mut residual);
    let forces = problem.constraints.matrix.transpose().multiply(&solution.dual);
    residual.iter_mut().zip(&forces).for_each(|(r, f)| *r -= f);
    residual.iter_mut().zip(&problem.fixed).filter(|(_, fixed)| fixed.is_some()).for_each(|(r, _)| *r = 0.0);
    let mut step = residual.clone();
    let left = engine.pin(&problem.objective, &problem.fixed).unwrap().solve(&mut step).unwrap();
    let energy: f64 = residual.iter().zip(&step).map(|(r, d)| 0.5 * r * d).sum();
    println!("the residual adds {:.1e} to the gap (solved to {left:.1e})", energy / solution.objective);
}

/// Restarts from the iterate kept for it after the data changed by a little noise.
fn warm(engine: &mut Engine, made: &problems::Instance, settings: &Settings) {
    let saved = engine.solve(&made.problem, Some(&made.pinned), settings, &mut |_| {}).unwrap().restart.unwrap();
    for share in [0.0, 0.01, 0.1] {
        let mut problem = made.problem.clone();
        let mut random = problems::Random(99);
        problem.objective.linear.iter_mut().for_each(|q| *q *= 1.0 + share * random.normal());
        let cold = engine.solve(&problem, None, settings, &mut |_| {}).unwrap();
        let next = engine.solve_warm(&problem, (&saved.x, &saved.dual), settings, &mut |_| {}).unwrap();
        println!(
            "data changed by {share}: {} iterations cold, {} warm ({:?}), energies differ by {:.1e}",
            cold.iterations,
            next.iterations,
            next.status,
            (next.objective - cold.objective) / cold.objective
        );
    }
}

/// Largest resident memory so far, MiB.
fn peak() -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find(|line| line.starts_with("VmHWM")).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|kib| kib.parse::<f64>().ok()).unwrap_or(0.0) / 1024.0
}

fn is_asked(word: &str) -> bool {
    std::env::args().any(|argument| argument == word)
}

/// Pools live to the end: a thread that ends takes its processor seconds out of the sum.
fn pool(threads: usize) -> &'static rayon::ThreadPool {
    static POOLS: [OnceLock<rayon::ThreadPool>; 2] = [OnceLock::new(), OnceLock::new()];
    POOLS[threads - 1].get_or_init(|| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap())
}

/// The solution, processor seconds and wall seconds of the whole solve on some threads.
fn timed(engine: &mut Engine, made: &problems::Instance, threads: usize) -> (Solution, f64, f64) {
    let verbose = std::env::var("VERBOSE").is_ok();
    let start = if is_asked("inside") { &made.start } else { &made.pinned };
    pool(threads).install(|| {
        engine.minimise(&made.problem.objective, &made.problem.fixed).unwrap();
        let (clock, wall) = (processor_seconds(), Instant::now());
        let mut report = |p: Progress| {
            if verbose {
                println!("{:3} gap {:.1e} stationarity {:.1e} primal {:.1e} step {:.3}", p.iteration, p.gap, p.stationarity, p.primal, p.step);
            }
        };
        let solution = engine.solve(&made.problem, Some(start), &Settings::default(), &mut report).unwrap();
        (solution, processor_seconds() - clock, wall.elapsed().as_secs_f64())
    })
}

/// Four problems, each with places, noise and bumps of its own on the same pattern, one after the other and side by side.
fn four(engine: &Engine, side: usize, order: usize, case: Case) {
    let all: Vec<_> = (7..11).map(|seed| instance(side, order, case, seed)).collect();
    let wall = |threads: usize| {
        pool(threads).install(|| {
            let clock = Instant::now();
            let ended: Vec<_> = all
                .par_iter()
                .map(|made| engine.fork().solve(&made.problem, Some(&made.pinned), &Settings::default(), &mut |_| {}).unwrap().status)
                .collect();
            assert!(ended.iter().all(|status| *status == QpStatus::Solved));
            clock.elapsed().as_secs_f64()
        })
    };
    let (one, two) = (wall(1), wall(2));
    println!("four problems: wall s {one:.2} on one thread, {two:.2} on two: {:.2} times faster", one / two);
}

fn run(side: usize, order: usize, case: Case, with_peer: bool) {
    let made = instance(side, order, case, 7);
    let n = side * side;
    let clock = processor_seconds();
    let mut engine = Engine::new(&made.problem.objective, None, Some(&made.coordinates)).unwrap();
    let analysis = processor_seconds() - clock;
    if is_asked("two") {
        let (solution, seconds, wall) = timed(&mut engine, &made, 2);
        let (kkt, peak) = (&solution.kkt, peak());
        println!(
            "| {n} | {order} | {case:?} | {:?}, {} factorizations, wall {wall:.1} s on two threads, {seconds:.1} processor s, gap {:.1e}, stationarity {:.1e}, energy {:.12e}, peak {peak:.0} MiB |",
            solution.status, solution.factorizations, kkt.duality_gap, kkt.stationarity, solution.objective
        );
        return;
    }
    let floor = pool(1).install(|| {
        let mut one = || engine.factor_and_solve(&made.problem.objective, &made.problem.fixed).unwrap();
        // The first factorisation pays for touching fresh memory.
        one();
        let repeats = 1 + 200_000 / n;
        let clock = processor_seconds();
        (0..repeats).for_each(|_| drop(one()));
        (processor_seconds() - clock) / repeats as f64
    });
    let mut best = timed(&mut engine, &made, 1);
    for _ in 0..if side < 200 { 2 } else { 0 } {
        let next = timed(&mut engine, &made, 1);
        best = (next.0, best.1.min(next.1), best.2.min(next.2));
    }
    let (solution, seconds, wall) = best;
    let (second, _, wall_of_two) = timed(&mut engine, &made, 2);
    let same = solution.x.iter().zip(&second.x).all(|(a, b)| a.to_bits() == b.to_bits());
    let peak = peak();
    if is_asked("warm") {
        warm(&mut engine, &made, &Settings::default());
    }
    if is_asked("excess") {
        excess(&mut engine, &made, &solution);
    }
    if is_asked("four") {
        four(&engine, side, order, case);
    }
    let peer = if with_peer {
        let (iterations, seconds, energy) = peer::clarabel(&made.problem);
        format!("{iterations}, {seconds:.2}, {:.1e}", (energy - solution.objective) / solution.objective)
    } else {
        String::new()
    };
    println!(
        "| {n} | {order} | {case:?} | {} | {:.2e} | {analysis:.3} | {floor:.4} | {} {} | {} | {} | {:.3} | {:.1} | {:.1} | {wall:.3}, {wall_of_two:.3}, {:.2} | {same} | {:.1e} | {:.1e} ({:.1e}) | {:.1e} | {:.12e} | {peak:.0} | {peer} |",
        made.problem.constraints.offset.len(),
        engine.factor_entries() as f64,
        solution.iterations,
        if solution.status == QpStatus::Solved { "" } else { "(not solved)" },
        solution.factorizations,
        solution.solves,
        seconds,
        seconds / floor,
        seconds / floor + 1.0,
        wall / wall_of_two,
        solution.kkt.duality_gap,
        solution.kkt.stationarity,
        solution.kkt.rounding,
        solution.kkt.primal,
        solution.objective,
    );
}
