//! Domains: cells and grids of a file, masked and subdivided into a simplicial complex of dimension 1, 2 or 3.
//!
//! [`Domain`] is the way in: it keeps the way back from vertices to the user's points and from simplices to the user's
//! cells, and notes what it handled. [`faults`] lists everything that is wrong with a domain, [`check`] the first thing
//! that stands in the way of a computation.
//!
//! What is handled: several components, boundary, any genus, non-manifold edges, faces and vertices, unoriented
//! meshes, duplicate cells and points, collapsed cells, unreferenced points, cells of lower dimension. What is
//! refused: coordinates that are not finite, simplices of zero measure, cells without a linear subdivision.
//!
//! [`triangulate`] fills outlines with triangles. [`HandleSet::attach`] finds the vertices that carry points, bones, regions and
//! cages, and a [`Pose`] says where they go.

mod attach;
mod build;
mod cells;
mod complex;
mod delaunay;
mod domain;
mod error;
mod explicit;
mod fault;
mod faults;
mod fold;
mod grid;
mod handle_error;
mod handles;
mod implicit;
mod incidence;
mod lattice;
mod measure;
mod outline;
mod polygon;
mod pose;
mod pose_between;
mod segment;
mod stencil;
mod subdivide;
mod triangulation;

pub use attach::AttachOptions;
pub use cells::{CellList, CellShape};
pub use complex::{EdgeId, MeshError, SimplicialComplex, TriangleId};
pub use delaunay::triangulate;
pub use domain::{Domain, Mask};
pub use error::DomainError;
pub use fault::{MeshFault, Severity};
pub use faults::{check, faults};
pub use fold::{Fold, folds};
pub use grid::{Grid, GridGeometry};
pub use handle_error::HandleError;
pub use handles::{AttachedHandles, Handle, HandleSet, HandleShape, SharedVertex};
pub use implicit::ImplicitGrid;
pub use lattice::FreudenthalLattice;
pub use measure::ZERO_MEASURE;
pub use outline::{OutlineError, OutlineOptions, OutlinePlace, Size};
pub use pose::{HandleTransform, Pose, Rotation};
pub use triangulation::{Cell, Corners, Triangulation};
pub(crate) use measure::{cross, dot, minus, norm};
