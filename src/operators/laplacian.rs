//! The cotangent Laplacian and its relative with positive weights.
//!
//! Literature: Pinkall, Polthier 1993, *Computing discrete minimal surfaces and their conjugates* (triangles);
//! Crane 2019, *The n-dimensional cotangent formula* (any dimension).

use super::OperatorError;
use super::error::check_measures;
use crate::field::VertexId;
use crate::linalg::CsrMatrix;
use crate::mesh::{SimplicialComplex, cross, dot, minus, norm};
use rayon::prelude::*;

/// The least weight of an edge in [`positive_laplacian`], as a fraction of the sum of `measure / longest edge²` of the
/// simplices at the edge.
///
/// That sum is the weight which equilateral simplices of the same size give, up to a factor near 1. On long right-angled
/// triangles it is half the smaller of the two weights beside the right angle, so that a regular but anisotropic grid keeps all
/// its weights but the vanishing ones of the diagonals.
pub const LEAST_WEIGHT: f64 = 1e-3;

/// Vertices handled by one parallel task. Any size gives the same result.
const CHUNK: usize = 4096;

/// The cotangent Laplacian: the stiffness matrix of linear finite elements.
///
/// `L_ij = -w_ij` for an edge, `L_ii = sum_j w_ij`, with the weight summed over the simplices at the edge:
/// dimension 1: `1 / length`; 2: `cot(opposite angle) / 2`; 3: `|opposite edge| cot(dihedral angle there) / 6`.
/// **Positive** semi-definite; rows sum to 0; the kernel holds the functions that are constant on each component. Weights
/// may be negative where angles are obtuse, so the maximum principle may fail: see [`positive_laplacian`].
///
/// # Arguments
/// * `complex`: `n` vertices, any dimension, planar or curved, with or without boundary.
///
/// # Returns
/// Symmetric `n x n` in `[length^(d-2)]`, one entry a vertex and two an edge, also where they vanish.
///
/// # Errors
/// [`OperatorError::ZeroMeasure`] with the first simplex below [`ZERO_MEASURE`](crate::mesh::ZERO_MEASURE),
/// [`OperatorError::Scale`] where coordinates overflow.
///
/// # Cost
/// O(m), in parallel; 12 bytes an entry.
///
/// # Source
/// Crane 2019, *The n-dimensional cotangent formula*.
///
/// # Example
/// ```
/// use morsmooth::{mesh::SimplicialComplex, operators::cotangent_laplacian};
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let laplacian = cotangent_laplacian(&SimplicialComplex::new(2, points, vec![0, 1, 2])?)?;
/// assert_eq!(laplacian.get(0, 1), -0.5); // cot 45° / 2
/// assert_eq!(laplacian.get(1, 2), 0.0); // cot 90° / 2
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cotangent_laplacian(complex: &SimplicialComplex) -> Result<CsrMatrix, OperatorError> {
    check_measures(complex)?;
    let weights = edge_sums(complex, |simplex, edge| cotangent(complex, simplex, edge));
    laplacian(complex, &weights)
}

/// A Laplacian with positive weights: the cotangent Laplacian, its weights clamped from below.
///
/// `w_ij := max(w_ij, LEAST_WEIGHT * sum of measure / longest edge² over the simplices at the edge)`. The matrix is an
/// M-matrix, irreducible on a connected mesh: a function that is harmonic for it has, in exact arithmetic, no extremum but at
/// fixed vertices. Where no angle is obtuse it is the cotangent Laplacian, but for edges of weight 0.
///
/// # Arguments, Returns, Errors, Cost
/// As for [`cotangent_laplacian`].
///
/// # Source
/// The clamp is common practice; DESIGN section 2 has the measured need.
pub fn positive_laplacian(complex: &SimplicialComplex) -> Result<CsrMatrix, OperatorError> {
    check_measures(complex)?;
    let dimension = complex.dimension() as i32;
    let simplices = (0..complex.simplex_count()).into_par_iter().with_min_len(CHUNK);
    let floors: Vec<f64> = simplices
        .map(|simplex| {
            let size = complex.size(simplex);
            LEAST_WEIGHT * size.measure / size.longest.powi(2) * size.scale.powi(dimension - 2)
        })
        .collect();
    let mut weights = edge_sums(complex, |simplex, edge| cotangent(complex, simplex, edge));
    let floors = edge_sums(complex, |simplex, _| floors[simplex]);
    weights.par_iter_mut().zip(&floors).with_min_len(CHUNK).for_each(|(weight, &floor)| *weight = weight.max(floor));
    laplacian(complex, &weights)
}

