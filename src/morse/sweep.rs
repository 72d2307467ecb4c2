//! The basins of all extrema of one kind, and where they meet.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::field::VertexId;
use crate::mesh::{FreudenthalLattice, Triangulation};

use super::lattice_scan::LatticeScan;
use super::link::link;

/// Vertices handled by one parallel task. Any number gives the same result.
const CHUNK: usize = 1 << 14;

/// When a vertex comes as a field is swept: by rising rank for minima, by falling rank for maxima.
#[derive(Clone, Copy)]
pub(super) struct Age<'a> {
    pub ranks: &'a [u32],
    /// Turns ranks around by exclusive or: no bit for minima, all for maxima.
    pub turn: u32,
}

impl Age<'_> {
    fn of(self, vertex: u32) -> u32 {
        self.ranks[vertex as usize] ^ self.turn
    }
}

/// The extrema, and where components of the swept set join.
pub(super) struct Basins {
    /// By age.
    pub extrema: Vec<VertexId>,
    /// Age of a vertex and the numbers of two extrema whose basins meet below it, by rising age. Components of swept sets
    /// join only there: what comes before any other vertex among its neighbours is in one component already.
    pub passes: Vec<(u32, u32, u32)>,
    /// By extremum: the vertex of lowest index that is known to be in its component of the domain.
    pub components: Vec<VertexId>,
}

/// Marks a label that is the number of an extremum, no vertex.
const NUMBER: u32 = 1 << 31;
/// Label of a vertex without neighbours.
const ALONE: u32 = u32::MAX;

pub(super) fn basins<T: Triangulation>(complex: &T, age: Age) -> Basins {
    let count = complex.vertex_count();
    let label: Vec<AtomicU32> = (0..count).into_par_iter().with_min_len(CHUNK).map(|_| AtomicU32::new(ALONE)).collect();
    // Relaxed throughout: what a task reads of another one's vertices is right before and after they are changed.
    let set = |vertex: u32, to: u32| label[vertex as usize].store(to, Ordering::Relaxed);
    let get = |vertex: u32| label[vertex as usize].load(Ordering::Relaxed);
    let found: Vec<(Vec<VertexId>, Vec<Pass>)> = in_chunks(count, |points| match complex.lattice() {
        Some(lattice) => match lattice.dimension() {
            1 => survey_lattice::<2>(&lattice, age, points, &set),
            2 => survey_lattice::<6>(&lattice, age, points, &set),
            _ => survey_lattice::<14>(&lattice, age, points, &set),
        },
        None => (survey(complex, age, points, &set), Vec::new()),
    });
    let mut extrema: Vec<VertexId> = found.iter().flat_map(|(extrema, _)| extrema.iter().copied()).collect();
    extrema.par_sort_unstable_by_key(|extremum| age.of(extremum.0));
    // Every vertex is led to the end of its path; all vertices passed are told at once.
    in_chunks(count, |points| {
        for start in points.map(|point| point as u32).filter(|&start| get(start) != ALONE) {
            let mut end = start;
            while get(end) != end {
                end = get(end);
            }
            let mut vertex = start;
            while vertex != end {
                let next = get(vertex);
                set(vertex, end);
                vertex = next;
            }
        }
    });
    extrema.par_iter().with_min_len(CHUNK).enumerate().for_each(|(place, extremum)| set(extremum.0, place as u32 | NUMBER));
    // An extremum is its number already and stays it.
    in_chunks(count, |points| {
        for vertex in points.map(|point| point as u32) {
            let end = get(vertex);
            if end & NUMBER == 0 {
                set(vertex, get(end));
            }
        }
    });
    let basin = |vertex: u32| get(vertex) & !NUMBER;
    let components = match complex.lattice() {
        Some(_) => vec![VertexId(0); extrema.len()],
        None => lowest_vertices(count, extrema.len(), &get),
    };
    let of_lattice = found.into_par_iter().flat_map_iter(|(_, passes)| passes);
    let mut passes: Vec<Pass> = of_lattice
        .map(|(age, one, other)| (age, basin(one), basin(other)))
        .filter(|&(_, one, other)| one != other)
        .collect();
    if complex.lattice().is_none() {
        passes = in_chunks(count, |points| passes_of(complex, age, points, &basin)).concat();
    }
    // Passes that are listed twice are the same in every respect, so an unstable sort has one possible result.
    passes.par_sort_unstable();
    Basins { extrema, passes, components }
}

type Pass = (u32, u32, u32);

fn in_chunks<R: Send>(count: usize, work: impl Fn(std::ops::Range<usize>) -> R + Sync) -> Vec<R> {
    let chunks = (0..count.div_ceil(CHUNK)).into_par_iter();
    chunks.map(|chunk| work(chunk * CHUNK..count.min((chunk + 1) * CHUNK))).collect()
}

