//! Properties of exact distances on any mesh.

use morsmooth::field::VertexId;
use morsmooth::geodesic::{ExactGeodesic, SurfacePoint, exact_distances, nearest_point, sample_curve};
use morsmooth::mesh::SimplicialComplex;

use super::{Random, at, distance, from, grid};

fn terrain(seed: u64) -> SimplicialComplex {
    let place = |x: f64, y: f64, random: &mut Random| [x + 0.4 * random.next(), y + 0.4 * random.next(), 1.5 * random.next()];
    grid([16, 14], &mut Random(seed), place, |i, j| !(5..8).contains(&i) || !(4..9).contains(&j))
}

#[test]
fn distances_are_a_metric() {
    let mesh = terrain(5);
    let used: Vec<usize> = (0..mesh.vertex_count()).filter(|&vertex| !mesh.star(VertexId::from(vertex)).is_empty()).step_by(9).collect();
    let table: Vec<Vec<f64>> = used.iter().map(|&vertex| from(&mesh, vertex)).collect();
    for (a, row) in table.iter().enumerate() {
        for (b, other) in table.iter().enumerate() {
            assert!((row[used[b]] - other[used[a]]).abs() < 1e-11, "symmetric");
            for &c in &used {
                assert!(row[c] <= row[used[b]] + other[c] + 1e-11, "triangle inequality");
            }
        }
        for edge in mesh.edges() {
            let length = distance(mesh.point(edge[0]), mesh.point(edge[1]));
            assert!((row[edge[0].index()] - row[edge[1].index()]).abs() <= length + 1e-11, "no faster than along an edge");
        }
    }
}

#[test]
fn unit_and_numbering_do_not_matter() {
    let mesh = terrain(6);
    let expected = from(&mesh, 3);
    for factor in [1e-8, 1e8, 1e-120, 1e120] {
        let points = mesh.points().iter().map(|point| point.map(|part| part * factor)).collect();
        let scaled = SimplicialComplex::new(2, points, mesh.simplices().to_vec()).unwrap();
        for (found, expected) in from(&scaled, 3).iter().zip(&expected).filter(|(_, expected)| expected.is_finite()) {
            assert!((found / factor - expected).abs() <= 1e-12 * expected, "{factor}: {found}");
        }
    }
    // Points in reverse order, every second triangle turned over.
    let n = mesh.vertex_count() as u32;
    let points = mesh.points().iter().rev().copied().collect();
    let turned = mesh.simplices().chunks(3).enumerate().flat_map(|(place, t)| {
        let [a, b, c] = [t[0], t[1], t[2]].map(|vertex| n - 1 - vertex);
        if place % 2 == 0 { [b, a, c] } else { [a, b, c] }
    });
    let other = SimplicialComplex::new(2, points, turned.collect()).unwrap();
    for (found, expected) in from(&other, n as usize - 4).iter().rev().zip(&expected).filter(|(_, expected)| expected.is_finite()) {
        assert!((found - expected).abs() <= 1e-12 * (1.0 + expected));
    }
}

#[test]
fn sources_in_faces_and_on_edges_are_vertices_of_a_finer_mesh() {
    let mesh = terrain(7);
    for triangle in [0, 77, 200] {
        for (weights, on_edge) in [([0.2, 0.5, 0.3], false), ([0.0, 0.25, 0.75], true)] {
            let source = SurfacePoint::Face { triangle, weights };
            let found = exact_distances(&mesh, &[source]).unwrap();
            let position = source.position(&mesh);
            let (nearest, off) = nearest_point(&mesh, position).unwrap();
            assert!(off < 1e-12 && matches!(nearest, SurfacePoint::Edge { .. }) == on_edge);
            let also = exact_distances(&mesh, &[nearest]).unwrap();
            // The triangles that hold the source, cut there.
            let mut points = mesh.points().to_vec();
            points.push(position);
            let new = points.len() as u32 - 1;
            let corners = mesh.simplex(triangle);
            let opposite = [corners[1], corners[2]];
            let mut finer = Vec::new();
            for t in mesh.simplices().chunks(3) {
                let is_cut = if on_edge { opposite.iter().all(|vertex| t.contains(vertex)) } else { t == corners };
                if !is_cut {
                    finer.extend_from_slice(t);
                    continue;
                }
                for k in 0..3 {
                    let side = [t[k], t[(k + 1) % 3]];
                    if !(on_edge && opposite.iter().all(|vertex| side.contains(vertex))) {
                        finer.extend([side[0], side[1], new]);
                    }
                }
            }
            let expected = from(&SimplicialComplex::new(2, points, finer).unwrap(), new as usize);
            for (vertex, &expected) in expected[..new as usize].iter().enumerate().filter(|(_, expected)| expected.is_finite()) {
                assert!((found[vertex] - expected).abs() < 1e-11 && (also[vertex] - expected).abs() < 1e-11, "vertex {vertex}");
            }
        }
    }
}

