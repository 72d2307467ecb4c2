//! Which extrema are wanted: by a persistence threshold, by their number, or by a chosen set.

use crate::field::VertexId;

use super::error::MorseError;
use super::pairs::{ExtremumKind, ExtremumPair};

/// A persistence threshold; kept is what exceeds it strictly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Threshold {
    /// A fraction of the range of the field on which extrema are selected: 0.05 for 5 %.
    Fraction(f64),
    /// In the units of the field.
    Absolute(f64),
}

impl Threshold {
    /// The threshold in the units of the field.
    ///
    /// # Arguments
    /// * `range`: greatest minus smallest value of the field on which extrema are selected.
    ///
    /// # Errors
    /// [`MorseError::Threshold`] if it is negative, infinite or not a number.
    pub fn resolve(self, range: f64) -> Result<f64, MorseError> {
        let (given, resolved) = match self {
            Self::Fraction(fraction) => (fraction, fraction * range),
            Self::Absolute(value) => (value, value),
        };
        if given >= 0.0 && resolved.is_finite() { Ok(resolved) } else { Err(MorseError::Threshold { found: given }) }
    }
}

/// How the wanted extrema are chosen.
#[derive(Debug, Clone, PartialEq)]
pub enum Selection {
    /// Every extremum whose persistence is greater than the threshold.
    Threshold(Threshold),
    /// This many extrema, minima and maxima together, by falling persistence.
    Count(usize),
    /// These vertices.
    Set(Vec<VertexId>),
}

/// The extrema to keep, each list by rising vertex.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct WantedExtrema {
    /// Minima.
    pub minima: Vec<VertexId>,
    /// Maxima.
    pub maxima: Vec<VertexId>,
}

/// Range of the field: value of the highest maximum minus value of the lowest minimum; 0 without extrema.
///
/// # Arguments
/// * `minima`, `maxima`: all extremum pairs of the field.
/// * `values`: the `n` values from which the vertex order was taken.
pub fn range(minima: &[ExtremumPair], maxima: &[ExtremumPair], values: &[f64]) -> f64 {
    let value = |pair: &ExtremumPair| values[pair.extremum.index()];
    let low = minima.iter().map(value).fold(f64::INFINITY, f64::min);
    let high = maxima.iter().map(value).fold(f64::NEG_INFINITY, f64::max);
    if low <= high { high - low } else { 0.0 }
}

/// Persistence of every pair, for reports: that of an essential pair is the range of its component.
///
/// # Arguments
/// * `pairs`: pairs of one kind, of which the persistences are asked.
/// * `opposite`: all pairs of the other kind.
/// * `values`: the `n` values from which the vertex order was taken.
///
/// # Returns
/// One persistence a pair, in the units of the field.
///
/// # Cost
/// O(p log c) for p pairs and c components.
pub fn reported_persistences(pairs: &[ExtremumPair], opposite: &[ExtremumPair], values: &[f64]) -> Vec<f64> {
    let mut essential: Vec<(VertexId, VertexId)> =
        opposite.iter().filter(|pair| pair.is_essential()).map(|pair| (pair.component, pair.extremum)).collect();
    essential.sort_unstable();
    let across = |pair: &ExtremumPair| {
        let place = essential.binary_search_by_key(&pair.component, |&(component, _)| component);
        place.map_or(0.0, |place| (values[essential[place].1.index()] - values[pair.extremum.index()]).abs())
    };
    pairs.iter().map(|pair| pair.persistence(values).unwrap_or_else(|| across(pair))).collect()
}

