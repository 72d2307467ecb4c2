//! Partition of unity: weights that sum to one at every vertex.

use rayon::prelude::*;

use crate::monotone::{NotRepresentable, Strictness, repair};
use crate::qp::Objective;

use super::InterpolateError;
use super::controlled::{Controlled, Frame};
use super::method::InterpolateOptions;

/// Most turns of division and return.
const MOST_TURNS: usize = 100;
/// Turns without progress after which no more are tried.
const PATIENCE: usize = 10;

/// Divides the weights at every vertex by their sum.
///
/// # Arguments
/// * `weights`: one list of `n` numbers a handle.
///
/// # Returns
/// The largest distance of a sum from 1 before.
///
/// # Errors
/// [`InterpolateError::NoPartition`] where the sum is not positive.
///
/// # Cost
/// O(n h) for h handles.
pub fn normalise(weights: &mut [Vec<f64>]) -> Result<f64, InterpolateError> {
    let n = weights.first().map_or(0, Vec::len);
    let sums = sums(weights);
    if let Some(vertex) = (0..n).find(|&vertex| sums[vertex].is_nan() || sums[vertex] <= 0.0) {
        return Err(InterpolateError::NoPartition { vertex: vertex.into(), sum: sums[vertex] });
    }
    weights.par_iter_mut().for_each(|weights| weights.iter_mut().zip(&sums).for_each(|(weight, sum)| *weight /= sum));
    Ok(sums.iter().map(|sum| (sum - 1.0).abs()).fold(0.0, f64::max))
}

/// The largest distance of a sum of weights from 1.
pub fn distance_from_unity(weights: &[Vec<f64>]) -> f64 {
    sums(weights).iter().map(|sum| (sum - 1.0).abs()).fold(0.0, f64::max)
}

fn sums(weights: &[Vec<f64>]) -> Vec<f64> {
    let n = weights.first().map_or(0, Vec::len);
    // By rising handle, whatever the number of threads.
    (0..n).into_par_iter().with_min_len(4096).map(|vertex| weights.iter().map(|weights| weights[vertex]).sum()).collect()
}

/// Moves monotone weights, in turns, to a sum of one and back to an order with their extrema.
///
/// Each way back is along the order of the divided weights themselves, flooded to the wanted extrema: it moves what division spoiled, and
/// little else. The last move is the exact repair, so that every weight keeps its extrema; the sums are as near to 1 as the turns brought
/// them.
///
/// # Returns
/// The number of turns.
pub(super) fn normalise_in_order(
    weights: &mut [Vec<f64>],
    frames: &mut [Frame],
    (objective, options): (&Objective, &InterpolateOptions),
    tolerance: f64,
) -> Result<usize, InterpolateError> {
    let mut least = f64::INFINITY;
    let mut without_progress = 0;
    for turn in 1.. {
        let distance = normalise(weights)?;
        without_progress = if distance < 0.9 * least { 0 } else { without_progress + 1 };
        least = least.min(distance);
        let is_last = distance <= tolerance || turn >= MOST_TURNS || without_progress >= PATIENCE;
        let moved: Result<(), InterpolateError> = weights.par_iter_mut().zip(frames.par_iter_mut()).try_for_each(|(weights, frame)| {
            let Frame { contraction, directions } = frame;
            let controlled = Controlled::new(contraction, objective, options);
            let mut nodes = controlled.led_back(weights, directions);
            if is_last {
                let repaired = repair(&directions.graph, &nodes, &controlled.rules, options.precision, Strictness::Plain);
                let vertex = |found: NotRepresentable| contraction.member[found.vertex.index()];
                nodes = repaired.map_err(|found| InterpolateError::NotRepresentable { vertex: vertex(found) })?.values;
            }
            *weights = contraction.spread(&nodes);
            Ok(())
        });
        moved?;
        if is_last {
            return Ok(turn);
        }
    }
    Ok(MOST_TURNS)
}

/// Keeps the greatest weights at every vertex, of equal ones those of earlier handles, and divides them by their sum.
///
/// # Arguments
/// * `most`: how many are kept, at least 1.
///
/// # Returns
/// The largest sum of weights that was cut off at a vertex.
///
/// # Errors
/// [`InterpolateError::NoPartition`] where none of the greatest weights is positive.
///
/// # Cost
/// O(n h log h).
pub fn keep_strongest(weights: &mut [Vec<f64>], most: usize) -> Result<f64, InterpolateError> {
    let n = weights.first().map_or(0, Vec::len);
    let mut largest: f64 = 0.0;
    let mut order: Vec<usize> = Vec::with_capacity(weights.len());
    for vertex in 0..n {
        order.clear();
        order.extend(0..weights.len());
        order.sort_by(|&a, &b| weights[b][vertex].total_cmp(&weights[a][vertex]).then(a.cmp(&b)));
        let (kept, cut) = order.split_at(most.max(1).min(order.len()));
        let lost: f64 = cut.iter().map(|&handle| weights[handle][vertex].abs()).sum();
        largest = largest.max(lost);
        if lost == 0.0 {
            continue;
        }
        let sum: f64 = kept.iter().map(|&handle| weights[handle][vertex]).sum();
        if sum.is_nan() || sum <= 0.0 {
            return Err(InterpolateError::NoPartition { vertex: vertex.into(), sum });
        }
        kept.iter().for_each(|&handle| weights[handle][vertex] /= sum);
        cut.iter().for_each(|&handle| weights[handle][vertex] = 0.0);
    }
    Ok(largest)
}
