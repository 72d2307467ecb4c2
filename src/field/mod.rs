//! Scalar fields and the one strict total order in which their vertices are compared.

mod order;
mod sort;

pub use order::{FieldError, VertexId, VertexOrder, check_finite};
