//! Time to build domains. `cargo test --release --test it -- --ignored --nocapture mesh::timing`

use morsmooth::mesh::{CellList, CellShape, Domain, Grid, Mask};
use std::time::Instant;

pub fn best_of<T>(label: &str, mut work: impl FnMut() -> T) -> f64 {
    let best = (0..5)
        .map(|_| {
            let start = Instant::now();
            std::hint::black_box(work());
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min);
    eprintln!("{label}: {:.1} ms", best * 1e3);
    best
}

#[test]
#[ignore = "a measurement, not a check"]
fn domains() {
    for dims in [[403, 344, 1], [1000, 1000, 1], [100, 100, 100]] {
        let grid = Grid::image(dims, [0.0; 3], [1.0; 3]);
        best_of(&format!("grid {dims:?}"), || Domain::from_grid(&grid, &Mask::none()).unwrap());
        let some = (0..grid.point_count()).map(|point| point % 97 != 5).collect();
        let mask = Mask { keep_points: Some(some), keep_cells: None };
        best_of(&format!("grid {dims:?}, masked"), || Domain::from_grid(&grid, &mask).unwrap());
        let domain = Domain::from_grid(&grid, &Mask::none()).unwrap();
        let shape = if domain.complex.dimension() == 2 { CellShape::Triangle } else { CellShape::Tetrahedron };
        let cells = CellList::uniform(shape, domain.complex.dimension() + 1, domain.complex.simplices());
        let points = domain.complex.points();
        best_of(&format!("its simplices {dims:?} as cells"), || Domain::from_cells(points, &cells, &Mask::none()).unwrap());
    }
}
