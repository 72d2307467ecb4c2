//! A triangle mesh ready to be unfolded: every side of every triangle with the plane of its triangle.

use rayon::prelude::*;

use super::error::GeodesicError;
use crate::field::VertexId;
use crate::mesh::{SimplicialComplex, cross, dot, minus, norm};
use crate::operators::OperatorError;

/// A link to a side, packed: its number times two, plus one if it runs the same way as the side it is linked from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Link(u32);

const NO_LINK: u32 = u32::MAX;

impl Link {
    const NONE: Self = Self(NO_LINK);

    fn new(side: u32, is_same_way: bool) -> Self {
        Self(2 * side + u32::from(is_same_way))
    }

    /// The side of the neighbour, and whether it runs the same way: then the neighbour is turned over against this triangle.
    #[inline]
    pub fn get(self) -> Option<(u32, bool)> {
        (self.0 != NO_LINK).then_some((self.0 / 2, self.0 % 2 == 1))
    }
}

/// A side of a triangle, from corner `a` to corner `b`, in the plane of the triangle: `a` in the origin, `b` at `(length, 0)`,
/// the third corner `c`, the apex, above.
#[derive(Debug, Clone)]
pub(super) struct Side {
    /// Distance of `a` and `b`.
    pub length: f64,
    /// The apex.
    pub apex: [f64; 2],
    /// Distance of `a` and `c`.
    pub left_length: f64,
    /// Distance of `c` and `b`.
    pub right_length: f64,
    /// `a`, `b` and `c`.
    pub corners: [u32; 3],
    /// The neighbour across the side from `c` to `a`.
    pub left: Link,
    /// The neighbour across the side from `b` to `c`.
    pub right: Link,
}

/// The sides of all triangles: side `3 t + k` runs from corner `k` of triangle `t` to the next corner.
///
/// Lengths are divided by `scale`, a power of two near the size of the mesh, so that their fourth powers neither overflow nor vanish.
#[derive(Debug)]
pub(super) struct Surface {
    pub sides: Vec<Side>,
    /// The neighbour across each side itself.
    pub across: Vec<Link>,
    /// The unit of length.
    pub scale: f64,
    /// Whether shortest paths may bend at a vertex.
    pub bends: Vec<bool>,
}

/// An angle sum may exceed a straight one by so much without a bend: far above its rounding error, far below what could be seen.
const ANGLE_SLACK: f64 = 1e-11;

impl Surface {
    /// Lays out every triangle.
    pub fn new(complex: &SimplicialComplex) -> Result<Self, GeodesicError> {
        if complex.dimension() != 2 {
            return Err(GeodesicError::Dimension { found: complex.dimension() });
        }
        check_measures(complex)?;
        let triangles = complex.simplex_count();
        let most = (NO_LINK / 2) as usize / 3;
        if triangles > most {
            return Err(GeodesicError::TooLarge { found: triangles, most });
        }
        let across = links(complex)?;
        let scale = complex.bounding_box_diagonal().log2().floor().exp2();
        let sides: Vec<Side> = (0..3 * triangles).into_par_iter().with_min_len(4096).map(|side| layout(complex, &across, scale, side)).collect();
        let bends = (0..complex.vertex_count()).into_par_iter().with_min_len(1024).map(|vertex| bends(complex, &sides, &across, vertex)).collect();
        Ok(Self { sides, across, scale, bends })
    }

    /// The side of triangle `triangle` that lies opposite to `vertex`, one of its corners.
    #[inline]
    pub fn opposite(&self, triangle: u32, vertex: u32) -> u32 {
        let first = 3 * triangle;
        (first..first + 3).find(|&side| self.sides[side as usize].corners[2] == vertex).unwrap_or(first)
    }
}

/// Refuses simplices of zero measure.
pub(super) fn check_measures(complex: &SimplicialComplex) -> Result<(), GeodesicError> {
    match complex.first_zero_measure() {
        Some((simplex, ratio)) => {
            let vertices = complex.simplex(simplex).iter().map(|&vertex| VertexId(vertex)).collect();
            Err(OperatorError::ZeroMeasure { simplex, vertices, ratio }.into())
        }
        None => Ok(()),
    }
}