/// Chooses the extrema to keep. Essential pairs, the lowest minimum and the highest maximum of each component, are
/// kept by any threshold and number.
///
/// # Arguments
/// * `minima`, `maxima`: all extremum pairs of the field on which extrema are selected.
/// * `values`: its `n` values.
/// * `selection`: the rule. Of equal persistences a number prefers minima, then the more extreme value, then the
///   vertex that comes first in the order (for maxima: last).
///
/// # Errors
/// [`MorseError::Threshold`]; [`MorseError::TooFew`] and [`MorseError::TooMany`] for a number;
/// [`MorseError::NotAnExtremum`] and [`MorseError::ComponentWithout`] for a set.
///
/// # Cost
/// O(p log p) for p pairs.
pub fn select(
    minima: &[ExtremumPair],
    maxima: &[ExtremumPair],
    values: &[f64],
    selection: &Selection,
) -> Result<WantedExtrema, MorseError> {
    let mut wanted = match selection {
        Selection::Threshold(threshold) => {
            let threshold = threshold.resolve(range(minima, maxima, values))?;
            let kept = |pairs: &[ExtremumPair]| {
                let exceeding = pairs.iter().filter(|pair| pair.persistence(values).is_none_or(|p| p > threshold));
                exceeding.map(|pair| pair.extremum).collect()
            };
            WantedExtrema { minima: kept(minima), maxima: kept(maxima) }
        }
        Selection::Count(count) => by_count(minima, maxima, values, *count)?,
        Selection::Set(set) => by_set(minima, maxima, set)?,
    };
    wanted.minima.sort_unstable();
    wanted.maxima.sort_unstable();
    Ok(wanted)
}

fn by_count(
    minima: &[ExtremumPair],
    maxima: &[ExtremumPair],
    values: &[f64],
    count: usize,
) -> Result<WantedExtrema, MorseError> {
    let mut pairs: Vec<&ExtremumPair> = minima.iter().chain(maxima).collect();
    let needed = pairs.iter().filter(|pair| pair.is_essential()).count();
    if count < needed {
        return Err(MorseError::TooFew { asked: count, needed });
    }
    if count > pairs.len() {
        return Err(MorseError::TooMany { asked: count, available: pairs.len() });
    }
    let persistence = |pair: &ExtremumPair| pair.persistence(values).unwrap_or(f64::INFINITY);
    // Stable: pairs come by rank, so equal persistences stay in that order.
    pairs.sort_by(|a, b| persistence(b).total_cmp(&persistence(a)));
    let of_kind =
        |kind: ExtremumKind| pairs[..count].iter().filter(|pair| pair.kind == kind).map(|pair| pair.extremum).collect();
    Ok(WantedExtrema { minima: of_kind(ExtremumKind::Minimum), maxima: of_kind(ExtremumKind::Maximum) })
}

fn by_set(minima: &[ExtremumPair], maxima: &[ExtremumPair], set: &[VertexId]) -> Result<WantedExtrema, MorseError> {
    let mut left: Vec<VertexId> = set.to_vec();
    left.sort_unstable();
    left.dedup();
    let mut chosen = |pairs: &[ExtremumPair], kind: ExtremumKind| {
        let in_set: Vec<&ExtremumPair> =
            pairs.iter().filter(|pair| left.binary_search(&pair.extremum).is_ok()).collect();
        let mut served: Vec<VertexId> = in_set.iter().map(|pair| pair.component).collect();
        served.sort_unstable();
        // Every component has exactly one essential pair.
        let unserved = pairs
            .iter()
            .filter(|pair| pair.is_essential() && served.binary_search(&pair.component).is_err())
            .map(|pair| pair.component)
            .min();
        let mut extrema: Vec<VertexId> = in_set.iter().map(|pair| pair.extremum).collect();
        extrema.sort_unstable();
        left.retain(|vertex| extrema.binary_search(vertex).is_err());
        (extrema, unserved.map(|component| MorseError::ComponentWithout { kind, component }))
    };
    let (minima, no_minimum) = chosen(minima, ExtremumKind::Minimum);
    let (maxima, no_maximum) = chosen(maxima, ExtremumKind::Maximum);
    if let Some(&vertex) = left.first() {
        return Err(MorseError::NotAnExtremum { vertex });
    }
    match no_minimum.or(no_maximum) {
        Some(error) => Err(error),
        None => Ok(WantedExtrema { minima, maxima }),
    }
}
