//! What a solve returns, and what it may be asked for.

use super::Certificate;

/// When a solve ends and how hard it works.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Duality gap relative to the objective (with its constant) below which a point counts as optimal.
    pub relative_gap: f64,
    /// Largest stationarity and primal residual, relative (see [`KktResiduals`]), of an optimal point. With a factor in single precision the
    /// stationarity may be larger where the gap is proven all the same, see [`KktResiduals::duality_gap`].
    pub residual: f64,
    /// Iterations before [`QpStatus::IterationLimit`]; each has one numeric factorisation.
    pub max_iterations: usize,
    /// Most centrality correctors (Gondzio 1996) in an iteration; a third one only where a factorisation costs many solves.
    pub correctors: usize,
    /// Fraction of the way to the boundary of the cone that a step takes, below 1.
    pub step_fraction: f64,
    /// A solve ends with [`QpStatus::CutOff`] once its dual objective shows that the optimum is above this: for choices among several
    /// problems, of which only the best one counts. Never, by default.
    pub cutoff: f64,
    /// Whether problems of nonnegative rows may be begun with rounds of splitting and ended by deciding which rows are active, where that is likely to
    /// take fewer factorisations; if not, the interior point does all. Warm starts decide at once.
    pub splitting: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            relative_gap: 1e-8,
            residual: 1e-8,
            max_iterations: 200,
            correctors: 3,
            step_fraction: 0.995,
            cutoff: f64::INFINITY,
            splitting: true,
        }
    }
}

/// Where a solve stands; given to the callback once an iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Iterations done.
    pub iteration: usize,
    /// Duality gap relative to the objective.
    pub gap: f64,
    /// Relative stationarity residual.
    pub stationarity: f64,
    /// Relative primal residual.
    pub primal: f64,
    /// Length of the last step, 0 before the first.
    pub step: f64,
}

/// How a solve ended. Only [`QpStatus::Solved`] is success.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum QpStatus {
    /// The KKT residuals are within the settings, or the gap is proven without the stationarity, see [`KktResiduals::duality_gap`].
    Solved,
    /// No point satisfies the constraints.
    Infeasible(Certificate),
    /// The optimum is above [`Settings::cutoff`]; the point is the last one.
    CutOff,
    /// The iterations ran out; the point is the last one.
    IterationLimit,
    /// Rounding stopped the progress above the tolerances; the point is the best one seen.
    Stalled,
}

/// Optimality of a point, measured on the problem as given (no scaling), gradients in product form.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct KktResiduals {
    /// Largest entry of `P x + q - Aᵀ z` at a free unknown, relative to the largest force in that balance: an entry of
    /// `Aᵀ z`, the reaction at a fixed unknown, or a thousandth of an entry of q.
    pub stationarity: f64,
    /// What rounding may leave in `stationarity`, in the same unit: four units in the last place of the largest sum of addends
    /// `|L| W |L| ... |x|`. Where this exceeds the tolerance (order 4 and few data on fine meshes), it is the tolerance; such
    /// residuals are rough and weigh next to nothing in the gap (2e-12 in the worst case measured, order 4 at 15,000 unknowns).
    pub rounding: f64,
    /// Componentwise backward error (Oettli and Prager 1964): largest entry of `P x + q - Aᵀ z` at a free unknown relative to the addends in
    /// its own row, `(|L| W |L| ... |x|)_i + |q_i| + |Aᵀ z|_i`. The smallest relative change of the entries of the terms for which the point
    /// is exactly stationary, up to rounding in forming it.
    pub backward: f64,
    /// Largest violation of a row or block of `A x + b` (by an eigenvalue), or difference to the slack, relative to the largest entry
    /// of `|A| |x| + |b|`.
    pub primal: f64,
    /// Largest product of a slack and its dual (of a block: trace of the product) relative to the objective.
    pub complementarity: f64,
    /// `zᵀ (A x + b)` relative to the objective. With zero stationarity this bounds the distance to the optimal objective. Where a solve ends with a
    /// stationarity residual r above the tolerance, as only a factor in single precision may leave it, what r can hide is included:
    /// `1/2 rᵀ P⁻¹ r`. The bound then holds for any stationarity.
    pub duality_gap: f64,
}

/// Seconds by stage.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Timings {
    /// Numeric factorisations, assembly included.
    pub factor: f64,
    /// Triangular solves with refinement.
    pub solve: f64,
    /// The whole call.
    pub total: f64,
}

/// A point on the way to a solution, from which a nearby problem is solved in fewer iterations than from the solution itself: an iterate of the
/// interior point keeps clear of the boundary.
#[derive(Debug, Clone, PartialEq)]
pub struct Iterate {
    /// The point, n numbers.
    pub x: Vec<f64>,
    /// The multipliers of all rows, m nonnegative numbers (0 for rows without free unknowns).
    pub dual: Vec<f64>,
    /// Its relative duality gap.
    pub gap: f64,
}

/// The end of a solve.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// The point, n numbers; fixed unknowns have exactly their values.
    pub x: Vec<f64>,
    /// `A x + b` at that point as the solve keeps it, m numbers: nonnegative, positive (definite) unless it ended with decided rows: then zero at
    /// active ones.
    pub slack: Vec<f64>,
    /// z, the multiplier of each row, m numbers, nonnegative or scaled vectors of positive semi-definite blocks.
    pub dual: Vec<f64>,
    /// The first iterate with a relative gap and residuals below 1e-3, or the solution where rows were decided before, for
    /// [`Engine::solve_warm`](super::Engine::solve_warm) on the next problem; `None` if no iterate came that near.
    pub restart: Option<Iterate>,
    /// How the solve ended.
    pub status: QpStatus,
    /// The objective at the point, with its constant.
    pub objective: f64,
    /// Optimality of the point.
    pub kkt: KktResiduals,
    /// Interior-point iterations, rounds of splitting and rounds of decided rows; not those that were taken back.
    pub iterations: usize,
    /// Numeric factorisations, repeated ones included.
    pub factorizations: usize,
    /// Triangular solves.
    pub solves: usize,
    /// Seconds by stage.
    pub timings: Timings,
}
