//! The extrema of values on a complex, by what lies below and above every vertex.

use crate::field::{FieldError, VertexId, check_finite};
use crate::mesh::SimplicialComplex;

/// The minima and maxima of a field, each list by rising vertex.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Extrema {
    /// Vertices with an empty lower link.
    pub minima: Vec<VertexId>,
    /// Vertices with an empty upper link.
    pub maxima: Vec<VertexId>,
}

/// What a plain `<` sees of a field, without an order among equal values; each list by rising vertex.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct StrictExtrema {
    /// Vertices that lie strictly below every neighbour.
    pub minima: Vec<VertexId>,
    /// Vertices that lie strictly above every neighbour.
    pub maxima: Vec<VertexId>,
    /// Vertices with an equal neighbour, and none strictly below or none strictly above: programs that compare with
    /// `<` and programs that compare with `<=` disagree on whether they are extrema.
    pub plateaus: Vec<VertexId>,
}

/// What some neighbour of a vertex is, one bit each.
const LOWER: u8 = 1;
const HIGHER: u8 = 2;
const EQUAL_BEFORE: u8 = 4;
const EQUAL_AFTER: u8 = 8;

/// The extrema in the order (value, vertex index).
///
/// A vertex is a minimum if and only if its lower link is empty, that is if no neighbour is below it; a maximum if and
/// only if no neighbour is above it. Boundary vertices count like any other; vertices of no simplex are no extrema.
///
/// # Arguments
/// * `complex`: `n` vertices, any dimension.
/// * `values`: `n` values. Those of a file with single precision are widened, which is exact.
///
/// # Errors
/// [`FieldError`] if there are not `n` values or one is not finite.
///
/// # Cost
/// Linear in the number of top simplices; one byte a vertex.
///
/// # Example
/// ```
/// use morsmooth::audit::extrema;
/// use morsmooth::field::VertexId;
/// use morsmooth::mesh::SimplicialComplex;
/// let line = SimplicialComplex::new(1, vec![[0.0; 3]; 4], vec![0, 1, 1, 2, 2, 3])?;
/// let found = extrema(&line, &[0.0, 3.0, 3.0, 1.0])?;
/// assert_eq!(found.minima, [VertexId(0), VertexId(3)]);
/// assert_eq!(found.maxima, [VertexId(2)]); // of equal values, the later is the higher
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn extrema(complex: &SimplicialComplex, values: &[f64]) -> Result<Extrema, FieldError> {
    let links = links(complex, values)?;
    let without = |bits: u8| -> Vec<VertexId> { matching(&links, |link| link != 0 && link & bits == 0) };
    Ok(Extrema { minima: without(LOWER | EQUAL_BEFORE), maxima: without(HIGHER | EQUAL_AFTER) })
}

/// The extrema under plain `<`, and the vertices where it decides nothing.
///
/// Without plateaus, these extrema and those of [`extrema`] are the same.
///
/// # Arguments
/// * `complex`: `n` vertices, any dimension.
/// * `values`: `n` values.
///
/// # Errors
/// As [`extrema`].
///
/// # Cost
/// As [`extrema`].
pub fn strict_extrema(complex: &SimplicialComplex, values: &[f64]) -> Result<StrictExtrema, FieldError> {
    let links = links(complex, values)?;
    let flat = |link: u8| link & (EQUAL_BEFORE | EQUAL_AFTER) != 0 && link & (LOWER | HIGHER) != LOWER | HIGHER;
    Ok(StrictExtrema {
        minima: matching(&links, |link| link == HIGHER),
        maxima: matching(&links, |link| link == LOWER),
        plateaus: matching(&links, flat),
    })
}

fn matching(links: &[u8], rule: impl Fn(u8) -> bool) -> Vec<VertexId> {
    links.iter().enumerate().filter(|&(_, &link)| rule(link)).map(|(vertex, _)| VertexId::from(vertex)).collect()
}

/// What the link of every vertex holds; 0 for a vertex of no simplex.
///
/// Read from the top simplices, not from the lists of edges and neighbours, on which the rest of the crate relies.
fn links(complex: &SimplicialComplex, values: &[f64]) -> Result<Vec<u8>, FieldError> {
    if values.len() != complex.vertex_count() {
        return Err(FieldError::LengthMismatch { expected: complex.vertex_count(), found: values.len() });
    }
    check_finite(values)?;
    let mut links = vec![0; values.len()];
    for corners in complex.simplices().chunks_exact(complex.dimension() + 1) {
        for &vertex in corners {
            for &other in corners.iter().filter(|&&other| other != vertex) {
                let (value, other_value) = (values[vertex as usize], values[other as usize]);
                links[vertex as usize] |= if other_value < value {
                    LOWER
                } else if other_value > value {
                    HIGHER
                } else if other < vertex {
                    EQUAL_BEFORE
                } else {
                    EQUAL_AFTER
                };
            }
        }
    }
    Ok(links)
}
