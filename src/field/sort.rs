//! The sort behind the vertex order: radix passes over packed keys, then the few that these leave undecided.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::VertexId;

/// Most bits of a digit, and passes over the 32 bits of a key.
const DIGIT: u32 = 11;
const PASSES: u32 = 3;
const BUCKETS: usize = 1 << DIGIT;

/// Fewer values are sorted by comparisons: counting buckets would cost more.
const FEW: usize = 1 << 13;

/// Values handled by one parallel task, at least. Any number gives the same result, since a pass keeps equal digits in order.
const CHUNK: usize = 1 << 16;

/// The vertices by rising (value, index), of finite values.
///
/// The bits of finite numbers, turned so that they compare as the numbers do, less those of the least and cut to the
/// leading 32 of the difference to the greatest, are sorted together with the index; what then is still equal is compared.
pub(super) fn sorted_vertices(values: &[f64]) -> Vec<VertexId> {
    let ends = values.par_iter().with_min_len(CHUNK).map(|&value| (key(value), key(value)));
    let (low, high) = ends.reduce(|| (u64::MAX, 0), |a, b| (a.0.min(b.0), a.1.max(b.1)));
    let excess = 32 - (high.saturating_sub(low)).leading_zeros().min(32);
    let pack = |(vertex, &value): (usize, &f64)| ((key(value) - low) >> excess) << 32 | vertex as u64;
    let mut packed: Vec<u64> = values.par_iter().with_min_len(CHUNK).enumerate().map(pack).collect();
    if packed.len() < FEW {
        packed.sort_unstable();
    } else {
        packed = radix_sorted(packed);
    }
    let mut sequence: Vec<VertexId> = packed.par_iter().with_min_len(CHUNK).map(|&item| VertexId(item as u32)).collect();
    if excess > 0 {
        let mut rest = &mut sequence[..];
        let mut runs = Vec::new();
        for run in packed.chunk_by(|a, b| a >> 32 == b >> 32) {
            let (run, after) = rest.split_at_mut(run.len());
            rest = after;
            if run.len() > 1 {
                runs.push(run);
            }
        }
        // All keys are different, so an unstable sort has one possible result.
        runs.into_par_iter().for_each(|run| {
            let full = |vertex: &VertexId| (key(values[vertex.index()]), vertex.0);
            if run.len() < CHUNK { run.sort_unstable_by_key(full) } else { run.par_sort_unstable_by_key(full) }
        });
    }
    sequence
}

/// A number that compares as the value does; the same for both zeros.
fn key(value: f64) -> u64 {
    let bits = (value + 0.0).to_bits();
    // Negative numbers compare in reverse.
    bits ^ ((bits as i64 >> 63) as u64 | 1 << 63)
}

/// Sorts by the upper 32 bits; the lower ones rise already where those are equal.
fn radix_sorted(items: Vec<u64>) -> Vec<u64> {
    let chunk = items.len().div_ceil(64).max(CHUNK);
    let mut from: Vec<AtomicU64> = items.into_iter().map(AtomicU64::new).collect();
    let mut to: Vec<AtomicU64> = (0..from.len()).into_par_iter().with_min_len(CHUNK).map(|_| AtomicU64::new(0)).collect();
    for pass in 0..PASSES {
        let digit = |item: &AtomicU64| {
            let item = item.load(Ordering::Relaxed);
            (item, (item >> (32 + pass * DIGIT)) as usize & (BUCKETS - 1))
        };
        let mut starts: Vec<Vec<u32>> = from
            .par_chunks(chunk)
            .map(|chunk| {
                let mut counts = vec![0; BUCKETS];
                for item in chunk {
                    counts[digit(item).1] += 1;
                }
                counts
            })
            .collect();
        if starts.iter().map(|counts| counts[digit(&from[0]).1] as usize).sum::<usize>() == from.len() {
            continue;
        }
        let mut total = 0;
        for bucket in 0..BUCKETS {
            for counts in &mut starts {
                total += std::mem::replace(&mut counts[bucket], total);
            }
        }
        // Relaxed is enough: every place is written by one task, and read only after all have joined.
        from.par_chunks(chunk).zip(starts).for_each(|(chunk, mut next)| {
            for item in chunk {
                let (item, bucket) = digit(item);
                to[next[bucket] as usize].store(item, Ordering::Relaxed);
                next[bucket] += 1;
            }
        });
        std::mem::swap(&mut from, &mut to);
    }
    drop(to);
    from.into_iter().map(AtomicU64::into_inner).collect()
}