/// Lists extrema and labels every vertex with its first neighbour by age.
fn survey<T: Triangulation>(
    complex: &T,
    age: Age,
    points: std::ops::Range<usize>,
    set: &impl Fn(u32, u32),
) -> Vec<VertexId> {
    let mut extrema = Vec::new();
    for point in points.map(|point| point as u32) {
        let mut first = (age.of(point), point);
        let mut alone = true;
        for neighbour in complex.neighbours(VertexId(point)) {
            first = first.min((age.of(neighbour.0), neighbour.0));
            alone = false;
        }
        if alone {
            continue;
        }
        set(point, first.1);
        if first.1 == point {
            extrema.push(VertexId(point));
        }
    }
    extrema
}

/// The same on a lattice, with passes between vertices: from one component of the lower link of a vertex to each other.
fn survey_lattice<const SLOTS: usize>(
    lattice: &FreudenthalLattice,
    age: Age,
    points: std::ops::Range<usize>,
    set: &impl Fn(u32, u32),
) -> (Vec<VertexId>, Vec<Pass>) {
    let (scan, link) = (LatticeScan::new(lattice), link(lattice.dimension()));
    let (mut extrema, mut passes) = (Vec::new(), Vec::new());
    scan.visit(points, |point, rims| {
        let own = age.of(point);
        let (mut first, mut first_slot, mut lower) = (own, SLOTS, 0usize);
        scan.look::<SLOTS>(point, rims, |slot, neighbour| {
            let other = age.of(neighbour);
            lower |= usize::from(other < own) << slot;
            (first, first_slot) = if other < first { (other, slot) } else { (first, first_slot) };
        });
        if lower == 0 {
            set(point, point);
            extrema.push(VertexId(point));
            return;
        }
        set(point, scan.neighbour(point, first_slot));
        let firsts = link.firsts[lower];
        let mut rest = firsts & (firsts - 1);
        while rest != 0 {
            let [one, other] = [firsts, rest].map(|set| scan.neighbour(point, set.trailing_zeros() as usize));
            passes.push((own, one, other));
            rest &= rest - 1;
        }
    });
    (extrema, passes)
}

/// Most lower neighbours of which a set is a mask.
const MASK: usize = 64;

/// Passes at vertices whose lower neighbours are in several basins and in several components of the lower link.
fn passes_of<T: Triangulation>(
    complex: &T,
    age: Age,
    points: std::ops::Range<usize>,
    basin: &impl Fn(u32) -> u32,
) -> Vec<Pass> {
    let mut passes = Vec::new();
    let mut lower: Vec<(u32, u32)> = Vec::new();
    for point in points.map(|point| point as u32) {
        let own = age.of(point);
        lower.clear();
        let below = complex.neighbours(VertexId(point)).filter(|neighbour| age.of(neighbour.0) < own);
        lower.extend(below.map(|neighbour| (neighbour.0, basin(neighbour.0))));
        let Some((&(_, one), others)) = lower.split_first() else {
            continue;
        };
        if others.iter().all(|&(_, other)| other == one) {
            continue;
        }
        // Basins that meet within a component of the lower link have met before. Where that takes longer to find out than to
        // sort them, among tetrahedra and with many neighbours, all are listed.
        let is_small = complex.dimension() < 3 && lower.len() <= MASK;
        let is_known = if is_small { inner_components(complex, VertexId(point), &lower) } else { 0 };
        for (place, &(_, other)) in lower.iter().enumerate().skip(1) {
            let known = place < MASK && is_known >> place & 1 == 1;
            if !known && other != one && passes.last() != Some(&(own, one, other)) {
                passes.push((own, one, other));
            }
        }
    }
    passes
}

/// The lower neighbours that are not the first of their component of the lower link, as a mask.
fn inner_components<T: Triangulation>(complex: &T, vertex: VertexId, lower: &[(u32, u32)]) -> u64 {
    let mut adjacent = [0u64; MASK];
    let place = |vertex: VertexId| lower.iter().position(|&(other, _)| other == vertex.0);
    for [a, b] in complex.link_edges(vertex) {
        if let Some((a, b)) = place(a).zip(place(b)) {
            adjacent[a] |= 1 << b;
            adjacent[b] |= 1 << a;
        }
    }
    let (mut inner, mut seen) = (0u64, 0u64);
    for start in 0..lower.len() {
        if seen >> start & 1 == 1 {
            continue;
        }
        let mut border = 1u64 << start;
        seen |= border;
        while border != 0 {
            let fresh = adjacent[border.trailing_zeros() as usize] & !seen;
            border &= border - 1;
            border |= fresh;
            seen |= fresh;
            inner |= fresh;
        }
    }
    inner
}

/// The lowest vertex of every basin.
fn lowest_vertices(count: usize, basins: usize, label: &impl Fn(u32) -> u32) -> Vec<VertexId> {
    let mut lowest = vec![VertexId(u32::MAX); basins];
    for vertex in (0..count as u32).rev().filter(|&vertex| label(vertex) != ALONE) {
        lowest[(label(vertex) & !NUMBER) as usize] = VertexId(vertex);
    }
    lowest
}
