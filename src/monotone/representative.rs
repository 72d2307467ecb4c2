//! Representative functions: any field with exactly the wanted extrema. Only its vertex order is used.
//!
//! Whatever the strategy, the order is proven to have exactly the wanted extrema before it is returned. Where rounding
//! (flat tails of a harmonic function) or merged separatrices spoil it, the flood mends it; the count of passes says so.
//!
//! Literature: Jacobson, Weinkauf, Sorkine 2012, section 3.3.

use crate::field::{FieldError, VertexId, VertexOrder};
use crate::mesh::SimplicialComplex;
use crate::morse::{MorseError, WantedExtrema};
use crate::operators::{OperatorError, positive_laplacian};
use crate::qp::QpError;

use super::blocks::{st_numbering, unreachable_regions};
use super::flood::{flood, has_exactly};
use super::laplace::laplace;

/// How the representative function is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Strategy {
    /// The smooth field with the wanted values pinned and no other constraint, flooded to exactly the wanted extrema.
    #[default]
    SmoothThenSimplify,
    /// The field on which the extrema were selected, flooded to exactly the wanted extrema.
    Flood,
    /// The simplified Morse complex of that field: values along separatrices, harmonic elsewhere (the paper's, 3.3).
    Separatrix,
    /// Harmonic with 0 at the wanted minima and 1 at the wanted maxima (the paper's, eq. 15–17).
    Harmonic,
}

impl std::fmt::Display for Strategy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::SmoothThenSimplify => "smooth-then-simplify",
            Self::Flood => "flood",
            Self::Separatrix => "separatrix",
            Self::Harmonic => "harmonic",
        })
    }
}

/// Why there is no representative function.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RepresentativeError {
    /// The wanted extrema admit no field at all.
    #[error(
        "no field has exactly the wanted extrema: the {len} vertices around vertex {vertex} touch the rest at one vertex, or touch \
         wanted minima or maxima only; expected a wanted extremum among them"
    )]
    Unreachable {
        /// The lowest vertex of the part that needs an extremum of its own.
        vertex: VertexId,
        /// Number of vertices of that part.
        len: usize,
    },
    /// The Laplacian could not be assembled.
    #[error(transparent)]
    Operator(#[from] OperatorError),
    /// The Morse complex of the field could not be built or simplified.
    #[error(transparent)]
    Morse(#[from] MorseError),
    /// A value of the function is not finite.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// The Laplace equation could not be solved.
    #[error("the harmonic function could not be computed: {0}")]
    Solver(#[from] QpError),
}

/// A vertex order with exactly the wanted extrema, and how it came about.
#[derive(Debug, Clone)]
pub struct Representative {
    /// The order.
    pub order: VertexOrder,
    /// Passes of the flood; 0 if the function was valid as it was.
    pub passes: usize,
    /// Whether the flood did not settle and a harmonic function or an st-numbering took its place.
    pub replaced: bool,
}

/// The order of a field, mended where its extrema are not exactly the wanted ones.
///
/// # Arguments
/// * `order`: the order of any field, the closer to the wanted extrema the better.
///
/// # Errors
/// [`RepresentativeError::Unreachable`] if the wanted extrema admit no field at all.
///
/// # Cost
/// A few passes of O(n log n).
pub fn representative(
    complex: &SimplicialComplex,
    order: &VertexOrder,
    wanted: &WantedExtrema,
) -> Result<Representative, RepresentativeError> {
    let flooded = flood(complex, order, wanted);
    if flooded.valid {
        return Ok(Representative { order: flooded.order, passes: flooded.passes, replaced: false });
    }
    Ok(Representative { passes: flooded.passes, replaced: true, ..harmonic(complex, wanted)? })
}

/// The harmonic representative function: 0 at the wanted minima, 1 at the wanted maxima, Laplace elsewhere.
///
/// The Laplacian has positive edge weights, so the maximum principle holds on any mesh. In appendages longer than about
/// ten widths the differences sink below rounding; there the order is completed combinatorially.
///
/// # Errors
/// [`RepresentativeError`].
///
/// # Cost
/// One sparse factorisation.
///
/// # Source
/// Jacobson, Weinkauf, Sorkine 2012, eq. 15–17.
pub fn harmonic(complex: &SimplicialComplex, wanted: &WantedExtrema) -> Result<Representative, RepresentativeError> {
    if let Some(region) = unreachable_regions(complex, wanted).first() {
        return Err(RepresentativeError::Unreachable { vertex: region[0], len: region.len() });
    }
    let mut fixed = vec![None; complex.vertex_count()];
    wanted.minima.iter().for_each(|minimum| fixed[minimum.index()] = Some(0.0));
    wanted.maxima.iter().for_each(|maximum| fixed[maximum.index()] = Some(1.0));
    let values = laplace(complex, &positive_laplacian(complex)?, &fixed)?;
    let order = order_within_bounds(&values, wanted);
    if let Some(order) = order {
        let flooded = flood(complex, &order, wanted);
        if flooded.valid {
            return Ok(Representative { order: flooded.order, passes: flooded.passes, replaced: false });
        }
    }
    match st_numbering(complex, wanted) {
        Some(order) if has_exactly(complex, &order, wanted) => Ok(Representative { order, passes: 0, replaced: true }),
        _ => {
            let vertex = wanted.minima.first().copied().unwrap_or(VertexId(0));
            Err(RepresentativeError::Unreachable { vertex, len: complex.vertex_count() })
        }
    }
}

/// The order of values in which the wanted minima come before all other vertices of the same value, and maxima after.
fn order_within_bounds(values: &[f64], wanted: &WantedExtrema) -> Option<VertexOrder> {
    let mut side = vec![0i8; values.len()];
    wanted.minima.iter().for_each(|minimum| side[minimum.index()] = -1);
    wanted.maxima.iter().for_each(|maximum| side[maximum.index()] = 1);
    let mut sequence: Vec<VertexId> = (0..values.len()).map(VertexId::from).collect();
    // Rounding leaves values a little outside [0, 1]; they belong inside.
    let key = |vertex: VertexId| (values[vertex.index()] + 0.0).clamp(0.0, 1.0);
    sequence.sort_by(|&a, &b| {
        key(a).total_cmp(&key(b)).then(side[a.index()].cmp(&side[b.index()])).then(a.cmp(&b))
    });
    VertexOrder::of_sequence(sequence).ok()
}