/// The neighbour across every side.
fn links(complex: &SimplicialComplex) -> Result<Vec<Link>, GeodesicError> {
    const NO_SIDE: u32 = u32::MAX;
    let corner = |side: u32, step: u32| complex.simplices()[(side / 3 * 3 + (side % 3 + step) % 3) as usize];
    let mut first = vec![NO_SIDE; complex.edges().len()];
    let mut links = vec![Link::NONE; complex.simplices().len()];
    let mut worst: Option<usize> = None;
    for side in 0..links.len() as u32 {
        let (a, b) = (VertexId(corner(side, 0)), VertexId(corner(side, 1)));
        let Some(edge) = complex.edge(a, b).map(|edge| edge.0 as usize) else { continue };
        let other = first[edge];
        if other == NO_SIDE {
            first[edge] = side;
        } else if links[other as usize] == Link::NONE {
            let is_same_way = corner(other, 0) == a.0;
            links[other as usize] = Link::new(side, is_same_way);
            links[side as usize] = Link::new(other, is_same_way);
        } else {
            worst = Some(worst.map_or(edge, |worst| worst.min(edge)));
        }
    }
    match worst {
        None => Ok(links),
        Some(edge) => {
            let vertices = complex.edges()[edge];
            let has = |&&simplex: &&u32| complex.simplex(simplex as usize).contains(&vertices[1].0);
            Err(GeodesicError::NonManifoldEdge { vertices, triangles: complex.star(vertices[0]).iter().filter(has).count() })
        }
    }
}

fn layout(complex: &SimplicialComplex, across: &[Link], scale: f64, side: usize) -> Side {
    let corners = complex.simplex(side / 3);
    let corner = |step: usize| corners[(side + step) % 3];
    let [a, b, c] = [0, 1, 2].map(|step| complex.points()[corner(step) as usize].map(|part| part / scale));
    let (base, to_apex) = (minus(b, a), minus(c, a));
    let length = norm(base);
    let apex = [dot(base, to_apex) / length, norm(cross(base, to_apex)) / length];
    let link = |step: usize| across[side / 3 * 3 + (side + step) % 3];
    Side {
        length,
        apex,
        left_length: norm(to_apex),
        right_length: norm(minus(b, c)),
        corners: [corner(0), corner(1), corner(2)],
        left: link(2),
        right: link(1),
    }
}

impl Side {
    /// The angle at the apex.
    pub fn apex_angle(&self) -> f64 {
        let [x, y] = self.apex;
        // Between the directions to a and to b; their cross product is length times height.
        (self.length * y).atan2(x * x + y * y - self.length * x)
    }
}

/// Whether shortest paths may bend at a vertex: inside of the surface above a full turn, on its boundary above half a turn, and
/// always where several fans of triangles meet in the vertex only.
fn bends(complex: &SimplicialComplex, sides: &[Side], across: &[Link], vertex: usize) -> bool {
    let star = complex.star(VertexId::from(vertex));
    let corner = |triangle: u32| (0..3).find(|&k| complex.simplex(triangle as usize)[k] as usize == vertex).unwrap_or(0);
    let mut angle = 0.0;
    let mut open = 0;
    for &triangle in star {
        let (first, corner) = (3 * triangle as usize, corner(triangle));
        angle += sides[first + (corner + 1) % 3].apex_angle();
        open += [corner, (corner + 2) % 3].iter().filter(|&&k| across[first + k] == Link::NONE).count();
    }
    let straight = if open == 0 { 2.0 } else { 1.0 } * std::f64::consts::PI;
    angle > straight + ANGLE_SLACK || open > 2 || fan_length(sides, across, star, vertex, corner) < star.len()
}

/// How many triangles of the star can be reached from its first one across sides at the vertex.
fn fan_length(sides: &[Side], across: &[Link], star: &[u32], vertex: usize, corner: impl Fn(u32) -> usize) -> usize {
    let Some(&begin) = star.first() else { return 0 };
    let mut count = 1;
    let place = corner(begin);
    for first in [place, (place + 2) % 3] {
        let mut link = across[3 * begin as usize + first];
        while let Some((side, _)) = link.get() {
            if side / 3 == begin {
                return count;
            }
            count += 1;
            // The other side at the vertex.
            let triangle = 3 * (side / 3);
            let is_start = sides[side as usize].corners[0] as usize == vertex;
            let next = triangle + (side % 3 + if is_start { 2 } else { 1 }) % 3;
            link = across[next as usize];
        }
    }
    count
}
