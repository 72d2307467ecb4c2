//! The factor of an engine: formed or mixed, in double or in single precision.

use crate::linalg::{Cholesky, Compliance, Factor, FactorError, SparseRow, SymbolicCholesky};

use super::mixed::{Layout, Mixed};
use super::Engine;

/// The numbers that the factor of an engine is made of. Everything else is in double precision, always.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FactorPrecision {
    /// 64 bits: a solve is exact up to rounding, and one or two steps of refinement end it.
    #[default]
    Double,
    /// 32 bits: half the memory and half the time. The factor is the preconditioner of conjugate gradients in double precision.
    Single,
    /// 32 bits until conjugate gradients no longer converge with it, then 64 bits for the rest of the solve.
    Adaptive,
}

/// Most steps of conjugate gradients with a factor in single precision; with one in double precision see the callers.
const SINGLE_STEPS: usize = 60;

/// Steps without a new least residual after which conjugate gradients with a factor in single precision end.
const SINGLE_PATIENCE: usize = 6;

/// Shifts relative to the diagonal that are tried in turn when a pivot fails; refinement removes their effect.
const SHIFTS: [f64; 5] = [1e-14, 1e-12, 1e-10, 1e-8, 1e-6];

/// The same in single precision.
const SINGLE_SHIFTS: [f64; 4] = [1e-7, 1e-6, 1e-5, 1e-4];

/// The factor of an engine.
pub(super) enum System {
    Formed(Cholesky),
    Single(Factor<f32>),
    Mixed(Mixed),
}

impl System {
    pub fn new(layout: Option<Layout>, symbolic: &SymbolicCholesky, columns: usize) -> Self {
        match layout {
            None => Self::Formed(Cholesky::new(symbolic, columns)),
            Some(layout) => Self::Mixed(Mixed::new(layout, symbolic, columns)),
        }
    }

    pub fn layout(&self) -> Option<Layout> {
        match self {
            Self::Formed(_) | Self::Single(_) => None,
            Self::Mixed(mixed) => Some(mixed.layout),
        }
    }

    /// The place of a vertex's x among the unknowns of the system.
    pub fn unknown(&self, vertex: usize) -> usize {
        self.layout().map_or(vertex, |layout| layout.unknown(vertex))
    }

    pub fn factor(&mut self, symbolic: &SymbolicCholesky, values: &[f64]) -> Result<(), FactorError> {
        match self {
            Self::Formed(factor) => factor.factor(symbolic, values),
            Self::Single(factor) => factor.factor(symbolic, values),
            Self::Mixed(factor) => factor.factor(symbolic, values),
        }
    }

    pub fn solve_in_place(&mut self, symbolic: &SymbolicCholesky, sides: &mut [f64]) {
        match self {
            Self::Formed(factor) => factor.solve_in_place(symbolic, sides),
            Self::Single(factor) => factor.solve_in_place(symbolic, sides),
            Self::Mixed(factor) => factor.solve_in_place(symbolic, sides),
        }
    }

    /// Adds rows of coefficients of x to a compliance with this factor.
    pub fn comply(&self, symbolic: &SymbolicCholesky, compliance: &mut Compliance, rows: &mut [SparseRow]) {
        for (unknown, _) in rows.iter_mut().flatten() {
            *unknown = self.unknown(*unknown as usize) as u32;
        }
        match self {
            Self::Formed(factor) => factor.comply(symbolic, compliance, rows),
            Self::Single(factor) => factor.comply(symbolic, compliance, rows),
            Self::Mixed(factor) => factor.comply(symbolic, compliance, rows),
        }
    }

    /// Relative shifts of the diagonal to try when a pivot fails.
    pub fn shifts(&self) -> &'static [f64] {
        if matches!(self, Self::Single(_)) { &SINGLE_SHIFTS } else { &SHIFTS }
    }

    /// Most steps of conjugate gradients, and steps without progress before they end, where a caller wants so many with an exact factor.
    pub fn steps(&self, wanted: usize) -> (usize, usize) {
        match self {
            // A single step is never refined.
            Self::Single(_) if wanted > 1 => (SINGLE_STEPS, SINGLE_PATIENCE),
            _ => (wanted, 1),
        }
    }
}

impl Engine {
    /// Chooses the numbers that the factor is made of; the mixed form stays in double precision.
    ///
    /// Penalty continuation and the pinned solvers refine without conjugate gradients and want double precision.
    pub fn set_precision(&mut self, precision: FactorPrecision) {
        self.precision = precision;
        self.apply_precision();
    }

    /// The numbers that the factor is made of at the moment.
    pub fn precision(&self) -> FactorPrecision {
        match (&self.system, self.precision) {
            (System::Single(_), precision) => precision,
            _ => FactorPrecision::Double,
        }
    }

    /// Bytes of the factor, its work memory included roughly, in a precision.
    pub fn factor_bytes(&self, precision: FactorPrecision) -> usize {
        let each = if precision == FactorPrecision::Double { size_of::<f64>() } else { size_of::<f32>() };
        // Stacks of update matrices take two thirds of the factor on solid meshes, measured.
        self.symbolic.stored_entries() * each * 5 / 3
    }

    /// Floating-point operations of one factorisation.
    pub fn factor_flops(&self) -> f64 {
        self.symbolic.factor_flops()
    }

    /// Begins a solve in the chosen precision.
    pub(super) fn apply_precision(&mut self) {
        let is_single = matches!(self.system, System::Single(_));
        let wanted = self.precision != FactorPrecision::Double && self.system.layout().is_none();
        if is_single != wanted {
            self.system = if wanted {
                System::Single(Factor::new(&self.symbolic, super::engine::COLUMNS))
            } else {
                System::new(self.system.layout(), &self.symbolic, super::engine::COLUMNS)
            };
            self.forget_factor();
        }
    }

    /// Goes on in double precision where that is allowed; false where the factor is in double precision already, or must not be.
    pub(super) fn escalate(&mut self) -> bool {
        if self.precision != FactorPrecision::Adaptive || !matches!(self.system, System::Single(_)) {
            return false;
        }
        self.system = System::Formed(Cholesky::new(&self.symbolic, super::engine::COLUMNS));
        self.forget_factor();
        true
    }
}
