//! Energies that are functions of `det F`, which is not convex.

use super::local::{Elastic, ElementEnergy, Local};
use crate::linalg::small::{composed, symmetric_eigen};

/// A function of the determinant, by rest measure.
pub(super) trait OfDeterminant: Sync {
    /// Value, slope and curvature; infinite where it is not defined.
    fn at(&self, determinant: f64) -> [f64; 3];
}

/// The elastic energy plus a function of `det F`.
pub(super) struct WithDeterminant<'a, P> {
    pub elastic: Elastic<'a>,
    pub part: P,
}

impl<const D: usize, const N: usize, P: OfDeterminant> ElementEnergy<D, N> for WithDeterminant<'_, P> {
    fn value(&self, element: usize, f: &[f64; N]) -> f64 {
        let part = self.part.at(determinant::<D, N>(f).value)[0];
        ElementEnergy::<D, N>::value(&self.elastic, element, f) + self.elastic.measures[element] * part
    }

    fn expand(&self, element: usize, f: &[f64; N]) -> Local<N> {
        let mut local = ElementEnergy::<D, N>::expand(&self.elastic, element, f);
        let determinant = determinant::<D, N>(f);
        let part = self.part.at(determinant.value).map(|number| self.elastic.measures[element] * number);
        if part != [0.0; 3] {
            add(&mut local, &determinant, part);
        }
        local
    }
}

/// `det F` with its gradient, the cofactors, and its second derivative.
fn determinant<const D: usize, const N: usize>(f: &[f64; N]) -> Local<N> {
    let mut hessian = [[0.0; N]; N];
    let mut gradient = [0.0; N];
    if D == 2 {
        gradient.copy_from_slice(&[f[3], -f[2], -f[1], f[0]]);
        for (i, j, sign) in [(0, 3, 1.0), (1, 2, -1.0)] {
            hessian[i][j] = sign;
            hessian[j][i] = sign;
        }
        return Local { value: f[0] * f[3] - f[1] * f[2], gradient, hessian };
    }
    for a in 0..3 {
        for b in 0..3 {
            let (a1, a2, b1, b2) = ((a + 1) % 3, (a + 2) % 3, (b + 1) % 3, (b + 2) % 3);
            gradient[3 * a + b] = f[3 * a1 + b1] * f[3 * a2 + b2] - f[3 * a1 + b2] * f[3 * a2 + b1];
            hessian[3 * a + b][3 * a1 + b1] = f[3 * a2 + b2];
            hessian[3 * a + b][3 * a2 + b2] = f[3 * a1 + b1];
            hessian[3 * a + b][3 * a1 + b2] = -f[3 * a2 + b1];
            hessian[3 * a + b][3 * a2 + b1] = -f[3 * a1 + b2];
        }
    }
    Local { value: (0..3).map(|b| f[b] * gradient[b]).sum(), gradient, hessian }
}

/// Adds a function of the determinant with the given value, slope and curvature, and projects the Hessian of the sum.
fn add<const N: usize>(local: &mut Local<N>, determinant: &Local<N>, [value, slope, curvature]: [f64; 3]) {
    local.value += value;
    for i in 0..N {
        local.gradient[i] += slope * determinant.gradient[i];
        for j in 0..N {
            local.hessian[i][j] +=
                curvature * determinant.gradient[i] * determinant.gradient[j] + slope * determinant.hessian[i][j];
        }
    }
    local.hessian = projected(&local.hessian);
}

/// The nearest positive semi-definite matrix.
fn projected<const N: usize>(matrix: &[[f64; N]; N]) -> [[f64; N]; N] {
    let (values, vectors) = symmetric_eigen(matrix);
    if values[0] >= 0.0 { *matrix } else { composed(&values.map(|value| value.max(0.0)), &vectors) }
}
