//! What penalty continuation may be asked for, and what it shows on the way.

use super::Penalty;
use crate::qp::QpError;

/// How a problem is solved.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Method {
    /// The primal–dual interior point.
    #[default]
    InteriorPoint,
    /// Penalty continuation.
    Penalty(PenaltyOptions),
}

/// When penalty continuation ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Until {
    /// At the first penalty parameter whose minimiser is optimal by the settings' tolerances.
    Optimal,
    /// After the last penalty parameter, as published.
    Limit,
}

/// Backtracking on the penalised energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineSearch {
    /// Part of the predicted decrease that a step must reach, above 0 and below 1/2.
    pub slope: f64,
    /// Factor from one trial to the next, above 0 and below 1.
    pub shrink: f64,
}

/// The parameters of algorithm 1.
#[derive(Debug, Clone, PartialEq)]
pub struct PenaltyOptions {
    /// The penalty of an eigenvalue.
    pub penalty: Penalty,
    /// tau_0, the first penalty parameter, positive.
    pub start: f64,
    /// mu, the factor from one parameter to the next, above 1.
    pub growth: f64,
    /// zeta, the largest parameter.
    pub limit: f64,
    /// epsilon: the parameter grows once `gᵀ H⁻¹ g <= epsilon²` relative to the objective.
    pub tolerance: f64,
    /// The line search (Boyd and Vandenberghe 2004, algorithm 9.2).
    pub line_search: LineSearch,
    /// When to end.
    pub until: Until,
    /// w, a positive factor for each order row and each block, in their order. `None` takes, for each, one over the mean of
    /// `a diag(P)⁻¹ aᵀ` over its rows a, which is the measure of the element up to a constant where the problem comes from a mesh, and
    /// which makes tau a pure number. Where some unknowns are held by much stiffer terms, such as soft handles, give the measures themselves:
    /// the penalty of the blocks there would be as stiff, and the barrier of the spline slow to vanish.
    pub weights: Option<Vec<f64>>,
}

impl Default for PenaltyOptions {
    /// The quadratic penalty with tau_0 = 1, mu = 10, zeta = 1e13, epsilon = 1e-7, as published.
    fn default() -> Self {
        Self {
            penalty: Penalty::Quadratic,
            start: 1.0,
            growth: 10.0,
            limit: 1e13,
            tolerance: 1e-7,
            line_search: LineSearch { slope: 1e-2, shrink: 0.5 },
            until: Until::Optimal,
            weights: None,
        }
    }
}

impl PenaltyOptions {
    /// The default with another penalty.
    ///
    /// The violation left by the cubic one falls with the square root of tau only, so its zeta is 1e20: its curvature there is that of
    /// the quadratic one at 1e10.
    pub fn with(penalty: Penalty) -> Self {
        let limit = if penalty == Penalty::Cubic { 1e20 } else { 1e13 };
        Self { penalty, limit, ..Self::default() }
    }

    /// Refuses numbers out of range.
    pub(super) fn check(&self, blocks: usize) -> Result<(), QpError> {
        let LineSearch { slope, shrink } = self.line_search;
        let ranges = [
            ("tau_0", self.start, self.start > 0.0, "a positive number"),
            ("mu", self.growth, self.growth > 1.0, "a number above 1"),
            ("zeta", self.limit, self.limit >= self.start, "a number not below tau_0"),
            ("epsilon", self.tolerance, self.tolerance > 0.0, "a positive number"),
            ("line search: slope", slope, slope > 0.0 && slope < 0.5, "a number between 0 and 1/2"),
            ("line search: shrink", shrink, shrink > 0.0 && shrink < 1.0, "a number between 0 and 1"),
        ];
        for (option, value, is_good, expected) in ranges {
            if !is_good || !value.is_finite() {
                return Err(QpError::Option { option, value, expected });
            }
        }
        let Some(weights) = &self.weights else { return Ok(()) };
        if weights.len() != blocks {
            return Err(QpError::Length { array: "penalty weights", expected: blocks, found: weights.len() });
        }
        match weights.iter().find(|weight| !(**weight > 0.0 && weight.is_finite())) {
            Some(&value) => Err(QpError::Option { option: "penalty weight", value, expected: "a positive number" }),
            None => Ok(()),
        }
    }
}

/// An iterate, shown before the next step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preview<'a> {
    /// Newton steps done.
    pub iteration: usize,
    /// The penalty parameter; 0 for the minimiser without rows.
    pub tau: f64,
    /// The point, n numbers.
    pub x: &'a [f64],
    /// The most negative eigenvalue of a block or value of a row; 0 if there is none.
    pub violation: f64,
    /// `gᵀ H⁻¹ g` of the last step relative to the objective.
    pub decrement: f64,
}
