//! What the engine refuses.

use crate::linalg::FactorError;

/// Why a problem was refused. How a solve *ended* is [`QpStatus`](super::QpStatus), not an error.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QpError {
    /// A list has the wrong length.
    #[error("{array} has {found} entries; {expected} were expected")]
    Length {
        /// The list.
        array: &'static str,
        /// Entries expected.
        expected: usize,
        /// Entries found.
        found: usize,
    },
    /// A matrix has the wrong shape.
    #[error("matrix is {found_rows} x {found_columns}; {rows} x {columns} was expected")]
    Shape {
        /// Rows expected.
        rows: usize,
        /// Columns expected.
        columns: usize,
        /// Rows found.
        found_rows: usize,
        /// Columns found.
        found_columns: usize,
    },
    /// A number is NaN or infinite.
    #[error("{array}[{index}] is {value}; a finite number was expected")]
    NotFinite {
        /// The list.
        array: &'static str,
        /// Place in the list.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A number that must not be negative is.
    #[error("{array}[{index}] is {value}; a nonnegative number was expected")]
    Negative {
        /// The list.
        array: &'static str,
        /// Place in the list.
        index: usize,
        /// The number.
        value: f64,
    },
    /// Other unknowns are fixed than those of the factor.
    #[error("unknown {unknown} is fixed in one of two lists only; the same unknowns were expected in both")]
    FixedSet {
        /// The first such unknown.
        unknown: usize,
    },
    /// A chain without factors.
    #[error("term {term} is a chain of order 0; at least 1 was expected")]
    ChainOrder {
        /// Index of the term.
        term: usize,
    },
    /// The stiffness matrix of a chain is no Laplacian.
    #[error("row {row} of the stiffness matrix sums to {sum} (absolute values: {size}); 0 was expected")]
    RowSum {
        /// The row.
        row: usize,
        /// Its sum.
        sum: f64,
        /// The sum of its absolute values.
        size: f64,
    },
    /// A row couples unknowns that the engine's pattern does not couple.
    #[error("row {row} couples unknowns {first} and {second}, outside the analysed pattern; give Constraints::coupling to Engine::new")]
    RowOutsidePattern {
        /// The row.
        row: usize,
        /// One unknown.
        first: usize,
        /// The other.
        second: usize,
    },
    /// The objective has another pattern than the one the engine was made for.
    #[error("term {term} couples unknowns {first} and {second}, outside the analysed pattern")]
    TermOutsidePattern {
        /// Index of the term.
        term: usize,
        /// One unknown.
        first: usize,
        /// The other.
        second: usize,
    },
    /// The matrix could not be factored, even after a shift.
    #[error("the quadratic form is not positive definite on the free unknowns (unknown {unknown}), even after a relative shift of {shift}")]
    NotConvex {
        /// The unknown whose pivot failed.
        unknown: usize,
        /// The largest shift tried, relative to the diagonal.
        shift: f64,
    },
    /// An option of a method is out of range.
    #[error("{option} is {value}; {expected} was expected")]
    Option {
        /// The option.
        option: &'static str,
        /// Its value.
        value: f64,
        /// What was expected, in words.
        expected: &'static str,
    },
    /// The linear algebra refused.
    #[error(transparent)]
    Factor(#[from] FactorError),
}
