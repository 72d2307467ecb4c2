//! The paper's representative function for data: values along the separatrices of the simplified Morse complex.
//!
//! Critical vertices keep their values; on separatrices the values are monotone from saddle to extremum; Laplace's equation
//! fills the rest. Separatrices of one kind merge into a forest that leads to the extrema, so the value at a vertex must
//! suit every separatrix through it: with `lo` the value of the extremum at the end, `hi` the lowest saddle upstream, `depth`
//! the steps to the extremum and `height` the most steps from a saddle, `lo + (hi - lo) depth / (depth + height)` falls
//! strictly along all of them, and is the paper's linear interpolation where nothing merges.
//!
//! Literature: Jacobson, Weinkauf, Sorkine 2012, section 3.3; Weinkauf, Gingold, Sorkine 2010, section 4.

use crate::field::{VertexId, VertexOrder};
use crate::mesh::SimplicialComplex;
use crate::morse::{ExtremumGraph, ExtremumKind, WantedExtrema, separatrices};
use crate::operators::positive_laplacian;

use super::laplace::laplace;
use super::representative::{Representative, RepresentativeError, representative};

/// The representative function of the simplified Morse complex of a field.
///
/// # Arguments
/// * `values`, `order`: the field on which the extrema were selected, and its order.
/// * `wanted`: a subset of its extrema.
///
/// # Errors
/// [`RepresentativeError`]; [`RepresentativeError::Morse`] if a wanted vertex is no extremum of the field.
///
/// # Cost
/// Two discrete gradients, one sparse factorisation.
///
/// # Source
/// Jacobson, Weinkauf, Sorkine 2012, section 3.3, *Initial data*.
pub fn separatrix(
    complex: &SimplicialComplex,
    values: &[f64],
    order: &VertexOrder,
    wanted: &WantedExtrema,
) -> Result<Representative, RepresentativeError> {
    let mut fixed = vec![None; values.len()];
    for &extremum in wanted.minima.iter().chain(&wanted.maxima) {
        fixed[extremum.index()] = Some(values[extremum.index()]);
    }
    let mut below = ExtremumGraph::new(complex, order, ExtremumKind::Minimum)?;
    below.simplify(values, &wanted.minima)?;
    let mut above = ExtremumGraph::new(complex, order, ExtremumKind::Maximum)?;
    above.simplify(values, &wanted.maxima)?;
    let separatrices = separatrices(&below, &above);
    for (paths, kind) in
        [(&separatrices.descending, ExtremumKind::Minimum), (&separatrices.ascending, ExtremumKind::Maximum)]
    {
        for (vertex, value) in values_along(paths, values, kind) {
            // Where separatrices of both kinds meet, the first value stays; the flood mends what that spoils.
            fixed[vertex.index()].get_or_insert(value);
        }
    }
    let function = laplace(complex, &positive_laplacian(complex)?, &fixed)?;
    representative(complex, &VertexOrder::of_values(&function)?, wanted)
}

/// Values on the union of separatrices that lead to extrema of one kind.
fn values_along(separatrices: &[Vec<VertexId>], values: &[f64], kind: ExtremumKind) -> Vec<(VertexId, f64)> {
    // Turned so that separatrices fall, for both kinds.
    let sign = if kind == ExtremumKind::Minimum { 1.0 } else { -1.0 };
    const OFF: u32 = u32::MAX;
    let mut depth = vec![OFF; values.len()];
    let mut height = vec![0u32; values.len()];
    let mut lower = vec![f64::NEG_INFINITY; values.len()];
    let mut upper = vec![f64::INFINITY; values.len()];
    let mut on_path = Vec::new();
    for path in separatrices {
        let (Some(saddle), Some(end)) = (path.first(), path.last()) else { continue };
        let mut bound = sign * values[saddle.index()];
        for (steps, &vertex) in path.iter().enumerate() {
            let i = vertex.index();
            let below = (path.len() - 1 - steps) as u32;
            if depth[i] == OFF {
                on_path.push(vertex);
                depth[i] = below;
            }
            // A saddle can lie on paths of different lengths; the longest counts.
            depth[i] = depth[i].max(below);
            height[i] = height[i].max(steps as u32);
            lower[i] = lower[i].max(sign * values[end.index()]);
            upper[i] = upper[i].min(bound);
            bound = upper[i];
        }
    }
    on_path
        .into_iter()
        .filter(|vertex| depth[vertex.index()] > 0)
        .map(|vertex| {
            let i = vertex.index();
            let fraction = f64::from(depth[i]) / f64::from(depth[i] + height[i]);
            (vertex, sign * (lower[i] + (upper[i] - lower[i]) * fraction))
        })
        .collect()
}
