//! The numeric factorisation: fronts assembled from children's updates, subtrees side by side.

use faer::dyn_stack::MemStack;
use rayon::prelude::*;

use super::assembly::Assembly;
use super::front::{eliminate, is_large, pass_on, scratch};
use super::pivoting::{Pivots, eliminate_with_pivots, pivoting_scratch};
use super::pool::Pool;
use super::tasks::{Places, Task};
use super::Value;

/// Destination columns that one thread assembles at a time in a large front.
const COLUMNS: usize = 64;

/// Runs of rows are added as runs where they are at least so long on average.
const LONG_RUNS: usize = 4;

/// What a factorisation reads.
pub(super) struct Multifrontal<'a, T> {
    pub assembly: &'a Assembly,
    pub places: &'a Places,
    /// Where the entries of each column of the matrix begin.
    pub starts: &'a [u32],
    /// Place in the factor of each entry of the matrix.
    pub targets: &'a [u32],
    /// The matrix.
    pub entries: &'a [f64],
    /// Width of the widest supernode.
    pub widest: usize,
    pub pool: &'a Pool<T>,
    pub kind: Kind,
}

/// Which matrices a factorisation is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Positive definite: `L Lᵀ`.
    Definite,
    /// Any symmetric: `L D Lᵀ` with pivoting within supernodes.
    Indefinite,
}

/// The factor of a run of supernodes.
#[derive(Debug, Default)]
pub(super) struct Part<'a, T> {
    pub values: &'a mut [T],
    /// Empty for a definite matrix.
    pub pivots: Pivots<'a, T>,
}

impl<'a, T> Part<'a, T> {
    /// Cuts off the first so many values and columns.
    fn cut(&mut self, values: usize, columns: usize) -> Self {
        fn head<'a, U>(slice: &mut &'a mut [U], length: usize) -> &'a mut [U] {
            let (head, tail) = std::mem::take(slice).split_at_mut(length);
            *slice = tail;
            head
        }
        let columns = columns.min(self.pivots.order.len());
        Self {
            values: head(&mut self.values, values),
            pivots: Pivots {
                couplings: head(&mut self.pivots.couplings, columns),
                order: head(&mut self.pivots.order, columns),
                inverse: head(&mut self.pivots.inverse, columns),
            },
        }
    }
}

/// The update matrices of a finished task's roots, in the stack that holds them.
struct Output<'a, T> {
    task: &'a Task,
    stack: Vec<T>,
}

impl<T: Value> Multifrontal<'_, T> {
    /// Factors everything into `part`.
    ///
    /// # Errors
    /// The column with the first failed pivot.
    pub fn run(&self, task: &Task, part: Part<'_, T>) -> Result<(), usize> {
        self.task(task, part).map(|output| self.pool.give(output.stack))
    }

    fn task<'t>(&self, task: &'t Task, mut part: Part<'_, T>) -> Result<Output<'t, T>, usize> {
        let assembly = self.assembly;
        let mut own = Vec::with_capacity(task.inner.len() + 1);
        let mut below = Vec::with_capacity(task.inner.len());
        let mut cut = |begin: usize, end: usize| {
            part.cut(assembly.values[end] - assembly.values[begin], (assembly.columns[end] - assembly.columns[begin]) as usize)
        };
        for (place, (begin, end)) in task.own().enumerate() {
            own.push((begin, end, cut(begin, end)));
            if let Some(inner) = task.inner.get(place) {
                below.push((inner, cut(inner.first, inner.end)));
            }
        }
        let done: Vec<Result<Output<'t, T>, usize>> =
            below.into_par_iter().with_max_len(1).map(|(inner, part)| self.task(inner, part)).collect();
        // In order, so that the first failed pivot is named whatever ran first.
        let inputs = done.into_iter().collect::<Result<Vec<_>, usize>>()?;
        let mut stacks = task.matrices.map(|length| self.pool.take(length));
        let (mut memory, mut scaled) = match self.kind {
            Kind::Definite => (scratch::<T>(self.widest), Vec::new()),
            Kind::Indefinite => (pivoting_scratch::<T>(self.widest), self.pool.take(task.below)),
        };
        for (begin, end, mut part) in own {
            for supernode in begin..end {
                let width = assembly.width(supernode);
                let part = part.cut(width * assembly.height(supernode), width);
                let inputs = if task.branch == Some(supernode) { &inputs[..] } else { &[] };
                self.front(supernode, part, (&mut stacks, &mut scaled), inputs, MemStack::new(&mut memory))?;
            }
        }
        self.pool.give(scaled);
        for input in inputs {
            self.pool.give(input.stack);
        }
        let [even, odd] = stacks;
        let (kept, free) = if task.end > task.first && self.assembly.parity[task.end - 1] == 0 { (even, odd) } else { (odd, even) };
        self.pool.give(free);
        Ok(Output { task, stack: kept })
    }

    fn front(
        &self,
        supernode: usize,
        part: Part<'_, T>,
        (stacks, scaled): (&mut [Vec<T>; 2], &mut [T]),
        inputs: &[Output<'_, T>],
        memory: &mut MemStack,
    ) -> Result<(), usize> {
        let assembly = self.assembly;
        let (height, width, reach) = (assembly.height(supernode), assembly.width(supernode), assembly.reach(supernode));
        let is_large = is_large(assembly.flops[supernode]);
        let [even, odd] = stacks;
        let (mine, other) = if assembly.parity[supernode] == 0 { (even, odd) } else { (odd, even) };
        let updates = Updates { assembly, places: self.places, supernode, stack: other, inputs };

        let Part { values: columns, mut pivots } = part;
        columns.fill(T::of(0.0));
        let first = assembly.columns[supernode] as usize;
        let range = self.starts[first] as usize..self.starts[first + width] as usize;
        let base = assembly.values[supernode];
        for (&target, &value) in self.targets[range.clone()].iter().zip(&self.entries[range]) {
            columns[target as usize - base] = T::of(value);
        }
        let has_children = !assembly.children(supernode).is_empty();
        if has_children {
            updates.add(columns, height, (0, width), 0, is_large);
        }
        let below = &mut scaled[..if self.kind == Kind::Indefinite { reach * width } else { 0 }];
        match self.kind {
            Kind::Definite => eliminate(columns, (height, width), is_large, memory),
            Kind::Indefinite => eliminate_with_pivots(columns, (height, width), &mut pivots, below, memory),
        }
        .map_err(|index| first + index)?;
        if reach > 0 {
            let place = self.places.matrix[supernode];
            let update = &mut mine[place..place + reach * reach];
            if has_children || is_large {
                updates.add(update, reach, (width, height), width, is_large);
            }
            let below = (self.kind == Kind::Indefinite).then_some(&*below);
            pass_on(columns, (height, width), below, update, (is_large, !has_children && !is_large));
        }
        Ok(())
    }
}

