//! The fit: fields of least energy on one mesh, without constraints, with pinned values, or monotone along given edges.

use std::borrow::Cow;

use crate::linalg::CsrMatrix;
use crate::mesh::SimplicialComplex;
use crate::qp::{Constraints, Engine, KktResiduals, Problem, Progress, QpError, QpStatus, Settings};

use super::edges::MonotonicityGraph;
use super::energy::{EnergyWeights, Operators, objective, total_mass};
use super::levels::{Levels, ValueRule, sweep};

/// Part of the start that comes from the levels; the rest is the swept minimiser. Measured on three flows, k = 2 and 3: a tenth
/// takes one or two iterations fewer than a hundredth, and no more than a fifth.
const LEVEL_SHARE: f64 = 0.1;
/// A row counts as active if the solution is this much closer to it than the field's range, beyond the margin.
const ACTIVE: f64 = 1e-7;

/// What the order constraints ask beyond the order itself.
#[derive(Debug, Clone)]
pub struct MonotoneConstraints<'a> {
    /// The edges along which the field rises.
    pub graph: &'a MonotonicityGraph,
    /// Levels of the graph: a feasible field.
    pub levels: &'a Levels,
    /// One rule a vertex.
    pub rules: &'a [ValueRule],
    /// The field must rise along each edge by this part of what the levels do; below 0.01.
    pub margin: f64,
    /// A field that is feasible but for margins, whose rise along an edge caps the margin there, so that it stays
    /// feasible: the last round's solution.
    pub feasible: Option<&'a [f64]>,
}

/// The solution of one quadratic problem, in the units of the data.
#[derive(Debug, Clone)]
pub struct MonotoneFit {
    /// `n` values.
    pub values: Vec<f64>,
    /// Energy of the values, `[value² length^d]`.
    pub energy: f64,
    /// How the solver ended.
    pub status: QpStatus,
    /// Residuals.
    pub kkt: KktResiduals,
    /// Order constraints.
    pub rows: usize,
    /// Order constraints on which the solution lies.
    pub active_rows: usize,
    /// Iterations.
    pub iterations: usize,
    /// Factorizations.
    pub factorizations: usize,
}

/// The quadratic problem of a monotone fit, over `x = (f - shift) / unit`.
#[derive(Debug, Clone)]
pub struct MonotoneProblem {
    /// The problem, its objective divided by the total mass and by `unit²`.
    pub problem: Problem,
    /// Where the solve begins, `n` numbers: the pinned minimiser as it is, or, where a feasible field is known, a strictly feasible point.
    pub start: Vec<f64>,
    /// Middle of the data, in their units.
    pub shift: f64,
    /// Range of the data.
    pub unit: f64,
}

/// Fields of least energy on one mesh: one analysis of the pattern, many solves.
pub struct Fitter<'a> {
    complex: &'a SimplicialComplex,
    operators: Cow<'a, Operators>,
    engine: Engine,
}

impl<'a> Fitter<'a> {
    /// Analyses the pattern of the energy.
    ///
    /// # Arguments
    /// * `operators`: those of the mesh, borrowed or given away.
    /// * `order`: k of all energies that will be minimised.
    ///
    /// # Errors
    /// [`QpError`].
    ///
    /// # Cost
    /// A fill-reducing ordering and a symbolic analysis.
    pub fn new(
        complex: &'a SimplicialComplex,
        operators: impl Into<Cow<'a, Operators>>,
        order: usize,
    ) -> Result<Self, QpError> {
        let operators = operators.into();
        let zeros = vec![0.0; complex.vertex_count()];
        let weights = EnergyWeights { order, length: 1.0, confidence: None, smoothness: None };
        let objective = objective(&operators, &zeros, &weights, (0.0, 1.0));
        let engine = Engine::new(&objective, None, Some(complex.points()))?;
        Ok(Self { complex, operators, engine })
    }

    /// With an engine whose analysis is that of this mesh.
    pub(super) fn with_engine(complex: &'a SimplicialComplex, operators: &'a Operators, engine: Engine) -> Self {
        Self { complex, operators: Cow::Borrowed(operators), engine }
    }

