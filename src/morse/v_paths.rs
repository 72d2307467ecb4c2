//! V-paths from one critical cell down to the critical cells one dimension below.

use std::collections::HashMap;

use crate::field::VertexId;
use crate::mesh::{Cell, Triangulation};

use super::gradient::{DiscreteGradient, Pairing};

/// Up to this number, V-paths between the same two critical cells become separatrices of their own. On a manifold no more
/// than two lead to a critical vertex from an edge, or to a critical facet from a top cell; only the connections
/// between saddles of a 3-dimensional field can be more, and then as many as grow exponentially with the size.
pub(super) const LISTED: u64 = 2;

/// V-paths between two critical cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Separatrix {
    /// Number of V-paths that this separatrix stands for (saturating). 1, unless more than two join the two cells.
    pub multiplicity: u64,
    /// The cells of the V-path, both ends included, dimension k and k-1 in turn. If the separatrix stands for several,
    /// every cell on any of them, each once, a cell before those that follow it.
    pub cells: Vec<Cell>,
}

/// All V-paths that start in one critical cell: an acyclic graph of cells of its dimension.
struct Descent {
    /// Cells of dimension k, a cell before those that follow it.
    cells: Vec<Cell>,
    /// For each of them the places of the cells before it, with the facet between.
    before: Vec<Vec<(usize, Cell)>>,
    /// Number of V-paths from the start.
    paths: Vec<u64>,
    /// Critical facets, and the places of the cells from which a V-path ends in them.
    ends: Vec<(Cell, Vec<usize>)>,
}

/// The separatrices from a critical cell down to critical cells of the next lower dimension.
///
/// # Returns
/// Pairs of critical facet and separatrix, by rising facet.
pub(super) fn separatrices_below<T: Triangulation>(
    complex: &T,
    gradient: &DiscreteGradient,
    start: Cell,
) -> Vec<(Cell, Separatrix)> {
    let descent = Descent::new(complex, gradient, start);
    let mut separatrices = Vec::new();
    for (end, last) in &descent.ends {
        let multiplicity = last.iter().fold(0u64, |sum, &place| sum.saturating_add(descent.paths[place]));
        if multiplicity <= LISTED {
            for cells in descent.paths_to(*end, last) {
                separatrices.push((*end, Separatrix { multiplicity: 1, cells }));
            }
        } else {
            separatrices.push((*end, Separatrix { multiplicity, cells: descent.union_to(*end, last) }));
        }
    }
    separatrices
}

impl Descent {
    fn new<T: Triangulation>(complex: &T, gradient: &DiscreteGradient, start: Cell) -> Self {
        let (visits, finished) = explore(complex, gradient, start);
        let mut place_of = vec![0; visits.len()];
        for (place, &visit) in finished.iter().rev().enumerate() {
            place_of[visit] = place;
        }
        let mut before = vec![Vec::new(); visits.len()];
        let mut ends: Vec<(Cell, usize)> = Vec::new();
        let mut paths = vec![0u64; visits.len()];
        paths[0] = 1;
        for (place, &visit) in finished.iter().rev().enumerate() {
            for step in visits[visit].steps.into_iter().flatten() {
                match step {
                    Step::End(facet) => ends.push((facet, place)),
                    Step::On(facet, next) => {
                        before[place_of[next]].push((place, facet));
                        paths[place_of[next]] = paths[place_of[next]].saturating_add(paths[place]);
                    }
                }
            }
        }
        ends.sort_unstable();
        let mut grouped: Vec<(Cell, Vec<usize>)> = Vec::new();
        for (end, place) in ends {
            match grouped.last_mut() {
                Some((last, places)) if *last == end => places.push(place),
                _ => grouped.push((end, vec![place])),
            }
        }
        let cells = finished.iter().rev().map(|&visit| visits[visit].cell).collect();
        Self { cells, before, paths, ends: grouped }
    }

