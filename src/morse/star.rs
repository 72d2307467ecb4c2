//! Vertices and cofacets of cells, and which vertices lie on the boundary of the domain.

use rayon::prelude::*;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::SimplicialComplex;

use super::gradient::Cell;

/// The vertices of a cell; the slots that it does not need are `None`.
fn corners(complex: &SimplicialComplex, cell: Cell) -> [Option<VertexId>; 4] {
    let index = cell.index as usize;
    let mut corners = [None; 4];
    match cell.dimension {
        0 => corners[0] = Some(VertexId(cell.index)),
        1 => corners[..2].copy_from_slice(&complex.edges()[index].map(Some)),
        2 => corners[..3].copy_from_slice(&complex.triangles()[index].map(Some)),
        _ => corners.iter_mut().zip(complex.simplex(index)).for_each(|(slot, &corner)| *slot = Some(VertexId(corner))),
    }
    corners
}

/// The vertices of a cell.
pub(super) fn vertices(complex: &SimplicialComplex, cell: Cell) -> impl Iterator<Item = VertexId> {
    corners(complex, cell).into_iter().flatten()
}

/// Ranks of the vertices plus one, highest first, padded with 0: cells of one dimension compare as in the lower-star
/// filtration.
pub(super) fn key(complex: &SimplicialComplex, order: &VertexOrder, cell: Cell) -> [u32; 4] {
    let mut key = corners(complex, cell).map(|corner| corner.map_or(0, |vertex| order.rank(vertex) + 1));
    key.sort_unstable_by(|a, b| b.cmp(a));
    key
}

/// The cells one dimension above that have this one as a facet, by rising number of their top simplices.
pub(super) fn cofacets(complex: &SimplicialComplex, cell: Cell, found: &mut Vec<Cell>) {
    found.clear();
    if cell.dimension == 0 {
        found.extend(complex.incident_edges(VertexId(cell.index)).iter().map(|&edge| Cell::edge(edge)));
        return;
    }
    let own = corners(complex, cell);
    let mut own_corners = own.iter().flatten();
    let Some(first) = own_corners.next() else { return };
    let count = cell.dimension as usize + 1;
    for &simplex in complex.star(*first) {
        let corners = complex.simplex(simplex as usize);
        let has = |vertex: &VertexId| corners.contains(&vertex.0);
        if !own[1..count].iter().flatten().all(has) {
            continue;
        }
        match (cell.dimension, complex.dimension()) {
            (1, 2) => found.extend(complex.triangle([corners[0], corners[1], corners[2]].map(VertexId)).map(Cell::triangle)),
            (2, 3) => found.push(Cell { dimension: 3, index: simplex }),
            (1, 3) => {
                let others = corners.iter().filter(|&&corner| !own.contains(&Some(VertexId(corner))));
                for &other in others {
                    let triangle = [own[0].unwrap_or(*first), own[1].unwrap_or(*first), VertexId(other)];
                    let cofacet = complex.triangle(triangle).map(Cell::triangle);
                    found.extend(cofacet.filter(|cofacet| !found.contains(cofacet)));
                }
            }
            _ => {}
        }
    }
}

/// Whether each vertex lies on the boundary: on a facet of exactly one top simplex.
///
/// # Cost
/// Linear in the cells, parallel.
pub(super) fn on_boundary(complex: &SimplicialComplex) -> Vec<bool> {
    let dimension = complex.dimension() as u8 - 1;
    let count = [complex.vertex_count(), complex.edges().len(), complex.triangles().len()][dimension as usize];
    let rim: Vec<Cell> = (0..count as u32)
        .into_par_iter()
        .map(|index| Cell { dimension, index })
        .map_init(Vec::new, |around, cell| {
            cofacets(complex, cell, around);
            (around.len() == 1).then_some(cell)
        })
        .flatten_iter()
        .collect();
    let mut on_boundary = vec![false; complex.vertex_count()];
    for cell in rim {
        vertices(complex, cell).for_each(|vertex| on_boundary[vertex.index()] = true);
    }
    on_boundary
}
