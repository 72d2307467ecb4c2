//! What positions say about every element: deformation gradient, determinant, smallest eigenvalue.

use super::DeformError;
use super::rest::{CHUNK, RestShape};
use crate::linalg::small::symmetric_eigen;
use rayon::prelude::*;

impl RestShape {
    /// The deformation gradient `F = sum_v x_v (grad phi_v)ᵀ` of every element.
    ///
    /// # Arguments
    /// * `positions`: `n x dim` coordinates, vertex by vertex.
    ///
    /// # Returns
    /// One matrix an element, by rows; in 2-D the third row and column are those of the identity.
    ///
    /// # Errors
    /// [`DeformError::Length`], [`DeformError::Number`].
    pub fn deformation_gradients(&self, positions: &[f64]) -> Result<Vec<[[f64; 3]; 3]>, DeformError> {
        self.check_positions(positions)?;
        let elements = (0..self.element_count()).into_par_iter().with_min_len(CHUNK);
        Ok(elements.map(|element| self.deformation_gradient(element, positions)).collect())
    }

    /// `det F` of every element: deformed over rest measure, negative where inverted. In double precision, with its rounding.
    ///
    /// # Arguments, Errors
    /// As for [`RestShape::deformation_gradients`].
    pub fn determinants(&self, positions: &[f64]) -> Result<Vec<f64>, DeformError> {
        self.check_positions(positions)?;
        let elements = (0..self.element_count()).into_par_iter().with_min_len(CHUNK);
        Ok(elements.map(|element| determinant(&self.deformation_gradient(element, positions))).collect())
    }

    /// The smallest eigenvalue of `sym(RᵀF)` of every element. Where it is positive, so is `det F`.
    ///
    /// # Arguments
    /// * `rotations`: one rotation an element, by rows; in 2-D the leading 2 x 2 block is read.
    /// * `positions`: `n x dim` coordinates.
    ///
    /// # Errors
    /// [`DeformError::Length`], [`DeformError::Number`], [`DeformError::NotARotation`].
    pub fn smallest_eigenvalues(&self, rotations: &[[[f64; 3]; 3]], positions: &[f64]) -> Result<Vec<f64>, DeformError> {
        self.check_positions(positions)?;
        self.check_rotations(rotations)?;
        let elements = (0..self.element_count()).into_par_iter().with_min_len(CHUNK);
        Ok(elements.map(|element| self.smallest(element, &rotations[element], positions)).collect())
    }

    pub(super) fn deformation_gradient(&self, element: usize, positions: &[f64]) -> [[f64; 3]; 3] {
        let dimension = self.dimension();
        let mut matrix = [[0.0; 3]; 3];
        if dimension == 2 {
            matrix[2][2] = 1.0;
        }
        let corners = self.corners(element);
        let base = &positions[corners[0] as usize * dimension..][..dimension];
        for (&vertex, gradient) in corners.iter().zip(self.gradients(element)).skip(1) {
            let place = &positions[vertex as usize * dimension..][..dimension];
            for axis in 0..dimension {
                // Gradients sum to zero; by differences the place of the shape costs no digits.
                let side = place[axis] - base[axis];
                for (slot, part) in matrix[axis].iter_mut().zip(&gradient[..dimension]) {
                    *slot += side * part;
                }
            }
        }
        matrix
    }

    fn smallest(&self, element: usize, rotation: &[[f64; 3]; 3], positions: &[f64]) -> f64 {
        let stretch = symmetric_part(self.dimension(), rotation, &self.deformation_gradient(element, positions));
        let [a, b, c, d, e, f] = stretch;
        match self.dimension() {
            2 => symmetric_eigen(&[[a, b], [b, c]]).0[0],
            _ => symmetric_eigen(&[[a, b, d], [b, c, e], [d, e, f]]).0[0],
        }
    }

    pub(super) fn check_rotations(&self, rotations: &[[[f64; 3]; 3]]) -> Result<(), DeformError> {
        if rotations.len() != self.element_count() {
            return Err(DeformError::Length { what: "rotations", expected: self.element_count(), found: rotations.len() });
        }
        let dimension = self.dimension();
        for (element, rotation) in rotations.iter().enumerate() {
            let mut deviation = 0.0f64;
            for a in 0..dimension {
                for b in 0..=a {
                    let product: f64 = (0..dimension).map(|axis| rotation[axis][a] * rotation[axis][b]).sum();
                    let off = (product - f64::from(u8::from(a == b))).abs();
                    // NaN must not pass for zero.
                    deviation = if off.is_nan() { f64::INFINITY } else { deviation.max(off) };
                }
            }
            let planar = rotation[0][0] * rotation[1][1] - rotation[0][1] * rotation[1][0];
            if deviation <= 1e-8 && (if dimension == 2 { planar } else { determinant(rotation) }) < 0.0 {
                deviation = 2.0;
            }
            if deviation > 1e-8 {
                return Err(DeformError::NotARotation { element, deviation });
            }
        }
        Ok(())
    }
}

/// The determinant of a 3 x 3 matrix.
pub fn determinant(matrix: &[[f64; 3]; 3]) -> f64 {
    let [[a, b, c], [d, e, f], [g, h, i]] = *matrix;
    a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
}

/// The lower triangle `(s11, s21, s22, s31, s32, s33)` of `sym(RᵀF)`, unscaled; in 2-D the last three are zero.
pub(super) fn symmetric_part(dimension: usize, rotation: &[[f64; 3]; 3], gradient: &[[f64; 3]; 3]) -> [f64; 6] {
    let turned = |a: usize, b: usize| (0..dimension).map(|axis| rotation[axis][a] * gradient[axis][b]).sum::<f64>();
    let mut triangle = [0.0; 6];
    let mut place = 0;
    for a in 0..dimension {
        for b in 0..=a {
            triangle[place] = 0.5 * (turned(a, b) + turned(b, a));
            place += 1;
        }
    }
    triangle
}
