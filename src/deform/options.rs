//! What a solve of a deformation may be asked for.

use crate::qp::{Penalty, Settings};

/// How the convex problem is solved. Both ways end at the same optimum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SolveMethod {
    /// The primal–dual interior point.
    #[default]
    InteriorPoint,
    /// The penalty continuation of Liu et al. 2016, whose iterates are previews of the result.
    Penalty(Penalty),
}

/// Where a solve begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Begin {
    /// At the minimiser without cones: the result does not depend on what was solved before.
    #[default]
    Cold,
    /// Near the last solution of this solver, where there is one; the interior point only.
    Warm,
}

/// The numbers that the factor is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FactorChoice {
    /// 64 bits while the factor fits in the memory limit, 32 bits with conjugate gradients in 64 bits beyond that.
    #[default]
    Automatic,
    /// 64 bits.
    Double,
    /// 32 bits, as the preconditioner of conjugate gradients in 64 bits: half the memory.
    Single,
}

/// What to do where no inversion-free shape has the asked rotations and handles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OnContradiction {
    /// Name the culprits and leave the shape as the solver left it.
    #[default]
    Name,
    /// Name the culprits, and look for the closest inversion-free shape: handles let go to soft ones, rotations read anew.
    KeepBest,
}

/// How a solve is done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolveOptions {
    /// Interior point or penalties.
    pub method: SolveMethod,
    /// When a solve ends.
    pub settings: Settings,
    /// Rounds in which the rotations are read anew from the last shape (Kovalsky et al. 2014) after the first solve; 0 keeps the rotations.
    pub rounds: usize,
    /// Where the first solve begins.
    pub begin: Begin,
    /// What happens on a contradiction.
    pub on_contradiction: OnContradiction,
}

impl Default for SolveOptions {
    /// The interior point to a relative gap of 1e-6, from a cold start, for the given rotations.
    fn default() -> Self {
        Self {
            method: SolveMethod::InteriorPoint,
            settings: Settings { relative_gap: 1e-6, ..Settings::default() },
            rounds: 0,
            begin: Begin::Cold,
            on_contradiction: OnContradiction::Name,
        }
    }
}
