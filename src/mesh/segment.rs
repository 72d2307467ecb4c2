//! The vertices of a mesh along a straight segment.

use super::measure::{dot, minus, norm};
use super::{HandleError, SimplicialComplex};
use crate::field::VertexId;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Most points looked at along one segment; a longer list would only find the same vertices again.
const MOST_SAMPLES: usize = 4096;

/// Longest chain of edges that joins two carriers which are not neighbours.
const LONGEST_JOIN: usize = 4;

/// Distances in the units of the mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    /// A place further than this from a vertex, and than the longest edge there, is outside the mesh.
    pub outside: f64,
    /// A vertex this close lies on a segment.
    pub on: f64,
}

/// The vertices along a segment and their places between its ends, 0 to 1, in this order.
pub(super) fn along(
    name: &str,
    ends: [[f64; 3]; 2],
    complex: &SimplicialComplex,
    reach: Reach,
) -> Result<Vec<(VertexId, f64)>, HandleError> {
    let near = candidates(ends, complex, reach);
    let mut on: Vec<(VertexId, f64)> =
        near.iter().filter(|near| near.distance <= reach.on).map(|near| (near.vertex, near.place)).collect();
    on.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    if !covers(&on, ends, complex) {
        on = sampled(name, ends, complex, reach, &near)?;
    }
    Ok(on)
}

/// A vertex near a segment.
#[derive(Debug, Clone, Copy)]
struct Near {
    vertex: VertexId,
    /// Of the foot of its perpendicular, 0 to 1.
    place: f64,
    distance: f64,
}

/// Vertices within reach of a segment, rising.
fn candidates(ends: [[f64; 3]; 2], complex: &SimplicialComplex, reach: Reach) -> Vec<Near> {
    let near = |vertex: usize| {
        let vertex = VertexId::from(vertex);
        let (place, distance) = project(ends, complex.point(vertex));
        (distance <= reach.outside.max(longest_edge(complex, vertex))).then_some(Near { vertex, place, distance })
    };
    (0..complex.vertex_count()).into_par_iter().with_min_len(8192).filter_map(near).collect()
}

/// Whether vertices on a segment leave no gap longer than twice the edges there: meshes made for a skeleton have vertices on it, at their own
/// spacing.
fn covers(on: &[(VertexId, f64)], ends: [[f64; 3]; 2], complex: &SimplicialComplex) -> bool {
    let length = norm(minus(ends[1], ends[0]));
    let Some(&(first, start)) = on.first() else { return false };
    let Some(&(last, end)) = on.last() else { return false };
    let edge = |vertex| 2.0 * longest_edge(complex, vertex);
    start * length <= edge(first)
        && (1.0 - end) * length <= edge(last)
        && on.windows(2).all(|pair| (pair[1].1 - pair[0].1) * length <= edge(pair[0].0).max(edge(pair[1].0)))
}

/// The vertices nearest to points spaced half an edge along a segment, joined along edges.
fn sampled(
    name: &str,
    ends: [[f64; 3]; 2],
    complex: &SimplicialComplex,
    reach: Reach,
    near: &[Near],
) -> Result<Vec<(VertexId, f64)>, HandleError> {
    let spacing = mean_edge(complex, near) / 2.0;
    let length = norm(minus(ends[1], ends[0]));
    let steps = if spacing > 0.0 { ((length / spacing).ceil() as usize).clamp(1, MOST_SAMPLES) } else { 1 };
    let mut chain: Vec<VertexId> = Vec::new();
    for step in 0..=steps {
        let share = step as f64 / steps as f64;
        let place: [f64; 3] = std::array::from_fn(|axis| ends[0][axis] * (1.0 - share) + ends[1][axis] * share);
        let found = nearest(complex, near.iter().map(|near| near.vertex), place);
        let found = found.or_else(|| nearest(complex, (0..complex.vertex_count()).map(VertexId::from), place));
        let Some((vertex, distance)) = found else {
            return Err(HandleError::NoVertex { name: name.into(), reason: "the mesh has no vertices".into() });
        };
        let allowed = reach.outside.max(longest_edge(complex, vertex));
        if distance > allowed {
            return Err(HandleError::Outside { name: name.into(), place, vertex, distance, allowed });
        }
        if chain.last() != Some(&vertex) {
            chain.push(vertex);
        }
    }
    let joined = join(complex, near, &chain);
    let mut vertices: Vec<(VertexId, f64)> =
        joined.into_iter().map(|vertex| (vertex, project(ends, complex.point(vertex)).0)).collect();
    vertices.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    Ok(vertices)
}

