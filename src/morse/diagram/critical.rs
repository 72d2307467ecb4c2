//! Critical cells in the order of the field, and their places by cell number.

use rayon::prelude::*;

use crate::mesh::{Cell, Triangulation};

use super::landscape::{Landscape, Ranks};

/// The critical cells of one dimension.
pub(super) struct CriticalCells {
    dimension: u8,
    /// Numbers of the cells, lowest cell first.
    cells: Vec<u32>,
    /// Their levels: rank of the highest vertex plus one.
    levels: Vec<u32>,
    /// One bit a cell of the mesh: whether it is critical.
    bits: Vec<u64>,
    /// Critical cells before each word of `bits`.
    before: Vec<u32>,
    /// Place in `cells` of every critical cell by rising number.
    places: Vec<u32>,
}

impl CriticalCells {
    pub(super) fn new<T: Triangulation>(landscape: &Landscape<'_, T>, dimension: usize) -> Self {
        let by_number = landscape.critical(dimension);
        let cell = |index| Cell { dimension: dimension as u8, index };
        let mut keyed: Vec<(Ranks, u32)> =
            by_number.par_iter().enumerate().map(|(at, &index)| (landscape.ranks(cell(index)), at as u32)).collect();
        // No two cells have the same vertices, so an unstable sort has one possible result.
        keyed.par_sort_unstable();
        let mut places = vec![0; keyed.len()];
        for (place, &(_, at)) in keyed.iter().enumerate() {
            places[at as usize] = place as u32;
        }
        let levels = keyed.iter().map(|(ranks, _)| ranks[0]).collect();
        let cells = keyed.into_iter().map(|(_, at)| by_number[at as usize]).collect();
        let mut bits = vec![0u64; landscape.numbers(dimension).div_ceil(64)];
        for index in by_number {
            bits[index as usize / 64] |= 1 << (index % 64);
        }
        let before = bits.iter().scan(0, |sum, word| Some(std::mem::replace(sum, *sum + word.count_ones()))).collect();
        Self { dimension: dimension as u8, cells, levels, bits, before, places }
    }

    pub(super) fn len(&self) -> usize {
        self.cells.len()
    }

    pub(super) fn dimension(&self) -> u8 {
        self.dimension
    }

    /// Levels of the cells, lowest cell first.
    pub(super) fn levels(&self) -> &[u32] {
        &self.levels
    }

    /// Places in the order by rising number of the cell: near in memory, where the order is not.
    pub(super) fn places(&self) -> &[u32] {
        &self.places
    }

    /// What `of_cell` says of every cell, lowest cell first; asked by rising number.
    pub(super) fn map<R: Copy + Default + Send>(&self, of_cell: impl Fn(u32) -> R + Sync) -> Vec<R> {
        let by_number: Vec<R> = self.places.par_iter().map(|&place| of_cell(self.cells[place as usize])).collect();
        let mut by_place = vec![R::default(); by_number.len()];
        for (&place, of_cell) in self.places.iter().zip(by_number) {
            by_place[place as usize] = of_cell;
        }
        by_place
    }

    /// The cell at a place of the order.
    pub(super) fn cell(&self, place: u32) -> Cell {
        Cell { dimension: self.dimension, index: self.cells[place as usize] }
    }

    /// Place in the order of a critical cell.
    pub(super) fn place(&self, index: u32) -> u32 {
        let word = index as usize / 64;
        let lower = self.bits[word] & ((1 << (index % 64)) - 1);
        self.places[(self.before[word] + lower.count_ones()) as usize]
    }
}
