//! Finds what is wrong with a domain.

use super::{Domain, MeshFault, SimplicialComplex};
use crate::field::VertexId;
use rayon::prelude::*;

/// Vertices handled by one parallel task. Any size gives the same result.
const CHUNK: usize = 8192;

/// Refuses a domain on which nothing can be computed, with the first reason.
///
/// Looks only for what is refused: coordinates that are not finite, then simplices of zero measure. Everything else is
/// handled and listed by [`faults`].
///
/// # Errors
/// [`MeshFault::NonFiniteCoordinates`] or [`MeshFault::ZeroMeasure`].
///
/// # Cost
/// O(n + m), in parallel.
pub fn check(domain: &Domain) -> Result<(), MeshFault> {
    let complex = &domain.complex;
    let broken = complex.points().par_iter().with_min_len(CHUNK).position_first(|point| !is_finite(point));
    if let Some(vertex) = broken {
        return Err(non_finite(domain, vertex));
    }
    complex.first_zero_measure().map_or(Ok(()), |(simplex, ratio)| Err(zero_measure(domain, simplex, ratio)))
}

/// Everything that is wrong with a domain: what is refused, then what was handled while it was made, then its shape.
///
/// Looks for coordinates that are not finite, simplices of zero measure, non-manifold edges (more than two triangles), faces (more
/// than two tetrahedra) and vertices (the star is neither a disc or ball nor half of one; in dimension 1, more than two
/// lines), neighbours oriented against each other, and points at the same place.
///
/// # Returns
/// The faults, those of one kind by rising vertices; empty for an oriented manifold whose points are all used.
///
/// # Cost
/// O(m s log s) for m simplices and stars of s simplices, in parallel, and a sort of the points.
///
/// # Example
/// ```
/// use morsmooth::mesh::{CellList, CellShape, Domain, Mask, MeshFault, faults};
/// // Three triangles at one edge.
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]];
/// let cells = CellList::uniform(CellShape::Triangle, 3, &[0, 1, 2, 1, 0, 3, 0, 1, 4]);
/// let domain = Domain::from_cells(&points, &cells, &Mask::none())?;
/// assert_eq!(faults(&domain), [MeshFault::NonManifoldEdge { points: [0, 1], triangles: 3 }]);
/// # Ok::<(), morsmooth::mesh::DomainError>(())
/// ```
pub fn faults(domain: &Domain) -> Vec<MeshFault> {
    let complex = &domain.complex;
    let mut faults: Vec<MeshFault> = (0..complex.vertex_count())
        .filter(|&vertex| !is_finite(&complex.points()[vertex]))
        .map(|vertex| non_finite(domain, vertex))
        .collect();
    faults.extend(complex.zero_measures().into_iter().map(|(simplex, ratio)| zero_measure(domain, simplex, ratio)));
    faults.extend(domain.notes.iter().cloned());
    faults.extend(shape(domain));
    faults.extend(duplicate_points(domain));
    faults
}

fn is_finite(point: &[f64; 3]) -> bool {
    point.iter().all(|part| part.is_finite())
}

fn non_finite(domain: &Domain, vertex: usize) -> MeshFault {
    let coordinates = domain.complex.points()[vertex];
    MeshFault::NonFiniteCoordinates { point: domain.point_of_vertex[vertex], coordinates }
}

fn zero_measure(domain: &Domain, simplex: usize, ratio: f64) -> MeshFault {
    let points = domain.complex.simplex(simplex).iter().map(|&vertex| domain.point_of_vertex[vertex as usize]).collect();
    MeshFault::ZeroMeasure { cell: domain.cell_of_simplex[simplex], points, ratio }
}

/// A face of codimension 1: its sorted vertices, a top simplex at it, and the sense in which that runs round it.
type Facet = ([u32; 3], u32, bool);

/// Where the mesh branches or is oriented against itself.
#[derive(Default)]
struct Shape {
    /// Faces of codimension 1 with more than two top simplices, and how many.
    branches: Vec<([u32; 3], usize)>,
    /// Pairs of simplices oriented against each other.
    turned: Vec<[u32; 2]>,
}

/// Faults of edges, faces, vertices and orientation.
fn shape(domain: &Domain) -> Vec<MeshFault> {
    let complex = &domain.complex;
    let dimension = complex.dimension();
    let mut shape = Shape::default();
    for part in by_chunks(complex.vertex_count(), |vertex, part: &mut Shape, facets| facets_of(complex, vertex, part, facets)) {
        shape.branches.extend(part.branches);
        shape.turned.extend(part.turned);
    }
    let mut listed = vec![false; complex.vertex_count()];
    let mut faults = Vec::new();
    let point = |vertex: u32| domain.point_of_vertex[vertex as usize];
    for (vertices, simplices) in shape.branches {
        vertices[..dimension].iter().for_each(|&vertex| listed[vertex as usize] = true);
        let [a, b, c] = vertices;
        faults.push(match dimension {
            1 => MeshFault::NonManifoldVertex { point: point(a), sheets: simplices },
            2 => MeshFault::NonManifoldEdge { points: [point(a), point(b)], triangles: simplices },
            _ => MeshFault::NonManifoldFace { points: [point(a), point(b), point(c)], tetrahedra: simplices },
        });
    }
    if dimension > 1 {
        let pinched = by_chunks(complex.vertex_count(), |vertex, part: &mut Vec<(usize, usize)>, facets| {
            if !listed[vertex] {
                part.extend(pinch(complex, vertex, facets).map(|sheets| (vertex, sheets)));
            }
        });
        let fault = |(vertex, sheets): (usize, usize)| MeshFault::NonManifoldVertex { point: point(vertex as u32), sheets };
        faults.extend(pinched.into_iter().flatten().map(fault));
    }
    let cells = |pair: [u32; 2]| pair.map(|simplex| domain.cell_of_simplex[simplex as usize]);
    if let Some(&first) = shape.turned.first() {
        faults.push(MeshFault::InconsistentOrientation { count: shape.turned.len(), first: cells(first) });
    }
    faults
}

