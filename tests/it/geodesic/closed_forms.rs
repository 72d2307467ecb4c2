//! Meshes on which distances are known.

use morsmooth::mesh::SimplicialComplex;

use super::{Random, distance, from, grid};

#[test]
fn a_convex_part_of_the_plane_has_straight_distances() {
    let mut random = Random(3);
    let inside = |x: f64| x > 0.0 && x < 20.0;
    let place = |x: f64, y: f64, random: &mut Random| {
        // The rim stays straight.
        let shift = |on: bool, random: &mut Random| if on { 0.45 * (random.next() - 0.5) } else { 0.0 };
        let moved = inside(x) && inside(y);
        [x + shift(moved, random), y + shift(moved, random), 0.0]
    };
    let mesh = grid([21, 21], &mut random, place, |_, _| true);
    for source in [0, 5, 220, 233, 440] {
        for (vertex, found) in from(&mesh, source).into_iter().enumerate() {
            let expected = distance(mesh.points()[source], mesh.points()[vertex]);
            assert!((found - expected).abs() <= 1e-9, "{source} to {vertex}: {found}, {expected}");
        }
    }
}

#[test]
fn paths_bend_around_a_corner() {
    // A square of 20 x 20 without its upper right quarter.
    let mesh = grid([21, 21], &mut Random(4), |x, y, _| [x, y, 0.0], |i, j| i < 10 || j < 10);
    let (source, corner) = (20 * 21 + 7, [10.0, 10.0, 0.0]);
    let found = from(&mesh, source);
    let start = mesh.points()[source];
    for (vertex, &point) in mesh.points().iter().enumerate().filter(|(vertex, _)| vertex % 21 <= 10 || vertex / 21 <= 10) {
        // Behind the line from the source through the corner.
        let is_hidden = (corner[0] - start[0]) * (point[1] - start[1]) - (corner[1] - start[1]) * (point[0] - start[0]) > 0.0 && point[0] > 10.0;
        let expected = if is_hidden { distance(start, corner) + distance(corner, point) } else { distance(start, point) };
        assert!((found[vertex] - expected).abs() < 1e-9, "{point:?}: {}, {expected}", found[vertex]);
    }
}

#[test]
fn the_far_corner_of_a_box_is_where_unfolding_says() {
    let corners: Vec<[f64; 3]> = (0..8).map(|k| [f64::from(k & 1), 2.0 * f64::from(k >> 1 & 1), 3.0 * f64::from(k >> 2)]).collect();
    let quads = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    for turn in 0..4 {
        // Whichever diagonals the faces have.
        let mut triangles = Vec::new();
        for (place, quad) in quads.iter().enumerate() {
            let [a, b, c, d] = if (place + turn) % 2 == 0 { *quad } else { [quad[1], quad[2], quad[3], quad[0]] };
            triangles.extend([a, b, c, a, c, d]);
        }
        let mesh = SimplicialComplex::new(2, corners.clone(), triangles).unwrap();
        let found = from(&mesh, 0);
        // sqrt((1 + 2)² + 3²) is the least of the three unfoldings.
        assert!((found[7] - 18f64.sqrt()).abs() < 1e-14, "{}", found[7]);
        assert!((found[3] - 5f64.sqrt()).abs() < 1e-14 && (found[6] - 13f64.sqrt()).abs() < 1e-14);
    }
}

#[test]
fn a_cone_has_chords_or_goes_over_its_apex() {
    // Points at distance 1 from the apex, their neighbours seen from it under `angle`: less than a full turn in all, or more.
    for (count, angle) in [(9usize, 0.4f64), (16, 0.4), (20, 0.4), (31, 0.3)] {
        let chord = 2.0 * (angle / 2.0).sin();
        let mut points = vec![[0.0; 3]];
        // A zigzag closes the ring for any angle: all points on the unit sphere, neighbours at the distance `chord`.
        let tilt = ring_tilt(count, chord);
        for k in 0..count {
            let turn = std::f64::consts::TAU * k as f64 / count as f64;
            let height = match tilt {
                Tilt::Cone(height) => height,
                Tilt::Wave(rise) => if k % 2 == 0 { rise } else { -rise },
            };
            let radius = (1.0 - height * height).sqrt();
            points.push([radius * turn.cos(), radius * turn.sin(), height]);
        }
        let corners = (0..count as u32).flat_map(|k| [0, 1 + k, 1 + (k + 1) % count as u32]).collect();
        let mesh = SimplicialComplex::new(2, points.clone(), corners).unwrap();
        let found = from(&mesh, 1);
        for k in 1..count {
            let step = k.min(count - k);
            let mut seen = 0.0;
            let order: Vec<usize> = if step == k { (0..k).collect() } else { (k..count).collect() };
            for &j in &order {
                let side = distance(points[1 + j], points[1 + (j + 1) % count]);
                seen += 2.0 * (side / 2.0).asin();
            }
            let expected = if seen < std::f64::consts::PI { 2.0 * (seen / 2.0).sin() } else { 2.0 };
            assert!((found[1 + k] - expected).abs() < 1e-12, "{count} x {angle}, {k}: {}, {expected}", found[1 + k]);
        }
    }
}

enum Tilt {
    Cone(f64),
    Wave(f64),
}

/// Heights on the unit sphere that put `count` points at about the distance `chord` from the next.
fn ring_tilt(count: usize, chord: f64) -> Tilt {
    let flat = 2.0 * (std::f64::consts::PI / count as f64).sin();
    if chord < flat {
        Tilt::Cone((1.0 - (chord / flat).powi(2)).sqrt())
    } else {
        // Equal sides need an even number; for an odd one two neighbours share a height, and the test measures every side.
        let rise = ((chord * chord - flat * flat) / (4.0 - flat * flat)).max(0.0).sqrt();
        Tilt::Wave(rise)
    }
}
