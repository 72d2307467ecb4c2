//! Simplification alone: exactly the wanted extrema and pairs, under plain `<`, near the data.

use morsmooth::audit::{Plateaus, ValueRule, Wanted, audit};
use morsmooth::field::{Precision, VertexId, VertexOrder};
use morsmooth::mesh::SimplicialComplex;
use morsmooth::monotone::flood_field;
use morsmooth::morse::{ExtremumKind, Selection, Threshold, extremum_pairs};
use morsmooth::smooth::{MeasuredField, Simplified, SmoothError, simplify};
use proptest::prelude::*;

use crate::morse::meshes::{cubes, grid, line, masked_grid, noise, random_part, sphere, torus};

/// Simplifies and judges: a broken promise panics.
fn judged(complex: &SimplicialComplex, data: &[f64], selection: Selection, precision: Precision) -> Result<Simplified, SmoothError> {
    let result = simplify(complex, data, &[selection], precision, &mut |_| {})?.remove(0);
    let is_kept = |vertex: &VertexId| result.rules[vertex.index()] != morsmooth::monotone::ValueRule::Free;
    let ruled = |vertices: &[VertexId]| -> Vec<_> {
        let rule = |vertex: &VertexId| is_kept(vertex).then(|| ValueRule::Exactly(precision.round(data[vertex.index()])));
        vertices.iter().map(|vertex| (*vertex, rule(vertex))).collect()
    };
    let (minima, maxima) = (ruled(&result.wanted.minima), ruled(&result.wanted.maxima));
    let verdict = audit(complex, &result.values, &Wanted { minima: &minima, maxima: &maxima, plateaus: Plateaus::Refused }).unwrap();
    assert!(verdict.passed, "{verdict:?}\n{data:?}");
    for [a, b] in complex.edges() {
        assert_ne!(result.values[a.index()], result.values[b.index()], "a tie along an edge");
    }
    if precision == Precision::F32 {
        assert!(result.values.iter().all(|&value| f64::from(value as f32) == value));
    }
    // By values alone: no pair but those of the wanted extrema.
    let after = MeasuredField::new(complex, result.values.clone()).unwrap();
    assert_eq!(after.minima.len() + after.maxima.len(), minima.len() + maxima.len());
    assert_eq!(result.report.pairs.found, minima.len() + maxima.len());
    assert!(after.minima.iter().chain(&after.maxima).all(|pair| pair.persistence(&after.values).is_none_or(|p| p > 0.0)));
    Ok(result)
}

fn above(threshold: f64) -> Selection {
    Selection::Threshold(Threshold::Absolute(threshold))
}

/// On curves the pairs left are those of the data, birth and death to the last bit; on surfaces and in volumes nearly all
/// are, and none moves by more than what was removed beside it.
#[test]
fn pairs_above_the_threshold_are_hardly_touched() {
    for (complex, least) in [
        (line(200), 1.0),
        (sphere(9), 0.95),
        (torus(17), 0.95),
        (grid(25, 20), 0.8),
        (masked_grid(24, 24, |x, y| (x / 4 + y / 4) % 5 != 0), 0.8),
        (cubes([9, 8, 7]), 0.9),
    ] {
        let (mut found, mut same) = (0, 0);
        for seed in 0..6 {
            let data = noise(complex.vertex_count(), seed, 1 << 40);
            for threshold in [0.05, 0.2, 0.4, 0.7] {
                let pairs = judged(&complex, &data, above(threshold), Precision::F64).unwrap().report.pairs;
                assert!(pairs.largest_change <= 2.0 * threshold, "{pairs:?}");
                (found, same) = (found + pairs.found, same + pairs.same);
            }
        }
        assert!(same as f64 >= least * found as f64, "{same} of {found}, dimension {}", complex.dimension());
    }
}

