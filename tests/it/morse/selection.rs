//! Which extrema are wanted: thresholds, numbers, sets, and what is refused.

use morsmooth::field::{VertexId, VertexOrder};
use morsmooth::mesh::SimplicialComplex;
use morsmooth::morse::{
    ExtremumKind, ExtremumPair, MorseError, PersistenceCurve, Selection, Threshold, WantedExtrema, extremum_pairs,
    range, reported_persistences, select,
};
use proptest::prelude::*;

use super::meshes;

fn both(complex: &SimplicialComplex, values: &[f64]) -> (Vec<ExtremumPair>, Vec<ExtremumPair>) {
    let order = VertexOrder::of_values(values).unwrap();
    let pairs = |kind| extremum_pairs(complex, &order, kind);
    (pairs(ExtremumKind::Minimum), pairs(ExtremumKind::Maximum))
}

fn ids(vertices: &[u32]) -> Vec<VertexId> {
    vertices.iter().map(|&vertex| VertexId(vertex)).collect()
}

/// Minima 1, 3, 5 with persistences (essential), 3, 3; maxima 4, 2, 6, 0 with (essential), 3, 1, 2. Range 5.
const SERIES: [f64; 7] = [2.0, 0.0, 4.0, 1.0, 5.0, 2.0, 3.0];

fn choose(selection: &Selection) -> Result<WantedExtrema, MorseError> {
    let (minima, maxima) = both(&meshes::line(7), &SERIES);
    select(&minima, &maxima, &SERIES, selection)
}

#[test]
fn kept_is_what_exceeds_the_threshold_strictly() {
    let kept = |threshold| {
        let wanted = choose(&Selection::Threshold(threshold)).unwrap();
        (wanted.minima, wanted.maxima)
    };
    assert_eq!(kept(Threshold::Absolute(0.0)), (ids(&[1, 3, 5]), ids(&[0, 2, 4, 6])));
    assert_eq!(kept(Threshold::Absolute(1.0)), (ids(&[1, 3, 5]), ids(&[0, 2, 4])));
    assert_eq!(kept(Threshold::Absolute(2.9)), (ids(&[1, 3, 5]), ids(&[2, 4])));
    assert_eq!(kept(Threshold::Absolute(3.0)), (ids(&[1]), ids(&[4])));
    assert_eq!(kept(Threshold::Absolute(1e300)), (ids(&[1]), ids(&[4])));
    assert_eq!(kept(Threshold::Fraction(0.2)), kept(Threshold::Absolute(1.0)));
    assert_eq!(kept(Threshold::Fraction(0.6)), (ids(&[1]), ids(&[4])));
}

#[test]
fn a_number_of_extrema_goes_by_persistence_over_both_kinds() {
    let kept = |count| {
        let wanted = choose(&Selection::Count(count)).unwrap();
        (wanted.minima, wanted.maxima)
    };
    assert_eq!(kept(2), (ids(&[1]), ids(&[4])));
    assert_eq!(kept(3), (ids(&[1, 3]), ids(&[4]))); // 3, 5 and 2 tie: minima first, the lower first
    assert_eq!(kept(4), (ids(&[1, 3, 5]), ids(&[4])));
    assert_eq!(kept(5), (ids(&[1, 3, 5]), ids(&[2, 4])));
    assert_eq!(kept(7), (ids(&[1, 3, 5]), ids(&[0, 2, 4, 6])));
}

#[test]
fn a_set_may_leave_out_the_global_extrema_of_a_connected_domain() {
    let wanted = choose(&Selection::Set(ids(&[6, 3, 3]))).unwrap();
    assert_eq!((wanted.minima, wanted.maxima), (ids(&[3]), ids(&[6])));
}

