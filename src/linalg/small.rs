//! Algebra of 2 x 2 and 3 x 3 matrices, written once for both sizes and unrolled by the compiler.
//!
//! A matrix is an array of rows. Symmetric matrices travel as *scaled vectors*, the lower triangle row by row with
//! off-diagonal entries times the square root of two, so that the dot product of two is the trace of their product:
//! (s11, √2 s21, s22) and (s11, √2 s21, s22, √2 s31, √2 s32, s33).

// Entries (i, j) and (j, i) of one matrix are read and written together: indices are the formulas.
#![allow(clippy::needless_range_loop)]

use std::f64::consts::FRAC_1_SQRT_2;

/// A D x D matrix, row by row.
pub type Square<const D: usize> = [[f64; D]; D];

/// Most sweeps of a Jacobi iteration; three or four are the rule.
const SWEEPS: usize = 30;

/// Length of the scaled vector of a symmetric D x D matrix.
pub const fn scaled_length(size: usize) -> usize {
    size * (size + 1) / 2
}

/// The symmetric matrix of a scaled vector.
///
/// # Arguments
/// * `vector`: D (D + 1) / 2 numbers.
#[inline]
pub fn from_scaled<const D: usize>(vector: &[f64]) -> Square<D> {
    let mut matrix = [[0.0; D]; D];
    let mut place = 0;
    for row in 0..D {
        for column in 0..row {
            let value = vector[place] * FRAC_1_SQRT_2;
            matrix[row][column] = value;
            matrix[column][row] = value;
            place += 1;
        }
        matrix[row][row] = vector[place];
        place += 1;
    }
    matrix
}

/// Writes the scaled vector of the symmetric part of a matrix.
///
/// # Arguments
/// * `vector`: D (D + 1) / 2 numbers, overwritten.
#[inline]
pub fn to_scaled<const D: usize>(matrix: &Square<D>, vector: &mut [f64]) {
    let mut place = 0;
    for row in 0..D {
        for column in 0..row {
            vector[place] = (matrix[row][column] + matrix[column][row]) * FRAC_1_SQRT_2;
            place += 1;
        }
        vector[place] = matrix[row][row];
        place += 1;
    }
}

/// The identity.
pub const fn identity<const D: usize>() -> Square<D> {
    let mut matrix = [[0.0; D]; D];
    let mut i = 0;
    while i < D {
        matrix[i][i] = 1.0;
        i += 1;
    }
    matrix
}

/// The transpose.
#[inline]
pub fn transposed<const D: usize>(a: &Square<D>) -> Square<D> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// `A B`.
#[inline]
pub fn product<const D: usize>(a: &Square<D>, b: &Square<D>) -> Square<D> {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..D).map(|k| a[i][k] * b[k][j]).sum()))
}

/// `A X Aᵀ`; symmetric, to the last bit, for symmetric X.
#[inline]
pub fn congruence<const D: usize>(a: &Square<D>, x: &Square<D>) -> Square<D> {
    let ax = product(a, x);
    let mut result = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..=i {
            let value = (0..D).map(|k| ax[i][k] * a[j][k]).sum();
            result[i][j] = value;
            result[j][i] = value;
        }
    }
    result
}

/// The determinant, D at most 3.
#[inline]
pub fn determinant<const D: usize>(a: &Square<D>) -> f64 {
    match D {
        1 => a[0][0],
        2 => a[0][0] * a[1][1] - a[0][1] * a[1][0],
        3 => (0..3).map(|j| a[0][j] * cofactor3(a, 0, j)).sum(),
        _ => unreachable!("matrices here are at most 3 x 3"),
    }
}

/// The inverse by cofactors, D at most 3; `None` if the determinant is zero or not finite. Good for well conditioned matrices: it loses twice
/// as many digits as the condition number has.
#[inline]
pub fn inverse<const D: usize>(a: &Square<D>) -> Option<Square<D>> {
    let determinant = determinant(a);
    if determinant == 0.0 || !determinant.is_finite() {
        return None;
    }
    let adjugate = |i: usize, j: usize| match D {
        1 => 1.0,
        2 if i == j => a[1 - i][1 - j],
        2 => -a[i][j],
        _ => cofactor3(a, j, i),
    };
    Some(std::array::from_fn(|i| std::array::from_fn(|j| adjugate(i, j) / determinant)))
}

