//! Minimisers with some unknowns fixed and no rows: one factorisation, then any number of refined solves.

use super::engine::{COLUMNS, Engine};
use super::kkt::backward_error;
use super::problem::check_fixed;
use super::product::{add, dot, largest};
use super::{Objective, QpError};

/// Most refinement steps; formed matrices that contract at all need two or three.
const STEPS: usize = 12;

/// The minimiser of an objective with some unknowns fixed.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The minimiser, n numbers.
    pub x: Vec<f64>,
    /// The objective there, with its constant.
    pub objective: f64,
    /// Largest entry of the gradient at a free unknown, relative to the largest force (linear term, gradient at a fixed unknown).
    pub stationarity: f64,
    /// What rounding may leave in `stationarity`, as in [`KktResiduals`](super::KktResiduals).
    pub rounding: f64,
    /// Largest entry of the gradient at a free unknown relative to the sum of the sizes of the addends it is made of, in product form: the
    /// componentwise backward error.
    pub backward: f64,
    /// Solves that were needed.
    pub solves: usize,
}

/// One objective with one set of fixed unknowns, factored: minimisers and solves for many right-hand sides.
///
/// Made by [`Engine::pin`]; it borrows the engine, so that the next objective reuses the analysis.
pub struct PinnedSolver<'a> {
    engine: &'a mut Engine,
    objective: &'a Objective,
    start: Vec<f64>,
}

impl Engine {
    /// Factors an objective on its free unknowns.
    ///
    /// # Arguments
    /// * `objective`: inside the engine's pattern; where only scales or diagonals changed since the last call, nothing is formed anew.
    /// * `fixed`: the value of each fixed unknown, n entries.
    ///
    /// # Errors
    /// [`QpError::NotConvex`] where the form is not positive definite on the free unknowns even after a shift; shapes.
    ///
    /// # Cost
    /// One numeric factorisation.
    pub fn pin<'a>(&'a mut self, objective: &'a Objective, fixed: &[Option<f64>]) -> Result<PinnedSolver<'a>, QpError> {
        self.assemble(objective, fixed)?;
        self.factor_base()?;
        let start = fixed.iter().map(|value| value.unwrap_or(0.0)).collect();
        Ok(PinnedSolver { engine: self, objective, start })
    }

    /// The minimiser of an objective with some unknowns fixed: [`Engine::pin`], then [`PinnedSolver::minimise`].
    ///
    /// # Errors
    /// As [`Engine::pin`].
    ///
    /// # Example
    /// ```
    /// use morsmooth::qp::{Engine, Objective, Term};
    /// // Half the squared distance to (3, 4), with the second unknown fixed at 1.
    /// let objective = Objective { terms: vec![Term::Diagonal(vec![1.0, 1.0])], linear: vec![-3.0, -4.0], constant: 12.5 };
    /// let mut engine = Engine::new(&objective, None, None)?;
    /// let minimum = engine.minimise(&objective, &[None, Some(1.0)])?;
    /// assert_eq!(minimum.x, [3.0, 1.0]);
    /// assert_eq!(minimum.objective, 4.5);
    /// # Ok::<(), morsmooth::qp::QpError>(())
    /// ```
    pub fn minimise(&mut self, objective: &Objective, fixed: &[Option<f64>]) -> Result<Minimum, QpError> {
        Ok(self.pin(objective, fixed)?.minimise())
    }

    /// One numeric factorisation and one solve, unrefined: the floor that the time of whole solves is measured against.
    ///
    /// # Errors
    /// As [`Engine::pin`].
    pub fn factor_and_solve(&mut self, objective: &Objective, fixed: &[Option<f64>]) -> Result<Vec<f64>, QpError> {
        self.assemble(objective, fixed)?;
        self.reset_values();
        let mut side = objective.linear.clone();
        self.mask(&mut side);
        self.factor_values()?;
        self.system.solve_in_place(&self.symbolic, &mut side);
        Ok(side)
    }
}

