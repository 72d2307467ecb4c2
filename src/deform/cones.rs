//! The rows `svec(sym(RᵀF) - eps I)` of every element.

use super::rest::{CHUNK, RestShape};
use super::state::symmetric_part;
use crate::linalg::CsrMatrix;
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Row and column of each entry of the scaled lower triangle; the first three are those of a 2 x 2 matrix.
const TRIANGLE: [(usize, usize); 6] = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];

/// Rows of one block.
pub(super) fn block(dimension: usize) -> usize {
    dimension * (dimension + 1) / 2
}

/// The matrix of the rows for given rotations.
///
/// Entry (a, b) of `sym(RᵀF)` is linear in the positions: vertex v and axis c enter by `(R_ca g_vb + R_cb g_va) / 2`.
pub(super) fn matrix(rest: &RestShape, rotations: &[[[f64; 3]; 3]]) -> CsrMatrix {
    let dimension = rest.dimension();
    let (stride, rows) = (dimension + 1, block(dimension));
    let width = stride * dimension;
    let elements = rest.element_count();
    let mut indices = vec![0u32; elements * rows * width];
    let mut values = vec![0.0; elements * rows * width];
    let each = (0..elements).into_par_iter().with_min_len(CHUNK);
    let blocks = indices.par_chunks_mut(rows * width).zip(values.par_chunks_mut(rows * width));
    each.zip(blocks).for_each(|(element, (indices, values))| {
        let rotation = &rotations[element];
        for (row, &(a, b)) in TRIANGLE[..rows].iter().enumerate() {
            let scale = if a == b { 0.5 } else { FRAC_1_SQRT_2 };
            for (corner, (&vertex, gradient)) in rest.corners(element).iter().zip(rest.gradients(element)).enumerate() {
                for (axis, turned) in rotation.iter().enumerate().take(dimension) {
                    let place = row * width + corner * dimension + axis;
                    indices[place] = vertex * dimension as u32 + axis as u32;
                    values[place] = scale * (turned[a] * gradient[b] + turned[b] * gradient[a]);
                }
            }
        }
    });
    let offsets = (0..=elements * rows).map(|row| (row * width) as u32).collect();
    CsrMatrix::from_parts(elements * rows, rest.vertex_count() * dimension, offsets, indices, values)
}

/// The offsets of the rows over displacements from a reference: `svec(sym(RᵀF) - eps I)` at the reference.
pub(super) fn offset(rest: &RestShape, rotations: &[[[f64; 3]; 3]], margins: &[f64], reference: &[f64]) -> Vec<f64> {
    let dimension = rest.dimension();
    let rows = block(dimension);
    let mut offset = vec![0.0; rest.element_count() * rows];
    let each = offset.par_chunks_mut(rows).with_min_len(CHUNK).enumerate();
    each.for_each(|(element, slots)| {
        let triangle = symmetric_part(dimension, &rotations[element], &rest.deformation_gradient(element, reference));
        for ((slot, entry), (a, b)) in slots.iter_mut().zip(triangle).zip(TRIANGLE) {
            *slot = if a == b { entry - margins[element] } else { SQRT_2 * entry };
        }
    });
    offset
}
