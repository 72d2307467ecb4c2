//! From a noisy field to a smooth one: the stages in order.

use crate::field::{VertexId, VertexOrder};
use crate::mesh::SimplicialComplex;
use crate::monotone::{
    Contradiction, EnergyWeights, Fitter, Levels, MonotoneConstraints, MonotoneFit, MonotonicityGraph, Operators, Precision, Repaired,
    Representative, Strategy, Strictness, ValueRule, energy_parts, harmonic, levels, repair, representative, separatrix,
};
use crate::morse::{Selection, WantedExtrema};
use crate::qp::{Progress, Settings};

use super::checks::{check_confidence, check_options, check_power, constant_components, unit};
use super::error::SmoothError;
use super::length::cross_validated_length;
use super::options::{ExtremumValues, Length, SelectOn, SmoothOptions};
use super::report::{
    ChangeReport, EnergyReport, ExtremumCount, LengthReport, RepairReport, RepresentativeReport, SmoothReport, SolverReport,
    Timing,
};
use super::select::{MeasuredField, Selected, select_extrema};

/// Shortest automatic length, in mean edges: shorter ones leave the noise between neighbours as it is.
const SHORTEST_EDGES: f64 = 1.5;

/// Margins of the order constraints, as parts of the differences of levels: small against the energy, large against the
/// rounding of the stored width (prototype: 1e-4 leaves no tie in 32 bits, at +9e-5 of the energy).
const MARGIN_F32: f64 = 1e-4;
const MARGIN_F64: f64 = 1e-6;

