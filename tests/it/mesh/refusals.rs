//! Every way to refuse points and cells, with its message.

use morsmooth::mesh::{CellList, CellShape, Domain, DomainError, Grid, GridGeometry, Mask, MeshError};

const POINTS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn refuse(cells: &CellList, mask: &Mask) -> DomainError {
    Domain::from_cells(&POINTS, cells, mask).unwrap_err()
}

fn list(offsets: &[u32], connectivity: &[u32]) -> CellList {
    let shapes = vec![CellShape::Triangle; offsets.len().saturating_sub(1)];
    CellList { shapes, offsets: offsets.to_vec(), connectivity: connectivity.to_vec() }
}

#[test]
fn nothing_left() {
    let none = Mask::none();
    let error = Domain::from_cells(&[], &CellList::new(), &none).unwrap_err();
    assert_eq!(error, DomainError::Empty { points: 0, cells: 0, masked_points: 0, masked_cells: 0 });
    let vertices = CellList::uniform(CellShape::Vertex, 1, &[0, 1, 2]);
    assert!(matches!(refuse(&vertices, &none), DomainError::Empty { points: 4, cells: 3, .. }));
    let triangle = CellList::uniform(CellShape::Triangle, 3, &[0, 1, 2]);
    let masked = Mask { keep_points: Some(vec![false, true, false, true]), keep_cells: None };
    assert_eq!(
        refuse(&triangle, &masked).to_string(),
        "the domain is empty: 4 points, 1 cells, of which the mask removes 2 points and 0 cells, and no line, triangle or tetrahedron is left"
    );
    let masked = Mask { keep_points: None, keep_cells: Some(vec![false]) };
    assert!(matches!(refuse(&triangle, &masked), DomainError::Empty { masked_cells: 1, .. }));
    for dims in [[1, 1, 1], [0, 0, 0], [5, 0, 1]] {
        let error = Domain::from_grid(&Grid::image(dims, [0.0; 3], [1.0; 3]), &none).unwrap_err();
        assert!(matches!(error, DomainError::Empty { .. }), "{dims:?}: {error}");
    }
    let masked = Mask { keep_points: Some(vec![false; 9]), keep_cells: None };
    let error = Domain::from_grid(&Grid::image([3, 3, 1], [0.0; 3], [1.0; 3]), &masked).unwrap_err();
    assert_eq!(error, DomainError::Empty { points: 9, cells: 4, masked_points: 9, masked_cells: 0 });
}

#[test]
fn masks_of_the_wrong_length() {
    let triangle = CellList::uniform(CellShape::Triangle, 3, &[0, 1, 2]);
    let mask = Mask { keep_points: Some(vec![true; 3]), keep_cells: None };
    assert_eq!(refuse(&triangle, &mask).to_string(), "the mask has 3 flags for 4 points");
    let mask = Mask { keep_points: None, keep_cells: Some(vec![true; 2]) };
    assert_eq!(refuse(&triangle, &mask), DomainError::MaskLength { what: "cells", expected: 1, found: 2 });
}

#[test]
fn offsets_that_contradict_themselves() {
    let none = Mask::none();
    let message = |offsets: &[u32], connectivity: &[u32]| refuse(&list(offsets, connectivity), &none).to_string();
    assert_eq!(message(&[1, 4], &[0, 0, 1, 2]), "cell offsets are inconsistent at cell 0: first offset 1; expected 0");
    assert_eq!(message(&[0, 3, 1], &[0]), "cell offsets are inconsistent at cell 1: end 1; expected at least its begin 3");
    assert_eq!(message(&[0, 3, 6], &[0, 1, 2]), "cell offsets are inconsistent at cell 1: end 6; expected the 3 corners there are");
    assert_eq!(message(&[0], &[0, 1]), "cell offsets are inconsistent at cell 0: end 0; expected the 2 corners there are");
    let short = CellList { shapes: vec![CellShape::Line; 2], offsets: vec![0, 2], connectivity: vec![0, 1] };
    assert!(refuse(&short, &none).to_string().contains("2 offsets; expected 3 for 2 cells"));
    let without = CellList { shapes: vec![], offsets: vec![], connectivity: vec![] };
    assert!(matches!(refuse(&without, &none), DomainError::Offsets { .. }));
}

