//! The penalty of one eigenvalue and its derivatives.

/// A convex penalty of an eigenvalue lambda of a block that should not be negative.
///
/// Formulas are for eigenvalues in the problem's own unit rho (a typical row of `A x + b`), `y = lambda / rho`, and give
/// `T = w rho² t(y)`; so scaling a problem does not change its iterates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Penalty {
    /// `t = tau y²` for y < 0, else 0: once differentiable. Equation 5.
    #[default]
    Quadratic,
    /// `t = tau (-y)³` for y < 0, else 0: twice differentiable.
    Cubic,
    /// `t = (2 (tau y)² - log(1/2) - 1/2) / tau` for `2 tau y < -1`, else `-log(tau y + 1) / tau`: strictly convex and twice
    /// differentiable everywhere, a barrier inside that vanishes with growing tau.
    Spline,
}

impl Penalty {
    /// `t(y)`.
    pub fn value(self, tau: f64, y: f64) -> f64 {
        match self {
            Self::Quadratic => tau * y.min(0.0).powi(2),
            Self::Cubic => -tau * y.min(0.0).powi(3),
            Self::Spline => {
                let z = tau * y;
                (if 2.0 * z < -1.0 { 2.0 * z * z + std::f64::consts::LN_2 - 0.5 } else { -z.ln_1p() }) / tau
            }
        }
    }

    /// `t'(y)`, never positive.
    pub fn slope(self, tau: f64, y: f64) -> f64 {
        match self {
            Self::Quadratic => 2.0 * tau * y.min(0.0),
            Self::Cubic => -3.0 * tau * y.min(0.0).powi(2),
            Self::Spline => {
                let z = tau * y;
                if 2.0 * z < -1.0 { 4.0 * z } else { -1.0 / (1.0 + z) }
            }
        }
    }

    /// `t''(y)`, never negative.
    pub fn curvature(self, tau: f64, y: f64) -> f64 {
        match self {
            Self::Quadratic => {
                if y < 0.0 { 2.0 * tau } else { 0.0 }
            }
            Self::Cubic => -6.0 * tau * y.min(0.0),
            Self::Spline => {
                let z = tau * y;
                if 2.0 * z < -1.0 { 4.0 * tau } else { tau / (1.0 + z).powi(2) }
            }
        }
    }

    /// `(t'(y) - t'(z)) / (y - z)`, the curvature between two eigenvalues; its limit where they meet.
    pub fn secant(self, tau: f64, y: f64, z: f64) -> f64 {
        // Nearer than this, the difference of the slopes has lost half of its digits, and the middle is as good.
        if (y - z).abs() <= 1e-8 * (y.abs() + z.abs()) {
            return self.curvature(tau, 0.5 * (y + z));
        }
        (self.slope(tau, y) - self.slope(tau, z)) / (y - z)
    }
}
