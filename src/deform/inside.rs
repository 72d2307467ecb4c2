//! A shape that is well inside every cone, where one can be told without a solve.

use super::polar::mean_rotation;
use super::rest::CHUNK;
use super::{Deformer, Hold};
use crate::linalg::small::Square;
use rayon::prelude::*;

/// Least cosine of the angle between the rotation of an element and the mean of all rotations.
const ROOM: f64 = 0.1;

impl Deformer {
    /// The rest shape as a whole, turned by the mean of the rotations, if that lies well inside every cone: if no rotation is within 6 degrees of a
    /// quarter turn against the mean, or beyond. It comes to lie where the handles are in the mean.
    ///
    /// # Arguments
    /// * `reference`: see [`Deformer::reference`].
    ///
    /// # Returns
    /// Displacements from the reference; `None` too where handles are hard, since then it is no point of the problem.
    pub(super) fn turned_rest(&self, rotations: &[Square<3>], reference: &[f64]) -> Option<Vec<f64>> {
        if self.options().hold == Hold::Hard {
            return None;
        }
        let dimension = self.rest().dimension();
        let turn = mean_rotation(rotations, self.rest().measures());
        // The eigenvalues of the symmetric part of a rotation are the cosine of its angle and, in space, 1 and the cosine once more.
        let is_near = |rotation: &Square<3>| {
            let trace: f64 = (0..dimension).flat_map(|i| (0..dimension).map(move |j| (i, j))).map(|(i, j)| rotation[i][j] * turn[i][j]).sum();
            0.5 * (trace - if dimension == 2 { 0.0 } else { 1.0 }) >= ROOM
        };
        if !rotations.par_iter().with_min_len(CHUNK).all(is_near) {
            return None;
        }
        let rest = self.rest().positions();
        let mut centres = [[0.0; 3]; 2];
        for vertex in self.handles() {
            for (centre, list) in centres.iter_mut().zip([&rest, reference]) {
                let place = &list[vertex.index() * dimension..][..dimension];
                centre.iter_mut().zip(place).for_each(|(slot, part)| *slot += part / self.handles().len() as f64);
            }
        }
        let turned = |(index, base): (usize, &f64)| {
            let (vertex, axis) = (index / dimension, index % dimension);
            let sum: f64 = (0..dimension).map(|j| turn[axis][j] * (rest[vertex * dimension + j] - centres[0][j])).sum();
            centres[1][axis] + sum - base
        };
        Some(reference.iter().enumerate().map(turned).collect())
    }
}
