//! Functions without any extremum but at given values: the monotone method.
//!
//! Literature: Jacobson, Weinkauf, Sorkine 2012, section 3, without a data term.

use crate::field::{Precision, VertexId, VertexOrder};
use crate::linalg::CsrMatrix;
use crate::monotone::{
    Contradiction, EdgeSet, Levels, MonotonicityGraph, Strictness, ValueRule, flood, levels, repair, st_numbering, sweep,
};
use crate::qp::{Constraints, Engine, Objective, Problem, QpStatus, Settings, Solution};

use super::contraction::Contraction;
use super::method::InterpolateOptions;
use super::InterpolateError;

/// Margins of the order constraints, as parts of the differences of levels: small against the energy, large against the rounding of
/// the stored width.
const MARGIN_F32: f64 = 1e-4;
const MARGIN_F64: f64 = 1e-6;

/// Part of the start of a refinement round that comes from the levels.
const LEVEL_SHARE: f64 = 0.1;

/// The convex problem of one function on a contracted mesh.
pub(super) struct Controlled<'a> {
    pub contraction: &'a Contraction,
    pub objective: &'a Objective,
    pub options: &'a InterpolateOptions,
    /// Value of a unit of the unknowns, and their zero.
    unit: f64,
    shift: f64,
    pub rules: Vec<ValueRule>,
}

/// A direction for every monotonicity edge, and a field that follows it strictly.
pub(super) struct Directions {
    pub graph: MonotonicityGraph,
    pub levels: Levels,
    /// Passes of the flood.
    pub passes: usize,
    /// Another function took the place of the one asked for.
    pub replaced: bool,
}

/// What keeps a function monotone after it was found.
pub(super) struct Frame {
    pub contraction: Contraction,
    pub directions: Directions,
}

/// A field on the nodes, strict along the directions.
pub(super) struct Strict {
    pub nodes: Vec<f64>,
    pub solution: Solution,
    pub iterations: usize,
    pub factorizations: usize,
    pub largest_move: f64,
    pub directions: Directions,
    /// Energy in units of the objective after each round.
    pub rounds: Vec<f64>,
}

impl Strict {
    /// The one of two with less energy, with the work of both.
    pub fn or_better(self, other: Self) -> Self {
        let (iterations, factorizations) = (self.iterations + other.iterations, self.factorizations + other.factorizations);
        // A solve that did not end is worth less than one that did.
        let key = |found: &Self| (found.solution.status != QpStatus::Solved, found.solution.objective);
        let best = if key(&other) < key(&self) { other } else { self };
        Self { iterations, factorizations, ..best }
    }
}

impl<'a> Controlled<'a> {
    pub fn new(contraction: &'a Contraction, objective: &'a Objective, options: &'a InterpolateOptions) -> Self {
        let (low, high) = super::boundary::range(&contraction.fixed);
        let rule = |value: &Option<f64>| value.map_or(ValueRule::Free, |value| ValueRule::Exactly(options.precision.round(value)));
        Self {
            contraction,
            objective,
            options,
            unit: if high > low { high - low } else { 1.0 },
            shift: 0.5 * (low + high),
            rules: contraction.fixed.iter().map(rule).collect(),
        }
    }

    /// The objective of the smooth function with the given values, below which no function with these values can be.
    pub fn bound(&self, pinned: &[f64]) -> f64 {
        let scaled: Vec<f64> = pinned.iter().map(|value| (value - self.shift) / self.unit).collect();
        self.objective.value(&scaled)
    }

    /// Directions from a field on the vertices; where its order cannot serve, from the harmonic function or, in the end, from the graph
    /// alone.
    pub fn directions(&self, asked: &[f64], harmonic: &[f64]) -> Result<Directions, InterpolateError> {
        let Contraction { graph, wanted, .. } = self.contraction;
        let mut found = None;
        for (field, replaced) in [(asked, false), (harmonic, true)] {
            let flooded = flood(graph, &self.order_of(field), wanted);
            if flooded.valid {
                match self.along(flooded.order, flooded.passes, replaced) {
                    Ok(directions) => return Ok(directions),
                    Err(contradiction) => found = Some(contradiction),
                }
            }
        }
        match (st_numbering(graph, wanted), found) {
            (Some(order), None) => self.along(order, 0, true).map_err(|found| self.refusal(found)),
            (_, Some(found)) => Err(self.refusal(found)),
            // The contraction leaves no region that is out of reach.
            (None, None) => Err(InterpolateError::Pinched { vertex: self.contraction.member[0], vertices: graph.vertex_count() }),
        }
    }

