//! From meshes to matrices and derivatives: cotangent Laplacian, lumped mass, gradients, derived flow quantities.
//!
//! Signs and units, for a mesh of dimension d with lengths in metres: the Laplacian is **positive** semi-definite, in
//! `[m^(d-2)]`; the mass is in `[m^d]`; `M⁻¹ L` is minus the Laplace operator, in `[1/m²]`. Nothing here depends on the
//! orientation of the simplices. All sums run in a fixed order, so that the bits do not depend on the number of threads.

mod derived;
mod error;
mod gradient;
mod laplacian;
mod mass;

pub use derived::{Derived, PLANAR, derive};
pub use error::OperatorError;
pub(crate) use gradient::dual_basis;
pub use gradient::{gradients, vertex_gradients};
pub use laplacian::{LEAST_WEIGHT, cotangent_laplacian, positive_laplacian};
pub use mass::{lumped_mass, mixed_voronoi_mass};
