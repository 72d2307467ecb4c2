//! Weights of handles as a table: checks and rows of sum 1.

use super::DeformError;
use crate::mesh::Pose;

/// Weights of every vertex, rows divided by their sums on the way out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weights<'a> {
    rows: &'a [f64],
    handles: usize,
}

impl<'a> Weights<'a> {
    /// Checks lengths, and that every row has a positive sum.
    pub fn new(rows: &'a [f64], vertices: usize, pose: &Pose) -> Result<Self, DeformError> {
        let handles = pose.transforms.len();
        if handles == 0 {
            return Err(DeformError::Length { what: "transforms of handles", expected: 1, found: 0 });
        }
        if rows.len() != vertices * handles {
            return Err(DeformError::Length { what: "weights", expected: vertices * handles, found: rows.len() });
        }
        for (handle, transform) in pose.transforms.iter().enumerate() {
            let rotation = transform.rotation.quaternion();
            let numbers = rotation.iter().chain(&transform.translation).chain(&transform.pivot);
            if let Some(&value) = numbers.into_iter().find(|value| !value.is_finite()) {
                return Err(DeformError::Number { what: "transform of handle", index: handle, value, expected: "a rotation and finite numbers" });
            }
            if !(transform.scale > 0.0 && transform.scale.is_finite()) {
                let value = transform.scale;
                return Err(DeformError::Number { what: "scale of handle", index: handle, value, expected: "a positive number" });
            }
        }
        let weights = Self { rows, handles };
        match (0..vertices).map(|vertex| (vertex, weights.row(vertex).iter().sum::<f64>())).find(|(_, sum)| !(*sum > 0.0 && sum.is_finite())) {
            Some((vertex, sum)) => {
                Err(DeformError::Number { what: "sum of the weights of vertex", index: vertex, value: sum, expected: "a positive number" })
            }
            None => Ok(weights),
        }
    }

    fn row(&self, vertex: usize) -> &'a [f64] {
        &self.rows[vertex * self.handles..][..self.handles]
    }

    /// The weights of a vertex, of sum 1, handle by handle; zeros are left out.
    pub fn of(&self, vertex: usize) -> impl Iterator<Item = (usize, f64)> + Clone + 'a {
        let row = self.row(vertex);
        let sum: f64 = row.iter().sum();
        row.iter().enumerate().filter(|(_, weight)| **weight != 0.0).map(move |(handle, weight)| (handle, weight / sum))
    }

    /// The means of the weights of some vertices, written to a row of all handles.
    pub fn mean(&self, vertices: &[u32], row: &mut [f64]) {
        row.fill(0.0);
        for &vertex in vertices {
            self.of(vertex as usize).for_each(|(handle, weight)| row[handle] += weight / vertices.len() as f64);
        }
    }
}

/// The quaternion of the handle with the greatest weight, the first of several: the others take the sign that brings them to its side.
///
/// # Source
/// Kavan, Collins, Žára, O'Sullivan 2008, section 4.1, on antipodality.
pub(super) fn side(weights: impl Iterator<Item = (usize, f64)>, quaternions: &[[f64; 4]]) -> Option<[f64; 4]> {
    let strongest = weights.fold(None, |best: Option<(usize, f64)>, (handle, weight)| match best {
        Some((_, most)) if most >= weight => best,
        _ => Some((handle, weight)),
    });
    strongest.map(|(handle, _)| quaternions[handle])
}

pub(super) fn dot4(a: [f64; 4], b: [f64; 4]) -> f64 {
    (0..4).map(|part| a[part] * b[part]).sum()
}

pub(super) fn sign(reference: [f64; 4], quaternion: [f64; 4]) -> f64 {
    if dot4(reference, quaternion) < 0.0 { -1.0 } else { 1.0 }
}