    /// Every V-path to a critical facet.
    fn paths_to(&self, end: Cell, last: &[usize]) -> Vec<Vec<Cell>> {
        let mut complete = Vec::new();
        // Reversed beginnings of V-paths, each with the place at which it goes on.
        let mut partial: Vec<(usize, Vec<Cell>)> = last.iter().rev().map(|&place| (place, vec![end])).collect();
        while let Some((mut place, mut path)) = partial.pop() {
            loop {
                path.push(self.cells[place]);
                let Some((&(next, facet), others)) = self.before[place].split_first() else {
                    break;
                };
                for &(other, facet) in others.iter().rev() {
                    let mut branch = path.clone();
                    branch.push(facet);
                    partial.push((other, branch));
                }
                path.push(facet);
                place = next;
            }
            path.reverse();
            complete.push(path);
        }
        complete
    }

    /// All cells on V-paths to a critical facet.
    fn union_to(&self, end: Cell, last: &[usize]) -> Vec<Cell> {
        let mut on_path = vec![false; self.cells.len()];
        for &place in last {
            on_path[place] = true;
        }
        let mut cells = vec![end];
        // Places rise along every V-path, so all that follow a cell are known before it.
        for place in (0..self.cells.len()).rev() {
            if !on_path[place] {
                continue;
            }
            cells.push(self.cells[place]);
            for &(before, facet) in &self.before[place] {
                on_path[before] = true;
                // All arrows into one cell leave the same facet: the one it is paired with.
                if cells.last() != Some(&facet) {
                    cells.push(facet);
                }
            }
        }
        cells.reverse();
        cells
    }
}

/// A facet through which V-paths leave a cell.
#[derive(Debug, Clone, Copy)]
enum Step {
    /// A critical facet, where a V-path ends.
    End(Cell),
    /// A facet paired with another cell, which has this number.
    On(Cell, usize),
}

/// A cell on a V-path. Cells are numbered in the order of discovery.
struct Visit {
    cell: Cell,
    steps: [Option<Step>; 4],
}

/// The cells of dimension k on V-paths from `start`, and their numbers in the order in which a search in depth leaves
/// them: all that follow a cell are left before it, since no V-path is closed.
fn explore<T: Triangulation>(complex: &T, gradient: &DiscreteGradient, start: Cell) -> (Vec<Visit>, Vec<usize>) {
    let mut number_of: HashMap<Cell, usize> = [(start, 0)].into();
    let mut visits = vec![Visit { cell: start, steps: [None; 4] }];
    let mut finished = Vec::new();
    let mut stack = vec![(0, complex.facets(start).enumerate())];
    while let Some((number, left)) = stack.last_mut() {
        let number = *number;
        let Some((slot, facet)) = left.next() else {
            finished.push(number);
            stack.pop();
            continue;
        };
        visits[number].steps[slot] = match gradient.pairing(facet) {
            Pairing::Critical => Some(Step::End(facet)),
            Pairing::Up(next) if next != visits[number].cell => {
                let following = *number_of.entry(next).or_insert_with(|| {
                    visits.push(Visit { cell: next, steps: [None; 4] });
                    stack.push((visits.len() - 1, complex.facets(next).enumerate()));
                    visits.len() - 1
                });
                Some(Step::On(facet, following))
            }
            Pairing::Up(_) | Pairing::Down(_) | Pairing::Outside => None,
        };
    }
    (visits, finished)
}

/// The V-path down from a vertex: that vertex, then edges and vertices in turn, the minimum last.
pub(super) fn path_down<T: Triangulation>(complex: &T, gradient: &DiscreteGradient, start: VertexId) -> Vec<Cell> {
    let mut path = vec![Cell::vertex(start)];
    let mut vertex = start;
    while let Pairing::Up(edge) = gradient.pairing(Cell::vertex(vertex)) {
        let ends = complex.cell_vertices(edge);
        vertex = if ends[0] == vertex { ends[1] } else { ends[0] };
        path.extend([edge, Cell::vertex(vertex)]);
    }
    path
}
