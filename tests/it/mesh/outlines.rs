//! Outlines filled with triangles.

use super::shapes::Noise;
use morsmooth::field::VertexId;
use morsmooth::mesh::{OutlineError, OutlineOptions, OutlinePlace, SimplicialComplex, Size, triangulate};
use proptest::prelude::*;
use std::f64::consts::TAU;

fn square(low: f64, high: f64) -> Vec<[f64; 2]> {
    vec![[low, low], [high, low], [high, high], [low, high]]
}

fn options(max_edge: f64) -> OutlineOptions {
    OutlineOptions { max_edge: Size::Absolute(max_edge), ..OutlineOptions::default() }
}

/// Area of a polygon by the shoelace formula.
fn area(ring: &[[f64; 2]]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    ring.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>().abs() / 2.0
}

fn signed(mesh: &SimplicialComplex, triangle: usize) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|corner| mesh.point(VertexId(mesh.simplex(triangle)[corner])));
    ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
}

fn smallest_angle(mesh: &SimplicialComplex, triangle: usize) -> f64 {
    let corners = [0, 1, 2].map(|corner| mesh.point(VertexId(mesh.simplex(triangle)[corner])));
    let angle = |at: usize| {
        let side = |to: usize| [0, 1].map(|axis| corners[(at + to) % 3][axis] - corners[at][axis]);
        let ([a, b], [c, d]) = (side(1), side(2));
        (a * d - b * c).atan2(a * c + b * d).to_degrees()
    };
    (0..3).map(angle).fold(f64::INFINITY, f64::min)
}

/// What holds of every triangulation: given points first and bit by bit, all triangles counter-clockwise, the area, the boundary one closed
/// curve a ring, edges not too long, no vertex of no triangle.
fn check(rings: &[Vec<[f64; 2]>], mesh: &SimplicialComplex, expected: f64, max_edge: f64) {
    for (given, &point) in rings.iter().flatten().zip(mesh.points()) {
        assert_eq!([given[0].to_bits(), given[1].to_bits()], [point[0].to_bits(), point[1].to_bits()]);
    }
    let areas: Vec<f64> = (0..mesh.simplex_count()).map(|triangle| signed(mesh, triangle)).collect();
    assert!(areas.iter().all(|&area| area > 0.0), "counter-clockwise");
    assert!((areas.iter().sum::<f64>() - expected).abs() < 1e-9 * expected, "{} for {expected}", areas.iter().sum::<f64>());
    assert!((0..mesh.vertex_count()).all(|vertex| !mesh.star(VertexId::from(vertex)).is_empty()));
    for &[a, b] in mesh.edges() {
        let [p, q] = [mesh.point(a), mesh.point(b)];
        assert!((p[0] - q[0]).hypot(p[1] - q[1]) <= max_edge * (1.0 + 1e-12));
    }
    // Vertices - edges + triangles = parts - holes, and every given segment's ends are on the boundary.
    let boundary = |vertex: usize| {
        let vertex = VertexId::from(vertex);
        mesh.star(vertex).len() + 1 == mesh.neighbours(vertex).len()
    };
    assert!((0..rings.iter().map(Vec::len).sum()).all(boundary));
}

fn euler(mesh: &SimplicialComplex) -> i64 {
    mesh.vertex_count() as i64 - mesh.edges().len() as i64 + mesh.simplex_count() as i64
}

#[test]
fn a_square_with_a_hole_and_an_island_in_it() {
    let rings = [square(0.0, 6.0), square(1.0, 5.0), square(2.0, 4.0)];
    let mesh = triangulate(&rings, &options(0.5)).unwrap();
    check(&rings, &mesh, 36.0 - 16.0 + 4.0, 0.5);
    assert_eq!(mesh.components().1, 2);
    assert_eq!(euler(&mesh), 1, "a ring has 0, a disc 1");
    let smallest = (0..mesh.simplex_count()).map(|triangle| smallest_angle(&mesh, triangle)).fold(90.0, f64::min);
    assert!(smallest >= 20.0, "{smallest}");
    // The direction of a ring does not matter.
    let turned = rings.clone().map(|mut ring| {
        ring.reverse();
        ring
    });
    let other = triangulate(&turned, &options(0.5)).unwrap();
    check(&turned, &other, 24.0, 0.5);
}

