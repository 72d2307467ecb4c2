//! Scalar fields derived from a vector field: what flow visualisation looks at.
//!
//! Literature: Hunt, Wray, Moin 1988, *Eddies, streams, and convergence zones in turbulent flows* (Q); Okubo 1970,
//! *Horizontal dispersion of floatable particles*; Weiss 1991, *The dynamics of enstrophy transfer*.

use super::error::{check_field, check_measures};
use super::gradient::{CHUNK, measures, vertex_average};
use super::OperatorError;
use crate::mesh::{SimplicialComplex, cross, dot, minus, norm};
use rayon::prelude::*;

/// A domain of dimension 2 is planar if no point leaves the plane by more than this fraction of the bounding-box diagonal.
///
/// Wide enough for planes stored in single precision.
pub const PLANAR: f64 = 1e-6;

/// A scalar field derived from a vector field `v`, with `J_ab = ∂v_a / ∂x_b`, `S` and `Ω` its symmetric and
/// antisymmetric part.
///
/// In a plane, the component of `v` across the plane is ignored (but for the magnitude), and no derivative across it is
/// known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Derived {
    /// Planar: the component of the curl along the normal, with sign; in the x–y plane `∂v_y/∂x - ∂v_x/∂y`, positive
    /// if the flow turns counter-clockwise seen from the end of the normal. In 3-D: the length of the curl. `[v / length]`
    Vorticity,
    /// `trace J`; in a plane the two terms of the plane. `[v / length]`
    Divergence,
    /// `|v|`, all three components, on any domain. `[v]`
    Magnitude,
    /// `Q = (|Ω|² - |S|²) / 2` in Frobenius norms; positive where rotation outweighs strain. Planar or 3-D. `[v² / length²]`
    QCriterion,
    /// `W = s_n² + s_s² - ω²`, with `s_n = ∂v_x/∂x - ∂v_y/∂y`, `s_s = ∂v_y/∂x + ∂v_x/∂y` and the vorticity `ω`; negative
    /// where rotation outweighs strain. Planar only. `[v² / length²]`
    OkuboWeiss,
}

impl std::fmt::Display for Derived {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Vorticity => "vorticity",
            Self::Divergence => "divergence",
            Self::Magnitude => "magnitude",
            Self::QCriterion => "q-criterion",
            Self::OkuboWeiss => "okubo-weiss",
        })
    }
}

/// Derives a scalar field from a vector field, at the vertices.
///
/// The gradient of `v` at a vertex is the average over its simplices, weighted by measure (exact for linear fields; one-sided
/// and of first order at the boundary), and the quantity is taken from that average.
///
/// A planar domain may lie in any plane. Its normal points along the positive axis to which it is nearest: the
/// vorticity of a field in the x–y, y–z or z–x plane is the z, x or y component of the curl.
///
/// # Arguments
/// * `complex`: `n` vertices.
/// * `vectors`: `n x 3` components along the axes, in the units of the file.
///
/// # Returns
/// `n` values; units at [`Derived`].
///
/// # Errors
/// [`OperatorError::Undefined`] for a derivative on a curve, on a curved surface, or for Okubo–Weiss in 3-D;
/// [`OperatorError::LengthMismatch`], [`OperatorError::NonFinite`], [`OperatorError::ZeroMeasure`].
///
/// # Cost
/// O(m), in parallel; 8 bytes a simplex beside the result.
///
/// # Example
/// ```
/// use morsmooth::{mesh::SimplicialComplex, operators::{Derived, derive}};
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let turning: Vec<[f64; 3]> = points.iter().map(|p| [-p[1], p[0], 0.0]).collect(); // once around in 2π, counter-clockwise
/// let complex = SimplicialComplex::new(2, points, vec![0, 1, 2])?;
/// assert_eq!(derive(&complex, &turning, Derived::Vorticity)?, [2.0; 3]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn derive(complex: &SimplicialComplex, vectors: &[[f64; 3]], derived: Derived) -> Result<Vec<f64>, OperatorError> {
    check_field(complex, vectors.iter().copied())?;
    if derived == Derived::Magnitude {
        return Ok(vectors.iter().map(|&vector| norm(vector)).collect());
    }
    check_measures(complex)?;
    let measures = measures(complex);
    let undefined = |found, expected| Err(OperatorError::Undefined { derived, found, expected });
    let frame = match complex.dimension() {
        1 => return undefined("a curve", "a planar or volume mesh"),
        2 => match plane(complex, &measures) {
            Some(normal) => Frame::Plane(normal),
            None => return undefined("a curved surface", "a planar or volume mesh"),
        },
        _ if derived == Derived::OkuboWeiss => return undefined("a volume", "a planar mesh (for volumes: q-criterion)"),
        _ => Frame::Space,
    };
    let at_vertex = |vertex: usize| scalar(derived, &frame, &jacobian(complex, &measures, vectors, vertex));
    Ok((0..complex.vertex_count()).into_par_iter().with_min_len(CHUNK).map(at_vertex).collect())
}

