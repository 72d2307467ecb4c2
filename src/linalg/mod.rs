//! Sparse matrices, orderings and factorisations. The only home of the crate `faer`.
//!
//! A factorisation has three steps that are paid at different rates: an order of elimination and an analysis once a
//! pattern ([`fill_reducing_order`], [`SymbolicCholesky`]), a numeric factor once a matrix, and solves
//! ([`Cholesky`], or [`Lblt`] where the matrix is indefinite). faer analyses and supplies the dense kernels; the elimination over the tree is ours, so that independent
//! subtrees run on all threads (faer's own threads made every size tried here slower).

mod assembly;
mod cholesky;
mod compliance;
mod dense;
mod dissection;
mod error;
mod front;
mod indefinite;
mod multifrontal;
mod numeric;
mod ordering;
mod pattern;
mod permutation;
mod pivoting;
mod pool;
mod product;
pub mod small;
mod sparse;
mod substitution;
mod tasks;
mod value;

pub use cholesky::{Cholesky, Factor};
pub use compliance::{Compliance, SparseRow};
pub use dense::solve_symmetric;
pub use error::FactorError;
pub use indefinite::Lblt;
pub use ordering::{fill_reducing_order, minimum_degree, nested_dissection};
pub use pattern::SymbolicCholesky;
pub use permutation::Permutation;
pub(crate) use product::sort_and_deduplicate;
pub use sparse::{CsrMatrix, MatrixError};
pub use value::Value;
