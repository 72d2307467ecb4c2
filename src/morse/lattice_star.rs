//! The lower stars of a grid: at most 14 neighbours, and the link known beforehand.

use crate::mesh::FreudenthalLattice;

use super::link::{Codes, Link, link};
use super::mask_star::{LOWER, LowerLink};

/// Where the pairs of lower stars are written: dimension, number of the cell, what it keeps.
pub(super) trait Sink: Fn(usize, u32, u8) {}

impl<F: Fn(usize, u32, u8)> Sink for F {}

/// The lower star of one point after the other.
pub(super) struct LatticeStar<'a, S> {
    sink: &'a S,
    link: &'static Link,
    /// By dimension and cell of the star: its number less that of the first cell at the point, modulo 2^32.
    shifts: [Vec<u32>; 4],
    /// Types of cells by dimension.
    kinds: [u32; 4],
    point: u32,
    /// Lower neighbours as a set of numbers in the link.
    lower: u16,
    /// By rank: number in the link.
    slots: [usize; LOWER],
    /// By number in the link: rank among the lower neighbours.
    places: [u8; LOWER],
    adjacent: [u16; LOWER],
}

impl<'a, S: Sink> LatticeStar<'a, S> {
    pub(super) fn new(lattice: &FreudenthalLattice, sink: &'a S) -> Self {
        let link = link(lattice.dimension());
        let kinds = [0, 1, 2, 3].map(|dimension| lattice.kinds(dimension) as u32);
        let shift = |dimension: usize| {
            let of_cell = |&(back, kind): &(u8, u32)| {
                kind.wrapping_sub(lattice.steps()[back as usize].wrapping_mul(kinds[dimension]))
            };
            link.anchors[dimension].iter().map(of_cell).collect()
        };
        Self {
            sink,
            link,
            shifts: [0, 1, 2, 3].map(shift),
            kinds,
            point: 0,
            lower: 0,
            slots: [0; LOWER],
            places: [0; LOWER],
            adjacent: [0; LOWER],
        }
    }

    /// Turns to a point.
    ///
    /// # Arguments
    /// * `lower`: its lower neighbours, a set of numbers in the link.
    /// * `ranks`: ranks of the neighbours; those of others than the lower ones are `i32::MAX`.
    pub(super) fn turn_to(&mut self, point: u32, lower: u16, ranks: &[i32; LOWER]) {
        (self.point, self.lower) = (point, lower);
        for (place, &rank) in self.places.iter_mut().zip(ranks) {
            // Counting has no branch to mispredict, and vectorises as sums that may wrap do.
            *place = ranks.iter().fold(0i32, |below, &other| below.wrapping_add((other < rank).into())) as u8 % LOWER as u8;
        }
        let mut rest = lower;
        while rest != 0 {
            let slot = first(rest);
            rest &= rest.wrapping_sub(1);
            let place = self.place(slot);
            self.slots[place] = slot;
            self.adjacent[place] = self.places_of(self.link.adjacent[slot]);
        }
    }

    /// The lower ones of some neighbours, given and returned as sets: by number in the link and by rank.
    fn places_of(&self, slots: u16) -> u16 {
        let mut rest = slots & self.lower;
        let mut places = 0;
        while rest != 0 {
            places |= 1 << self.place(first(rest));
            rest &= rest.wrapping_sub(1);
        }
        places
    }

    fn place(&self, slot: usize) -> usize {
        self.places[slot] as usize % LOWER
    }

    fn slot(&self, place: usize) -> usize {
        self.slots[place % LOWER] % LOWER
    }

    /// Writes a pair of a cell of the star of some dimension and number, and its partner above.
    fn write(&self, dimension: usize, number: usize, codes: Codes) {
        (self.sink)(dimension, self.number(dimension, number), codes.up);
        (self.sink)(dimension + 1, self.number(dimension + 1, codes.upper as usize), codes.down);
    }

    fn number(&self, dimension: usize, number: usize) -> u32 {
        self.point.wrapping_mul(self.kinds[dimension]).wrapping_add(self.shifts[dimension][number])
    }
}

fn first(set: u16) -> usize {
    set.trailing_zeros() as usize % LOWER
}

impl<S: Sink> LowerLink for LatticeStar<'_, S> {
    fn adjacent(&self, a: usize) -> u16 {
        self.adjacent[a]
    }

    fn thirds(&self, a: usize, b: usize) -> u16 {
        self.places_of(self.link.thirds[self.slot(a)][self.slot(b)])
    }

    fn pair_vertex(&self) {
        self.write(0, 0, self.link.of_edge[self.slot(0)]);
    }

    fn pair_edge(&self, edge: usize, other: usize) {
        let slot = self.slot(edge);
        self.write(1, slot, self.link.of_triangle[slot][self.slot(other)]);
    }

    fn pair_triangle(&self, [a, b]: [usize; 2], third: usize) {
        let triangle = self.link.of_triangle[self.slot(a)][self.slot(b)].upper as usize;
        self.write(2, triangle, self.link.of_tetrahedron[triangle][self.slot(third)]);
    }
}
