//! Twelve problems of this program, small to large, in an open format, with our own solutions.
//!
//! ```text
//! cargo run --release --example test_set -- FOLDER [only=NAME,NAME] [solve=yes|no] [large=yes|no]
//! cargo run --release --example test_set -- run NAME OUT.json [repeats=3] [method=interior|penalty|published]
//! ```
//!
//! The first form writes `FOLDER/NAME/{P,L,A}.mtx`, `problem.json` and, for matrix cones, `problem.cbf`; README.md beside this file
//! documents them. `large=yes` adds problems of 250,000 and 1,000,000 unknowns, without P.mtx. The second form makes the problem
//! anew, solves it and writes the solution alone, with the times of this run: best of `repeats`. Method `penalty` is penalty
//! continuation to the same accuracy, `published` runs it to the end of its schedule.
#![allow(clippy::print_stderr, clippy::expect_used, clippy::unwrap_used)]

#[path = "../bench/clock.rs"]
mod clock;
mod cbf;
mod export;
mod fields;
mod names;
#[path = "../bench/problems.rs"]
#[allow(dead_code)]
mod problems;
#[path = "../bench/scenes.rs"]
#[allow(dead_code)]
mod scenes;

use clock::processor_seconds;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

use morsmooth::deform::DeformOptions;
use morsmooth::qp::{Engine, PenaltyOptions, Settings, Until};
use serde_json::{Value, json};

use export::Formed;
use fields::Made;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).filter(|word| !word.contains('=')).collect();
    let option = |name: &str| arguments.iter().find_map(|word| word.strip_prefix(name)?.strip_prefix('='));
    match words.as_slice() {
        ["run", name, out] => {
            let (made, _) = names::make(name)?;
            let solved = solve(&made, option("repeats").unwrap_or("3").parse()?, option("method").unwrap_or("interior"))?;
            std::fs::write(out, serde_json::to_string(&solved)?)?;
            Ok(())
        }
        [folder] => {
            let mut chosen: Vec<&str> = match option("only") {
                Some(list) => list.split(',').collect(),
                None => names::TWELVE.to_vec(),
            };
            if option("large") == Some("yes") {
                chosen.extend(names::LARGE);
            }
            chosen.iter().try_for_each(|name| write(&Path::new(folder).join(name), name, option("solve") != Some("no")))
        }
        _ => Err("usage: test_set FOLDER [only=NAME,NAME] [solve=yes|no] [large=yes|no], or test_set run NAME OUT.json".into()),
    }
}

fn write(folder: &Path, name: &str, is_solved: bool) -> Result<(), Box<dyn Error>> {
    let (made, scene) = names::make(name).map_err(|error| format!("{name}: {error}"))?;
    std::fs::create_dir_all(folder)?;
    let solution = if is_solved { solve(&made, 1, "interior")? } else { Value::Null };
    let formed = if names::LARGE.contains(&name) { Formed::No } else { Formed::Yes };
    let more = [
        ("name", json!(name)),
        ("coordinates", json!(made.coordinates)),
        ("start", json!(made.start)),
        ("solution", solution.clone()),
    ];
    export::write(folder, &made.problem, formed, &more)?;
    if let Some(scene) = scene {
        cbf::write(&folder.join("problem.cbf"), &scene, DeformOptions::default(), &made.problem)?;
    }
    eprintln!(
        "{name}: {} unknowns, {} fixed, {} rows; {}, {} iterations, {} s, floor {} s",
        made.problem.fixed.len(),
        made.problem.fixed.iter().flatten().count(),
        made.problem.constraints.offset.len(),
        solution["status"],
        solution["iterations"],
        solution["seconds"],
        solution["floor"],
    );
    Ok(())
}

/// Solves a problem and adds the times: seconds of the whole solve without and with the analysis, and of the floor, one
/// factorisation with one solve; each as the clock has it and as the processors do.
fn solve(made: &Made, repeats: usize, method: &str) -> Result<Value, Box<dyn Error>> {
    let rows = made.problem.constraints.coupling();
    let clock = Clock::start();
    let mut engine = Engine::new(&made.problem.objective, Some(&rows), Some(&made.coordinates))?;
    let analysis = clock.seconds();
    let (floor, _) = best(3, || engine.factor_and_solve(&made.problem.objective, &made.problem.fixed))?;
    let settings = Settings::default();
    let (seconds, solution) = best(repeats, || match method {
        "penalty" => engine.solve_penalty(&made.problem, None, &settings, &PenaltyOptions::default(), &mut |_| {}),
        "published" => {
            let options = PenaltyOptions { until: Until::Limit, ..PenaltyOptions::default() };
            engine.solve_penalty(&made.problem, None, &settings, &options, &mut |_| {})
        }
        _ => engine.solve(&made.problem, made.start.as_deref(), &settings, &mut |_| {}),
    })?;
    let mut value = export::solution(&solution);
    for (name, [wall, processor]) in [("analysis", analysis), ("floor", floor), ("seconds", seconds)] {
        value[name] = json!(wall);
        value[format!("{name}_processor")] = json!(processor);
    }
    value["factor_entries"] = json!(engine.factor_entries());
    Ok(value)
}

/// Seconds of the best of several runs, and the last result. Short work is run many times in each, since the kernel counts
/// a processor's time by ticks of some milliseconds.
fn best<T, E>(runs: usize, mut work: impl FnMut() -> Result<T, E>) -> Result<([f64; 2], T), E> {
    let clock = Instant::now();
    let mut result = work()?;
    let turns = if runs > 1 { (0.1 / clock.elapsed().as_secs_f64().max(1e-6)).ceil().min(100.0) as usize } else { 1 };
    let mut least = [f64::INFINITY; 2];
    for _ in 0..runs.max(1) {
        let clock = Clock::start();
        for _ in 0..turns {
            result = work()?;
        }
        let seconds = clock.seconds();
        least = std::array::from_fn(|kind| least[kind].min(seconds[kind] / turns as f64));
    }
    Ok((least, result))
}

/// Seconds on the wall, and those that all threads of this program spend on a processor, which a busy machine does not stretch.
struct Clock(Instant, f64);

impl Clock {
    fn start() -> Self {
        Self(Instant::now(), processor_seconds())
    }

    fn seconds(&self) -> [f64; 2] {
        [self.0.elapsed().as_secs_f64(), processor_seconds() - self.1]
    }
}
