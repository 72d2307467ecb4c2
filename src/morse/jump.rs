//! Pointer jumping: where following successors ends, for all members of a forest at once.

use rayon::prelude::*;

/// Follows every member of a forest to its root.
///
/// # Arguments
/// * `next`: the successor of each of `0..n`, itself for a root. Numbers from `n` on are roots outside, which stay.
///
/// # Returns
/// The root of each.
///
/// # Cost
/// O(n log l) for paths of length l, in parallel; 4 bytes a member more. The result is unique, so it does not depend on
/// the number of threads.
///
/// # Source
/// JáJá 1992, *An Introduction to Parallel Algorithms*, section 2.2.
pub(super) fn roots(mut next: Vec<u32>) -> Vec<u32> {
    let mut jumped = vec![0; next.len()];
    loop {
        let moved: usize = jumped
            .par_iter_mut()
            .zip(&next)
            .map(|(slot, &at)| {
                *slot = next.get(at as usize).copied().unwrap_or(at);
                usize::from(*slot != at)
            })
            .sum();
        std::mem::swap(&mut next, &mut jumped);
        if moved == 0 {
            return next;
        }
    }
}