    /// The field on the vertices nearest to a given one, in the mean of two sweeps, that falls along none of the directions of its own
    /// order, flooded to the wanted extrema; of the old directions where that has none.
    pub fn led_back(&self, field: &[f64], old: &mut Directions) -> Vec<f64> {
        let Contraction { graph, wanted, member, .. } = self.contraction;
        let flooded = flood(graph, &self.order_of(field), wanted);
        if flooded.valid && let Ok(found) = self.along(flooded.order, old.passes, old.replaced) {
            *old = found;
        }
        let nodes: Vec<f64> = member.iter().map(|vertex| field[vertex.index()]).collect();
        sweep(&old.graph, &old.levels, &nodes)
    }

    /// The order of a field on the vertices; wanted minima come before other nodes of the same value, wanted maxima after.
    fn order_of(&self, field: &[f64]) -> VertexOrder {
        let Contraction { member, fixed, wanted, .. } = self.contraction;
        let mut side = vec![0i8; member.len()];
        wanted.minima.iter().for_each(|node| side[node.index()] = -1);
        wanted.maxima.iter().for_each(|node| side[node.index()] = 1);
        let keys: Vec<f64> = member.iter().zip(fixed).map(|(vertex, fixed)| fixed.unwrap_or(field[vertex.index()]) + 0.0).collect();
        let mut sequence: Vec<VertexId> = (0..member.len()).map(VertexId::from).collect();
        sequence.sort_by(|&a, &b| {
            let (a, b) = (a.index(), b.index());
            keys[a].total_cmp(&keys[b]).then(side[a].cmp(&side[b])).then(a.cmp(&b))
        });
        VertexOrder::of_sequence(sequence).expect("every node stands in the sequence once")
    }

    fn along(&self, order: VertexOrder, passes: usize, replaced: bool) -> Result<Directions, Contradiction> {
        let graph = MonotonicityGraph::new(&self.contraction.graph, &order, &self.contraction.wanted, EdgeSet::Minimal);
        let range = (self.shift - 0.5 * self.unit, self.shift + 0.5 * self.unit);
        levels(&graph, &self.rules, range).map(|levels| Directions { graph, levels, passes, replaced })
    }

    fn refusal(&self, found: Contradiction) -> InterpolateError {
        InterpolateError::Contradiction {
            low: self.contraction.member[found.low.index()],
            low_value: found.low_value,
            high: self.contraction.member[found.high.index()],
            high_value: found.high_value,
        }
    }

    /// Solves along the directions, refines as often as was asked, and makes the result strict in the stored width.
    ///
    /// # Arguments
    /// * `near`: a field on the vertices near the solution, best the minimiser without order constraints.
    /// * `rival`: what other directions led to; it is returned if these are worse, which often shows long before the solve would end.
    ///
    /// # Source
    /// Refinement: Günther, Jacobson, Reininghaus, Seidel, Sorkine-Hornung, Weinkauf 2014.
    pub fn solve(
        &self,
        engine: &mut Engine,
        directions: Directions,
        near: &[f64],
        rival: Option<Strict>,
    ) -> Result<Strict, InterpolateError> {
        let start: Vec<f64> = near.iter().map(|value| (value - self.shift) / self.unit).collect();
        let cutoff = rival.as_ref().map_or(f64::INFINITY, |rival| rival.solution.objective);
        let solution = self.along_directions(engine, &directions, (&start, None), cutoff)?;
        match rival {
            Some(rival) if solution.status == QpStatus::CutOff => Ok(Strict {
                iterations: rival.iterations + solution.iterations,
                factorizations: rival.factorizations + solution.factorizations,
                ..rival
            }),
            Some(rival) => Ok(rival.or_better(self.refined(engine, solution, directions)?)),
            None => self.refined(engine, solution, directions),
        }
    }