/// The updates that the children of a supernode have left.
struct Updates<'a, T> {
    assembly: &'a Assembly,
    places: &'a Places,
    supernode: usize,
    stack: &'a [T],
    inputs: &'a [Output<'a, T>],
}

impl<T: Value> Updates<'_, T> {
    /// Adds the children's updates to some columns of the front; with `skipped` > 0 the columns are cleared first.
    ///
    /// # Arguments
    /// * `target`: the columns `range` of the front from row `skipped` on, `stride` numbers each.
    fn add(&self, target: &mut [T], stride: usize, range: (usize, usize), skipped: usize, in_parallel: bool) {
        if in_parallel {
            target.par_chunks_mut(stride * COLUMNS).enumerate().for_each(|(chunk, target)| {
                let begin = range.0 + chunk * COLUMNS;
                self.add_range(target, stride, (begin, (begin + COLUMNS).min(range.1)), skipped);
            });
        } else {
            self.add_range(target, stride, range, skipped);
        }
    }

    fn add_range(&self, target: &mut [T], stride: usize, (begin, end): (usize, usize), skipped: usize) {
        if skipped > 0 {
            for (column, slots) in (begin - skipped..).zip(target.chunks_mut(stride)) {
                slots[column..].fill(T::of(0.0));
            }
        }
        for &child in self.assembly.children(self.supernode) {
            let child = child as usize;
            let relative = self.assembly.relative(child);
            let reach = relative.len();
            let place = self.places.matrix[child];
            let input = self.inputs.iter().find(|input| (input.task.first..input.task.end).contains(&child));
            let update = &input.map_or(self.stack, |input| &input.stack)[place..place + reach * reach];
            let from = relative.partition_point(|&row| (row as usize) < begin);
            let to = relative.partition_point(|&row| (row as usize) < end);
            let runs = self.assembly.runs(child);
            let are_long = reach >= LONG_RUNS * runs.len();
            let mut run = 0;
            for column in from..to {
                let at = (relative[column] as usize - begin) * stride;
                let slots = &mut target[at..at + stride];
                let source = &update[column * reach + column..(column + 1) * reach];
                if !are_long {
                    for (&row, value) in relative[column..].iter().zip(source) {
                        slots[row as usize - skipped] += *value;
                    }
                    continue;
                }
                while runs[run + 1] as usize <= column {
                    run += 1;
                }
                let mut first = column;
                for &end in &runs[run + 1..] {
                    let end = end as usize;
                    let low = relative[first] as usize - skipped;
                    for (slot, value) in slots[low..low + (end - first)].iter_mut().zip(&source[first - column..end - column]) {
                        *slot += *value;
                    }
                    first = end;
                }
            }
        }
    }
}
