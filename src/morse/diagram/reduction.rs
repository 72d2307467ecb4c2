//! Pairs between critical cells of any two neighbouring dimensions: reduction of the Morse boundary, on the fly.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::mesh::{Cell, Triangulation};

use super::super::gradient::Pairing;
use super::column::{Column, Entry, Kind};
use super::critical::CriticalCells;
use super::landscape::Landscape;

/// The reduced column whose highest critical cell is the row it is kept at, without that cell.
struct Kept {
    column: u32,
    rest: Box<[Entry]>,
}

/// The Morse boundary between critical cells of two neighbouring dimensions.
pub(super) struct Boundary<'a, T> {
    pub(super) landscape: &'a Landscape<'a, T>,
    /// The lower cells.
    pub(super) rows: &'a CriticalCells,
    /// By place: rows that are known to end classes, not to begin them. They never are the highest of a reduced column,
    /// so they are left out.
    pub(super) is_closed: Vec<bool>,
    /// The upper cells.
    pub(super) columns: &'a CriticalCells,
}

impl<T: Triangulation> Boundary<'_, T> {
    /// Pairs rows with columns.
    ///
    /// A column starts as the boundary of its critical cell. Its highest cell is followed down the gradient, until it is
    /// critical; the column kept there is added, until there is none. So V-paths are only followed as far as is needed,
    /// and what many columns would pass through, they pass through once. Threads take columns in turn and keep them at
    /// rows, the earlier column in place of a later one, which is then reduced further: whatever the threads do, columns
    /// are only added to later ones, and so the pairs are always the same.
    ///
    /// # Arguments
    /// * `places`: columns to be reduced, in any order. By number of their cells, what they read is near in memory and in
    ///   the caches: on noise that is twice as fast as by rising place, and on no field that we tried slower.
    ///
    /// # Returns
    /// Place of the column for every row; `None` if there is none.
    ///
    /// # Source
    /// Guillou, Vidal, Tierny 2023, section 4.3 (propagation); Morozov, Nigmetov 2020 (columns without order); Bauer,
    /// Kerber, Reininghaus, Wagner 2017 (heaps).
    pub(super) fn pairs(&self, places: &[u32]) -> Vec<Option<u32>> {
        let kept: Vec<Mutex<Option<Kept>>> = (0..self.rows.len()).map(|_| Mutex::new(None)).collect();
        let next = AtomicUsize::new(0);
        (0..rayon::current_num_threads()).into_par_iter().with_max_len(1).for_each(|_| {
            let mut work = Column::default();
            while let Some(&place) = places.get(next.fetch_add(1, Ordering::Relaxed)) {
                self.reduce(place, &mut work, &kept);
            }
        });
        let column = |slot: Mutex<Option<Kept>>| slot.into_inner().ok().flatten().map(|kept| kept.column);
        kept.into_iter().map(column).collect()
    }

    fn reduce(&self, mut column: u32, work: &mut Column, kept: &[Mutex<Option<Kept>>]) {
        self.add_boundary(self.columns.cell(column), None, work);
        while let Some(row) = self.pivot(work) {
            let mut slot = kept[row as usize].lock().expect("no thread panics while it holds a column");
            match slot.as_mut() {
                Some(earlier) if earlier.column < column => work.add_all(&earlier.rest),
                Some(later) => {
                    let rest = std::mem::replace(&mut later.rest, work.take());
                    work.add_all(&later.rest);
                    work.add_all(&rest);
                    column = std::mem::replace(&mut later.column, column);
                }
                None => {
                    *slot = Some(Kept { column, rest: work.take() });
                    return;
                }
            }
        }
    }

    /// Takes out the highest critical cell, with everything above it followed down.
    fn pivot(&self, work: &mut Column) -> Option<u32> {
        let lower = self.rows.dimension();
        while let Some(entry) = work.pop() {
            match entry.kind() {
                Kind::Row(place) => return Some(place),
                Kind::Passing(index) => {
                    let cell = Cell { dimension: lower, index };
                    if let Pairing::Up(upper) = self.landscape.pairing(cell) {
                        self.add_boundary(upper, Some(cell), work);
                    }
                }
            }
        }
        None
    }

    /// Adds the facets of a cell but for one, without those in which no V-path goes on.
    fn add_boundary(&self, cell: Cell, but: Option<Cell>, work: &mut Column) {
        for (facet, level) in self.landscape.facets_with_levels(cell).filter(|&(facet, _)| Some(facet) != but) {
            match self.landscape.pairing(facet) {
                Pairing::Critical => {
                    let place = self.rows.place(facet.index);
                    if !self.is_closed[place as usize] {
                        work.add(Entry::row(level, place));
                    }
                }
                Pairing::Up(_) => work.add(Entry::passing(level, facet.index)),
                Pairing::Down(_) | Pairing::Outside => {}
            }
        }
    }
}
