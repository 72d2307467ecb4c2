//! Distances along a mesh: exact ones on surfaces, and fast approximate ones by heat flow on surfaces and solids.

mod envelope;
mod error;
mod exact;
mod heat;
mod source;
mod surface;
mod turn;
mod wavefront;
mod window;

pub use error::GeodesicError;
pub use exact::{ExactGeodesic, exact_distances};
pub use heat::{HeatGeodesic, HeatOptions};
pub use source::{SurfacePoint, nearest_point};
