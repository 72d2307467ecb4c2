//! Topology by hand: exactly the wanted extrema, whose values are given, bounded or free; with or without data to stay close to.
//!
//! Literature: Jacobson, Weinkauf, Sorkine 2012, eq. 12–14; without data the data term is left out.

use crate::field::{Precision, VertexId, VertexOrder};
use crate::mesh::SimplicialComplex;
use crate::monotone::{
    Contradiction, EdgeSet, EnergyWeights, Fitter, Levels, MonotoneConstraints, MonotoneFit, MonotonicityGraph, Representative,
    RepresentativeError, Strictness, ValueRule, harmonic, levels, repair, representative,
};
use crate::morse::WantedExtrema;
use crate::qp::Settings;

use super::InterpolateError;
use super::interpolator::{InterpolateReport, Interpolated, Interpolator};
use super::method::{Guide, InterpolateOptions};

/// Margins of the order constraints, as in [`Interpolator`].
const MARGIN_F32: f64 = 1e-4;
const MARGIN_F64: f64 = 1e-6;
/// Room beyond the known values for levels of extrema whose value is free, in parts of the range of the known ones.
const ROOM: f64 = 0.25;

/// Data that a function stays close to.
#[derive(Debug, Clone, Copy)]
pub struct Nearness<'a> {
    /// `n` finite values; what they are where the confidence is 0 says nothing.
    pub data: &'a [f64],
    /// Smoothing length l in the units of the points, positive.
    pub length: f64,
    /// Confidence in each value, `n` numbers not below 0, one above at least; 1 everywhere if absent.
    pub confidence: Option<&'a [f64]>,
}

/// The function of least energy with exactly the wanted extrema, whose values are fixed, within intervals, or free.
///
/// ```text
/// minimise fᵀ (L M⁻¹)^(k-1) L f   subject to   f_i = g_i or lo_i ≤ f_i ≤ hi_i at wanted extrema,   f_i < f_j along monotonicity edges
/// ```
///
/// # Arguments
/// * `wanted`: the extrema.
/// * `rules`: `n` rules; those of vertices that are no wanted extremum are free.
///
/// # Returns
/// A function whose extrema under plain `<` in the stored width are exactly the wanted ones, whatever its status.
///
/// # Errors
/// [`InterpolateError::NoScale`] where no minimum, or no maximum, of a connected part is fixed or bounded;
/// [`InterpolateError::Representative`] where no function has these extrema; [`InterpolateError::Contradiction`] with the two values that
/// leave no room.
///
/// # Cost
/// An ordering and analysis, then a factorisation an iteration, 10 to 30.
///
/// # Source
/// Jacobson, Weinkauf, Sorkine 2012, eq. 12–14 and section 3.3.
pub fn interpolate_wanted(
    interpolator: &Interpolator<'_>,
    wanted: &WantedExtrema,
    rules: &[ValueRule],
    options: &InterpolateOptions,
) -> Result<Interpolated, InterpolateError> {
    let complex = interpolator.complex();
    let n = complex.vertex_count();
    check_count("rules", rules.len(), n)?;
    check_scale(complex, wanted, rules, |_| false)?;
    let (low, high) = known_range(rules);
    let mass: f64 = interpolator.operators().mass.iter().sum();
    let spacing = (mass / n.max(1) as f64).powf(1.0 / complex.dimension() as f64);
    // Without confidence the data only say in which units the solver works.
    let mut data = vec![low; n];
    data[0] = high;
    let nothing = Nearness { data: &data, length: spacing, confidence: Some(&vec![0.0; n]) };
    by_hand(interpolator, (wanted, rules), &nothing, (low, high), options)
}

