//! Distances along a mesh: exact ones on surfaces, and fast approximate ones by heat flow on surfaces and solids.
//!
//! [`ExactGeodesic`] carries windows over the triangles and is exact but for rounding. [`HeatGeodesic`] solves two linear systems with
//! kept factors, works on curves and tetrahedra too, and is approximate; on surfaces by an intrinsic Delaunay triangulation. Sources are [`SurfacePoint`]s: vertices, points of edges and of
//! faces; curves are sampled by [`sample_curve`] with a stated error.

mod curve;
mod envelope;
mod error;
mod exact;
mod heat;
mod intrinsic;
mod source;
mod surface;
mod turn;
mod wavefront;
mod window;

pub use curve::sample_curve;
pub use error::GeodesicError;
pub use exact::{ExactGeodesic, exact_distances};
pub use heat::{HeatBoundary, HeatGeodesic, HeatOptions, HeatTriangles};
pub use source::{SurfacePoint, nearest_point};
