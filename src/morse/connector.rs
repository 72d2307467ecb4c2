//! The V-path between a 1-saddle and a 2-saddle, if there is exactly one.

use std::collections::{BTreeMap, BTreeSet};

use crate::mesh::{Cell, Triangulation};

use super::gradient::{DiscreteGradient, Pairing};
use super::star::cofacets;

/// The V-path between a critical triangle and a critical edge, from the edge up, if there is exactly one.
///
/// # Cost
/// Twice the smaller one of the two walls: the cells that V-paths reach from the triangle down, and from the edge up.
pub(super) fn unique_path<T: Triangulation>(
    complex: &T,
    gradient: &DiscreteGradient,
    edge: Cell,
    triangle: Cell,
) -> Option<Vec<Cell>> {
    let mut walls = [Wall::new(edge, triangle), Wall::new(triangle, edge)];
    // Turn by turn, so that the smaller wall ends the search.
    let whole = loop {
        if let Some(place) = walls.iter_mut().position(|wall| !wall.grow(complex, gradient)) {
            break place;
        }
    };
    let mut path = walls[whole].only_path()?;
    if path[0] == triangle {
        path.reverse();
    }
    Some(path)
}

/// The cells of one dimension that V-paths reach from a critical one, upwards or downwards.
struct Wall {
    start: Cell,
    target: Cell,
    /// Cells that wait for their turn.
    open: Vec<Cell>,
    seen: BTreeSet<Cell>,
    /// Where V-paths go on: the cell between and the next one; the target has itself as both.
    onward: BTreeMap<Cell, Vec<(Cell, Cell)>>,
    around: Vec<Cell>,
}

impl Wall {
    fn new(start: Cell, target: Cell) -> Self {
        let (seen, onward) = (BTreeSet::from([start]), BTreeMap::new());
        Self { start, target, open: vec![start], seen, onward, around: Vec::new() }
    }

    /// Takes one more cell in; `false` if there is none.
    fn grow<T: Triangulation>(&mut self, complex: &T, gradient: &DiscreteGradient) -> bool {
        let Some(cell) = self.open.pop() else { return false };
        if cell.dimension < self.target.dimension {
            cofacets(complex, cell, &mut self.around);
        } else {
            self.around.clear();
            self.around.extend(complex.facets(cell));
        }
        let mut onward = Vec::new();
        for &between in &self.around {
            if between == self.target {
                onward.push((between, between));
                continue;
            }
            let next = match gradient.pairing(between) {
                Pairing::Up(next) | Pairing::Down(next) => next,
                Pairing::Critical | Pairing::Outside => continue,
            };
            if next.dimension == cell.dimension && next != cell {
                onward.push((between, next));
                if self.seen.insert(next) {
                    self.open.push(next);
                }
            }
        }
        self.onward.insert(cell, onward);
        true
    }

    /// The path from the start to the target, if there is exactly one, in a wall that is whole.
    fn only_path(&self) -> Option<Vec<Cell>> {
        let counts = self.counts();
        if counts.get(&self.start) != Some(&1) {
            return None;
        }
        let mut path = vec![self.start];
        let mut cell = self.start;
        loop {
            let leads = |&&(between, next): &&(Cell, Cell)| between == self.target || counts.get(&next) == Some(&1);
            let &(between, next) = self.onward.get(&cell)?.iter().find(leads)?;
            path.push(between);
            if between == self.target {
                return Some(path);
            }
            path.push(next);
            cell = next;
        }
    }

    /// Number of paths from each cell to the target, 2 for more than one.
    fn counts(&self) -> BTreeMap<Cell, u8> {
        let mut counts: BTreeMap<Cell, u8> = BTreeMap::new();
        let mut stack = vec![(self.start, false)];
        while let Some((cell, is_left)) = stack.pop() {
            let onward = self.onward.get(&cell).map_or(&[][..], Vec::as_slice);
            if is_left {
                let paths = |&(between, next): &(Cell, Cell)| match between == self.target {
                    true => 1,
                    false => counts.get(&next).copied().unwrap_or(0),
                };
                counts.insert(cell, onward.iter().map(paths).fold(0, |sum, more| (sum + more).min(2)));
            } else if !counts.contains_key(&cell) {
                stack.push((cell, true));
                let waiting = onward.iter().filter(|(between, next)| *between != self.target && !counts.contains_key(next));
                stack.extend(waiting.map(|&(_, next)| (next, false)));
            }
        }
        counts
    }
}