impl PinnedSolver<'_> {
    /// The minimiser, refined with gradients in product form until they no longer improve.
    pub fn minimise(&mut self) -> Minimum {
        let mut x = self.start.clone();
        let n = x.len();
        let mut gradient = vec![0.0; n];
        let mut step = vec![0.0; n];
        let mut solves = 0;
        let mut first = f64::INFINITY;
        let mut before = f64::INFINITY;
        for _ in 0..STEPS {
            self.objective.gradient_into(&x, &mut gradient);
            self.engine.mask(&mut gradient);
            for value in &mut gradient {
                *value = -*value;
            }
            let (taken, _) = self.engine.solve_refined(self.objective, None, &gradient, &mut step, (1e-2, STEPS));
            solves += taken;
            // Twice the energy that is still to be gained; refinement has done its work once it no longer falls.
            let gain = dot(&gradient, &step);
            if !gain.is_finite() || gain <= 0.0 || gain > 0.25 * before {
                break;
            }
            add(&mut x, 1.0, &step);
            if first.is_infinite() {
                first = gain;
            }
            before = gain;
            if gain <= 1e-30 * first {
                break;
            }
        }
        self.objective.gradient_into(&x, &mut gradient);
        let mut forces = gradient.clone();
        for (force, &fixed) in forces.iter_mut().zip(&self.engine.is_fixed) {
            if !fixed {
                *force = 0.0;
            }
        }
        self.engine.mask(&mut gradient);
        let scale = largest(&forces).max(largest(&self.objective.linear));
        let relative = |size: f64| if scale > 0.0 { size / scale } else { size };
        let stationarity = relative(largest(&gradient));
        self.objective.addends_into(&x, &mut step, &mut self.engine.scratch);
        let backward = backward_error(&gradient, &step);
        self.engine.mask(&mut step);
        let rounding = relative(4.0 * f64::EPSILON * largest(&step));
        Minimum { objective: self.objective.value(&x), x, stationarity, rounding, backward, solves }
    }

    /// The minimiser with other values at the same fixed unknowns; the factor serves for all of them.
    ///
    /// # Arguments
    /// * `fixed`: n entries, values where [`Engine::pin`] was given some.
    ///
    /// # Errors
    /// [`QpError::Length`], [`QpError::NotFinite`], [`QpError::FixedSet`] if other unknowns are fixed.
    ///
    /// # Cost
    /// A few solves.
    pub fn minimise_at(&mut self, fixed: &[Option<f64>]) -> Result<Minimum, QpError> {
        check_fixed(fixed, self.start.len())?;
        if let Some(unknown) = (0..fixed.len()).find(|&unknown| fixed[unknown].is_some() != self.engine.is_fixed[unknown]) {
            return Err(QpError::FixedSet { unknown });
        }
        self.start = fixed.iter().map(|value| value.unwrap_or(0.0)).collect();
        Ok(self.minimise())
    }

    /// Overwrites right-hand sides r with the solutions of `P d = r` on the free unknowns, `d = 0` on the fixed ones.
    ///
    /// # Arguments
    /// * `sides`: any number of right-hand sides, n numbers each, one after the other; entries at fixed unknowns are ignored.
    ///
    /// # Returns
    /// The largest relative residual (2-norm) left, measured in product form.
    ///
    /// # Cost
    /// Two solves a right-hand side, eight sides at a time; a third and more only where the factor has lost its digits.
    pub fn solve(&mut self, sides: &mut [f64]) -> Result<f64, QpError> {
        let n = self.engine.unknowns();
        if n == 0 || !sides.len().is_multiple_of(n) {
            return if sides.is_empty() { Ok(0.0) } else { Err(QpError::Length { array: "sides", expected: n, found: sides.len() }) };
        }
        let mut worst: f64 = 0.0;
        for block in sides.chunks_mut(n * COLUMNS) {
            for side in block.chunks_mut(n) {
                self.engine.mask(side);
            }
            let wanted = block.to_vec();
            let mut residual = block.to_vec();
            block.fill(0.0);
            let mut before = f64::INFINITY;
            for _ in 0..STEPS {
                self.engine.system.solve_in_place(&self.engine.symbolic, &mut residual);
                add(block, 1.0, &residual);
                let now = self.residuals(block, &wanted, &mut residual);
                if now > 0.25 * before {
                    if now > before {
                        before = now;
                    }
                    break;
                }
                before = now;
                if now <= 1e-13 {
                    break;
                }
            }
            worst = worst.max(before);
        }
        Ok(worst)
    }

    /// `residual := wanted - P x`, column by column; the largest relative 2-norm.
    fn residuals(&mut self, x: &[f64], wanted: &[f64], residual: &mut [f64]) -> f64 {
        let n = self.engine.unknowns();
        let mut worst: f64 = 0.0;
        for ((x, wanted), residual) in x.chunks(n).zip(wanted.chunks(n)).zip(residual.chunks_mut(n)) {
            self.objective.product_into(x, residual, &mut self.engine.scratch);
            for (slot, wanted) in residual.iter_mut().zip(wanted) {
                *slot = wanted - *slot;
            }
            self.engine.mask(residual);
            let size = dot(wanted, wanted).sqrt();
            if size > 0.0 {
                worst = worst.max(dot(residual, residual).sqrt() / size);
            }
        }
        worst
    }
}
