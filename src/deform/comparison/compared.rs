//! One shape with handles, rotations and targets, on which every method can be run.

use super::local::Elastic;
use super::newton::{Newton, Rule};
use crate::deform::{DeformEnergy, DeformError, Deformer};

/// How a method of comparison ended. It says nothing of inversions: see [`Compared::inverted`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// By its own rule: at its minimum, or a local one.
    Converged,
    /// Its iterations ran out.
    IterationLimit,
    /// No step made progress any more.
    Stuck,
}

/// What a method of comparison ended with.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// Coordinates, `n x dim`.
    pub positions: Vec<f64>,
    /// How it ended.
    pub ending: Ending,
    /// Newton steps; each is a factorisation.
    pub iterations: usize,
    /// Rounds of the outer loop: penalty parameters, moves of the handles, updates of multipliers.
    pub rounds: usize,
    /// Elements with `det F <= 0`, rising.
    pub inverted: Vec<usize>,
    /// The deformation energy, without penalties and barriers.
    pub energy: DeformEnergy,
}

/// The problem of a [`Deformer`] for given rotations and targets, for the methods that it is compared with.
///
/// # Example
/// ```
/// use morsmooth::{deform::{Comparison, DeformOptions, Deformer}, mesh::SimplicialComplex};
/// // A square whose right side is pushed through its left one: without constraints it turns inside out.
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let square = SimplicialComplex::new(2, points, vec![0, 1, 2, 0, 2, 3])?;
/// let handles = [0, 1, 2, 3].map(Into::into);
/// let targets = [[0.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let deformer = Deformer::new(&square, &handles, DeformOptions::default())?;
/// let rotations = [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]; 2];
/// let comparison = Comparison::new(&deformer, &rotations, &targets)?;
/// assert_eq!(comparison.ex_rotated()?.inverted, [0, 1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Comparison<'a> {
    pub(super) deformer: &'a Deformer,
    pub(super) rotations: &'a [[[f64; 3]; 3]],
    pub(super) targets: &'a [[f64; 3]],
}

impl<'a> Comparison<'a> {
    /// Checks rotations and targets.
    ///
    /// # Arguments
    /// As for [`Deformer::problem`].
    ///
    /// # Errors
    /// As [`Deformer::problem`].
    pub fn new(deformer: &'a Deformer, rotations: &'a [[[f64; 3]; 3]], targets: &'a [[f64; 3]]) -> Result<Self, DeformError> {
        deformer.energy(rotations, targets, &deformer.reference(targets)?)?;
        Ok(Self { deformer, rotations, targets })
    }

    /// Ex-rotated skinning: the minimiser of the energy without any constraint.
    ///
    /// # Errors
    /// [`DeformError::Factor`].
    ///
    /// # Cost
    /// One factorisation, one solve.
    ///
    /// # Source
    /// Gao, Mitchell, Sifakis 2014, *Steklov–Poincaré skinning*; Liu et al. 2016, equations 1 and 2.
    pub fn ex_rotated(&self) -> Result<Compared, DeformError> {
        let mut newton = Newton::new(self.deformer)?;
        let mut x = self.deformer.reference(self.targets)?;
        let ending = self.minimise_elastic(&mut newton, &mut x)?;
        self.compared(x, ending, (newton.steps, 1))
    }

    /// One Newton step is exact for a quadratic energy; so is the solve, but for rounding.
    pub(super) fn minimise_elastic(&self, newton: &mut Newton<'_>, x: &mut Vec<f64>) -> Result<Ending, DeformError> {
        // The decrement of the only step is large; it says nothing here.
        let rule = Rule { tolerance: f64::INFINITY, steps: 1 };
        let targets = self.targets;
        match self.deformer.rest().dimension() {
            2 => newton.minimise::<2, 4>(&self.elastic(), (targets, x), rule, &mut |_, _| {}),
            _ => newton.minimise::<3, 9>(&self.elastic(), (targets, x), rule, &mut |_, _| {}),
        }
    }

    /// The energy on which all methods build.
    pub(super) fn elastic(&self) -> Elastic<'a> {
        Elastic {
            measures: self.deformer.rest().measures(),
            rotations: self.rotations,
            nu: self.deformer.options().incompressibility,
        }
    }

    /// Judges where a method ended.
    pub(super) fn compared(&self, positions: Vec<f64>, ending: Ending, (iterations, rounds): (usize, usize)) -> Result<Compared, DeformError> {
        let determinants = self.deformer.rest().determinants(&positions)?;
        let inverted = (0..determinants.len()).filter(|&element| determinants[element].is_nan() || determinants[element] <= 0.0).collect();
        let energy = self.deformer.energy(self.rotations, self.targets, &positions)?;
        Ok(Compared { positions, ending, iterations, rounds, inverted, energy })
    }
}
