//! The convex engine: a sparse quadratic objective, fixed unknowns, rows in cones.
//!
//! ```text
//! minimise 1/2 xᵀ P x + qᵀ x + c   subject to   x_i = g_i (fixed),   A x + b in K_1 x K_2 x ...
//! ```
//!
//! P is a sum of terms, among them chains `L (W L)^(k-1)` that are multiplied through and never trusted in formed shape.
//! Every row touches few neighbouring unknowns, so that `P + Aᵀ W A` keeps one pattern: an [`Engine`] orders and analyses
//! it once, and then serves minimisers without rows ([`Engine::minimise`], [`Engine::pin`]) and interior-point solves
//! ([`Engine::solve`]) or penalty continuation ([`Engine::solve_penalty`]) with any weights, fixed sets and rows inside that pattern. It knows no mesh.
//!
//! Solves with nonnegative rows only begin with rounds of splitting, which find most active rows sooner than interior-point iterations, and
//! end by deciding which rows are active and mending wrong decisions with the factor at hand ([`Settings::splitting`]).
//!
//! The end of a solve is a [`QpStatus`] with [`KktResiduals`] on the problem as given; only `Solved` is success.

mod blocks;
mod bound;
mod centred;
mod certificate;
mod complementarity;
mod conflict;
mod deciding;
mod elastic;
mod engine;
mod error;
mod interior;
mod kkt;
mod mending;
mod mixed;
mod penalty;
mod pinned;
mod problem;
mod product;
mod rows;
mod scaling;
mod solution;
mod splitting;
mod start;
mod step;
mod system;

pub use certificate::Certificate;
pub use engine::Engine;
pub use error::QpError;
pub use interior::{Known, solve};
pub use mixed::KktForm;
pub use penalty::{LineSearch, MatrixPenalty, Method, Penalty, PenaltyOptions, Preview, Until, solve_with};
pub use pinned::{Minimum, PinnedSolver};
pub use problem::{Cone, Constraints, Objective, Problem, Term};
pub use system::FactorPrecision;
pub use solution::{Iterate, KktResiduals, Progress, QpStatus, Settings, Solution, Timings};
