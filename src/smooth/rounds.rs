//! The convex problem, and its repetition with the solution as representative function.

use crate::field::{Precision, VertexOrder};
use crate::mesh::SimplicialComplex;
use crate::monotone::{
    EnergyWeights, Fitter, MonotoneConstraints, MonotoneFit, MonotonicityGraph, Strictness, ValueRule, levels, repair,
};
use crate::morse::WantedExtrema;
use crate::qp::Settings;

use super::error::SmoothError;
use super::guidance::Guide;
use super::options::SmoothOptions;
use super::pipeline::SmoothProgress;

/// Margins of the order constraints, as parts of the differences of levels: small against the energy, large against the
/// rounding of the stored width (prototype: 1e-4 leaves no tie in 32 bits, at +9e-5 of the energy).
const MARGIN_F32: f64 = 1e-4;
const MARGIN_F64: f64 = 1e-6;

/// What the rounds of solves ended with.
pub(super) struct Solved {
    /// The last round's solution.
    pub(super) fit: MonotoneFit,
    /// The last round's guide: the solution rises along its edges.
    pub(super) guide: Guide,
    /// Energy after each round.
    pub(super) energies: Vec<f64>,
    pub(super) iterations: usize,
    pub(super) factorizations: usize,
}

/// The convex problem, and its repetition with the solution as representative function.
pub(super) struct Rounds<'a> {
    pub(super) data: &'a [f64],
    pub(super) weights: EnergyWeights<'a>,
    pub(super) wanted: &'a WantedExtrema,
    pub(super) rules: &'a [ValueRule],
    pub(super) options: &'a SmoothOptions<'a>,
}

impl Rounds<'_> {
    /// Solves along the guide's edges, then refines as often as was asked.
    ///
    /// # Source
    /// Refinement: Günther, Jacobson, Reininghaus, Seidel, Sorkine-Hornung, Weinkauf 2014.
    pub(super) fn run(
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
