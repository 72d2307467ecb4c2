//! What all numeric factors share: the numbers, the work memory, and the way through the tree.

use rayon::prelude::*;

use super::multifrontal::{Kind, Multifrontal, Part};
use super::compliance::{Compliance, SparseRow, Triangular};
use super::pivoting::Pivots;
use super::pool::Pool;
use super::substitution::Substitution;
use super::{SymbolicCholesky, Value};

/// Vectors below this length are permuted by one thread.
const SHORT: usize = 65_536;

/// A numeric factor of a definite or an indefinite matrix.
pub(super) struct Numeric<T> {
    kind: Kind,
    values: Vec<T>,
    /// One number a column; empty for a definite matrix, like the two after it.
    couplings: Vec<T>,
    order: Vec<u32>,
    inverse: Vec<u32>,
    pool: Pool<T>,
    permuted: Vec<T>,
    columns: usize,
}

impl<T: Value> Numeric<T> {
    pub fn new(symbolic: &SymbolicCholesky, columns: usize, kind: Kind) -> Self {
        let columns = columns.clamp(1, 8).next_power_of_two();
        let zero = T::of(0.0);
        let pivots = if kind == Kind::Indefinite { symbolic.size() } else { 0 };
        Self {
            kind,
            values: vec![zero; symbolic.stored_entries()],
            couplings: vec![zero; pivots],
            order: vec![0; pivots],
            inverse: vec![0; pivots],
            pool: Pool::new(),
            permuted: vec![zero; symbolic.size() * columns],
            columns,
        }
    }

    /// Factors a matrix.
    ///
    /// # Errors
    /// The unknown with the first failed pivot.
    pub fn factor(&mut self, symbolic: &SymbolicCholesky, values: &[f64]) -> Result<(), usize> {
        assert_eq!(values.len(), symbolic.entries(), "values must fit the pattern");
        let multifrontal = Multifrontal {
            assembly: &symbolic.assembly,
            places: &symbolic.places,
            starts: &symbolic.starts,
            targets: &symbolic.targets,
            entries: values,
            widest: symbolic.widest,
            pool: &self.pool,
            kind: self.kind,
        };
        let pivots = Pivots { couplings: &mut self.couplings, order: &mut self.order, inverse: &mut self.inverse };
        let part = Part { values: &mut self.values, pivots };
        multifrontal.run(&symbolic.task, part).map_err(|column| symbolic.order().order()[column] as usize)
    }

    /// Adds rows to a compliance with this factor.
    pub fn comply(&self, symbolic: &SymbolicCholesky, compliance: &mut Compliance, rows: &[SparseRow]) {
        let pivots = (!self.order.is_empty()).then_some((&self.couplings[..], &self.order[..]));
        compliance.extend(&Triangular { symbolic, values: &self.values, pivots }, rows);
    }

    /// Overwrites right-hand sides of `n` numbers, one after the other, with their solutions.
    pub fn solve_in_place(&mut self, symbolic: &SymbolicCholesky, sides: &mut [f64]) {
        let n = symbolic.size();
        if n == 0 {
            return;
        }
        assert_eq!(sides.len() % n, 0, "right-hand sides must have n numbers each");
        for block in sides.chunks_mut(n * self.columns) {
            match block.len() / n {
                1 => self.solve::<1>(symbolic, block),
                2 => self.solve::<2>(symbolic, block),
                3 | 4 => self.solve::<4>(symbolic, block),
                _ => self.solve::<8>(symbolic, block),
            }
        }
    }

    /// Solves for at most `W` right-hand sides, interleaved and filled up with zeros.
    fn solve<const W: usize>(&mut self, symbolic: &SymbolicCholesky, block: &mut [f64]) {
        let n = symbolic.size();
        let count = block.len() / n;
        let order = symbolic.order().order();
        let permuted = &mut self.permuted[..n * W];
        let gather = |(slots, &old): (&mut [T], &u32)| {
            for (place, slot) in slots.iter_mut().enumerate() {
                *slot = if place < count { T::of(block[place * n + old as usize]) } else { T::of(0.0) };
            }
        };
        let is_long = n * W >= SHORT;
        if is_long {
            permuted.par_chunks_mut(W).zip(order).with_min_len(4096).for_each(gather);
        } else {
            permuted.chunks_mut(W).zip(order).for_each(gather);
        }
        let substitution = Substitution {
            assembly: &symbolic.assembly,
            places: &symbolic.places,
            values: &self.values,
            pivots: (!self.order.is_empty()).then_some((&self.couplings, &self.order)),
            pool: &self.pool,
        };
        substitution.solve::<W>(&symbolic.task, permuted);
        let permuted = &self.permuted;
        let inverse = symbolic.inverse();
        for (place, side) in block.chunks_mut(n).enumerate() {
            let scatter = |(slot, &new): (&mut f64, &u32)| *slot = permuted[new as usize * W + place].get();
            if is_long {
                side.par_iter_mut().zip(inverse).with_min_len(4096).for_each(scatter);
            } else {
                side.iter_mut().zip(inverse).for_each(scatter);
            }
        }
    }
}
