//! Time and memory of vertex order, discrete gradient and extremum pairs on noise, with one and two threads.
//!
//! ```text
//! cargo run --release --example morse [-- FILTER]
//! ```
//!
//! Seconds by the clock and of the processors, best of three; peak of memory beyond what was there before, a vertex.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::time::Instant;

use morsmooth::field::VertexOrder;
use morsmooth::mesh::{Domain, Grid, ImplicitGrid, Mask, Triangulation};
use morsmooth::morse::{ExtremumKind, discrete_gradient, extremum_pairs};

/// Makes the allocator return large blocks at once.
const FRESH: &str = "MALLOC_MMAP_THRESHOLD_";

fn main() {
    if std::env::var_os(FRESH).is_none() {
        // The allocator would keep freed memory, and peaks would not be seen.
        let program = std::env::current_exe().unwrap();
        let again = std::process::Command::new(program).args(std::env::args().skip(1)).env(FRESH, "65536").status();
        return assert!(again.unwrap().success());
    }
    let filter = std::env::args().nth(1).unwrap_or_default();
    let grid = |dims: [usize; 3]| Grid::image(dims, [0.0; 3], [1.0; 3]);
    if "mesh".contains(&filter) {
        let mesh = Domain::from_grid(&grid([512, 512, 1]), &Mask::none()).unwrap().complex;
        stages("mesh 512 x 512", &mesh);
    }
    if "mesh3".contains(&filter) {
        let mesh = Domain::from_grid(&grid([64, 64, 64]), &Mask::none()).unwrap().complex;
        stages("tetrahedral mesh 64^3", &mesh);
    }
    for (name, dims) in [("grid 1000 x 1000", [1000, 1000, 1]), ("grid 128^3", [128; 3]), ("grid 256^3", [256; 3])] {
        if name.contains(&filter) && (dims[2] < 200 || !filter.is_empty()) {
            stages(name, &ImplicitGrid::new(grid(dims)).unwrap());
        }
    }
}

fn stages<T: Triangulation>(name: &str, complex: &T) {
    let values = noise(complex.vertex_count());
    let order = VertexOrder::of_values(&values).unwrap();
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let measure = |what: &str, work: &(dyn Fn() + Sync)| {
            pool.install(|| measure(&format!("{name}, {threads} threads, {what}"), values.len(), work));
        };
        measure("order", &|| drop(VertexOrder::of_values(&values).unwrap()));
        measure("gradient", &|| drop(discrete_gradient(complex, &order).unwrap()));
        measure("minima", &|| drop(extremum_pairs(complex, &order, ExtremumKind::Minimum)));
        measure("from values to pairs of both kinds", &|| {
            let order = VertexOrder::of_values(&values).unwrap();
            drop([ExtremumKind::Minimum, ExtremumKind::Maximum].map(|kind| extremum_pairs(complex, &order, kind)));
        });
    }
    let pairs = extremum_pairs(complex, &order, ExtremumKind::Minimum);
    println!("{name}: {} minima", pairs.len());
}

fn measure(label: &str, vertices: usize, work: &(dyn Fn() + Sync)) {
    let (mut wall, mut processor) = (f64::INFINITY, f64::INFINITY);
    let before = memory("VmRSS:");
    // Sets the peak to what is there now.
    std::fs::write("/proc/self/clear_refs", "5").unwrap();
    for _ in 0..3 {
        let (start, spent) = (Instant::now(), processor_seconds());
        work();
        wall = wall.min(start.elapsed().as_secs_f64());
        processor = processor.min(processor_seconds() - spent);
    }
    let bytes = (memory("VmHWM:") - before) * 1024.0 / vertices as f64;
    println!("{label}: {wall:.3} s, processors {processor:.3} s, {bytes:.0} bytes a vertex");
}

fn noise(count: usize) -> Vec<f64> {
    let mut state = 7u64;
    let mut next = || {
        // xorshift64*
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..count).map(|_| next()).collect()
}

/// Of all threads, those that have ended included; in steps of 10 ms.
fn processor_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let after_name = stat.rsplit(')').next().unwrap();
    after_name.split_whitespace().skip(11).take(2).map(|ticks| ticks.parse::<f64>().unwrap() / 100.0).sum()
}

fn memory(line: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let found = status.lines().find(|candidate| candidate.starts_with(line)).unwrap();
    found.split_whitespace().nth(1).unwrap().parse().unwrap()
}
