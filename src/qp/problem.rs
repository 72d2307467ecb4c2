//! The problem: a quadratic objective in terms, fixed unknowns, rows in cones.

use crate::linalg::{CsrMatrix, sort_and_deduplicate};

use super::QpError;

/// A symmetric positive semi-definite part `P_t` of the quadratic form `1/2 xᵀ P x`.
#[derive(Debug, Clone, PartialEq)]
pub enum Term {
    /// A matrix with both triangles stored, `n x n`.
    Matrix(CsrMatrix),
    /// A diagonal of n nonnegative numbers.
    Diagonal(Vec<f64>),
    /// `scale * L (W L)^(order - 1)` with `W = diag(weights)`: a polyharmonic energy of the given order.
    ///
    /// The product is formed for the factorisation only. Residuals and energies multiply through the chain by
    /// differences, since the rounded entries of the formed product lose every digit at order 4.
    Chain {
        /// Factor of the whole term, `>= 0`.
        scale: f64,
        /// Symmetric `n x n` matrix whose rows sum to zero, positive semi-definite; its diagonal is read for the
        /// factorisation only.
        stiffness: CsrMatrix,
        /// The n nonnegative weights between the factors (one over the lumped mass, times a mask).
        weights: Vec<f64>,
        /// Number of factors L, at least 1.
        order: usize,
    },
}

/// The objective `1/2 xᵀ P x + qᵀ x + c` with `P` the sum of the terms.
#[derive(Debug, Clone, PartialEq)]
pub struct Objective {
    /// The parts of P.
    pub terms: Vec<Term>,
    /// q, n numbers.
    pub linear: Vec<f64>,
    /// c. Include it: gaps are judged relative to the value with it.
    pub constant: f64,
}

/// A set that a run of consecutive rows of `A x + b` must lie in.
///
/// A positive semi-definite block owns consecutive rows, the *scaled vector* of its symmetric matrix S: the lower triangle row by
/// row, off-diagonal entries times √2, so that `zᵀ s = trace(Z S)`. Slacks and duals of a block are scaled vectors too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cone {
    /// The given number of rows, each `>= 0`.
    NonNegative(usize),
    /// The given number of positive semi-definite 2 x 2 blocks, three rows each: (s11, √2 s21, s22).
    Psd2(usize),
    /// The given number of positive semi-definite 3 x 3 blocks, six rows each: (s11, √2 s21, s22, √2 s31, √2 s32, s33).
    Psd3(usize),
}

impl Cone {
    /// Rows that the cone takes.
    pub fn rows(&self) -> usize {
        match self {
            Self::NonNegative(rows) => *rows,
            Self::Psd2(blocks) => 3 * blocks,
            Self::Psd3(blocks) => 6 * blocks,
        }
    }

    /// Constraints in the cone: a row of a nonnegative cone is one, and a block is one.
    pub fn members(&self) -> usize {
        match self {
            Self::NonNegative(count) | Self::Psd2(count) | Self::Psd3(count) => *count,
        }
    }

    /// Order of the matrix of a member: 1 for a nonnegative row.
    pub fn order(&self) -> usize {
        match self {
            Self::NonNegative(_) => 1,
            Self::Psd2(_) => 2,
            Self::Psd3(_) => 3,
        }
    }
}

/// `A x + b` lies in the product of cones.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraints {
    /// A, `m x n`.
    pub matrix: CsrMatrix,
    /// b, m numbers.
    pub offset: Vec<f64>,
    /// The cones of consecutive runs of rows; their rows add up to m.
    pub cones: Vec<Cone>,
}

impl Constraints {
    /// `A x + b >= 0` in every row.
    ///
    /// # Arguments
    /// * `matrix`: A, `m x n`; `offset`: b, m numbers.
    pub fn nonnegative(matrix: CsrMatrix, offset: Vec<f64>) -> Self {
        let cones = vec![Cone::NonNegative(matrix.rows())];
        Self { matrix, offset, cones }
    }

    /// Every three rows of `A x + b` are a positive semi-definite 2 x 2 matrix; see [`Cone::Psd2`].
    ///
    /// # Arguments
    /// * `matrix`: A, `3 b x n` for b blocks; `offset`: b, 3 b numbers.
    pub fn psd2(matrix: CsrMatrix, offset: Vec<f64>) -> Self {
        let cones = vec![Cone::Psd2(matrix.rows() / 3)];
        Self { matrix, offset, cones }
    }

    /// Every six rows of `A x + b` are a positive semi-definite 3 x 3 matrix; see [`Cone::Psd3`].
    ///
    /// # Arguments
    /// * `matrix`: A, `6 b x n` for b blocks; `offset`: b, 6 b numbers.
    pub fn psd3(matrix: CsrMatrix, offset: Vec<f64>) -> Self {
        let cones = vec![Cone::Psd3(matrix.rows() / 6)];
        Self { matrix, offset, cones }
    }

    /// Number of constraints: a nonnegative row counts as one and a block as one, in the order of the cones.
    pub fn members(&self) -> usize {
        self.cones.iter().map(Cone::members).sum()
    }

    /// First row and matrix order (1, 2, 3) of each constraint.
    pub fn member_rows(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.cones
            .iter()
            .scan(0, |row, cone| {
                let first = *row;
                *row += cone.rows();
                Some((first, cone))
            })
            .flat_map(|(first, cone)| {
                let order = cone.order();
                (0..cone.members()).map(move |member| (first + member * order * (order + 1) / 2, order))
            })
    }