fn cofactor3<const D: usize>(a: &Square<D>, i: usize, j: usize) -> f64 {
    let (r, s) = ((i + 1) % 3, (i + 2) % 3);
    let (c, d) = ((j + 1) % 3, (j + 2) % 3);
    a[r][c] * a[s][d] - a[r][d] * a[s][c]
}

/// The lower triangular L with positive diagonal and `L Lᵀ = A`; `None` unless A is positive definite in floating point.
///
/// # Arguments
/// * `a`: symmetric; the lower triangle is read.
#[inline]
pub fn cholesky<const D: usize>(a: &Square<D>) -> Option<Square<D>> {
    let mut factor = [[0.0; D]; D];
    for j in 0..D {
        let pivot = a[j][j] - (0..j).map(|k| factor[j][k] * factor[j][k]).sum::<f64>();
        // Written so that NaN fails too.
        if !(pivot > 0.0 && pivot.is_finite()) {
            return None;
        }
        let root = pivot.sqrt();
        factor[j][j] = root;
        for i in j + 1..D {
            factor[i][j] = (a[i][j] - (0..j).map(|k| factor[i][k] * factor[j][k]).sum::<f64>()) / root;
        }
    }
    Some(factor)
}

/// Cosine, sine and tangent of the Jacobi rotation that annihilates the off-diagonal entry of a symmetric 2 x 2 matrix.
#[inline]
fn rotation(first: f64, off: f64, second: f64) -> (f64, f64, f64) {
    let theta = (second - first) / (2.0 * off);
    // For |theta| so large that its square overflows, 1/(2 theta) is exact; it comes out of the formula as 0 or so, harmlessly.
    let tangent = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
    (cosine, tangent * cosine, tangent)
}

/// Eigenvalues, rising, and eigenvectors, the columns of an orthogonal V with `A = V diag(values) Vᵀ`.
///
/// For D = 2 one rotation, in closed form; for D = 3 cyclic Jacobi sweeps, accurate to rounding of the largest eigenvalue.
///
/// # Arguments
/// * `a`: symmetric.
///
/// # Source
/// Golub and Van Loan 2013, section 8.5.
#[inline]
pub fn symmetric_eigen<const D: usize>(a: &Square<D>) -> ([f64; D], Square<D>) {
    let mut a = *a;
    let mut vectors = identity::<D>();
    for _ in 0..SWEEPS {
        let mut off = 0.0;
        let mut size = 0.0;
        for i in 0..D {
            size += a[i][i] * a[i][i];
            for j in 0..i {
                off += a[i][j] * a[i][j];
            }
        }
        // Far below half an ulp of the largest entry; NaN ends the loop too.
        if off.is_nan() || off <= 1e-36 * (size + off) {
            break;
        }
        for p in 0..D {
            for q in p + 1..D {
                if a[p][q] == 0.0 {
                    continue;
                }
                let (c, s, t) = rotation(a[p][p], a[p][q], a[q][q]);
                let off = a[p][q];
                a[p][p] -= t * off;
                a[q][q] += t * off;
                a[p][q] = 0.0;
                a[q][p] = 0.0;
                for k in 0..D {
                    if k != p && k != q {
                        let (kp, kq) = (a[k][p], a[k][q]);
                        a[k][p] = c * kp - s * kq;
                        a[p][k] = a[k][p];
                        a[k][q] = s * kp + c * kq;
                        a[q][k] = a[k][q];
                    }
                }
                for row in &mut vectors {
                    let (vp, vq) = (row[p], row[q]);
                    row[p] = c * vp - s * vq;
                    row[q] = s * vp + c * vq;
                }
            }
        }
    }
    let mut values: [f64; D] = std::array::from_fn(|i| a[i][i]);
    for end in (1..D).rev() {
        for i in 0..end {
            if values[i] > values[i + 1] {
                values.swap(i, i + 1);
                for row in &mut vectors {
                    row.swap(i, i + 1);
                }
            }
        }
    }
    (values, vectors)
}

