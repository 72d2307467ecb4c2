//! Where distances start: points of a mesh.

use super::error::GeodesicError;
use crate::field::VertexId;
use crate::mesh::{EdgeId, SimplicialComplex, dot, minus, norm};

/// A point of a triangle mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurfacePoint {
    /// A vertex.
    Vertex(VertexId),
    /// A point of an edge.
    Edge {
        /// The edge.
        edge: EdgeId,
        /// Weight of its higher end, 0 to 1; the lower end has the rest.
        share: f64,
    },
    /// A point of a face.
    Face {
        /// The triangle, a top simplex.
        triangle: usize,
        /// Weights of its corners as the complex lists them, not below 0, with sum 1.
        weights: [f64; 3],
    },
}

/// Weights may miss the sum 1 by so much: they come from divisions and from decimal digits.
const SUM_SLACK: f64 = 1e-6;

impl SurfacePoint {
    /// The position, in the units of the points.
    ///
    /// # Panics
    /// If the complex has no such vertex, edge or triangle.
    pub fn position(&self, complex: &SimplicialComplex) -> [f64; 3] {
        let mut position = [0.0; 3];
        for (vertex, weight) in self.corners(complex) {
            for (slot, part) in position.iter_mut().zip(complex.point(vertex)) {
                *slot += weight * part;
            }
        }
        position
    }

    /// Vertices and weights of the point.
    pub(super) fn corners(&self, complex: &SimplicialComplex) -> Vec<(VertexId, f64)> {
        match *self {
            Self::Vertex(vertex) => vec![(vertex, 1.0)],
            Self::Edge { edge, share } => {
                let [low, high] = complex.edges()[edge.0 as usize];
                vec![(low, 1.0 - share), (high, share)]
            }
            Self::Face { triangle, weights } => {
                complex.simplex(triangle).iter().map(|&vertex| VertexId(vertex)).zip(weights).collect()
            }
        }
    }

    /// The same point on the smallest cell that holds it: a face point with a weight of 0 is one of an edge, and so on.
    ///
    /// # Errors
    /// [`GeodesicError::SourceVertex`], [`GeodesicError::IsolatedSource`], [`GeodesicError::SourceCell`],
    /// [`GeodesicError::SourceWeights`], all with `source_number`.
    pub fn simplest(self, complex: &SimplicialComplex, source_number: usize) -> Result<Self, GeodesicError> {
        let cell = |what, found: usize, count: usize| match found < count {
            true => Ok(()),
            false => Err(GeodesicError::SourceCell { source_number, what, found, count }),
        };
        let weights = |weights: &[f64]| {
            let is_fit = weights.iter().all(|&weight| weight >= 0.0) && (weights.iter().sum::<f64>() - 1.0).abs() <= SUM_SLACK;
            if is_fit { Ok(()) } else { Err(GeodesicError::SourceWeights { source_number, weights: weights.to_vec() }) }
        };
        match self {
            Self::Vertex(vertex) => {
                let vertices = complex.vertex_count();
                if vertex.index() >= vertices {
                    Err(GeodesicError::SourceVertex { source_number, vertex, vertices })
                } else if complex.star(vertex).is_empty() {
                    Err(GeodesicError::IsolatedSource { source_number, vertex })
                } else {
                    Ok(self)
                }
            }
            Self::Edge { edge, share } => {
                cell("edge", edge.0 as usize, complex.edges().len())?;
                weights(&[1.0 - share, share])?;
                let [low, high] = complex.edges()[edge.0 as usize];
                Ok(match share {
                    0.0 => Self::Vertex(low),
                    1.0 => Self::Vertex(high),
                    _ => self,
                })
            }
            Self::Face { triangle, weights: given } => {
                cell("face", triangle, complex.simplex_count())?;
                weights(&given)?;
                let sum: f64 = given.iter().sum();
                let given = given.map(|weight| weight / sum);
                let corners = complex.simplex(triangle);
                let positive: Vec<usize> = (0..3).filter(|&corner| given[corner] > 0.0).collect();
                Ok(match positive.as_slice() {
                    [only] => Self::Vertex(VertexId(corners[*only])),
                    &[first, second] => {
                        let ends = [VertexId(corners[first]), VertexId(corners[second])];
                        match complex.edge(ends[0], ends[1]) {
                            Some(edge) => Self::Edge { edge, share: given[if ends[0] > ends[1] { first } else { second }] },
                            None => Self::Face { triangle, weights: given },
                        }
                    }
                    _ => Self::Face { triangle, weights: given },
                })
            }
        }
    }

