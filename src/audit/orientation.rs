//! Judges deformed meshes: the orientation of every element, by exact arithmetic, in the precision that is written.

use crate::field::Precision;
use crate::mesh::SimplicialComplex;
use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Elements that one parallel task judges. Any size gives the same result.
const CHUNK: usize = 4096;

/// What the orientations of all elements say about a deformed mesh.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct OrientationReport {
    /// The numbers that were judged.
    pub precision: Precision,
    /// Elements judged.
    pub elements: usize,
    /// Elements whose orientation is opposite to that at rest, rising.
    pub inverted: Vec<usize>,
    /// Elements whose corners lie on a line (2-D) or in a plane (3-D), exactly, rising.
    pub degenerate: Vec<usize>,
    /// The smallest deformed over rest measure, signed: the smallest `det F`. Its sign is exact, its digits are rounded.
    pub smallest: f64,
    /// The element where it is; `None` without elements.
    pub where_smallest: Option<usize>,
}

impl OrientationReport {
    /// No element is inverted or degenerate.
    pub fn is_clean(&self) -> bool {
        self.inverted.is_empty() && self.degenerate.is_empty()
    }
}

/// Why orientations cannot be judged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OrientationError {
    /// Only areas in a plane and volumes have orientations.
    #[error("the mesh has simplices of dimension {found}; triangles in a plane or tetrahedra were expected")]
    Dimension {
        /// Dimension of its top simplices.
        found: usize,
    },
    /// A list of positions of the wrong length.
    #[error("{found} positions were given for {expected} vertices")]
    Length {
        /// Vertices of the mesh.
        expected: usize,
        /// Positions found.
        found: usize,
    },
    /// A position that is no place.
    #[error("coordinate {axis} of vertex {vertex} is {value}; a finite number was expected")]
    NotFinite {
        /// The first such vertex.
        vertex: usize,
        /// Its first such axis.
        axis: usize,
        /// The number.
        value: f64,
    },
}

/// Judges the orientation of every element of a deformed mesh against its orientation at rest.
///
/// Signs come from adaptive exact predicates, never from rounded determinants; nothing is shared with the code that deforms. A
/// number that overflows in 32 bits counts as not finite.
///
/// # Arguments
/// * `rest`: `n` vertices; triangles, of which x and y are read, or tetrahedra, in any order of their corners.
/// * `folded`: elements, rising, whose orientation at rest is wrong and must have changed.
/// * `points`: the deformed positions, `n x 3`.
///
/// # Errors
/// [`OrientationError`].
///
/// # Cost
/// O(m) for m elements, in parallel.
///
/// # Source
/// Shewchuk 1997, *Adaptive precision floating-point arithmetic and fast robust geometric predicates*, through the crate `robust`.
///
/// # Example
/// ```
/// use morsmooth::{audit::orientations, field::Precision, mesh::SimplicialComplex};
/// let triangle = SimplicialComplex::new(2, vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![0, 1, 2])?;
/// let doubled = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
/// assert_eq!(orientations(&triangle, &[], &doubled, Precision::F32)?.smallest, 4.0);
/// let mirrored = [[0.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// assert_eq!(orientations(&triangle, &[], &mirrored, Precision::F64)?.inverted, [0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn orientations(
    rest: &SimplicialComplex,
    folded: &[usize],
    points: &[[f64; 3]],
    precision: Precision,
) -> Result<OrientationReport, OrientationError> {
    let dimension = rest.dimension();
    if !(2..=3).contains(&dimension) {
        return Err(OrientationError::Dimension { found: dimension });
    }
    if points.len() != rest.points().len() {
        return Err(OrientationError::Length { expected: rest.points().len(), found: points.len() });
    }
    let written: Vec<[f64; 3]> = points.iter().map(|point| point.map(|part| precision.round(part))).collect();
    for (vertex, point) in written.iter().enumerate() {
        if let Some(axis) = point[..dimension].iter().position(|part| !part.is_finite()) {
            return Err(OrientationError::NotFinite { vertex, axis, value: points[vertex][axis] });
        }
    }
    let judge = |element: usize| {
        let corners = rest.simplex(element);
        let (before, after) = (signed(rest.points(), corners), signed(&written, corners));
        let sign = if folded.binary_search(&element).is_ok() { -1.0 } else { 1.0 };
        let agrees = sign * before.signum() * after;
        // The sign is that of the exact predicates even where the quotient underflows.
        let ratio = sign * after / before;
        (if ratio == 0.0 || ratio.is_nan() { agrees.signum() * f64::MIN_POSITIVE } else { ratio }, after == 0.0 || before == 0.0)
    };
    let elements = rest.simplex_count();
    let judged: Vec<(f64, bool)> = (0..elements).into_par_iter().with_min_len(CHUNK).map(judge).collect();
    let mut report = OrientationReport {
        precision,
        elements,
        inverted: Vec::new(),
        degenerate: Vec::new(),
        smallest: f64::INFINITY,
        where_smallest: None,
    };
    for (element, (ratio, is_degenerate)) in judged.into_iter().enumerate() {
        let ratio = if is_degenerate { 0.0 } else { ratio };
        if is_degenerate {
            report.degenerate.push(element);
        } else if ratio < 0.0 {
            report.inverted.push(element);
        }
        if ratio < report.smallest {
            (report.smallest, report.where_smallest) = (ratio, Some(element));
        }
    }
    Ok(report)
}

/// Twice the area or six times the volume, of one sign convention for all elements; its sign is exact.
fn signed(points: &[[f64; 3]], corners: &[u32]) -> f64 {
    let at = |corner: usize| points[corners[corner] as usize];
    if corners.len() == 3 {
        let flat = |[x, y, _]: [f64; 3]| Coord { x, y };
        orient2d(flat(at(0)), flat(at(1)), flat(at(2)))
    } else {
        let place = |[x, y, z]: [f64; 3]| Coord3D { x, y, z };
        orient3d(place(at(0)), place(at(1)), place(at(2)), place(at(3)))
    }
}
