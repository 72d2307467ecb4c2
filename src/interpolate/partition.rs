//! Partition of unity: weights that sum to one at every vertex.

use rayon::prelude::*;

use crate::monotone::{NotRepresentable, Precision, Strictness, repair, sweep};

use super::InterpolateError;
use super::controlled::Frame;

/// Most turns of normalisation and sweep.
const MOST_TURNS: usize = 200;

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

/// Moves monotone weights, in turns, to a sum of one and back to their order: alternating projections onto two convex sets.
///
/// The last move is the exact repair, so that every weight keeps its extrema; the sums are as near to 1 as the turns brought them.
///
/// # Returns
/// The number of turns.
pub(super) fn normalise_in_order(
    weights: &mut [Vec<f64>],
    frames: &[Frame],
    precision: Precision,
    tolerance: f64,
) -> Result<usize, InterpolateError> {
    let mut turns = 0;
    let mut before = f64::INFINITY;
    loop {
        let distance = normalise(weights)?;
        turns += 1;
        // Slow progress means that the two sets hardly meet.
        let is_done = distance <= tolerance || turns >= MOST_TURNS || (turns % 20 == 0 && distance > 0.98 * before);
        if turns % 20 == 0 {
            before = distance;
        }
        let moved: Result<(), InterpolateError> = weights
            .par_iter_mut()
            .zip(frames)
            .try_for_each(|(weights, frame)| {
                let nodes: Vec<f64> = frame.member.iter().map(|vertex| weights[vertex.index()]).collect();
                let swept = sweep(&frame.graph, &frame.levels, &nodes);
                let nodes = match is_done {
                    false => swept,
                    true => repair(&frame.graph, &swept, &frame.rules, precision, Strictness::Plain)
                        .map_err(|NotRepresentable { vertex }| InterpolateError::NotRepresentable { vertex: frame.member[vertex.index()] })?
                        .values,
                };
                weights.iter_mut().zip(&frame.node).for_each(|(weight, &node)| *weight = nodes[node as usize]);
                Ok(())
            });
        moved?;
        if is_done {
            return Ok(turns);
        }
    }
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
