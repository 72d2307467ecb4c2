//! Sparse matrices, orderings and factorisations. The only home of the crate `faer`.
//!
//! A factorisation has three steps that are paid at different rates: an order of elimination and an analysis once a
//! pattern ([`fill_reducing_order`], [`SymbolicCholesky`]), a numeric factor once a matrix, and solves
//! ([`Cholesky`]). Everything runs on one thread: faer's threads made every size tried here slower.

mod cholesky;
mod ordering;
mod product;
pub mod small;
mod sparse;

pub use cholesky::{Cholesky, FactorError, SymbolicCholesky};
pub use ordering::{Permutation, fill_reducing_order, minimum_degree, nested_dissection};
pub use sparse::{CsrMatrix, MatrixError};
