//! The diagram as data: pairs, essential classes, counts.

use crate::field::VertexId;
use crate::mesh::Cell;

use super::super::error::MorseError;

/// A homology class of the sublevel sets: born with one critical cell, dead with another one, or never.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct PersistencePair {
    /// The critical cell that creates the class; its dimension is that of the class.
    pub birth: Cell,
    /// The critical cell that fills the class, of one dimension more; `None` for an essential class.
    pub death: Option<Cell>,
    /// Highest vertex of `birth`: the class is born at its value.
    pub birth_vertex: VertexId,
    /// Highest vertex of `death`: the class dies at its value.
    pub death_vertex: Option<VertexId>,
    /// Dimension of the class: 0 for components, 1 for tunnels, 2 for cavities, 3 for closed 3-manifolds.
    pub dimension: u8,
}

impl PersistencePair {
    /// Whether the class lives on in the whole domain.
    pub fn is_essential(&self) -> bool {
        self.death.is_none()
    }

    /// `h(death) - h(birth)`, at least 0, in the units of the field; `None` for an essential class.
    ///
    /// # Arguments
    /// * `values`: the `n` values from which the vertex order was taken.
    pub fn persistence(&self, values: &[f64]) -> Option<f64> {
        self.death_vertex.map(|death| values[death.index()] - values[self.birth_vertex.index()])
    }
}

/// The persistence diagram of the sublevel sets of a field, in all dimensions.
///
/// Classes that are born and die at the same vertex are left out. Equal values at different vertices are different
/// heights, by simulation of simplicity: such pairs are listed and have persistence 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PersistenceDiagram {
    pub(super) dimension: usize,
    pub(super) pairs: Vec<PersistencePair>,
    pub(super) critical_counts: [usize; 4],
    pub(super) instant_counts: [usize; 4],
    pub(super) highest_vertex: Option<VertexId>,
}

impl PersistenceDiagram {
    /// Dimension of the domain.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// All pairs and essential classes by birth: cells by their vertices from the highest on, a face before its cofaces.
    ///
    /// The first one is the essential class of the global minimum.
    pub fn pairs(&self) -> &[PersistencePair] {
        &self.pairs
    }

    /// Pairs and essential classes of one dimension, by birth.
    pub fn of_dimension(&self, dimension: usize) -> impl Iterator<Item = &PersistencePair> {
        self.pairs.iter().filter(move |pair| pair.dimension as usize == dimension)
    }

    /// Number of classes that die, by dimension.
    pub fn finite_counts(&self) -> [usize; 4] {
        self.counts(|pair| !pair.is_essential())
    }

    /// Number of classes that never die, by dimension: components, tunnels, cavities of the domain (modulo 2).
    pub fn betti_numbers(&self) -> [usize; 4] {
        self.counts(PersistencePair::is_essential)
    }

    /// The global maximum, on the boundary or not: where TTK lets essential classes end. `None` without any cell.
    pub fn highest_vertex(&self) -> Option<VertexId> {
        self.highest_vertex
    }

    /// Number of critical cells by dimension of the gradient from which the diagram was read.
    pub fn critical_counts(&self) -> [usize; 4] {
        self.critical_counts
    }

    /// Number of pairs of critical cells with one highest vertex, by dimension of the class. They are not listed.
    ///
    /// There are none on manifolds: the gradient pairs all such cells. Elsewhere a lower link may have no perfect
    /// gradient.
    pub fn instant_counts(&self) -> [usize; 4] {
        self.instant_counts
    }

    /// Persistence of all classes that die, of any dimension, in the order of [`pairs`](Self::pairs).
    ///
    /// # Arguments
    /// * `values`: the `n` values from which the vertex order was taken.
    pub fn persistences(&self, values: &[f64]) -> impl Iterator<Item = f64> {
        self.pairs.iter().filter_map(|pair| pair.persistence(values))
    }

    /// Checks that every critical cell is in one place of the diagram, and that Betti numbers and critical cells
    /// alternate to the same Euler characteristic.
    ///
    /// # Errors
    /// [`MorseError::Euler`].
    ///
    /// # Source
    /// Forman 1998, corollary 3.7 (Morse inequalities).
    pub fn check_euler(&self) -> Result<(), MorseError> {
        let (finite, betti) = (self.finite_counts(), self.betti_numbers());
        let used = [0, 1, 2, 3].map(|dimension| {
            let ending = |dimension: usize| finite[dimension] + self.instant_counts[dimension];
            betti[dimension] + ending(dimension) + if dimension > 0 { ending(dimension - 1) } else { 0 }
        });
        let alternating = |counts: [usize; 4]| counts.into_iter().rev().fold(0, |sum, count| count as i64 - sum);
        let (found, expected) = (alternating(used), alternating(self.critical_counts));
        if used == self.critical_counts && alternating(betti) == expected {
            Ok(())
        } else {
            Err(MorseError::Euler { counts: used, found, expected })
        }
    }

    fn counts(&self, wanted: impl Fn(&PersistencePair) -> bool) -> [usize; 4] {
        let mut counts = [0; 4];
        for pair in self.pairs.iter().filter(|pair| wanted(pair)) {
            counts[pair.dimension as usize] += 1;
        }
        counts
    }
}
