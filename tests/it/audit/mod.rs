//! The judge: right on its own, and not fooled by planted defects.

mod orientation;

use morsmooth::audit::{
    ExtremumType, LISTED_DEFECTS, MovedValue, Plateaus, ValueRule, Wanted, audit, extrema, strict_extrema,
};
use morsmooth::field::{FieldError, VertexId, VertexOrder};
use morsmooth::mesh::SimplicialComplex;
use proptest::prelude::*;

use crate::morse::meshes;

fn ids(vertices: &[u32]) -> Vec<VertexId> {
    vertices.iter().map(|&vertex| VertexId(vertex)).collect()
}

/// A smooth field with one minimum and one maximum on a grid, and what it is asked to be.
fn ramp() -> (SimplicialComplex, Vec<f64>) {
    let grid = meshes::grid(11, 7);
    let values = (0..77).map(|vertex| f64::from(vertex % 11) + 0.1 * f64::from(vertex / 11)).collect();
    (grid, values)
}

const MINIMA: [(VertexId, Option<ValueRule>); 1] = [(VertexId(0), Some(ValueRule::Exactly(0.0)))];
const MAXIMA: [(VertexId, Option<ValueRule>); 1] = [(VertexId(76), Some(ValueRule::Within(10.0, 11.0)))];

fn wanted() -> Wanted<'static> {
    Wanted { minima: &MINIMA, maxima: &MAXIMA, plateaus: Plateaus::Refused }
}

#[test]
fn what_was_asked_for_passes() {
    let (grid, values) = ramp();
    let report = audit(&grid, &values, &wanted()).unwrap();
    assert!(report.passed);
    assert_eq!((report.found_minima, report.found_maxima), (1, 1));
    assert!(report.missing.is_empty() && report.spurious.is_empty());
    assert!(report.moved_values.is_empty() && report.plateaus.is_empty());
}

#[test]
fn one_raised_vertex_anywhere_is_found() {
    let (grid, values) = ramp();
    for vertex in 1..76 {
        for (change, kind) in [(30.0, ExtremumType::Maximum), (-30.0, ExtremumType::Minimum)] {
            let mut broken = values.clone();
            broken[vertex] += change;
            let report = audit(&grid, &broken, &wanted()).unwrap();
            assert!(!report.passed);
            assert!(report.spurious.first.contains(&(VertexId::from(vertex), kind)));
        }
    }
}

#[test]
fn the_least_possible_bump_is_found() {
    let (grid, values) = ramp();
    let mut broken = values.clone();
    let vertex = VertexId(38);
    let highest = grid.neighbours(vertex).iter().map(|w| values[w.index()]).fold(f64::MIN, f64::max);
    broken[38] = highest.next_up();
    let report = audit(&grid, &broken, &wanted()).unwrap();
    assert_eq!(report.spurious.first, [(vertex, ExtremumType::Maximum)]);
    broken[38] = highest.next_down();
    assert!(audit(&grid, &broken, &wanted()).unwrap().passed);
}

#[test]
fn a_moved_extremum_is_missing_at_one_place_and_spurious_at_another() {
    let (grid, mut values) = ramp();
    values[1] = -1.0;
    let report = audit(&grid, &values, &wanted()).unwrap();
    assert!(!report.passed);
    assert_eq!(report.missing.first, [(VertexId(0), ExtremumType::Minimum)]);
    assert_eq!(report.spurious.first, [(VertexId(1), ExtremumType::Minimum)]);
    assert!(report.moved_values.is_empty());
}

#[test]
fn an_extremum_of_the_wrong_kind_does_not_count() {
    let (grid, values) = ramp();
    let swapped = Wanted { minima: &[(VertexId(76), None)], maxima: &[(VertexId(0), None)], ..Wanted::default() };
    let report = audit(&grid, &values, &swapped).unwrap();
    assert_eq!((report.missing.count, report.spurious.count), (2, 2));
}

#[test]
fn a_value_off_by_the_last_bit_is_found() {
    let (grid, mut values) = ramp();
    values[0] = -f64::MIN_POSITIVE;
    let report = audit(&grid, &values, &wanted()).unwrap();
    assert!(!report.passed);
    let moved = MovedValue { vertex: VertexId(0), found: values[0], rule: ValueRule::Exactly(0.0) };
    assert_eq!(report.moved_values.first, [moved]);
    values[0] = -0.0;
    assert!(audit(&grid, &values, &wanted()).unwrap().passed, "the two zeros are equal");
    values[76] = 11.0f64.next_up();
    assert_eq!(audit(&grid, &values, &wanted()).unwrap().moved_values.count, 1);
}

#[test]
fn a_plateau_fails_unless_it_is_allowed() {
    let (grid, mut values) = ramp();
    // Two equal vertices at the foot: (value, index) order sees one minimum, plain `<` none, `<=` two.
    values[1] = 0.0;
    let report = audit(&grid, &values, &wanted()).unwrap();
    assert!(!report.passed);
    assert_eq!(report.plateaus.first, ids(&[0, 1]));
    assert!(report.spurious.is_empty() && report.missing.is_empty());
    assert!(audit(&grid, &values, &Wanted { plateaus: Plateaus::Allowed, ..wanted() }).unwrap().passed);
    // Equal neighbours on a slope are no plateau.
    let (grid, mut values) = ramp();
    values[38] = values[39];
    assert!(audit(&grid, &values, &wanted()).unwrap().passed);
}

