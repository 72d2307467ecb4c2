//! The numeric factor of a symmetric indefinite matrix.

use super::multifrontal::Kind;
use super::numeric::Numeric;
use super::compliance::{Compliance, SparseRow};
use super::{FactorError, SymbolicCholesky};

/// A factor `L D Lᵀ` of a symmetric indefinite matrix, D with blocks of one and two.
///
/// Pivots are sought within supernodes only, so that the analysis of the pattern stays valid; where that is not enough for full
/// accuracy, refine. Threads and bits as for [`Cholesky`](super::Cholesky).
///
/// # Source
/// Bunch and Kaufman 1977; Schenk and Gärtner 2006 (pivoting within supernodes).
pub struct Lblt(Numeric<f64>);

impl Lblt {
    /// Makes room for factors of `symbolic` and for solves with up to `columns` right-hand sides at a time, at most 8.
    pub fn new(symbolic: &SymbolicCholesky, columns: usize) -> Self {
        Self(Numeric::new(symbolic, columns, Kind::Indefinite))
    }

    /// Factors the matrix with the given values; the old factor is gone, also on failure.
    ///
    /// # Arguments
    /// * `values`: [`SymbolicCholesky::entries`] numbers, placed by [`SymbolicCholesky::slot`].
    ///
    /// # Errors
    /// [`FactorError::SingularPivot`] with the unknown.
    pub fn factor(&mut self, symbolic: &SymbolicCholesky, values: &[f64]) -> Result<(), FactorError> {
        self.0.factor(symbolic, values).map_err(|unknown| FactorError::SingularPivot { unknown })
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
