//! Solves with a factor: up the tree and down again, subtrees side by side.
//!
//! Right-hand sides are interleaved, `W` numbers an unknown, so that a subtree's part of all of them is one slice; within the
//! vectors of a supernode they follow one another, as the dense kernels like them.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place, solve_unit_upper_triangular_in_place,
    solve_upper_triangular_in_place,
};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

use super::assembly::{Assembly, NONE};
use super::pivoting::Blocks;
use super::pool::Pool;
use super::tasks::{Places, Task};
use super::Value;

/// Supernodes of this size and more go through the dense kernels: a single right-hand side, several ones.
const DENSE: [usize; 2] = [512, 128];

fn is_dense<const W: usize>(height: usize, width: usize) -> bool {
    height * width >= DENSE[usize::from(W > 1)]
}

/// Numbers of the next supernode that are fetched ahead: well within the cache of one core.
const AHEAD: usize = 16_384;

/// Reads a number of each cache line, so that the columns are at hand when their turn comes.
///
/// A solve is bound by the memory that the factor comes from, and the groups of short columns that the kernels go through side by side do not
/// look like a stream to the processor. (Measured: solves with factors of 58,000 and 250,000 unknowns take 0.72 to 0.78 of the time.)
fn fetch<T: Value>(columns: &[T]) {
    const LINE: usize = 64;
    let ahead = &columns[..columns.len().min(AHEAD)];
    std::hint::black_box(ahead.iter().step_by(LINE / size_of::<T>()).fold(T::of(0.0), |sum, value| sum + *value));
}

/// What a solve reads.
pub(super) struct Substitution<'a, T> {
    pub assembly: &'a Assembly,
    pub places: &'a Places,
    /// The factor.
    pub values: &'a [T],
    /// Couplings and order of the columns of an indefinite factor.
    pub pivots: Option<(&'a [T], &'a [u32])>,
    pub pool: &'a Pool<T>,
}

struct Output<'a, T> {
    task: &'a Task,
    stack: Vec<T>,
}

/// A run of supernodes and its part of the vectors.
type Part<'x, T> = (usize, usize, &'x mut [T]);

/// An inner task and its part of the vectors.
type InnerPart<'t, 'x, T> = (&'t Task, &'x mut [T]);