/// As [`interpolate_wanted`], and as close to data as the extrema allow.
///
/// ```text
/// minimise Σ c_i m_i (f_i - h_i)² + l^2k fᵀ (L M⁻¹)^(k-1) L f   subject to the same
/// ```
///
/// # Arguments
/// * `wanted`, `rules`: as for [`interpolate_wanted`]; every value may be free.
/// * `near`: the data h, the confidence c and the smoothing length l.
///
/// # Returns
/// A function as that of [`interpolate_wanted`]; the energy of its report is that of smoothness alone.
///
/// # Errors
/// As [`interpolate_wanted`], [`InterpolateError::NoScale`] only where a part has no data; [`InterpolateError::Nearness`] for a length, a value or a confidence that
/// is out of range.
///
/// # Cost
/// As [`interpolate_wanted`].
///
/// # Source
/// Jacobson, Weinkauf, Sorkine 2012, eq. 12–14, with the data term of their section 3.1.
pub fn interpolate_near(
    interpolator: &Interpolator<'_>,
    wanted: &WantedExtrema,
    rules: &[ValueRule],
    near: &Nearness<'_>,
    options: &InterpolateOptions,
) -> Result<Interpolated, InterpolateError> {
    let complex = interpolator.complex();
    let n = complex.vertex_count();
    check_count("rules", rules.len(), n)?;
    check_nearness(near, n)?;
    let trusted = |vertex: &usize| near.confidence.is_none_or(|confidence| confidence[*vertex] > 0.0);
    // A part without any data hangs on given values, as without data at all.
    check_scale(complex, wanted, rules, |vertex| trusted(&vertex))?;
    let (mut low, mut high) = known_range(rules);
    for vertex in (0..n).filter(trusted) {
        (low, high) = (low.min(near.data[vertex]), high.max(near.data[vertex]));
    }
    by_hand(interpolator, (wanted, rules), near, (low, high), options)
}

fn by_hand(
    interpolator: &Interpolator<'_>,
    (wanted, rules): (&WantedExtrema, &[ValueRule]),
    near_to: &Nearness<'_>,
    (low, high): (f64, f64),
    options: &InterpolateOptions,
) -> Result<Interpolated, InterpolateError> {
    let complex = interpolator.complex();
    let clock = std::time::Instant::now();
    let unit = if high > low { high - low } else { 1.0 };
    let operators = interpolator.operators();
    let data = near_to.data;
    let weights =
        EnergyWeights { order: interpolator.order(), length: near_to.length, confidence: near_to.confidence, smoothness: None };
    let mut fitter = Fitter::new(complex, operators, interpolator.order())?;
    let pinned = near(&mut fitter, data, &weights, rules)?;
    let work = Work { complex, wanted, rules, options, range: (low - ROOM * unit, high + ROOM * unit) };
    let asked: &[Guide] = match options.guide {
        Guide::Automatic if interpolator.order() > 2 => &[Guide::SmoothThenSimplify, Guide::Harmonic],
        Guide::Automatic | Guide::SmoothThenSimplify => &[Guide::SmoothThenSimplify],
        Guide::Harmonic => &[Guide::Harmonic],
    };
    let (mut best, mut refusal, mut iterations, mut factorizations) = (None, None, 0, 0);
    for &asked in asked {
        let (guide, replaced) = match work.guide(asked, &pinned) {
            Ok(found) => found,
            Err(error) => {
                refusal = refusal.or(Some(error));
                continue;
            }
        };
        let fit = work.solve(&mut fitter, (data, &weights), &guide, &pinned, None)?;
        iterations += fit.iterations;
        factorizations += fit.factorizations;
        let is_better = |(_, _, least): &(Along, bool, MonotoneFit)| fit.energy < least.energy;
        if best.as_ref().is_none_or(is_better) {
            best = Some((guide, replaced, fit));
        }
    }
    let Some((mut guide, replaced, mut fit)) = best else {
        // No guide at all: the list of them is not empty.
        return Err(refusal.unwrap_or(InterpolateError::Count { what: "guides", found: 0, expected: 1 }));
    };
    let mut rounds = vec![fit.energy];
    for _ in 0..options.refine {
        let strict = work.strict(&guide.0, &fit, Precision::F64)?;
        let Ok(next_guide) = work.along(VertexOrder::of_values(&strict)?) else { break };
        let next = work.solve(&mut fitter, (data, &weights), &next_guide, &fit.values, Some(&fit.values))?;
        iterations += next.iterations;
        factorizations += next.factorizations;
        let gain = fit.energy - next.energy;
        if gain <= 0.0 {
            break;
        }
        rounds.push(next.energy);
        (fit, guide) = (next, next_guide);
        if gain <= options.relative_gap * fit.energy {
            break;
        }
    }
    let values = work.strict(&guide.0, &fit, options.precision)?;
    let largest_repair = values.iter().zip(&fit.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let report = InterpolateReport {
        energy: interpolator.energy(&values),
        residual: fit.kkt.backward,
        gap: fit.kkt.duality_gap,
        rows: fit.rows,
        active_rows: fit.active_rows,
        iterations,
        factorizations,
        minima: wanted.minima.clone(),
        maxima: wanted.maxima.clone(),
        guide_replaced: replaced,
        rounds,
        largest_repair,
        status: fit.status,
        seconds: clock.elapsed().as_secs_f64(),
        ..InterpolateReport::solved()
    };
    Ok(Interpolated { values, report })
}

struct Work<'a> {
    complex: &'a SimplicialComplex,
    wanted: &'a WantedExtrema,
    rules: &'a [ValueRule],
    options: &'a InterpolateOptions,
    range: (f64, f64),
}

