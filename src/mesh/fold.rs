//! Folds: neighbouring simplices that lie on the same side of what they share. One of them is inverted.

use super::{SimplicialComplex, cross, dot, minus};

/// A complex of dimension 2 is planar if its points have one third coordinate.
const PLANE_AXIS: usize = 2;

/// Two neighbouring simplices on the same side of their common face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fold {
    /// The first simplex of the two.
    pub first: usize,
    /// The second.
    pub second: usize,
}

/// The folds of a planar mesh of triangles in the x–y plane, or of tetrahedra; none for anything else.
///
/// It does not depend on the order of the corners: a file whose simplices are numbered clockwise and counter-clockwise at will has no
/// fold, a mesh with a vertex dragged across an edge has.
///
/// # Returns
/// Folds by their first simplex.
///
/// # Cost
/// O(m log m).
pub fn folds(complex: &SimplicialComplex) -> Vec<Fold> {
    let dimension = complex.dimension();
    let points = complex.points();
    let is_planar = dimension == 2 && points.windows(2).all(|pair| pair[0][PLANE_AXIS] == pair[1][PLANE_AXIS]);
    if !is_planar && dimension != 3 {
        return Vec::new();
    }
    // Every face with its simplex and the corner opposite.
    let mut faces: Vec<([u32; 3], u32, u32)> = Vec::with_capacity(complex.simplices().len());
    for simplex in 0..complex.simplex_count() {
        let corners = complex.simplex(simplex);
        for &opposite in corners {
            let mut face = [u32::MAX; 3];
            for (slot, &corner) in face.iter_mut().zip(corners.iter().filter(|&&corner| corner != opposite)) {
                *slot = corner;
            }
            face.sort_unstable();
            faces.push((face, simplex as u32, opposite));
        }
    }
    faces.sort_unstable();
    let at = |vertex: u32| points[vertex as usize];
    let side = |face: &[u32; 3], opposite: u32| {
        let (a, to) = (at(face[0]), minus(at(opposite), at(face[0])));
        let along = minus(at(face[1]), a);
        match dimension {
            2 => along[0] * to[1] - along[1] * to[0],
            _ => dot(cross(along, minus(at(face[2]), a)), to),
        }
    };
    let mut found: Vec<Fold> = faces
        .windows(2)
        .filter(|pair| pair[0].0 == pair[1].0 && side(&pair[0].0, pair[0].2) * side(&pair[1].0, pair[1].2) > 0.0)
        .map(|pair| Fold { first: pair[0].1 as usize, second: pair[1].1 as usize })
        .collect();
    found.sort_unstable_by_key(|fold| (fold.first, fold.second));
    found
}
