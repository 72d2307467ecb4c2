//! The simplified field: values near the data whose extrema are exactly the wanted ones, strict as they are stored.
//!
//! The flood gives values with plateaus: a filled pit is as high as its pass. Other programs carry a second array that
//! orders the plateaus; here the exact repair raises each vertex of a plateau to the next free numbers above its lower
//! neighbours, so that plain `<` on the values says it all. What is kept besides the extrema are the values of the
//! vertices at which they die, so that every persistence pair that is left has the persistence it had.

use crate::field::{Precision, VertexId, VertexOrder};
use crate::mesh::SimplicialComplex;
use crate::morse::{ExtremumKind, WantedExtrema, extremum_pairs};

use super::bridges::flood_with_bridges;
use super::edges::{EdgeSet, MonotonicityGraph};
use super::flood::Flooded;
use super::levels::{Contradiction, ValueRule, levels, sweep};
use super::repair::{NotRepresentable, Repaired, Strictness, repair};
use super::representative::{RepresentativeError, harmonic};

/// A field with exactly the wanted extrema, near a given one.
#[derive(Debug, Clone)]
pub struct SimplifiedField {
    /// `n` values of the stored width, strict under plain `<` along every edge of the mesh.
    pub values: Vec<f64>,
    /// An order that they rise along on every edge.
    pub order: VertexOrder,
    /// What was asked of the value at each vertex: the extrema and the vertices at which they die are fixed.
    pub rules: Vec<ValueRule>,
    /// Passes of the flood.
    pub passes: usize,
    /// Whether the flood did not settle, and a harmonic order took the place of its own.
    pub replaced: bool,
    /// Saddles whose value could not be kept, because too few numbers of the stored width lie beside it.
    pub freed_saddles: usize,
}

/// Why there is no simplified field.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimplifyError {
    /// The wanted extrema admit no field.
    #[error(transparent)]
    Representative(#[from] RepresentativeError),
    /// Two values at wanted extrema contradict each other.
    #[error(
        "the values of vertex {} ({:?}) and vertex {} ({:?}) contradict each other: the first must stay below the second",
        .0.low, .0.low_value, .0.high, .0.high_value
    )]
    Contradiction(Contradiction),
    /// Fewer numbers of the stored width lie between two wanted values than vertices in a row.
    #[error("no strictly monotone field fits at vertex {}: expected more distance between the wanted values", .0.vertex)]
    NotRepresentable(NotRepresentable),
}

/// Simplifies a field to exactly the wanted extrema.
///
/// # Arguments
/// * `values`, `order`: the `n` values of a field and their order.
/// * `wanted`: the extrema to be left, with the values they have.
/// * `free`: those of them whose values need not be kept, by rising vertex.
/// * `precision`: the stored width, which must hold the values.
///
/// # Returns
/// Values that differ from the given ones in filled pits and cut hills, and by a few units in the last place where a plateau
/// was made strict.
///
/// # Errors
/// [`SimplifyError`]. Extrema of the field itself, chosen by a threshold, cannot contradict each other.
///
/// # Cost
/// That of a flood, and O(m) for m edges.
///
/// # Source
/// The flood: Tierny, Pascucci 2012; Lukasczyk, Garth, Maciejewski, Tierny 2020.
pub fn simplified_field(
    complex: &SimplicialComplex,
    values: &[f64],
    order: &VertexOrder,
    (wanted, free): (&WantedExtrema, &[VertexId]),
    precision: Precision,
) -> Result<SimplifiedField, SimplifyError> {
    let bridged = flood_with_bridges(complex, values, order, wanted).map_err(RepresentativeError::Morse)?;
    let (Flooded { order: flooded, valid, passes }, field) = (bridged.flooded, bridged.field);
    let flooded = if valid { flooded } else { harmonic(complex, wanted)?.order };
    let graph = MonotonicityGraph::new(complex, &flooded, wanted, EdgeSet::All);
    let mut rules = vec![ValueRule::Free; values.len()];
    for &extremum in wanted.minima.iter().chain(&wanted.maxima).filter(|extremum| free.binary_search(extremum).is_err()) {
        rules[extremum.index()] = ValueRule::Exactly(precision.round(values[extremum.index()]));
    }
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
    // A free extremum may have to leave the range: on a plateau at its end there is no room within.
    let room = if free.is_empty() { 0.0 } else { high - low };
    let range = (low - room, high + room);
    let levels = levels(&graph, &rules, range).map_err(SimplifyError::Contradiction)?;
    // The flood's own values do not fall along its order; those of another order must be found along it.
    let field = if valid { field } else { sweep(&graph, &levels, values) };
    let mut freed_saddles = 0;
    if valid {
        let with_saddles = fixed_saddles(complex, &flooded, &field, &rules, precision);
        (rules, freed_saddles) = without_crowding(&graph, with_saddles, &rules, precision);
    }
    let repaired = repair(&graph, &field, &rules, precision, Strictness::Plain).map_err(SimplifyError::NotRepresentable)?;
    let Repaired { values: mut strict, .. } = repaired;
    for vertex in (0..values.len()).filter(|&vertex| complex.neighbours(vertex.into()).is_empty()) {
        strict[vertex] = precision.round(values[vertex]);
    }
    Ok(SimplifiedField { values: strict, order: flooded, rules, passes, replaced: !valid, freed_saddles })
}