type Along = (MonotonicityGraph, Levels);

impl Work<'_> {
    /// Directions from the smooth function, or, where the wanted values contradict its order, from the harmonic one.
    fn guide(&self, asked: Guide, pinned: &[f64]) -> Result<(Along, bool), InterpolateError> {
        let smooth = || representative(self.complex, &VertexOrder::of_values(pinned)?, self.wanted);
        let by = |is_harmonic: bool| -> Result<Representative, RepresentativeError> {
            if is_harmonic { harmonic(self.complex, self.wanted) } else { smooth() }
        };
        let is_harmonic = asked == Guide::Harmonic;
        let asked = by(is_harmonic)?;
        let found = match self.along(asked.order) {
            Ok(along) => return Ok((along, asked.replaced)),
            Err(found) => found,
        };
        let other = by(!is_harmonic)?;
        self.along(other.order).map(|along| (along, true)).map_err(|_| InterpolateError::Contradiction {
            low: found.low,
            low_value: found.low_value,
            high: found.high,
            high_value: found.high_value,
        })
    }

    fn along(&self, order: VertexOrder) -> Result<Along, Contradiction> {
        let graph = MonotonicityGraph::new(self.complex, &order, self.wanted, EdgeSet::Minimal);
        levels(&graph, self.rules, self.range).map(|levels| (graph, levels))
    }

    fn solve(
        &self,
        fitter: &mut Fitter<'_>,
        (data, weights): (&[f64], &EnergyWeights<'_>),
        (graph, levels): &Along,
        near: &[f64],
        feasible: Option<&[f64]>,
    ) -> Result<MonotoneFit, InterpolateError> {
        let margin = match self.options.precision {
            Precision::F32 => MARGIN_F32,
            Precision::F64 => MARGIN_F64,
        };
        let constraints = MonotoneConstraints { graph, levels, rules: self.rules, margin, feasible };
        let settings = Settings { relative_gap: self.options.relative_gap, ..Settings::default() };
        Ok(fitter.monotone(data, weights, &constraints, near, &settings, &mut |_| {})?)
    }

    fn strict(&self, graph: &MonotonicityGraph, fit: &MonotoneFit, precision: Precision) -> Result<Vec<f64>, InterpolateError> {
        repair(graph, &fit.values, self.rules, precision, Strictness::Plain)
            .map(|repaired| repaired.values)
            .map_err(|found| InterpolateError::NotRepresentable { vertex: found.vertex })
    }
}

