//! Whether rotations leave any shape at all: a question without a scale, asked where the solver could not decide.

use super::solver::Solved;
use super::{DeformError, DeformOptions, DeformPreview, DeformSolver, Deformer, Effort, Hold, SolveOptions};
use crate::qp::{QpStatus, Settings};

/// Margin of the question. Soft handles let a shape shrink to nothing, where every cone is violated by no more than the tiny margin of the
/// problem; with a margin of the order of one no shape comes near by shrinking.
const MARGIN: f64 = 0.5;

/// Stiffness of all springs together, relative to that of the shape: they keep the shape in its place, and move nothing.
const SPRINGS: f64 = 1e-3;

impl DeformSolver {
    /// As [`DeformSolver::solve_once`]; where that ends undecided, the rotations alone are asked for a shape first.
    ///
    /// The cones `sym(RᵀF) - eps I` are those of a linear map but for eps: if one shape is in them with a margin of 1/2, so is a multiple of it with
    /// any other margin, and if none is, none is with any margin above zero. Of soft handles this is a proof for the problem itself: its status is
    /// then [`QpStatus::Infeasible`] with the certificate of the question. If there is a shape, the solve begins anew at it.
    pub(super) fn decided(
        &mut self,
        rotations: &[[[f64; 3]; 3]],
        targets: &[[f64; 3]],
        options: &SolveOptions,
        (effort, preview): (&mut Effort, &mut dyn FnMut(DeformPreview<'_>)),
    ) -> Result<Solved, DeformError> {
        let mut solved = self.solve_once(rotations, targets, options, (&mut *effort, preview))?;
        let is_undecided = matches!(solved.solution.status, QpStatus::IterationLimit | QpStatus::Stalled);
        if !is_undecided || self.deformer.options().hold == Hold::Hard {
            return Ok(solved);
        }
        let (status, shape) = self.shape_for(rotations, effort)?;
        match status {
            QpStatus::Infeasible(certificate) => solved.solution.status = QpStatus::Infeasible(certificate),
            QpStatus::Solved => {
                let problem = self.deformer.problem(rotations, targets)?;
                let reference = self.deformer.reference(targets)?;
                let start: Vec<f64> = shape.iter().zip(&reference).map(|(place, base)| place - base).collect();
                let solution = self.engine.solve(&problem, Some(&start), &options.settings, &mut |_| {})?;
                effort.add(&solution);
                let positions = self.deformer.positions(targets, &solution.x)?;
                let inverted = |positions: &[f64]| -> Result<usize, DeformError> {
                    Ok(self.deformer.rest().determinants(positions)?.iter().filter(|det| !(**det > 0.0)).count())
                };
                if solution.status == QpStatus::Solved || inverted(&positions)? < inverted(&solved.positions)? {
                    solved = Solved { solution, positions };
                }
            }
            QpStatus::IterationLimit | QpStatus::Stalled => {}
        }
        Ok(solved)
    }

    /// Looks for any shape with these rotations, wherever its handles are.
    fn shape_for(&mut self, rotations: &[[[f64; 3]; 3]], effort: &mut Effort) -> Result<(QpStatus, Vec<f64>), DeformError> {
        let rest = self.deformer.rest();
        let total: f64 = rest.measures().iter().sum();
        let alpha = SPRINGS * total / (self.complex.bounding_box_diagonal().powi(2) * self.held.vertices.len() as f64);
        let options = DeformOptions { hold: Hold::Soft { alpha }, ..self.deformer.options() };
        let free = Deformer::with_rest(rest.clone(), &self.held.vertices, options)?;
        let targets: Vec<[f64; 3]> = self.held.vertices.iter().map(|vertex| self.complex.point(*vertex)).collect();
        let mut problem = free.problem(rotations, &targets)?;
        let margins = free.margins(&targets);
        for ((first, order), margin) in problem.constraints.member_rows().collect::<Vec<_>>().into_iter().zip(margins) {
            // The diagonal of a scaled vector is at places 0, 2 and 5.
            for place in &[0, 2, 5][..order] {
                problem.constraints.offset[first + place] -= MARGIN - margin;
            }
        }
        let settings = Settings { relative_gap: 1e-2, ..Settings::default() };
        let solution = self.engine.solve(&problem, None, &settings, &mut |_| {})?;
        effort.add(&solution);
        let positions = free.positions(&targets, &solution.x)?;
        Ok((solution.status, positions))
    }
}
