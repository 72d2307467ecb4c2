//! Two augmented Lagrangians of "S is positive semi-definite" for one small matrix.

// Entries of small matrices are named by their indices, as in the formulas.
#![allow(clippy::needless_range_loop)]

use crate::linalg::small::{Square, identity, inverse, product, square_root, symmetric_eigen};

/// Which augmented Lagrangian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lagrangian {
    /// `trace p phi(-V S V / p)` with the multiplier `U = V²` and phi quadratic above -1/2, logarithmic below.
    ///
    /// # Source
    /// Apkarian, Noll, Thevenet, Tuan 2004; phi is that of Ben-Tal and Zibulevsky 1997.
    Spectral,
    /// `p² <U, (S + p I)⁻¹> - p trace U`, defined where `S + p I` is positive definite.
    ///
    /// # Source
    /// Kočvara and Stingl 2003.
    Pennon,
}

/// The augmented term of one matrix at one S, by rest measure.
pub(super) struct Term<const D: usize> {
    pub value: f64,
    /// Its derivative by S.
    pub slope: Square<D>,
    /// The next multiplier: minus the slope, but no eigenvalue less than [`LEAST_SHARE`] of what it was.
    pub next: Square<D>,
    /// Its second derivative `sum c (a Dir b)²`: c, a, b.
    pub squares: Vec<(f64, [f64; D], [f64; D])>,
}

/// A multiplier shrinks to no less than this share in a round: one that has vanished at a block which is inactive for a while would
/// take many rounds to come back. PENNON restricts its updates alike.
const LEAST_SHARE: f64 = 0.3;

/// phi, phi', phi''.
fn phi(t: f64) -> [f64; 3] {
    if t >= -0.5 { [t + 0.5 * t * t, 1.0 + t, 1.0] } else { [-0.25 * (-2.0 * t).ln() - 0.375, -0.25 / t, 0.25 / (t * t)] }
}

impl Lagrangian {
    /// The value alone; infinite outside its domain.
    pub(super) fn value<const D: usize>(self, multiplier: &Square<D>, p: f64, s: &Square<D>) -> f64 {
        match self {
            Self::Spectral => {
                let root = square_root(multiplier);
                let (values, _) = symmetric_eigen(&negated(&product(&product(&root, s), &root)));
                values.iter().map(|t| p * phi(t / p)[0]).sum()
            }
            Self::Pennon => match resolvent(s, p) {
                Some(m) => p * p * trace_of_product(multiplier, &m) - p * trace(multiplier),
                None => f64::INFINITY,
            },
        }
    }

    /// Value and derivatives; `None` outside its domain.
    pub(super) fn expand<const D: usize>(self, multiplier: &Square<D>, p: f64, s: &Square<D>) -> Option<Term<D>> {
        let (mut slope, mut next) = ([[0.0; D]; D], [[0.0; D]; D]);
        let mut squares = Vec::with_capacity(D * D);
        match self {
            Self::Spectral => {
                let root = square_root(multiplier);
                let (values, vectors) = symmetric_eigen(&negated(&product(&product(&root, s), &root)));
                let parts = values.map(|t| phi(t / p));
                // y_i = V w_i.
                let images = product(&root, &vectors);
                let column = |i: usize| -> [f64; D] { std::array::from_fn(|row| images[row][i]) };
                for i in 0..D {
                    add_square(&mut slope, -parts[i][1], &column(i));
                    add_square(&mut next, parts[i][1].max(LEAST_SHARE), &column(i));
                    squares.push((parts[i][2] / p, column(i), column(i)));
                    for j in 0..i {
                        let apart = values[i] - values[j];
                        let secant = if apart.abs() > 1e-9 * p { (parts[i][1] - parts[j][1]) / apart } else { parts[i][2] / p };
                        squares.push((2.0 * secant, column(i), column(j)));
                    }
                }
                Some(Term { value: parts.iter().map(|part| p * part[0]).sum(), slope, next, squares })
            }
            Self::Pennon => {
                let m = resolvent(s, p)?;
                let inner = product(&product(&m, multiplier), &m);
                let symmetric = std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (inner[i][j] + inner[j][i])));
                let (outer_values, outer) = symmetric_eigen(&m);
                let (inner_values, vectors) = symmetric_eigen(&symmetric);
                for k in 0..D {
                    for l in 0..D {
                        let weight = 2.0 * p * p * outer_values[k].max(0.0) * inner_values[l].max(0.0);
                        squares.push((weight, outer.map(|row| row[k]), vectors.map(|row| row[l])));
                    }
                }
                let value = p * p * trace_of_product(multiplier, &m) - p * trace(multiplier);
                let exact = symmetric.map(|row| row.map(|entry| p * p * entry));
                let share: Square<D> = std::array::from_fn(|i| {
                    std::array::from_fn(|j| exact[i][j] - LEAST_SHARE * multiplier[i][j])
                });
                // exact or a share of the old one, whichever is more: the part of their difference that is positive.
                let mut next = multiplier.map(|row| row.map(|entry| LEAST_SHARE * entry));
                let (values, vectors) = symmetric_eigen(&share);
                for i in 0..D {
                    add_square(&mut next, values[i].max(0.0), &vectors.map(|row| row[i]));
                }
                Some(Term { value, slope: exact.map(|row| row.map(|entry| -entry)), next, squares })
            }
        }
    }
}

/// `(S + p I)⁻¹`, if it is positive definite.
fn resolvent<const D: usize>(s: &Square<D>, p: f64) -> Option<Square<D>> {
    let shifted: Square<D> = std::array::from_fn(|i| std::array::from_fn(|j| s[i][j] + if i == j { p } else { 0.0 }));
    // NaN fails too.
    if symmetric_eigen(&shifted).0[0] > 0.0 { inverse(&shifted) } else { None }
}

fn negated<const D: usize>(a: &Square<D>) -> Square<D> {
    std::array::from_fn(|i| std::array::from_fn(|j| -0.5 * (a[i][j] + a[j][i])))
}

fn add_square<const D: usize>(matrix: &mut Square<D>, weight: f64, vector: &[f64; D]) {
    for i in 0..D {
        for j in 0..D {
            matrix[i][j] += weight * vector[i] * vector[j];
        }
    }
}

/// `trace(A B)` of symmetric matrices.
pub(super) fn trace_of_product<const D: usize>(a: &Square<D>, b: &Square<D>) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum()
}

fn trace<const D: usize>(a: &Square<D>) -> f64 {
    trace_of_product(a, &identity::<D>())
}