    /// The engine, for other fitters of this mesh.
    pub(super) fn into_engine(self) -> Engine {
        self.engine
    }

    /// The operators of the mesh.
    pub fn operators(&self) -> &Operators {
        &self.operators
    }

    /// The mesh.
    pub fn complex(&self) -> &'a SimplicialComplex {
        self.complex
    }

    /// The field of least energy with some values pinned.
    ///
    /// # Arguments
    /// * `data`: `n` values; `pinned`: `n` entries.
    ///
    /// # Errors
    /// [`QpError`].
    ///
    /// # Cost
    /// One factorisation.
    pub fn minimiser(
        &mut self,
        data: &[f64],
        weights: &EnergyWeights<'_>,
        pinned: &[Option<f64>],
    ) -> Result<Vec<f64>, QpError> {
        let (shift, unit) = units(data);
        let objective = objective(&self.operators, data, weights, (shift, unit));
        let fixed: Vec<Option<f64>> = pinned.iter().map(|value| value.map(|value| (value - shift) / unit)).collect();
        let minimum = self.engine.minimise(&objective, &fixed)?;
        Ok(minimum.x.iter().zip(pinned).map(|(x, pin)| pin.unwrap_or(shift + unit * x)).collect())
    }

    /// Applies the smoother `A_l`, the linear map from data to the field of least energy, to several fields.
    ///
    /// # Errors
    /// [`QpError`].
    ///
    /// # Cost
    /// One factorisation, and a few solves a field.
    pub fn smoothed(&mut self, weights: &EnergyWeights<'_>, fields: &[&[f64]]) -> Result<Vec<Vec<f64>>, QpError> {
        let n = self.complex.vertex_count();
        let zeros = vec![0.0; n];
        let objective = objective(&self.operators, &zeros, weights, (0.0, 1.0));
        let total = total_mass(&self.operators);
        let pull = |i: usize| 2.0 * weights.confidence.map_or(1.0, |confidence| confidence[i]) * self.operators.mass[i] / total;
        let pull: Vec<f64> = (0..n).map(pull).collect();
        let mut sides: Vec<f64> = Vec::with_capacity(n * fields.len());
        let mut shifts = Vec::with_capacity(fields.len());
        for field in fields {
            // Constants are reproduced: without them the solve keeps more digits.
            let (shift, _) = units(field);
            shifts.push(shift);
            sides.extend(field.iter().zip(&pull).map(|(value, pull)| pull * (value - shift)));
        }
        self.engine.pin(&objective, &vec![None; n])?.solve(&mut sides)?;
        let columns = sides.chunks(n).zip(shifts);
        Ok(columns.map(|(column, shift)| column.iter().map(|value| value + shift).collect()).collect())
    }

    /// The problem that [`Fitter::monotone`] solves, for another solver.
    ///
    /// # Arguments
    /// As there.
    ///
    /// # Errors
    /// [`QpError`] if there are not as many rules as vertices.
    ///
    /// # Cost
    /// O(n + m).
    ///
    /// # Source
    /// Jacobson, Weinkauf, Sorkine 2012, eq. 12–14.
    pub fn problem(
        &self,
        data: &[f64],
        weights: &EnergyWeights<'_>,
        constraints: &MonotoneConstraints<'_>,
        near: &[f64],
    ) -> Result<MonotoneProblem, QpError> {
        let (shift, unit) = units(data);
        let (rows, offset) = order_rows(constraints, (shift, unit))?;
        let fixed = constraints
            .rules
            .iter()
            .map(|rule| match rule {
                ValueRule::Exactly(value) => Some((value - shift) / unit),
                ValueRule::Free | ValueRule::Within(..) => None,
            })
            .collect();
        let problem = Problem {
            objective: objective(&self.operators, data, weights, (shift, unit)),
            fixed,
            constraints: Constraints::nonnegative(rows, offset),
        };
        let start = match constraints.feasible {
            // The engine makes more of how a minimiser violates the order than of a repaired one.
            None => near.iter().map(|value| (value - shift) / unit).collect(),
            Some(_) => {
                let swept = sweep(constraints.graph, constraints.levels, near);
                let mixed = swept.iter().zip(&constraints.levels.values).map(|(near, level)| near + LEVEL_SHARE * (level - near));
                mixed.map(|value| (value - shift) / unit).collect()
            }
        };
        Ok(MonotoneProblem { problem, start, shift, unit })
    }

    /// The field of least energy that rises along the monotonicity edges.
    ///
    /// # Arguments
    /// * `data`: `n` values.
    /// * `near`: a field near the solution, such as the pinned minimiser. The last round's solution, if the constraints name it as
    ///   feasible, is swept and mixed with the levels.
    /// * `progress`: called once an iteration.
    ///
    /// # Errors
    /// [`QpError`] if the problem is refused; how the solver ended is the status.
    ///
    /// # Cost
    /// One factorisation an iteration; 8 to 30 iterations.
    ///
    /// # Source
    /// Jacobson, Weinkauf, Sorkine 2012, eq. 12–14.
    pub fn monotone(
        &mut self,
        data: &[f64],
        weights: &EnergyWeights<'_>,
        constraints: &MonotoneConstraints<'_>,
        near: &[f64],
        settings: &Settings,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<MonotoneFit, QpError> {
        let MonotoneProblem { problem, start, shift, unit } = self.problem(data, weights, constraints, near)?;
        let solution = self.engine.solve(&problem, Some(&start), settings, progress)?;
        let values: Vec<f64> = solution
            .x
            .iter()
            .zip(constraints.rules)
            .map(|(x, rule)| match rule {
                ValueRule::Exactly(value) => *value,
                ValueRule::Free | ValueRule::Within(..) => shift + unit * x,
            })
            .collect();
        let (smoothness, distance) = super::energy::energy_parts(&self.operators, data, weights, &values);
        Ok(MonotoneFit {
            values,
            energy: smoothness + distance,
            status: solution.status,
            kkt: solution.kkt,
            rows: solution.slack.len(),
            active_rows: solution.slack.iter().filter(|&&slack| slack < ACTIVE).count(),
            iterations: solution.iterations,
            factorizations: solution.factorizations,
        })
    }
}

