//! One set of wanted extrema, one smooth field: the stages after what all sets share.

use std::sync::Arc;

use crate::field::{Precision, VertexId};
use crate::mesh::SimplicialComplex;
use crate::monotone::{
    EnergyWeights, Fitter, Operators, Repaired, Strategy, ValueRule, energy_parts, repair,
};
use crate::morse::{Selection, WantedExtrema};

use super::error::SmoothError;
use super::guidance::Guidance;
use super::keep::kept_values;
use super::options::{ExtremumValues, KeepAlso, SelectOn, SmoothOptions};
use super::pipeline::{SmoothProgress, Smoothed};
use super::report::{
    ChangeReport, EnergyReport, ExtremumCount, KeptReport, LengthReport, RepairReport, SmoothReport, SolverReport, Timing,
};
use super::rounds::{Rounds, Solved};
use super::select::{MeasuredField, Selected, select_extrema};

/// What all selections of one field share.
pub(super) struct Shared<'a> {
    pub(super) data: &'a [f64],
    /// A power of two near the range of the data.
    pub(super) unit: f64,
    pub(super) weights: EnergyWeights<'a>,
    pub(super) length: LengthReport,
    pub(super) unconstrained: Vec<f64>,
    pub(super) before: ExtremumCount,
    pub(super) data_range: (f64, f64),
    pub(super) selected_on: Arc<MeasuredField>,
    pub(super) timing: Timing,
}

/// A field that obeys its rules, and how it was found.
struct Attempt {
    pinned: Vec<f64>,
    solved: Solved,
    repaired: Repaired,
}

/// The smooth field with the extrema of one selection.
pub(super) fn smooth_selected(
    fitter: &mut Fitter<'_>,
    shared: &Shared<'_>,
    selection: &Selection,
    options: &SmoothOptions<'_>,
    progress: &mut dyn FnMut(SmoothProgress),
) -> Result<Smoothed, SmoothError> {
    let complex = fitter.complex();
    let selected_on = &*shared.selected_on;
    let mut timing = shared.timing.clone();
    progress(SmoothProgress::Stage("selection"));
    let selected = timing.measure("selection", || select_extrema(complex, selected_on, selection))?;
    let mut rules = rules(selected_on, &selected.wanted, options);
    let work = Work { shared, selected: &selected, options };
    let mut attempt = work.attempt(fitter, &mut rules, &mut timing, progress)?;
    let mut kept_report = None;
    if options.keep_also != KeepAlso::Nothing {
        progress(SmoothProgress::Stage("values kept besides"));
        let kept = timing.measure("kept values", || {
            kept_values(complex, selected_on, &selected, options.precision, options.keep_also)
        })?;
        let without = attempt.solved.fit.energy;
        rules = kept.added_to(&rules);
        attempt = work.attempt_or_flood(fitter, &mut rules, &mut timing, progress)?;
        let with = attempt.solved.fit.energy;
        let (saddles, separatrix_vertices) = (kept.saddles, kept.values.len() - kept.saddles);
        let paid = with / without - 1.0;
        kept_report = Some(KeptReport { what: options.keep_also, saddles, separatrix_vertices, without, with, paid });
    }
    let Attempt { pinned, solved, repaired } = attempt;
    let values = keep_isolated(complex, shared.data, repaired.values.clone(), options.precision);

    // Squares of values can leave the range of numbers where the values do not: compare energies in units of the range.
    let (unit, operators) = (shared.unit, fitter.operators());
    let in_units = |field: &[f64]| field.iter().map(|value| value / unit).collect::<Vec<f64>>();
    let data_in_units = in_units(shared.data);
    let energy_of = |field: &[f64]| energy_parts(operators, &data_in_units, &shared.weights, &in_units(field));
    let total = |field: &[f64]| {
        let (smoothness, distance) = energy_of(field);
        smoothness + distance
    };
    let (smoothness, distance) = energy_of(&values);
    let (result, bound, free) = (smoothness + distance, total(&pinned), total(&shared.unconstrained));
    let square = |energy: f64| energy * unit * unit;
    let Solved { fit, guide, energies, iterations, factorizations } = solved;
    let report = SmoothReport {
        vertices: complex.vertex_count(),
        simplices: complex.simplex_count(),
        dimension: complex.dimension(),
        components: complex.components().1,
        data_range: shared.data_range,
        before: shared.before,
        select_on: options.select_on,
        selection_range: selected_on.range(),
        selection_extrema: ExtremumCount { minima: selected_on.minima.len(), maxima: selected_on.maxima.len() },
        threshold: selected_on.threshold(selection)?,
        wanted: ExtremumCount { minima: selected.wanted.minima.len(), maxima: selected.wanted.maxima.len() },
        unavoidable: selected.unavoidable.len(),
        kept_also: kept_report,
        order: options.order,
        length: shared.length,
        representative: guide.report,
        energy: EnergyReport {
            result: square(result),
            smoothness: square(smoothness),
            data: square(distance),
            unconstrained: square(free),
            bound: square(bound),
            above_bound: result / bound - 1.0,
            above_unconstrained: result / free - 1.0,
            rounds: energies,
        },
        solver: SolverReport {
            status: fit.status,
            rows: fit.rows,
            active_rows: fit.active_rows,
            iterations,
            factorizations,
            kkt: fit.kkt,
        },
        repair: RepairReport { moved: repaired.moved, largest_move: repaired.largest_move },
        precision: options.precision,
        change: change(operators, &data_in_units, &in_units(&values), shared.data_range, unit),
        timing,
    };
    Ok(Smoothed { values, wanted: selected.wanted, rules, selected_on: Arc::clone(&shared.selected_on), report })
}