/// Where the vectors live.
enum Frame {
    /// A plane with this unit normal.
    Plane([f64; 3]),
    Space,
}

/// The averaged gradient of each component of the vectors; rows are components.
fn jacobian(complex: &SimplicialComplex, measures: &[f64], vectors: &[[f64; 3]], vertex: usize) -> [[f64; 3]; 3] {
    vertex_average(complex, measures, vertex, |basis, corners| {
        let mut rows = [[0.0; 3]; 3];
        for (dual, &corner) in basis.iter().zip(&corners[1..]) {
            let rise = minus(vectors[corner as usize], vectors[corners[0] as usize]);
            for (row, rise) in rows.iter_mut().zip(rise) {
                for (slot, part) in row.iter_mut().zip(dual) {
                    *slot += rise * part;
                }
            }
        }
        rows
    })
}

fn scalar(derived: Derived, frame: &Frame, jacobian: &[[f64; 3]; 3]) -> f64 {
    let j = match frame {
        // Gradients lie in the plane already; the component of the vectors across it goes.
        Frame::Plane(normal) => {
            let across: [f64; 3] = std::array::from_fn(|column| (0..3).map(|row| normal[row] * jacobian[row][column]).sum());
            std::array::from_fn(|row| std::array::from_fn(|column| jacobian[row][column] - normal[row] * across[column]))
        }
        Frame::Space => *jacobian,
    };
    let curl = [j[2][1] - j[1][2], j[0][2] - j[2][0], j[1][0] - j[0][1]];
    let trace = j[0][0] + j[1][1] + j[2][2];
    let strain: f64 = (0..3).flat_map(|a| (0..3).map(move |b| (a, b))).map(|(a, b)| ((j[a][b] + j[b][a]) / 2.0).powi(2)).sum();
    // |Ω|² is half the squared curl.
    let spin = dot(curl, curl) / 2.0;
    match (derived, frame) {
        (Derived::Vorticity, Frame::Plane(normal)) => dot(curl, *normal),
        (Derived::Vorticity, Frame::Space) => norm(curl),
        (Derived::QCriterion, _) => (spin - strain) / 2.0,
        // In a plane s_n² + s_s² = 2 |S|² - (trace J)², free of the choice of axes.
        (Derived::OkuboWeiss, _) => 2.0 * strain - trace * trace - 2.0 * spin,
        // Magnitude was returned before any derivative.
        (Derived::Divergence | Derived::Magnitude, _) => trace,
    }
}

/// The unit normal of a planar complex, along the positive axis to which it is nearest; `None` for a curved one.
fn plane(complex: &SimplicialComplex, measures: &[f64]) -> Option<[f64; 3]> {
    let widest = (0..measures.len()).max_by(|&a, &b| measures[a].total_cmp(&measures[b]))?;
    let corners = complex.simplex(widest);
    let at = |corner: usize| complex.points()[corners[corner] as usize];
    let (a, b) = (minus(at(1), at(0)), minus(at(2), at(0)));
    let reach = complex.bounding_box_diagonal();
    let normal = cross(a.map(|part| part / reach), b.map(|part| part / reach));
    let greatest = normal.into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(1.0);
    let length = norm(normal).copysign(greatest);
    let normal = normal.map(|part| part / length);
    let leaves = |point: &[f64; 3]| dot(minus(*point, at(0)), normal).abs() > PLANAR * reach;
    (!complex.points().par_iter().with_min_len(CHUNK).any(leaves)).then_some(normal)
}
