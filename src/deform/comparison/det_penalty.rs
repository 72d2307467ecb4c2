//! Penalty continuation on `det F` itself instead of the convex set around the given rotation.

use super::compared::{Compared, Comparison, Ending};
use super::determinant::{OfDeterminant, WithDeterminant};
use super::newton::{Newton, Rule};
use crate::deform::DeformError;

/// The parameters of the penalty on `det F`; the defaults are those of Liu 2016, algorithm 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetPenaltyOptions {
    /// tau_0, the first penalty parameter, positive.
    pub start: f64,
    /// mu, the factor from one parameter to the next, above 1.
    pub growth: f64,
    /// zeta, the largest parameter.
    pub limit: f64,
    /// eps, the determinant below which an element is penalised, not negative.
    pub margin: f64,
    /// `gᵀ H⁻¹ g` relative to the energy at which the parameter grows, positive.
    pub tolerance: f64,
    /// Newton steps at most, over all parameters.
    pub max_iterations: usize,
}

impl Default for DetPenaltyOptions {
    /// tau_0 = 1, mu = 10, zeta = 1e13, eps = 1e-7, (1e-7)², 1000 steps.
    fn default() -> Self {
        Self { start: 1.0, growth: 10.0, limit: 1e13, margin: 1e-7, tolerance: 1e-14, max_iterations: 1000 }
    }
}

/// `tau (det F - eps)²` below eps.
struct ClampedSquare {
    tau: f64,
    margin: f64,
}

impl OfDeterminant for ClampedSquare {
    fn at(&self, determinant: f64) -> [f64; 3] {
        let off = determinant - self.margin;
        // NaN falls through to the square and stays NaN.
        if off >= 0.0 { [0.0; 3] } else { [self.tau * off * off, 2.0 * self.tau * off, 2.0 * self.tau] }
    }
}

impl Comparison<'_> {
    /// Newton's method with a penalty of `det F_i < eps`, ever steeper, from the ex-rotated minimiser on.
    ///
    /// The energy is not convex: Hessians of elements are projected to their positive semi-definite part, and what is found is a local
    /// minimum, if any.
    ///
    /// # Arguments
    /// * `watch`: called with the number of each step and its positions.
    ///
    /// # Errors
    /// [`DeformError::Number`] for an option out of range; [`DeformError::Factor`].
    ///
    /// # Cost
    /// A factorisation a step, up to the limit.
    ///
    /// # Source
    /// Liu et al. 2016, section 4 and figure 12; the projection is that of Teran, Sifakis, Irving, Fedkiw 2005.
    pub fn det_penalty(
        &self,
        options: &DetPenaltyOptions,
        watch: &mut dyn FnMut(usize, &[f64]),
    ) -> Result<Compared, DeformError> {
        let DetPenaltyOptions { start, growth, limit, margin, tolerance, max_iterations } = *options;
        positive(&[start, growth - 1.0, limit, tolerance])?;
        let mut newton = Newton::new(self.deformer)?;
        let mut x = self.deformer.reference(self.targets)?;
        self.minimise_elastic(&mut newton, &mut x)?;
        let (mut tau, mut rounds, mut ending) = (start, 0, Ending::IterationLimit);
        while newton.steps < max_iterations {
            rounds += 1;
            let energy = WithDeterminant { elastic: self.elastic(), part: ClampedSquare { tau, margin } };
            let rule = Rule { tolerance, steps: max_iterations - newton.steps };
            let places = (self.targets, &mut x);
            ending = match self.deformer.rest().dimension() {
                2 => newton.minimise::<2, 4>(&energy, places, rule, watch)?,
                _ => newton.minimise::<3, 9>(&energy, places, rule, watch)?,
            };
            tau *= growth;
            if ending != Ending::Converged || tau > limit * (1.0 + 1e-9) {
                break;
            }
        }
        self.compared(x, ending, (newton.steps, rounds))
    }
}

/// Refuses options that are not positive numbers.
pub(super) fn positive(options: &[f64]) -> Result<(), DeformError> {
    match options.iter().position(|value| value.is_nan() || *value <= 0.0) {
        Some(index) => Err(DeformError::Number {
            what: "option of the comparison",
            index,
            value: options[index],
            expected: "a positive number",
        }),
        None => Ok(()),
    }
}
