//! Bridges and cuts: the few vertices that must be raised or lowered, so that cutting hills and filling pits moves few passes.
//!
//! A hill that is cut down to its pass may carry the pass of a wanted minimum: the rim of a crater is such a hill. Cut, it
//! would let the crater run over early. The other way to remove its summit keeps it: a bridge at the level of that pass,
//! along the reversed V-paths that lead from there to a wanted maximum, raised where it dips below. It dips by less than the
//! greatest persistence removed. Pits are drained along cuts likewise.
//!
//! Not every pass can stay. Where two hills on the boundary of the domain guard a pass between them, and the ridge from one of
//! them to a third carries another pass, the ridge needs a summit of its own unless a bridge dams the first pass. Bridges of
//! several passes may cross as well. What is left is counted by the caller.
//!
//! Literature: Forman 1998, theorem 11.1, cancellation by reversal; Bauer, Lange, Wardetzky 2012, *Optimal topological
//! simplification of discrete functions on surfaces*.

use crate::field::{VertexId, VertexOrder};
use crate::mesh::SimplicialComplex;
use crate::morse::{ExtremumGraph, ExtremumKind, ExtremumPair, MorseError, WantedExtrema, extremum_pairs};

use super::flood::{Flooded, flood_field};

/// Rounds of bridges: one may dam what another one let pass.
const MOST_ROUNDS: usize = 4;

/// A flooded field, with the passes at which wanted extrema die where they were wherever that was possible.
#[derive(Debug, Clone)]
pub(super) struct Bridged {
    pub(super) flooded: Flooded,
    /// Does not fall along the flooded order.
    pub(super) field: Vec<f64>,
}

/// Floods a field to the wanted extrema, with bridges and cuts for the passes that flooding alone would move.
///
/// # Arguments
/// * `values`, `order`: the field.
/// * `wanted`: extrema of the field.
///
/// # Errors
/// [`MorseError`] if a wanted vertex is no extremum of the field.
pub(super) fn flood_with_bridges(
    complex: &SimplicialComplex,
    values: &[f64],
    order: &VertexOrder,
    wanted: &WantedExtrema,
) -> Result<Bridged, MorseError> {
    let (flooded, field) = flood_field(complex, values, order, wanted);
    let mut best = Bridged { flooded, field };
    if !best.flooded.valid {
        return Ok(best);
    }
    let deaths = Deaths::new(complex, values, order, wanted);
    let mut moved = deaths.moved(complex, &best);
    if moved.is_empty() {
        return Ok(best);
    }
    let mut works = Works::new(complex, values, order, wanted)?;
    let mut fewest = moved.len();
    let mut level_now = best.field.clone();
    for _ in 0..MOST_ROUNDS {
        for &pass in &moved {
            works.secure(pass, values[pass.index()], level_now[pass.index()]);
        }
        let Ok(order) = VertexOrder::of_values(&works.field) else { break };
        let (flooded, field) = flood_field(complex, &works.field, &order, wanted);
        let next = Bridged { flooded, field };
        let is_kept = |extremum: &VertexId| next.field[extremum.index()] == values[extremum.index()];
        if !next.flooded.valid || !wanted.minima.iter().chain(&wanted.maxima).all(is_kept) {
            break;
        }
        moved = deaths.moved(complex, &next);
        level_now.clone_from(&next.field);
        if moved.len() < fewest {
            (best, fewest) = (next, moved.len());
        }
        if moved.is_empty() {
            break;
        }
    }
    Ok(best)
}

/// Where the wanted extrema of a field die, and at which values.
struct Deaths {
    /// By extremum: the vertex at which it dies and its value, of those that die. Minima, then maxima.
    passes: [Vec<(VertexId, VertexId, f64)>; 2],
}