/// The smallest eigenvalue of a symmetric matrix, D at most 3.
///
/// Closed form for D = 2; for D = 3 the trigonometric solution, accurate to about 1e-8 of the largest eigenvalue where two
/// eigenvalues meet: good for step lengths. For more digits use [`symmetric_eigen`].
///
/// # Source
/// Smith 1961, *Eigenvalues of a symmetric 3 x 3 matrix*.
#[inline]
pub fn smallest_eigenvalue<const D: usize>(a: &Square<D>) -> f64 {
    match D {
        1 => a[0][0],
        2 => {
            let (mean, half) = (0.5 * (a[0][0] + a[1][1]), 0.5 * (a[0][0] - a[1][1]));
            mean - (half * half + a[1][0] * a[1][0]).sqrt()
        }
        _ => {
            let mean = (a[0][0] + a[1][1] + a[2][2]) / 3.0;
            let off = a[1][0] * a[1][0] + a[2][0] * a[2][0] + a[2][1] * a[2][1];
            let spread: f64 = (0..3).map(|i| (a[i][i] - mean) * (a[i][i] - mean)).sum::<f64>() + 2.0 * off;
            let radius = (spread / 6.0).sqrt();
            if radius == 0.0 {
                return mean;
            }
            let shape: Square<D> = std::array::from_fn(|i| {
                std::array::from_fn(|j| (a[i][j] - if i == j { mean } else { 0.0 }) / radius)
            });
            let angle = (0.5 * determinant(&shape)).clamp(-1.0, 1.0).acos() / 3.0;
            mean + 2.0 * radius * (angle + 2.0 * std::f64::consts::FRAC_PI_3).cos()
        }
    }
}

/// `V diag(f(values)) Vᵀ` over the eigenvalues of a symmetric matrix.
#[inline]
pub fn spectral<const D: usize>(a: &Square<D>, f: impl Fn(f64) -> f64) -> Square<D> {
    let (values, vectors) = symmetric_eigen(a);
    composed(&std::array::from_fn(|i| f(values[i])), &vectors)
}

/// `V diag(values) Vᵀ`.
#[inline]
pub fn composed<const D: usize>(values: &[f64; D], vectors: &Square<D>) -> Square<D> {
    let mut result = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..=i {
            let value = (0..D).map(|k| vectors[i][k] * values[k] * vectors[j][k]).sum();
            result[i][j] = value;
            result[j][i] = value;
        }
    }
    result
}

/// The symmetric positive semi-definite square root; negative eigenvalues, of rounding, count as zero.
#[inline]
pub fn square_root<const D: usize>(a: &Square<D>) -> Square<D> {
    spectral(a, |value| value.max(0.0).sqrt())
}

/// A singular value decomposition `G = U diag(values) Vᵀ`, values nonnegative and in no particular order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmallSvd<const D: usize> {
    /// Orthonormal columns; a column of a zero value is zero.
    pub left: Square<D>,
    /// The singular values.
    pub values: [f64; D],
    /// Orthogonal.
    pub right: Square<D>,
}

/// The singular value decomposition by one-sided Jacobi rotations; small values keep their relative digits where the columns
/// are badly scaled rather than nearly parallel.
///
/// # Source
/// Demmel and Veselić 1992.
#[inline]
pub fn singular_values<const D: usize>(g: &Square<D>) -> SmallSvd<D> {
    // Columns as arrays.
    let mut columns = transposed(g);
    let mut right = identity::<D>();
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..D {
            for q in p + 1..D {
                let dot = |a: &[f64; D], b: &[f64; D]| (0..D).map(|k| a[k] * b[k]).sum::<f64>();
                let (a, b, off) =
                    (dot(&columns[p], &columns[p]), dot(&columns[q], &columns[q]), dot(&columns[p], &columns[q]));
                if off == 0.0 || off.is_nan() || off * off <= 1e-31 * a * b {
                    continue;
                }
                rotated = true;
                let (c, s, _) = rotation(a, off, b);
                for k in 0..D {
                    let (x, y) = (columns[p][k], columns[q][k]);
                    columns[p][k] = c * x - s * y;
                    columns[q][k] = s * x + c * y;
                    let (x, y) = (right[k][p], right[k][q]);
                    right[k][p] = c * x - s * y;
                    right[k][q] = s * x + c * y;
                }
            }
        }
        if !rotated {
            break;
        }
    }
    let mut left = [[0.0; D]; D];
    let mut values = [0.0; D];
    for j in 0..D {
        let size = columns[j].iter().map(|x| x * x).sum::<f64>().sqrt();
        values[j] = size;
        if size > 0.0 {
            for i in 0..D {
                left[i][j] = columns[j][i] / size;
            }
        }
    }
    SmallSvd { left, values, right }
}