/// From rules to a field that obeys them.
struct Work<'a> {
    shared: &'a Shared<'a>,
    selected: &'a Selected,
    options: &'a SmoothOptions<'a>,
}

impl Work<'_> {
    /// Pins, finds a guide, solves and repairs. Rules of extrema that nobody asked for are freed where they contradict.
    fn attempt(
        &self,
        fitter: &mut Fitter<'_>,
        rules: &mut [ValueRule],
        timing: &mut Timing,
        progress: &mut dyn FnMut(SmoothProgress),
    ) -> Result<Attempt, SmoothError> {
        let (shared, options) = (self.shared, self.options);
        let Selected { wanted, unavoidable } = self.selected;
        let complex = fitter.complex();
        progress(SmoothProgress::Stage("pinned field"));
        let mut pinned = timing.measure("pinned", || pinned_field(fitter, shared, rules, options))?;

        progress(SmoothProgress::Stage("representative function"));
        let make = Guidance { complex, selected_on: &shared.selected_on, wanted, options };
        let mut built = timing.measure("representative", || make.asked(&pinned, rules))?;
        let is_unavoidable = |vertex: VertexId| unavoidable.binary_search(&vertex).is_ok();
        if built.as_ref().is_err_and(|found| is_unavoidable(found.low) || is_unavoidable(found.high)) {
            // Nobody asked for these extrema: on a plateau their values would contradict their neighbours'.
            unavoidable.iter().for_each(|extremum| rules[extremum.index()] = ValueRule::Free);
            pinned = timing.measure("pinned", || pinned_field(fitter, shared, rules, options))?;
            built = timing.measure("representative", || make.asked(&pinned, rules))?;
        }
        let guide = match built {
            Ok(guide) => guide,
            Err(found) => timing.measure("representative", || make.instead(found, rules))?,
        };

        progress(SmoothProgress::Stage("quadratic problem"));
        let rounds = Rounds { data: shared.data, weights: shared.weights.clone(), wanted, rules, options };
        let solved = timing.measure("solve", || rounds.run(fitter, guide, &pinned, progress))?;

        progress(SmoothProgress::Stage("repair"));
        let repaired = timing
            .measure("repair", || repair(&solved.guide.graph, &solved.fit.values, rules, options.precision, options.strictness))
            .map_err(|found| SmoothError::not_representable(found, options.precision))?;
        Ok(Attempt { pinned, solved, repaired })
    }

    /// As [`Work::attempt`]; where the stored width has too few numbers for the order of the asked function between so many
    /// kept values, along the flood's, in which the simplified field itself fits.
    fn attempt_or_flood(
        &self,
        fitter: &mut Fitter<'_>,
        rules: &mut [ValueRule],
        timing: &mut Timing,
        progress: &mut dyn FnMut(SmoothProgress),
    ) -> Result<Attempt, SmoothError> {
        match self.attempt(fitter, rules, timing, progress) {
            Err(SmoothError::NotRepresentable { .. }) if self.options.strategy != Strategy::Flood => {
                let options = SmoothOptions { strategy: Strategy::Flood, refine: 0, ..self.options.clone() };
                let mut attempt = Work { options: &options, ..*self }.attempt(fitter, rules, timing, progress)?;
                let report = &mut attempt.solved.guide.report;
                report.asked = self.options.strategy;
                report.why = Some("its order leaves too few numbers of the stored width between the values kept besides".to_owned());
                Ok(attempt)
            }
            result => result,
        }
    }
}