/// Visits all vertices in chunks, in parallel; one result a chunk, in order, and a list to reuse.
fn by_chunks<T: Default + Send>(vertices: usize, visit: impl Fn(usize, &mut T, &mut Vec<Facet>) + Sync) -> Vec<T> {
    (0..vertices.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut part = T::default();
            let mut facets = Vec::new();
            (chunk * CHUNK..vertices.min((chunk + 1) * CHUNK)).for_each(|vertex| visit(vertex, &mut part, &mut facets));
            part
        })
        .collect()
}

/// Looks at the faces of codimension 1 of which `vertex` is the lowest.
fn facets_of(complex: &SimplicialComplex, vertex: usize, shape: &mut Shape, facets: &mut Vec<Facet>) {
    facets.clear();
    for &simplex in complex.star(VertexId::from(vertex)) {
        facets.extend(facets_at(complex, simplex, vertex).filter(|facet| facet.0[0] as usize == vertex));
    }
    facets.sort_unstable();
    for run in facets.chunk_by(|a, b| a.0 == b.0) {
        match run {
            [a, b] if a.2 == b.2 => shape.turned.push([a.1, b.1]),
            [_, _, _, ..] => shape.branches.push((run[0].0, run.len())),
            _ => {}
        }
    }
}

/// The faces of codimension 1 of a simplex that contain a vertex.
fn facets_at(complex: &SimplicialComplex, simplex: u32, vertex: usize) -> impl Iterator<Item = Facet> {
    let corners = complex.simplex(simplex as usize);
    let left_out = (0..corners.len()).filter(move |&corner| corners[corner] as usize != vertex);
    left_out.map(move |left_out| {
        let mut face = [u32::MAX; 3];
        let others = corners.iter().enumerate().filter(|&(corner, _)| corner != left_out);
        face.iter_mut().zip(others).for_each(|(slot, (_, &corner))| *slot = corner);
        // The face without corner p carries the sign (-1)^p, and every exchange on the way to sorted order turns it.
        let exchanges = (0..3).map(|i| (i + 1..3).filter(|&j| face[j] < face[i]).count()).sum::<usize>();
        face.sort_unstable();
        (face, simplex, (left_out + exchanges) % 2 == 0)
    })
}

/// Number of sheets at a vertex whose star is no (half) disc or ball; `None` where it is one.
///
/// Sheets are the parts of the star that hang together through faces of codimension 1 at the vertex. One sheet without
/// branches is a manifold in dimension 2. In dimension 3 the link of one sheet is a connected surface, perhaps
/// pinched: each handle or pinch lowers its Euler characteristic below that of a sphere (2) or, with rim, of a disc (1).
fn pinch(complex: &SimplicialComplex, vertex: usize, facets: &mut Vec<Facet>) -> Option<usize> {
    let star = complex.star(VertexId::from(vertex));
    facets.clear();
    for (position, &simplex) in star.iter().enumerate() {
        facets.extend(facets_at(complex, simplex, vertex).map(|(face, _, sense)| (face, position as u32, sense)));
    }
    facets.sort_unstable();
    let mut parent: Vec<u32> = (0..star.len() as u32).collect();
    let (mut sheets, mut link_edges, mut rim) = (star.len(), 0, false);
    for run in facets.chunk_by(|a, b| a.0 == b.0) {
        link_edges += 1;
        rim |= run.len() == 1;
        for pair in run.windows(2) {
            let [a, b] = [pair[0].1, pair[1].1].map(|position| root(&mut parent, position));
            if a != b {
                parent[a as usize] = b;
                sheets -= 1;
            }
        }
    }
    let link_vertices = complex.neighbours(VertexId::from(vertex)).len();
    let euler = link_vertices + star.len();
    let round = complex.dimension() < 3 || euler == link_edges + if rim { 1 } else { 2 };
    (sheets > 1 || (sheets == 1 && !round)).then_some(sheets)
}

fn root(parent: &mut [u32], mut item: u32) -> u32 {
    while parent[item as usize] != item {
        parent[item as usize] = parent[parent[item as usize] as usize];
        item = parent[item as usize];
    }
    item
}

/// Vertices at the place of an earlier one.
fn duplicate_points(domain: &Domain) -> Option<MeshFault> {
    let points = domain.complex.points();
    // + 0.0 makes -0.0 and 0.0 the same place.
    let place = |vertex: u32| points[vertex as usize].map(|part| part + 0.0);
    let compare = |a: &u32, b: &u32| {
        let (p, q) = (place(*a), place(*b));
        p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])).then(p[2].total_cmp(&q[2])).then(a.cmp(b))
    };
    let mut order: Vec<u32> = (0..points.len() as u32).filter(|&vertex| is_finite(&points[vertex as usize])).collect();
    order.par_sort_unstable_by(compare);
    let runs = order.chunk_by(|&a, &b| place(a) == place(b));
    let (mut count, mut pair) = (0, None);
    for run in runs.filter(|run| run.len() > 1) {
        count += run.len() - 1;
        let here = (run[1], run[0]);
        pair = Some(pair.map_or(here, |pair: (u32, u32)| pair.min(here)));
    }
    let point = |vertex: u32| domain.point_of_vertex[vertex as usize];
    pair.map(|(later, earlier)| MeshFault::DuplicatePoints { count, first: point(earlier), second: point(later) })
}
