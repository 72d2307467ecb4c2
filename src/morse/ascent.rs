//! V-paths upwards from facets to top cells: unique from every top cell on, as long as no facet has more than two.

use rayon::prelude::*;

use crate::mesh::{Cell, Triangulation};

use super::gradient::{DiscreteGradient, Pairing};
use super::jump::roots;
use super::star::cofacets;

/// Where the V-path up from a top cell ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Summit {
    /// In a critical top cell.
    Critical(Cell),
    /// In this facet of the boundary: the field rises out of the domain.
    Boundary(Cell),
    /// In a facet of three or more top cells, where V-paths part.
    Branching,
}

/// What comes after a top cell on its V-path up.
pub(super) enum Step {
    /// Through this facet into the next top cell.
    On(Cell, Cell),
    /// Nothing.
    End(Summit),
}

/// One step up from a top cell.
pub(super) fn step<T: Triangulation>(
    complex: &T,
    gradient: &DiscreteGradient,
    top: Cell,
    around: &mut Vec<Cell>,
) -> Step {
    let Pairing::Down(facet) = gradient.pairing(top) else {
        return Step::End(Summit::Critical(top));
    };
    cofacets(complex, facet, around);
    match around.as_slice() {
        [_] => Step::End(Summit::Boundary(facet)),
        [one, other] => Step::On(facet, if *one == top { *other } else { *one }),
        _ => Step::End(Summit::Branching),
    }
}

/// The V-path up from a facet through one of its top cells: facets and top cells in turn, that facet first. A path that
/// ends on the boundary ends in its facet.
pub(super) fn path<T: Triangulation>(
    complex: &T,
    gradient: &DiscreteGradient,
    facet: Cell,
    top: Cell,
) -> (Vec<Cell>, Summit) {
    let mut around = Vec::new();
    let mut path = vec![facet, top];
    let mut last = top;
    loop {
        match step(complex, gradient, last, &mut around) {
            Step::On(facet, next) => {
                path.extend([facet, next]);
                last = next;
            }
            Step::End(summit) => {
                if let Summit::Boundary(facet) = summit {
                    path.push(facet);
                }
                return (path, summit);
            }
        }
    }
}

/// The field rises out of the domain.
pub(super) const OUTSIDE: u32 = u32::MAX - 1;
/// V-paths part at a facet of three or more top cells.
pub(super) const BRANCHING: u32 = u32::MAX;

/// For every top cell the number of the critical one at the end of its V-path up, or [`OUTSIDE`], or [`BRANCHING`].
///
/// # Cost
/// O(m log l) for m top cells and V-paths of length l, in parallel.
pub(super) fn summits<T: Triangulation>(complex: &T, gradient: &DiscreteGradient) -> Vec<u32> {
    let dimension = complex.dimension() as u8;
    let next = (0..complex.cell_bound(complex.dimension()) as u32)
        .into_par_iter()
        .map_init(Vec::new, |around, index| {
            let top = Cell { dimension, index };
            if !complex.is_cell(top) {
                return OUTSIDE;
            }
            match step(complex, gradient, top, around) {
                Step::On(_, next) => next.index,
                Step::End(Summit::Critical(cell)) => cell.index,
                Step::End(Summit::Boundary(_)) => OUTSIDE,
                Step::End(Summit::Branching) => BRANCHING,
            }
        })
        .collect();
    roots(next)
}
