//! A column of a boundary matrix modulo 2 while it is reduced: cells to come, the highest first.

use std::collections::BinaryHeap;

/// An entry of a column: the rank of the highest vertex, then whether the cell is not critical, then its number.
///
/// V-paths never rise, so when the cells that are not critical come first among those of one highest vertex, no entry
/// that follows can add a critical cell above one that has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Entry(u64);

const PASSING: u64 = 1 << 32;

/// What an entry stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A critical cell, by its place in the order.
    Row(u32),
    /// A cell that V-paths pass through, by its number.
    Passing(u32),
}

impl Entry {
    /// # Arguments
    /// * `level`: rank of the highest vertex of the cell; below 2^31.
    /// * `place`: place of the critical cell in the order.
    pub(super) fn row(level: u32, place: u32) -> Self {
        Self(u64::from(level) << 33 | u64::from(place))
    }

    /// # Arguments
    /// * `level`: rank of the highest vertex of the cell; below 2^31.
    /// * `index`: number of the cell.
    pub(super) fn passing(level: u32, index: u32) -> Self {
        Self(u64::from(level) << 33 | PASSING | u64::from(index))
    }

    pub(super) fn kind(self) -> Kind {
        let number = self.0 as u32;
        if self.0 & PASSING == 0 { Kind::Row(number) } else { Kind::Passing(number) }
    }
}

/// Sums of at least this many entries are kept as sorted runs, shorter ones go to the heap: most columns of noise never
/// have a run, and long columns of long cycles are added as fast as they can be read.
const RUN: usize = 48;

/// A column in work. An entry that is there an even number of times is not there.
#[derive(Debug, Default)]
pub(super) struct Column {
    heap: BinaryHeap<Entry>,
    /// Each rising, each less than half as long as the one before it when it came.
    runs: Vec<Vec<Entry>>,
}

impl Column {
    pub(super) fn add(&mut self, entry: Entry) {
        self.heap.push(entry);
    }

    /// # Arguments
    /// * `entries`: rising, as [`take`](Self::take) returns them.
    pub(super) fn add_all(&mut self, entries: &[Entry]) {
        if entries.len() < RUN {
            self.heap.extend(entries);
            return;
        }
        let mut run = entries.to_vec();
        while let Some(last) = self.runs.pop_if(|last| last.len() < 2 * run.len()) {
            run = sum(&last, &run);
        }
        self.runs.push(run);
    }

    /// Takes the highest entry out.
    pub(super) fn pop(&mut self) -> Option<Entry> {
        loop {
            let of_runs = self.runs.iter().filter_map(|run| run.last()).max();
            let entry = *of_runs.max(self.heap.peek())?;
            let mut odd = false;
            while self.heap.peek() == Some(&entry) {
                self.heap.pop();
                odd = !odd;
            }
            for run in &mut self.runs {
                if run.pop_if(|last| *last == entry).is_some() {
                    odd = !odd;
                }
            }
            if odd {
                return Some(entry);
            }
        }
    }

    /// Takes all entries out, each once, rising.
    pub(super) fn take(&mut self) -> Box<[Entry]> {
        let mut entries: Vec<Entry> = self.heap.drain().collect();
        entries.sort_unstable();
        let mut kept = 0;
        let mut at = 0;
        while at < entries.len() {
            let entry = entries[at];
            let count = entries[at..].iter().take_while(|&&other| other == entry).count();
            if count % 2 == 1 {
                entries[kept] = entry;
                kept += 1;
            }
            at += count;
        }
        entries.truncate(kept);
        while let Some(run) = self.runs.pop() {
            entries = sum(&run, &entries);
        }
        entries.into_boxed_slice()
    }
}

/// The entries that are in one of two rising lists but not in both, rising.
fn sum(one: &[Entry], other: &[Entry]) -> Vec<Entry> {
    let mut merged = vec![Entry(0); one.len() + other.len()];
    let (mut a, mut b, mut kept) = (0, 0, 0);
    while a < one.len() && b < other.len() {
        // Without branches, since which list comes next cannot be predicted.
        let (x, y) = (one[a], other[b]);
        merged[kept] = x.min(y);
        kept += usize::from(x != y);
        a += usize::from(x <= y);
        b += usize::from(y <= x);
    }
    merged.truncate(kept);
    merged.extend_from_slice(&one[a..]);
    merged.extend_from_slice(&other[b..]);
    merged
}
