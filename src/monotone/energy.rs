//! The energy of a field: smoothness of order k against distance from the data.
//!
//! ```text
//! E(f) = l^(2k) E_k(f) + (f - h)ᵀ D (f - h)        E_k(f) = ½ fᵀ L (Λ M⁻¹ L)^(k-1) f        D = C M
//! ```
//!
//! in units of `[value² length^d]`. Λ and C are diagonal: the smoothness mask and the confidence.
//!
//! Literature: Jacobson, Weinkauf, Sorkine 2012, eq. 3–5 and 18; Botsch, Kobbelt 2004, section 3, for blended orders.

use std::borrow::Cow;

use crate::linalg::CsrMatrix;
use crate::mesh::SimplicialComplex;
use crate::operators::{OperatorError, cotangent_laplacian, lumped_mass};
use crate::qp::{Objective, Term};

/// The operators of a mesh from which energies are made.
#[derive(Debug, Clone)]
pub struct Operators {
    /// `n x n` cotangent Laplacian, positive semi-definite, rows sum to zero.
    pub laplacian: CsrMatrix,
    /// `n` lumped masses, `[length^d]`.
    pub mass: Vec<f64>,
}

impl Operators {
    /// Assembles Laplacian and mass.
    ///
    /// # Errors
    /// [`OperatorError`] names the first simplex without length, area or volume.
    pub fn new(complex: &SimplicialComplex) -> Result<Self, OperatorError> {
        Ok(Self { laplacian: cotangent_laplacian(complex)?, mass: lumped_mass(complex)? })
    }
}

impl<'a> From<&'a Operators> for Cow<'a, Operators> {
    fn from(operators: &'a Operators) -> Self {
        Self::Borrowed(operators)
    }
}

impl From<Operators> for Cow<'_, Operators> {
    fn from(operators: Operators) -> Self {
        Self::Owned(operators)
    }
}

/// What weighs in the energy.
#[derive(Debug, Clone)]
pub struct EnergyWeights<'a> {
    /// Order k of the polyharmonic energy, 1 to 4.
    pub order: usize,
    /// Smoothing length l in the units of the points.
    pub length: f64,
    /// Confidence in each data value, `n` numbers not below 0; 1 everywhere if absent.
    pub confidence: Option<&'a [f64]>,
    /// Smoothness mask, `n` numbers in [0, 1]; 1 everywhere if absent. 0 allows a C0 spike at the vertex (k ≥ 2).
    pub smoothness: Option<&'a [f64]>,
}

impl EnergyWeights<'_> {
    /// The diagonal of D.
    fn pull(&self, mass: &[f64]) -> Vec<f64> {
        (0..mass.len()).map(|i| self.confidence.map_or(1.0, |confidence| confidence[i]) * mass[i]).collect()
    }

    /// The diagonal of Λ M⁻¹; vertices without mass have no energy.
    fn chain(&self, mass: &[f64]) -> Vec<f64> {
        let weight = |i: usize| self.smoothness.map_or(1.0, |mask| mask[i]);
        (0..mass.len()).map(|i| if mass[i] > 0.0 { weight(i) / mass[i] } else { 0.0 }).collect()
    }
}

/// Smoothness and data part of the energy of a field, `[value² length^d]`.
///
/// # Arguments
/// * `data`: h; `field`: f; `n` values each.
///
/// # Cost
/// k products with the Laplacian.
///
/// # Source
/// Jacobson, Weinkauf, Sorkine 2012, eq. 19–20: the chain is multiplied through, never formed.
pub fn energy_parts(operators: &Operators, data: &[f64], weights: &EnergyWeights<'_>, field: &[f64]) -> (f64, f64) {
    let chain = weights.chain(&operators.mass);
    // Constants are in the null space: without them the products keep more digits.
    let shift = field.first().copied().unwrap_or(0.0);
    let centred: Vec<f64> = field.iter().map(|value| value - shift).collect();
    // Half of the chain from either side: E_k is a sum of squares for even k and a Dirichlet energy for odd k.
    let mut left = centred;
    for _ in 0..(weights.order - 1) / 2 {
        left = operators.laplacian.multiply(&left);
        left.iter_mut().zip(&chain).for_each(|(value, weight)| *value *= weight);
    }
    let image = operators.laplacian.multiply(&left);
    let square: f64 = match weights.order % 2 {
        1 => left.iter().zip(&image).map(|(a, b)| a * b).sum(),
        _ => image.iter().zip(&chain).map(|(value, weight)| value * value * weight).sum(),
    };
    let pull = weights.pull(&operators.mass);
    let distance = (0..data.len()).map(|i| pull[i] * (field[i] - data[i]).powi(2)).sum();
    (weights.length.powi(2 * weights.order as i32) * 0.5 * square, distance)
}

/// The same energy as an objective in product form, divided by the total mass and by `unit²`, over `x = (f - shift) / unit`.
///
/// In these units values and energies are of order one whatever the units of the file.
///
/// # Source
/// Jacobson, Weinkauf, Sorkine 2012, eq. 5 and 18, with γ_L/γ_D = l^(2k), which makes l a length on any mesh.
pub(super) fn objective(
    operators: &Operators,
    data: &[f64],
    weights: &EnergyWeights<'_>,
    (shift, unit): (f64, f64),
) -> Objective {
    let total = total_mass(operators);
    let pull: Vec<f64> = weights.pull(&operators.mass).iter().map(|pull| 2.0 * pull / total).collect();
    let scaled: Vec<f64> = data.iter().map(|value| (value - shift) / unit).collect();
    let linear = pull.iter().zip(&scaled).map(|(pull, value)| -pull * value).collect();
    let constant = pull.iter().zip(&scaled).map(|(pull, value)| 0.5 * pull * value * value).sum();
    Objective {
        terms: vec![
            Term::Chain {
                scale: weights.length.powi(2 * weights.order as i32) / total,
                stiffness: operators.laplacian.clone(),
                weights: weights.chain(&operators.mass),
                order: weights.order,
            },
            Term::Diagonal(pull),
        ],
        linear,
        constant,
    }
}

/// Sum of the lumped masses: length, area or volume of the mesh.
pub(super) fn total_mass(operators: &Operators) -> f64 {
    operators.mass.iter().sum()
}
