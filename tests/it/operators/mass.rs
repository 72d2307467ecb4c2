//! The lumped mass.

use crate::mesh::shapes::{grid, jittered, mapped, sphere, turned, with_threads};
use morsmooth::mesh::SimplicialComplex;
use morsmooth::operators::lumped_mass;

#[test]
fn it_sums_to_the_measure_of_the_mesh() {
    for (complex, measure) in [
        (jittered([9, 1, 1], 0.3, 1), 8.0),
        (mapped(&jittered([8, 7, 1], 0.3, 2), turned), 42.0),
        (jittered([5, 4, 6], 0.15, 3), 60.0),
    ] {
        let mass = lumped_mass(&complex).unwrap();
        assert!(mass.iter().all(|&share| share > 0.0));
        assert!((mass.iter().sum::<f64>() - measure).abs() < 1e-12 * measure);
    }
    // An inscribed polyhedron of 512 triangles has about 2 % less area than its sphere.
    let area: f64 = lumped_mass(&sphere(3)).unwrap().iter().sum();
    assert!((area / (4.0 * std::f64::consts::PI) - 0.98).abs() < 0.01, "{area}");
}

#[test]
fn known_shares() {
    assert_eq!(lumped_mass(&grid([3, 1, 1])).unwrap(), [0.5, 1.0, 0.5]);
    let square = lumped_mass(&grid([2, 2, 1])).unwrap();
    for (share, expected) in square.iter().zip([1.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 3.0]) {
        assert!((share - expected).abs() < 1e-16);
    }
    // A vertex of no simplex has none.
    let loose = SimplicialComplex::new(1, vec![[0.0; 3], [9.0; 3], [1.0, 0.0, 0.0]], vec![0, 2]).unwrap();
    assert_eq!(lumped_mass(&loose).unwrap(), [0.5, 0.0, 0.5]);
}

#[test]
fn it_scales_with_the_unit_of_length() {
    for complex in [grid([4, 1, 1]), jittered([5, 6, 1], 0.3, 4), jittered([4, 4, 4], 0.15, 5)] {
        let unit = lumped_mass(&complex).unwrap();
        for scale in [1e-8f64, 1e8] {
            let scaled = lumped_mass(&mapped(&complex, |p| p.map(|part| part * scale))).unwrap();
            for (a, b) in unit.iter().zip(scaled) {
                let expected = a * scale.powi(complex.dimension() as i32);
                assert!((expected - b).abs() < 1e-13 * expected);
            }
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let complex = jittered([90, 80, 1], 0.3, 6);
    let [one, four] = with_threads(|| lumped_mass(&complex).unwrap());
    assert_eq!(one, four);
}
