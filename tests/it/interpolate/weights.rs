//! Skinning weights of all handles together: sums, pruning, the coupled problem.

use super::{block, comb, tips_of_comb, of_handles};
use crate::mesh::shapes::with_threads;
use morsmooth::field::VertexId;
use morsmooth::interpolate::{
    InterpolateError, Interpolator, Method, Partition, SkinningWeights, WeightOptions, distance_from_unity, keep_strongest, normalise,
    skinning_weights,
};

fn weights(order: usize, method: Method, partition: Partition) -> SkinningWeights {
    let complex = comb();
    let given = of_handles(&tips_of_comb(&complex));
    let mut interpolator = Interpolator::new(&complex, order).unwrap();
    let options = WeightOptions { method, partition, ..WeightOptions::default() };
    skinning_weights(&mut interpolator, &given, &options).unwrap()
}

#[test]
fn monotone_weights_keep_their_extrema_when_they_are_normalised() {
    for order in [2, 3] {
        let free = weights(order, Method::Monotone, Partition::Free);
        assert!(free.reports.iter().all(|report| report.extrema.passed && report.divided.is_none()));
        let normalised = weights(order, Method::Monotone, Partition::Normalised);
        assert!(normalised.reports.iter().all(|report| report.extrema.passed), "{:?}", normalised.reports);
        assert!(normalised.turns > 0);
        assert!(normalised.off_unity.1 <= normalised.off_unity.0.max(1e-12), "{:?}", normalised.off_unity);
        assert_eq!(normalised.off_unity.1, distance_from_unity(&normalised.weights));
    }
}

#[test]
fn bounded_weights_sum_to_one_after_division() {
    let found = weights(2, Method::Bounded, Partition::Normalised);
    assert!(found.off_unity.1 < 1e-14);
    assert!(found.weights.iter().flatten().all(|&weight| (0.0..=1.0).contains(&weight)));
}

#[test]
fn the_coupled_problem_keeps_both() {
    for order in [1, 2] {
        let coupled = weights(order, Method::Monotone, Partition::Coupled);
        for report in &coupled.reports {
            assert!(report.extrema.passed, "order {order}: {:?}", report.extrema);
        }
        assert!(coupled.off_unity.1 < 1e-9, "order {order}: {:?}", coupled.off_unity);
        // Constraints cost energy against the best of each handle alone.
        let polyharmonic = weights(order, Method::Polyharmonic, Partition::Free);
        assert!(coupled.energy >= polyharmonic.energy * (1.0 - 1e-6), "order {order}");
    }
}

#[test]
fn two_handles_couple_to_one_function_and_its_complement() {
    let complex = block();
    let given = of_handles(&[vec![VertexId(0), VertexId(1)], vec![VertexId(209)]]);
    let mut interpolator = Interpolator::new(&complex, 2).unwrap();
    let options = WeightOptions { partition: Partition::Coupled, ..WeightOptions::default() };
    let found = skinning_weights(&mut interpolator, &given, &options).unwrap();
    for (a, b) in found.weights[0].iter().zip(&found.weights[1]) {
        assert!((a + b - 1.0).abs() < 1e-10);
    }
    assert!(found.reports.iter().all(|report| report.extrema.passed));
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let [one, four] = with_threads(|| weights(2, Method::Monotone, Partition::Normalised).weights);
    assert_eq!(one, four);
}

#[test]
fn the_strongest_are_kept_and_sum_to_one() {
    let mut weights = vec![vec![0.5, 0.1], vec![0.3, 0.1], vec![0.2, 0.1], vec![0.0, 0.7]];
    let cut = keep_strongest(&mut weights, 2).unwrap();
    assert!((cut - 0.2).abs() < 1e-15);
    // Of equal weights those of earlier handles stay.
    assert_eq!(weights.iter().map(|column| column[0] > 0.0).collect::<Vec<_>>(), [true, true, false, false]);
    assert_eq!(weights.iter().map(|column| column[1] > 0.0).collect::<Vec<_>>(), [true, false, false, true]);
    assert!(distance_from_unity(&weights) < 1e-15);
    let before = weights.clone();
    assert_eq!(keep_strongest(&mut weights, 2).unwrap(), 0.0);
    assert_eq!(weights, before);
    assert!(matches!(normalise(&mut [vec![0.0]]), Err(InterpolateError::NoPartition { .. })));
}
