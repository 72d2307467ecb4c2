//! The dual objective of multipliers that do not balance the gradient exactly.
//!
//! Multipliers z inside the dual cone bound the optimum from below by `D(z) = min_y f(y) - zᵀ(A y + b)`. At a point x with stationarity residual
//! `r = P x + q - Aᵀ z` the minimiser is `y = x - P⁻¹ r`, so that
//!
//! ```text
//! f(x) - D(z) = zᵀ(A x + b) + 1/2 rᵀ P⁻¹ r.
//! ```
//!
//! The second part is what the residual may hide of the gap. A factor in single precision sometimes cannot close the residual of the normal
//! equations, whose weights span many powers of ten near the optimum; P alone has no such weights, and its solves converge.

use super::QpError;
use super::interior::Interior;
use super::kkt::Measure;
use super::product::dot;
use super::system::System;

/// Relative residual of `P d = r` below which d counts as known.
const ENOUGH: f64 = 1e-6;

/// The bound is asked for again only when the residual has fallen to this share since the last time: it costs a factorisation.
const FALLEN: f64 = 0.1;

impl Interior<'_> {
    /// Whether the point is optimal though its stationarity residual is above the tolerance: the gap, with what the residual may hide, is within
    /// its own tolerance. Asked only with a factor in single precision, of points whose gap and primal residual are closed.
    ///
    /// # Cost
    /// One factorisation of P where it is asked. The factor at hand is lost.
    pub(super) fn is_bounded(&mut self, measure: &Measure) -> Result<bool, QpError> {
        let (kkt, settings) = (&measure.kkt, self.settings);
        let is_closed = kkt.duality_gap <= settings.relative_gap && kkt.primal <= settings.residual;
        if !is_closed || !matches!(self.engine.system, System::Single(_)) || kkt.stationarity > FALLEN * self.bounded_at {
            return Ok(false);
        }
        self.bounded_at = kkt.stationarity;
        self.engine.factor_base()?;
        let mut step = std::mem::take(&mut self.step.x);
        let (taken, reached) =
            self.engine.solve_refined(&self.problem.objective, None, &self.stationarity, &mut step, (0.1 * ENOUGH, 4));
        self.solves += taken;
        let product = dot(&self.stationarity, &step);
        // What is left of the residual of the solve, against the direction.
        let open = reached * (dot(&self.stationarity, &self.stationarity) * dot(&step, &step)).sqrt();
        self.step.x = step;
        self.hidden = 0.5 * (product + 2.0 * open) / measure.unit;
        Ok(reached <= ENOUGH && kkt.duality_gap + self.hidden <= settings.relative_gap)
    }
}