impl<T: Value> Substitution<'_, T> {
    /// Overwrites `x` (permuted, `W` interleaved right-hand sides) with the solution.
    pub fn solve<const W: usize>(&self, task: &Task, x: &mut [T]) {
        let output = self.upwards::<W>(task, x);
        self.pool.give(output.stack);
        self.downwards::<W>(task, x, (NONE as usize, &[]));
    }

    /// The parts of `x` that belong to the task's own runs of supernodes and to its inner tasks.
    fn parts<'t, 'x, const W: usize>(&self, task: &'t Task, x: &'x mut [T]) -> (Vec<Part<'x, T>>, Vec<InnerPart<'t, 'x, T>>) {
        let length = |begin: usize, end: usize| (self.assembly.columns[end] - self.assembly.columns[begin]) as usize * W;
        let mut own = Vec::with_capacity(task.inner.len() + 1);
        let mut inner = Vec::with_capacity(task.inner.len());
        let mut rest = x;
        for (place, (begin, end)) in task.own().enumerate() {
            let (head, tail) = rest.split_at_mut(length(begin, end));
            own.push((begin, end, head));
            rest = tail;
            if let Some(below) = task.inner.get(place) {
                let (head, tail) = rest.split_at_mut(length(below.first, below.end));
                inner.push((below, head));
                rest = tail;
            }
        }
        (own, inner)
    }

    fn columns(&self, supernode: usize) -> &[T] {
        &self.values[self.assembly.values[supernode]..self.assembly.values[supernode + 1]]
    }

    /// `x := inverse(L) x`.
    fn upwards<'t, const W: usize>(&self, task: &'t Task, x: &mut [T]) -> Output<'t, T> {
        let (own, below) = self.parts::<W>(task, x);
        let inputs: Vec<Output<'t, T>> = match below.len() {
            0 => Vec::new(),
            _ => below.into_par_iter().with_max_len(1).map(|(inner, x)| self.upwards::<W>(inner, x)).collect(),
        };
        let mut stacks = task.vectors.map(|length| self.pool.take(length * W));
        for (begin, end, mut x) in own {
            for supernode in begin..end {
                let width = self.assembly.width(supernode);
                let (here, rest) = std::mem::take(&mut x).split_at_mut(width * W);
                x = rest;
                if supernode + 1 < end {
                    fetch(self.columns(supernode + 1));
                }
                let inputs = if task.branch == Some(supernode) { &inputs[..] } else { &[] };
                self.up::<W>(supernode, here, &mut stacks, inputs);
            }
        }
        for input in inputs {
            self.pool.give(input.stack);
        }
        let [even, odd] = stacks;
        let (kept, free) = if task.end > task.first && self.assembly.parity[task.end - 1] == 0 { (even, odd) } else { (odd, even) };
        self.pool.give(free);
        Output { task, stack: kept }
    }

    fn up<const W: usize>(&self, supernode: usize, here: &mut [T], stacks: &mut [Vec<T>; 2], inputs: &[Output<'_, T>]) {
        let assembly = self.assembly;
        let (height, width) = (assembly.height(supernode), assembly.width(supernode));
        let [even, odd] = stacks;
        let (mine, other) = if assembly.parity[supernode] == 0 { (even, odd) } else { (odd, even) };
        let place = self.places.vector[supernode] * W;
        let local = &mut mine[place..place + height * W];
        put_in::<T, W>(here, local, height);
        local.chunks_exact_mut(height).for_each(|local| local[width..].fill(T::of(0.0)));
        for &child in assembly.children(supernode) {
            let child = child as usize;
            let input = inputs.iter().find(|input| (input.task.first..input.task.end).contains(&child));
            let stack = input.map_or(&other[..], |input| &input.stack);
            let below = assembly.height(child);
            let passed = &stack[self.places.vector[child] * W..][..below * W];
            for (local, passed) in local.chunks_exact_mut(height).zip(passed.chunks_exact(below)) {
                for (&row, value) in assembly.relative(child).iter().zip(&passed[assembly.width(child)..]) {
                    local[row as usize] += *value;
                }
            }
        }
        if let Some((couplings, order)) = self.pivots {
            let range = assembly.columns[supernode] as usize..assembly.columns[supernode + 1] as usize;
            let (couplings, order) = (&couplings[range.clone()], &order[range]);
            // The slots of `here` are free until the end.
            take_out::<T, W>(local, height, here);
            for (side, local) in local.chunks_exact_mut(height).enumerate() {
                for (slot, &column) in local.iter_mut().zip(order) {
                    *slot = here[column as usize * W + side];
                }
            }
            forward_with_pivots::<T, W>(self.columns(supernode), (height, width), couplings, local, here);
        } else {
            forward::<T, W>(self.columns(supernode), (height, width), local);
            take_out::<T, W>(local, height, here);
        }
    }

    /// `x := inverse(Lᵀ) x`.
    ///
    /// # Arguments
    /// * `above`: the parent of the task's roots and the solution at its columns and rows.
    fn downwards<const W: usize>(&self, task: &Task, x: &mut [T], above: (usize, &[T])) {
        let (own, below) = self.parts::<W>(task, x);
        let mut memory = self.pool.take(task.downwards * W);
        for (begin, end, mut x) in own.into_iter().rev() {
            for supernode in (begin..end).rev() {
                let (rest, here) = std::mem::take(&mut x).split_at_mut(x_length::<W>(self.assembly, begin, supernode));
                x = rest;
                if supernode > begin {
                    fetch(self.columns(supernode - 1));
                }
                self.down::<W>(supernode, here, &mut memory, above);
            }
        }
        if !below.is_empty() {
            let above = task.branch.map_or((NONE as usize, &[][..]), |branch| {
                let place = self.places.downwards[branch] * W;
                (branch, &memory[place..place + self.assembly.height(branch) * W])
            });
            below.into_par_iter().with_max_len(1).for_each(|(inner, x)| self.downwards::<W>(inner, x, above));
        }
        self.pool.give(memory);
    }

    fn down<const W: usize>(&self, supernode: usize, here: &mut [T], memory: &mut [T], above: (usize, &[T])) {
        let assembly = self.assembly;
        let (height, width) = (assembly.height(supernode), assembly.width(supernode));
        let parent = assembly.parent[supernode] as usize;
        let place = self.places.downwards[supernode] * W;
        let size = height * W;
        let relative = assembly.relative(supernode);
        let gather = |local: &mut [T], from: &[T]| {
            let above = assembly.height(parent);
            for (local, from) in local.chunks_exact_mut(height).zip(from.chunks_exact(above)) {
                for (slot, &row) in local[width..].iter_mut().zip(relative) {
                    *slot = from[row as usize];
                }
            }
        };
        let local = if parent == NONE as usize {
            &mut memory[place..place + size]
        } else if parent == above.0 {
            let local = &mut memory[place..place + size];
            gather(local, above.1);
            local
        } else {
            // The parent lies before its children, except for the branch, which lies behind everything.
            let from = self.places.downwards[parent] * W;
            if from < place {
                let (head, tail) = memory.split_at_mut(place);
                gather(&mut tail[..size], &head[from..from + assembly.height(parent) * W]);
                &mut tail[..size]
            } else {
                let (head, tail) = memory.split_at_mut(from);
                gather(&mut head[place..place + size], &tail[..assembly.height(parent) * W]);
                &mut head[place..place + size]
            }
        };
        put_in::<T, W>(here, local, height);
        if let Some((_, order)) = self.pivots {
            backward_with_pivots::<T, W>(self.columns(supernode), (height, width), local);
            let order = &order[assembly.columns[supernode] as usize..][..width];
            for (side, local) in local.chunks_exact(height).enumerate() {
                for (&value, &column) in local.iter().zip(order) {
                    here[column as usize * W + side] = value;
                }
            }
            // What the children read are the unknowns in their own order.
            put_in::<T, W>(here, local, height);
        } else {
            backward::<T, W>(self.columns(supernode), (height, width), local);
            take_out::<T, W>(local, height, here);
        }
    }
}