/// A chain of vertices with the vertices of short paths between those that are not neighbours.
fn join(complex: &SimplicialComplex, near: &[Near], chain: &[VertexId]) -> BTreeSet<VertexId> {
    let mut joined: BTreeSet<VertexId> = chain.iter().copied().collect();
    for pair in chain.windows(2) {
        if complex.edge(pair[0], pair[1]).is_none() {
            joined.extend(short_path(complex, near, pair[0], pair[1]));
        }
    }
    joined
}

/// The inner vertices of a path of fewest edges through vertices near the segment; none if it would be long.
fn short_path(complex: &SimplicialComplex, near: &[Near], from: VertexId, to: VertexId) -> Vec<VertexId> {
    let mut before: BTreeMap<VertexId, VertexId> = BTreeMap::from([(from, from)]);
    let mut rim = vec![from];
    for _ in 0..LONGEST_JOIN {
        let mut next = Vec::new();
        for &vertex in &rim {
            for &neighbour in complex.neighbours(vertex) {
                let allowed = near.binary_search_by_key(&neighbour, |near| near.vertex).is_ok();
                if allowed && !before.contains_key(&neighbour) {
                    before.insert(neighbour, vertex);
                    next.push(neighbour);
                }
            }
        }
        if before.contains_key(&to) {
            let mut path = Vec::new();
            let mut vertex = before[&to];
            while vertex != from {
                path.push(vertex);
                vertex = before[&vertex];
            }
            return path;
        }
        rim = next;
    }
    Vec::new()
}

/// Mean length of the edges at some vertices; 0 without any.
fn mean_edge(complex: &SimplicialComplex, near: &[Near]) -> f64 {
    let (mut sum, mut count) = (0.0, 0usize);
    for near in near {
        for &neighbour in complex.neighbours(near.vertex) {
            sum += norm(minus(complex.point(neighbour), complex.point(near.vertex)));
            count += 1;
        }
    }
    if count == 0 { 0.0 } else { sum / count as f64 }
}

/// The vertex nearest to a place, the lowest of several, and its distance.
pub(super) fn nearest(
    complex: &SimplicialComplex,
    vertices: impl Iterator<Item = VertexId>,
    place: [f64; 3],
) -> Option<(VertexId, f64)> {
    let distances = vertices.map(|vertex| (vertex, norm(minus(complex.point(vertex), place))));
    distances.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
}

/// Length of the longest edge at a vertex.
pub(super) fn longest_edge(complex: &SimplicialComplex, vertex: VertexId) -> f64 {
    let from = complex.point(vertex);
    complex.neighbours(vertex).iter().map(|&other| norm(minus(complex.point(other), from))).fold(0.0, f64::max)
}

/// Place, 0 to 1, of the point of a segment nearest to a point, and the distance to it.
fn project([start, end]: [[f64; 3]; 2], point: [f64; 3]) -> (f64, f64) {
    let (direction, offset) = (minus(end, start), minus(point, start));
    let square = dot(direction, direction);
    let place = if square > 0.0 { (dot(offset, direction) / square).clamp(0.0, 1.0) } else { 0.0 };
    let foot: [f64; 3] = std::array::from_fn(|axis| offset[axis] - place * direction[axis]);
    (place, norm(foot))
}
