//! The persistence diagram of noisy 3-D grids: seconds by stage, bytes a vertex, pairs by dimension.
//!
//! ```text
//! cargo run --release --example diagram -- [sides 64,128] [threads 1,2] [noise share 0.3]
//! ```
//! The field is the sum of forty Gaussian bumps and white noise of the given share of the range; the same in every run.
//! Seconds are those on the clock and, in brackets, those that all threads together spent on a processor. Bytes are the
//! rise of the resident set during gradient and diagram, at its highest.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

#[path = "clock.rs"]
mod clock;

use clock::processor_seconds;
use std::time::Instant;

use morsmooth::field::VertexOrder;
use morsmooth::mesh::{Grid, ImplicitGrid};
use morsmooth::morse::{diagram_of_gradient_by_stage, discrete_gradient};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let list = |index: usize, default: &str| -> Vec<f64> {
        arguments.get(index).map_or(default, |text| text).split(',').map(|word| word.parse().unwrap()).collect()
    };
    for side in list(0, "64,128") {
        for threads in list(1, "1,2") {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build().unwrap();
            pool.install(|| run(side as usize, list(2, "0.3")[0]));
        }
    }
}

fn run(side: usize, noise: f64) {
    let grid = Grid::image([side; 3], [0.0; 3], [1.0; 3]);
    let mesh = &ImplicitGrid::new(grid).unwrap();
    let values = bumps(side, noise);
    let order = VertexOrder::of_values(&values).unwrap();
    std::fs::write("/proc/self/clear_refs", "5").unwrap();
    let before = resident("VmRSS:");
    println!("{side}^3, {} threads", rayon::current_num_threads());
    let mut clock = Clock::start();
    let gradient = discrete_gradient(mesh, &order).unwrap();
    clock.stage("gradient");
    let diagram = diagram_of_gradient_by_stage(mesh, &order, &gradient, &mut |stage| clock.stage(&format!("{stage:?}")));
    clock.total();
    diagram.check_euler().unwrap();
    let bytes = (resident("VmHWM:") - before) / values.len() as f64;
    println!(
        "  {bytes:.0} bytes a vertex; critical cells {:?}, pairs {:?}, Betti numbers {:?}",
        diagram.critical_counts(),
        diagram.finite_counts(),
        diagram.betti_numbers()
    );
}

/// Bytes in memory, now or at most.
fn resident(field: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with(field)).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap() * 1024.0
}

/// Time on the clock and on processors.
struct Clock {
    start: (Instant, f64),
    last: (Instant, f64),
}

impl Clock {
    fn start() -> Self {
        let now = (Instant::now(), processor_seconds());
        Self { start: now, last: now }
    }

    fn stage(&mut self, name: &str) {
        let now = (Instant::now(), processor_seconds());
        println!("  {name:<16} {:7.3} s ({:7.3})", (now.0 - self.last.0).as_secs_f64(), now.1 - self.last.1);
        self.last = now;
    }

    fn total(&mut self) {
        self.last = self.start;
        self.stage("all");
    }
}

fn bumps(side: usize, noise: f64) -> Vec<f64> {
    let mut state = 7u64;
    let mut random = || {
        // splitmix64
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut values = vec![0.0; side * side * side];
    for bump in 0..40 {
        let (centre, width) = ([random(), random(), random()], 0.05 + 0.1 * random());
        // A Gaussian of three variables is a product of three of one.
        let axes = centre.map(|centre| -> Vec<f64> {
            let at = |index: usize| (index as f64 / side as f64 - centre) / width;
            (0..side).map(|index| (-at(index).powi(2)).exp()).collect()
        });
        let sign = if bump % 2 == 0 { 1.0 } else { -1.0 };
        for (vertex, value) in values.iter_mut().enumerate() {
            let place = [vertex % side, vertex / side % side, vertex / side / side];
            *value += sign * axes[0][place[0]] * axes[1][place[1]] * axes[2][place[2]];
        }
    }
    values.iter_mut().for_each(|value| *value += 2.0 * noise * random());
    values
}
