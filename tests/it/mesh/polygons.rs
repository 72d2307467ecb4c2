//! Triangulation of polygons, quads, pixels, strips and polylines.

use super::shapes::{Noise, turned};
use morsmooth::mesh::{CellList, CellShape, Domain, Mask, MeshFault, check, faults};
use proptest::prelude::*;

fn polygon(outline: &[[f64; 2]], map: impl Fn([f64; 3]) -> [f64; 3]) -> Domain {
    let points: Vec<[f64; 3]> = outline.iter().map(|&[x, y]| map([x, y, 0.0])).collect();
    let mut cells = CellList::new();
    cells.push(CellShape::Polygon, &(0..points.len() as u32).collect::<Vec<_>>());
    Domain::from_cells(&points, &cells, &Mask::none()).unwrap()
}

fn signed_area(outline: &[[f64; 2]]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>() / 2.0
}

/// Triangles cover a simple polygon if their number, orientation and total area are right.
fn assert_covers(domain: &Domain, outline: &[[f64; 2]]) {
    let complex = &domain.complex;
    assert_eq!(complex.simplex_count(), outline.len() - 2);
    assert_eq!(faults(domain), []);
    let area: f64 = (0..complex.simplex_count()).map(|simplex| complex.measure(simplex)).sum();
    let expected = signed_area(outline).abs();
    assert!((area - expected).abs() < 1e-12 * expected.max(1.0), "{area} for {expected}");
}

#[test]
fn a_convex_polygon_is_a_fan_from_its_smallest_point() {
    let points = [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 1.5, 0.0], [1.0, 1.0, 0.0]];
    let cells = CellList::uniform(CellShape::Polygon, 5, &[1, 0, 4, 3, 2]);
    let domain = Domain::from_cells(&points, &cells, &Mask::none()).unwrap();
    assert_eq!(domain.complex.simplices(), [0, 4, 3, 0, 3, 2, 0, 2, 1]);
}

#[test]
fn a_hanging_node_makes_no_flat_triangle() {
    // The fan from point 0 would hold the flat triangle 0, 1, 2.
    let outline = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
    assert_covers(&polygon(&outline, |p| p), &outline);
    // All sides of a square cut in four.
    let side = |from: [f64; 2], to: [f64; 2]| (0..4).map(move |i| [0, 1].map(|a| from[a] + (to[a] - from[a]) * i as f64 / 4.0));
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let outline: Vec<[f64; 2]> = (0..4).flat_map(|i| side(corners[i], corners[(i + 1) % 4])).collect();
    assert_covers(&polygon(&outline, |p| p), &outline);
}

#[test]
fn concave_polygons_are_cut_by_ears() {
    let letter = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    assert_covers(&polygon(&letter, |p| p), &letter);
    let dart = [[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.7, 1.0]];
    assert_covers(&polygon(&dart, turned), &dart);
    // Clockwise outlines stay clockwise.
    let back: Vec<[f64; 2]> = letter.iter().rev().copied().collect();
    let domain = polygon(&back, |p| p);
    assert_covers(&domain, &back);
    let [a, b, c] = [0, 1, 2].map(|corner| back[domain.complex.simplex(0)[corner] as usize]);
    assert!(signed_area(&[a, b, c]) < 0.0);
}

#[test]
fn a_spiral_is_cut_by_ears() {
    let spiral: Vec<[f64; 2]> = (0..40)
        .map(|i| (i as f64 * 0.4, 1.0))
        .chain((0..40).rev().map(|i| (i as f64 * 0.4, 1.3)))
        .map(|(turn, wide)| [(1.0 + turn) * wide * turn.cos(), (1.0 + turn) * wide * turn.sin()])
        .collect();
    assert_covers(&polygon(&spiral, turned), &spiral);
}

#[test]
fn a_hole_may_be_tied_to_the_outline_by_a_bridge() {
    let points = [
        [0.0, 0.0, 0.0],
        [3.0, 0.0, 0.0],
        [3.0, 3.0, 0.0],
        [0.0, 3.0, 0.0],
        [1.0, 1.0, 0.0],
        [1.0, 2.0, 0.0],
        [2.0, 2.0, 0.0],
        [2.0, 1.0, 0.0],
    ];
    let mut cells = CellList::new();
    cells.push(CellShape::Polygon, &[0, 1, 2, 3, 0, 4, 5, 6, 7, 4]);
    let domain = Domain::from_cells(&points, &cells, &Mask::none()).unwrap();
    assert_eq!(faults(&domain), []);
    let area: f64 = (0..domain.complex.simplex_count()).map(|simplex| domain.complex.measure(simplex)).sum();
    assert!((area - 8.0).abs() < 1e-12);
}

