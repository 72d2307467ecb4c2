//! Random small masked grids with few distinct values: the right field or a typed refusal, never a wrong field or a panic.

use morsmooth::field::{Precision, VertexId};
use morsmooth::mesh::SimplicialComplex;
use morsmooth::monotone::{EdgeSet, Strategy as Function, Strictness};
use morsmooth::morse::{Selection, Threshold};
use morsmooth::smooth::{ExtremumValues, Length, SelectOn, SmoothError, SmoothOptions};
use proptest::prelude::*;

use super::judged;
use crate::morse::meshes::masked_grid;

/// A masked grid with at least one triangle, and values with many ties.
fn masked_field() -> impl Strategy<Value = (SimplicialComplex, Vec<f64>)> {
    (2usize..9, 2usize..9).prop_flat_map(|(width, height)| {
        let points = width * height;
        (Just((width, height)), prop::collection::vec(0u8..8, points), prop::collection::vec(0i8..5, points), 0..3usize)
            .prop_filter_map("no triangle", |((width, height), shown, steps, scale)| {
                let complex = masked_grid(width, height, |x, y| shown[y * width + x] > 0);
                let scale = [1.0, 1e-7, 0.1][scale];
                let values = steps.iter().map(|&step| f64::from(step) * scale).collect();
                (complex.simplex_count() > 0).then_some((complex, values))
            })
    })
}

fn options() -> impl Strategy<Value = SmoothOptions<'static>> {
    let selection = prop_oneof![
        (0.0..1.2f64).prop_map(|part| Selection::Threshold(Threshold::Fraction(part))),
        (0.0..5.0f64).prop_map(|value| Selection::Threshold(Threshold::Absolute(value))),
        (0usize..12).prop_map(Selection::Count),
        prop::collection::vec(0u32..64, 1..6).prop_map(|set| Selection::Set(set.into_iter().map(VertexId).collect())),
    ];
    let functions = prop::sample::select(vec![Function::SmoothThenSimplify, Function::Flood, Function::Separatrix, Function::Harmonic]);
    let lengths = prop_oneof![
        1 => Just(Length::Automatic),
        3 => prop::sample::select(vec![1e-3, 0.01, 0.05, 0.2, 1.0, 30.0]).prop_map(Length::OfDiagonal),
    ];
    let values = prop_oneof![
        3 => Just(ExtremumValues::Keep),
        1 => Just(ExtremumValues::Free),
        1 => prop::sample::select(vec![0.0, 0.01, 0.05, 0.3, 2.0]).prop_map(ExtremumValues::Within),
    ];
    (selection, functions, lengths, values, 1usize..5, any::<[bool; 4]>(), 0usize..3).prop_map(
        |(selection, strategy, length, values, order, [smooth, all, single, raw], refine)| SmoothOptions {
            select_on: if smooth { SelectOn::Smooth } else { SelectOn::Data },
            strategy,
            length,
            values,
            order,
            edges: if all { EdgeSet::All } else { EdgeSet::Minimal },
            precision: if single { Precision::F32 } else { Precision::F64 },
            strictness: if raw { Strictness::TiesByIndex } else { Strictness::Plain },
            refine,
            ..SmoothOptions::new(selection)
        },
    )
}

/// Found by `thresholds_are_always_met`: a flat part on one vertex needs an extremum, whose value cannot be kept, because
/// the shared vertex has the same.
#[test]
fn a_flat_part_that_hangs_on_one_vertex() {
    let points = masked_grid(3, 3, |_, _| true).points().to_vec();
    let complex = SimplicialComplex::new(2, points, vec![0, 4, 3, 4, 5, 8]).unwrap();
    let values = [4.0, 0.0, 0.0, 4.0, 4.0, 0.0, 0.0, 0.0, 0.0];
    let options = SmoothOptions { order: 1, ..SmoothOptions::new(Selection::Threshold(Threshold::Fraction(0.0))) };
    let result = judged(&complex, &values, &options).unwrap();
    assert_eq!((result.wanted.minima, result.wanted.maxima), (vec![VertexId(0), VertexId(5)], vec![VertexId(4)]));
    assert_eq!((result.report.unavoidable, result.values[4], result.values[5]), (1, 4.0, 0.0));
    assert!(result.values[0] < 4.0);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2 * ProptestConfig::default().cases, ..ProptestConfig::default() })]

    #[test]
    fn the_right_field_or_a_refusal((complex, values) in masked_field(), options in options()) {
        if let Err(error) = judged(&complex, &values, &options) {
            prop_assert!(!error.to_string().is_empty());
            let expected = matches!(
                error,
                SmoothError::Constant { .. }
                    | SmoothError::SmoothedAway { .. }
                    | SmoothError::Morse(_)
                    | SmoothError::Representative(_)
                    | SmoothError::Contradiction(_)
                    | SmoothError::NotRepresentable { .. }
            );
            prop_assert!(expected, "{error:?}");
        }
    }

    /// A threshold on the data, in 64 bits, is always met where every part varies.
    #[test]
    fn thresholds_are_always_met((complex, values) in masked_field(), part in 0.0..1.1f64, mut options in options()) {
        options.selection = Selection::Threshold(Threshold::Fraction(part));
        options.select_on = SelectOn::Data;
        options.precision = Precision::F64;
        match judged(&complex, &values, &options) {
            Ok(_) | Err(SmoothError::Constant { .. }) => {}
            Err(error) => prop_assert!(false, "{error:?}"),
        }
    }
}
