//! What a deformation returns: the shape, the evidence, and what it took.

use super::{Blame, DeformEnergy, SolveMethod};
use crate::audit::OrientationReport;
use crate::field::VertexId;
use crate::qp::{FactorPrecision, KktResiduals, Solution};

/// How a deformation ended. Only [`DeformStatus::Certified`] is success.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DeformStatus {
    /// Optimal within the settings, and without inversions in double and in single precision by the audit.
    ///
    /// An energy of at most [`Deformed::NO_ENERGY`] times the rest measure is an optimum as well, whatever its gap: none is below zero.
    Certified,
    /// No element is inverted, but the solver did not reach the tolerances: iterations ran out, or rounding stopped it.
    Uncertified,
    /// No shape without inversions has these rotations and handles; the blame names the culprits.
    Contradiction(Blame),
    /// The audit found inverted or degenerate elements.
    Inverted,
}

/// What was done to come to a shape without inversions after all.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Substitute {
    /// Hard handles were let go to soft ones.
    SoftHandles,
    /// The rotations of elements that could not follow were read anew from the closest shape, in so many rounds; handles are soft.
    RotationsReread {
        /// Rounds.
        rounds: usize,
        /// Elements with other rotations than asked.
        elements: usize,
    },
    /// All rotations were drawn towards their mean, to this share of the way from it; handles are soft.
    RotationsBlended {
        /// 1 would be the rotations as asked, 0 one rotation for all.
        share: f64,
    },
}

/// One number or mark for every element, in the order of the mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementReport {
    /// `det F`, deformed over rest measure.
    pub determinants: Vec<f64>,
    /// The smallest eigenvalue of `sym(RᵀF)`.
    pub smallest_eigenvalues: Vec<f64>,
    /// Energy over rest measure.
    pub energy_densities: Vec<f64>,
    /// Whether the cone holds the element back: its multiplier outweighs its slack.
    pub active: Vec<bool>,
}

/// A held vertex, where it was asked to be and where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandlePlace {
    /// The vertex.
    pub vertex: VertexId,
    /// Asked.
    pub asked: [f64; 3],
    /// Achieved.
    pub achieved: [f64; 3],
    /// Their distance, `[length]`.
    pub distance: f64,
}

/// What a deformation took.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct Effort {
    /// Convex problems solved.
    pub problems: usize,
    /// Iterations of all of them.
    pub iterations: usize,
    /// Numeric factorisations of all of them.
    pub factorizations: usize,
    /// Triangular solves of all of them.
    pub solves: usize,
    /// Nonzeros of the factor.
    pub factor_entries: usize,
    /// Seconds in factorisations, assembly included.
    pub factor_seconds: f64,
    /// Seconds of all solves.
    pub seconds: f64,
}

impl Effort {
    /// Counts one more solve.
    pub(super) fn add(&mut self, solution: &Solution) {
        self.problems += 1;
        self.iterations += solution.iterations;
        self.factorizations += solution.factorizations;
        self.solves += solution.solves;
        self.factor_seconds += solution.timings.factor;
        self.seconds += solution.timings.total;
    }
}

/// A deformed shape with its evidence.
#[derive(Debug, Clone, PartialEq)]
pub struct Deformed {
    /// `n x dim` coordinates, vertex by vertex.
    pub positions: Vec<f64>,
    /// The same as points; in 2-D with the height of the rest shape.
    pub points: Vec<[f64; 3]>,
    /// The rotation of every element that the last solve used.
    pub rotations: Vec<[[f64; 3]; 3]>,
    /// How it ended.
    pub status: DeformStatus,
    /// Elements and handles to look at where the end is not a certified shape: those of the contradiction, or the elements whose cone does
    /// not hold.
    pub suspects: Option<Blame>,
    /// The numbers that the factor was made of at the end.
    pub factor: FactorPrecision,
    /// What was solved instead, where that was asked for after a contradiction. Certificate, energy and elements are those of the substitute.
    pub substitute: Option<Substitute>,
    /// The parts of the energy.
    pub energy: DeformEnergy,
    /// Area (2-D) or volume (3-D) of all elements at rest.
    pub rest_measure: f64,
    /// The optimality certificate of the last solve. Gaps are relative to the true energy, its constant included.
    pub certificate: KktResiduals,
    /// Per-element numbers.
    pub elements: ElementReport,
    /// The audit of the positions, in double and in single precision.
    pub audit: [OrientationReport; 2],
    /// Asked and achieved places of the held vertices, in their order.
    pub handles: Vec<HandlePlace>,
    /// The method used.
    pub method: SolveMethod,
    /// What it took.
    pub effort: Effort,
}

impl Deformed {
    /// Energy that counts as none, as a part of the rest measure (area or volume of all elements): the root of the mean of `|F - R|²` is
    /// then at most 1.5e-6.
    pub const NO_ENERGY: f64 = 1e-12;

    /// Whether the energy is none, up to [`Deformed::NO_ENERGY`]. A gap relative to it then says nothing.
    pub fn is_without_energy(&self) -> bool {
        self.energy.total() <= Self::NO_ENERGY * self.rest_measure
    }

    /// The smallest `det F` in double and in single precision.
    pub fn smallest_determinants(&self) -> [f64; 2] {
        [self.audit[0].smallest, self.audit[1].smallest]
    }

    /// Whether the audit found neither inverted nor degenerate elements, in either precision.
    pub fn is_inversion_free(&self) -> bool {
        self.audit.iter().all(OrientationReport::is_clean)
    }

    /// Whether the shape is the certified optimum of what was asked.
    pub fn is_certified(&self) -> bool {
        self.status == DeformStatus::Certified
    }

    /// The held vertex that is farthest from where it was asked to be; `None` without handles.
    pub fn farthest_handle(&self) -> Option<HandlePlace> {
        self.handles.iter().copied().reduce(|most, next| if next.distance > most.distance { next } else { most })
    }
}
