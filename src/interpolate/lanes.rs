//! Independent solves side by side, each lane with an engine of its own.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::qp::Engine;

/// Runs `work` for every job on as many engines as there are; at no time are there more factors than engines.
///
/// A parallel map over the jobs would give every waiting thread another engine. Which engine does a job makes no difference to it.
///
/// # Returns
/// The results in the order of the jobs, or the error of the first job that failed.
pub(super) fn in_lanes<T: Send, E: Send>(
    engines: &mut [Engine],
    jobs: usize,
    work: impl Fn(&mut Engine, usize) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let next = AtomicUsize::new(0);
    let lane = |engine: &mut Engine| {
        let mut done = Vec::new();
        loop {
            let job = next.fetch_add(1, Ordering::Relaxed);
            if job >= jobs {
                return done;
            }
            done.push((job, work(engine, job)));
        }
    };
    let mut results: Vec<(usize, Result<T, E>)> = engines.par_iter_mut().map(lane).collect::<Vec<_>>().into_iter().flatten().collect();
    results.sort_by_key(|(job, _)| *job);
    results.into_iter().map(|(_, result)| result).collect()
}