/// The minimiser with the fixed values; where it leaves an interval, or nothing is fixed in a part, values of intervals are fixed as well.
fn near(
    fitter: &mut Fitter<'_>,
    data: &[f64],
    weights: &EnergyWeights<'_>,
    rules: &[ValueRule],
) -> Result<Vec<f64>, InterpolateError> {
    let (component, parts) = fitter.complex().components();
    let mut is_fixed = vec![false; parts];
    let exact = |rule: &ValueRule| if let ValueRule::Exactly(value) = rule { Some(*value) } else { None };
    let mut pins: Vec<Option<f64>> = rules.iter().map(exact).collect();
    pins.iter().zip(&component).filter(|(pin, _)| pin.is_some()).for_each(|(_, &part)| is_fixed[part as usize] = true);
    for (vertex, rule) in rules.iter().enumerate() {
        if let (ValueRule::Within(low, high), false) = (rule, is_fixed[component[vertex] as usize]) {
            pins[vertex] = Some(0.5 * (low + high));
        }
    }
    let found = fitter.minimiser(data, weights, &pins)?;
    let mut changed = false;
    for (vertex, rule) in rules.iter().enumerate() {
        if let (ValueRule::Within(low, high), None) = (rule, pins[vertex])
            && !(*low..=*high).contains(&found[vertex])
        {
            pins[vertex] = Some(found[vertex].clamp(*low, *high));
            changed = true;
        }
    }
    if changed { Ok(fitter.minimiser(data, weights, &pins)?) } else { Ok(found) }
}

fn check_count(what: &'static str, found: usize, expected: usize) -> Result<(), InterpolateError> {
    if found == expected { Ok(()) } else { Err(InterpolateError::Count { what, found, expected }) }
}

fn check_nearness(near: &Nearness<'_>, n: usize) -> Result<(), InterpolateError> {
    check_count("data", near.data.len(), n)?;
    let refuse = |what: &'static str, place: usize, value: f64, expected: &'static str| {
        Err(InterpolateError::Nearness { what, place, value, expected })
    };
    if !(near.length > 0.0 && near.length.is_finite()) {
        return refuse("length", 0, near.length, "a positive number");
    }
    if let Some(vertex) = near.data.iter().position(|value| !value.is_finite()) {
        return refuse("data", vertex, near.data[vertex], "a finite number");
    }
    let Some(confidence) = near.confidence else { return Ok(()) };
    check_count("confidence", confidence.len(), n)?;
    match confidence.iter().position(|&value| !(value >= 0.0 && value.is_finite())) {
        Some(vertex) => refuse("confidence", vertex, confidence[vertex], "a number not below 0"),
        None if confidence.iter().all(|&value| value == 0.0) => refuse("confidence", 0, 0.0, "one above 0 at least"),
        None => Ok(()),
    }
}

/// Every connected part without data needs a minimum and a maximum that are fixed or bounded.
fn check_scale(
    complex: &SimplicialComplex,
    wanted: &WantedExtrema,
    rules: &[ValueRule],
    has_data: impl Fn(usize) -> bool,
) -> Result<(), InterpolateError> {
    let (component, parts) = complex.components();
    let mut is_held = vec![false; parts];
    component.iter().enumerate().filter(|(vertex, _)| has_data(*vertex)).for_each(|(_, &part)| is_held[part as usize] = true);
    for (kind, vertices) in [("minimum", &wanted.minima), ("maximum", &wanted.maxima)] {
        let mut is_bounded = is_held.clone();
        let has_rule = |vertex: &&VertexId| rules[vertex.index()] != ValueRule::Free;
        vertices.iter().filter(has_rule).for_each(|vertex| is_bounded[component[vertex.index()] as usize] = true);
        if let Some(part) = is_bounded.iter().position(|bounded| !bounded) {
            let vertex = component.iter().position(|&own| own as usize == part).unwrap_or(0);
            return Err(InterpolateError::NoScale { kind, vertex: VertexId::from(vertex) });
        }
    }
    Ok(())
}

fn known_range(rules: &[ValueRule]) -> (f64, f64) {
    let ends = rules.iter().flat_map(|rule| match *rule {
        ValueRule::Free => [None, None],
        ValueRule::Exactly(value) => [Some(value), None],
        ValueRule::Within(low, high) => [Some(low), Some(high)],
    });
    ends.flatten().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}
