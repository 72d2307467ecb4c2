//! Grids: geometry, subdivision, numbering.

use super::shapes::{grid, with_threads};
use morsmooth::mesh::{Domain, Grid, GridGeometry, Mask, SimplicialComplex, Severity, faults};

fn total(complex: &SimplicialComplex) -> f64 {
    (0..complex.simplex_count()).map(|simplex| complex.measure(simplex)).sum()
}

#[test]
fn any_axes_may_be_flat() {
    for (dims, simplices) in [
        ([5, 1, 1], 4),
        ([1, 5, 1], 4),
        ([1, 1, 5], 4),
        ([4, 3, 1], 12),
        ([4, 1, 3], 12),
        ([1, 4, 3], 12),
        ([4, 3, 2], 36),
    ] {
        let complex = grid(dims);
        assert_eq!(complex.dimension(), dims.iter().filter(|&&count| count > 1).count());
        assert_eq!(complex.simplex_count(), simplices, "{dims:?}");
        let expected: f64 = dims.iter().map(|&count| (count - 1).max(1) as f64).product();
        assert!((total(&complex) - expected).abs() < 1e-12 * expected, "{dims:?}");
    }
}

#[test]
fn squares_are_cut_along_the_rising_diagonal() {
    let complex = grid([2, 2, 1]);
    assert_eq!(complex.simplices(), [0, 1, 3, 0, 3, 2]);
    let complex = grid([2, 2, 2]);
    let holds_diagonal = |simplex: usize| [0, 7].iter().all(|end| complex.simplex(simplex).contains(end));
    assert!((0..6).all(holds_diagonal));
    // An interior vertex of a Freudenthal grid has 6 neighbours in the plane and 14 in space.
    assert_eq!(grid([3, 3, 1]).neighbours(4usize.into()).len(), 6);
    assert_eq!(grid([3, 3, 3]).neighbours(13usize.into()).len(), 14);
}

#[test]
fn grids_are_oriented_manifolds() {
    for dims in [[6, 1, 1], [4, 5, 1], [1, 5, 4], [4, 3, 5]] {
        let domain = Domain::from_grid(&Grid::image(dims, [1.0; 3], [0.5, 2.0, 3.0]), &Mask::none()).unwrap();
        assert_eq!(faults(&domain), [], "{dims:?}");
    }
}

#[test]
fn an_image_has_extent_and_direction() {
    let direction = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]; // a quarter turn about z
    let geometry = GridGeometry::Image { origin: [10.0, 20.0, 30.0], spacing: [2.0, 3.0, 4.0], direction, extent: [-1, 0, 5, 6, 7, 7] };
    let image = Grid { dims: [2, 2, 1], geometry };
    let domain = Domain::from_grid(&image, &Mask::none()).unwrap();
    let expected = [[-5.0, 18.0, 58.0], [-5.0, 20.0, 58.0], [-8.0, 18.0, 58.0], [-8.0, 20.0, 58.0]];
    assert_eq!(domain.complex.points(), expected);
    assert_eq!((0..4).map(|point| image.point(point)).collect::<Vec<_>>(), expected);
}

#[test]
fn three_geometries_agree() {
    let image = Grid::image([3, 4, 2], [1.0, 2.0, 3.0], [0.5, 0.25, 2.0]);
    let axis = |axis: usize, count: usize| (0..count).map(|i| [1.0, 2.0, 3.0][axis] + [0.5, 0.25, 2.0][axis] * i as f64).collect();
    let rectilinear = Grid { dims: [3, 4, 2], geometry: GridGeometry::Rectilinear { x: axis(0, 3), y: axis(1, 4), z: axis(2, 2) } };
    let points = (0..24).map(|point| image.point(point)).collect();
    let curvilinear = Grid { dims: [3, 4, 2], geometry: GridGeometry::Curvilinear { points } };
    let [a, b, c] = [image, rectilinear, curvilinear].map(|grid| Domain::from_grid(&grid, &Mask::none()).unwrap());
    assert_eq!(a.complex.points(), b.complex.points());
    assert_eq!(a.complex.points(), c.complex.points());
    assert_eq!(a.complex.simplices(), c.complex.simplices());
}

#[test]
fn cells_are_numbered_as_vtk_numbers_them() {
    let grid = Grid::image([3, 1, 3], [0.0; 3], [1.0; 3]);
    assert_eq!((grid.point_count(), grid.cell_count()), (9, 4));
    let domain = Domain::from_grid(&grid, &Mask { keep_points: None, keep_cells: Some(vec![false, true, false, false]) }).unwrap();
    assert_eq!(domain.cell_of_simplex(), [1, 1]);
    assert_eq!(domain.point_of_vertex(), [1, 2, 4, 5]); // the second square of the first row
}

#[test]
fn a_seam_is_found_and_kept() {
    // An O-grid: the last column lies on the first.
    let points = (0..10).map(|p| {
        let (angle, radius) = ((p % 5) as f64 * std::f64::consts::FRAC_PI_2, (1 + p / 5) as f64);
        if p % 5 == 4 { [radius, 0.0, 0.0] } else { [radius * angle.cos(), radius * angle.sin(), 0.0] }
    });
    let ring = Grid { dims: [5, 2, 1], geometry: GridGeometry::Curvilinear { points: points.collect() } };
    let found = faults(&Domain::from_grid(&ring, &Mask::none()).unwrap());
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].severity(), Severity::Handled);
    assert!(found[0].to_string().starts_with("2 points lie exactly on an earlier point, first point 4 on point 0; kept apart"));
}

#[test]
fn any_number_of_threads_gives_the_same_domain() {
    let grid = Grid::image([120, 110, 1], [0.0; 3], [1.0; 3]);
    let flags = (0..grid.point_count()).map(|point| point % 7 != 3).collect();
    let mask = Mask { keep_points: Some(flags), keep_cells: None };
    let [one, four] = with_threads(|| Domain::from_grid(&grid, &mask).unwrap());
    assert_eq!(one.complex.simplices(), four.complex.simplices());
    assert_eq!(one.complex.edges(), four.complex.edges());
    assert_eq!((one.point_of_vertex(), one.cell_of_simplex()), (four.point_of_vertex(), four.cell_of_simplex()));
}