#[test]
fn impossible_choices_are_refused() {
    assert_eq!(choose(&Selection::Count(1)), Err(MorseError::TooFew { asked: 1, needed: 2 }));
    assert_eq!(choose(&Selection::Count(8)), Err(MorseError::TooMany { asked: 8, available: 7 }));
    let not_extrema = choose(&Selection::Set(ids(&[1, 4, 9, 99])));
    assert_eq!(not_extrema, Err(MorseError::NotAnExtremum { vertex: VertexId(9) }));
    let no_maximum = MorseError::ComponentWithout { kind: ExtremumKind::Maximum, component: VertexId(0) };
    assert_eq!(no_maximum.to_string(), "the component of vertex 0 keeps no maximum; expected one at least");
    assert_eq!(choose(&Selection::Set(ids(&[1]))), Err(no_maximum));
    for bad in [-0.1, f64::NAN, f64::INFINITY] {
        for threshold in [Threshold::Absolute(bad), Threshold::Fraction(bad)] {
            assert!(matches!(choose(&Selection::Threshold(threshold)), Err(MorseError::Threshold { .. })));
        }
    }
}

#[test]
fn every_component_keeps_a_minimum_and_a_maximum() {
    let two = SimplicialComplex::new(1, vec![[0.0; 3]; 6], vec![0, 1, 1, 2, 3, 4, 4, 5]).unwrap();
    let values = [0.0, 9.0, 1.0, 5.0, 5.5, 5.25];
    let (minima, maxima) = both(&two, &values);
    assert_eq!(range(&minima, &maxima, &values), 9.0);
    assert_eq!(reported_persistences(&minima, &maxima, &values), [9.0, 8.0, 0.5, 0.25]);
    assert_eq!(reported_persistences(&maxima, &minima, &values), [9.0, 0.5]);
    let wanted = select(&minima, &maxima, &values, &Selection::Threshold(Threshold::Fraction(0.95))).unwrap();
    assert_eq!((wanted.minima, wanted.maxima), (ids(&[0, 3]), ids(&[1, 4])));
    let few = select(&minima, &maxima, &values, &Selection::Count(3));
    assert_eq!(few, Err(MorseError::TooFew { asked: 3, needed: 4 }));
    let without = select(&minima, &maxima, &values, &Selection::Set(ids(&[0, 1, 4])));
    let expected = MorseError::ComponentWithout { kind: ExtremumKind::Minimum, component: VertexId(3) };
    assert_eq!(without, Err(expected));
}

proptest! {
    #[test]
    fn the_curve_counts_what_a_threshold_keeps(
        (complex, values) in meshes::random_field(),
        threshold in (0..14i32).prop_map(|half| f64::from(half) / 2.0),
    ) {
        let (minima, maxima) = both(&complex, &values);
        let curve = PersistenceCurve::new(&minima, &maxima, &values);
        let selection = Selection::Threshold(Threshold::Absolute(threshold));
        let wanted = select(&minima, &maxima, &values, &selection).unwrap();
        prop_assert_eq!(curve.at(threshold), (wanted.minima.len(), wanted.maxima.len()));
        let counted = select(&minima, &maxima, &values, &Selection::Count(wanted.minima.len() + wanted.maxima.len()));
        prop_assert_eq!(counted.unwrap(), wanted);
    }
}

#[test]
fn the_widest_gaps_of_the_curve_come_first() {
    let (minima, maxima) = both(&meshes::line(7), &SERIES);
    let curve = PersistenceCurve::new(&minima, &maxima, &SERIES);
    assert_eq!(curve.thresholds, [0.0, 1.0, 2.0, 3.0]);
    assert_eq!((curve.minima.as_slice(), curve.maxima.as_slice()), (&[3, 3, 3, 1][..], &[4, 3, 2, 1][..]));
    let values = [0.0, 1.0, 0.5, 9.0, 3.0, 10.0];
    let (minima, maxima) = both(&meshes::line(6), &values);
    let gaps = PersistenceCurve::new(&minima, &maxima, &values).widest_gaps(1);
    assert_eq!(gaps.len(), 1);
    assert_eq!((gaps[0].from, gaps[0].to, gaps[0].minima, gaps[0].maxima), (0.5, 6.0, 2, 2));
    assert_eq!((gaps[0].width(), gaps[0].ratio()), (5.5, 12.0));
}
