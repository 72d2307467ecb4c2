//! Simplicial complexes of dimension 1, 2 and 3.

mod complex;

pub use complex::{EdgeId, MeshError, SimplicialComplex, TriangleId};
