//! Whether rotations leave any shape at all: a question without a scale, asked where the solver could not decide.

use super::solver::Solved;
use super::{Begin, DeformError, DeformOptions, DeformPreview, DeformSolver, Deformer, Effort, Hold, RestShape, SolveOptions};
use crate::linalg::small::{Square, scaled_length, symmetric_eigen, to_scaled};
use crate::qp::{Certificate, QpStatus, Settings};

/// Margin of the question. Soft handles let a shape shrink to nothing, where every cone is violated by no more than the tiny margin of the
/// problem; with a margin of the order of one no shape comes near by shrinking.
const MARGIN: f64 = 0.5;

/// Stiffness of all springs together, relative to that of the shape: they keep the shape in its place, and move nothing.
const SPRINGS: f64 = 1e-3;

/// Neighbours count as turned half a turn against each other if `1 + cos` of their angle is below this: a shape would have to be
/// stretched a million times.
const OPPOSED: f64 = 1e-12;

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
        let is_undecided = |solved: &Solved| matches!(solved.solution.status, QpStatus::IterationLimit | QpStatus::Stalled);
        if is_undecided(&solved) && options.begin == Begin::Warm {
            // Where no cone holds the shape back any more, only a cold start sees it.
            solved = self.solve_once(rotations, targets, &SolveOptions { begin: Begin::Cold, ..*options }, (&mut *effort, preview))?;
        }
        if !is_undecided(&solved) || self.deformer.options().hold == Hold::Hard {
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
                    Ok(self.deformer.rest().determinants(positions)?.iter().filter(|det| det.is_nan() || **det <= 0.0).count())
                };
                if solution.status == QpStatus::Solved || inverted(&positions)? < inverted(&solved.positions)? {
                    solved = Solved { solution, positions };
                }
            }
            QpStatus::IterationLimit | QpStatus::Stalled | QpStatus::CutOff => {
                let margins = self.deformer.margins(targets);
                if let Some(certificate) = opposed_neighbours(self.deformer.rest(), rotations, &margins) {
                    solved.solution.status = QpStatus::Infeasible(certificate);
                }
            }
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

/// The proof by two neighbours that are turned half a turn against each other, the first such pair.
///
/// There is a direction t in their common facet with `R_1 t = -R_2 t`. Both map it to the same `F t`, so that
/// `tᵀ R_1ᵀ F_1 t + tᵀ R_2ᵀ F_2 t = 0` whatever the shape: the ray has `t tᵀ` at both blocks.
fn opposed_neighbours(rest: &RestShape, rotations: &[Square<3>], margins: &[f64]) -> Option<Certificate> {
    let dimension = rest.dimension();
    let mut facets: Vec<([u32; 3], u32)> = Vec::with_capacity(rest.element_count() * (dimension + 1));
    for element in 0..rest.element_count() {
        let corners = rest.corners(element);
        for omitted in 0..corners.len() {
            let mut facet = [u32::MAX; 3];
            let kept = (0..corners.len()).filter(|&corner| corner != omitted);
            facet.iter_mut().zip(kept).for_each(|(slot, corner)| *slot = corners[corner]);
            facets.push((facet, element as u32));
        }
    }
    facets.sort_unstable();
    let cosine = |one: usize, other: usize| {
        let product = |axis: usize, column: usize| rotations[one][axis][column] * rotations[other][axis][column];
        let trace: f64 = (0..dimension).flat_map(|axis| (0..dimension).map(move |column| (axis, column))).map(|(a, c)| product(a, c)).sum();
        // The trace of a rotation by an angle is 2 cos in the plane, 1 + 2 cos in space.
        0.5 * (trace - if dimension == 2 { 0.0 } else { 1.0 })
    };
    let pair = facets.windows(2).find(|pair| pair[0].0 == pair[1].0 && 1.0 + cosine(pair[0].1 as usize, pair[1].1 as usize) < OPPOSED)?;
    let (facet, [one, other]) = (pair[0].0, [pair[0].1 as usize, pair[1].1 as usize]);
    let direction = opposed_direction(rest, facet, [&rotations[one], &rotations[other]])?;
    let square: Square<3> = std::array::from_fn(|i| std::array::from_fn(|j| direction[i] * direction[j]));
    let rows = scaled_length(dimension);
    let mut ray = vec![0.0; rest.element_count() * rows];
    for element in [one, other] {
        let mut scaled = [0.0; 6];
        to_scaled(&square, &mut scaled);
        ray[element * rows..][..rows].copy_from_slice(&scaled[..rows]);
    }
    Some(Certificate {
        constraints: vec![one.min(other), one.max(other)],
        multipliers: vec![1.0; 2],
        conflict: -(margins[one] + margins[other]),
        residual: 0.0,
        relaxations: Vec::new(),
        least_objective: None,
        ray,
    })
}

/// The unit vector t in a facet, in the rest shape, for which `R_1 t + R_2 t` is shortest.
fn opposed_direction(rest: &RestShape, facet: [u32; 3], [first, second]: [&Square<3>; 2]) -> Option<[f64; 3]> {
    let at = |corner: usize| rest.points()[facet[corner] as usize];
    let side = |corner: usize| -> [f64; 3] { std::array::from_fn(|axis| at(corner)[axis] - at(0)[axis]) };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let unit = |a: [f64; 3]| {
        let length = dot(a, a).sqrt();
        (length > 0.0).then(|| a.map(|part| part / length))
    };
    let along = unit(side(1))?;
    if rest.dimension() == 2 {
        return Some(along);
    }
    let across = side(2);
    let share = dot(along, across);
    let across = unit(std::array::from_fn(|axis| across[axis] - share * along[axis]))?;
    let sum = |t: [f64; 3]| -> [f64; 3] { std::array::from_fn(|row| dot(first[row], t) + dot(second[row], t)) };
    let (a, b) = (sum(along), sum(across));
    let (_, vectors) = symmetric_eigen(&[[dot(a, a), dot(a, b)], [dot(a, b), dot(b, b)]]);
    Some(std::array::from_fn(|axis| vectors[0][0] * along[axis] + vectors[1][0] * across[axis]))
}
