//! The vertex order: (value, vertex index), simulation of simplicity.
//!
//! Literature: Edelsbrunner, Mücke 1990, *Simulation of simplicity*.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::sort::sorted_vertices;

/// A vertex of a mesh: its place in every per-vertex array.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VertexId(pub u32);

impl VertexId {
    /// The place of the vertex in an array.
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

impl From<usize> for VertexId {
    fn from(index: usize) -> Self {
        debug_assert!(u32::try_from(index).is_ok(), "vertex {index} does not fit into 32 bits");
        Self(index as u32)
    }
}

impl std::fmt::Display for VertexId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// Why a list of numbers is not a scalar field on a given mesh, or not an order of its vertices.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FieldError {
    /// The field and the mesh disagree on the number of vertices.
    #[error("field has {found} values for {expected} vertices")]
    LengthMismatch {
        /// Number of vertices of the mesh.
        expected: usize,
        /// Number of values given.
        found: usize,
    },
    /// A value is NaN or infinite, so the vertices cannot be ordered.
    #[error("value {value} at vertex {vertex} is not finite")]
    NonFinite {
        /// The first vertex with such a value.
        vertex: VertexId,
        /// The value found there.
        value: f64,
    },
    /// A sequence that should list every vertex once leaves one out or repeats it.
    #[error("sequence of {len} vertices is not a permutation: vertex {vertex} is repeated or out of range")]
    NotAPermutation {
        /// Length of the sequence.
        len: usize,
        /// The vertex that is repeated or out of range.
        vertex: VertexId,
    },
}

/// Vertices handled by one parallel task, at least. Any number gives the same result.
const CHUNK: usize = 1 << 16;

/// Refuses a field with a value that is NaN or infinite, naming the first such vertex.
///
/// # Errors
/// [`FieldError::NonFinite`].
pub fn check_finite(values: &[f64]) -> Result<(), FieldError> {
    match values.par_iter().with_min_len(CHUNK).position_first(|value| !value.is_finite()) {
        Some(vertex) => Err(FieldError::NonFinite { vertex: vertex.into(), value: values[vertex] }),
        None => Ok(()),
    }
}

/// A strict total order of the vertices.
///
/// Taken from values, it compares (value, then vertex index), so that two equal neighbours are never both extrema.
/// `-0.0` and `0.0` are equal values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VertexOrder {
    /// `rank[v]`: number of vertices below `v`.
    rank: Vec<u32>,
    /// Vertices from lowest to highest; the inverse of `rank`.
    sequence: Vec<VertexId>,
}

impl VertexOrder {
    /// Orders vertices by (value, index).
    ///
    /// # Arguments
    /// * `values`: `n` values, one a vertex.
    ///
    /// # Errors
    /// [`FieldError::NonFinite`] if a value is NaN or infinite.
    ///
    /// # Cost
    /// O(n) time, and O(t log t) for t values that agree in the leading 32 bits of their distance from the least; in
    /// parallel. 8 bytes a vertex, 16 while it runs.
    ///
    /// # Example
    /// ```
    /// use morsmooth::field::{VertexId, VertexOrder};
    /// let order = VertexOrder::of_values(&[0.5, 0.0, 0.5])?;
    /// assert!(order.is_below(VertexId(1), VertexId(0)));
    /// assert!(order.is_below(VertexId(0), VertexId(2))); // equal values: by index
    /// # Ok::<(), morsmooth::field::FieldError>(())
    /// ```
    pub fn of_values(values: &[f64]) -> Result<Self, FieldError> {
        check_finite(values)?;
        Ok(Self::of_permutation(sorted_vertices(values)))
    }

    /// The order that lists the vertices as given, lowest first.
    ///
    /// # Errors
    /// [`FieldError::NotAPermutation`] unless `sequence` holds each of `0..n` once.
    pub fn of_sequence(sequence: Vec<VertexId>) -> Result<Self, FieldError> {
        let len = sequence.len();
        let mut seen = vec![false; len];
        for &vertex in &sequence {
            match seen.get_mut(vertex.index()) {
                Some(slot) if !*slot => *slot = true,
                _ => return Err(FieldError::NotAPermutation { len, vertex }),
            }
        }
        Ok(Self::of_permutation(sequence))
    }

    fn of_permutation(sequence: Vec<VertexId>) -> Self {
        // Relaxed is enough: every rank is written once, and read only after all tasks have joined.
        let vertices = (0..sequence.len()).into_par_iter().with_min_len(CHUNK);
        let rank: Vec<AtomicU32> = vertices.map(|_| AtomicU32::new(0)).collect();
        sequence.par_iter().with_min_len(CHUNK).enumerate().for_each(|(position, vertex)| {
            rank[vertex.index()].store(position as u32, Ordering::Relaxed);
        });
        Self { rank: rank.into_iter().map(AtomicU32::into_inner).collect(), sequence }
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.rank.len()
    }

    /// Whether there is no vertex.
    pub fn is_empty(&self) -> bool {
        self.rank.is_empty()
    }

    /// Number of vertices below `vertex`.
    pub fn rank(&self, vertex: VertexId) -> u32 {
        self.rank[vertex.index()]
    }

    /// Ranks of all vertices, by vertex.
    pub fn ranks(&self) -> &[u32] {
        &self.rank
    }

    /// All vertices, lowest first.
    pub fn sequence(&self) -> &[VertexId] {
        &self.sequence
    }

    /// Whether `a` comes before `b`.
    pub fn is_below(&self, a: VertexId, b: VertexId) -> bool {
        self.rank[a.index()] < self.rank[b.index()]
    }

    /// The order turned upside down: that of `-h`, with ties by falling index.
    pub fn reversed(&self) -> Self {
        let last = self.len().wrapping_sub(1) as u32;
        Self {
            rank: self.rank.par_iter().with_min_len(CHUNK).map(|&rank| last.wrapping_sub(rank)).collect(),
            sequence: self.sequence.par_iter().with_min_len(CHUNK).rev().copied().collect(),
        }
    }
}