#[test]
fn rounding_to_single_precision_is_seen() {
    let line = meshes::line(4);
    let values = [0.0, 1.0, 1.0 + 1e-9, 2.0];
    let minima = [(VertexId(0), None)];
    let maxima = [(VertexId(3), None)];
    let wanted = Wanted { minima: &minima, maxima: &maxima, ..Wanted::default() };
    assert!(audit(&line, &values, &wanted).unwrap().passed);
    let reversed = [0.0, 1.0 + 1e-9, 1.0, 2.0];
    assert_eq!(audit(&line, &reversed, &wanted).unwrap().spurious.count, 2);
    let stored = reversed.map(|value| f64::from(value as f32));
    let report = audit(&line, &stored, &wanted).unwrap();
    assert!(report.spurious.is_empty(), "the stored values are judged, not the computed ones");
    assert_eq!((report.passed, report.plateaus.first), (false, ids(&[1, 2])), "rounding made two neighbours equal");
}

#[test]
fn long_lists_are_capped_but_counted() {
    let line = meshes::line(1001);
    let values: Vec<f64> = (0..1001).map(|vertex| f64::from(vertex % 2)).collect();
    let report = audit(&line, &values, &Wanted::default()).unwrap();
    assert_eq!((report.found_minima, report.found_maxima, report.spurious.count), (501, 500, 1001));
    assert_eq!(report.spurious.first.len(), LISTED_DEFECTS);
}

#[test]
fn vertices_that_do_not_exist_or_are_isolated_are_missing() {
    let complex = SimplicialComplex::new(1, vec![[0.0; 3]; 3], vec![0, 1]).unwrap();
    let minima = [(VertexId(0), None), (VertexId(2), None), (VertexId(9), Some(ValueRule::Exactly(1.0)))];
    let wanted = Wanted { minima: &minima, maxima: &[(VertexId(1), None)], ..Wanted::default() };
    let report = audit(&complex, &[0.0, 1.0, -5.0], &wanted).unwrap();
    let kind = ExtremumType::Minimum;
    assert_eq!(report.missing.first, [(VertexId(2), kind), (VertexId(9), kind)]);
    assert!(!report.passed);
}

#[test]
fn fields_that_are_none_are_refused() {
    let (grid, mut values) = ramp();
    let short = audit(&grid, &values[1..], &wanted());
    assert_eq!(short, Err(FieldError::LengthMismatch { expected: 77, found: 76 }));
    values[5] = f64::INFINITY;
    let infinite = FieldError::NonFinite { vertex: VertexId(5), value: f64::INFINITY };
    assert_eq!(audit(&grid, &values, &wanted()), Err(infinite.clone()));
    assert_eq!(extrema(&grid, &values), Err(infinite.clone()));
    assert_eq!(strict_extrema(&grid, &values), Err(infinite));
}

#[test]
fn a_constant_field_is_one_plateau() {
    let grid = meshes::grid(4, 4);
    let values = vec![1.0; 16];
    let strict = strict_extrema(&grid, &values).unwrap();
    assert!(strict.minima.is_empty() && strict.maxima.is_empty());
    assert_eq!(strict.plateaus.len(), 16);
    let ordered = extrema(&grid, &values).unwrap();
    assert_eq!((ordered.minima, ordered.maxima), (ids(&[0]), ids(&[15])));
}

proptest! {
    #[test]
    fn extrema_are_the_vertices_without_lower_or_higher_neighbours((complex, values) in meshes::random_field()) {
        let order = VertexOrder::of_values(&values).unwrap();
        let inhabited = |vertex: &VertexId| !complex.neighbours(*vertex).is_empty();
        let all: Vec<VertexId> = (0..values.len()).map(VertexId::from).filter(inhabited).collect();
        let neighbours = |vertex: VertexId| complex.neighbours(vertex).iter().copied();
        let minima: Vec<VertexId> =
            all.iter().copied().filter(|&v| neighbours(v).all(|w| order.is_below(v, w))).collect();
        let maxima: Vec<VertexId> =
            all.iter().copied().filter(|&v| neighbours(v).all(|w| order.is_below(w, v))).collect();
        let found = extrema(&complex, &values).unwrap();
        prop_assert_eq!(&found.minima, &minima);
        prop_assert_eq!(&found.maxima, &maxima);

        let value = |vertex: VertexId| values[vertex.index()];
        let strict = strict_extrema(&complex, &values).unwrap();
        let weak = |v: VertexId| {
            let none_below = neighbours(v).all(|w| value(w) >= value(v));
            let none_above = neighbours(v).all(|w| value(w) <= value(v));
            (none_below, none_above)
        };
        let plateaus: Vec<VertexId> = all
            .iter()
            .copied()
            .filter(|&v| weak(v) != (false, false) && neighbours(v).any(|w| value(w) == value(v)))
            .collect();
        prop_assert_eq!(&strict.plateaus, &plateaus);
        if plateaus.is_empty() {
            prop_assert_eq!(strict.minima, found.minima);
            prop_assert_eq!(strict.maxima, found.maxima);
        }
    }

    #[test]
    fn extrema_swap_when_the_field_is_turned_over((complex, values) in meshes::random_field()) {
        // Strict extrema know no ties, so they swap exactly.
        let upside_down: Vec<f64> = values.iter().map(|value| -value).collect();
        let (up, down) =
            (strict_extrema(&complex, &values).unwrap(), strict_extrema(&complex, &upside_down).unwrap());
        prop_assert_eq!((up.minima, up.maxima, up.plateaus), (down.maxima, down.minima, down.plateaus));
    }
}
