//! After a contradiction: the closest shape without inversions that can be found by asking for less.

use super::polar::{mean_rotation, nearest_rotation};
use super::solver::Solved;
use super::{Begin, DeformError, DeformPreview, DeformSolver, DeformStatus, Deformed, Effort, Hold, SolveOptions, Substitute};
use crate::qp::{QpStatus, Settings};

/// Most rounds in which rotations are read anew.
const ROUNDS: usize = 6;

/// Steps of alternating unconstrained shapes and their rotations that every further round has more.
const SETTLING: usize = 4;

/// Most halvings of the way from the mean rotation to the asked ones.
const HALVINGS: i32 = 6;

/// Most iterations of one of these problems: where a problem needs more, other rotations are the better way.
const ITERATIONS: usize = 60;

/// Soft handles in place of hard ones.
const ALPHA: f64 = 1e4;

/// What was given up, the result, and the rotations that it is for.
type Found = (Substitute, Solved, Vec<[[f64; 3]; 3]>);

impl DeformSolver {
    /// Gives up what contradicts itself, the least first: hard handles become soft ones; then elements whose cone cannot hold take the
    /// rotation that they have in the shape found, round by round; then all rotations are drawn to their mean, for which the
    /// turned rest shape is feasible, so that there always is an end.
    pub(super) fn closest(
        &mut self,
        (asked, targets): (&[[[f64; 3]; 3]], &[[f64; 3]]),
        status: DeformStatus,
        first: Solved,
        options: &SolveOptions,
        (mut effort, preview): (Effort, &mut dyn FnMut(DeformPreview<'_>)),
    ) -> Result<Deformed, DeformError> {
        let settings = Settings { max_iterations: options.settings.max_iterations.min(ITERATIONS), ..options.settings };
        let options = &SolveOptions { settings, begin: Begin::Cold, ..*options };
        if self.deformer.options().hold == Hold::Hard {
            let softer = super::DeformOptions { hold: Hold::Soft { alpha: ALPHA }, ..self.deformer.options() };
            let mut soft = Self::with_rest(&self.complex, self.deformer.rest().clone(), self.held.clone(), softer)?;
            let solved = soft.decided(asked, targets, options, (&mut effort, &mut *preview))?;
            let is_enough = soft.is_usable(&solved)?;
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

    /// Reads the rotations of elements whose cone does not hold, or did not before, from a shape.
    fn reread(
        &self,
        (rotations, is_other): (&mut [[[f64; 3]; 3]], &mut [bool]),
        targets: &[[f64; 3]],
        positions: &[f64],
    ) -> Result<(), DeformError> {
        let margins = self.deformer.margins(targets);
        let smallest = self.deformer.rest().smallest_eigenvalues(rotations, positions)?;
        let gradients = self.deformer.rest().deformation_gradients(positions)?;
        for element in 0..rotations.len() {
            if smallest[element] < margins[element] || is_other[element] {
                rotations[element] = nearest_rotation(&gradients[element]);
                is_other[element] = true;
            }
        }
        Ok(())
    }

    /// Whether a problem has ended with a shape without inversions.
    pub(super) fn is_usable(&self, solved: &Solved) -> Result<bool, DeformError> {
        let is_open = !matches!(solved.solution.status, QpStatus::Infeasible(_));
        Ok(is_open && self.deformer.rest().determinants(&solved.positions)?.iter().all(|&determinant| determinant > 0.0))
    }

    /// Rotations near the asked ones for which there is a shape, and that shape.
    fn other_rotations(
        &mut self,
        (asked, targets): (&[[[f64; 3]; 3]], &[[f64; 3]]),
        first: Solved,
        options: &SolveOptions,
        (effort, preview): (&mut Effort, &mut dyn FnMut(DeformPreview<'_>)),
    ) -> Result<Found, DeformError> {
        let mut rotations = asked.to_vec();
        // Folded rest elements are where the asked rotations mean least.
        let mut is_other = vec![false; asked.len()];
        self.deformer.rest().folded().iter().for_each(|&element| is_other[element] = true);
        let mut solved = first;
        for rounds in 1..=ROUNDS {
            self.reread((&mut rotations, &mut is_other), targets, &solved.positions)?;
            // Where one reading is not enough, the unconstrained shape and its rotations are settled between the solves.
            for _ in 0..(rounds - 1) * SETTLING {
                let problem = self.deformer.problem(&rotations, targets)?;
                let x = self.engine.minimise(&problem.objective, &problem.fixed)?.x;
                effort.factorizations += 1;
                let positions = self.deformer.positions(targets, &x)?;
                self.reread((&mut rotations, &mut is_other), targets, &positions)?;
            }
            solved = self.decided(&rotations, targets, options, (&mut *effort, &mut *preview))?;
            if self.is_usable(&solved)? {
                let elements = is_other.iter().filter(|&&other| other).count();
                return Ok((Substitute::RotationsReread { rounds, elements }, solved, rotations));
            }
        }
        let mean = mean_rotation(asked, self.deformer.rest().measures());
        for halving in 1..=HALVINGS + 1 {
            let share = if halving > HALVINGS { 0.0 } else { 0.5f64.powi(halving) };
            rotations = asked.iter().map(|&rotation| mean_rotation(&[mean, rotation], &[1.0 - share, share])).collect();
            solved = self.decided(&rotations, targets, options, (&mut *effort, &mut *preview))?;
            if self.is_usable(&solved)? || halving > HALVINGS {
                return Ok((Substitute::RotationsBlended { share }, solved, rotations));
            }
        }
        Ok((Substitute::RotationsBlended { share: 0.0 }, solved, rotations))
    }
}
