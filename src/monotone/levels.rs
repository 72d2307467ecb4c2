//! Levels: a strictly feasible field in linear time, or the two values that contradict the order.
//!
//! With `lo` and `hi` the largest value fixed below a vertex and the smallest fixed above it, and `depth` and `height` the
//! longest paths of monotonicity edges from below and to above,
//!
//! ```text
//! level_i = lo_i + (hi_i - lo_i) depth_i / (depth_i + height_i)
//! ```
//!
//! rises along every edge: `lo`, `hi` and the fraction do not fall, and the fraction rises. Differences of levels are the
//! margins of the order constraints, and levels are the interior start of the solver.

use crate::field::VertexId;

use super::edges::MonotonicityGraph;

/// What is known beforehand of the value at a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ValueRule {
    /// Nothing.
    Free,
    /// It is this.
    Exactly(f64),
    /// It lies in this closed interval.
    Within(f64, f64),
}

impl ValueRule {
    /// Smallest and greatest value allowed.
    pub fn bounds(self) -> (f64, f64) {
        match self {
            Self::Free => (f64::NEG_INFINITY, f64::INFINITY),
            Self::Exactly(value) => (value, value),
            Self::Within(low, high) => (low, high),
        }
    }
}

/// Two vertices whose asked values contradict the order: the field must rise from `low` to `high`, but cannot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contradiction {
    /// The vertex that must be lower.
    pub low: VertexId,
    /// The least value asked there.
    pub low_value: f64,
    /// The vertex that must be higher.
    pub high: VertexId,
    /// The greatest value asked there.
    pub high_value: f64,
}

/// A strictly feasible field.
#[derive(Debug, Clone)]
pub struct Levels {
    /// One value a vertex, rising strictly (up to rounding) along every monotonicity edge.
    pub values: Vec<f64>,
    /// Greatest lower bound set at or below each vertex.
    pub lower: Vec<f64>,
    /// Smallest upper bound set at or above each vertex.
    pub upper: Vec<f64>,
}

impl Levels {
    /// Least and greatest bound anywhere.
    pub fn range(&self) -> (f64, f64) {
        let low = self.lower.iter().copied().fold(f64::INFINITY, f64::min);
        (low, self.upper.iter().copied().fold(f64::NEG_INFINITY, f64::max))
    }
}

/// The levels of a monotonicity graph, or the contradiction that makes it infeasible.
///
/// # Arguments
/// * `rules`: one a vertex. Intervals stand at minima and maxima of the graph only, fixed values anywhere.
/// * `range`: the values that take the place of a missing bound, its low end strictly below its high end; it must not
///   cut into the rules' values.
///
/// # Errors
/// A [`Contradiction`] if some value asked below is not smaller than one asked above.
///
/// # Cost
/// O(n + m).
pub fn levels(graph: &MonotonicityGraph, rules: &[ValueRule], range: (f64, f64)) -> Result<Levels, Contradiction> {
    let n = rules.len();
    let sequence = graph.order().sequence();
    let (mut lower, mut upper) = (vec![range.0; n], vec![range.1; n]);
    let (mut lower_source, mut upper_source) = (vec![VertexId(0); n], vec![VertexId(0); n]);
    let (mut depth, mut height) = (vec![0u32; n], vec![0u32; n]);
    for &vertex in sequence {
        let i = vertex.index();
        lower_source[i] = vertex;
        lower[i] = lower[i].max(rules[i].bounds().0);
        // A source whose value is not fixed must not lie on its own bound.
        depth[i] = u32::from(!matches!(rules[i], ValueRule::Exactly(_)));
        for &below in graph.below(vertex) {
            let j = below.index();
            if lower[j] > lower[i] {
                (lower[i], lower_source[i]) = (lower[j], lower_source[j]);
            }
            depth[i] = depth[i].max(depth[j] + 1);
        }
    }
    for &vertex in sequence.iter().rev() {
        let i = vertex.index();
        upper_source[i] = vertex;
        upper[i] = upper[i].min(rules[i].bounds().1);
        height[i] = u32::from(!matches!(rules[i], ValueRule::Exactly(_)));
        for &above in graph.above(vertex) {
            let j = above.index();
            if upper[j] < upper[i] {
                (upper[i], upper_source[i]) = (upper[j], upper_source[j]);
            }
            height[i] = height[i].max(height[j] + 1);
        }
    }
    let mut values = vec![0.0; n];
    for i in 0..n {
        if let ValueRule::Exactly(value) = rules[i] {
            if let Some(found) = cut_off(graph, i, value, (&lower, &lower_source), (&upper, &upper_source)) {
                return Err(found);
            }
            values[i] = value;
            continue;
        }
        if lower[i] >= upper[i] {
            return Err(contradiction(i, &lower, &lower_source, &upper, &upper_source));
        }
        let fraction = f64::from(depth[i]) / f64::from(depth[i] + height[i]);
        values[i] = lower[i] + (upper[i] - lower[i]) * fraction;
    }
    Ok(Levels { values, lower, upper })
}

/// A value fixed or bounded below a fixed vertex that is not smaller, or one above it that is not greater.
fn cut_off(
    graph: &MonotonicityGraph,
    i: usize,
    value: f64,
    (lower, lower_source): (&[f64], &[VertexId]),
    (upper, upper_source): (&[f64], &[VertexId]),
) -> Option<Contradiction> {
    let vertex = VertexId::from(i);
    let below = graph.below(vertex).iter().map(|below| below.index()).find(|&j| lower[j] >= value);
    if let Some(j) = below {
        return Some(Contradiction { low: lower_source[j], low_value: lower[j], high: vertex, high_value: value });
    }
    let above = graph.above(vertex).iter().map(|above| above.index()).find(|&j| upper[j] <= value);
    above.map(|j| Contradiction { low: vertex, low_value: value, high: upper_source[j], high_value: upper[j] })
}

fn contradiction(
    i: usize,
    lower: &[f64],
    lower_source: &[VertexId],
    upper: &[f64],
    upper_source: &[VertexId],
) -> Contradiction {
    Contradiction { low: lower_source[i], low_value: lower[i], high: upper_source[i], high_value: upper[i] }
}

/// The nearest non-decreasing field, in the mean of two sweeps: upwards each vertex is raised to those below it, downwards
/// lowered to those above it; both stay within the bounds of the levels.
///
/// # Returns
/// A field that does not fall along any monotonicity edge, and keeps fixed values.
///
/// # Cost
/// O(n + m).
pub fn sweep(graph: &MonotonicityGraph, levels: &Levels, field: &[f64]) -> Vec<f64> {
    let sequence = graph.order().sequence();
    let clamp = |i: usize, value: f64| value.max(levels.lower[i]).min(levels.upper[i]);
    let (mut raised, mut lowered) = (field.to_vec(), field.to_vec());
    for &vertex in sequence {
        let floor = graph.below(vertex).iter().map(|below| raised[below.index()]).fold(f64::NEG_INFINITY, f64::max);
        raised[vertex.index()] = clamp(vertex.index(), field[vertex.index()].max(floor));
    }
    for &vertex in sequence.iter().rev() {
        let roof = graph.above(vertex).iter().map(|above| lowered[above.index()]).fold(f64::INFINITY, f64::min);
        lowered[vertex.index()] = clamp(vertex.index(), field[vertex.index()].min(roof));
    }
    raised.iter().zip(&lowered).map(|(a, b)| 0.5 * (a + b)).collect()
}
