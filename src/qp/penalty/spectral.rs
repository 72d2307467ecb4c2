//! The penalty of the eigenvalues of one matrix, differentiated twice.

use super::Penalty;
use crate::linalg::small::{Square, from_scaled, scaled_length, symmetric_eigen, to_scaled};
use std::f64::consts::SQRT_2;

/// The penalty of a symmetric matrix and its derivatives by the scaled vector of the matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct MatrixPenalty {
    /// The sum over the eigenvalues.
    pub value: f64,
    /// Its gradient, as many numbers as the scaled vector has; minus a matrix that is positive semi-definite.
    pub gradient: Vec<f64>,
    /// Its Hessian by rows, positive semi-definite.
    pub hessian: Vec<f64>,
}

impl Penalty {
    /// The penalty of a symmetric D x D matrix with its derivatives.
    ///
    /// # Arguments
    /// * `scaled`: the scaled vector, `D (D + 1) / 2` numbers (see [`Cone`](crate::qp::Cone)); D at most 3.
    ///
    /// # Source
    /// Bonnans and Shapiro 2000, section 5.3 (spectral functions).
    pub fn of_matrix<const D: usize>(self, tau: f64, scaled: &[f64]) -> MatrixPenalty {
        let rows = scaled_length(D);
        let (values, _) = symmetric_eigen(&from_scaled::<D>(scaled));
        let mut gradient = vec![0.0; rows];
        let mut hessian = vec![0.0; rows * rows];
        expand::<D>(self, tau, scaled, &mut gradient, &mut |curvature, direction| {
            for (row, one) in direction.iter().enumerate() {
                for (column, other) in direction.iter().enumerate() {
                    hessian[row * rows + column] += curvature * one * other;
                }
            }
        });
        MatrixPenalty { value: values.iter().map(|&value| self.value(tau, value)).sum(), gradient, hessian }
    }
}

/// The gradient of the penalty of a matrix, and its Hessian as a sum of squares `curvature u uᵀ` over scaled vectors u.
///
/// With `S = V diag(lambda) Vᵀ`, the second derivative along D is `sum_ij c_ij (v_iᵀ D v_j)²` with the curvatures
/// `c_ii = t''(lambda_i)` and the secants `c_ij` of t' between two eigenvalues.
pub(super) fn expand<const D: usize>(
    penalty: Penalty,
    tau: f64,
    scaled: &[f64],
    gradient: &mut [f64],
    add: &mut impl FnMut(f64, &[f64]),
) {
    let (values, vectors) = symmetric_eigen(&from_scaled::<D>(scaled));
    let slopes = values.map(|value| penalty.slope(tau, value));
    gradient.fill(0.0);
    if slopes.iter().all(|slope| *slope == 0.0) {
        return;
    }
    let mut vector = [0.0; 6];
    let vector = &mut vector[..scaled_length(D)];
    for i in 0..D {
        for j in 0..=i {
            // The symmetric part of v_i v_jᵀ; its square counts twice for i != j.
            let scale = if i == j { 0.5 } else { 0.5 * SQRT_2 };
            let square: Square<D> = std::array::from_fn(|a| {
                std::array::from_fn(|b| scale * (vectors[a][i] * vectors[b][j] + vectors[b][i] * vectors[a][j]))
            });
            to_scaled(&square, vector);
            if i == j {
                gradient.iter_mut().zip(vector.iter()).for_each(|(slot, u)| *slot += slopes[i] * u);
            }
            let curvature =
                if i == j { penalty.curvature(tau, values[i]) } else { penalty.secant(tau, values[i], values[j]) };
            if curvature > 0.0 {
                add(curvature, vector);
            }
        }
    }
}
