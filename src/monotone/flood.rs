//! The flood: a vertex order turned, as little as it needs, into one with exactly the wanted extrema.
//!
//! From the wanted minima the order is flooded upwards, lowest available vertex first: a vertex enters after one of its
//! neighbours, so it is no minimum. Flooding the reversed order from the wanted maxima does the same for maxima. Each of
//! the two can disturb the other's set, so they alternate until both sets are right.
//!
//! Literature: Tierny, Pascucci 2012, *Generalized topological simplification of scalar fields on surfaces*; Lukasczyk,
//! Garth, Maciejewski, Tierny 2020, *Localized topological simplification of scalar data*. Ours are the two rules that
//! let a wanted extremum be none of the given field: a wanted minimum enters before all its neighbours, a wanted
//! maximum after all of them.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::SimplicialComplex;
use crate::morse::WantedExtrema;

/// Passes after which the flood gives up; 2 to 9 are usual.
const MOST_PASSES: usize = 120;

/// The outcome of a flood.
#[derive(Debug, Clone)]
pub struct Flooded {
    /// The order reached.
    pub order: VertexOrder,
    /// Whether its extrema are exactly the wanted ones.
    pub valid: bool,
    /// Passes over the mesh, upwards and downwards together.
    pub passes: usize,
}

/// Simplifies a vertex order to exactly the wanted extrema.
///
/// # Arguments
/// * `order`: any strict order of the `n` vertices.
/// * `wanted`: minima and maxima; every component of the mesh needs one of each.
///
/// # Returns
/// The last order reached; `valid` is false if the alternation did not settle, or if the wanted extrema admit no order
/// at all (see [`unreachable_regions`](super::unreachable_regions)).
///
/// # Cost
/// O(m + n log n) a pass for n vertices and m edges.
pub fn flood(complex: &SimplicialComplex, order: &VertexOrder, wanted: &WantedExtrema) -> Flooded {
    alternate(complex, order, wanted, |_, _| {})
}

/// Floods a field with its order: what is flooded from below is filled to the level of its pass, what is flooded from above
/// is cut down to its.
///
/// # Arguments
/// * `values`, `order`: the `n` values of a field and their order.
/// * `wanted`: as for [`flood`].
///
/// # Returns
/// The flooded order, and values that do not fall along it: equal where the flood stands level, unchanged where it did not
/// come. Every value is one of those given, so the width in which they are stored holds them.
///
/// # Cost
/// As [`flood`].
///
/// # Source
/// Tierny, Pascucci 2012, section 3: the running level of the flood is the new value.
pub fn flood_field(
    complex: &SimplicialComplex,
    values: &[f64],
    order: &VertexOrder,
    wanted: &WantedExtrema,
) -> (Flooded, Vec<f64>) {
    let mut field = values.to_vec();
    let flooded = alternate(complex, order, wanted, |sequence, upwards| match upwards {
        true => level_off(complex, sequence.iter(), &mut field, f64::max),
        false => level_off(complex, sequence.iter().rev(), &mut field, f64::min),
    });
    (flooded, field)
}

/// Gives every vertex the most extreme value so far, along the sequence in which a flood reached them.
///
/// The flood takes the lowest vertex at hand. One below the level reached was not at hand before, so it lies in a pit
/// behind the vertex that made the level: the level is its own.
fn level_off<'a>(
    complex: &SimplicialComplex,
    sequence: impl Iterator<Item = &'a VertexId>,
    field: &mut [f64],
    extreme: fn(f64, f64) -> f64,
) {
    let mut level: Option<f64> = None;
    for &vertex in sequence.filter(|&&vertex| !complex.neighbours(vertex).is_empty()) {
        let value = &mut field[vertex.index()];
        *value = level.map_or(*value, |level| extreme(level, *value));
        level = Some(*value);
    }
}