/// The rules with the vertices fixed at which the wanted extrema die, at the level of the flood.
fn fixed_saddles(
    complex: &SimplicialComplex,
    order: &VertexOrder,
    field: &[f64],
    rules: &[ValueRule],
    precision: Precision,
) -> Vec<ValueRule> {
    let mut rules = rules.to_vec();
    let (minima, maxima) = rayon::join(
        || extremum_pairs(complex, order, ExtremumKind::Minimum),
        || extremum_pairs(complex, order, ExtremumKind::Maximum),
    );
    for saddle in minima.iter().chain(&maxima).filter_map(|pair| pair.saddle) {
        // Where every saddle is an extremum, as on a curve, its rule stands already.
        if rules[saddle.index()] == ValueRule::Free {
            rules[saddle.index()] = ValueRule::Exactly(precision.round(field[saddle.index()]));
        }
    }
    rules
}

/// The rules without those saddles that leave too few numbers of the stored width between themselves and what is fixed
/// below or above them, and how many these are.
fn without_crowding(
    graph: &MonotonicityGraph,
    mut rules: Vec<ValueRule>,
    without: &[ValueRule],
    precision: Precision,
) -> (Vec<ValueRule>, usize) {
    let mut freed = 0;
    let is_saddle = |i: usize| without[i] == ValueRule::Free;
    let mut free = |rules: &mut Vec<ValueRule>, i: usize| {
        rules[i] = ValueRule::Free;
        freed += 1;
    };
    let sequence = graph.order().sequence();
    // The least place left to each vertex by what is fixed below it; then the greatest by what is fixed above.
    let mut least = vec![i64::MIN; rules.len()];
    for &vertex in sequence {
        let i = vertex.index();
        least[i] = graph.below(vertex).iter().map(|below| least[below.index()].saturating_add(1)).max().unwrap_or(i64::MIN);
        if let ValueRule::Exactly(value) = rules[i] {
            match precision.place(value) {
                place if place >= least[i] => least[i] = place,
                _ if is_saddle(i) => free(&mut rules, i),
                _ => {}
            }
        }
    }
    let mut greatest = vec![i64::MAX; rules.len()];
    for &vertex in sequence.iter().rev() {
        let i = vertex.index();
        greatest[i] = graph.above(vertex).iter().map(|above| greatest[above.index()].saturating_sub(1)).min().unwrap_or(i64::MAX);
        if let ValueRule::Exactly(value) = rules[i] {
            match precision.place(value) {
                place if place <= greatest[i] => greatest[i] = place,
                _ if is_saddle(i) => free(&mut rules, i),
                _ => {}
            }
        }
    }
    (rules, freed)
}
