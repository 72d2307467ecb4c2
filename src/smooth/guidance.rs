//! From a representative function to a guide: its monotonicity edges and levels, or another function in its place.

use crate::field::VertexOrder;
use crate::mesh::SimplicialComplex;
use crate::monotone::{
    Contradiction, Levels, MonotonicityGraph, Representative, Strategy, ValueRule, harmonic, levels, representative, separatrix,
};
use crate::morse::WantedExtrema;

use super::error::SmoothError;
use super::options::SmoothOptions;
use super::report::RepresentativeReport;
use super::select::MeasuredField;

/// A representative function that suits the wanted values: its edges and levels.
pub(super) struct Guide {
    pub(super) graph: MonotonicityGraph,
    pub(super) levels: Levels,
    pub(super) report: RepresentativeReport,
}

/// From representative functions to guides.
pub(super) struct Guidance<'a> {
    pub(super) complex: &'a SimplicialComplex,
    pub(super) selected_on: &'a MeasuredField,
    pub(super) wanted: &'a WantedExtrema,
    pub(super) options: &'a SmoothOptions<'a>,
}

impl Guidance<'_> {
    /// The representative function asked for, or the two wanted values that its order contradicts.
    pub(super) fn asked(&self, pinned: &[f64], rules: &[ValueRule]) -> Result<Result<Guide, Contradiction>, SmoothError> {
        let (complex, field, wanted) = (self.complex, self.selected_on, self.wanted);
        let function = match self.options.strategy {
            Strategy::SmoothThenSimplify => representative(complex, &VertexOrder::of_values(pinned)?, wanted)?,
            Strategy::Flood => representative(complex, &field.order, wanted)?,
            Strategy::Separatrix => separatrix(complex, &field.values, &field.order, wanted)?,
            Strategy::Harmonic => harmonic(complex, wanted)?,
        };
        let why = function.replaced.then(|| "the flood of its order did not settle".to_owned());
        let used = if function.replaced { Strategy::Harmonic } else { self.options.strategy };
        Ok(self.guide(function, rules, used, why))
    }

    /// Another function for wanted values that contradict the one asked for: the separatrices of the field on which they were
    /// measured, and if those contradict them as well, its flood, which cannot.
    pub(super) fn instead(&self, found: Contradiction, rules: &[ValueRule]) -> Result<Guide, SmoothError> {
        let (complex, field, wanted) = (self.complex, self.selected_on, self.wanted);
        if self.options.strategy == Strategy::Flood {
            return Err(found.into());
        }
        let why = format!(
            "in its order vertex {} (value {:?}) lies below vertex {} (value {:?})",
            found.low, found.low_value, found.high, found.high_value
        );
        if self.options.strategy != Strategy::Separatrix {
            // On measured terrain half as far from the optimum as the flood.
            let function = separatrix(complex, &field.values, &field.order, wanted)?;
            if let Ok(guide) = self.guide(function, rules, Strategy::Separatrix, Some(why.clone())) {
                return Ok(guide);
            }
        }
        let function = representative(complex, &field.order, wanted)?;
        Ok(self.guide(function, rules, Strategy::Flood, Some(why))?)
    }

    fn guide(
        &self,
        function: Representative,
        rules: &[ValueRule],
        used: Strategy,
        why: Option<String>,
    ) -> Result<Guide, Contradiction> {
        let graph = MonotonicityGraph::new(self.complex, &function.order, self.wanted, self.options.edges);
        let report = RepresentativeReport { asked: self.options.strategy, used, why, passes: function.passes };
        levels(&graph, rules, level_range(self.selected_on, rules)).map(|levels| Guide { graph, levels, report })
    }
}

/// Bounds for vertices that no wanted value bounds.
fn level_range(field: &MeasuredField, rules: &[ValueRule]) -> (f64, f64) {
    rules.iter().fold(field.range(), |(low, high), rule| match rule.bounds() {
        (least, greatest) if least.is_finite() && greatest.is_finite() => (low.min(least), high.max(greatest)),
        _ => (low, high),
    })
}
