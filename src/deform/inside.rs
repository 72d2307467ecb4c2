//! A shape that is well inside every cone, where one can be told without a solve.

use super::polar::mean_rotation;
use super::{DeformError, Deformer, Hold};
use crate::linalg::small::Square;

/// Least eigenvalue of `sym(RᵀF)` of every element.
const ROOM: f64 = 0.1;

impl Deformer {
    /// The rest shape as a whole, turned by the mean of the rotations, if that lies well inside every cone: if no rotation is within 6 degrees of a
    /// quarter turn against the mean, or beyond, and no element is folded. It comes to lie where the handles are in the mean.
    ///
    /// # Arguments
    /// * `reference`: see [`Deformer::reference`].
    ///
    /// # Returns
    /// Displacements from the reference; `None` too where handles are hard, since then it is no point of the problem.
    ///
    /// # Errors
    /// As [`RestShape::smallest_eigenvalues`](super::RestShape::smallest_eigenvalues).
    pub(super) fn turned_rest(&self, rotations: &[Square<3>], reference: &[f64]) -> Result<Option<Vec<f64>>, DeformError> {
        if self.options().hold == Hold::Hard {
            return Ok(None);
        }
        let dimension = self.rest().dimension();
        let turn = mean_rotation(rotations, self.rest().measures());
        let rest = self.rest().positions();
        let mut centres = [[0.0; 3]; 2];
        for vertex in self.handles() {
            for (centre, list) in centres.iter_mut().zip([&rest, reference]) {
                let place = &list[vertex.index() * dimension..][..dimension];
                centre.iter_mut().zip(place).for_each(|(slot, part)| *slot += part / self.handles().len() as f64);
            }
        }
        let turned = |index: usize| {
            let (vertex, axis) = (index / dimension, index % dimension);
            let sum: f64 = (0..dimension).map(|j| turn[axis][j] * (rest[vertex * dimension + j] - centres[0][j])).sum();
            centres[1][axis] + sum
        };
        let positions: Vec<f64> = (0..reference.len()).map(turned).collect();
        let smallest = self.rest().smallest_eigenvalues(rotations, &positions)?;
        let is_inside = smallest.iter().all(|&least| least >= ROOM);
        Ok(is_inside.then(|| positions.iter().zip(reference).map(|(place, base)| place - base).collect()))
    }
}
