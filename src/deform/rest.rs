//! What the undeformed mesh says: measures and gradients of the barycentric coordinates.

use super::DeformError;
use super::orientation::inverted;
use crate::field::VertexId;
use crate::linalg::small::symmetric_eigen;
use crate::mesh::{SimplicialComplex, dot, minus};
use crate::operators::dual_basis;
use rayon::prelude::*;

/// Elements handled by one parallel task. Any size gives the same result.
pub(super) const CHUNK: usize = 2048;

/// The rest shape of a planar triangle mesh or a tetrahedral mesh, with everything that deformation gradients need.
///
/// Corners of an element are kept by rising vertex; nothing depends on the orientation in which a file lists them.
#[derive(Debug, Clone)]
pub struct RestShape {
    dimension: usize,
    points: Vec<[f64; 3]>,
    corners: Vec<u32>,
    gradients: Vec<[f64; 3]>,
    measures: Vec<f64>,
    folded: Vec<usize>,
    /// Connected part of each vertex.
    pub(super) parts: Vec<u32>,
}

impl RestShape {
    /// Reads a mesh.
    ///
    /// # Arguments
    /// * `complex`: `n` vertices; triangles in a plane z = constant, or tetrahedra.
    ///
    /// # Errors
    /// [`DeformError::Dimension`], [`DeformError::NotPlanar`]; [`DeformError::ZeroMeasure`] and [`DeformError::Inverted`] with all
    /// elements concerned; [`DeformError::Scale`].
    ///
    /// # Cost
    /// O(m log m) for m elements; 100 bytes a triangle, 150 a tetrahedron.
    pub fn new(complex: &SimplicialComplex) -> Result<Self, DeformError> {
        let rest = Self::untangled(complex)?;
        if rest.folded.is_empty() { Ok(rest) } else { Err(DeformError::Inverted { elements: rest.folded }) }
    }

    /// Reads a mesh that may have elements folded over their neighbours; a folded element's rest shape is its mirror image.
    ///
    /// Of all mirror images the nearest is taken, across the line or plane through the element's middle in which it is widest, so that
    /// the identity asks for the least movement. Solving for any rotations then turns folded elements right side out.
    ///
    /// # Errors
    /// As [`RestShape::new`], [`DeformError::Inverted`] excepted.
    ///
    /// # Cost
    /// As [`RestShape::new`].
    pub fn untangled(complex: &SimplicialComplex) -> Result<Self, DeformError> {
        let dimension = complex.dimension();
        if dimension < 2 {
            return Err(DeformError::Dimension { found: dimension });
        }
        let points = complex.points().to_vec();
        if dimension == 2
            && let Some(vertex) = points.iter().position(|point| point[2] != points[0][2])
        {
            return Err(DeformError::NotPlanar { vertex: vertex.into(), found: points[vertex][2], expected: points[0][2] });
        }
        let flat = complex.zero_measures();
        if let Some(&(_, ratio)) = flat.first() {
            return Err(DeformError::ZeroMeasure { elements: flat.into_iter().map(|(element, _)| element).collect(), ratio });
        }
        let elements = (0..complex.simplex_count()).into_par_iter().with_min_len(CHUNK);
        let measures: Vec<f64> = elements.clone().map(|element| complex.measure(element)).collect();
        let folded = inverted(complex, &measures);
        let stride = dimension + 1;
        let mut corners = complex.simplices().to_vec();
        let mut gradients = vec![[0.0; 3]; corners.len()];
        elements.zip(corners.par_chunks_mut(stride)).zip(gradients.par_chunks_mut(stride)).for_each(|((element, corners), gradients)| {
            let dual = dual_basis(complex, element);
            for axis in 0..3 {
                gradients[0][axis] = -dual[..dimension].iter().map(|gradient| gradient[axis]).sum::<f64>();
            }
            gradients[1..].copy_from_slice(&dual[..dimension]);
            if folded.binary_search(&element).is_ok() {
                let normal = thinnest(dimension, corners.iter().map(|&vertex| points[vertex as usize]));
                for gradient in gradients.iter_mut() {
                    let off = 2.0 * dot(*gradient, normal);
                    gradient.iter_mut().zip(normal).for_each(|(slot, part)| *slot -= off * part);
                }
            }
            // By rising vertex, as rows of matrices want them.
            for last in (1..stride).rev() {
                for place in 0..last {
                    if corners[place] > corners[place + 1] {
                        corners.swap(place, place + 1);
                        gradients.swap(place, place + 1);
                    }
                }
            }
        });
        if let Some(place) = gradients.iter().position(|gradient| !gradient.iter().all(|part| part.is_finite())) {
            return Err(DeformError::Scale { element: place / stride });
        }
        Ok(Self { dimension, points, folded, corners, gradients, measures, parts: complex.components().0 })
    }

