//! Orientations by exact predicates: against whole-number arithmetic, on borderline cases, and refusals.

use crate::deform::scenes;
use morsmooth::audit::{OrientationError, orientations};
use morsmooth::field::Precision;
use morsmooth::mesh::SimplicialComplex;
use proptest::prelude::*;

fn triangle(points: [[f64; 3]; 3]) -> SimplicialComplex {
    SimplicialComplex::new(2, points.to_vec(), vec![0, 1, 2]).unwrap()
}

const RIGHT: [[f64; 3]; 3] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

#[test]
fn a_mesh_at_rest_is_clean_whatever_the_order_of_corners() {
    for complex in [scenes::square(5), scenes::solid([3, 2, 4], 0.25, |_| true)] {
        for precision in [Precision::F64, Precision::F32] {
            let report = orientations(&complex, &[], complex.points(), precision).unwrap();
            assert!(report.is_clean() && (report.smallest - 1.0).abs() < 1e-5, "{report:?}");
            assert_eq!(report.elements, complex.simplex_count());
        }
        let swapped: Vec<u32> =
            complex.simplices().chunks(complex.dimension() + 1).flat_map(|c| [&[c[1], c[0]], &c[2..]].concat()).collect();
        let turned = SimplicialComplex::new(complex.dimension(), complex.points().to_vec(), swapped).unwrap();
        assert!(orientations(&turned, &[], turned.points(), Precision::F64).unwrap().is_clean());
    }
}

#[test]
fn a_mirrored_mesh_is_inverted_everywhere_unless_all_was_folded() {
    let complex = scenes::solid([2; 3], 0.5, |_| true);
    let mirrored: Vec<[f64; 3]> = complex.points().iter().map(|&[x, y, z]| [x, y, -z]).collect();
    let all: Vec<usize> = (0..complex.simplex_count()).collect();
    let report = orientations(&complex, &[], &mirrored, Precision::F64).unwrap();
    assert_eq!(report.inverted, all);
    assert!((report.smallest + 1.0).abs() < 1e-12);
    assert!(orientations(&complex, &all, &mirrored, Precision::F64).unwrap().is_clean());
}

#[test]
fn what_only_rounding_inverts_is_found_in_single_precision() {
    // The third corner is above the diagonal by less than a unit of single precision: rounded, it falls onto it.
    let rest = triangle([[0.0; 3], [1.0, 1.0, 0.0], [0.5, 0.75, 0.0]]);
    let thin = [[0.0; 3], [1.0, 1.0, 0.0], [0.5, 0.5 + 1e-12, 0.0]];
    let double = orientations(&rest, &[], &thin, Precision::F64).unwrap();
    assert!(double.is_clean() && double.smallest > 0.0 && double.smallest < 1e-10);
    let single = orientations(&rest, &[], &thin, Precision::F32).unwrap();
    assert_eq!((single.degenerate.as_slice(), single.inverted.as_slice(), single.smallest), (&[0][..], &[][..], 0.0));
}

#[test]
fn the_sign_is_exact_where_the_rounded_determinant_says_nothing() {
    // Corners on a line y = x up to one unit in the last place: the rounded cross product is zero or has the wrong sign.
    let rest = triangle(RIGHT);
    let place = 12.000_000_000_000_002;
    for steps in 0..40u32 {
        let y = f64::from_bits(12f64.to_bits() + u64::from(steps));
        let points = [[0.5, 0.5, 0.0], [place, y, 0.0], [24.0, 24.0, 0.0]];
        let report = orientations(&rest, &[], &points, Precision::F64).unwrap();
        // Twice the area is 23.5 (x - y): a point above the line y = x turns the triangle over.
        let wanted = (place - y).partial_cmp(&0.0).unwrap();
        let found = if report.degenerate == [0] { std::cmp::Ordering::Equal } else { report.smallest.partial_cmp(&0.0).unwrap() };
        assert_eq!(found, wanted, "{steps}");
    }
}

#[test]
fn refusals_name_the_place() {
    let rest = triangle(RIGHT);
    let line = SimplicialComplex::new(1, vec![[0.0; 3], [1.0, 0.0, 0.0]], vec![0, 1]).unwrap();
    let judge = |points: &[[f64; 3]], precision| orientations(&rest, &[], points, precision).unwrap_err();
    assert_eq!(orientations(&line, &[], line.points(), Precision::F64), Err(OrientationError::Dimension { found: 1 }));
    assert_eq!(judge(&RIGHT[..2], Precision::F64), OrientationError::Length { expected: 3, found: 2 });
    let mut points = RIGHT;
    points[1][1] = 1e39;
    assert!(orientations(&rest, &[], &points, Precision::F64).is_ok());
    let found = judge(&points, Precision::F32);
    assert_eq!(found, OrientationError::NotFinite { vertex: 1, axis: 1, value: 1e39 });
    assert_eq!(found.to_string(), "coordinate 1 of vertex 1 is 1000000000000000000000000000000000000000; a finite number was expected");
}

proptest! {
    #[test]
    fn signs_agree_with_whole_numbers(places in prop::collection::vec(-9i64..=9, 12)) {
        let solid = SimplicialComplex::new(
            3,
            vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            vec![0, 1, 2, 3],
        ).unwrap();
        let points: Vec<[f64; 3]> = places.chunks(3).map(|p| [p[0] as f64, p[1] as f64, p[2] as f64]).collect();
        let side = |corner: usize, axis: usize| places[3 * corner + axis] - places[axis];
        let volume = side(1, 0) * (side(2, 1) * side(3, 2) - side(2, 2) * side(3, 1))
            - side(1, 1) * (side(2, 0) * side(3, 2) - side(2, 2) * side(3, 0))
            + side(1, 2) * (side(2, 0) * side(3, 1) - side(2, 1) * side(3, 0));
        let report = orientations(&solid, &[], &points, Precision::F32).unwrap();
        prop_assert_eq!(report.inverted.len(), usize::from(volume < 0));
        prop_assert_eq!(report.degenerate.len(), usize::from(volume == 0));
        prop_assert!((report.smallest - volume as f64).abs() <= 1e-12 * volume.abs() as f64);
    }
}