#[test]
fn cells_that_cannot_be() {
    let none = Mask::none();
    let mut cells = CellList::uniform(CellShape::Triangle, 3, &[0, 1, 2, 1, 7, 2]);
    assert_eq!(refuse(&cells, &none), DomainError::PointOutOfRange { cell: 1, point: 7, points: 4 });
    cells = CellList::uniform(CellShape::Hexahedron, 4, &[0, 1, 2, 3]);
    assert_eq!(refuse(&cells, &none).to_string(), "cell 0 (Hexahedron) has 4 corners; expected 8");
    cells = CellList::uniform(CellShape::Triangle, 3, &[0, 1, 2]);
    cells.push(CellShape::Other(42), &[0, 1, 2, 3]);
    assert_eq!(refuse(&cells, &none), DomainError::UnsupportedCell { cell: 1, vtk_type: 42 });
    // Masked, it does not disturb; and an empty cell (type 0) never does.
    let mask = Mask { keep_points: None, keep_cells: Some(vec![true, false]) };
    assert!(Domain::from_cells(&POINTS, &cells, &mask).is_ok());
    cells.shapes[1] = CellShape::Other(0);
    assert!(Domain::from_cells(&POINTS, &cells, &none).is_ok());
}

#[test]
fn points_that_are_nowhere() {
    let mut points = POINTS;
    points[2][1] = f64::INFINITY;
    let cells = CellList::uniform(CellShape::Triangle, 3, &[0, 1, 3, 0, 1, 2]);
    let error = Domain::from_cells(&points, &cells, &Mask::none()).unwrap_err();
    assert_eq!(error.to_string(), "point 2 lies at [0.0, inf, 0.0]; expected finite coordinates: mask the point or repair it");
    let error = Domain::from_grid(&Grid::image([3, 3, 1], [0.0; 3], [1.0, f64::NAN, 1.0]), &Mask::none()).unwrap_err();
    assert!(matches!(error, DomainError::NonFinitePoint { point: 0, .. }));
    // Overflow of the origin plus the extent.
    let far = Grid::image([3, 1, 1], [0.0; 3], [1e308, 1.0, 1.0]);
    assert!(matches!(Domain::from_grid(&far, &Mask::none()), Err(DomainError::NonFinitePoint { point: 2, .. })));
}

#[test]
fn grids_that_do_not_fit() {
    let refuse = |dims, geometry| Domain::from_grid(&Grid { dims, geometry }, &Mask::none()).unwrap_err();
    let image = |extent| GridGeometry::Image { origin: [0.0; 3], spacing: [1.0; 3], direction: GridGeometry::IDENTITY, extent };
    assert_eq!(refuse([3, 3, 1], image([0, 2, 0, 3, 0, 0])), DomainError::GridShape { axis: 1, expected: 3, found: 4 });
    assert!(matches!(refuse([3, 3, 1], image([i64::MIN, i64::MAX, 0, 2, 0, 0])), DomainError::GridShape { axis: 0, .. }));
    let axes = GridGeometry::Rectilinear { x: vec![0.0, 1.0], y: vec![0.0], z: vec![] };
    assert_eq!(refuse([2, 1, 1], axes), DomainError::GridShape { axis: 2, expected: 1, found: 0 });
    let curvilinear = GridGeometry::Curvilinear { points: POINTS.to_vec() };
    assert_eq!(
        refuse([2, 3, 1], curvilinear).to_string(),
        "the geometry of the grid has 4 points along axis 3 (3: in all); expected 6"
    );
    let huge = image([0, 99_999, 0, 99_999, 0, 99_999]);
    assert!(matches!(refuse([100_000; 3], huge.clone()), DomainError::Complex(MeshError::TooLarge { .. })));
    assert!(matches!(refuse([usize::MAX; 3], huge), DomainError::Complex(MeshError::TooLarge { .. })));
}