#[test]
fn without_bounds_the_corners_are_enough() {
    let ring = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [2.0, 1.0], [0.0, 3.0]];
    let free = OutlineOptions { max_edge: Size::Unbounded, min_angle: 0.0, ..OutlineOptions::default() };
    let mesh = triangulate(std::slice::from_ref(&ring), &free).unwrap();
    assert_eq!((mesh.vertex_count(), mesh.simplex_count()), (5, 3));
    check(std::slice::from_ref(&ring), &mesh, area(&ring), f64::INFINITY);
    let small = OutlineOptions { max_area: Some(0.01), ..free };
    let mesh = triangulate(&[ring], &small).unwrap();
    assert!((0..mesh.simplex_count()).all(|triangle| mesh.measure(triangle) <= 0.01));
}

#[test]
fn points_that_repeat_in_a_row_count_once() {
    let once = square(0.0, 1.0);
    let twice: Vec<[f64; 2]> = once.iter().flat_map(|&point| [point, point]).chain([once[0]]).collect();
    let [a, b] = [once, twice].map(|ring| triangulate(&[ring], &options(0.3)).unwrap());
    assert_eq!((a.points(), a.simplices()), (b.points(), b.simplices()));
}

#[test]
fn a_spike_and_a_slit_keep_their_shape() {
    // A spike of 0.6 degrees, and a slit of width 1e-6.
    let spike = vec![[0.0, 0.0], [10.0, 0.05], [0.0, 0.1], [-5.0, 3.0], [-5.0, -3.0]];
    let slit = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0 + 1e-6, 2.0], [1.0, 0.5], [1.0 - 1e-6, 2.0], [0.0, 2.0]];
    for ring in [spike, slit] {
        let expected = area(&ring);
        let mesh = triangulate(std::slice::from_ref(&ring), &options(0.5)).unwrap();
        check(&[ring], &mesh, expected, 0.5);
        assert!(mesh.first_zero_measure().is_none());
        assert!(mesh.vertex_count() < 20_000, "{}", mesh.vertex_count());
    }
}

#[test]
fn large_and_small_and_far_outlines_work() {
    for (scale, shift) in [(1e-12, 0.0), (1e12, 0.0), (1.0, 1e6)] {
        let ring = square(0.0, 1.0).into_iter().map(|[x, y]| [scale * x + shift, scale * y - shift]).collect::<Vec<_>>();
        let mesh = triangulate(std::slice::from_ref(&ring), &options(0.2 * scale)).unwrap();
        check(&[ring], &mesh, scale * scale, 0.2 * scale * 1.000001);
    }
}

#[test]
fn outlines_that_cross_or_touch_are_refused_with_the_place() {
    let refuse = |rings: &[Vec<[f64; 2]>]| triangulate(rings, &OutlineOptions::default()).unwrap_err();
    let bow = vec![[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]];
    assert_eq!(
        refuse(&[bow]).to_string(),
        "the segment from point 0 of ring 0 to point 1 crosses the segment from point 2 of ring 0 to point 3 at (1.000000, 1.000000); \
         expected rings that do not cross"
    );
    let crossing = refuse(&[square(0.0, 2.0), square(1.0, 3.0)]);
    assert!(matches!(crossing, OutlineError::Crossing { first: OutlinePlace { ring: 0, .. }, second: OutlinePlace { ring: 1, .. }, .. }), "{crossing}");
    // A corner of one ring on a corner, and on a segment, of another; the same ring twice; a ring that returns to one of its places.
    for rings in [
        vec![square(0.0, 1.0), square(1.0, 2.0)],
        vec![square(0.0, 2.0), vec![[1.0, 0.0], [1.5, 1.0], [0.5, 1.0]]],
        vec![square(0.0, 1.0), square(0.0, 1.0)],
        vec![vec![[0.0, 0.0], [1.0, 0.0], [0.5, 0.5], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]]],
        vec![vec![[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]]],
    ] {
        assert!(matches!(refuse(&rings), OutlineError::Touching { .. }), "{}", refuse(&rings));
    }
}