fn x_length<const W: usize>(assembly: &Assembly, begin: usize, supernode: usize) -> usize {
    (assembly.columns[supernode] - assembly.columns[begin]) as usize * W
}

/// The interleaved unknowns of a supernode, into the heads of its local vectors.
fn put_in<T: Value, const W: usize>(here: &[T], local: &mut [T], height: usize) {
    for (side, local) in local.chunks_exact_mut(height).enumerate() {
        for (slot, values) in local.iter_mut().zip(here.chunks_exact(W)) {
            *slot = values[side];
        }
    }
}

/// The heads of the local vectors, interleaved.
fn take_out<T: Value, const W: usize>(local: &[T], height: usize, here: &mut [T]) {
    for (side, local) in local.chunks_exact(height).enumerate() {
        for (slots, &value) in here.chunks_exact_mut(W).zip(local) {
            slots[side] = value;
        }
    }
}

/// Eliminates a supernode's columns from the local vectors, one after the other of `height` numbers each.
fn forward<T: Value, const W: usize>(columns: &[T], (height, width): (usize, usize), local: &mut [T]) {
    if is_dense::<W>(height, width) {
        let (top, bottom) = MatRef::from_column_major_slice(columns, height, width).split_at_row(width);
        let (mut here, passed) = MatMut::from_column_major_slice_mut(local, height, W).split_at_row_mut(width);
        solve_lower_triangular_in_place(top, here.rb_mut(), Par::Seq);
        matmul(passed, Accum::Add, bottom, here.rb(), T::of(-1.0), Par::Seq);
    } else {
        local.chunks_exact_mut(height).for_each(|local| forward_one(columns, (height, width), local));
    }
}

/// Solves for a supernode's unknowns, those above being known.
fn backward<T: Value, const W: usize>(columns: &[T], (height, width): (usize, usize), local: &mut [T]) {
    if is_dense::<W>(height, width) {
        let (top, bottom) = MatRef::from_column_major_slice(columns, height, width).split_at_row(width);
        let (mut here, known) = MatMut::from_column_major_slice_mut(local, height, W).split_at_row_mut(width);
        matmul(here.rb_mut(), Accum::Add, bottom.transpose(), known.rb(), T::of(-1.0), Par::Seq);
        solve_upper_triangular_in_place(top.transpose(), here.rb_mut(), Par::Seq);
    } else {
        local.chunks_exact_mut(height).for_each(|local| backward_one(columns, (height, width), local));
    }
}

