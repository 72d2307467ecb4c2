//! The algebra of the Laplacians, not their numbers.

use crate::mesh::shapes::{Noise, grid, is_inside, jittered, mapped, renumbered, sphere, torus, turned, with_threads};
use morsmooth::field::VertexId;
use morsmooth::linalg::CsrMatrix;
use morsmooth::mesh::SimplicialComplex;
use morsmooth::operators::{LEAST_WEIGHT, cotangent_laplacian, gradients, positive_laplacian};

/// Meshes of every dimension: regular, irregular, closed, curved, thin.
fn meshes() -> Vec<(&'static str, SimplicialComplex)> {
    let squash = |p: [f64; 3]| [p[0], 0.1 * p[1], p[2]];
    vec![
        ("line", jittered([9, 1, 1], 0.3, 1)),
        ("curve in space", mapped(&grid([12, 1, 1]), |p| [p[0].sin(), p[0].cos(), 0.3 * p[0]])),
        ("plane", jittered([8, 7, 1], 0.3, 2)),
        ("squashed plane", mapped(&jittered([8, 7, 1], 0.3, 3), squash)),
        ("turned plane", mapped(&jittered([8, 7, 1], 0.3, 4), turned)),
        ("sphere", sphere(3)),
        ("torus", torus(9, 6)),
        ("block", jittered([5, 4, 6], 0.15, 5)),
        ("squashed block", mapped(&jittered([5, 4, 6], 0.15, 6), squash)),
    ]
}

fn largest(matrix: &CsrMatrix) -> f64 {
    (0..matrix.rows()).flat_map(|row| matrix.row(row).1).fold(0.0, |most, value| most.max(value.abs()))
}

/// Rounding of a row: its terms times the relative error of a cotangent, which grows as the angle shrinks.
fn tolerance(matrix: &CsrMatrix) -> f64 {
    1e-13 * largest(matrix)
}

#[test]
fn constants_are_in_the_null_space_and_the_matrix_is_symmetric() {
    for (name, complex) in meshes() {
        for laplacian in [cotangent_laplacian(&complex).unwrap(), positive_laplacian(&complex).unwrap()] {
            assert_eq!(laplacian, laplacian.transpose(), "{name}: to the bit");
            let rows = laplacian.multiply(&vec![1.0; complex.vertex_count()]);
            assert!(rows.iter().all(|sum| sum.abs() <= tolerance(&laplacian)), "{name}");
            assert_eq!(laplacian.entries(), complex.vertex_count() + 2 * complex.edges().len(), "{name}");
        }
    }
}

#[test]
fn it_is_positive_semidefinite() {
    let mut noise = Noise(7);
    for (name, complex) in meshes() {
        for laplacian in [cotangent_laplacian(&complex).unwrap(), positive_laplacian(&complex).unwrap()] {
            for _ in 0..50 {
                let x: Vec<f64> = (0..complex.vertex_count()).map(|_| noise.next() - 0.5).collect();
                let energy: f64 = x.iter().zip(laplacian.multiply(&x)).map(|(a, b)| a * b).sum();
                assert!(energy > 0.0, "{name}: {energy}");
            }
        }
    }
}

