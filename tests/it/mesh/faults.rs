//! Every fault has a test with its place and message.

use super::shapes::{grid, sphere, torus};
use morsmooth::mesh::{CellList, CellShape, Domain, Mask, MeshFault, Severity, SimplicialComplex, check, faults};

fn domain(shape: CellShape, stride: usize, points: &[[f64; 3]], corners: &[u32]) -> Domain {
    Domain::from_cells(points, &CellList::uniform(shape, stride, corners), &Mask::none()).unwrap()
}

/// Points in general position.
fn points(count: usize) -> Vec<[f64; 3]> {
    (0..count).map(|i| i as f64 + 1.0).map(|t| [t.sin(), (2.0 * t).cos(), (3.0 * t).sin() + 0.1 * t]).collect()
}

#[test]
fn clean_meshes_have_none() {
    for complex in [sphere(2), torus(5, 4), grid([4, 4, 1]), grid([3, 3, 3]), grid([9, 1, 1])] {
        let domain = Domain::from_complex(&complex).unwrap();
        assert_eq!(faults(&domain), []);
        assert_eq!(check(&domain), Ok(()));
    }
}

#[test]
fn non_finite_coordinates() {
    let mut domain = Domain::from_complex(&grid([3, 3, 1])).unwrap();
    let mut points = domain.complex.points().to_vec();
    points[4] = [0.0, f64::NAN, 0.0];
    domain.complex = SimplicialComplex::new(2, points, domain.complex.simplices().to_vec()).unwrap();
    let fault = check(&domain).unwrap_err();
    assert_eq!(fault.severity(), Severity::Refused);
    assert_eq!(fault.to_string(), "point 4 lies at [0.0, NaN, 0.0]; every coordinate must be finite: mask the point or repair it");
    assert!(matches!(faults(&domain)[0], MeshFault::NonFiniteCoordinates { point: 4, .. }));
}

#[test]
fn zero_measure_in_every_dimension() {
    let place = |domain: &Domain| match check(domain).unwrap_err() {
        MeshFault::ZeroMeasure { cell, points, .. } => (cell, points),
        other => panic!("{other}"),
    };
    let line = [[1.0, 1.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
    assert_eq!(place(&domain(CellShape::Line, 2, &line, &[0, 1, 0, 2])), (1, vec![0, 2]));
    let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.1, 0.1, 0.0], [0.3, 0.3, 0.0]];
    let triangles = domain(CellShape::Triangle, 3, &flat, &[0, 1, 2, 0, 3, 4]);
    assert_eq!(place(&triangles), (1, vec![0, 3, 4]));
    let fault = check(&triangles).unwrap_err();
    assert_eq!(fault.severity(), Severity::Refused);
    assert!(fault.to_string().starts_with("cell 1 holds a simplex of zero measure on points [0, 3, 4]"), "{fault}");
    let plane = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    assert_eq!(place(&domain(CellShape::Tetrahedron, 4, &plane, &[0, 1, 2, 3])), (0, vec![0, 1, 2, 3]));
    // Thin is not flat, at any unit of length.
    for unit in [1e-100, 1e-8, 1.0, 1e8, 1e100] {
        let thin = [[0.0; 3], [unit, 0.0, 0.0], [0.0, 1e-12 * unit, 0.0]];
        assert_eq!(check(&domain(CellShape::Triangle, 3, &thin, &[0, 1, 2])), Ok(()));
    }
}

#[test]
fn non_manifold_edge() {
    let domain = domain(CellShape::Triangle, 3, &points(6), &[1, 2, 3, 2, 1, 4, 1, 2, 5]);
    let found = faults(&domain);
    assert_eq!(found[1..], [MeshFault::NonManifoldEdge { points: [1, 2], triangles: 3 }]);
    assert_eq!(found[1].to_string(), "edge between points 1 and 2 has 3 triangles; kept: extrema and energy count every one of them");
    assert_eq!(check(&domain), Ok(()), "handled, not refused");
}

#[test]
fn non_manifold_face() {
    let domain = domain(CellShape::Tetrahedron, 4, &points(6), &[0, 1, 2, 3, 0, 1, 2, 4, 0, 1, 2, 5]);
    assert_eq!(faults(&domain), [MeshFault::NonManifoldFace { points: [0, 1, 2], tetrahedra: 3 }]);
}

#[test]
fn non_manifold_vertices() {
    let fork = domain(CellShape::Line, 2, &points(4), &[0, 1, 1, 2, 1, 3]);
    assert_eq!(faults(&fork), [MeshFault::NonManifoldVertex { point: 1, sheets: 3 }]);
    let bow_tie = domain(CellShape::Triangle, 3, &points(5), &[0, 1, 2, 0, 3, 4]);
    assert_eq!(faults(&bow_tie), [MeshFault::NonManifoldVertex { point: 0, sheets: 2 }]);
    let touching = domain(CellShape::Tetrahedron, 4, &points(7), &[0, 1, 2, 3, 0, 4, 5, 6]);
    assert_eq!(unoriented(&touching), [MeshFault::NonManifoldVertex { point: 0, sheets: 2 }]);
    // Two tetrahedra at one edge: both its ends are pinched.
    let hinge = domain(CellShape::Tetrahedron, 4, &points(6), &[0, 1, 2, 3, 0, 1, 4, 5]);
    let pinched = |point| MeshFault::NonManifoldVertex { point, sheets: 2 };
    assert_eq!(unoriented(&hinge), [pinched(0), pinched(1)]);
}

/// The faults without orientation, which points in general position do not control.
fn unoriented(domain: &Domain) -> Vec<MeshFault> {
    faults(domain).into_iter().filter(|fault| !matches!(fault, MeshFault::InconsistentOrientation { .. })).collect()
}

