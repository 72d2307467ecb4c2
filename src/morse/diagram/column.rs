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

/// A column in work. An entry that is there an even number of times is not there.
#[derive(Debug, Default)]
pub(super) struct Column(BinaryHeap<Entry>);

impl Column {
    pub(super) fn add(&mut self, entry: Entry) {
        self.0.push(entry);
    }

    pub(super) fn add_all(&mut self, entries: &[Entry]) {
        self.0.extend(entries);
    }

    /// Takes the highest entry out.
    pub(super) fn pop(&mut self) -> Option<Entry> {
        while let Some(entry) = self.0.pop() {
            let mut odd = true;
            while self.0.peek() == Some(&entry) {
                self.0.pop();
                odd = !odd;
            }
            if odd {
                return Some(entry);
            }
        }
        None
    }

    /// Takes all entries out, each once, by rising order.
    pub(super) fn take(&mut self) -> Box<[Entry]> {
        let mut entries: Vec<Entry> = self.0.drain().collect();
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
        entries.into_boxed_slice()
    }
}
