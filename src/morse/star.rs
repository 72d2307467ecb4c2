//! Vertices and cofacets of cells, and which vertices lie on the boundary of the domain.

use rayon::prelude::*;

use crate::field::VertexOrder;
use crate::mesh::{Cell, Triangulation};

/// Ranks of the vertices plus one, highest first, padded with 0: cells of one dimension compare as in the lower-star
/// filtration.
pub(super) fn key<T: Triangulation>(complex: &T, order: &VertexOrder, cell: Cell) -> [u32; 4] {
    let mut key = [0; 4];
    for (slot, &corner) in key.iter_mut().zip(complex.cell_vertices(cell).iter()) {
        *slot = order.rank(corner) + 1;
    }
    key.sort_unstable_by(|a, b| b.cmp(a));
    key
}

/// The cells one dimension above that have this one as a facet, by rising number.
pub(super) fn cofacets<T: Triangulation>(complex: &T, cell: Cell, found: &mut Vec<Cell>) {
    found.clear();
    found.extend(complex.cofacets(cell));
}

/// Whether each vertex lies on the boundary: on a facet of exactly one top simplex.
///
/// # Cost
/// Linear in the cells, parallel.
pub(super) fn on_boundary<T: Triangulation>(complex: &T) -> Vec<bool> {
    let dimension = complex.dimension() as u8 - 1;
    let rim: Vec<Cell> = (0..complex.cell_bound(dimension as usize) as u32)
        .into_par_iter()
        .map(|index| Cell { dimension, index })
        .filter(|&cell| complex.is_cell(cell) && complex.cofacets(cell).take(2).count() == 1)
        .collect();
    let mut on_boundary = vec![false; complex.vertex_count()];
    for cell in rim {
        complex.cell_vertices(cell).iter().for_each(|vertex| on_boundary[vertex.index()] = true);
    }
    on_boundary
}
