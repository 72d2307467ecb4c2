//! Scalar fields, the one strict total order in which their vertices are compared, and the width of their numbers.

mod order;
mod precision;
mod sort;

pub use order::{FieldError, VertexId, VertexOrder, check_finite};
pub use precision::Precision;
