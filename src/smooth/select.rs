//! From a field to the extrema that its smooth version must have.

use crate::field::{VertexId, VertexOrder};
use crate::mesh::SimplicialComplex;
use crate::monotone::unreachable_regions;
use crate::morse::{ExtremumKind, ExtremumPair, Selection, WantedExtrema, extremum_pairs, select};

use super::error::SmoothError;

/// A field with its extremum pairs.
#[derive(Debug, Clone)]
pub struct MeasuredField {
    /// `n` values.
    pub values: Vec<f64>,
    /// Their order.
    pub order: VertexOrder,
    /// Minima, each with the saddle at which it dies: dimension 0 of the field.
    pub minima: Vec<ExtremumPair>,
    /// Maxima likewise: dimension 0 of the negated field.
    pub maxima: Vec<ExtremumPair>,
}

impl MeasuredField {
    /// Orders the vertices and pairs the extrema.
    ///
    /// # Errors
    /// [`SmoothError::Field`] for values that are not finite or too few.
    ///
    /// # Cost
    /// O(n log n).
    pub fn new(complex: &SimplicialComplex, values: Vec<f64>) -> Result<Self, SmoothError> {
        if values.len() != complex.vertex_count() {
            let (expected, found) = (complex.vertex_count(), values.len());
            return Err(crate::field::FieldError::LengthMismatch { expected, found }.into());
        }
        let order = VertexOrder::of_values(&values)?;
        let (minima, maxima) = rayon::join(
            || extremum_pairs(complex, &order, ExtremumKind::Minimum),
            || extremum_pairs(complex, &order, ExtremumKind::Maximum),
        );
        Ok(Self { values, order, minima, maxima })
    }

    /// Least and greatest value.
    pub fn range(&self) -> (f64, f64) {
        let end = |vertex: Option<&VertexId>| vertex.map_or(0.0, |vertex| self.values[vertex.index()]);
        (end(self.order.sequence().first()), end(self.order.sequence().last()))
    }

    /// The persistence that a selection asks to exceed, in the units of the values; `None` if it is no threshold.
    ///
    /// # Errors
    /// [`SmoothError::Morse`] for a threshold that is negative or no number.
    pub fn threshold(&self, selection: &Selection) -> Result<Option<f64>, SmoothError> {
        let (low, high) = self.range();
        match selection {
            Selection::Threshold(threshold) => Ok(Some(threshold.resolve(high - low)?)),
            Selection::Count(_) | Selection::Set(_) => Ok(None),
        }
    }
}

/// The selection, completed where the domain needs more.
#[derive(Debug, Clone)]
pub struct Selected {
    /// The wanted extrema, by rising vertex.
    pub wanted: WantedExtrema,
    /// Of these, kept only because no field is without them, by rising vertex. Their values are kept where they can be.
    pub unavoidable: Vec<VertexId>,
}

/// Chooses the wanted extrema of a field.
///
/// Where a part of the domain touches the rest at one vertex only, every field has an extremum in it; there the most
/// persistent one is added, unless the set was chosen by hand, which is then refused.
///
/// # Errors
/// [`SmoothError::Morse`], [`SmoothError::Representative`].
///
/// # Cost
/// O(n + m), repeated while parts are completed.
pub fn select_extrema(
    complex: &SimplicialComplex,
    field: &MeasuredField,
    selection: &Selection,
) -> Result<Selected, SmoothError> {
    let mut wanted = select(&field.minima, &field.maxima, &field.values, selection)?;
    let mut unavoidable = Vec::new();
    loop {
        let regions = unreachable_regions(complex, &wanted);
        let Some(first) = regions.first() else { break };
        let refusal = crate::monotone::RepresentativeError::Unreachable { vertex: first[0], len: first.len() };
        if matches!(selection, Selection::Set(_)) {
            return Err(refusal.into());
        }
        const OUTSIDE: u32 = u32::MAX;
        let mut region_of = vec![OUTSIDE; complex.vertex_count()];
        for (number, region) in regions.iter().enumerate() {
            region.iter().for_each(|vertex| region_of[vertex.index()] = number as u32);
        }
        let mut best: Vec<Option<(f64, &ExtremumPair)>> = vec![None; regions.len()];
        for pair in field.minima.iter().chain(&field.maxima) {
            let number = region_of[pair.extremum.index()];
            if number == OUTSIDE {
                continue;
            }
            let persistence = pair.persistence(&field.values).unwrap_or(f64::INFINITY);
            let slot = &mut best[number as usize];
            if slot.is_none_or(|(most, _)| persistence > most) {
                *slot = Some((persistence, pair));
            }
        }
        for choice in &best {
            // The highest or the lowest vertex of such a part is an extremum of any field, so there is always one.
            let Some((_, pair)) = choice else { return Err(refusal.into()) };
            match pair.kind {
                ExtremumKind::Minimum => wanted.minima.push(pair.extremum),
                ExtremumKind::Maximum => wanted.maxima.push(pair.extremum),
            }
            unavoidable.push(pair.extremum);
        }
    }
    wanted.minima.sort_unstable();
    wanted.maxima.sort_unstable();
    unavoidable.sort_unstable();
    Ok(Selected { wanted, unavoidable })
}
