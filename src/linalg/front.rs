//! The dense work on one supernode: its columns, and what it passes up.
//!
//! Large fronts are cut into tiles of a fixed size, so that both the bits and the parallelism come from the matrix alone.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};

use super::Value;

/// Columns that are eliminated together in a large front.
const PANEL: usize = 128;

/// Rows and columns of a tile.
pub(super) const TILE: usize = 256;

/// Fronts with more work than this are cut into tiles.
const LARGE: f64 = 2e7;

/// Whether a front with so much work is cut into tiles.
pub(super) fn is_large(flops: f64) -> bool {
    flops >= LARGE
}

/// Memory for eliminating the columns of fronts up to a width.
pub(super) fn scratch<T: Value>(width: usize) -> MemBuffer {
    MemBuffer::new(cholesky_in_place_scratch::<T>(width, Par::Seq, Default::default()))
}

/// Overwrites the columns of a front with those of its factor.
///
/// # Arguments
/// * `columns`: `height x width`, column by column; the upper triangle is not read.
///
/// # Errors
/// The first column whose pivot is not positive.
pub(super) fn eliminate<T: Value>(
    columns: &mut [T],
    (height, width): (usize, usize),
    is_large: bool,
    stack: &mut MemStack,
) -> Result<(), usize> {
    let mut columns = MatMut::from_column_major_slice_mut(columns, height, width);
    if !is_large {
        let (mut top, bottom) = columns.split_at_row_mut(width);
        pivots(top.rb_mut(), stack)?;
        solve_lower_triangular_in_place(top.rb(), bottom.transpose_mut(), Par::Seq);
        return Ok(());
    }
    for begin in (0..width).step_by(PANEL) {
        let size = PANEL.min(width - begin);
        let (left, right) = columns.rb_mut().split_at_col_mut(begin);
        let (_, left) = left.rb().split_at_row(begin);
        let (left_top, left_bottom) = left.split_at_row(size);
        let (_, panel) = right.subcols_mut(0, size).split_at_row_mut(begin);
        let (mut top, bottom) = panel.split_at_row_mut(size);
        if begin > 0 {
            lower_product(top.rb_mut(), Accum::Add, left_top, left_top);
        }
        pivots(top.rb_mut(), stack).map_err(|index| begin + index)?;
        rows_below(bottom, left_bottom, left_top, top.rb());
    }
    Ok(())
}

/// `update -= B Cᵀ` in the lower triangle, B being the rows of the eliminated columns below their diagonal block.
///
/// # Arguments
/// * `columns`: the factor's columns; `update`: the square of the remaining rows, column by column.
/// * `scaled`: C, column by column, where it is not B.
/// * `is_first`: nothing has been written to `update` yet.
pub(super) fn pass_on<T: Value>(
    columns: &[T],
    (height, width): (usize, usize),
    scaled: Option<&[T]>,
    update: &mut [T],
    (is_large, is_first): (bool, bool),
) {
    let reach = height - width;
    let (_, below) = MatRef::from_column_major_slice(columns, height, width).split_at_row(width);
    let right = scaled.map_or(below, |scaled| MatRef::from_column_major_slice(scaled, reach, width));
    let update = MatMut::from_column_major_slice_mut(update, reach, reach);
    if is_large && !is_first {
        triangle_of_tiles(update, below, right);
    } else {
        let accum = if is_first { Accum::Replace } else { Accum::Add };
        lower_product(update, accum, below, right);
    }
}

fn lower_product<T: Value>(square: MatMut<'_, T>, accum: Accum, left: MatRef<'_, T>, right: MatRef<'_, T>) {
    let (lower, full) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
    triangular::matmul(square, lower, accum, left, full, right.transpose(), full, T::of(-1.0), Par::Seq);
}

fn pivots<T: Value>(square: MatMut<'_, T>, stack: &mut MemStack) -> Result<(), usize> {
    match cholesky_in_place(square, LltRegularization::default(), Par::Seq, stack, Default::default()) {
        Ok(_) => Ok(()),
        Err(LltError::NonPositivePivot { index }) => Err(index),
    }
}

/// The rows of a panel below its diagonal block, in tiles.
fn rows_below<T: Value>(rows: MatMut<'_, T>, left: MatRef<'_, T>, left_top: MatRef<'_, T>, top: MatRef<'_, T>) {
    if rows.nrows() > TILE {
        let (upper, lower) = rows.split_at_row_mut(half(left.nrows()));
        let (left_upper, left_lower) = left.split_at_row(half(left.nrows()));
        rayon::join(
            || rows_below(upper, left_upper, left_top, top),
            || rows_below(lower, left_lower, left_top, top),
        );
        return;
    }
    let mut rows = rows;
    if left.ncols() > 0 {
        matmul(rows.rb_mut(), Accum::Add, left, left_top.transpose(), T::of(-1.0), Par::Seq);
    }
    solve_lower_triangular_in_place(top, rows.transpose_mut(), Par::Seq);
}

/// About half of a length, a whole number of tiles.
pub(super) fn half(length: usize) -> usize {
    length.div_ceil(TILE).div_ceil(2) * TILE
}

fn triangle_of_tiles<T: Value>(update: MatMut<'_, T>, left: MatRef<'_, T>, right: MatRef<'_, T>) {
    let size = update.nrows();
    if size <= TILE {
        lower_product(update, Accum::Add, left, right);
        return;
    }
    let middle = half(size);
    let (first, _, corner, last) = update.split_at_mut(middle, middle);
    let (upper, lower) = left.split_at_row(middle);
    let (right_upper, right_lower) = right.split_at_row(middle);
    rayon::join(
        || tiles(corner, lower, right_upper),
        || rayon::join(|| triangle_of_tiles(first, upper, right_upper), || triangle_of_tiles(last, lower, right_lower)),
    );
}

fn tiles<T: Value>(block: MatMut<'_, T>, rows: MatRef<'_, T>, columns: MatRef<'_, T>) {
    if block.nrows() > TILE && block.nrows() >= block.ncols() {
        let middle = half(block.nrows());
        let (first, last) = block.split_at_row_mut(middle);
        let (upper, lower) = rows.split_at_row(middle);
        rayon::join(|| tiles(first, upper, columns), || tiles(last, lower, columns));
    } else if block.ncols() > TILE {
        let middle = half(block.ncols());
        let (first, last) = block.split_at_col_mut(middle);
        let (left, right) = columns.split_at_row(middle);
        rayon::join(|| tiles(first, rows, left), || tiles(last, rows, right));
    } else {
        matmul(block, Accum::Add, rows, columns.transpose(), T::of(-1.0), Par::Seq);
    }
}
