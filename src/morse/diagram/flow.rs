//! Where unique V-paths end: from vertices down to minima, from facets up to critical top cells.

use std::sync::atomic::{AtomicU32, Ordering};

/// A step of a unique V-path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    /// To the cell of this number.
    On(u32),
    /// The path ends here, at the node of this number.
    End(u32),
}

/// Ends of V-paths, found when asked for and kept, so that all questions together take linear time.
///
/// Threads may find the same end at the same time; they all store the same number.
pub(super) struct Flow<S> {
    /// Number of the end plus one; 0 while it is unknown.
    ends: Vec<AtomicU32>,
    step: S,
}

impl<S: Fn(u32) -> Step + Sync> Flow<S> {
    /// # Arguments
    /// * `numbers`: one more than the greatest number of a cell.
    /// * `step`: where the path goes on from a cell.
    pub(super) fn new(numbers: usize, step: S) -> Self {
        Self { ends: (0..numbers).map(|_| AtomicU32::new(0)).collect(), step }
    }

    /// The node in which the path from a cell ends.
    pub(super) fn end(&self, start: u32) -> u32 {
        let known = |cell: u32| self.ends[cell as usize].load(Ordering::Relaxed);
        let mut cell = start;
        let end = loop {
            match known(cell) {
                0 => match (self.step)(cell) {
                    Step::On(next) => cell = next,
                    Step::End(end) => break end + 1,
                },
                end => break end,
            }
        };
        let mut cell = start;
        while known(cell) == 0 {
            self.ends[cell as usize].store(end, Ordering::Relaxed);
            match (self.step)(cell) {
                Step::On(next) => cell = next,
                Step::End(_) => break,
            }
        }
        end - 1
    }
}
