//! Domains: cells and grids of a file, masked and subdivided into a simplicial complex of dimension 1, 2 or 3.

mod cells;
mod complex;
mod domain;
mod fault;
mod grid;

pub use cells::{CellList, CellShape};
pub use complex::{EdgeId, MeshError, SimplicialComplex, TriangleId};
pub use domain::{Domain, DomainError, Mask};
pub use fault::{MeshFault, Severity};
pub use grid::{Grid, GridGeometry};

/// A simplex counts as one of zero measure below this ratio of measure to longest edge to the power of the dimension.
///
/// About fifty times the relative rounding error of the measure. A right-angled triangle of aspect ratio 1e13 still
/// passes.
pub const ZERO_MEASURE: f64 = 1e-14;
