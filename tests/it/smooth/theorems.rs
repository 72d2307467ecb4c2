//! What must hold for every field: symmetries, bounds, determinism.

use morsmooth::field::VertexId;
use morsmooth::mesh::SimplicialComplex;
use morsmooth::monotone::{EdgeSet, Strategy};
use morsmooth::morse::{Selection, Threshold};
use morsmooth::smooth::{ExtremumValues, Length, SelectOn, SmoothError, SmoothOptions, smooth};

use super::judged;
use crate::morse::meshes;

fn noise(number: usize) -> f64 {
    let mut bits = (number as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Hills under noise on a grid with a hole.
fn hills() -> (SimplicialComplex, Vec<f64>) {
    let (width, height) = (26, 22);
    let complex = meshes::masked_grid(width, height, |x, y| !((9..13).contains(&x) && (8..12).contains(&y)));
    let value = |i: usize| ((i % width) as f64 / 4.0).sin() * ((i / width) as f64 / 3.0).cos() + 0.25 * noise(i);
    (complex, (0..width * height).map(value).collect())
}

fn above(part: f64) -> SmoothOptions<'static> {
    SmoothOptions::new(Selection::Threshold(Threshold::Fraction(part)))
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

#[test]
fn values_may_be_scaled_and_shifted() {
    let (complex, data) = hills();
    for select_on in [SelectOn::Data, SelectOn::Smooth] {
        let options = SmoothOptions { select_on, ..above(0.15) };
        let first = judged(&complex, &data, &options).unwrap();
        for (scale, shift) in [(1e8, 0.0), (1e-8, 0.0), (1.0, 1000.0), (3.0, -7.0)] {
            let scaled: Vec<f64> = data.iter().map(|value| value * scale + shift).collect();
            let second = judged(&complex, &scaled, &options).unwrap();
            assert_eq!(first.wanted, second.wanted, "{scale} {shift}");
            let back: Vec<f64> = second.values.iter().map(|value| (value - shift) / scale).collect();
            // The gap of the solver is 1e-8 of the energy, so values agree to about its root.
            let distance = rms(&first.values, &back);
            assert!(distance < 2e-4, "{scale} {shift}: {distance}");
            let energies = (first.report.energy.result, second.report.energy.result / (scale * scale));
            assert!((energies.0 / energies.1 - 1.0).abs() < 1e-6, "{energies:?}");
        }
    }
}

#[test]
fn powers_of_two_change_no_digit() {
    let (complex, data) = hills();
    let first = judged(&complex, &data, &above(0.15)).unwrap();
    for scale in [2f64.powi(30), 2f64.powi(-40), 2f64.powi(900), 2f64.powi(-900)] {
        let scaled: Vec<f64> = data.iter().map(|value| value * scale).collect();
        let second = judged(&complex, &scaled, &above(0.15)).unwrap();
        assert!(first.values.iter().zip(&second.values).all(|(a, b)| a * scale == *b), "{scale:e}");
        assert_eq!(first.report.energy.above_bound, second.report.energy.above_bound);
    }
}

#[test]
fn coordinates_may_be_scaled_and_moved() {
    let (complex, data) = hills();
    let options = above(0.15);
    let first = judged(&complex, &data, &options).unwrap();
    for (scale, shift) in [(1e8, 0.0), (1e-8, 0.0), (1.0, 1e5)] {
        let points = complex.points().iter().map(|point| point.map(|x| x * scale + shift)).collect();
        let moved = SimplicialComplex::new(2, points, complex.simplices().to_vec()).unwrap();
        let second = judged(&moved, &data, &options).unwrap();
        assert_eq!(first.wanted, second.wanted);
        assert!((second.report.length.absolute / scale / first.report.length.absolute - 1.0).abs() < 1e-6);
        let distance = rms(&first.values, &second.values);
        assert!(distance < 2e-4, "{scale} {shift}: {distance}");
    }
}

#[test]
fn extrema_swap_when_the_field_is_turned_over() {
    let (complex, data) = hills();
    let upside_down: Vec<f64> = data.iter().map(|value| -value).collect();
    for strategy in [Strategy::SmoothThenSimplify, Strategy::Flood, Strategy::Separatrix, Strategy::Harmonic] {
        let options = SmoothOptions { strategy, ..above(0.2) };
        let (up, down) = (judged(&complex, &data, &options).unwrap(), judged(&complex, &upside_down, &options).unwrap());
        assert_eq!((&up.wanted.minima, &up.wanted.maxima), (&down.wanted.maxima, &down.wanted.minima));
        let (bound, other) = (up.report.energy.bound, down.report.energy.bound);
        assert!((bound / other - 1.0).abs() < 1e-6, "{bound} {other}");
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let (complex, data) = hills();
    let with = |threads: usize, options: &SmoothOptions<'_>| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| judged(&complex, &data, options).unwrap().values)
    };
    for strategy in [Strategy::SmoothThenSimplify, Strategy::Separatrix, Strategy::Harmonic] {
        let options = SmoothOptions { strategy, refine: 1, select_on: SelectOn::Smooth, ..above(0.1) };
        let one = with(1, &options);
        for threads in [2, 3] {
            assert!(one.iter().zip(with(threads, &options)).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
    }
}

#[test]
fn energies_are_ordered() {
    let (complex, data) = hills();
    for order in 1..=4 {
        for strategy in [Strategy::SmoothThenSimplify, Strategy::Flood, Strategy::Harmonic] {
            let energy = |edges: EdgeSet, values: ExtremumValues| {
                let options = SmoothOptions { order, strategy, edges, values, length: Length::OfDiagonal(0.05), ..above(0.2) };
                let report = judged(&complex, &data, &options).unwrap().report;
                assert!(report.energy.unconstrained <= report.energy.bound * (1.0 + 1e-9));
                assert!(report.energy.bound <= report.energy.result * (1.0 + 1e-9), "order {order}: {:?}", report.energy);
                (report.energy.result, report.representative.used)
            };
            let (few, all) = (energy(EdgeSet::Minimal, ExtremumValues::Keep), energy(EdgeSet::All, ExtremumValues::Keep));
            // More constraints cannot help; each solve may end a gap above its optimum.
            assert!(few.1 != all.1 || few.0 <= all.0 * (1.0 + 1e-5), "order {order}, {strategy}: {few:?} {all:?}");
            let free = energy(EdgeSet::Minimal, ExtremumValues::Free);
            assert!(free.1 != few.1 || free.0 <= few.0 * (1.0 + 1e-5));
        }
    }
}

#[test]
fn refinement_is_monotone() {
    let (complex, data) = hills();
    for strategy in [Strategy::Flood, Strategy::Separatrix, Strategy::Harmonic] {
        for edges in [EdgeSet::Minimal, EdgeSet::All] {
            let options = SmoothOptions { strategy, edges, refine: 5, length: Length::OfDiagonal(0.06), ..above(0.3) };
            let rounds = judged(&complex, &data, &options).unwrap().report.energy.rounds;
            assert!(!rounds.is_empty() && rounds.len() <= 6);
            assert!(rounds.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-6)), "{strategy}: {rounds:?}");
        }
    }
}

#[test]
fn a_field_that_is_smooth_already_hardly_moves() {
    let complex = meshes::grid(21, 21);
    let data: Vec<f64> = (0..441).map(|i| (i % 21) as f64 + 0.3 * (i / 21) as f64).collect();
    let result = judged(&complex, &data, &SmoothOptions { length: Length::OfDiagonal(0.02), ..above(0.1) }).unwrap();
    assert_eq!((result.wanted.minima, result.wanted.maxima), (vec![VertexId(0)], vec![VertexId(440)]));
    assert!(result.report.change.rms_of_range < 0.01);
}

#[test]
fn every_refusal_has_its_place() {
    let (complex, data) = hills();
    let n = data.len();
    let refusal = |data: &[f64], options: &SmoothOptions<'_>| smooth(&complex, data, options, &mut |_| {}).unwrap_err();
    assert!(matches!(refusal(&data[1..], &above(0.1)), SmoothError::Field(_)));
    let empty = SimplicialComplex::new(2, vec![[0.0; 3]], Vec::new()).unwrap();
    let nothing = smooth(&empty, &[1.0], &above(0.1), &mut |_| {}).unwrap_err();
    assert_eq!(nothing, SmoothError::Empty { vertices: 1, simplices: 0 });
    let mut broken = data.clone();
    broken[17] = f64::NAN;
    assert_eq!(refusal(&broken, &above(0.1)).vertices(), [VertexId(17)]);
    let flat = vec![4.0; n];
    assert_eq!(refusal(&flat, &above(0.1)), SmoothError::Constant { vertex: VertexId(0), vertices: n - 16, value: 4.0 });
    let options = SmoothOptions { confidence: Some(&data[1..]), ..above(0.1) };
    assert_eq!(refusal(&data, &options), SmoothError::OptionLength { option: "confidence", expected: n, found: n - 1 });
    let zeros = vec![0.0; n];
    let options = SmoothOptions { confidence: Some(&zeros), ..above(0.1) };
    assert!(matches!(refusal(&data, &options), SmoothError::NoConfidence { .. }));
    let options = SmoothOptions { order: 5, ..above(0.1) };
    assert!(matches!(refusal(&data, &options), SmoothError::OptionRange { option: "order", .. }));
    let options = SmoothOptions { length: Length::Absolute(1e200), ..above(0.1) };
    assert_eq!(refusal(&data, &options), SmoothError::LengthPower { length: 1e200, power: 4 });
    let wide: Vec<f64> = data.iter().map(|value| value * 1e308).collect();
    assert!(matches!(refusal(&wide, &above(0.1)), SmoothError::Range { .. }));
    let options = SmoothOptions { select_on: SelectOn::Smooth, ..SmoothOptions::new(Selection::Count(1)) };
    assert!(matches!(refusal(&data, &options), SmoothError::Morse(_)));
}

#[test]
fn the_ends_of_a_line_keep_their_values() {
    use morsmooth::mesh::{Domain, Grid, Mask};
    let domain = Domain::from_grid(&Grid::image([60, 1, 1], [0.0; 3], [0.1, 1.0, 1.0]), &Mask::none()).unwrap();
    let data: Vec<f64> = (0..60).map(|i| (0.4 * f64::from(i)).sin() + 0.05 * f64::from(i * 7 % 5)).collect();
    let options = morsmooth::smooth::SmoothOptions::new(morsmooth::morse::Selection::Threshold(
        morsmooth::morse::Threshold::Fraction(0.9),
    ));
    let result = morsmooth::smooth::smooth(&domain.complex, &data, &options, &mut |_| {}).unwrap();
    // Far below the threshold, but no field is without them: they keep place, kind and value like all others.
    assert!(result.report.unavoidable > 0);
    assert_eq!((result.values[0], result.values[59]), (data[0], data[59]));
}

#[test]
fn an_island_with_hardly_any_room_does_not_stall_the_solver() {
    use morsmooth::mesh::{Domain, Grid, Mask};
    use morsmooth::qp::QpStatus;
    // 25 x 20 points of noise, a gap, and 3 x 3 points whose values differ by next to nothing: the start has slacks of 1e-13.
    let keep = (0..29 * 20).map(|point| point % 29 < 25 || (point % 29 > 25 && point / 29 < 3)).collect();
    let mask = Mask { keep_points: Some(keep), keep_cells: None };
    let domain = Domain::from_grid(&Grid::image([29, 20, 1], [0.0; 3], [1.0; 3]), &mask).unwrap();
    let data: Vec<f64> = domain
        .point_of_vertex()
        .iter()
        .map(|&point| match point % 29 < 25 {
            true => (f64::from(point) * 12.9898).sin() * 43_758.547 % 1.0,
            false => 0.25 + 1e-12 * f64::from(point * 7 % 11),
        })
        .collect();
    let threshold = morsmooth::morse::Threshold::Fraction(0.1);
    let options = morsmooth::smooth::SmoothOptions {
        length: morsmooth::smooth::Length::OfDiagonal(0.03),
        ..morsmooth::smooth::SmoothOptions::new(morsmooth::morse::Selection::Threshold(threshold))
    };
    let result = morsmooth::smooth::smooth(&domain.complex, &data, &options, &mut |_| {}).unwrap();
    assert_eq!(result.report.solver.status, QpStatus::Solved);
    assert!(result.report.energy.above_bound < 0.2, "{}", result.report.energy.above_bound);
}
