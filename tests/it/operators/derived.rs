//! Derivatives are exact for linear fields, in any plane and in space.

use crate::mesh::shapes::{Noise, grid, jittered, mapped, sphere, turned, with_threads};
use morsmooth::mesh::SimplicialComplex;
use morsmooth::operators::{Derived, OperatorError, derive, gradients, vertex_gradients};
use proptest::prelude::*;

type Matrix = [[f64; 3]; 3];

fn linear(complex: &SimplicialComplex, j: &Matrix) -> Vec<[f64; 3]> {
    let apply = |p: &[f64; 3]| [0, 1, 2].map(|row: usize| 1.0 + (0..3).map(|column| j[row][column] * p[column]).sum::<f64>());
    complex.points().iter().map(apply).collect()
}

fn assert_all(complex: &SimplicialComplex, vectors: &[[f64; 3]], derived: Derived, expected: f64) {
    for (vertex, value) in derive(complex, vectors, derived).unwrap().into_iter().enumerate() {
        assert!((value - expected).abs() < 1e-10, "{derived} at {vertex}: {value} for {expected}");
    }
}

fn matrix() -> impl Strategy<Value = Matrix> {
    proptest::array::uniform3(proptest::array::uniform3(-2.0f64..2.0))
}

proptest! {
    #[test]
    fn planar_quantities_are_exact_for_linear_fields(j in matrix(), plane in 0usize..3, seed in any::<u64>()) {
        // Axes x and y of the plane in right-handed order, and the normal.
        let [x, y, normal] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]][plane];
        let flat = jittered([6, 5, 1], 0.3, seed);
        let complex = mapped(&flat, |p| {
            let mut q = [0.0; 3];
            (q[x], q[y], q[normal]) = (p[0], p[1], 4.0);
            q
        });
        let vectors = linear(&complex, &j);
        let (vorticity, divergence) = (j[y][x] - j[x][y], j[x][x] + j[y][y]);
        let (stretch, shear) = (j[x][x] - j[y][y], j[y][x] + j[x][y]);
        let okubo_weiss = stretch * stretch + shear * shear - vorticity * vorticity;
        assert_all(&complex, &vectors, Derived::Vorticity, vorticity);
        assert_all(&complex, &vectors, Derived::Divergence, divergence);
        assert_all(&complex, &vectors, Derived::OkuboWeiss, okubo_weiss);
        let strain = j[x][x].powi(2) + j[y][y].powi(2) + shear * shear / 2.0;
        assert_all(&complex, &vectors, Derived::QCriterion, (vorticity * vorticity / 2.0 - strain) / 2.0);
    }

    #[test]
    fn quantities_in_space_are_exact_for_linear_fields(j in matrix(), seed in any::<u64>()) {
        let complex = jittered([4, 4, 4], 0.15, seed);
        let vectors = linear(&complex, &j);
        let curl = [j[2][1] - j[1][2], j[0][2] - j[2][0], j[1][0] - j[0][1]];
        assert_all(&complex, &vectors, Derived::Vorticity, curl.iter().map(|part| part * part).sum::<f64>().sqrt());
        assert_all(&complex, &vectors, Derived::Divergence, j[0][0] + j[1][1] + j[2][2]);
        // Q = ((trace J)² - trace J²) / 2 - (trace J)² / 2, another road to the same number.
        let square: f64 = (0..3).flat_map(|a| (0..3).map(move |b| (a, b))).map(|(a, b)| j[a][b] * j[b][a]).sum();
        assert_all(&complex, &vectors, Derived::QCriterion, -square / 2.0);
    }

    /// A turned plane gives the same numbers, up to the sign that comes with its normal.
    #[test]
    fn planes_may_be_tilted(j in matrix(), seed in any::<u64>()) {
        let flat = jittered([6, 5, 1], 0.3, seed);
        let vectors = linear(&flat, &j);
        let tilted = mapped(&flat, turned);
        let turned_vectors: Vec<[f64; 3]> = vectors.iter().map(|&v| turned(v)).collect();
        // The turn takes +z to (0, -0.89, 0.45), whose greatest component is negative.
        let sign = -1.0;
        for (derived, sign) in [(Derived::Vorticity, sign), (Derived::Divergence, 1.0), (Derived::QCriterion, 1.0), (Derived::OkuboWeiss, 1.0)] {
            let expected = derive(&flat, &vectors, derived).unwrap();
            for (value, expected) in derive(&tilted, &turned_vectors, derived).unwrap().into_iter().zip(expected) {
                prop_assert!((value - sign * expected).abs() < 1e-9, "{derived}: {value} for {expected}");
            }
        }
    }
}

#[test]
fn counter_clockwise_rotation_has_positive_vorticity() {
    let complex = grid([5, 5, 1]);
    let rotation: Vec<[f64; 3]> = complex.points().iter().map(|p| [2.0 - p[1], p[0] - 2.0, 7.0]).collect();
    assert_all(&complex, &rotation, Derived::Vorticity, 2.0);
    assert_all(&complex, &rotation, Derived::OkuboWeiss, -4.0);
    assert_all(&complex, &rotation, Derived::QCriterion, 1.0);
    assert_all(&complex, &rotation, Derived::Divergence, 0.0);
}