impl Deaths {
    fn new(complex: &SimplicialComplex, values: &[f64], order: &VertexOrder, wanted: &WantedExtrema) -> Self {
        let passes = |pairs: Vec<ExtremumPair>, wanted: &[VertexId]| {
            let mut passes: Vec<(VertexId, VertexId, f64)> = pairs
                .into_iter()
                .filter(|pair| wanted.binary_search(&pair.extremum).is_ok())
                .filter_map(|pair| pair.saddle.map(|saddle| (pair.extremum, saddle, values[saddle.index()])))
                .collect();
            passes.sort_unstable_by_key(|&(extremum, ..)| extremum);
            passes
        };
        let [minima, maxima] = both_pairs(complex, order);
        Self { passes: [passes(minima, &wanted.minima), passes(maxima, &wanted.maxima)] }
    }

    /// The passes whose extremum dies at another value in a flooded field, by rising vertex.
    fn moved(&self, complex: &SimplicialComplex, bridged: &Bridged) -> Vec<VertexId> {
        let mut moved = Vec::new();
        for (pairs, passes) in both_pairs(complex, &bridged.flooded.order).iter().zip(&self.passes) {
            for pair in pairs {
                let Ok(place) = passes.binary_search_by_key(&pair.extremum, |&(extremum, ..)| extremum) else { continue };
                let (_, pass, value) = passes[place];
                if pair.saddle.is_none_or(|saddle| bridged.field[saddle.index()] != value) {
                    moved.push(pass);
                }
            }
        }
        moved.sort_unstable();
        moved.dedup();
        moved
    }
}

fn both_pairs(complex: &SimplicialComplex, order: &VertexOrder) -> [Vec<ExtremumPair>; 2] {
    let (minima, maxima) = rayon::join(
        || extremum_pairs(complex, order, ExtremumKind::Minimum),
        || extremum_pairs(complex, order, ExtremumKind::Maximum),
    );
    [minima, maxima]
}

/// The field with its bridges and cuts.
struct Works {
    field: Vec<f64>,
    /// The next vertex on the V-path to a wanted minimum, and to a wanted maximum.
    down: Vec<Option<VertexId>>,
    up: Vec<Option<VertexId>>,
    /// The level at which the way down, or up, from a vertex is open already.
    open_down: Vec<f64>,
    open_up: Vec<f64>,
    /// Wanted extrema stay as they are.
    is_wanted: Vec<bool>,
}

impl Works {
    fn new(complex: &SimplicialComplex, values: &[f64], order: &VertexOrder, wanted: &WantedExtrema) -> Result<Self, MorseError> {
        let successors = |kind: ExtremumKind, wanted: &[VertexId]| {
            let mut graph = ExtremumGraph::new(complex, order, kind)?;
            graph.simplify(values, wanted)?;
            Ok::<_, MorseError>(graph.successors())
        };
        let (down, up) = rayon::join(
            || successors(ExtremumKind::Minimum, &wanted.minima),
            || successors(ExtremumKind::Maximum, &wanted.maxima),
        );
        let mut is_wanted = vec![false; values.len()];
        wanted.minima.iter().chain(&wanted.maxima).for_each(|extremum| is_wanted[extremum.index()] = true);
        Ok(Self {
            field: values.to_vec(),
            down: down?,
            up: up?,
            open_down: vec![f64::INFINITY; values.len()],
            open_up: vec![f64::NEG_INFINITY; values.len()],
            is_wanted,
        })
    }

    /// Opens a way at the level of a pass: up from one that was cut down to `found`, down from one that was flooded.
    fn secure(&mut self, pass: VertexId, level: f64, found: f64) {
        let mut next = Some(pass);
        if found < level {
            while let Some(vertex) = next.filter(|vertex| self.open_up[vertex.index()] < level) {
                let i = vertex.index();
                self.open_up[i] = level;
                if !self.is_wanted[i] {
                    self.field[i] = self.field[i].max(level);
                }
                next = self.up[i];
            }
        } else if found > level {
            while let Some(vertex) = next.filter(|vertex| self.open_down[vertex.index()] > level) {
                let i = vertex.index();
                self.open_down[i] = level;
                if !self.is_wanted[i] {
                    self.field[i] = self.field[i].min(level);
                }
                next = self.down[i];
            }
        }
    }
}
