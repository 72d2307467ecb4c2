//! Boundary values: checked, one a vertex.

use crate::field::VertexId;
use crate::mesh::SimplicialComplex;

use super::InterpolateError;

/// The value of every vertex that has one, `n` entries.
///
/// # Errors
/// What is wrong with the values, or the first connected part of the mesh without one.
pub(super) fn fixed_values(
    complex: &SimplicialComplex,
    component: &(Vec<u32>, usize),
    values: &[(VertexId, f64)],
) -> Result<Vec<Option<f64>>, InterpolateError> {
    let n = complex.vertex_count();
    let mut fixed: Vec<Option<f64>> = vec![None; n];
    let mut has_value = vec![false; component.1];
    for &(vertex, value) in values {
        let Some(slot) = fixed.get_mut(vertex.index()) else {
            return Err(InterpolateError::VertexOutOfRange { vertex, vertices: n });
        };
        if !value.is_finite() {
            return Err(InterpolateError::NotFinite { vertex, value });
        }
        match *slot {
            Some(other) if other != value => {
                return Err(InterpolateError::TwoValues { vertex, first: other.min(value), second: other.max(value) });
            }
            // One zero for both, so that equal values have equal bits.
            _ => *slot = Some(value + 0.0),
        }
        has_value[component.0[vertex.index()] as usize] = true;
    }
    match has_value.iter().position(|has| !has) {
        None => Ok(fixed),
        Some(part) => {
            let members = || component.0.iter().enumerate().filter(|&(_, &number)| number as usize == part);
            let vertex = members().next().map_or(0, |(vertex, _)| vertex).into();
            Err(InterpolateError::PartWithoutValue { vertex, vertices: members().count() })
        }
    }
}

/// Least and greatest given value.
pub(super) fn range(fixed: &[Option<f64>]) -> (f64, f64) {
    fixed.iter().flatten().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)))
}
