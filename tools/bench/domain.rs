//! Time to build domains, operators and extremum pairs on grids, best of five.
//!
//! ```text
//! cargo run --release --example domain
//! ```
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::time::Instant;

use morsmooth::field::VertexOrder;
use morsmooth::mesh::{CellList, CellShape, Domain, Grid, Mask};
use morsmooth::morse::{ExtremumKind, extremum_pairs};
use morsmooth::operators::{Derived, cotangent_laplacian, derive, lumped_mass, positive_laplacian};

fn best_of<T>(label: &str, dims: [usize; 3], mut work: impl FnMut() -> T) {
    let seconds = || {
        let start = Instant::now();
        std::hint::black_box(work());
        start.elapsed().as_secs_f64()
    };
    let best = std::iter::repeat_with(seconds).take(5).fold(f64::INFINITY, f64::min);
    println!("{dims:?} {label}: {:.1} ms", best * 1e3);
}

fn main() {
    for dims in [[403, 344, 1], [1000, 1000, 1], [100, 100, 100]] {
        let grid = Grid::image(dims, [0.0; 3], [1.0; 3]);
        best_of("grid", dims, || Domain::from_grid(&grid, &Mask::none()).unwrap());
        let some = (0..grid.point_count()).map(|point| point % 97 != 5).collect();
        let mask = Mask { keep_points: Some(some), keep_cells: None };
        best_of("grid, masked", dims, || Domain::from_grid(&grid, &mask).unwrap());
        let complex = Domain::from_grid(&grid, &Mask::none()).unwrap().complex;
        let shape = if complex.dimension() == 2 { CellShape::Triangle } else { CellShape::Tetrahedron };
        let cells = CellList::uniform(shape, complex.dimension() + 1, complex.simplices());
        best_of("its simplices as cells", dims, || Domain::from_cells(complex.points(), &cells, &Mask::none()).unwrap());
        best_of("cotangent Laplacian", dims, || cotangent_laplacian(&complex).unwrap());
        best_of("positive Laplacian", dims, || positive_laplacian(&complex).unwrap());
        best_of("lumped mass", dims, || lumped_mass(&complex).unwrap());
        best_of("vorticity", dims, || derive(&complex, complex.points(), Derived::Vorticity).unwrap());
        // Rough numbers without a pattern: as many extrema as noise has.
        let noise: Vec<f64> = (0..complex.vertex_count()).map(|i| (i as f64 * 12.9898).sin() * 43_758.547 % 1.0).collect();
        let order = VertexOrder::of_values(&noise).unwrap();
        best_of("extremum pairs, both kinds", dims, || {
            [ExtremumKind::Minimum, ExtremumKind::Maximum].map(|kind| extremum_pairs(&complex, &order, kind).len())
        });
    }
}
