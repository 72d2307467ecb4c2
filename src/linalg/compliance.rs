//! Compliances: what unit forces on some rows move them all by, `B A⁻¹ Bᵀ`, from the factor of A.
//!
//! With `A = L D Lᵀ` and `Y = L⁻¹ Bᵀ` it is `Yᵀ D⁻¹ Y`. A sparse row of B touches the supernodes from its unknowns to the root and no others:
//! on a planar mesh some two thousand columns of the factor out of any number. Rows are taken in chunks, so that what they share is dense work.
//!
//! Sources: Gilbert and Peierls 1988 (sparse right-hand sides); Gill, Murray, Saunders and Wright 1990, *A Schur-complement method for sparse
//! quadratic programming* (why one wants this).

use std::collections::BTreeMap;

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, Mat, MatRef, Par};
use rayon::prelude::*;

use super::assembly::NONE;
use super::pivoting::Blocks;
use super::{SymbolicCholesky, Value};

/// Rows that go up the tree together.
const CHUNK: usize = 64;

/// A sparse row: unknowns and coefficients.
pub type SparseRow = Vec<(u32, f64)>;

/// `B A⁻¹ Bᵀ` of a growing number of rows of B, all with the same factor of A.
#[derive(Default)]
pub struct Compliance {
    chunks: Vec<Chunk>,
    /// Lower triangle, row by row.
    entries: Vec<f64>,
    size: usize,
}

impl Compliance {
    /// Without rows.
    pub fn new() -> Self {
        Self::default()
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Forgets all rows: the factor has changed.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// What a unit force on one row moves another by; symmetric.
    pub fn at(&self, row: usize, column: usize) -> f64 {
        let (low, high) = (row.min(column), row.max(column));
        self.entries[high * (high + 1) / 2 + low]
    }

    /// Adds rows; `factor` must be the one of all rows before.
    pub(super) fn extend<T: Value>(&mut self, factor: &Triangular<'_, T>, rows: &[SparseRow]) {
        let before = self.chunks.len();
        let firsts = (self.size..).step_by(CHUNK);
        let more: Vec<Chunk> = rows.par_chunks(CHUNK).zip(firsts.take(rows.len().div_ceil(CHUNK)).collect::<Vec<_>>()).map(|(rows, first)| factor.chunk(rows, first)).collect();
        self.chunks.extend(more);
        self.size += rows.len();
        self.entries.resize(self.size * (self.size + 1) / 2, 0.0);
        let pairs: Vec<(usize, usize)> = (before..self.chunks.len()).flat_map(|high| (0..=high).map(move |low| (high, low))).collect();
        let chunks = &self.chunks;
        let products: Vec<Mat<f64>> = pairs.par_iter().map(|&(high, low)| chunks[high].product(&chunks[low])).collect();
        for (&(high, low), product) in pairs.iter().zip(&products) {
            for row in 0..product.nrows() {
                let at = chunks[high].first + row;
                let length = product.ncols().min(at + 1 - chunks[low].first);
                let begin = at * (at + 1) / 2 + chunks[low].first;
                for (column, slot) in self.entries[begin..begin + length].iter_mut().enumerate() {
                    *slot = product[(row, column)];
                }
            }
        }
    }
}

/// A factor as forward substitution reads it.
pub(super) struct Triangular<'a, T> {
    pub symbolic: &'a SymbolicCholesky,
    pub values: &'a [T],
    /// Couplings and order of the columns of an indefinite factor.
    pub pivots: Option<(&'a [T], &'a [u32])>,
}

/// Some rows of B, solved upwards.
struct Chunk {
    first: usize,
    count: usize,
    /// By supernode, rising.
    blocks: Vec<Block>,
}

/// The columns of a supernode that some rows reach.
struct Block {
    supernode: usize,
    /// These rows, within the chunk.
    members: Vec<u32>,
    /// Y, a column a row of B.
    solved: Mat<f64>,
    /// `D⁻¹ Y`, where D is not the identity.
    scaled: Option<Mat<f64>>,
}

