//! The gradient of a whole grid: one byte a cell, lower stars of chunks of points in parallel.

use std::sync::atomic::{AtomicU8, Ordering};

use rayon::prelude::*;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::FreudenthalLattice;

use super::lattice_star::{LatticeStar, Sink};
use super::partners::{CRITICAL_BYTE, NO_CELL};

/// Points handled by one parallel task. Any number gives the same result.
const CHUNK: usize = 4096;

/// By dimension and number of a cell: its partner as [`Partners`](super::partners::Partners) keeps it.
pub(super) fn lattice_places(lattice: &FreudenthalLattice, order: &VertexOrder) -> [Vec<u8>; 4] {
    let points = lattice.vertex_count();
    let places = [0, 1, 2, 3].map(|dimension| {
        let cells = (0..points * lattice.kinds(dimension)).into_par_iter().with_min_len(CHUNK);
        cells.map(|_| AtomicU8::new(CRITICAL_BYTE)).collect::<Vec<_>>()
    });
    // Relaxed is enough: every cell is written by its one lower star, and read only after all threads have joined.
    let sink = |dimension: usize, index: u32, place: u8| {
        places[dimension][index as usize].store(place, Ordering::Relaxed);
    };
    let run = match lattice.dimension() {
        1 => pair_chunk::<2>,
        2 => pair_chunk::<6>,
        _ => pair_chunk::<14>,
    };
    (0..points.div_ceil(CHUNK)).into_par_iter().for_each_init(
        || (LatticeStar::new(lattice), Rims::new(lattice)),
        |(star, rims), chunk| run(Chunk { lattice, order, chunk }, star, rims, &sink),
    );
    places.map(|cells| cells.into_iter().map(AtomicU8::into_inner).collect())
}

struct Chunk<'a> {
    lattice: &'a FreudenthalLattice,
    order: &'a VertexOrder,
    chunk: usize,
}

/// What the rims of the lattice take from a point.
struct Rims {
    /// Differences of numbers to the neighbours, modulo 2^32.
    shifts: [u32; 14],
    /// By rims: the neighbours that are there, as a set.
    present: [u16; 64],
    /// By rims at the end of axes: dimension and type of the cells anchored at the point that are not there.
    gaps: [Vec<(usize, u32)>; 8],
    /// Types of cells by dimension.
    kinds: [u32; 4],
}

impl Rims {
    fn new(lattice: &FreudenthalLattice) -> Self {
        let half = (1usize << lattice.dimension()) - 1;
        let steps = lattice.steps();
        let mut shifts = [0; 14];
        let mut present = [0; 64];
        for step in 1..=half {
            // Neighbours by rising number: the furthest back first.
            let (before, after) = (half - step, half + step - 1);
            shifts[before] = steps[step].wrapping_neg();
            shifts[after] = steps[step];
            for (rims, present) in present.iter_mut().enumerate() {
                *present |= u16::from(rims & step == 0) << before;
                *present |= u16::from(rims >> 3 & step == 0) << after;
            }
        }
        let gaps = [0u8, 1, 2, 3, 4, 5, 6, 7].map(|ends| {
            let types = (1..4).flat_map(|dimension| (0..lattice.kinds(dimension)).map(move |kind| (dimension, kind)));
            let leaves = types.filter(|&(dimension, kind)| lattice.chain(dimension, kind)[dimension - 1] & ends != 0);
            leaves.map(|(dimension, kind)| (dimension, kind as u32)).collect()
        });
        Self { shifts, present, gaps, kinds: [0, 1, 2, 3].map(|dimension| lattice.kinds(dimension) as u32) }
    }
}

/// Pairs the lower stars of a chunk of points with up to `SLOTS` neighbours.
fn pair_chunk<const SLOTS: usize>(chunk: Chunk, star: &mut LatticeStar, rims: &Rims, sink: &impl Sink) {
    let Chunk { lattice, order, chunk } = chunk;
    let ranks = order.ranks();
    let points = (chunk * CHUNK) as u32..ranks.len().min((chunk + 1) * CHUNK) as u32;
    let sizes = lattice.sizes();
    let mut place = lattice.coordinates(VertexId(points.start));
    for point in points {
        let mut at = 0;
        for axis in 0..3 {
            at |= usize::from(place[axis] == 0) << axis | usize::from(place[axis] + 1 == sizes[axis]) << (3 + axis);
        }
        // Axes beyond the dimension have both rims everywhere, and no step along them.
        let present = rims.present[at];
        for &(dimension, kind) in &rims.gaps[at >> 3] {
            sink(dimension, point * rims.kinds[dimension] + kind, NO_CELL);
        }
        let own = signed(ranks[point as usize]);
        let mut around = [i32::MAX; 16];
        let mut lower = 0u16;
        let mut look = |slot: usize| {
            let rank = signed(ranks[point.wrapping_add(rims.shifts[slot]) as usize]);
            around[slot] = if rank < own { rank } else { i32::MAX };
            lower |= u16::from(rank < own) << slot;
        };
        if present.count_ones() as usize == SLOTS {
            (0..SLOTS).for_each(&mut look);
        } else {
            (0..SLOTS).filter(|slot| present >> slot & 1 == 1).for_each(&mut look);
        }
        if lower != 0 {
            star.pair(point, lower, &around, sink);
        }
        place[0] += 1;
        for axis in 0..2 {
            if place[axis] == sizes[axis] {
                place[axis] = 0;
                place[axis + 1] += 1;
            }
        }
    }
}

/// Ranks compare as signed numbers do, for which older processors have the faster instruction.
fn signed(rank: u32) -> i32 {
    (rank ^ 1 << 31) as i32
}