    fn refined(&self, engine: &mut Engine, solution: Solution, directions: Directions) -> Result<Strict, InterpolateError> {
        let mut best = self.strict(solution, directions, Precision::F64)?;
        for _ in 0..self.options.refine {
            let order = VertexOrder::of_values(&best.nodes)?;
            let Ok(directions) = self.along(order, best.directions.passes, best.directions.replaced) else { break };
            let swept = sweep(&directions.graph, &directions.levels, &best.nodes);
            let mixed = swept.iter().zip(&directions.levels.values).map(|(near, level)| near + LEVEL_SHARE * (level - near));
            let nodes: Vec<f64> = mixed.map(|value| (value - self.shift) / self.unit).collect();
            let start = self.contraction.spread(&nodes);
            let solution = self.along_directions(engine, &directions, (&start, Some(&best.nodes)), f64::INFINITY)?;
            let gain = best.solution.objective - solution.objective;
            if gain <= 0.0 {
                break;
            }
            let mut next = self.strict(solution, directions, Precision::F64)?;
            next.iterations += best.iterations;
            next.factorizations += best.factorizations;
            next.rounds = [best.rounds, next.rounds].concat();
            best = next;
            if gain <= self.options.relative_gap * best.solution.objective {
                break;
            }
        }
        if self.options.precision == Precision::F32 {
            let Strict { solution, directions, iterations, factorizations, rounds, .. } = best;
            return Ok(Strict { iterations, factorizations, rounds, ..self.strict(solution, directions, Precision::F32)? });
        }
        Ok(best)
    }

    fn along_directions(
        &self,
        engine: &mut Engine,
        directions: &Directions,
        (start, feasible): (&[f64], Option<&[f64]>),
        cutoff: f64,
    ) -> Result<Solution, InterpolateError> {
        let Contraction { member, fixed, node, .. } = self.contraction;
        let margin = match self.options.precision {
            Precision::F32 => MARGIN_F32,
            Precision::F64 => MARGIN_F64,
        };
        let mut triplets = Vec::with_capacity(2 * directions.graph.edges().len());
        let mut offset = Vec::with_capacity(directions.graph.edges().len());
        let level = &directions.levels.values;
        for edge in directions.graph.edges() {
            let (low, high) = (edge.low.index(), edge.high.index());
            // The levels have shown that two given values are in order.
            if fixed[low].is_some() && fixed[high].is_some() {
                continue;
            }
            let row = offset.len() as u32;
            triplets.extend([(row, member[low].0, -1.0), (row, member[high].0, 1.0)]);
            let asked = margin * (level[high] - level[low]);
            let asked = feasible.map_or(asked, |feasible| asked.min(feasible[high] - feasible[low]).max(0.0));
            offset.push(-asked / self.unit);
        }
        let matrix = CsrMatrix::from_triplets(offset.len(), node.len(), &triplets)?;
        let held = node.iter().map(|&node| fixed[node as usize].map(|value| (value - self.shift) / self.unit)).collect();
        let problem =
            Problem { objective: self.objective.clone(), fixed: held, constraints: Constraints::nonnegative(matrix, offset) };
        let settings = Settings { relative_gap: self.options.relative_gap, cutoff, ..Settings::default() };
        Ok(engine.solve(&problem, Some(start), &settings, &mut |_| {})?)
    }

    fn strict(&self, solution: Solution, directions: Directions, precision: Precision) -> Result<Strict, InterpolateError> {
        let Contraction { member, .. } = self.contraction;
        let nodes: Vec<f64> = member.iter().map(|vertex| self.shift + self.unit * solution.x[vertex.index()]).collect();
        let repaired = repair(&directions.graph, &nodes, &self.rules, precision, Strictness::Plain)
            .map_err(|found| InterpolateError::NotRepresentable { vertex: member[found.vertex.index()] })?;
        Ok(Strict {
            nodes: repaired.values,
            iterations: solution.iterations,
            factorizations: solution.factorizations,
            largest_move: repaired.largest_move,
            rounds: vec![solution.objective * self.unit * self.unit],
            solution,
            directions,
        })
    }
}