impl Chunk {
    /// `Yᵀ D⁻¹ Y` of this one's rows and another's.
    fn product(&self, other: &Self) -> Mat<f64> {
        let mut sum = Mat::zeros(self.count, other.count);
        let mut blocks = other.blocks.iter().peekable();
        for block in &self.blocks {
            while blocks.next_if(|other| other.supernode < block.supernode).is_some() {}
            let Some(other) = blocks.next_if(|other| other.supernode == block.supernode) else { continue };
            let mut product = Mat::zeros(block.members.len(), other.members.len());
            let right = other.scaled.as_ref().unwrap_or(&other.solved);
            matmul(product.as_mut(), Accum::Replace, block.solved.transpose(), right, 1.0, Par::Seq);
            for (column, &member) in other.members.iter().enumerate() {
                for (row, &mine) in block.members.iter().enumerate() {
                    sum[(mine as usize, member as usize)] += product[(row, column)];
                }
            }
        }
        sum
    }
}

impl<T: Value> Triangular<'_, T> {
    fn chunk(&self, rows: &[SparseRow], first: usize) -> Chunk {
        let assembly = &self.symbolic.assembly;
        let inverse = self.symbolic.inverse();
        // Who reaches which supernode, and what begins there.
        let mut members: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
        let mut begins = Vec::new();
        for (member, row) in rows.iter().enumerate() {
            for &(unknown, value) in row {
                let column = inverse[unknown as usize];
                let mut supernode = assembly.columns.partition_point(|&begin| begin <= column) - 1;
                begins.push((supernode, member as u32, column, value));
                while supernode != NONE as usize {
                    let here = members.entry(supernode).or_default();
                    if here.last() == Some(&(member as u32)) {
                        break;
                    }
                    here.push(member as u32);
                    supernode = assembly.parent[supernode] as usize;
                }
            }
        }
        begins.sort_by_key(|begin| begin.0);
        let mut begins = begins.into_iter().peekable();
        let mut open: BTreeMap<usize, Mat<T>> = BTreeMap::new();
        let mut blocks = Vec::with_capacity(members.len());
        for (&supernode, here) in &members {
            let mut local = open.remove(&supernode).unwrap_or_else(|| Mat::zeros(assembly.height(supernode), here.len()));
            while let Some((_, member, column, value)) = begins.next_if(|begin| begin.0 == supernode) {
                let place = position(here, member);
                local[((column - assembly.columns[supernode]) as usize, place)] += T::of(value);
            }
            blocks.push(self.eliminate(supernode, here.clone(), &mut local));
            let parent = assembly.parent[supernode] as usize;
            let Some(above) = members.get(&parent) else { continue };
            let target = open.entry(parent).or_insert_with(|| Mat::zeros(assembly.height(parent), above.len()));
            let width = assembly.width(supernode);
            for (column, &member) in here.iter().enumerate() {
                let place = position(above, member);
                for (below, &row) in assembly.relative(supernode).iter().enumerate() {
                    target[(row as usize, place)] += local[(width + below, column)];
                }
            }
        }
        Chunk { first, count: rows.len(), blocks }
    }

    /// Solves for a supernode's columns; below them `local` keeps what is passed on.
    fn eliminate(&self, supernode: usize, members: Vec<u32>, local: &mut Mat<T>) -> Block {
        let assembly = &self.symbolic.assembly;
        let (height, width) = (assembly.height(supernode), assembly.width(supernode));
        let values = &self.values[assembly.values[supernode]..assembly.values[supernode + 1]];
        let (top, bottom) = MatRef::from_column_major_slice(values, height, width).split_at_row(width);
        let (mut here, passed) = local.as_mut().split_at_row_mut(width);
        let double = |from: MatRef<'_, T>| Mat::from_fn(width, members.len(), |row, column| from[(row, column)].get());
        let scaled = match self.pivots {
            None => {
                solve_lower_triangular_in_place(top, here.rb_mut(), Par::Seq);
                None
            }
            Some((couplings, order)) => {
                let range = assembly.columns[supernode] as usize..assembly.columns[supernode + 1] as usize;
                let before = here.rb().to_owned();
                for (place, &column) in order[range.clone()].iter().enumerate() {
                    here.rb_mut().row_mut(place).copy_from(before.row(column as usize));
                }
                solve_unit_lower_triangular_in_place(top, here.rb_mut(), Par::Seq);
                let mut scaled = Mat::zeros(width, members.len());
                Blocks { top, couplings: &couplings[range] }.divide(here.rb(), scaled.as_mut());
                Some(double(scaled.as_ref()))
            }
        };
        matmul(passed, Accum::Add, bottom, here.rb(), T::of(-1.0), Par::Seq);
        let solved = double(here.rb());
        Block { supernode, members, solved, scaled }
    }
}

/// The place of a member, who must be one.
fn position(members: &[u32], member: u32) -> usize {
    members.partition_point(|&other| other < member)
}
