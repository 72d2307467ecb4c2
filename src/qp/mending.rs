//! Rows that were decided wrongly, active or not, are mended with the factor at hand.
//!
//! A factor of `P + Aᵀ ρ A` holds the rows that were taken for active and lets go of the others. A step with it shows which of them are not what they
//! were taken for; these are given slacks and multipliers of their own, exactly ([`super::complementarity`]), and what that does to the
//! other rows shows by one more solve. When no more rows turn up, the step is the minimum over x of the augmented Lagrangian
//!
//! ```text
//! 1/2 xᵀ P x + qᵀ x + Σ σ/2 max(z/σ - (A x + b), 0)².
//! ```
//!
//! What makes it cheap is that a row reaches few columns of the factor: the compliance of five hundred rows costs less than a tenth of a factorisation
//! at 250,000 unknowns.

use crate::linalg::{Compliance, SparseRow};

use super::complementarity::{Row, solve};
use super::interior::Interior;
use super::product::add;

/// Most solves that look for more rows in a step.
const PASSES: usize = 6;

/// The rows that are mended with the present factor.
pub(super) struct Mending {
    most: usize,
    rows: Vec<usize>,
    is_member: Vec<bool>,
    is_active: Vec<bool>,
    /// As the factor has it, for all rows.
    was_active: Vec<bool>,
    compliance: Compliance,
}

impl Mending {
    /// Begins with a new factor, for at most so many rows.
    pub fn new(most: usize, was_active: Vec<bool>) -> Self {
        let is_member = vec![false; was_active.len()];
        Self { most, rows: Vec::new(), is_member, is_active: Vec::new(), was_active, compliance: Compliance::new() }
    }

    /// Whether no row was mended yet.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

impl Interior<'_> {
    /// Takes the step at hand, and mends the rows that it shows to be decided wrongly.
    ///
    /// # Arguments
    /// * `targets`: weight of each row where it is active.
    ///
    /// # Returns
    /// Whether no wrong rows are left.
    pub(super) fn mended_step(&mut self, mending: &mut Mending, targets: &[f64]) -> bool {
        add(&mut self.point.x, 1.0, &self.step.x);
        let base: Vec<f64> = self.point.s.iter().zip(&self.step.s).map(|(s, step)| s + step).collect();
        let mut value = base.clone();
        let mut side = vec![0.0; self.point.x.len()];
        let mut forces = Vec::new();
        let mut is_mended = false;
        for pass in 0..PASSES {
            let (point, weights) = (&self.point, &self.scaling.weights);
            let is_wrong = |&row: &usize| {
                !mending.is_member[row] && (value[row] - point.z[row] / weights[row] < 0.0) != mending.was_active[row]
            };
            let wrong: Vec<usize> = (0..value.len()).filter(is_wrong).collect();
            is_mended = wrong.is_empty();
            if is_mended && (pass > 0 || mending.is_empty()) || mending.rows.len() + wrong.len() > mending.most {
                break;
            }
            self.join(mending, &wrong);
            let is_settled;
            (forces, is_settled) = self.forces(mending, targets, &base);
            side.fill(0.0);
            for (&row, force) in mending.rows.iter().zip(&forces) {
                let (columns, values) = self.rows.matrix.row(row);
                for (&column, value) in columns.iter().zip(values) {
                    side[column as usize] += value * force;
                }
            }
            self.engine.system.solve_in_place(&self.engine.symbolic, &mut side);
            self.solves += 1;
            self.rows.image_into(&side, &mut value);
            add(&mut value, 1.0, &base);
            if !is_settled {
                break;
            }
        }
        add(&mut self.point.x, 1.0, &side);
        self.settle(mending, targets, &forces, &value);
        is_mended
    }

    /// Takes wrong rows among those that are mended.
    fn join(&self, mending: &mut Mending, wrong: &[usize]) {
        let sparse = |&row: &usize| {
            let (columns, values) = self.rows.matrix.row(row);
            columns.iter().copied().zip(values.iter().copied()).collect()
        };
        let mut sparse: Vec<SparseRow> = wrong.iter().map(sparse).collect();
        self.engine.system.comply(&self.engine.symbolic, &mut mending.compliance, &mut sparse);
        wrong.iter().for_each(|&row| mending.is_member[row] = true);
        mending.rows.extend(wrong);
        mending.is_active.extend(wrong.iter().map(|&row| !mending.was_active[row]));
    }

    /// The forces that make slacks and duals of the mended rows complementary.
    ///
    /// # Arguments
    /// * `base`: values of all rows without these forces.
    fn forces(&self, mending: &mut Mending, targets: &[f64], base: &[f64]) -> (Vec<f64>, bool) {
        let known = |&row: &usize| Row {
            weight: self.scaling.weights[row],
            target: targets[row],
            value: base[row],
            slack: self.point.s[row],
            dual: self.point.z[row],
        };
        let known: Vec<Row> = mending.rows.iter().map(known).collect();
        solve(&mending.compliance, &known, &mut mending.is_active)
    }

    /// Slacks and duals at the new values of the rows.
    fn settle(&mut self, mending: &Mending, targets: &[f64], forces: &[f64], value: &[f64]) {
        let (point, weights) = (&mut self.point, &self.scaling.weights);
        for ((&row, &is_active), more) in mending.rows.iter().zip(&mending.is_active).zip(forces) {
            let (s, z) = (point.s[row], point.z[row]);
            (point.s[row], point.z[row]) = if is_active {
                (0.0, (z + more - weights[row] * (value[row] - s)).max(0.0))
            } else {
                ((value[row] - z / targets[row]).max(0.0), 0.0)
            };
        }
        for row in (0..value.len()).filter(|&row| !mending.is_member[row]) {
            let r = value[row] - point.z[row] / weights[row];
            point.s[row] = r.max(0.0);
            point.z[row] = weights[row] * (-r).max(0.0);
        }
    }
}