    /// Triangles that hold the point, by rising number.
    pub(super) fn triangles(&self, complex: &SimplicialComplex) -> Vec<u32> {
        match *self {
            Self::Vertex(vertex) => complex.star(vertex).to_vec(),
            Self::Edge { edge, .. } => {
                let [low, high] = complex.edges()[edge.0 as usize];
                let star = complex.star(low).iter().copied();
                star.filter(|&triangle| complex.simplex(triangle as usize).contains(&high.0)).collect()
            }
            Self::Face { triangle, .. } => vec![triangle as u32],
        }
    }

    /// Weights of the point in a triangle that holds it.
    pub(super) fn weights_in(&self, complex: &SimplicialComplex, triangle: u32) -> [f64; 3] {
        let mut weights = [0.0; 3];
        let corners = complex.simplex(triangle as usize);
        for (vertex, weight) in self.corners(complex) {
            if let Some(corner) = corners.iter().position(|&corner| corner == vertex.0) {
                weights[corner] = weight;
            }
        }
        weights
    }
}

/// The point of a triangle mesh that is nearest to a point in space, and its distance in the units of the points.
///
/// Points nearer to a vertex or edge than rounding can tell are put on it. Of equally near triangles the first counts.
///
/// # Arguments
/// * `complex`: triangles.
/// * `position`: three finite coordinates.
///
/// # Returns
/// `None` if the complex has no triangle.
///
/// # Cost
/// O(m).
///
/// # Source
/// Ericson 2005, *Real-time collision detection*, section 5.1.5.
pub fn nearest_point(complex: &SimplicialComplex, position: [f64; 3]) -> Option<(SurfacePoint, f64)> {
    let mut best: Option<(usize, [f64; 3], f64)> = None;
    for triangle in 0..if complex.dimension() == 2 { complex.simplex_count() } else { 0 } {
        let corners = complex.simplex(triangle);
        let at = [0, 1, 2].map(|corner| complex.points()[corners[corner] as usize]);
        let weights = nearest_in_triangle(at, position);
        let mut foot = [0.0; 3];
        for (corner, weight) in at.iter().zip(weights) {
            for (slot, part) in foot.iter_mut().zip(corner) {
                *slot += weight * part;
            }
        }
        let distance = norm(minus(foot, position));
        if best.is_none_or(|(_, _, least)| distance < least) {
            best = Some((triangle, weights, distance));
        }
    }
    let (triangle, mut weights, distance) = best?;
    const ROUNDING: f64 = 1e-12;
    weights.iter_mut().filter(|weight| **weight < ROUNDING).for_each(|weight| *weight = 0.0);
    let sum: f64 = weights.iter().sum();
    let point = SurfacePoint::Face { triangle, weights: weights.map(|weight| weight / sum) };
    point.simplest(complex, 0).ok().map(|point| (point, distance))
}

/// Weights of the point of a triangle that is nearest to `p`.
fn nearest_in_triangle([a, b, c]: [[f64; 3]; 3], p: [f64; 3]) -> [f64; 3] {
    let (ab, ac) = (minus(b, a), minus(c, a));
    let (d1, d2) = (dot(ab, minus(p, a)), dot(ac, minus(p, a)));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let (d3, d4) = (dot(ab, minus(p, b)), dot(ac, minus(p, b)));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let (d5, d6) = (dot(ab, minus(p, c)), dot(ac, minus(p, c)));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let share = d1 / (d1 - d3);
        return [1.0 - share, share, 0.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let share = d2 / (d2 - d6);
        return [1.0 - share, 0.0, share];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let share = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - share, share];
    }
    let sum = va + vb + vc;
    [va / sum, vb / sum, vc / sum]
}