/// Middle and range of a field: the units in which its problem is of order one.
fn units(data: &[f64]) -> (f64, f64) {
    let (low, high) = data.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)));
    if data.is_empty() {
        return (0.0, 1.0);
    }
    let range = high - low;
    (low + 0.5 * range, if range > 0.0 { range } else { 1.0 })
}

/// The rows `A x + b ≥ 0`: a rise along every monotonicity edge by its margin, and the intervals.
///
/// Rows between two fixed values are left out; the levels have shown that they hold.
fn order_rows(constraints: &MonotoneConstraints<'_>, (shift, unit): (f64, f64)) -> Result<(CsrMatrix, Vec<f64>), QpError> {
    let mut triplets = Vec::with_capacity(2 * constraints.graph.edges().len());
    let mut offset = Vec::with_capacity(constraints.graph.edges().len());
    let is_fixed = |i: usize| matches!(constraints.rules[i], ValueRule::Exactly(_));
    let levels = &constraints.levels.values;
    for edge in constraints.graph.edges() {
        let (low, high) = (edge.low.index(), edge.high.index());
        if is_fixed(low) && is_fixed(high) {
            continue;
        }
        let row = offset.len() as u32;
        triplets.extend([(row, low as u32, -1.0), (row, high as u32, 1.0)]);
        let asked = constraints.margin * (levels[high] - levels[low]);
        let margin = constraints.feasible.map_or(asked, |feasible| asked.min(feasible[high] - feasible[low]).max(0.0));
        offset.push(-margin / unit);
    }
    for (i, rule) in constraints.rules.iter().enumerate() {
        if let &ValueRule::Within(low, high) = rule {
            for (sign, bound) in [(1.0, low), (-1.0, high)] {
                triplets.push((offset.len() as u32, i as u32, sign));
                offset.push(-sign * (bound - shift) / unit);
            }
        }
    }
    let matrix = CsrMatrix::from_triplets(offset.len(), constraints.rules.len(), &triplets).map_err(|_| QpError::Length {
        array: "rules",
        expected: levels.len(),
        found: constraints.rules.len(),
    })?;
    Ok((matrix, offset))
}