#[test]
fn what_is_no_outline_is_refused() {
    let refuse = |rings: &[Vec<[f64; 2]>], options: &OutlineOptions| triangulate(rings, options).unwrap_err().to_string();
    let usual = OutlineOptions::default();
    assert_eq!(refuse(&[], &usual), "the outline has no ring; expected at least one");
    assert_eq!(
        refuse(&[square(0.0, 1.0), vec![[0.0, 0.0], [1.0, 1.0], [0.0, 0.0]]], &usual),
        "ring 1 has 2 different points in a row; expected at least 3"
    );
    for wrong in [f64::NAN, f64::INFINITY, 1e40, 1e-40] {
        let ring = vec![[0.0, 0.0], [1.0, wrong], [1.0, 2.0]];
        assert!(refuse(&[ring], &usual).starts_with("point 1 of ring 0 is at [1.0, "), "{wrong}");
    }
    for (wrong, words) in [
        (OutlineOptions { min_angle: 40.0, ..usual }, "the smallest angle is 40; expected 0 to 33 degrees"),
        (OutlineOptions { max_area: Some(0.0), ..usual }, "the largest area is 0; expected a positive number"),
        (options(-1.0), "the longest edge is -1; expected a positive number"),
        (
            OutlineOptions { max_vertices: 100, ..options(0.01) },
            "the triangulation needs more than 100 vertices; expected larger triangles or a smaller least angle",
        ),
    ] {
        assert_eq!(refuse(&[square(0.0, 1.0)], &wrong), words);
    }
}

/// One in forty of these lost a part of its area when long segments were divided after the triangulation.
#[test]
fn segments_longer_than_the_bound_are_divided() {
    for seed in 0..200 {
        let mut noise = Noise(seed);
        let ring: Vec<[f64; 2]> = (0..6)
            .map(|corner| {
                let (sine, cosine) = (TAU * f64::from(corner) / 6.0).sin_cos();
                let length = 1.0 - 0.18 * noise.next();
                [length * cosine, length * sine]
            })
            .collect();
        for longest in [0.15, 0.2] {
            let rings = [ring.clone()];
            check(&rings, &triangulate(&rings, &options(longest)).unwrap(), area(&ring), longest);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Star-shaped rings with star-shaped holes, of any roughness.
    #[test]
    fn stars_are_filled(seed in 0u64..10_000, corners in 3usize..60, rough in 0.0f64..0.8, hole in any::<bool>()) {
        let mut noise = Noise(seed);
        let mut star = |radius: f64| -> Vec<[f64; 2]> {
            (0..corners).map(|corner| {
                let (sine, cosine) = (TAU * corner as f64 / corners as f64).sin_cos();
                let length = radius * (1.0 - rough * noise.next());
                [length * cosine, length * sine]
            }).collect()
        };
        let mut rings = vec![star(1.0)];
        if hole {
            // Well inside the smallest radius that the ring can have.
            rings.push(star(0.4 * (1.0 - rough) * (std::f64::consts::PI / corners as f64).cos()));
        }
        let expected = area(&rings[0]) - rings.get(1).map_or(0.0, |ring| area(ring));
        let mesh = triangulate(&rings, &options(0.15)).unwrap();
        check(&rings, &mesh, expected, 0.15);
        prop_assert_eq!(euler(&mesh), i64::from(!hole));
        let again = triangulate(&rings, &options(0.15)).unwrap();
        prop_assert_eq!(mesh.simplices(), again.simplices());
    }
}
