//! Sparse matrices, orderings and factorisations. The only home of the crate `faer`.

mod sparse;

pub use sparse::{CsrMatrix, MatrixError};