#[test]
fn a_cone_over_a_torus_is_no_manifold_though_one_sheet() {
    let rim = torus(4, 3);
    let apex = rim.vertex_count() as u32;
    let mut points = rim.points().to_vec();
    points.push([0.0, 0.0, 9.0]);
    let tetrahedra: Vec<u32> = rim.simplices().chunks(3).flat_map(|t| [t[0], t[1], t[2], apex]).collect();
    let domain = domain(CellShape::Tetrahedron, 4, &points, &tetrahedra);
    let found = unoriented(&domain);
    assert!(found.contains(&MeshFault::NonManifoldVertex { point: apex, sheets: 1 }), "{found:?}");
}

#[test]
fn inconsistent_orientation() {
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let turned = domain(CellShape::Triangle, 3, &square, &[0, 1, 2, 0, 3, 2]);
    let found = faults(&turned);
    assert_eq!(found, [MeshFault::InconsistentOrientation { count: 1, first: [0, 1] }]);
    assert!(found[0].to_string().contains("first cells 0 and 1; kept"));
    let lines = domain(CellShape::Line, 2, &points(3), &[0, 1, 2, 1]);
    assert_eq!(faults(&lines), [MeshFault::InconsistentOrientation { count: 1, first: [0, 1] }]);
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let same = domain(CellShape::Tetrahedron, 4, &corners, &[0, 1, 2, 3, 0, 2, 1, 4]);
    assert_eq!(faults(&same), []);
    let mixed = domain(CellShape::Tetrahedron, 4, &corners, &[0, 1, 2, 3, 0, 1, 2, 4]);
    assert_eq!(faults(&mixed), [MeshFault::InconsistentOrientation { count: 1, first: [0, 1] }]);
}

#[test]
fn duplicate_points_and_minus_zero() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, -0.0, 0.0], [1.0, 1.0, 0.0], [-0.0, 1.0, 0.0]];
    let domain = domain(CellShape::Triangle, 3, &points, &[0, 1, 2, 3, 4, 5]);
    assert_eq!(faults(&domain), [MeshFault::DuplicatePoints { count: 2, first: 1, second: 3 }]);
}

#[test]
fn duplicate_cells() {
    let domain = domain(CellShape::Triangle, 3, &points(4), &[0, 1, 2, 1, 3, 2, 2, 0, 1, 0, 2, 1, 2, 3, 1]);
    assert_eq!(domain.complex.simplices(), [0, 1, 2, 1, 3, 2]);
    assert_eq!(domain.cell_of_simplex(), [0, 1]);
    assert_eq!(domain.notes, [MeshFault::DuplicateCells { count: 3, first: 0, second: 2 }]);
    assert_eq!(domain.notes[0].to_string(), "3 cells repeat simplices of earlier cells, first cell 2 those of cell 0; used once");
    assert_eq!(faults(&domain), domain.notes);
}

#[test]
fn lower_dimensional_cells_and_loose_points() {
    let mut cells = CellList::new();
    cells.push(CellShape::Vertex, &[0]);
    cells.push(CellShape::Line, &[3, 4]);
    cells.push(CellShape::Triangle, &[0, 1, 2]);
    let domain = Domain::from_cells(&points(6), &cells, &Mask::none()).unwrap();
    let expected = [
        MeshFault::UnreferencedPoints { count: 1, first: 5 },
        MeshFault::IsolatedPoints { count: 2, first: 3 },
        MeshFault::LowerDimensionalCells { count: 2, first: 0, dimension: 2 },
    ];
    assert_eq!(domain.notes, expected);
    assert!(domain.notes.iter().all(|note| note.severity() == Severity::Handled));
    // The cell mask chooses: without the triangle, the line is the domain.
    let mask = Mask { keep_points: None, keep_cells: Some(vec![true, true, false]) };
    assert_eq!(Domain::from_cells(&points(6), &cells, &mask).unwrap().complex.dimension(), 1);
}

#[test]
fn a_complex_may_have_loose_vertices() {
    let complex = SimplicialComplex::new(1, points(5), vec![1, 2, 2, 4]).unwrap();
    let domain = Domain::from_complex(&complex).unwrap();
    assert_eq!(domain.point_of_vertex(), [1, 2, 4]);
    assert_eq!(domain.notes, [MeshFault::UnreferencedPoints { count: 2, first: 0 }]);
}

#[test]
fn counts_and_first_places_hold_across_parallel_tasks() {
    let count = 20_000u32;
    let points: Vec<[f64; 3]> = (0..count + 2).map(|i| [i as f64, (i % 2) as f64, 0.0]).collect();
    let mut cells = CellList::new();
    for i in 0..count {
        match i {
            9_000 | 15_000 => cells.push(CellShape::Triangle, &[i, i, i + 2]),
            12_000 | 17_000 => cells.push(CellShape::Line, &[i, i + 2]),
            19_000 => cells.push(CellShape::Triangle, &[102, 101, 100]),
            _ => cells.push(CellShape::Triangle, &[i, i + 1, i + 2]),
        }
    }
    let domain = Domain::from_cells(&points, &cells, &Mask::none()).unwrap();
    let expected = [
        MeshFault::DuplicateCells { count: 1, first: 100, second: 19_000 },
        MeshFault::LowerDimensionalCells { count: 2, first: 12_000, dimension: 2 },
        MeshFault::CollapsedCells { count: 2, first: 9_000 },
    ];
    assert_eq!(domain.notes, expected);
    assert_eq!(domain.complex.simplex_count(), 19_995);
}
