//! The points of a lattice one after the other, each with its neighbours that are there.

use crate::field::VertexId;
use crate::mesh::FreudenthalLattice;

use super::link::SLOTS;

/// What the rims of a lattice take from a point.
pub(super) struct LatticeScan {
    sizes: [u32; 3],
    lattice: FreudenthalLattice,
    /// By number in the link: differences of numbers to the neighbours, modulo 2^32.
    shifts: [u32; SLOTS],
    /// By rims: the neighbours that are there, as a set.
    present: [u16; 64],
}

impl LatticeScan {
    pub(super) fn new(lattice: &FreudenthalLattice) -> Self {
        let half = (1usize << lattice.dimension()) - 1;
        let steps = lattice.steps();
        let mut shifts = [0; SLOTS];
        let mut present = [0; 64];
        for (step, &distance) in steps.iter().enumerate().take(half + 1).skip(1) {
            // Neighbours by rising number: the furthest back first.
            let (before, after) = (half - step, half + step - 1);
            shifts[before] = distance.wrapping_neg();
            shifts[after] = distance;
            for (rims, present) in present.iter_mut().enumerate() {
                *present |= u16::from(rims & step == 0) << before;
                *present |= u16::from(rims >> 3 & step == 0) << after;
            }
        }
        Self { sizes: lattice.sizes(), lattice: *lattice, shifts, present }
    }

    /// The neighbour with a number in the link.
    pub(super) fn neighbour(&self, point: u32, slot: usize) -> u32 {
        point.wrapping_add(self.shifts[slot])
    }

    /// Visits points by rising number, each with its [rims](FreudenthalLattice::rims).
    pub(super) fn visit(&self, points: std::ops::Range<usize>, mut visit: impl FnMut(u32, usize)) {
        let mut place = self.lattice.coordinates(VertexId::from(points.start));
        for point in points {
            let mut rims = 0;
            // Axes beyond the dimension have both rims everywhere, and no step along them.
            for (axis, (&place, &size)) in place.iter().zip(&self.sizes).enumerate() {
                rims |= usize::from(place == 0) << axis | usize::from(place + 1 == size) << (3 + axis);
            }
            visit(point as u32, rims);
            place[0] += 1;
            for axis in 0..2 {
                if place[axis] == self.sizes[axis] {
                    place[axis] = 0;
                    place[axis + 1] += 1;
                }
            }
        }
    }

    /// Lets `look` see every neighbour of a point that has up to `MOST`, by rising number in the link.
    #[inline(always)]
    pub(super) fn look<const MOST: usize>(&self, point: u32, rims: usize, mut look: impl FnMut(usize, u32)) {
        let present = self.present[rims];
        if present == (1 << MOST) - 1 {
            (0..MOST).for_each(|slot| look(slot, self.neighbour(point, slot)));
        } else {
            (0..MOST).filter(|slot| present >> slot & 1 == 1).for_each(|slot| look(slot, self.neighbour(point, slot)));
        }
    }
}
