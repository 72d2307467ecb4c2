//! After a contradiction: the closest shape without inversions that can be found by asking for less.

use super::polar::{mean_rotation, nearest_rotation};
use super::solver::Solved;
use super::{Blame, DeformError, DeformPreview, DeformSolver, DeformStatus, Deformed, Effort, Hold, SolveOptions, Substitute};
use crate::qp::QpStatus;

/// Most rounds in which rotations are read anew.
const ROUNDS: usize = 6;

/// Most halvings of the way from the mean rotation to the asked ones.
const HALVINGS: i32 = 6;

/// Soft handles in place of hard ones.
const ALPHA: f64 = 1e4;

impl DeformSolver {
    /// Gives up what contradicts itself, the least first: hard handles become soft ones; then elements whose cone cannot hold take the
    /// rotation that they have in the shape found, round by round; then all rotations are drawn to their mean, for which the
    /// turned rest shape is feasible, so that there always is an end.
    pub(super) fn closest(
        &mut self,
        (asked, targets): (&[[[f64; 3]; 3]], &[[f64; 3]]),
        blame: Blame,
        first: Solved,
        options: &SolveOptions,
        (mut effort, preview): (Effort, &mut dyn FnMut(DeformPreview<'_>)),
    ) -> Result<Deformed, DeformError> {
        let status = DeformStatus::Contradiction(blame);
        if self.deformer.options().hold == Hold::Hard {
            let softer = super::DeformOptions { hold: Hold::Soft { alpha: ALPHA }, ..self.deformer.options() };
            let mut soft = Self::with_rest(&self.complex, self.deformer.rest().clone(), self.held.clone(), softer)?;
            let solved = soft.decided(asked, targets, options, (&mut effort, &mut *preview))?;
            let is_enough = !matches!(solved.solution.status, QpStatus::Infeasible(_));
            let found = (Substitute::SoftHandles, solved, asked.to_vec());
            let (substitute, solved, rotations) =
                if is_enough { found } else { soft.other_rotations((asked, targets), found.1, options, (&mut effort, preview))? };
            let mut deformed = soft.report(status, (rotations, targets), solved, options, effort)?;
            deformed.substitute = Some(substitute);
            return Ok(deformed);
        }
        let (substitute, solved, rotations) = self.other_rotations((asked, targets), first, options, (&mut effort, preview))?;
        let mut deformed = self.report(status, (rotations, targets), solved, options, effort)?;
        deformed.substitute = Some(substitute);
        Ok(deformed)
    }

    /// Rotations near the asked ones for which there is a shape, and that shape.
    fn other_rotations(
        &mut self,
        (asked, targets): (&[[[f64; 3]; 3]], &[[f64; 3]]),
        first: Solved,
        options: &SolveOptions,
        (effort, preview): (&mut Effort, &mut dyn FnMut(DeformPreview<'_>)),
    ) -> Result<(Substitute, Solved, Vec<[[f64; 3]; 3]>), DeformError> {
        let margins = self.deformer.margins(targets);
        let mut rotations = asked.to_vec();
        let mut is_other = vec![false; asked.len()];
        let mut solved = first;
        for rounds in 1..=ROUNDS {
            let smallest = self.deformer.rest().smallest_eigenvalues(&rotations, &solved.positions)?;
            let gradients = self.deformer.rest().deformation_gradients(&solved.positions)?;
            for element in 0..asked.len() {
                if smallest[element] < margins[element] || is_other[element] {
                    rotations[element] = nearest_rotation(&gradients[element]);
                    is_other[element] = true;
                }
            }
            solved = self.decided(&rotations, targets, options, (&mut *effort, &mut *preview))?;
            if !matches!(solved.solution.status, QpStatus::Infeasible(_)) {
                let elements = is_other.iter().filter(|&&other| other).count();
                return Ok((Substitute::RotationsReread { rounds, elements }, solved, rotations));
            }
        }
        let mean = mean_rotation(asked, self.deformer.rest().measures());
        for halving in 1..=HALVINGS + 1 {
            let share = if halving > HALVINGS { 0.0 } else { 0.5f64.powi(halving) };
            rotations = asked.iter().map(|&rotation| mean_rotation(&[mean, rotation], &[1.0 - share, share])).collect();
            solved = self.decided(&rotations, targets, options, (&mut *effort, &mut *preview))?;
            if !matches!(solved.solution.status, QpStatus::Infeasible(_)) || halving > HALVINGS {
                return Ok((Substitute::RotationsBlended { share }, solved, rotations));
            }
        }
        Ok((Substitute::RotationsBlended { share: 0.0 }, solved, rotations))
    }
}
