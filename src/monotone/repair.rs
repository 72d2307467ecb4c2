//! Exact repair: the solver's field, rounded to the stored precision, made to rise strictly along every monotonicity edge.
//!
//! Floating-point numbers of one width are ordered like integers, so "strictly greater" is "at least the next number".
//! Bounds from below and above are passed along the edges in these integers; then one upward sweep moves each value into
//! its bounds and above its lower neighbours. Nothing is left to tolerances: the result is strict under plain `<` in
//! the stored precision, or there is no such field.

use crate::field::{Precision, VertexId};

use super::edges::MonotonicityGraph;
use super::levels::ValueRule;

/// How two ends of a monotonicity edge must compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Strictness {
    /// Under plain `<`.
    #[default]
    Plain,
    /// Under (value, vertex index): equal values are allowed where the lower end has the smaller index.
    TiesByIndex,
}

/// The repaired field and how far it was moved.
#[derive(Debug, Clone)]
pub struct Repaired {
    /// Values of the stored width.
    pub values: Vec<f64>,
    /// Vertices whose value is not just the rounded one.
    pub moved: usize,
    /// Greatest distance from the value before rounding.
    pub largest_move: f64,
}

/// No field of the stored width fits: between two asked values there are fewer numbers than vertices in a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NotRepresentable {
    /// The vertex without a value left.
    pub vertex: VertexId,
}

/// Rounds a field to the stored precision and makes it rise strictly along every edge.
///
/// # Arguments
/// * `field`: `n` finite values.
/// * `rules`: `n` rules; fixed values are rounded to the precision first, intervals inwards.
///
/// # Errors
/// [`NotRepresentable`].
///
/// # Cost
/// O(n + m).
pub fn repair(
    graph: &MonotonicityGraph,
    field: &[f64],
    rules: &[ValueRule],
    precision: Precision,
    strictness: Strictness,
) -> Result<Repaired, NotRepresentable> {
    let n = field.len();
    let sequence = graph.order().sequence();
    let step = |low: VertexId, high: VertexId| match strictness {
        Strictness::Plain => 1,
        Strictness::TiesByIndex => i64::from(low > high),
    };
    let widest = precision.place(match precision {
        Precision::F32 => f64::from(f32::MAX),
        Precision::F64 => f64::MAX,
    });
    let (mut lower, mut upper) = (vec![-widest; n], vec![widest; n]);
    for (i, rule) in rules.iter().enumerate() {
        let (low, high) = rule.bounds();
        match rule {
            ValueRule::Free => {}
            ValueRule::Exactly(value) => (lower[i], upper[i]) = (precision.place(*value), precision.place(*value)),
            ValueRule::Within(..) => {
                lower[i] = precision.place(low) + i64::from(precision.round(low) < low);
                upper[i] = precision.place(high) - i64::from(precision.round(high) > high);
            }
        }
    }
    for &vertex in sequence {
        for &below in graph.below(vertex) {
            lower[vertex.index()] = lower[vertex.index()].max(lower[below.index()] + step(below, vertex));
        }
    }
    for &vertex in sequence.iter().rev() {
        for &above in graph.above(vertex) {
            upper[vertex.index()] = upper[vertex.index()].min(upper[above.index()] - step(vertex, above));
        }
    }
    let mut places = vec![0i64; n];
    let mut values = vec![0.0; n];
    let (mut moved, mut largest_move) = (0, 0.0f64);
    for &vertex in sequence {
        let i = vertex.index();
        if lower[i] > upper[i] {
            return Err(NotRepresentable { vertex });
        }
        let rounded = precision.place(field[i]);
        let floor = graph.below(vertex).iter().map(|&below| places[below.index()] + step(below, vertex)).max();
        // The floor never passes the upper bound: each vertex below respects its own, which is smaller by the step.
        places[i] = rounded.max(floor.unwrap_or(lower[i])).max(lower[i]).min(upper[i]);
        values[i] = precision.number(places[i]);
        moved += usize::from(places[i] != rounded);
        largest_move = largest_move.max((values[i] - field[i]).abs());
    }
    Ok(Repaired { values, moved, largest_move })
}