/// Floods in turns, upwards first, until both sets of extrema are right; `passed` sees the order after every pass.
fn alternate(
    complex: &SimplicialComplex,
    order: &VertexOrder,
    wanted: &WantedExtrema,
    mut passed: impl FnMut(&[VertexId], bool),
) -> Flooded {
    let mut current = order.clone();
    // Which of the two comes first made no difference worth having on measured fields.
    let mut upwards = true;
    for passes in 0..MOST_PASSES {
        if has_exactly(complex, &current, wanted) {
            return Flooded { order: current, valid: true, passes };
        }
        let next = match upwards {
            true => flood_upwards(complex, &current, &wanted.minima, &wanted.maxima),
            false => flood_upwards(complex, &current.reversed(), &wanted.maxima, &wanted.minima).map(|order| order.reversed()),
        };
        match next {
            Some(next) => {
                passed(next.sequence(), upwards);
                current = next;
            }
            None => return Flooded { order: current, valid: false, passes },
        }
        upwards = !upwards;
    }
    let valid = has_exactly(complex, &current, wanted);
    Flooded { order: current, valid, passes: MOST_PASSES }
}

/// Whether the minima and maxima of an order are exactly the wanted ones, isolated vertices aside.
pub fn has_exactly(complex: &SimplicialComplex, order: &VertexOrder, wanted: &WantedExtrema) -> bool {
    let mut asked = vec![[false; 2]; complex.vertex_count()];
    for &minimum in &wanted.minima {
        asked[minimum.index()][0] = true;
    }
    for &maximum in &wanted.maxima {
        asked[maximum.index()][1] = true;
    }
    (0..complex.vertex_count()).map(VertexId::from).all(|vertex| {
        let neighbours = complex.neighbours(vertex);
        if neighbours.is_empty() {
            return asked[vertex.index()] == [false; 2];
        }
        let lower = neighbours.iter().filter(|&&neighbour| order.is_below(neighbour, vertex)).count();
        asked[vertex.index()] == [lower == 0, lower == neighbours.len()]
    })
}

/// One pass: the order in which a flood from `minima` reaches the vertices; `None` if it does not reach them all.
fn flood_upwards(
    complex: &SimplicialComplex,
    order: &VertexOrder,
    minima: &[VertexId],
    maxima: &[VertexId],
) -> Option<VertexOrder> {
    const SEED: u32 = u32::MAX;
    let n = complex.vertex_count();
    // Neighbours that a vertex still waits for: its wanted minima, or, if it is a wanted maximum, all of them.
    let mut waiting = vec![0u32; n];
    let mut is_cap = vec![false; n];
    for &minimum in minima {
        for &neighbour in complex.neighbours(minimum) {
            waiting[neighbour.index()] += 1;
        }
    }
    for &maximum in maxima {
        is_cap[maximum.index()] = true;
        waiting[maximum.index()] = complex.neighbours(maximum).len() as u32;
    }
    let mut heap = BinaryHeap::with_capacity(n / 4 + 16);
    let mut is_seed = vec![false; n];
    for &minimum in minima {
        is_seed[minimum.index()] = true;
        waiting[minimum.index()] = SEED;
        heap.push(Reverse(order.rank(minimum)));
    }
    let mut queued = is_seed.clone();
    let mut reached = Vec::with_capacity(n);
    // Isolated vertices have no order to respect: they go first.
    reached.extend((0..n).map(VertexId::from).filter(|&vertex| complex.neighbours(vertex).is_empty()));
    let isolated = reached.len();
    while let Some(Reverse(rank)) = heap.pop() {
        let vertex = order.sequence()[rank as usize];
        if complex.neighbours(vertex).is_empty() {
            continue;
        }
        reached.push(vertex);
        for &neighbour in complex.neighbours(vertex) {
            let slot = neighbour.index();
            if queued[slot] {
                continue;
            }
            if is_cap[slot] || is_seed[vertex.index()] {
                waiting[slot] -= 1;
            }
            if waiting[slot] == 0 {
                queued[slot] = true;
                heap.push(Reverse(order.rank(neighbour)));
            }
        }
    }
    debug_assert!(reached.len() <= n && isolated <= n, "no vertex enters twice");
    if reached.len() != n {
        return None;
    }
    VertexOrder::of_sequence(reached).ok()
}
