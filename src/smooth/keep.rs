//! What of the Morse complex is kept besides its extrema: values at saddles, values along separatrices.
//!
//! The values are those of the simplified field: the field on which extrema were selected, with filled pits and cut hills.
//! It has exactly the wanted extrema, rises strictly along its own order on every edge of the mesh, and its separatrices rise
//! and fall in that order, so its values at any vertices contradict neither each other nor the flood's monotonicity edges.
//!
//! Literature: Bremer, Edelsbrunner, Hamann, Pascucci 2004, *A topological hierarchy for functions on triangulated surfaces*;
//! Weinkauf, Gingold, Sorkine 2010, *Topology-based smoothing of 2D scalar fields with C1-continuity*, section 4.

use crate::field::{Precision, VertexId};
use crate::mesh::SimplicialComplex;
use crate::monotone::{SimplifiedField, SimplifyError, ValueRule, simplified_field};
use crate::morse::{ExtremumGraph, ExtremumKind, separatrices};

use super::error::SmoothError;
use super::options::KeepAlso;
use super::select::{MeasuredField, Selected};

/// Values to be kept besides those of the wanted extrema.
pub(super) struct Kept {
    /// Vertices by rising index, with their values, which the stored width holds.
    pub(super) values: Vec<(VertexId, f64)>,
    /// How many of them are saddles.
    pub(super) saddles: usize,
}

impl Kept {
    /// The rules, with these values fixed where nothing was asked yet.
    pub(super) fn added_to(&self, rules: &[ValueRule]) -> Vec<ValueRule> {
        let mut rules = rules.to_vec();
        for &(vertex, value) in &self.values {
            rules[vertex.index()] = ValueRule::Exactly(value);
        }
        rules
    }
}

/// The vertices that are kept, with their values in the simplified field.
///
/// A saddle or a point of a separatrix that is a wanted extremum, as all saddles of a curve are, is left to the rule of the
/// extremum.
pub(super) fn kept_values(
    complex: &SimplicialComplex,
    field: &MeasuredField,
    Selected { wanted, unavoidable }: &Selected,
    precision: Precision,
    what: KeepAlso,
) -> Result<Kept, SmoothError> {
    let attempt = |free: &[VertexId]| simplified_field(complex, &field.values, &field.order, (wanted, free), precision);
    let simplified = match attempt(&[]) {
        Err(SimplifyError::Contradiction(_) | SimplifyError::NotRepresentable(_)) if !unavoidable.is_empty() => attempt(unavoidable),
        other => other,
    };
    let SimplifiedField { values, order, .. } = simplified.map_err(|error| SmoothError::of_simplify(error, precision))?;
    let (below, above) = rayon::join(
        || ExtremumGraph::new(complex, &order, ExtremumKind::Minimum),
        || ExtremumGraph::new(complex, &order, ExtremumKind::Maximum),
    );
    let found = separatrices(&below?, &above?);
    const SADDLE: u8 = 1;
    const PATH: u8 = 2;
    const EXTREMUM: u8 = 4;
    let mut role = vec![0u8; values.len()];
    for path in found.descending.iter().chain(&found.ascending) {
        path.iter().for_each(|vertex| role[vertex.index()] |= PATH);
    }
    // A saddle may lie on the separatrix of another one; it counts as a saddle.
    found.saddles.iter().for_each(|saddle| role[saddle.index()] = SADDLE);
    wanted.minima.iter().chain(&wanted.maxima).for_each(|extremum| role[extremum.index()] = EXTREMUM);
    let is_kept = |role: u8| match what {
        KeepAlso::Nothing => false,
        KeepAlso::Saddles => role == SADDLE,
        KeepAlso::Separatrices => role == PATH,
        KeepAlso::Both => role == SADDLE || role == PATH,
    };
    let kept = || role.iter().enumerate().filter(|&(_, &role)| is_kept(role));
    Ok(Kept {
        values: kept().map(|(vertex, _)| (VertexId::from(vertex), values[vertex])).collect(),
        saddles: kept().filter(|&(_, &role)| role == SADDLE).count(),
    })
}
