//! Wanted extrema with data to stay close to: what is known of the result without them, and refusals.

use super::{block, comb};
use crate::mesh::shapes::{Noise, grid, with_threads};
use morsmooth::audit::extrema;
use morsmooth::field::VertexId;
use morsmooth::interpolate::{InterpolateError, InterpolateOptions, Interpolated, Interpolator, Nearness, interpolate_near};
use morsmooth::mesh::SimplicialComplex;
use morsmooth::monotone::{EnergyWeights, Fitter, ValueRule};
use morsmooth::morse::WantedExtrema;

/// Waves under noise.
fn noisy(complex: &SimplicialComplex, seed: u64) -> Vec<f64> {
    let mut noise = Noise(seed);
    complex.points().iter().map(|p| (0.7 * p[0]).sin() + 0.3 * p[1] + 0.2 * p[2] + 0.3 * noise.next()).collect()
}

fn extrema_of(complex: &SimplicialComplex, values: &[f64]) -> WantedExtrema {
    let found = extrema(complex, values).unwrap();
    WantedExtrema { minima: found.minima, maxima: found.maxima }
}

fn solve(complex: &SimplicialComplex, wanted: &WantedExtrema, rules: &[ValueRule], near: &Nearness<'_>, order: usize) -> Interpolated {
    let interpolator = Interpolator::new(complex, order).unwrap();
    interpolate_near(&interpolator, wanted, rules, near, &InterpolateOptions::default()).unwrap()
}

#[test]
fn the_extrema_of_the_minimiser_itself_give_the_minimiser() {
    for complex in [comb(), block()] {
        let n = complex.vertex_count();
        let data = noisy(&complex, 3);
        let mut confidence = vec![1.0; n];
        (n / 3..n / 2).for_each(|vertex| confidence[vertex] = 0.0);
        for order in 1..=2 {
            for confidence in [None, Some(&confidence[..])] {
                let near = Nearness { data: &data, length: 1.5, confidence };
                let interpolator = Interpolator::new(&complex, order).unwrap();
                let weights = EnergyWeights { order, length: near.length, confidence, smoothness: None };
                let free = Fitter::new(&complex, interpolator.operators(), order).unwrap().minimiser(&data, &weights, &vec![None; n]).unwrap();
                let wanted = extrema_of(&complex, &free);
                let found = solve(&complex, &wanted, &vec![ValueRule::Free; n], &near, order);
                let off = found.values.iter().zip(&free).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 2e-3, "order {order}: {off}");
                let real = extrema(&complex, &found.values).unwrap();
                assert_eq!((real.minima, real.maxima), (wanted.minima, wanted.maxima));
            }
        }
    }
}

#[test]
fn fewer_extrema_cost_closeness_and_given_values_are_kept() {
    let complex = grid([18, 14, 1]);
    let n = complex.vertex_count();
    let data = noisy(&complex, 8);
    let near = |length: f64| Nearness { data: &data, length, confidence: None };
    let wanted = WantedExtrema { minima: vec![VertexId(0)], maxima: vec![VertexId(n as u32 - 1)] };
    let mut rules = vec![ValueRule::Free; n];
    rules[n - 1] = ValueRule::Within(6.0, 7.0);
    rules[0] = ValueRule::Exactly(-2.0);
    let squares = |values: &[f64]| values.iter().zip(&data).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    let (close, far) = (solve(&complex, &wanted, &rules, &near(0.3), 2), solve(&complex, &wanted, &rules, &near(6.0), 2));
    assert!(squares(&close.values) < squares(&far.values) && close.report.energy > far.report.energy);
    for found in [&close, &far] {
        let real = extrema(&complex, &found.values).unwrap();
        assert_eq!((real.minima.as_slice(), real.maxima.as_slice()), (&wanted.minima[..], &wanted.maxima[..]));
        assert!(found.values[0] == -2.0 && (6.0..=7.0).contains(&found.values[n - 1]));
    }
    // More extrema leave the data nearer.
    let all = extrema_of(&complex, &data);
    assert!(squares(&solve(&complex, &all, &vec![ValueRule::Free; n], &near(0.3), 2).values) < squares(&close.values));
    let [one, more] = with_threads(|| solve(&complex, &wanted, &rules, &near(1.0), 2).values);
    assert!(one == more);
}

#[test]
fn what_is_out_of_range_is_refused() {
    let complex = grid([6, 5, 1]);
    let n = complex.vertex_count();
    let interpolator = Interpolator::new(&complex, 2).unwrap();
    let wanted = WantedExtrema { minima: vec![VertexId(0)], maxima: vec![VertexId(29)] };
    let rules = vec![ValueRule::Free; n];
    let data: Vec<f64> = (0..n).map(|vertex| vertex as f64).collect();
    let refuse = |near: &Nearness<'_>| {
        interpolate_near(&interpolator, &wanted, &rules, near, &InterpolateOptions::default()).unwrap_err().to_string()
    };
    let near = Nearness { data: &data, length: 1.0, confidence: None };
    assert_eq!(refuse(&Nearness { data: &data[1..], ..near }), "29 data; expected 30");
    assert_eq!(refuse(&Nearness { length: 0.0, ..near }), "the length at 0 is 0; expected a positive number");
    let mut broken = data.clone();
    broken[7] = f64::NAN;
    assert_eq!(refuse(&Nearness { data: &broken, ..near }), "the data at 7 is NaN; expected a finite number");
    let mut confidence = vec![0.0; n];
    assert_eq!(refuse(&Nearness { confidence: Some(&confidence), ..near }), "the confidence at 0 is 0; expected one above 0 at least");
    confidence[4] = -1.0;
    assert_eq!(refuse(&Nearness { confidence: Some(&confidence), ..near }), "the confidence at 4 is -1; expected a number not below 0");
    // Two parts, of which the second has neither data nor values.
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [7.0, 0.0, 0.0]];
    let lines = SimplicialComplex::new(1, points.to_vec(), vec![0, 1, 1, 2, 3, 4, 4, 5]).unwrap();
    let ends = WantedExtrema { minima: vec![VertexId(0), VertexId(3)], maxima: vec![VertexId(2), VertexId(5)] };
    let near = Nearness { data: &data[..6], length: 1.0, confidence: Some(&[1.0, 1.0, 1.0, 0.0, 0.0, 0.0]) };
    let interpolator = Interpolator::new(&lines, 1).unwrap();
    let found = interpolate_near(&interpolator, &ends, &[ValueRule::Free; 6], &near, &InterpolateOptions::default());
    assert!(matches!(found, Err(InterpolateError::NoScale { vertex: VertexId(3), .. })), "{found:?}");
}
