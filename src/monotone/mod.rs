//! Functions with controlled extrema: wanted extrema in, a smooth field with exactly those out.
//!
//! The steps, each in a file of its own: the *representative function*, any field with exactly the wanted extrema; the
//! *monotonicity edges*, which take its direction; the *levels*, a strictly feasible field or the two values that contradict;
//! the *fit*, the convex problem; and the *repair*, which makes the stored numbers strict.
//!
//! Literature: Jacobson, Weinkauf, Sorkine 2012, *Smooth shape-aware functions with controlled extrema*, section 3.

mod analysis;
mod blocks;
mod bridges;
mod edges;
mod energy;
mod fit;
mod flood;
mod laplace;
mod levels;
mod repair;
mod representative;
mod separatrix;
mod simplified;

pub use analysis::{AnalysisError, FitAnalysis};
pub use blocks::{st_numbering, unreachable_regions};
pub use edges::{EdgeSet, MonotonicityEdge, MonotonicityGraph};
pub use energy::{EnergyWeights, Operators, energy_parts};
pub use fit::{Fitter, MonotoneConstraints, MonotoneFit, MonotoneProblem};
pub use flood::{Flooded, flood, flood_field, has_exactly};
pub use levels::{Contradiction, Levels, ValueRule, levels, sweep};
pub use repair::{NotRepresentable, Repaired, Strictness, repair};
pub use representative::{Representative, RepresentativeError, Strategy, harmonic, representative};
pub use separatrix::separatrix;
pub use simplified::{SimplifiedField, SimplifyError, simplified_field};