fn rules(field: &MeasuredField, wanted: &WantedExtrema, options: &SmoothOptions<'_>) -> Vec<ValueRule> {
    let (low, high) = field.range();
    let mut rules = vec![ValueRule::Free; field.values.len()];
    for &extremum in wanted.minima.iter().chain(&wanted.maxima) {
        let value = options.precision.round(field.values[extremum.index()]);
        rules[extremum.index()] = match options.values {
            ExtremumValues::Keep => ValueRule::Exactly(value),
            ExtremumValues::Free => ValueRule::Free,
            ExtremumValues::Within(0.0) => ValueRule::Exactly(value),
            ExtremumValues::Within(part) => {
                let half = part * (high - low);
                ValueRule::Within(value - half, value + half)
            }
        };
    }
    rules
}

/// The field of least energy with the wanted values pinned: the lower bound of the ideal problem.
fn pinned_field(
    fitter: &mut Fitter<'_>,
    shared: &Shared<'_>,
    rules: &[ValueRule],
    options: &SmoothOptions<'_>,
) -> Result<Vec<f64>, SmoothError> {
    let pins: Vec<Option<f64>> = rules
        .iter()
        .map(|rule| match rule {
            ValueRule::Exactly(value) => Some(*value),
            ValueRule::Free | ValueRule::Within(..) => None,
        })
        .collect();
    // Values of the unconstrained field pinned to themselves change nothing but its last bits.
    let is_its_own = options.select_on == SelectOn::Smooth && options.keep_also == KeepAlso::Nothing;
    if is_its_own || pins.iter().all(Option::is_none) {
        return Ok(shared.unconstrained.clone());
    }
    Ok(fitter.minimiser(shared.data, &shared.weights, &pins)?)
}

fn keep_isolated(complex: &SimplicialComplex, data: &[f64], mut values: Vec<f64>, precision: Precision) -> Vec<f64> {
    for vertex in 0..values.len() {
        if complex.neighbours(vertex.into()).is_empty() {
            values[vertex] = precision.round(data[vertex]);
        }
    }
    values
}

fn change(operators: &Operators, data: &[f64], values: &[f64], (low, high): (f64, f64), unit: f64) -> ChangeReport {
    let (mut square, mut mass, mut largest) = (0.0, 0.0, 0.0f64);
    for i in 0..data.len() {
        let difference = values[i] - data[i];
        square += operators.mass[i] * difference * difference;
        mass += operators.mass[i];
        largest = largest.max(difference.abs());
    }
    let rms = (square / mass).sqrt() * unit;
    ChangeReport { rms, largest: largest * unit, rms_of_range: if high > low { rms / (high - low) } else { 0.0 } }
}