#[test]
fn a_dart_given_as_a_quad_is_cut_on_its_inner_diagonal() {
    let points = [[0.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 2.0, 0.0], [0.7, 1.0, 0.0]];
    // The smallest point number, 0, is not on the inner diagonal 1–3.
    let domain = Domain::from_cells(&points, &CellList::uniform(CellShape::Quad, 4, &[0, 1, 2, 3]), &Mask::none()).unwrap();
    assert!(domain.complex.edge(1usize.into(), 3usize.into()).is_some());
    assert_eq!(faults(&domain), []);
}

#[test]
fn quads_and_pixels_are_cut_at_their_smallest_point() {
    let points = [[1.0, 1.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let quad = Domain::from_cells(&points, &CellList::uniform(CellShape::Quad, 4, &[1, 2, 0, 3]), &Mask::none()).unwrap();
    assert_eq!(quad.complex.simplices(), [0, 3, 1, 0, 1, 2]);
    let pixel = Domain::from_cells(&points, &CellList::uniform(CellShape::Pixel, 4, &[1, 2, 3, 0]), &Mask::none()).unwrap();
    assert_eq!(quad.complex.simplices(), pixel.complex.simplices());
}

#[test]
fn strips_and_polylines() {
    let points: Vec<[f64; 3]> = (0..6).map(|i| [(i / 2) as f64, (i % 2) as f64, 0.0]).collect();
    let mut cells = CellList::new();
    cells.push(CellShape::TriangleStrip, &[0, 1, 2, 3, 4, 5]);
    let domain = Domain::from_cells(&points, &cells, &Mask::none()).unwrap();
    assert_eq!(domain.complex.simplices(), [0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 5]);
    assert_eq!(faults(&domain), []);
    let mut cells = CellList::new();
    cells.push(CellShape::PolyLine, &[3, 1, 0, 3]);
    cells.push(CellShape::Line, &[4, 5]);
    let domain = Domain::from_cells(&points, &cells, &Mask::none()).unwrap();
    assert_eq!(domain.complex.dimension(), 1);
    assert_eq!(domain.complex.components().1, 2);
    assert_eq!(domain.notes, [MeshFault::UnreferencedPoints { count: 1, first: 2 }]);
}

#[test]
fn collapsed_cells_give_what_they_have() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mut cells = CellList::new();
    cells.push(CellShape::Quad, &[0, 1, 2, 2]); // a triangle
    cells.push(CellShape::Polygon, &[0, 0, 2, 3, 0]); // a triangle, too
    cells.push(CellShape::Polygon, &[0, 1]); // nothing
    cells.push(CellShape::Triangle, &[0, 1, 1]); // nothing
    let domain = Domain::from_cells(&points, &cells, &Mask::none()).unwrap();
    assert_eq!(domain.complex.simplices(), [0, 1, 2, 0, 2, 3]);
    assert_eq!(domain.cell_of_simplex(), [0, 1]);
    assert_eq!(domain.notes, [MeshFault::CollapsedCells { count: 4, first: 0 }]);
}

#[test]
fn an_outline_that_crosses_itself_is_said_to() {
    // A pentagram around which the outline runs twice, and a bow tie of five points.
    let star: Vec<[f64; 2]> = (0..5).map(|i| (i as f64 * 0.8 * std::f64::consts::PI).sin_cos().into()).collect();
    let domain = polygon(&star, |p| p);
    assert_eq!(domain.notes, [MeshFault::TangledPolygons { count: 1, first: 0 }]);
    let tie = [[0.0, 0.0], [3.0, 2.0], [3.0, 0.0], [0.0, 2.0], [-1.0, 1.2]];
    assert_eq!(polygon(&tie, |p| p).notes.len(), 1);
}

#[test]
fn a_flat_polygon_is_refused_by_name() {
    let domain = polygon(&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0], [2.0, 2.0]], |p| p);
    assert!(matches!(check(&domain).unwrap_err(), MeshFault::ZeroMeasure { cell: 0, .. }));
}

proptest! {
    /// Star-shaped polygons with wild radii, in any plane, from any first point, either way round.
    #[test]
    fn star_shaped_polygons_are_covered(count in 4usize..40, seed in any::<u64>(), backwards: bool, scale in -8i32..9) {
        let mut noise = Noise(seed);
        let first = noise.next();
        let mut outline: Vec<[f64; 2]> = (0..count)
            .map(|i| {
                let angle = (first + (i as f64 + 0.4 * noise.next()) / count as f64) * std::f64::consts::TAU;
                let radius = 0.1 + noise.next();
                [radius * angle.cos(), radius * angle.sin()]
            })
            .collect();
        if backwards {
            outline.reverse();
        }
        let unit = 10f64.powi(scale);
        assert_covers(&polygon(&outline, turned), &outline);
        let scaled: Vec<[f64; 2]> = outline.iter().map(|p| p.map(|part| part * unit)).collect();
        let simplices = |outline: &[[f64; 2]]| polygon(outline, |p| p).complex.simplices().to_vec();
        prop_assert_eq!(simplices(&outline).len(), simplices(&scaled).len());
    }
}
