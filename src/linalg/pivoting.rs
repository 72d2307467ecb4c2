//! The dense work on one supernode of an indefinite matrix: `P A Pᵀ = L D Lᵀ` with pivots of one or two columns, sought within
//! the supernode.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::lblt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{ColMut, MatMut, MatRef, Par};

use super::Value;
use super::front::{TILE, half};

/// Memory for eliminating the columns of fronts up to a width.
pub(super) fn pivoting_scratch<T: Value>(width: usize) -> MemBuffer {
    MemBuffer::new(cholesky_in_place_scratch::<u32, T>(width, Par::Seq, Default::default()))
}

/// What pivoting leaves of a supernode beside its columns, one number a column.
#[derive(Debug, Default)]
pub(super) struct Pivots<'a, T> {
    /// Below the diagonal of D: nonzero in the first column of a pivot of two.
    pub couplings: &'a mut [T],
    /// Which column of the supernode was eliminated at each place.
    pub order: &'a mut [u32],
    /// Place of each column of the supernode.
    pub inverse: &'a mut [u32],
}

/// Overwrites the columns of a front with L below its diagonal and D on it.
///
/// # Arguments
/// * `columns`: `height x width`, column by column; the upper triangle is not read.
/// * `scaled`: `(height - width) x width` numbers, overwritten with the rows of `L D` below the diagonal block.
///
/// # Errors
/// The first column (in the order given) whose pivot is zero or not finite.
///
/// # Source
/// Bunch and Kaufman 1977, through `faer`.
pub(super) fn eliminate_with_pivots<T: Value>(
    columns: &mut [T],
    (height, width): (usize, usize),
    pivots: &mut Pivots<'_, T>,
    scaled: &mut [T],
    stack: &mut MemStack,
) -> Result<(), usize> {
    let (mut top, bottom) = MatMut::from_column_major_slice_mut(columns, height, width).split_at_row_mut(width);
    // Only pivots of two write theirs.
    pivots.couplings.fill(T::of(0.0));
    let couplings = ColMut::from_slice_mut(&mut *pivots.couplings).as_diagonal_mut();
    cholesky_in_place(top.rb_mut(), couplings, pivots.order, pivots.inverse, Par::Seq, stack, Default::default());
    let top = top.rb();
    let blocks = Blocks { top, couplings: pivots.couplings };
    if let Some(place) = blocks.first_bad() {
        return Err(pivots.order[place] as usize);
    }
    let scaled = MatMut::from_column_major_slice_mut(scaled, height - width, width);
    rows_below(bottom, scaled, blocks, pivots.order);
    Ok(())
}

/// D, as it lies on the diagonal of the columns and beside it.
#[derive(Clone, Copy)]
pub(super) struct Blocks<'a, T> {
    pub top: MatRef<'a, T>,
    pub couplings: &'a [T],
}

/// The inverse of one block of D: a number, or the three of a symmetric 2 x 2 matrix.
enum Inverse<T> {
    One(T),
    Two([T; 3]),
}

impl<T: Value> Blocks<'_, T> {
    /// The inverse of the block that begins at a place.
    fn inverse(&self, place: usize) -> Inverse<T> {
        let one = T::of(1.0);
        let first = self.top[(place, place)];
        let coupling = self.couplings[place];
        if coupling == T::of(0.0) {
            return Inverse::One(one / first);
        }
        // Scaled with the coupling, which is the largest entry, so that the determinant neither overflows nor cancels.
        let (a, c) = (first / coupling, self.top[(place + 1, place + 1)] / coupling);
        let scale = one / ((a * c - one) * coupling);
        Inverse::Two([c * scale, T::of(0.0) - scale, a * scale])
    }

    /// `to := inverse(D) from`.
    pub fn divide(&self, from: MatRef<'_, T>, mut to: MatMut<'_, T>) {
        let mut place = 0;
        while place < self.couplings.len() {
            match self.inverse(place) {
                Inverse::One(inverse) => {
                    for side in 0..from.ncols() {
                        to[(place, side)] = from[(place, side)] * inverse;
                    }
                    place += 1;
                }
                Inverse::Two([a, b, c]) => {
                    for side in 0..from.ncols() {
                        let (first, second) = (from[(place, side)], from[(place + 1, side)]);
                        to[(place, side)] = first * a + second * b;
                        to[(place + 1, side)] = first * b + second * c;
                    }
                    place += 2;
                }
            }
        }
    }

    fn first_bad(&self) -> Option<usize> {
        let finite = |value: T| value.get().is_finite();
        let mut place = 0;
        while place < self.couplings.len() {
            let (is_good, size) = match self.inverse(place) {
                Inverse::One(inverse) => (finite(inverse), 1),
                Inverse::Two([a, b, c]) => (finite(a) && finite(b) && finite(c), 2),
            };
            if !is_good || !finite(self.top[(place, place)]) {
                return Some(place);
            }
            place += size;
        }
        None
    }
}

/// The rows below the diagonal block, in tiles: `scaled := rows Pᵀ inverse(Lᵀ)`, `rows := scaled inverse(D)`.
fn rows_below<T: Value>(rows: MatMut<'_, T>, scaled: MatMut<'_, T>, blocks: Blocks<'_, T>, order: &[u32]) {
    if rows.nrows() > TILE {
        let middle = half(rows.nrows());
        let (upper, lower) = rows.split_at_row_mut(middle);
        let (scaled_upper, scaled_lower) = scaled.split_at_row_mut(middle);
        rayon::join(
            || rows_below(upper, scaled_upper, blocks, order),
            || rows_below(lower, scaled_lower, blocks, order),
        );
        return;
    }
    let mut scaled = scaled;
    for (place, &column) in order.iter().enumerate() {
        scaled.rb_mut().col_mut(place).copy_from(rows.rb().col(column as usize));
    }
    solve_unit_lower_triangular_in_place(blocks.top, scaled.rb_mut().transpose_mut(), Par::Seq);
    blocks.divide(scaled.rb().transpose(), rows.transpose_mut());
}