    /// One row a constraint, ones at all unknowns that it touches: what an engine's pattern must couple.
    ///
    /// For constraints with blocks give this to [`Engine::new`](super::Engine::new); for rows alone the matrix itself is as good.
    pub fn coupling(&self) -> CsrMatrix {
        let mut offsets = vec![0u32];
        let mut indices: Vec<u32> = Vec::with_capacity(self.matrix.entries());
        for (first, order) in self.member_rows() {
            let begin = indices.len();
            for row in first..first + order * (order + 1) / 2 {
                indices.extend_from_slice(self.matrix.row(row).0);
            }
            sort_and_deduplicate(&mut indices, begin);
            offsets.push(indices.len() as u32);
        }
        let values = vec![1.0; indices.len()];
        CsrMatrix::from_parts(self.members(), self.matrix.columns(), offsets, indices, values)
    }

    /// No rows over n unknowns.
    pub fn none(unknowns: usize) -> Self {
        Self { matrix: CsrMatrix::without_rows(unknowns), offset: Vec::new(), cones: Vec::new() }
    }
}

/// `minimise 1/2 xᵀ P x + qᵀ x + c  subject to  x_i = g_i,  A x + b in K`.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// What is minimised, over n unknowns.
    pub objective: Objective,
    /// The value of each fixed unknown, n entries.
    pub fixed: Vec<Option<f64>>,
    /// The rows.
    pub constraints: Constraints,
}

impl Objective {
    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.linear.len()
    }

    /// First fault of the shapes and numbers, if any.
    ///
    /// # Errors
    /// [`QpError`] with the place and what was expected.
    pub fn check(&self) -> Result<(), QpError> {
        let n = self.unknowns();
        finite("linear", &self.linear)?;
        finite("constant", &[self.constant])?;
        for (index, term) in self.terms.iter().enumerate() {
            match term {
                Term::Matrix(matrix) => shape(matrix, n, n)?,
                Term::Diagonal(diagonal) => {
                    length("diagonal", diagonal.len(), n)?;
                    nonnegative("diagonal", diagonal)?;
                }
                Term::Chain { scale, stiffness, weights, order } => {
                    shape(stiffness, n, n)?;
                    length("weights", weights.len(), n)?;
                    nonnegative("weights", weights)?;
                    nonnegative("scale", &[*scale])?;
                    if *order == 0 {
                        return Err(QpError::ChainOrder { term: index });
                    }
                    check_laplacian(stiffness)?;
                }
            }
        }
        Ok(())
    }
}

impl Problem {
    /// First fault of the shapes and numbers, if any.
    ///
    /// # Errors
    /// [`QpError`] with the place and what was expected.
    pub fn check(&self) -> Result<(), QpError> {
        self.objective.check()?;
        let n = self.objective.unknowns();
        check_fixed(&self.fixed, n)?;
        let rows = self.constraints.offset.len();
        shape(&self.constraints.matrix, rows, n)?;
        finite("offset", &self.constraints.offset)?;
        length("cones", self.constraints.cones.iter().map(Cone::rows).sum(), rows)?;
        for row in 0..rows {
            finite("rows", self.constraints.matrix.row(row).1)?;
        }
        Ok(())
    }
}

pub(super) fn check_fixed(fixed: &[Option<f64>], unknowns: usize) -> Result<(), QpError> {
    length("fixed", fixed.len(), unknowns)?;
    match fixed.iter().position(|value| value.is_some_and(|value| !value.is_finite())) {
        Some(index) => Err(QpError::NotFinite { array: "fixed", index, value: fixed[index].unwrap_or(f64::NAN) }),
        None => Ok(()),
    }
}

fn shape(matrix: &CsrMatrix, rows: usize, columns: usize) -> Result<(), QpError> {
    if (matrix.rows(), matrix.columns()) == (rows, columns) {
        Ok(())
    } else {
        Err(QpError::Shape { rows, columns, found_rows: matrix.rows(), found_columns: matrix.columns() })
    }
}

pub(super) fn length(array: &'static str, found: usize, expected: usize) -> Result<(), QpError> {
    if found == expected { Ok(()) } else { Err(QpError::Length { array, expected, found }) }
}

pub(super) fn finite(array: &'static str, values: &[f64]) -> Result<(), QpError> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(QpError::NotFinite { array, index, value: values[index] }),
        None => Ok(()),
    }
}

fn nonnegative(array: &'static str, values: &[f64]) -> Result<(), QpError> {
    finite(array, values)?;
    match values.iter().position(|&value| value < 0.0) {
        Some(index) => Err(QpError::Negative { array, index, value: values[index] }),
        None => Ok(()),
    }
}

/// Products by differences never read the diagonal, so the rows must sum to zero up to rounding.
fn check_laplacian(stiffness: &CsrMatrix) -> Result<(), QpError> {
    for row in 0..stiffness.rows() {
        let values = stiffness.row(row).1;
        finite("stiffness", values)?;
        let (sum, size) = values.iter().fold((0.0, 0.0), |(sum, size), value| (sum + value, size + value.abs()));
        if sum.abs() > 1e-9 * size {
            return Err(QpError::RowSum { row, sum, size });
        }
    }
    Ok(())
}