/// Eliminates a supernode's columns, already in the order of their pivots, from the local vectors; `here := inverse(D)` times
/// what is left of them.
fn forward_with_pivots<T: Value, const W: usize>(
    columns: &[T],
    (height, width): (usize, usize),
    couplings: &[T],
    local: &mut [T],
    here: &mut [T],
) {
    let (top, bottom) = MatRef::from_column_major_slice(columns, height, width).split_at_row(width);
    let (mut solved, passed) = MatMut::from_column_major_slice_mut(local, height, W).split_at_row_mut(width);
    solve_unit_lower_triangular_in_place(top, solved.rb_mut(), Par::Seq);
    matmul(passed, Accum::Add, bottom, solved.rb(), T::of(-1.0), Par::Seq);
    Blocks { top, couplings }.divide(solved.rb(), MatMut::from_row_major_slice_mut(here, width, W));
}

fn backward_with_pivots<T: Value, const W: usize>(columns: &[T], (height, width): (usize, usize), local: &mut [T]) {
    let (top, bottom) = MatRef::from_column_major_slice(columns, height, width).split_at_row(width);
    let (mut here, known) = MatMut::from_column_major_slice_mut(local, height, W).split_at_row_mut(width);
    matmul(here.rb_mut(), Accum::Add, bottom.transpose(), known.rb(), T::of(-1.0), Par::Seq);
    solve_unit_upper_triangular_in_place(top.transpose(), here.rb_mut(), Par::Seq);
}

/// Columns that go through a vector together: each number of the vector is loaded once for all of them.
const GROUP: usize = 4;

fn forward_one<T: Value>(columns: &[T], (height, width): (usize, usize), local: &mut [T]) {
    let mut index = 0;
    while index < width {
        let size = GROUP.min(width - index);
        for inner in 0..size {
            let column = &columns[(index + inner) * height..][..height];
            let value = local[index + inner] / column[index + inner];
            local[index + inner] = value;
            for row in index + inner + 1..index + size {
                local[row] -= column[row] * value;
            }
        }
        let (head, tail) = local.split_at_mut(index + size);
        let below = |inner: usize| &columns[(index + inner) * height + index + size..][..tail.len()];
        if size == GROUP {
            let [a, b, c, d] = [below(0), below(1), below(2), below(3)];
            let [p, q, r, s] = [head[index], head[index + 1], head[index + 2], head[index + 3]];
            for ((((slot, a), b), c), d) in tail.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                *slot -= (*a * p + *b * q) + (*c * r + *d * s);
            }
        } else {
            for inner in 0..size {
                let value = head[index + inner];
                let column = &columns[(index + inner) * height + index + size..][..tail.len()];
                for (slot, factor) in tail.iter_mut().zip(column) {
                    *slot -= *factor * value;
                }
            }
        }
        index += size;
    }
}

fn backward_one<T: Value>(columns: &[T], (height, width): (usize, usize), local: &mut [T]) {
    let mut end = width;
    while end > 0 {
        // The first group is the ragged one, as on the way up it was the last.
        let size = if end % GROUP == 0 { GROUP } else { end % GROUP };
        let index = end - size;
        let (head, tail) = local.split_at_mut(end);
        for inner in (0..size).rev() {
            let column = &columns[(index + inner) * height..][..height];
            let mut value = head[index + inner] - product(&column[end..], tail);
            for row in index + inner + 1..end {
                value -= column[row] * head[row];
            }
            head[index + inner] = value / column[index + inner];
        }
        end = index;
    }
}

/// The sum of products, in eight interleaved sums.
fn product<T: Value>(one: &[T], other: &[T]) -> T {
    const LANES: usize = 8;
    let mut sums = [T::of(0.0); LANES];
    let (ones, others) = (one.chunks_exact(LANES), other.chunks_exact(LANES));
    let rest = ones.remainder().iter().zip(others.remainder()).fold(T::of(0.0), |sum, (a, b)| sum + *a * *b);
    for (a, b) in ones.zip(others) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + e) + (b + f)) + ((c + g) + (d + h)) + rest
}
