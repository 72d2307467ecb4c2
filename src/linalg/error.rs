//! What ordering, analysing and factoring can refuse.

/// Why a matrix could not be ordered, analysed or factored.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FactorError {
    /// The matrix has more rows than columns, or the other way round.
    #[error("matrix is {rows} x {columns}; a square one was expected")]
    NotSquare {
        /// Rows found.
        rows: usize,
        /// Columns found.
        columns: usize,
    },
    /// There is not one place for each unknown.
    #[error("{found} coordinates for {expected} unknowns")]
    CoordinateCount {
        /// Unknowns.
        expected: usize,
        /// Coordinates given.
        found: usize,
    },
    /// A list is not a permutation.
    #[error("index {index} is out of range or named twice in a permutation of {size}")]
    NotAPermutation {
        /// The index.
        index: usize,
        /// Length of the list.
        size: usize,
    },
    /// A matrix entry has no place in the analysed pattern.
    #[error("entry ({row}, {column}) lies outside the analysed pattern")]
    OutsidePattern {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
    },
    /// A pivot was zero or negative: the matrix is not positive definite in floating point.
    #[error("pivot of unknown {unknown} is not positive")]
    NonPositivePivot {
        /// The unknown (old numbering) whose pivot failed.
        unknown: usize,
    },
    /// No pivot of an indefinite matrix could be found within a supernode: the matrix is singular in floating point.
    #[error("pivot of unknown {unknown} is zero or not finite")]
    SingularPivot {
        /// The unknown (old numbering) whose pivot failed.
        unknown: usize,
    },
    /// The factorisation library gave up (memory, index range).
    #[error("factorisation library: {message}")]
    Engine {
        /// Its words.
        message: String,
    },
}