/// The stiffness matrix of linear finite elements is the integral of gradient times gradient: another road to the same numbers.
#[test]
fn it_is_the_stiffness_matrix_of_the_gradients() {
    for (name, complex) in meshes() {
        let n = complex.vertex_count();
        let laplacian = cotangent_laplacian(&complex).unwrap();
        let hat = |vertex: usize| (0..n).map(|other| if other == vertex { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
        let hats: Vec<Vec<[f64; 3]>> = (0..n).map(|vertex| gradients(&complex, &hat(vertex)).unwrap()).collect();
        for (a, b) in (0..n).flat_map(|a| (a..n.min(a + 20)).map(move |b| (a, b))) {
            let product = |simplex: usize| hats[a][simplex].iter().zip(hats[b][simplex]).map(|(p, q)| p * q).sum::<f64>();
            let expected: f64 = (0..complex.simplex_count()).map(|simplex| complex.measure(simplex) * product(simplex)).sum();
            let found = laplacian.get(a, b);
            assert!((found - expected).abs() <= tolerance(&laplacian), "{name}: {found} for {expected} at {a}, {b}");
        }
    }
}

#[test]
fn linear_functions_are_harmonic_inside() {
    for (dims, jitter) in [([9, 1, 1], 0.3), ([9, 8, 1], 0.3), ([1, 8, 9], 0.0), ([5, 6, 5], 0.15)] {
        let complex = jittered(dims, jitter, 11);
        let laplacian = cotangent_laplacian(&complex).unwrap();
        let linear: Vec<f64> = complex.points().iter().map(|p| 3.0 * p[0] - 2.0 * p[1] + p[2] + 5.0).collect();
        let values = laplacian.multiply(&linear);
        for vertex in (0..complex.vertex_count()).filter(|&vertex| is_inside(dims, vertex)) {
            assert!(values[vertex].abs() < 100.0 * tolerance(&laplacian), "{dims:?}: {}", values[vertex]);
        }
    }
}

#[test]
fn a_unit_grid_gives_the_stencils_of_finite_differences() {
    let line = cotangent_laplacian(&grid([3, 1, 1])).unwrap();
    assert_eq!(line.row(1), (&[0, 1, 2][..], &[-1.0, 2.0, -1.0][..]));
    let plane = cotangent_laplacian(&grid([3, 3, 1])).unwrap();
    let (columns, values) = plane.row(4);
    assert_eq!(columns, [0, 1, 3, 4, 5, 7, 8]);
    for (value, expected) in values.iter().zip([0.0, -1.0, -1.0, 4.0, -1.0, -1.0, 0.0]) {
        assert!((value - expected).abs() < 1e-15);
    }
    // In space, too, only the six neighbours along the axes have a weight.
    let space = cotangent_laplacian(&grid([3, 3, 3])).unwrap();
    let (columns, values) = space.row(13);
    for (&column, &value) in columns.iter().zip(values) {
        let expected = if column == 13 { 6.0 } else if [4, 10, 12, 14, 16, 22].contains(&column) { -1.0 } else { 0.0 };
        assert!((value - expected).abs() < 1e-15, "{column}: {value}");
    }
}

/// `L` is in `[length^(d-2)]`.
#[test]
fn scale_by_1e8_and_back() {
    for (name, complex) in meshes() {
        for (build, positive) in [(cotangent_laplacian as fn(&_) -> _, false), (positive_laplacian, true)] {
            let unit = build(&complex).unwrap();
            for scale in [1e-8f64, 1e8] {
                let scaled = build(&mapped(&complex, |p| p.map(|part| part * scale))).unwrap();
                let factor = scale.powi(complex.dimension() as i32 - 2);
                for row in 0..unit.rows() {
                    let (columns, values) = unit.row(row);
                    assert_eq!(columns, scaled.row(row).0);
                    for (value, other) in values.iter().zip(scaled.row(row).1) {
                        let error = (value * factor - other).abs();
                        assert!(error <= tolerance(&unit) * factor, "{name}, {scale}, positive: {positive}: {value} {other}");
                    }
                }
            }
        }
    }
}

#[test]
fn renumbering_turning_and_moving_change_nothing_but_rounding() {
    let mut noise = Noise(13);
    for (name, complex) in meshes() {
        let laplacian = cotangent_laplacian(&complex).unwrap();
        let number = noise.permutation(complex.vertex_count());
        let other = cotangent_laplacian(&mapped(&renumbered(&complex, &number), |p| {
            let p = turned(p);
            [p[0] + 10.0, p[1] - 20.0, p[2]]
        }));
        let other = other.unwrap();
        for row in 0..laplacian.rows() {
            let (columns, values) = laplacian.row(row);
            for (&column, &value) in columns.iter().zip(values) {
                let moved = other.get(number[row] as usize, number[column as usize] as usize);
                // Moving by 20 costs one digit and a half of the coordinates.
                assert!((value - moved).abs() <= 100.0 * tolerance(&laplacian), "{name}: {value} {moved}");
            }
        }
    }
}

#[test]
fn obtuse_angles_make_negative_weights_and_the_clamp_removes_them() {
    let obtuse = mapped(&jittered([9, 9, 1], 0.3, 17), |p| [p[0], 0.1 * p[1], p[2]]);
    let plain = cotangent_laplacian(&obtuse).unwrap();
    assert!(obtuse.edges().iter().any(|[a, b]| plain.get(a.index(), b.index()) > 0.0), "else the test says nothing");
    for (name, complex) in meshes().into_iter().chain([("obtuse", obtuse)]) {
        let positive = positive_laplacian(&complex).unwrap();
        let plain = cotangent_laplacian(&complex).unwrap();
        for [a, b] in complex.edges() {
            let (weight, before) = (-positive.get(a.index(), b.index()), -plain.get(a.index(), b.index()));
            let local: f64 = complex
                .star(*a)
                .iter()
                .filter(|simplex| complex.simplex(**simplex as usize).contains(&b.0))
                .map(|&simplex| local_scale(&complex, simplex as usize))
                .sum();
            assert!(weight > 0.0, "{name}");
            assert!((weight - before.max(LEAST_WEIGHT * local)).abs() <= 1e-12 * weight, "{name}: {weight}");
        }
    }
}

/// Measure over the square of the longest edge, the slow way.
fn local_scale(complex: &SimplicialComplex, simplex: usize) -> f64 {
    let corners: Vec<[f64; 3]> = complex.simplex(simplex).iter().map(|&v| complex.point(VertexId(v))).collect();
    let square = |p: [f64; 3], q: [f64; 3]| (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f64>();
    let longest = corners.iter().flat_map(|&p| corners.iter().map(move |&q| square(p, q))).fold(0.0, f64::max);
    complex.measure(simplex) / longest
}

#[test]
fn an_anisotropic_grid_keeps_its_weights() {
    let complex = mapped(&grid([6, 6, 1]), |p| [p[0], 1e-4 * p[1], p[2]]);
    let (plain, positive) = (cotangent_laplacian(&complex).unwrap(), positive_laplacian(&complex).unwrap());
    for [a, b] in complex.edges().iter().filter(|[a, b]| b.0 - a.0 != 7) {
        assert_eq!(plain.get(a.index(), b.index()), positive.get(a.index(), b.index()));
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let complex = jittered([90, 80, 1], 0.3, 19);
    let [one, four] = with_threads(|| (cotangent_laplacian(&complex).unwrap(), positive_laplacian(&complex).unwrap()));
    assert_eq!(one, four);
}

#[test]
fn components_do_not_mix_and_non_manifold_edges_count_all_triangles() {
    let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [5.0; 3], [6.0, 5.0, 5.0], [5.0, 6.0, 5.0]];
    let complex = SimplicialComplex::new(2, points, vec![0, 1, 2, 0, 1, 3, 0, 1, 4, 5, 6, 7]).unwrap();
    let laplacian = cotangent_laplacian(&complex).unwrap();
    assert_eq!(laplacian.get(0, 1), -1.5); // three times cot 45° / 2
    let one: Vec<f64> = (0..8).map(|vertex| if vertex < 5 { 1.0 } else { -3.0 }).collect();
    assert!(laplacian.multiply(&one).iter().all(|value| value.abs() < 1e-15));
}
