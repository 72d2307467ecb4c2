//! Permutations of unknowns.

use super::FactorError;

/// A permutation of the indices `0..n`: position `new` holds the old index eliminated as number `new`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Permutation(Vec<u32>);

impl Permutation {
    /// Checks that a list names each index below its length once.
    ///
    /// # Errors
    /// [`FactorError::NotAPermutation`] with the first index that is out of range or named twice.
    pub fn new(order: Vec<u32>) -> Result<Self, FactorError> {
        let mut seen = vec![false; order.len()];
        for &old in &order {
            match seen.get_mut(old as usize) {
                Some(slot) if !*slot => *slot = true,
                _ => return Err(FactorError::NotAPermutation { index: old as usize, size: order.len() }),
            }
        }
        Ok(Self(order))
    }

    /// Wraps a list that is known to name each index once.
    pub(super) fn from_parts(order: Vec<u32>) -> Self {
        Self(order)
    }

    /// The permutation that moves nothing.
    pub fn identity(size: usize) -> Self {
        Self((0..size as u32).collect())
    }

    /// The old index at each new position.
    pub fn order(&self) -> &[u32] {
        &self.0
    }

    /// The new position of each old index.
    pub fn inverse(&self) -> Vec<u32> {
        let mut inverse = vec![0; self.0.len()];
        for (new, &old) in self.0.iter().enumerate() {
            inverse[old as usize] = new as u32;
        }
        inverse
    }

    /// Number of indices.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are no indices.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}