/// A crater whose rim is an unwanted hill of its own: cut down to its outer pass, it would run over too early.
#[test]
fn a_crater_keeps_its_depth() {
    let (size, centre) = (25usize, 12.0);
    let complex = grid(size, size);
    let data: Vec<f64> = (0..size * size)
        .map(|i| {
            let (x, y) = ((i % size) as f64, (i / size) as f64);
            let r = ((x - centre).powi(2) + (y - centre).powi(2)).sqrt();
            let tilt = 1e-4 * (x + 0.1 * y);
            let angle = 0.25 * (1.0 + (x - centre) / (r + 1e-9));
            match r {
                r if r < 1.0 => 5.0,
                r if r < 4.0 => 5.0 + 1.2 * r + tilt,
                r if r < 6.0 => 10.0 + angle + tilt,
                _ if (x, y) == (2.0, 22.0) => 0.0,
                _ if (x, y) == (22.0, 22.0) => 100.0,
                _ => 9.7 + tilt,
            }
        })
        .collect();
    let order = VertexOrder::of_values(&data).unwrap();
    let centre = VertexId((12 * size + 12) as u32);
    let death = |values: &[f64], order: &VertexOrder| {
        let pair = extremum_pairs(&complex, order, ExtremumKind::Minimum).into_iter().find(|pair| pair.extremum == centre);
        values[pair.unwrap().saddle.unwrap().index()]
    };
    let result = judged(&complex, &data, above(2.0), Precision::F64).unwrap();
    assert_eq!((result.wanted.minima.len(), result.wanted.maxima.len()), (2, 1), "the rim is not wanted");
    let (flooded, level) = flood_field(&complex, &data, &order, &result.wanted);
    assert!(flooded.valid && death(&level, &flooded.order) < death(&data, &order), "a plain flood lowers the rim");
    let after = VertexOrder::of_values(&result.values).unwrap();
    assert_eq!(death(&result.values, &after), death(&data, &order));
    assert_eq!(result.report.pairs.same, result.report.pairs.found);
}

#[test]
fn values_away_from_what_is_removed_stay() {
    // One pit of depth 1 in a slope.
    let complex = grid(20, 20);
    let mut data: Vec<f64> = (0..400).map(|i| (i % 20) as f64 + 1e-3 * (i / 20) as f64).collect();
    let pit = 10 * 20 + 10;
    data[pit] -= 2.5;
    let result = judged(&complex, &data, above(2.0), Precision::F64).unwrap();
    let changed: Vec<usize> = (0..400).filter(|&i| result.values[i] != data[i]).collect();
    assert_eq!(changed, [pit]);
    assert_eq!(result.report.change.vertices, 1);
    assert!((result.report.change.rms - result.report.change.largest / 20.0).abs() < 1e-12);
    // Nothing to remove: nothing changes.
    let same = judged(&complex, &data, above(0.0), Precision::F64).unwrap();
    assert_eq!((same.values, same.report.change.largest), (data, 0.0));
}

#[test]
fn several_thresholds_are_each_what_they_are_alone() {
    let complex = grid(24, 24);
    let data = noise(576, 3, 64);
    let selections = [above(0.1), above(0.5), Selection::Count(9)];
    let together = simplify(&complex, &data, &selections, Precision::F32, &mut |_| {}).unwrap();
    for (selection, result) in selections.iter().zip(&together) {
        let alone = judged(&complex, &data, selection.clone(), Precision::F32).unwrap();
        assert_eq!((&alone.values, &alone.wanted), (&result.values, &result.wanted));
    }
}

#[test]
fn contradictions_and_empty_domains_are_refused() {
    // On a line the pit between two hills cannot go while both stay: the second hill is above the first all the way.
    let complex = line(5);
    let data = [0.0, 4.0, 3.0, 5.0, 1.0];
    let set = Selection::Set([0, 1, 3, 4].map(VertexId).to_vec());
    let error = simplify(&complex, &data, &[set], Precision::F64, &mut |_| {}).unwrap_err();
    assert!(matches!(error, SmoothError::Representative(_) | SmoothError::Contradiction(_)), "{error:?}");
    let constant = simplify(&complex, &[2.0; 5], &[above(0.0)], Precision::F64, &mut |_| {}).unwrap_err();
    assert!(matches!(constant, SmoothError::Constant { vertices: 5, .. }), "{constant:?}");
    let nothing = simplify(&complex, &data, &[above(-1.0)], Precision::F64, &mut |_| {}).unwrap_err();
    assert!(matches!(nothing, SmoothError::Morse(_)), "{nothing:?}");
}

proptest! {
    /// Ties, boundary, holes, pinched vertices, several components, dimensions 1 to 3: the right field, or a typed refusal
    /// where the domain admits none.
    #[test]
    fn exactly_the_wanted_pairs((complex, values) in random_part(), threshold in 0.0..0.9f64, single in any::<bool>()) {
        let precision = if single { Precision::F32 } else { Precision::F64 };
        let data: Vec<f64> = values.iter().map(|&value| precision.round(value)).collect();
        match judged(&complex, &data, above(threshold), precision) {
            Ok(_) | Err(SmoothError::Constant { .. }) => {}
            Err(error) => prop_assert!(false, "{error:?}"),
        }
    }
}
