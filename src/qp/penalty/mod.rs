//! Penalty continuation: unconstrained Newton steps with ever steeper penalties of negative eigenvalues.
//!
//! ```text
//! minimise f(x) + sum_i T(lambda_i(S(x))),   T(lambda) = tau w p(lambda),   tau = 1, 10, 100, ...
//! ```
//!
//! over all eigenvalues of all blocks `S = A x + b` (an order row is a block of one number). Iterates violate the rows, less and
//! less, and never leave the neighbourhood of the solution: they are previews. The other method, the interior point, is
//! faster to the end. What this one adds to the published algorithm: block weights that make tau a pure number; acceptance of
//! full steps once the decrement sinks below the rounding of the energy; a shift of the diagonal at very large tau; multipliers
//! from the last Newton step, which give a dual point and an honest gap; and an end by the KKT residuals of the problem as given.
//!
//! # Source
//! Liu, Gao, Zhu, Sifakis, Kavan 2016, *Fast and robust inversion-free shape manipulation*, equations 4 to 8, algorithm 1 and
//! section 4 (cubic and spline penalty).

mod blocks;
mod continuation;
mod function;
mod measure;
mod options;
mod spectral;

pub use continuation::solve_with;
pub use function::Penalty;
pub use options::{LineSearch, Method, PenaltyOptions, Preview, Until};
pub use spectral::MatrixPenalty;