    /// 2 or 3.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.points.len()
    }

    /// Number of triangles or tetrahedra.
    pub fn element_count(&self) -> usize {
        self.measures.len()
    }

    /// Rest positions, one a vertex.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// Rest positions as the unknowns are numbered, `n x dim` numbers.
    pub fn positions(&self) -> Vec<f64> {
        self.points.iter().flat_map(|point| point[..self.dimension].iter().copied()).collect()
    }

    /// Rest area or volume of every element, `[length^dim]`.
    pub fn measures(&self) -> &[f64] {
        &self.measures
    }

    /// Vertices of an element, rising, `dim + 1` numbers.
    pub fn corners(&self, element: usize) -> &[u32] {
        let stride = self.dimension + 1;
        &self.corners[element * stride..(element + 1) * stride]
    }

    /// Gradients of the barycentric coordinates of an element's corners, `[1 / length]`; they sum to zero.
    pub fn gradients(&self, element: usize) -> &[[f64; 3]] {
        let stride = self.dimension + 1;
        &self.gradients[element * stride..(element + 1) * stride]
    }

    /// A bound on what rounding positions to 32-bit numbers adds to an element's deformation gradient, in the spectral norm.
    ///
    /// A coordinate of size r is rounded by at most `2^-24 r`, a position by `2^-24 r √dim`; and F is the sum of positions times
    /// gradients.
    ///
    /// # Arguments
    /// * `extent`: r, the largest absolute coordinate of the deformed shape.
    pub fn rounding(&self, element: usize, extent: f64) -> f64 {
        let sum: f64 = self.gradients(element).iter().map(|g| g.iter().map(|part| part * part).sum::<f64>().sqrt()).sum();
        f64::from(f32::EPSILON) / 2.0 * extent * (self.dimension as f64).sqrt() * sum
    }

    /// Elements whose orientation in the mesh is wrong and whose rest shape is their mirror image, rising.
    pub fn folded(&self) -> &[usize] {
        &self.folded
    }

    pub(super) fn check_positions(&self, positions: &[f64]) -> Result<(), DeformError> {
        let expected = self.vertex_count() * self.dimension;
        if positions.len() != expected {
            return Err(DeformError::Length { what: "coordinates", expected, found: positions.len() });
        }
        finite("coordinate", positions)
    }

    /// The first vertex of each connected part.
    pub(super) fn first_of_parts(&self) -> Vec<VertexId> {
        let mut first = Vec::new();
        for (vertex, &part) in self.parts.iter().enumerate() {
            if part as usize == first.len() {
                first.push(vertex.into());
            }
        }
        first
    }
}

/// The direction in which some places are spread least, a unit vector; in 2-D within the plane.
fn thinnest(dimension: usize, places: impl Iterator<Item = [f64; 3]> + Clone) -> [f64; 3] {
    let count = places.clone().count().max(1) as f64;
    let mut middle = [0.0; 3];
    for place in places.clone() {
        middle.iter_mut().zip(place).for_each(|(slot, part)| *slot += part / count);
    }
    let mut spread = [[0.0; 3]; 3];
    for place in places {
        let off = minus(place, middle);
        for (row, first) in spread.iter_mut().zip(off) {
            row.iter_mut().zip(off).for_each(|(slot, second)| *slot += first * second);
        }
    }
    if dimension == 2 {
        let [[a, b, _], [_, c, _], _] = spread;
        let vectors = symmetric_eigen(&[[a, b], [b, c]]).1;
        return [vectors[0][0], vectors[1][0], 0.0];
    }
    symmetric_eigen(&spread).1.map(|row| row[0])
}

pub(super) fn finite(what: &'static str, values: &[f64]) -> Result<(), DeformError> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(DeformError::Number { what, index, value: values[index], expected: "a finite number" }),
        None => Ok(()),
    }
}