#[test]
fn the_nearest_of_several_sources_counts_and_threads_do_not() {
    let mesh = terrain(8);
    let exact = ExactGeodesic::new(&mesh).unwrap();
    let sets = vec![vec![at(0)], vec![at(200)], vec![at(0), at(200)]];
    let each = exact.distances_each(&sets).unwrap();
    for ((one, other), both) in each[0].iter().zip(&each[1]).zip(&each[2]) {
        let nearest = one.min(*other);
        assert!(*both == nearest || (both - nearest).abs() < 1e-11);
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let alone = pool.install(|| ExactGeodesic::new(&mesh).unwrap().distances_each(&sets).unwrap());
    assert_eq!(alone, each, "same bits for any number of threads");
}

#[test]
fn other_components_are_infinitely_far_and_a_shared_vertex_is_a_gate() {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [9.0, 0.0, 0.0], [9.0, 1.0, 0.0], [8.0, 0.0, 0.0]];
    // Two triangles that share vertex 0 only, and one apart.
    let mesh = SimplicialComplex::new(2, points, vec![0, 1, 2, 0, 3, 4, 5, 6, 7]).unwrap();
    let found = from(&mesh, 1);
    assert_eq!(found[..5], [1.0, 0.0, 2f64.sqrt(), 2.0, 2.0]);
    assert!(found[5..].iter().all(|distance| *distance == f64::INFINITY));
}

#[test]
fn slivers_do_no_harm() {
    // A flat strip cut by needles of aspect 1 : 1e7.
    let n = 40;
    let mut points = Vec::new();
    for k in 0..n {
        let x = f64::from(k) + if k % 2 == 0 { 0.0 } else { -1.0 + 1e-7 };
        points.extend([[x, 0.0, 0.0], [x, 1.0, 0.0]]);
    }
    let corners = (0..n as u32 - 1).flat_map(|k| [2 * k, 2 * k + 2, 2 * k + 1, 2 * k + 1, 2 * k + 2, 2 * k + 3]).collect();
    let mesh = SimplicialComplex::new(2, points, corners).unwrap();
    let found = from(&mesh, 0);
    for (vertex, point) in mesh.points().iter().enumerate() {
        let expected = distance(mesh.points()[0], *point);
        assert!((found[vertex] - expected).abs() < 1e-8, "{vertex}: {} {expected}", found[vertex]);
    }
}

#[test]
fn a_sampled_curve_is_as_near_as_promised() {
    let mesh = grid([21, 21], &mut Random(9), |x, y, _| [x, y, 0.0], |_, _| true);
    let corners: Vec<SurfacePoint> = (3..18).map(|x| nearest_point(&mesh, [f64::from(x), 10.0, 0.0]).unwrap().0).collect();
    for spacing in [0.7, 0.1] {
        let samples = sample_curve(&mesh, &corners, spacing).unwrap();
        for pair in samples.windows(2) {
            assert!(distance(pair[0].position(&mesh), pair[1].position(&mesh)) <= spacing * (1.0 + 1e-12));
        }
        let found = exact_distances(&mesh, &samples).unwrap();
        for (vertex, &[x, y, _]) in mesh.points().iter().enumerate() {
            let expected = (x - x.clamp(3.0, 17.0)).hypot(y - 10.0);
            assert!((-1e-12..=spacing / 2.0).contains(&(found[vertex] - expected)), "{x} {y}: {}, {expected}", found[vertex]);
        }
    }
}
