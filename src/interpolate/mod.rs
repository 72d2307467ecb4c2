//! Functions from values at some vertices: skinning weights, colour diffusion, bounded and monotone interpolation.
//!
//! ```text
//! minimise  fᵀ (L M⁻¹)^(k-1) L f   subject to  f_i = g_i at some vertices,  and
//!     nothing more (polyharmonic; k = 1: harmonic),  low ≤ f ≤ high (bounded),  or  f_i < f_j along monotonicity edges (monotone)
//! ```
//!
//! A plateau of given, equal values joined by edges is one extremum: a handle is often a bone or a region.
//!
//! Literature: Jacobson, Weinkauf, Sorkine 2012, *Smooth shape-aware functions with controlled extrema*; Jacobson, Baran, Popović,
//! Sorkine 2011, *Bounded biharmonic weights for real-time deformation*; Botsch, Kobbelt 2004, *An intuitive framework for real-time
//! freeform modeling*.

mod boundary;
mod bounded;
mod by_hand;
mod colours;
mod contraction;
mod controlled;
mod coupled;
mod error;
mod interpolator;
mod lanes;
mod method;
mod partition;
mod weights;

pub use by_hand::{Nearness, interpolate_near, interpolate_wanted};
pub use colours::{Blend, Diffused, diffuse};
pub use error::InterpolateError;
pub use interpolator::{BoundaryValues, InterpolateReport, Interpolated, Interpolator};
pub use method::{Guide, InterpolateOptions, Mass, Method};
pub use partition::{distance_from_unity, keep_strongest, normalise};
pub use weights::{Partition, SkinningWeights, WeightOptions, WeightReport, skinning_weights};
