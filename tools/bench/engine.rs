//! The engine against one factorisation plus one solve, and against clarabel.
//!
//! ```text
//! RAYON_NUM_THREADS=1 cargo run --release --example engine -- [sides 71,123,241] [orders 2] [cases data,nodata,smooth] [clarabel]
//! ```
#![allow(clippy::print_stdout, clippy::unwrap_used)]

#[path = "peer.rs"]
mod peer;
#[path = "problems.rs"]
mod problems;

use std::time::Instant;

use morsmooth::qp::{Engine, Settings};
use problems::{Case, instance};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let list = |index: usize, default: &str| -> Vec<String> {
        arguments.get(index).map_or(default, |text| text).split(',').map(str::to_owned).collect()
    };
    let with_peer = arguments.iter().any(|argument| argument == "clarabel");
    println!("| n | k | case | rows | nnz(L) | analysis s | factor + solve s | iterations | factorizations | solves | s | x (factor + solve) | gap | stationarity (rounding) | primal | energy | clarabel: iterations, s, energy rel. |");
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
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

fn run(side: usize, order: usize, case: Case, with_peer: bool) {
    let made = instance(side, order, case, 7);
    let n = side * side;
    let clock = Instant::now();
    let mut engine = Engine::new(&made.problem.objective, None, Some(&made.coordinates)).unwrap();
    let analysis = clock.elapsed().as_secs_f64();
    // The second factorisation counts: the first one pays for touching fresh memory.
    let mut floor = f64::INFINITY;
    for _ in 0..3 {
        floor = floor.min(engine.factor_and_solve_seconds(&made.problem.objective, &made.problem.fixed).unwrap());
    }
    let settings = Settings::default();
    let verbose = std::env::var("VERBOSE").is_ok();
    let cold = std::env::var("COLD").is_ok();
    let mut solution = None;
    for _ in 0..if side < 200 { 3 } else { 1 } {
        let next = engine
            .solve(&made.problem, (!cold).then_some(&made.start[..]), &settings, &mut |p| {
                if verbose {
                    println!("{:3} gap {:.1e} stationarity {:.1e} primal {:.1e} step {:.3}", p.iteration, p.gap, p.stationarity, p.primal, p.step);
                }
            })
            .unwrap();
        if solution.as_ref().is_none_or(|best: &morsmooth::qp::Solution| next.timings.total < best.timings.total) {
            solution = Some(next);
        }
    }
    let solution = solution.unwrap();
    let peer = if with_peer {
        let (iterations, seconds, energy) = peer::clarabel(&made.problem);
        format!("{iterations}, {seconds:.2}, {:.1e}", (energy - solution.objective) / solution.objective)
    } else {
        String::new()
    };
    println!(
        "| {n} | {order} | {case:?} | {} | {:.2e} | {analysis:.3} | {floor:.4} | {} {:?} | {} | {} | {:.3} ({:.3} + {:.3}) | {:.1} | {:.1e} | {:.1e} ({:.1e}) | {:.1e} | {:.12e} | {peer} |",
        made.problem.constraints.offset.len(),
        engine.factor_entries() as f64,
        solution.iterations,
        std::mem::discriminant(&solution.status) == std::mem::discriminant(&morsmooth::qp::QpStatus::Solved),
        solution.factorizations,
        solution.solves,
        solution.timings.total,
        solution.timings.factor,
        solution.timings.solve,
        solution.timings.total / floor,
        solution.kkt.duality_gap,
        solution.kkt.stationarity,
        solution.kkt.rounding,
        solution.kkt.primal,
        solution.objective,
    );
}
