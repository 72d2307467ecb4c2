//! Topological simplification alone: the data, with exactly the wanted extrema, and nothing smoothed.

use serde::Serialize;

use crate::field::{Precision, VertexId};
use crate::mesh::SimplicialComplex;
use crate::monotone::{SimplifyError, ValueRule, simplified_field};
use crate::morse::{ExtremumPair, Selection, WantedExtrema};

use super::checks::constant_components;
use super::error::SmoothError;
use super::pipeline::SmoothProgress;
use super::report::{ExtremumCount, Timing};
use super::select::{MeasuredField, Selected, select_extrema};

/// A simplified field and the evidence.
#[derive(Debug, Clone)]
pub struct Simplified {
    /// `n` values of the asked width.
    pub values: Vec<f64>,
    /// The extrema that were wanted, and that the values have.
    pub wanted: WantedExtrema,
    /// What was asked of the value at each vertex: extrema, and the vertices at which they die, are fixed.
    pub rules: Vec<ValueRule>,
    /// What was measured.
    pub report: SimplifyReport,
}

/// The persistence pairs that the simplified values have, against those of the data.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PairReport {
    /// Extremum pairs of the simplified values, minima and maxima.
    pub found: usize,
    /// Of these, pairs of a wanted extremum that dies at the same value as in the data, or never in both.
    pub same: usize,
    /// Greatest change of the value at which a wanted extremum dies, in the units of the values.
    pub largest_change: f64,
}

/// How far the values are from the data; plain sums over vertices.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SimplifyChange {
    /// Vertices whose value is another one.
    pub vertices: usize,
    /// Root of the mean square of the change, over all vertices.
    pub rms: f64,
    /// Greatest change.
    pub largest: f64,
    /// `rms` as a fraction of the range of the data.
    pub rms_of_range: f64,
}

/// Evidence for one simplified field.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SimplifyReport {
    /// Vertices of the domain.
    pub vertices: usize,
    /// Dimension of the domain.
    pub dimension: usize,
    /// Least and greatest data value.
    pub data_range: (f64, f64),
    /// Extrema of the data.
    pub before: ExtremumCount,
    /// The persistence that had to be exceeded, in the units of the values; absent if extrema were chosen otherwise.
    pub threshold: Option<f64>,
    /// Extrema asked for.
    pub wanted: ExtremumCount,
    /// Of these, kept below the threshold because no field on the domain is without them.
    pub unavoidable: usize,
    /// Passes of the flood.
    pub passes: usize,
    /// Whether the flood did not settle, and a harmonic order took its place.
    pub replaced: bool,
    /// Saddles whose value had to be left free.
    pub freed_saddles: usize,
    /// Persistence pairs.
    pub pairs: PairReport,
    /// Stored width.
    pub precision: Precision,
    /// Change of the values.
    pub change: SimplifyChange,
    /// Wall seconds by stage.
    pub timing: Timing,
}

/// Simplifies a field so that it has exactly the wanted minima and maxima, without smoothing it.
///
/// # Arguments
/// * `data`: `n` finite values, one a vertex of `complex`.
/// * `selections`: which extrema are wanted; extremum pairs are computed once for all of them.
/// * `precision`: the width in which the values will be stored; it must hold the data.
/// * `progress`: told of every stage.
///
/// # Returns
/// One field a selection. Its values are strict under plain `<` along every edge, so they need no second array to order
/// plateaus. Wanted extrema keep their values. Where the wanted ones were chosen by a threshold, their pairs are those of the
/// data whose persistence exceeds it; nearly all die at the same values, all of them on curves, and `report.pairs` counts
/// them. Where what is removed lies across a pass, mostly along the boundary of the domain, no field may keep both, and
/// the pass moves.
///
/// # Errors
/// [`SmoothError`].
///
/// # Cost
/// O(n log n) for the pairs, and for each selection a few passes of O(n log n).
///
/// # Source
/// Tierny, Pascucci 2012; Lukasczyk, Garth, Maciejewski, Tierny 2020.
///
/// # Example
/// ```
/// use morsmooth::mesh::SimplicialComplex;
/// use morsmooth::field::Precision;
/// use morsmooth::morse::{Selection, Threshold};
/// use morsmooth::smooth::simplify;
/// let line = SimplicialComplex::new(1, vec![[0.0; 3]; 5], vec![0, 1, 1, 2, 2, 3, 3, 4])?;
/// let wanted = [Selection::Threshold(Threshold::Absolute(2.0))];
/// let simplified = simplify(&line, &[0.0, 6.0, 5.0, 8.0, 1.0], &wanted, Precision::F64, &mut |_| {})?;
/// let values = &simplified[0].values;
/// assert!(values.windows(2).take(3).all(|pair| pair[0] < pair[1]), "the pit of depth 1 is filled");
/// assert_eq!((values[0], values[3], values[4]), (0.0, 8.0, 1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simplify(
    complex: &SimplicialComplex,
    data: &[f64],
    selections: &[Selection],
    precision: Precision,
    progress: &mut dyn FnMut(SmoothProgress),
) -> Result<Vec<Simplified>, SmoothError> {
    if complex.simplex_count() == 0 {
        return Err(SmoothError::Empty { vertices: complex.vertex_count(), simplices: 0 });
    }
    progress(SmoothProgress::Stage("extrema of the data"));
    let mut timing = Timing::default();
    let measured = timing.measure("extrema", || MeasuredField::new(complex, data.to_vec()))?;
    if let Some(constant) = constant_components(complex, data).first() {
        return Err(SmoothError::Constant { vertex: constant[0], vertices: constant.len(), value: data[constant[0].index()] });
    }
    selections
        .iter()
        .map(|selection| {
            progress(SmoothProgress::Stage("simplification"));
            simplify_measured(complex, &measured, selection, precision, timing.clone())
        })
        .collect()
}

