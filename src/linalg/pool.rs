//! Work memory that outlives the tasks that use it.

use std::sync::{Mutex, PoisonError};

use super::Value;

/// Buffers that are free at the moment. Tasks take what they need and give it back, so that after the first round
/// nothing is allocated, and never more is held than ran at the same time.
#[derive(Debug, Default)]
pub(super) struct Pool<T> {
    free: Mutex<Vec<Vec<T>>>,
}

impl<T: Value> Pool<T> {
    pub fn new() -> Self {
        Self { free: Mutex::new(Vec::new()) }
    }

    /// A buffer of at least `length` numbers, whatever they are.
    pub fn take(&self, length: usize) -> Vec<T> {
        if length == 0 {
            return Vec::new();
        }
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let fitting = (0..free.len()).filter(|&place| free[place].len() >= length).min_by_key(|&place| free[place].len());
        let largest = (0..free.len()).max_by_key(|&place| free[place].len());
        match fitting.or(largest).map(|place| free.swap_remove(place)) {
            Some(buffer) if buffer.len() >= length => buffer,
            too_short => {
                drop(free);
                // Freed before the longer one is made: both together would be the peak of a whole solve.
                drop(too_short);
                vec![T::of(0.0); length]
            }
        }
    }

    /// Takes a buffer back.
    pub fn give(&self, buffer: Vec<T>) {
        if !buffer.is_empty() {
            self.free.lock().unwrap_or_else(PoisonError::into_inner).push(buffer);
        }
    }
}
