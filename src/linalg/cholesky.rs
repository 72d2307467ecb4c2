//! The numeric Cholesky factor: made once, filled often, solved in place.

use super::multifrontal::Kind;
use super::numeric::Numeric;
use super::compliance::{Compliance, SparseRow};
use super::{FactorError, SymbolicCholesky, Value};

/// A Cholesky factor in double precision.
pub type Cholesky = Factor<f64>;

/// A numeric Cholesky factor with all the memory that factoring and solving need.
///
/// Independent subtrees of the elimination run side by side on rayon's threads, and large fronts are cut into tiles of a fixed size:
/// the same matrix gives the same bits for any number of threads. In single precision it is half as large, a
/// preconditioner for refinement or conjugate gradients.
///
/// # Source
/// Duff and Reid 1983 (multifrontal elimination); Liu 1992 (its trees and stacks).
pub struct Factor<T>(Numeric<T>);

impl<T: Value> Factor<T> {
    /// Makes room for factors of `symbolic` and for solves with up to `columns` right-hand sides at a time, at most 8.
    pub fn new(symbolic: &SymbolicCholesky, columns: usize) -> Self {
        Self(Numeric::new(symbolic, columns, Kind::Definite))
    }

    /// Factors the matrix with the given values; the old factor is gone, also on failure.
    ///
    /// # Arguments
    /// * `values`: [`SymbolicCholesky::entries`] numbers, placed by [`SymbolicCholesky::slot`].
    ///
    /// # Errors
    /// [`FactorError::NonPositivePivot`] with the unknown, the first one in the order of elimination.
    ///
    /// # Cost
    /// [`SymbolicCholesky::factor_flops`]; work memory is kept for the next call.
    pub fn factor(&mut self, symbolic: &SymbolicCholesky, values: &[f64]) -> Result<(), FactorError> {
        self.0.factor(symbolic, values).map_err(|unknown| FactorError::NonPositivePivot { unknown })
    }

    /// Overwrites each right-hand side with its solution.
    ///
    /// # Arguments
    /// * `sides`: any number of right-hand sides of `n` numbers, one after the other.
    pub fn solve_in_place(&mut self, symbolic: &SymbolicCholesky, sides: &mut [f64]) {
        self.0.solve_in_place(symbolic, sides);
    }

    /// Adds rows to the compliance `B A⁻¹ Bᵀ`.
    ///
    /// # Arguments
    /// * `compliance`: empty, or of rows that were added with the same numeric factor.
    /// * `rows`: coefficients of unknowns; rows that share unknowns are best neighbours.
    ///
    /// # Cost
    /// A row goes through the columns of the factor between its unknowns and the root, and once more with each row that meets it there.
    pub fn comply(&self, symbolic: &SymbolicCholesky, compliance: &mut Compliance, rows: &[SparseRow]) {
        self.0.comply(symbolic, compliance, rows);
    }
}
