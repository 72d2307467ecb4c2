//! The gradient of a whole grid: one byte a cell, lower stars of chunks of points in parallel.

use std::ops::Range;
use std::sync::atomic::{AtomicU8, Ordering};

use rayon::prelude::*;

use crate::field::VertexOrder;
use crate::mesh::FreudenthalLattice;

use super::lattice_scan::LatticeScan;
use super::lattice_star::{LatticeStar, Sink};
use super::mask_star::{LOWER, MaskStar};
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
        1 => pair_chunk::<2, _>,
        2 => pair_chunk::<6, _>,
        _ => pair_chunk::<14, _>,
    };
    let (scan, gaps) = (LatticeScan::new(lattice), gaps(lattice));
    (0..points.div_ceil(CHUNK)).into_par_iter().for_each_init(
        || (LatticeStar::new(lattice, &sink), MaskStar::default()),
        |star, chunk| {
            let points = chunk * CHUNK..points.min((chunk + 1) * CHUNK);
            run(&scan, points.clone(), order.ranks(), star);
            mark_gaps(&scan, points, &gaps, &sink);
        },
    );
    places.map(|cells| cells.into_iter().map(AtomicU8::into_inner).collect())
}

/// By rims at the end of axes: types of cells by dimension, number of the type, types in all, that leave the lattice.
type Gaps = [Vec<(usize, u32, u32)>; 8];

fn gaps(lattice: &FreudenthalLattice) -> Gaps {
    [0u8, 1, 2, 3, 4, 5, 6, 7].map(|ends| {
        let of_dimension = |dimension: usize| {
            let kinds = lattice.kinds(dimension);
            let leaves = move |&kind: &usize| lattice.chain(dimension, kind)[dimension - 1] & ends != 0;
            (0..kinds).filter(leaves).map(move |kind| (dimension, kind as u32, kinds as u32))
        };
        (1..4).flat_map(of_dimension).collect()
    })
}

fn mark_gaps(scan: &LatticeScan, points: Range<usize>, gaps: &Gaps, sink: &impl Sink) {
    scan.visit(points, |point, rims| {
        for &(dimension, kind, kinds) in &gaps[rims >> 3] {
            sink(dimension, point * kinds + kind, NO_CELL);
        }
    });
}

/// Pairs the lower stars of points with up to `SLOTS` neighbours.
fn pair_chunk<const SLOTS: usize, S: Sink>(
    scan: &LatticeScan,
    points: Range<usize>,
    ranks: &[u32],
    (star, pairing): &mut (LatticeStar<'_, S>, MaskStar),
) {
    scan.visit(points, |point, rims| {
        let own = signed(ranks[point as usize]);
        let mut around = [i32::MAX; LOWER];
        let mut lower = 0u16;
        scan.look::<SLOTS>(point, rims, |slot, neighbour| {
            let rank = signed(ranks[neighbour as usize]);
            around[slot] = if rank < own { rank } else { i32::MAX };
            lower |= u16::from(rank < own) << slot;
        });
        if lower != 0 {
            star.turn_to(point, lower, &around);
            pairing.pair(lower.count_ones() as usize, star);
        }
    });
}

/// Ranks compare as signed numbers do, for which older processors have the faster instruction.
fn signed(rank: u32) -> i32 {
    (rank ^ 1 << 31) as i32
}
