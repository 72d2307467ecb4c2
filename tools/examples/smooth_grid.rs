//! Smooth a noisy field on a grid and look at the evidence.
//!
//! ```text
//! cargo run --release --example smooth_grid
//! ```
#![allow(clippy::print_stdout)]

use morsmooth::audit::extrema;
use morsmooth::mesh::{Domain, Grid, Mask};
use morsmooth::morse::{Selection, Threshold};
use morsmooth::smooth::{SelectOn, SmoothOptions, smooth};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let grid = Grid::image([80, 60, 1], [0.0; 3], [0.05, 0.05, 1.0]);
    let domain = Domain::from_grid(&grid, &Mask::none())?;
    // Two waves and noise that looks random.
    let data: Vec<f64> = domain
        .complex
        .points()
        .iter()
        .enumerate()
        .map(|(i, [x, y, _])| (1.8 * x).sin() * (1.3 * y).cos() + 0.2 * ((i as f64 * 12.9898).sin() * 43_758.547 % 1.0))
        .collect();
    let options = SmoothOptions {
        select_on: SelectOn::Smooth,
        ..SmoothOptions::new(Selection::Threshold(Threshold::Fraction(0.1)))
    };
    let result = smooth(&domain.complex, &data, &options, &mut |_| {})?;
    println!("before: {}", result.report.before);
    println!("wanted: {}", result.report.wanted);
    println!("energy above the bound of the ideal problem: {:.3} %", 100.0 * result.report.energy.above_bound);
    let found = extrema(&domain.complex, &result.values)?;
    println!("found:  {} minima, {} maxima", found.minima.len(), found.maxima.len());
    assert_eq!((found.minima, found.maxima), (result.wanted.minima, result.wanted.maxima));
    Ok(())
}