fn simplify_measured(
    complex: &SimplicialComplex,
    measured: &MeasuredField,
    selection: &Selection,
    precision: Precision,
    mut timing: Timing,
) -> Result<Simplified, SmoothError> {
    let Selected { wanted, unavoidable } = timing.measure("selection", || select_extrema(complex, measured, selection))?;
    let (data, order) = (&measured.values, &measured.order);
    let attempt = |free: &[VertexId]| simplified_field(complex, data, order, (&wanted, free), precision);
    let result = timing.measure("flood and repair", || match attempt(&[]) {
        // Nobody asked for these extrema: on a plateau their values would contradict their neighbours'.
        Err(SimplifyError::Contradiction(_) | SimplifyError::NotRepresentable(_)) if !unavoidable.is_empty() => attempt(&unavoidable),
        other => other,
    });
    let field = result.map_err(|error| SmoothError::of_simplify(error, precision))?;
    let after = timing.measure("pairs of the result", || MeasuredField::new(complex, field.values.clone()))?;
    let count = |field: &MeasuredField| ExtremumCount { minima: field.minima.len(), maxima: field.maxima.len() };
    let report = SimplifyReport {
        vertices: complex.vertex_count(),
        dimension: complex.dimension(),
        data_range: measured.range(),
        before: count(measured),
        threshold: measured.threshold(selection)?,
        wanted: ExtremumCount { minima: wanted.minima.len(), maxima: wanted.maxima.len() },
        unavoidable: unavoidable.len(),
        passes: field.passes,
        replaced: field.replaced,
        freed_saddles: field.freed_saddles,
        pairs: compare_pairs(measured, &after),
        precision,
        change: change(data, &field.values, measured.range()),
        timing,
    };
    Ok(Simplified { values: field.values, wanted, rules: field.rules, report })
}

/// Where the extrema that are left die, before and after.
fn compare_pairs(before: &MeasuredField, after: &MeasuredField) -> PairReport {
    let mut report = PairReport { found: after.minima.len() + after.maxima.len(), same: 0, largest_change: 0.0 };
    for (before_pairs, after_pairs) in [(&before.minima, &after.minima), (&before.maxima, &after.maxima)] {
        let mut deaths: Vec<(VertexId, Option<f64>)> = before_pairs.iter().map(|pair| (pair.extremum, death(pair, before))).collect();
        deaths.sort_unstable_by_key(|&(extremum, _)| extremum);
        for pair in after_pairs {
            let Ok(place) = deaths.binary_search_by_key(&pair.extremum, |&(extremum, _)| extremum) else { continue };
            match (deaths[place].1, death(pair, after)) {
                (was, is) if was == is => report.same += 1,
                (Some(was), Some(is)) => report.largest_change = report.largest_change.max((was - is).abs()),
                _ => {}
            }
        }
    }
    report
}

fn death(pair: &ExtremumPair, field: &MeasuredField) -> Option<f64> {
    pair.saddle.map(|saddle| field.values[saddle.index()])
}

fn change(data: &[f64], values: &[f64], (low, high): (f64, f64)) -> SimplifyChange {
    let differences = || data.iter().zip(values).map(|(was, is)| (is - was).abs());
    let largest = differences().fold(0.0, f64::max);
    // In units of the largest, whose square may leave the range of numbers.
    let square: f64 = differences().map(|difference| if largest > 0.0 { (difference / largest).powi(2) } else { 0.0 }).sum();
    let rms = largest * (square / data.len().max(1) as f64).sqrt();
    let vertices = differences().filter(|&difference| difference != 0.0).count();
    SimplifyChange { vertices, rms, largest, rms_of_range: if high > low { rms / (high - low) } else { 0.0 } }
}
