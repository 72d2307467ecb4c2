//! How a gradient keeps the partner of every cell: a number on an explicit complex, one byte on a lattice.

use crate::mesh::{Cell, FreudenthalLattice};

use super::gradient::Pairing;

/// Of an explicit complex: paired with nothing.
pub(super) const CRITICAL: u32 = u32::MAX;
/// Of an explicit complex: a vertex of no simplex.
pub(super) const OUTSIDE: u32 = u32::MAX - 1;
/// Of an explicit complex: the bit of a partner that is a facet.
pub(super) const DOWN: u32 = 1 << 31;

/// Of a lattice: paired with nothing.
pub(super) const CRITICAL_BYTE: u8 = 0;
/// Of a lattice: a number that names no cell.
pub(super) const NO_CELL: u8 = u8::MAX;
const FIRST_DOWN: u8 = 16;

/// On a lattice: paired with the cofacet of this place, counted with those that leave the lattice.
pub(super) const fn up(place: usize) -> u8 {
    1 + place as u8
}

/// On a lattice: paired with the facet of this place.
pub(super) const fn down(place: usize) -> u8 {
    FIRST_DOWN + place as u8
}

/// By dimension and cell: the partner.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Partners {
    /// Its number, with the bit `DOWN` if it is a facet; or `CRITICAL`; or `OUTSIDE`.
    Numbers([Vec<u32>; 4]),
    /// Its place among the facets or cofacets.
    Places(FreudenthalLattice, [Vec<u8>; 4]),
}

impl Partners {
    pub(super) fn pairing(&self, cell: Cell) -> Pairing {
        let (dimension, index) = (cell.dimension as usize, cell.index as usize);
        match self {
            Self::Numbers(partners) => match partners[dimension][index] {
                CRITICAL => Pairing::Critical,
                OUTSIDE => Pairing::Outside,
                partner if partner & DOWN != 0 => {
                    Pairing::Down(Cell { dimension: cell.dimension - 1, index: partner & !DOWN })
                }
                partner => Pairing::Up(Cell { dimension: cell.dimension + 1, index: partner }),
            },
            Self::Places(lattice, places) => match places[dimension][index] {
                CRITICAL_BYTE => Pairing::Critical,
                NO_CELL => Pairing::Outside,
                place if place >= FIRST_DOWN => Pairing::Down(lattice.facet(cell, (place - FIRST_DOWN) as usize)),
                place => Pairing::Up(lattice.cofacet(cell, place as usize - 1)),
            },
        }
    }

    pub(super) fn is_critical(&self, cell: Cell) -> bool {
        let (dimension, index) = (cell.dimension as usize, cell.index as usize);
        match self {
            Self::Numbers(partners) => partners[dimension][index] == CRITICAL,
            Self::Places(_, places) => places[dimension][index] == CRITICAL_BYTE,
        }
    }

    /// Critical cells of a dimension, by rising number.
    pub(super) fn critical(&self, dimension: usize) -> impl Iterator<Item = Cell> {
        let (numbers, places): (&[u32], &[u8]) = match self {
            Self::Numbers(partners) => (partners.get(dimension).map_or(&[], Vec::as_slice), &[]),
            Self::Places(_, places) => (&[], places.get(dimension).map_or(&[], Vec::as_slice)),
        };
        let of_numbers = numbers.iter().enumerate().filter(|&(_, &partner)| partner == CRITICAL).map(|(index, _)| index);
        let of_places = places.iter().enumerate().filter(|&(_, &place)| place == CRITICAL_BYTE).map(|(index, _)| index);
        of_numbers.chain(of_places).map(move |index| Cell { dimension: dimension as u8, index: index as u32 })
    }

    /// Number of cells of a dimension, but for vertices of no simplex.
    pub(super) fn cell_count(&self, dimension: usize) -> usize {
        match self {
            Self::Numbers(partners) => partners[dimension].iter().filter(|&&partner| partner != OUTSIDE).count(),
            Self::Places(_, places) => places[dimension].iter().filter(|&&place| place != NO_CELL).count(),
        }
    }

    /// Pairs a cell with one of its cofacets, whatever either was paired with.
    pub(super) fn pair(&mut self, lower: Cell, upper: Cell) {
        match self {
            Self::Numbers(partners) => {
                partners[lower.dimension as usize][lower.index as usize] = upper.index;
                partners[upper.dimension as usize][upper.index as usize] = lower.index | DOWN;
            }
            Self::Places(lattice, places) => {
                let way_up = lattice.cofacet_places(lower).find(|&place| lattice.cofacet(lower, place) == upper);
                let way_down = (0..=upper.dimension as usize).find(|&place| lattice.facet(upper, place) == lower);
                if let (Some(way_up), Some(way_down)) = (way_up, way_down) {
                    places[lower.dimension as usize][lower.index as usize] = up(way_up);
                    places[upper.dimension as usize][upper.index as usize] = down(way_down);
                }
            }
        }
    }

    pub(super) fn release(&mut self, cell: Cell) {
        let (dimension, index) = (cell.dimension as usize, cell.index as usize);
        match self {
            Self::Numbers(partners) => partners[dimension][index] = CRITICAL,
            Self::Places(_, places) => places[dimension][index] = CRITICAL_BYTE,
        }
    }
}