/// What [`smooth`] is doing.
#[derive(Debug, Clone)]
pub enum SmoothProgress {
    /// It begins a stage.
    Stage(&'static str),
    /// The solver finished an iteration.
    Solver(Progress),
}

/// A smooth field with exactly the wanted extrema, and the evidence.
#[derive(Debug, Clone)]
pub struct Smoothed {
    /// `n` values of the asked width.
    pub values: Vec<f64>,
    /// The extrema that were wanted, and that the values have.
    pub wanted: WantedExtrema,
    /// What was asked of the value at each vertex.
    pub rules: Vec<ValueRule>,
    /// The field on which extrema were selected, with its extremum pairs.
    pub selected_on: MeasuredField,
    /// What was measured.
    pub report: SmoothReport,
}

/// A representative function that suits the wanted values: its edges and levels.
struct Guide {
    graph: MonotonicityGraph,
    levels: Levels,
    report: RepresentativeReport,
}

/// Smooths a field so that it has exactly the wanted minima and maxima.
///
/// # Arguments
/// * `data`: `n` finite values, one a vertex of `complex`.
/// * `progress`: told of every stage and solver iteration.
///
/// # Returns
/// Values of the asked precision whose extrema under (value, vertex index) are exactly the wanted ones; and unless
/// [`Strictness::TiesByIndex`] was asked, every other vertex has a strictly smaller and a strictly greater neighbour.
/// This holds however the solver ended; `report.solver.status` says whether they are also optimal. Vertices without
/// neighbours keep their value.
///
/// # Errors
/// [`SmoothError`].
///
/// # Cost
/// With automatic length about a dozen factorisations, then one an iteration of the solver, 10 to 25.
///
/// # Source
/// Jacobson, Weinkauf, Sorkine 2012, section 3.
pub fn smooth(
    complex: &SimplicialComplex,
    data: &[f64],
    options: &SmoothOptions<'_>,
    progress: &mut dyn FnMut(SmoothProgress),
) -> Result<Smoothed, SmoothError> {
    check_options(complex, data, options)?;
    let mut timing = Timing::default();
    progress(SmoothProgress::Stage("extrema of the data"));
    let measured = timing.measure("extrema", || MeasuredField::new(complex, data.to_vec()))?;
    if let Some(constant) = constant_components(complex, data).first() {
        return Err(SmoothError::Constant { vertex: constant[0], vertices: constant.len(), value: data[constant[0].index()] });
    }
    check_confidence(complex, options.confidence)?;
    let unit = unit(measured.range())?;

    progress(SmoothProgress::Stage("operators"));
    let operators = timing.measure("operators", || Operators::new(complex))?;
    let mut fitter = timing.measure("analysis", || Fitter::new(complex, &operators, options.order))?;

    progress(SmoothProgress::Stage("smoothing length"));
    let length = timing.measure("length", || resolve_length(&mut fitter, data, unit, options))?;
    let weights = EnergyWeights {
        order: options.order,
        length: length.absolute,
        confidence: options.confidence,
        smoothness: options.smoothness,
    };
    progress(SmoothProgress::Stage("unconstrained field"));
    let unconstrained = timing.measure("unconstrained", || fitter.minimiser(data, &weights, &vec![None; data.len()]))?;

    progress(SmoothProgress::Stage("selection"));
    let before = count(&measured);
    let data_range = measured.range();
    let selected_on = match options.select_on {
        SelectOn::Data => measured,
        SelectOn::Smooth => timing.measure("extrema", || MeasuredField::new(complex, unconstrained.clone()))?,
    };
    if let Some(constant) = constant_components(complex, &selected_on.values).first() {
        let (vertex, vertices) = (constant[0], constant.len());
        return Err(SmoothError::SmoothedAway { vertex, vertices, value: selected_on.values[vertex.index()] });
    }
    let Selected { wanted, unavoidable } = timing.measure("selection", || select_extrema(complex, &selected_on, &options.selection))?;
    let mut rules = rules(&selected_on, &wanted, options);

    progress(SmoothProgress::Stage("pinned field"));
    let mut pin = |rules: &[ValueRule], timing: &mut Timing| {
        timing.measure("pinned", || pinned_field(&mut fitter, data, &weights, rules, options, &unconstrained))
    };
    let mut pinned = pin(&rules, &mut timing)?;

    progress(SmoothProgress::Stage("representative function"));
    let make = Guidance { complex, selected_on: &selected_on, wanted: &wanted, options };
    let mut built = timing.measure("representative", || make.asked(&pinned, &rules))?;
    let is_unavoidable = |vertex: VertexId| unavoidable.binary_search(&vertex).is_ok();
    if built.as_ref().is_err_and(|found| is_unavoidable(found.low) || is_unavoidable(found.high)) {
        // Nobody asked for these extrema: on a plateau their values would contradict their neighbours'.
        unavoidable.iter().for_each(|extremum| rules[extremum.index()] = ValueRule::Free);
        pinned = pin(&rules, &mut timing)?;
        built = timing.measure("representative", || make.asked(&pinned, &rules))?;
    }
    let guide = match built {
        Ok(guide) => guide,
        Err(found) => timing.measure("representative", || make.instead(found, &rules))?,
    };

    progress(SmoothProgress::Stage("quadratic problem"));
    let rounds = Rounds { data, weights: weights.clone(), wanted: &wanted, rules: &rules, options };
    let Solved { fit, guide, energies, iterations, factorizations } =
        timing.measure("solve", || rounds.run(&mut fitter, guide, &pinned, progress))?;

    progress(SmoothProgress::Stage("repair"));
    let repaired = timing
        .measure("repair", || repair(&guide.graph, &fit.values, &rules, options.precision, options.strictness))
        .map_err(|found| SmoothError::not_representable(found, options.precision))?;
    let values = keep_isolated(complex, data, repaired.values.clone(), options.precision);

    // Squares of values can leave the range of numbers where the values do not: compare energies in units of the range.
    let in_units = |field: &[f64]| field.iter().map(|value| value / unit).collect::<Vec<f64>>();
    let data_in_units = in_units(data);
    let energy_of = |field: &[f64]| energy_parts(&operators, &data_in_units, &weights, &in_units(field));
    let total = |field: &[f64]| {
        let (smoothness, distance) = energy_of(field);
        smoothness + distance
    };
    let (smoothness, distance) = energy_of(&values);
    let (result, bound, free) = (smoothness + distance, total(&pinned), total(&unconstrained));
    let square = |energy: f64| energy * unit * unit;
    let report = SmoothReport {
        vertices: complex.vertex_count(),
        simplices: complex.simplex_count(),
        dimension: complex.dimension(),
        components: complex.components().1,
        data_range,
        before,
        select_on: options.select_on,
        selection_range: selected_on.range(),
        selection_extrema: count(&selected_on),
        threshold: threshold(&selected_on, &options.selection)?,
        wanted: ExtremumCount { minima: wanted.minima.len(), maxima: wanted.maxima.len() },
        unavoidable: unavoidable.len(),
        order: options.order,
        length,
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
        repair: repair_report(&repaired),
        precision: options.precision,
        change: change(&operators, &data_in_units, &in_units(&values), data_range, unit),
        timing,
    };
    Ok(Smoothed { values, wanted, rules, selected_on, report })
}

fn resolve_length(
    fitter: &mut Fitter<'_>,
    data: &[f64],
    unit: f64,
    options: &SmoothOptions<'_>,
) -> Result<LengthReport, SmoothError> {
    let diagonal = fitter.complex().bounding_box_diagonal();
    let report = |absolute: f64, noise: Option<f64>| LengthReport {
        absolute,
        of_diagonal: absolute / diagonal,
        automatic: false,
        noise,
    };
    let given = |absolute: f64| check_power(absolute, options.order).map(|()| report(absolute, None));
    Ok(match options.length {
        Length::Absolute(length) => given(length)?,
        Length::OfDiagonal(fraction) => given(fraction * diagonal)?,
        Length::Automatic => {
            let weights = EnergyWeights {
                order: options.order,
                length: 0.0,
                confidence: options.confidence,
                smoothness: options.smoothness,
            };
            let shortest = SHORTEST_EDGES * mean_edge(fitter.complex());
            let longest = 0.25 * diagonal.max(4.0 * shortest);
            check_power(shortest, options.order)?;
            check_power(longest, options.order)?;
            let in_units: Vec<f64> = data.iter().map(|value| value / unit).collect();
            let chosen = cross_validated_length(fitter, &in_units, &weights, (shortest, longest))?;
            LengthReport { automatic: true, ..report(chosen.length, chosen.noise.map(|noise| noise * unit)) }
        }
    })
}

fn mean_edge(complex: &SimplicialComplex) -> f64 {
    let length = |&[a, b]: &[VertexId; 2]| {
        let (a, b) = (complex.point(a), complex.point(b));
        (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
    };
    complex.edges().iter().map(length).sum::<f64>() / complex.edges().len().max(1) as f64
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
    data: &[f64],
    weights: &EnergyWeights<'_>,
    rules: &[ValueRule],
    options: &SmoothOptions<'_>,
    unconstrained: &[f64],
) -> Result<Vec<f64>, SmoothError> {
    let pins: Vec<Option<f64>> = rules
        .iter()
        .map(|rule| match rule {
            ValueRule::Exactly(value) => Some(*value),
            ValueRule::Free | ValueRule::Within(..) => None,
        })
        .collect();
    // Values of the unconstrained field pinned to themselves change nothing but its last bits.
    if options.select_on == SelectOn::Smooth || pins.iter().all(Option::is_none) {
        return Ok(unconstrained.to_vec());
    }
    Ok(fitter.minimiser(data, weights, &pins)?)
}

/// From representative functions to guides.
struct Guidance<'a> {
    complex: &'a SimplicialComplex,
    selected_on: &'a MeasuredField,
    wanted: &'a WantedExtrema,
    options: &'a SmoothOptions<'a>,
}

impl Guidance<'_> {
    /// The representative function asked for, or the two wanted values that its order contradicts.
    fn asked(&self, pinned: &[f64], rules: &[ValueRule]) -> Result<Result<Guide, Contradiction>, SmoothError> {
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
    fn instead(&self, found: Contradiction, rules: &[ValueRule]) -> Result<Guide, SmoothError> {
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

/// What the rounds of solves ended with.
struct Solved {
    /// The last round's solution.
    fit: MonotoneFit,
    /// The last round's guide: the solution rises along its edges.
    guide: Guide,
    /// Energy after each round.
    energies: Vec<f64>,
    iterations: usize,
    factorizations: usize,
}

/// The convex problem, and its repetition with the solution as representative function.
struct Rounds<'a> {
    data: &'a [f64],
    weights: EnergyWeights<'a>,
    wanted: &'a WantedExtrema,
    rules: &'a [ValueRule],
    options: &'a SmoothOptions<'a>,
}

impl Rounds<'_> {
    /// Solves along the guide's edges, then refines as often as was asked.
    ///
    /// # Source
    /// Refinement: Günther, Jacobson, Reininghaus, Seidel, Sorkine-Hornung, Weinkauf 2014.
    fn run(
        &self,
        fitter: &mut Fitter<'_>,
        guide: Guide,
        near: &[f64],
        progress: &mut dyn FnMut(SmoothProgress),
    ) -> Result<Solved, SmoothError> {
        let fit = self.solve(fitter, &guide, near, None, progress)?;
        let (iterations, factorizations) = (fit.iterations, fit.factorizations);
        let mut solved = Solved { energies: vec![fit.energy], iterations, factorizations, fit, guide };
        for _ in 0..self.options.refine {
            let Some(guide) = self.refined_guide(fitter.complex(), &solved)? else { break };
            let last = &solved.fit.values;
            let fit = self.solve(fitter, &guide, last, Some(last), progress)?;
            let gain = solved.fit.energy - fit.energy;
            solved.energies.push(fit.energy);
            solved.iterations += fit.iterations;
            solved.factorizations += fit.factorizations;
            (solved.fit, solved.guide) = (fit, guide);
            // What the solver cannot tell apart is no progress.
            if gain <= self.options.relative_gap * solved.fit.energy {
                break;
            }
        }
        Ok(solved)
    }

    fn solve(
        &self,
        fitter: &mut Fitter<'_>,
        guide: &Guide,
        near: &[f64],
        feasible: Option<&[f64]>,
        progress: &mut dyn FnMut(SmoothProgress),
    ) -> Result<MonotoneFit, SmoothError> {
        let margin = match (self.options.strictness, self.options.precision) {
            (Strictness::TiesByIndex, _) => 0.0,
            (Strictness::Plain, Precision::F32) => MARGIN_F32,
            (Strictness::Plain, Precision::F64) => MARGIN_F64,
        };
        let constraints =
            MonotoneConstraints { graph: &guide.graph, levels: &guide.levels, rules: self.rules, margin, feasible };
        let settings = Settings { relative_gap: self.options.relative_gap, ..Settings::default() };
        let report = &mut |step| progress(SmoothProgress::Solver(step));
        Ok(fitter.monotone(self.data, &self.weights, &constraints, near, &settings, report)?)
    }

    /// The last solution, made strict, as the next representative function; `None` if its levels leave no room.
    fn refined_guide(&self, complex: &SimplicialComplex, solved: &Solved) -> Result<Option<Guide>, SmoothError> {
        let strict = repair(&solved.guide.graph, &solved.fit.values, self.rules, Precision::F64, Strictness::Plain)
            .map_err(|found| SmoothError::not_representable(found, Precision::F64))?;
        let order = VertexOrder::of_values(&strict.values)?;
        let graph = MonotonicityGraph::new(complex, &order, self.wanted, self.options.edges);
        let levels = levels(&graph, self.rules, solved.guide.levels.range()).ok();
        Ok(levels.map(|levels| Guide { graph, levels, report: solved.guide.report.clone() }))
    }
}

fn keep_isolated(complex: &SimplicialComplex, data: &[f64], mut values: Vec<f64>, precision: Precision) -> Vec<f64> {
    for vertex in 0..values.len() {
        if complex.neighbours(vertex.into()).is_empty() {
            values[vertex] = precision.round(data[vertex]);
        }
    }
    values
}

fn count(field: &MeasuredField) -> ExtremumCount {
    ExtremumCount { minima: field.minima.len(), maxima: field.maxima.len() }
}

fn threshold(field: &MeasuredField, selection: &Selection) -> Result<Option<f64>, SmoothError> {
    let (low, high) = field.range();
    match selection {
        Selection::Threshold(threshold) => Ok(Some(threshold.resolve(high - low)?)),
        Selection::Count(_) | Selection::Set(_) => Ok(None),
    }
}

fn repair_report(repaired: &Repaired) -> RepairReport {
    RepairReport { moved: repaired.moved, largest_move: repaired.largest_move }
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