#[test]
fn magnitude_needs_no_plane() {
    for complex in [grid([4, 1, 1]), sphere(1), grid([3, 3, 3])] {
        let vectors = vec![[2.0, -3.0, 6.0]; complex.vertex_count()];
        assert_all(&complex, &vectors, Derived::Magnitude, 7.0);
    }
}

#[test]
fn a_plane_in_single_precision_is_a_plane() {
    let complex = mapped(&jittered([30, 30, 1], 0.3, 3), |p| turned(p).map(|part| part as f32 as f64));
    let vectors = vec![[1.0; 3]; complex.vertex_count()];
    assert_all(&complex, &vectors, Derived::Divergence, 0.0);
}

#[test]
fn gradients_of_linear_functions_are_exact_and_tangential() {
    let slope = [3.0, -2.0, 0.5];
    for (complex, tangential) in [
        (jittered([5, 4, 4], 0.15, 1), slope),
        (jittered([5, 4, 1], 0.3, 2), [3.0, -2.0, 0.0]),
        (jittered([5, 1, 1], 0.3, 3), [3.0, 0.0, 0.0]),
    ] {
        let values: Vec<f64> = complex.points().iter().map(|p| p.iter().zip(slope).map(|(a, b)| a * b).sum()).collect();
        let at_simplices = gradients(&complex, &values).unwrap();
        assert_eq!(at_simplices.len(), complex.simplex_count());
        for gradient in at_simplices.into_iter().chain(vertex_gradients(&complex, &values).unwrap()) {
            assert!((0..3).all(|axis| (gradient[axis] - tangential[axis]).abs() < 1e-12), "{gradient:?}");
        }
    }
    // On a curved surface the gradient of the height lies in each triangle.
    let complex = sphere(2);
    let height: Vec<f64> = complex.points().iter().map(|p| p[2]).collect();
    for (simplex, gradient) in gradients(&complex, &height).unwrap().into_iter().enumerate() {
        let [a, b, c] = [0, 1, 2].map(|corner: usize| complex.points()[complex.simplex(simplex)[corner] as usize]);
        let along = |p: [f64; 3], q: [f64; 3]| (0..3).map(|axis| gradient[axis] * (q[axis] - p[axis])).sum::<f64>();
        assert!((along(a, b) - (b[2] - a[2])).abs() < 1e-14 && (along(a, c) - (c[2] - a[2])).abs() < 1e-14);
        assert!(gradient.iter().map(|part| part * part).sum::<f64>() <= 1.0 + 1e-12);
    }
}

#[test]
fn scale_does_not_matter() {
    let flat = jittered([6, 5, 1], 0.3, 4);
    let j = [[1.0, 2.0, 0.0], [-3.0, 0.5, 0.0], [0.0; 3]];
    for scale in [1e-8, 1e8] {
        let complex = mapped(&flat, |p| p.map(|part| part * scale));
        let vectors: Vec<[f64; 3]> = linear(&flat, &j).iter().map(|v| v.map(|part| part * scale)).collect();
        assert_all(&complex, &vectors, Derived::Vorticity, -5.0);
    }
}

#[test]
fn quantities_without_a_meaning_are_refused() {
    let refuse = |complex: &SimplicialComplex, derived| {
        derive(complex, &vec![[1.0; 3]; complex.vertex_count()], derived).unwrap_err().to_string()
    };
    for derived in [Derived::Vorticity, Derived::Divergence, Derived::QCriterion, Derived::OkuboWeiss] {
        assert_eq!(
            refuse(&sphere(1), derived),
            format!("{derived} of a vector field is not defined on this domain: found a curved surface; expected a planar or volume mesh")
        );
        assert!(refuse(&grid([4, 1, 1]), derived).contains("found a curve;"));
    }
    assert!(refuse(&grid([3, 3, 3]), Derived::OkuboWeiss).contains("found a volume; expected a planar mesh"));
    let bumpy = mapped(&grid([5, 5, 1]), |p| [p[0], p[1], if p == [2.0, 2.0, 0.0] { 1e-3 } else { 0.0 }]);
    assert!(refuse(&bumpy, Derived::Vorticity).contains("a curved surface"));
}

#[test]
fn broken_vector_fields_are_refused_with_the_place() {
    let complex = grid([3, 3, 1]);
    let mut vectors = vec![[1.0; 3]; 8];
    let error = derive(&complex, &vectors, Derived::Magnitude).unwrap_err();
    assert_eq!(error, OperatorError::LengthMismatch { expected: 9, found: 8 });
    vectors.push([0.0, f64::NAN, 0.0]);
    let error = derive(&complex, &vectors, Derived::Vorticity).unwrap_err();
    assert_eq!(error.to_string(), "component 1 of the field at vertex 8 is NaN; expected a finite number: mask the point");
    assert!(gradients(&complex, &[0.0; 2]).is_err() && vertex_gradients(&complex, &[f64::INFINITY; 9]).is_err());
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let complex = jittered([90, 80, 1], 0.3, 6);
    let mut noise = Noise(9);
    let vectors: Vec<[f64; 3]> = (0..complex.vertex_count()).map(|_| [0; 3].map(|_| noise.next())).collect();
    let [one, four] = with_threads(|| derive(&complex, &vectors, Derived::OkuboWeiss).unwrap());
    assert_eq!(one, four);
}
