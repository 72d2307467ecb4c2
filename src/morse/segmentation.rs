//! Segmentations of the vertices: by minimum, by maximum, and by both.

use rayon::prelude::*;

use crate::field::VertexId;

const NONE: u32 = u32::MAX;

/// Every vertex with the extremum at the end of its V-path.
///
/// Labelled by minimum, the vertices of one label are those of one ascending manifold; labelled by maximum, those of one
/// descending manifold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Segmentation {
    extrema: Vec<VertexId>,
    labels: Vec<u32>,
}

impl Segmentation {
    /// # Arguments
    /// * `labels`: a place in `extrema` for every vertex, or `u32::MAX`.
    pub(super) fn new(extrema: Vec<VertexId>, labels: Vec<u32>) -> Self {
        Self { extrema, labels }
    }

    /// The extrema, by rising vertex; a label is a place in this list.
    pub fn extrema(&self) -> &[VertexId] {
        &self.extrema
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.labels.len()
    }

    /// The label of a vertex; `None` for a vertex of no simplex.
    pub fn label(&self, vertex: VertexId) -> Option<u32> {
        Some(self.labels[vertex.index()]).filter(|&label| label != NONE)
    }

    /// Number of vertices of every label.
    ///
    /// # Cost
    /// Linear.
    pub fn sizes(&self) -> Vec<usize> {
        let mut sizes = vec![0; self.extrema.len()];
        for &label in self.labels.iter().filter(|&&label| label != NONE) {
            sizes[label as usize] += 1;
        }
        sizes
    }
}

/// The Morse–Smale segmentation: vertices with the same minimum and the same maximum.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MorseSmaleSegmentation {
    pairs: Vec<[u32; 2]>,
    labels: Vec<u32>,
}

impl MorseSmaleSegmentation {
    /// Overlays two segmentations.
    ///
    /// # Arguments
    /// * `minima`, `maxima`: segmentations of the same vertices.
    ///
    /// # Panics
    /// If they are of different numbers of vertices.
    ///
    /// # Cost
    /// O(n log n) for n vertices, in parallel; 16 bytes a vertex while it runs.
    pub fn new(minima: &Segmentation, maxima: &Segmentation) -> Self {
        assert_eq!(minima.labels.len(), maxima.labels.len(), "segmentations of the same vertices");
        let both: Vec<[u32; 2]> =
            minima.labels.par_iter().zip(&maxima.labels).map(|(&minimum, &maximum)| [minimum, maximum]).collect();
        let mut pairs: Vec<[u32; 2]> = both.par_iter().copied().filter(|pair| !pair.contains(&NONE)).collect();
        pairs.par_sort_unstable();
        pairs.dedup();
        let label = |pair: &[u32; 2]| pairs.binary_search(pair).map_or(NONE, |place| place as u32);
        let labels = both.par_iter().map(label).collect();
        Self { pairs, labels }
    }

    /// The labels of minimum and maximum of every region, by rising pair; the label of a region is its place here.
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// The label of a vertex; `None` for a vertex of no simplex.
    pub fn label(&self, vertex: VertexId) -> Option<u32> {
        Some(self.labels[vertex.index()]).filter(|&label| label != NONE)
    }
}
