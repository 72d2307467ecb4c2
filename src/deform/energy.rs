//! The energies of given positions, and the quadratic terms that add up to them.

use super::rest::{CHUNK, RestShape};
use crate::linalg::{CsrMatrix, MatrixError};
use rayon::prelude::*;

/// The parts of the energy at given positions, each summed from squares.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct DeformEnergy {
    /// `1/2 sum_i v_i |F_i - R_i|^2`.
    pub elastic: f64,
    /// `nu/2 sum_i v_i (trace(R_i^T F_i) - dim)^2`.
    pub volume: f64,
    /// `alpha |C x - d|^2`; zero for hard handles.
    pub handles: f64,
}

impl DeformEnergy {
    /// The sum of the parts.
    pub fn total(&self) -> f64 {
        self.elastic + self.volume + self.handles
    }
}

impl RestShape {
    /// `|F_i - R_i|²` and `(trace(R_iᵀ F_i) - dim)²` of every element: twice its energy densities at stiffness 1.
    pub(super) fn strains(&self, rotations: &[[[f64; 3]; 3]], positions: &[f64]) -> Vec<[f64; 2]> {
        let dimension = self.dimension();
        let elements = (0..self.element_count()).into_par_iter().with_min_len(CHUNK);
        let strain = |element: usize| {
            let (off, trace) = self.stretch(element, &rotations[element], positions);
            let square: f64 = off[..dimension].iter().flat_map(|row| &row[..dimension]).map(|part| part * part).sum();
            [square, trace * trace]
        };
        elements.map(strain).collect()
    }

    /// `sum_i v_i grad phi_v · grad phi_w` for every pair of vertices of an element and every axis: P of the elastic energy.
    pub(super) fn stiffness(&self) -> Result<CsrMatrix, MatrixError> {
        let dimension = self.dimension() as u32;
        let mut triplets = Vec::with_capacity(self.element_count() * (self.dimension() + 1).pow(2));
        for element in 0..self.element_count() {
            let (corners, gradients) = (self.corners(element), self.gradients(element));
            for (&row, one) in corners.iter().zip(gradients) {
                for (&column, other) in corners.iter().zip(gradients) {
                    let product = one[0] * other[0] + one[1] * other[1] + one[2] * other[2];
                    triplets.push((row, column, self.measures()[element] * product));
                }
            }
        }
        let scalar = CsrMatrix::from_triplets(self.vertex_count(), self.vertex_count(), &triplets)?;
        let (mut offsets, mut indices, mut values) = (vec![0u32], Vec::new(), Vec::new());
        for vertex in 0..self.vertex_count() {
            let (columns, entries) = scalar.row(vertex);
            for axis in 0..dimension {
                indices.extend(columns.iter().map(|column| column * dimension + axis));
                values.extend_from_slice(entries);
                offsets.push(indices.len() as u32);
            }
        }
        let unknowns = self.vertex_count() * self.dimension();
        Ok(CsrMatrix::from_parts(unknowns, unknowns, offsets, indices, values))
    }

    /// The rows `trace(R_iᵀ F_i)`, one an element.
    pub(super) fn traces(&self, rotations: &[[[f64; 3]; 3]]) -> CsrMatrix {
        let dimension = self.dimension();
        let width = (dimension + 1) * dimension;
        let (mut indices, mut values) = (Vec::new(), Vec::new());
        for (element, rotation) in rotations.iter().enumerate() {
            for (&vertex, gradient) in self.corners(element).iter().zip(self.gradients(element)) {
                for (axis, row) in rotation.iter().enumerate().take(dimension) {
                    indices.push(vertex * dimension as u32 + axis as u32);
                    values.push(turned(row, gradient));
                }
            }
        }
        let offsets = (0..=rotations.len()).map(|row| (row * width) as u32).collect();
        CsrMatrix::from_parts(rotations.len(), self.vertex_count() * dimension, offsets, indices, values)
    }

    /// The derivative of elastic and volume energy by the positions: `sum_i v_i (F_i - R_i + nu (trace(R_iᵀ F_i) - dim) R_i) grad phi_v`.
    pub(super) fn forces(&self, nu: f64, rotations: &[[[f64; 3]; 3]], positions: &[f64]) -> Vec<f64> {
        let dimension = self.dimension();
        let mut forces = vec![0.0; positions.len()];
        for (element, rotation) in rotations.iter().enumerate() {
            let (mut stress, off) = self.stretch(element, rotation, positions);
            for (row, turned) in stress.iter_mut().zip(rotation) {
                row.iter_mut().zip(turned).for_each(|(slot, part)| *slot += nu * off * part);
            }
            for (&vertex, gradient) in self.corners(element).iter().zip(self.gradients(element)) {
                for (axis, row) in stress.iter().enumerate().take(dimension) {
                    forces[vertex as usize * dimension + axis] += self.measures()[element] * turned(row, gradient);
                }
            }
        }
        forces
    }

    /// `F - R` and `trace(RᵀF) - dim` of an element.
    fn stretch(&self, element: usize, rotation: &[[f64; 3]; 3], positions: &[f64]) -> ([[f64; 3]; 3], f64) {
        let dimension = self.dimension();
        let mut off = self.deformation_gradient(element, positions);
        let mut trace = 0.0;
        for axis in 0..dimension {
            for column in 0..dimension {
                off[axis][column] -= rotation[axis][column];
                // trace(RᵀF) - dim = <R, F - R>, without the cancellation.
                trace += rotation[axis][column] * off[axis][column];
            }
        }
        (off, trace)
    }
}

/// One entry of `R g`; the third part of g is zero in 2-D.
fn turned(row: &[f64; 3], gradient: &[f64; 3]) -> f64 {
    row[0] * gradient[0] + row[1] * gradient[1] + row[2] * gradient[2]
}
