//! The two forms of the linear systems on the same problems: formed products, and auxiliary unknowns.
//!
//! ```text
//! RAYON_NUM_THREADS=1 cargo run --release --example forms -- [sides 71,123] [orders 2,3,4] [cases data,nodata]
//! ```
#![allow(clippy::print_stdout, clippy::unwrap_used, dead_code)]

#[path = "clock.rs"]
mod clock;
#[path = "problems.rs"]
mod problems;

use clock::processor_seconds;
use morsmooth::qp::{Engine, KktForm, Settings};
use problems::{Case, instance};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let list = |index: usize, default: &str| -> Vec<String> {
        arguments.get(index).map_or(default, |text| text).split(',').map(str::to_owned).collect()
    };
    println!("| n | k | case | form (automatic is mixed) | nnz(L) | analysis s | factor + solve s | pinned: stationarity, solves | status | iterations | s | gap | stationarity | primal | energy |");
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for side in list(0, "71,123") {
        for order in list(1, "2,3,4") {
            for case in list(2, "data,nodata") {
                let case = if case == "nodata" { Case::NoData } else { Case::Data };
                for form in [KktForm::Formed, KktForm::Mixed] {
                    run(side.parse().unwrap(), order.parse().unwrap(), case, form);
                }
            }
        }
    }
}

fn run(side: usize, order: usize, case: Case, form: KktForm) {
    let made = instance(side, order, case, 7);
    let objective = &made.problem.objective;
    let automatic = Engine::new(objective, None, Some(&made.coordinates)).unwrap().is_mixed();
    let clock = processor_seconds();
    let mut engine = Engine::in_form(objective, None, Some(&made.coordinates), form).unwrap();
    let analysis = processor_seconds() - clock;
    let mut floor = f64::INFINITY;
    for _ in 0..3 {
        let clock = processor_seconds();
        if let Err(error) = engine.factor_and_solve(objective, &made.problem.fixed) {
            println!("| {} | {order} | {case:?} | {form:?} ({automatic}) | {error} |", side * side);
            return;
        }
        floor = floor.min(processor_seconds() - clock);
    }
    let pinned = engine.minimise(objective, &made.problem.fixed).unwrap();
    let clock = processor_seconds();
    let is_verbose = std::env::var("VERBOSE").is_ok();
    let solved = engine.solve(&made.problem, Some(&made.start), &Settings::default(), &mut |p| {
        if is_verbose {
            println!("{:3} gap {:.1e} stationarity {:.1e} primal {:.1e} step {:.3}", p.iteration, p.gap, p.stationarity, p.primal, p.step);
        }
    });
    let seconds = processor_seconds() - clock;
    let head = format!(
        "| {} | {order} | {case:?} | {form:?} ({automatic}) | {:.2e} | {analysis:.2} | {floor:.3} | {:.1e}, {} |",
        side * side,
        engine.factor_entries() as f64,
        pinned.stationarity,
        pinned.solves
    );
    match solved {
        Ok(solution) => println!(
            "{head} {:?} | {} | {seconds:.2} | {:.1e} | {:.1e} | {:.1e} | {:.12e} |",
            solution.status,
            solution.iterations,
            solution.kkt.duality_gap,
            solution.kkt.stationarity,
            solution.kkt.primal,
            solution.objective
        ),
        Err(error) => println!("{head} {error} |"),
    }
}