/// Sums over the simplices at every edge, in the order of the edges; each sum runs by rising simplex.
///
/// # Arguments
/// * `share`: what a simplex adds to the edge between two of its corners, given by their places in the simplex.
fn edge_sums(complex: &SimplicialComplex, share: impl Fn(usize, [usize; 2]) -> f64 + Sync) -> Vec<f64> {
    let vertices = complex.vertex_count();
    let parts: Vec<Vec<f64>> = (0..vertices.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut sums = Vec::new();
            for vertex in chunk * CHUNK..vertices.min((chunk + 1) * CHUNK) {
                // Edges are sorted, so those with this lower end lie together, in the order of the neighbours above it.
                let neighbours = complex.neighbours(vertex.into());
                let above = &neighbours[neighbours.partition_point(|neighbour| neighbour.index() < vertex)..];
                let begin = sums.len();
                sums.resize(begin + above.len(), 0.0);
                for &simplex in complex.star(vertex.into()) {
                    let corners = complex.simplex(simplex as usize);
                    let own = corners.iter().position(|&corner| corner as usize == vertex).unwrap_or(0);
                    for (other, &corner) in corners.iter().enumerate().filter(|&(_, &corner)| corner as usize > vertex) {
                        let slot = above.partition_point(|&neighbour| neighbour < VertexId(corner));
                        sums[begin + slot] += share(simplex as usize, [own, other]);
                    }
                }
            }
            sums
        })
        .collect();
    parts.concat()
}

/// The share of a simplex in the cotangent weight of the edge between two of its corners.
fn cotangent(complex: &SimplicialComplex, simplex: usize, [i, j]: [usize; 2]) -> f64 {
    let corners = complex.simplex(simplex);
    let at = |corner: usize| complex.points()[corners[corner] as usize];
    match complex.dimension() {
        1 => 1.0 / norm(minus(at(j), at(i))),
        2 => {
            let k = 3 - i - j;
            let (a, b) = (minus(at(i), at(k)), minus(at(j), at(k)));
            dot(a, b) / norm(cross(a, b)) / 2.0
        }
        _ => {
            let k = (0..4).find(|&corner| corner != i && corner != j).unwrap_or(0);
            let l = 6 - i - j - k;
            let (edge, a, b) = (minus(at(l), at(k)), minus(at(i), at(k)), minus(at(j), at(k)));
            // The face normals at the opposite edge; the sine of their angle times their lengths is |edge| |det|.
            let (p, q) = (cross(edge, a), cross(edge, b));
            dot(p, q) / dot(p, b).abs() / 6.0
        }
    }
}

/// The matrix of edge weights: one row a vertex, the diagonal summed by rising neighbour.
fn laplacian(complex: &SimplicialComplex, weights: &[f64]) -> Result<CsrMatrix, OperatorError> {
    let vertices = complex.vertex_count();
    let parts: Vec<(Vec<u32>, Vec<f64>)> = (0..vertices.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let (mut indices, mut values) = (Vec::new(), Vec::new());
            for vertex in chunk * CHUNK..vertices.min((chunk + 1) * CHUNK) {
                let (neighbours, edges) = (complex.neighbours(vertex.into()), complex.incident_edges(vertex.into()));
                let below = neighbours.partition_point(|neighbour| neighbour.index() < vertex);
                let diagonal: f64 = edges.iter().map(|edge| weights[edge.0 as usize]).sum();
                indices.extend(neighbours[..below].iter().map(|neighbour| neighbour.0));
                values.extend(edges[..below].iter().map(|edge| -weights[edge.0 as usize]));
                indices.push(vertex as u32);
                values.push(diagonal);
                indices.extend(neighbours[below..].iter().map(|neighbour| neighbour.0));
                values.extend(edges[below..].iter().map(|edge| -weights[edge.0 as usize]));
            }
            (indices, values)
        })
        .collect();
    if let Some(edge) = weights.iter().position(|weight| !weight.is_finite()) {
        let vertex = complex.edges()[edge][0];
        return Err(OperatorError::Scale { quantity: "edge weight", vertex, value: weights[edge] });
    }
    let mut offsets = Vec::with_capacity(vertices + 1);
    offsets.push(0);
    let mut entries = 0;
    for vertex in 0..vertices {
        entries += complex.neighbours(vertex.into()).len() as u32 + 1;
        offsets.push(entries);
    }
    let (indices, values): (Vec<Vec<u32>>, Vec<Vec<f64>>) = parts.into_iter().unzip();
    Ok(CsrMatrix::from_parts(vertices, vertices, offsets, indices.concat(), values.concat()))
}
