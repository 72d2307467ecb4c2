//! What was asked, what was done and what was achieved, as numbers.

use serde::Serialize;

use crate::field::Precision;
use crate::monotone::Strategy;
use crate::qp::{KktResiduals, QpStatus};

use super::options::{KeepAlso, SelectOn};

/// Number of minima and maxima of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct ExtremumCount {
    /// Local minima.
    pub minima: usize,
    /// Local maxima.
    pub maxima: usize,
}

impl std::fmt::Display for ExtremumCount {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let noun = |count: usize, one: &str, many: &str| format!("{count} {}", if count == 1 { one } else { many });
        write!(
            f,
            "{}, {}",
            noun(self.minima, "minimum", "minima"),
            noun(self.maxima, "maximum", "maxima")
        )
    }
}

/// The smoothing length used.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LengthReport {
    /// In the units of the points.
    pub absolute: f64,
    /// As a fraction of the diagonal of the bounding box.
    pub of_diagonal: f64,
    /// Whether it was chosen by cross-validation.
    pub automatic: bool,
    /// Root mean square of what cross-validation could not predict, in the units of the values: the noise, and on top the error of
    /// the prediction. Absent where the length was given, or too few values were left to predict from.
    pub noise: Option<f64>,
}

/// The representative function used.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RepresentativeReport {
    /// The strategy asked for.
    pub asked: Strategy,
    /// The strategy used.
    pub used: Strategy,
    /// Why another one was used, in words.
    pub why: Option<String>,
    /// Passes of the flood.
    pub passes: usize,
}

/// Energies in units of `[value² length^d]`, all of the same objective.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EnergyReport {
    /// Of the values returned.
    pub result: f64,
    /// Of the smoothness term alone.
    pub smoothness: f64,
    /// Of the data term alone.
    pub data: f64,
    /// The least energy of any field.
    pub unconstrained: f64,
    /// The least energy of any field with the wanted values: no field with the wanted extrema can be below it, so it
    /// bounds the ideal, non-convex problem (Jacobson 2012, eq. 6–11). It is the energy of a minimiser computed to rounding.
    pub bound: f64,
    /// `result / bound - 1`.
    pub above_bound: f64,
    /// `result / unconstrained - 1`.
    pub above_unconstrained: f64,
    /// Energy after the first solve and after each refinement round, before the repair.
    pub rounds: Vec<f64>,
}

/// What was kept besides the extrema, and the energy paid for it, before the repair.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KeptReport {
    /// What was asked.
    pub what: KeepAlso,
    /// Saddles that keep their value.
    pub saddles: usize,
    /// Further vertices on separatrices that keep theirs.
    pub separatrix_vertices: usize,
    /// Energy of the field that keeps the wanted extrema only, `[value² length^d]`.
    pub without: f64,
    /// Energy of this field.
    pub with: f64,
    /// `with / without - 1`.
    pub paid: f64,
}

/// What the solver reached, the last round's.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SolverReport {
    /// How it ended.
    pub status: QpStatus,
    /// Order constraints.
    pub rows: usize,
    /// Of these, the ones on which the solution lies.
    pub active_rows: usize,
    /// Iterations over all rounds.
    pub iterations: usize,
    /// Factorizations over all rounds.
    pub factorizations: usize,
    /// Residuals on the unscaled problem.
    pub kkt: KktResiduals,
}

/// How far the exact repair moved the solver's values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RepairReport {
    /// Vertices whose value is not the rounded one.
    pub moved: usize,
    /// Greatest distance from the solver's value, rounding included.
    pub largest_move: f64,
}

/// What changed between the data and the result.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChangeReport {
    /// Root of the mean square of the change, weighted by lumped mass.
    pub rms: f64,
    /// Greatest change.
    pub largest: f64,
    /// `rms` as a fraction of the range of the data.
    pub rms_of_range: f64,
}

/// Seconds by stage.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Timing {
    /// Name of the stage and wall seconds spent in it, in the order of the work.
    pub stages: Vec<(String, f64)>,
}

impl Timing {
    /// Adds seconds to a stage.
    pub fn add(&mut self, stage: &str, seconds: f64) {
        match self.stages.iter_mut().find(|(name, _)| name == stage) {
            Some((_, total)) => *total += seconds,
            None => self.stages.push((stage.to_owned(), seconds)),
        }
    }

    /// Runs a piece of work and adds its time to a stage.
    pub fn measure<T>(&mut self, stage: &str, work: impl FnOnce() -> T) -> T {
        let begin = std::time::Instant::now();
        let result = work();
        self.add(stage, begin.elapsed().as_secs_f64());
        result
    }

    /// Seconds over all stages.
    pub fn total(&self) -> f64 {
        self.stages.iter().map(|(_, seconds)| seconds).sum()
    }
}

/// Evidence for one smoothed field.
#[derive(Debug, Clone, Serialize)]
pub struct SmoothReport {
    /// Vertices of the domain.
    pub vertices: usize,
    /// Top simplices of the domain.
    pub simplices: usize,
    /// Dimension of the domain.
    pub dimension: usize,
    /// Connected components.
    pub components: usize,
    /// Least and greatest data value.
    pub data_range: (f64, f64),
    /// Extrema of the data.
    pub before: ExtremumCount,
    /// The field on which extrema were selected.
    pub select_on: SelectOn,
    /// Least and greatest value of that field.
    pub selection_range: (f64, f64),
    /// Extrema of that field.
    pub selection_extrema: ExtremumCount,
    /// The persistence that had to be exceeded, in the units of the values; absent if extrema were chosen otherwise.
    pub threshold: Option<f64>,
    /// Extrema asked for.
    pub wanted: ExtremumCount,
    /// Of these, kept below the threshold because their part of the domain touches the rest at one vertex only, so that no
    /// field is without them. Their values are free.
    pub unavoidable: usize,
    /// What was kept besides the extrema; absent if nothing was asked.
    pub kept_also: Option<KeptReport>,
    /// Order k of the polyharmonic energy.
    pub order: usize,
    /// Smoothing length.
    pub length: LengthReport,
    /// Representative function.
    pub representative: RepresentativeReport,
    /// Energies.
    pub energy: EnergyReport,
    /// Solver.
    pub solver: SolverReport,
    /// Repair.
    pub repair: RepairReport,
    /// Stored width.
    pub precision: Precision,
    /// Change of the values.
    pub change: ChangeReport,
    /// Wall seconds by stage.
    pub timing: Timing,
}
