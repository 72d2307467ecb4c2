//! A barrier on `det F`, from the rest shape on: no iterate is ever inverted.

use super::compared::{Compared, Comparison, Ending};
use super::det_penalty::positive;
use super::determinant::{OfDeterminant, WithDeterminant};
use super::newton::{Newton, Rule};
use crate::deform::{DeformError, Hold};

/// What grows without bound as `det F` goes to zero. Both are functions of `g = 1 - (1 - det F)³`, which is smooth up to the second
/// derivative where the barrier begins, at `det F = 1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Barrier {
    /// `-ln g`.
    #[default]
    Logarithm,
    /// `1/g - 1`, as published.
    Reciprocal,
}

/// The parameters of the barrier method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BarrierOptions {
    /// The barrier.
    pub barrier: Barrier,
    /// Its weight against the elastic energy, positive; 0.01 as published.
    pub weight: f64,
    /// Steps in which the handles go from rest to their targets, along straight lines, at least 1.
    pub substeps: usize,
    /// `gᵀ H⁻¹ g` relative to the energy at which a step ends, positive.
    pub tolerance: f64,
    /// Newton steps at most, over all moves of the handles.
    pub max_iterations: usize,
}

impl Default for BarrierOptions {
    /// The logarithm with weight 0.01, ten moves, 1e-10, 3000 steps as in figure 10 of Liu 2016.
    fn default() -> Self {
        Self { barrier: Barrier::default(), weight: 1e-2, substeps: 10, tolerance: 1e-10, max_iterations: 3000 }
    }
}

struct Weighted {
    barrier: Barrier,
    weight: f64,
}

impl OfDeterminant for Weighted {
    fn at(&self, determinant: f64) -> [f64; 3] {
        if determinant >= 1.0 {
            return [0.0; 3];
        }
        if determinant.is_nan() || determinant <= 0.0 {
            return [f64::INFINITY, 0.0, 0.0];
        }
        let left = 1.0 - determinant;
        let (g, slope, curvature) = (1.0 - left * left * left, 3.0 * left * left, -6.0 * left);
        let parts = match self.barrier {
            Barrier::Logarithm => [-g.ln(), -slope / g, slope * slope / (g * g) - curvature / g],
            Barrier::Reciprocal => {
                [1.0 / g - 1.0, -slope / (g * g), 2.0 * slope * slope / (g * g * g) - curvature / (g * g)]
            }
        };
        parts.map(|part| self.weight * part)
    }
}

impl Comparison<'_> {
    /// A barrier method in the manner of locally injective mappings, with the elastic energy of the other methods.
    ///
    /// Starts at the rest shape, moves the targets in steps, and takes no step that inverts an element: whatever it ends with is free
    /// of inversions. The energy is not convex, the barrier biases it, and progress may be minute; the handles are where they are wanted
    /// only as far as the springs draw them (see [`DeformEnergy::handles`](crate::deform::DeformEnergy)).
    ///
    /// # Arguments
    /// * `watch`: called with the number of each step and its positions.
    ///
    /// # Errors
    /// [`DeformError::Number`] for an option out of range; [`DeformError::SoftHandles`] for hard handles, which would tear the elements
    /// at their rims through zero at once; [`DeformError::Factor`].
    ///
    /// # Cost
    /// A factorisation a step, up to the limit.
    ///
    /// # Source
    /// Schüller, Kavan, Panozzo, Sorkine-Hornung 2013, sections 3 and 4.
    pub fn locally_injective(
        &self,
        options: &BarrierOptions,
        watch: &mut dyn FnMut(usize, &[f64]),
    ) -> Result<Compared, DeformError> {
        let BarrierOptions { barrier, weight, substeps, tolerance, max_iterations } = *options;
        positive(&[weight, substeps as f64, tolerance])?;
        if self.deformer.options().hold == Hold::Hard {
            return Err(DeformError::SoftHandles);
        }
        let rest = self.deformer.rest();
        let mut newton = Newton::new(self.deformer)?;
        let mut x = rest.positions();
        let energy = WithDeterminant { elastic: self.elastic(), part: Weighted { barrier, weight } };
        let (mut rounds, mut ending) = (0, Ending::IterationLimit);
        for substep in 1..=substeps {
            if newton.steps >= max_iterations {
                ending = Ending::IterationLimit;
                break;
            }
            rounds += 1;
            let share = substep as f64 / substeps as f64;
            let between = |(vertex, target): (&crate::field::VertexId, &[f64; 3])| {
                let from = rest.points()[vertex.index()];
                std::array::from_fn(|axis| from[axis] + share * (target[axis] - from[axis]))
            };
            let targets: Vec<[f64; 3]> = self.deformer.handles().iter().zip(self.targets).map(between).collect();
            let rule = Rule { tolerance, steps: max_iterations - newton.steps };
            ending = match rest.dimension() {
                2 => newton.minimise::<2, 4>(&energy, (&targets, &mut x), rule, watch)?,
                _ => newton.minimise::<3, 9>(&energy, (&targets, &mut x), rule, watch)?,
            };
        }
        self.compared(x, ending, (newton.steps, rounds))
    }
}
