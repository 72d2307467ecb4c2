//! One pattern, analysed once: the quadratic form in it, its factor, and solves refined in product form.

use std::sync::Arc;

use crate::linalg::{CsrMatrix, FactorError, SymbolicCholesky, fill_reducing_order};

use super::mixed::{KktForm, Layout};
use super::problem::check_fixed;
use super::product::{Scratch, add, dot};
use super::rows::Rows;
use super::scaling::Scaling;
use super::system::{FactorPrecision, System};
use super::{Objective, QpError, Term};

/// Right-hand sides that the factor takes at a time.
pub(super) const COLUMNS: usize = 8;

/// The solver of all problems whose quadratic form and rows stay within one sparsity pattern.
///
/// Terms may be re-weighted or change their numbers, the set of fixed unknowns may change, rows may come and go:
/// the order of elimination and the analysis are paid once, in [`Engine::new`]. Fixed unknowns stay in the pattern as
/// rows of the identity.
pub struct Engine {
    unknowns: usize,
    pub(super) symbolic: Arc<SymbolicCholesky>,
    pub(super) system: System,
    pub(super) precision: FactorPrecision,
    /// Slot of the diagonal entry of each x.
    diagonal: Arc<[u32]>,
    /// Row and column of each stored value, in the system's numbering.
    places: Arc<[(u32, u32)]>,
    formed: Vec<Arc<Formed>>,
    /// The quadratic form on the free unknowns, identity on the fixed ones.
    base: Vec<f64>,
    /// What a chain that is not formed would add to the diagonal; empty where it is formed.
    chain_diagonal: Vec<f64>,
    pub(super) values: Vec<f64>,
    pub(super) is_fixed: Vec<bool>,
    pub(super) scratch: Scratch,
    refinement: [Vec<f64>; 4],
    pub(super) factorizations: usize,
    /// The factor is that of `values`, without a shift.
    is_factored: bool,
}

/// A term's matrix in the engine's slots, without the scale of a chain, and the term it was formed from.
struct Formed {
    term: Term,
    slots: Vec<u32>,
    values: Vec<f64>,
    /// The diagonal of a chain that is not formed; else empty.
    diagonal: Vec<f64>,
}

impl Engine {
    /// Analyses the pattern of an objective.
    ///
    /// # Arguments
    /// * `objective`: n unknowns; only the patterns of its terms matter here.
    /// * `rows`: `m x n` rows whose unknowns the pattern must couple, unless P couples them already (rows between mesh
    ///   neighbours always lie inside the pattern of a chain). For blocks: [`Constraints::coupling`](super::Constraints::coupling).
    /// * `coordinates`: a place for each unknown, any unit; turns on nested dissection from 3,000 unknowns (or vertices) on.
    ///
    /// # Errors
    /// [`QpError`] for wrong shapes and non-finite numbers; [`QpError::Factor`] from the analysis.
    ///
    /// # Cost
    /// About one numeric factorisation.
    pub fn new(objective: &Objective, rows: Option<&CsrMatrix>, coordinates: Option<&[[f64; 3]]>) -> Result<Self, QpError> {
        Self::in_form(objective, rows, coordinates, KktForm::Automatic)
    }

    /// As [`Engine::new`], with the linear systems in a form of one's choice.
    ///
    /// # Errors
    /// As [`Engine::new`].
    pub fn in_form(
        objective: &Objective,
        rows: Option<&CsrMatrix>,
        coordinates: Option<&[[f64; 3]]>,
        form: KktForm,
    ) -> Result<Self, QpError> {
        objective.check()?;
        let unknowns = objective.unknowns();
        let layout = Layout::choose(objective, form);
        let unformed = layout.and_then(|layout| layout.chain_in(&objective.terms));
        let formed = |(index, term)| if unformed == Some(index) { None } else { formed_matrix(term) };
        let matrices: Vec<Option<CsrMatrix>> = objective.terms.iter().enumerate().map(formed).collect();
        let coupling = rows.map(|rows| rows.transpose().weighted_product(&vec![1.0; rows.rows()], rows));
        let patterns: Vec<&CsrMatrix> = matrices.iter().flatten().chain(&coupling).collect();
        let (pattern, order) = match layout {
            Some(layout) => layout.pattern(objective, &patterns, coordinates)?,
            None => {
                let pattern = CsrMatrix::union_of_patterns(unknowns, &patterns);
                let order = fill_reducing_order(&pattern, coordinates)?;
                (pattern, order)
            }
        };
        let symbolic = SymbolicCholesky::new(&pattern, order)?;
        let mut places = vec![(0, 0); symbolic.entries()];
        for row in 0..symbolic.size() {
            for &column in pattern.row(row).0 {
                if symbolic.is_stored(row, column as usize) {
                    places[symbolic.slot(row, column as usize)? as usize] = (row as u32, column);
                }
            }
        }
        drop(pattern);
        let place = |vertex| layout.map_or(vertex, |layout| layout.unknown(vertex));
        let slots = (0..unknowns).map(|vertex| symbolic.slot(place(vertex), place(vertex)));
        let diagonal = slots.collect::<Result<Vec<u32>, FactorError>>()?;
        let mut engine = Self::with_analysis(Arc::new(symbolic), diagonal.into(), places.into(), layout);
        // The products were formed for the pattern; the first solve will want their numbers.
        for (index, (term, matrix)) in objective.terms.iter().zip(matrices).enumerate() {
            let formed = if unformed == Some(index) { engine.couple(index, term)? } else { engine.form(index, term, matrix)? };
            engine.formed.push(Arc::new(formed));
        }
        Ok(engine)
    }

    fn with_analysis(
        symbolic: Arc<SymbolicCholesky>,
        diagonal: Arc<[u32]>,
        places: Arc<[(u32, u32)]>,
        layout: Option<Layout>,
    ) -> Self {
        let unknowns = diagonal.len();
        Self {
            unknowns,
            system: System::new(layout, &symbolic, COLUMNS),
            precision: FactorPrecision::Double,
            diagonal,
            places,
            formed: Vec::new(),
            base: vec![0.0; symbolic.entries()],
            chain_diagonal: Vec::new(),
            values: vec![0.0; symbolic.entries()],
            is_fixed: vec![false; unknowns],
            scratch: Scratch::new(unknowns),
            refinement: std::array::from_fn(|_| vec![0.0; unknowns]),
            factorizations: 0,
            is_factored: false,
            symbolic,
        }
    }

    /// Whether the linear systems have auxiliary unknowns instead of formed products.
    pub fn is_mixed(&self) -> bool {
        self.system.layout().is_some()
    }

    /// Where the entry of two unknowns lives in the values.
    pub(super) fn slot(&self, first: usize, second: usize) -> Result<u32, FactorError> {
        self.symbolic
            .slot(self.system.unknown(first), self.system.unknown(second))
            .map_err(|_| FactorError::OutsidePattern { row: first, column: second })
    }

    /// A second engine on the same analysis, with a factor of its own: for independent problems in parallel.
    ///
    /// The order of elimination, the structure of the factor and the formed products are shared, not copied.
    ///
    /// # Cost
    /// Memory for one factor and a few vectors; no arithmetic.
    ///
    /// # Example
    /// ```
    /// use morsmooth::qp::{Engine, Objective, Term};
    /// use rayon::prelude::*;
    /// // One handle a problem: which of the unknowns 0 and 3 of a chain is held at 1, the other at 0.
    /// let objective = Objective { terms: vec![Term::Diagonal(vec![1.0; 4])], linear: vec![0.0; 4], constant: 0.0 };
    /// let engine = Engine::new(&objective, None, None)?;
    /// let handles = [[Some(1.0), None, None, Some(0.0)], [Some(0.0), None, None, Some(1.0)]];
    /// let weights: Result<Vec<_>, _> =
    ///     handles.par_iter().map_init(|| engine.fork(), |engine, fixed| engine.minimise(&objective, fixed)).collect();
    /// assert_eq!(weights?[1].x, [0.0, 0.0, 0.0, 1.0]);
    /// # Ok::<(), morsmooth::qp::QpError>(())
    /// ```
    pub fn fork(&self) -> Self {
        let mut engine = Self::with_analysis(
            self.symbolic.clone(),
            self.diagonal.clone(),
            self.places.clone(),
            self.system.layout(),
        );
        engine.formed = self.formed.clone();
        engine.set_precision(self.precision);
        engine
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Nonzeros of the factor.
    pub fn factor_entries(&self) -> usize {
        self.symbolic.factor_entries()
    }

    /// Numeric factorisations so far.
    pub fn factorizations(&self) -> usize {
        self.factorizations
    }

    /// Writes the quadratic form on the free unknowns into the base values. A chain whose matrix did not change is
    /// only scaled anew.
    pub(super) fn assemble(&mut self, objective: &Objective, fixed: &[Option<f64>]) -> Result<(), QpError> {
        if objective.unknowns() != self.unknowns {
            return Err(QpError::Length { array: "linear", expected: self.unknowns, found: objective.unknowns() });
        }
        objective.check()?;
        check_fixed(fixed, self.unknowns)?;
        self.formed.truncate(objective.terms.len());
        self.base.fill(0.0);
        self.chain_diagonal.clear();
        let unformed = self.system.layout().and_then(|layout| layout.chain_in(&objective.terms));
        for (index, term) in objective.terms.iter().enumerate() {
            if let Term::Diagonal(diagonal) = term {
                for (&slot, value) in self.diagonal.iter().zip(diagonal) {
                    self.base[slot as usize] += value;
                }
            }
            if self.formed.get(index).is_none_or(|formed| !same_matrix(&formed.term, term)) {
                let is_unformed = unformed == Some(index);
                let formed = if is_unformed { self.couple(index, term)? } else { self.form(index, term, formed_matrix(term))? };
                self.formed.truncate(index);
                self.formed.push(Arc::new(formed));
            }
            let scale = if let Term::Chain { scale, .. } = term { *scale } else { 1.0 };
            let formed = &self.formed[index];
            for (&slot, value) in formed.slots.iter().zip(&formed.values) {
                self.base[slot as usize] += scale * value;
            }
            if unformed == Some(index) {
                self.chain_diagonal.extend(formed.diagonal.iter().map(|value| scale * value));
            }
        }
        for (slot, value) in self.is_fixed.iter_mut().zip(fixed) {
            *slot = value.is_some();
        }
        let layout = self.system.layout();
        let is_without_chain = layout.is_some() && unformed.is_none();
        for (value, &(row, column)) in self.base.iter_mut().zip(self.places.iter()) {
            let is_held = |unknown: u32| match layout {
                None => self.is_fixed[unknown as usize],
                // Without a chain the auxiliary unknowns stand alone.
                Some(layout) => layout.vertex(unknown as usize).map_or(is_without_chain, |vertex| self.is_fixed[vertex]),
            };
            if is_held(row) || is_held(column) {
                *value = f64::from(u8::from(row == column));
            }
        }
        for (value, &fixed) in self.chain_diagonal.iter_mut().zip(&self.is_fixed) {
            if fixed {
                *value = 0.0;
            }
        }
        Ok(())
    }

    /// The entries of a chain that is not formed.
    fn couple(&self, index: usize, term: &Term) -> Result<Formed, QpError> {
        let (mut slots, mut values, mut diagonal) = (Vec::new(), Vec::new(), Vec::new());
        if let Some(layout) = self.system.layout() {
            for (row, column, value) in layout.entries(term) {
                let (row, column) = (row as usize, column as usize);
                slots.push(self.symbolic.slot(row, column).map_err(|_| QpError::TermOutsidePattern {
                    term: index,
                    first: row / layout.order,
                    second: column / layout.order,
                })?);
                values.push(value);
            }
            diagonal = layout.diagonal(term);
        }
        Ok(Formed { term: term.clone(), slots, values, diagonal })
    }

    fn form(&self, index: usize, term: &Term, matrix: Option<CsrMatrix>) -> Result<Formed, QpError> {
        let (mut slots, mut values) = (Vec::new(), Vec::new());
        if let Some(matrix) = matrix {
            slots.reserve(matrix.entries() / 2 + self.unknowns);
            values.reserve(matrix.entries() / 2 + self.unknowns);
            for row in 0..self.unknowns {
                let (columns, entries) = matrix.row(row);
                for (&column, &value) in columns.iter().zip(entries) {
                    if self.symbolic.is_stored(self.system.unknown(row), self.system.unknown(column as usize)) {
                        let slot = self.slot(row, column as usize).map_err(|_| QpError::TermOutsidePattern {
                            term: index,
                            first: row,
                            second: column as usize,
                        })?;
                        slots.push(slot);
                        values.push(value);
                    }
                }
            }
        }
        Ok(Formed { term: term.clone(), slots, values, diagonal: Vec::new() })
    }

    /// Resets the values to the quadratic form alone.
    pub(super) fn reset_values(&mut self) {
        self.is_factored = false;
        self.values.copy_from_slice(&self.base);
    }

    /// The factor at hand is no longer there.
    pub(super) fn forget_factor(&mut self) {
        self.is_factored = false;
    }

    /// Factors the quadratic form alone, unless that is the factor at hand.
    pub(super) fn factor_base(&mut self) -> Result<(), QpError> {
        if self.is_factored && self.values == self.base {
            return Ok(());
        }
        self.reset_values();
        self.factor_values()
    }

    /// Resets the values to a share of the quadratic form.
    pub(super) fn reset_values_to(&mut self, share: f64) {
        self.is_factored = false;
        for ((value, base), &(row, column)) in self.values.iter_mut().zip(&self.base).zip(self.places.iter()) {
            // The identity on fixed unknowns stays.
            *value = if row == column && self.is_fixed[row as usize] { *base } else { share * base };
        }
    }

    /// Factors the values; on a failed pivot with growing relative shifts of the diagonal.
    pub(super) fn factor_values(&mut self) -> Result<(), QpError> {
        self.factorizations += 1;
        let tried = self.system.factor(&self.symbolic, &self.values);
        self.is_factored = tried.is_ok();
        let Err(mut failed) = tried else { return Ok(()) };
        if self.escalate() {
            return self.factor_values();
        }
        let typical = self.diagonal.iter().map(|&slot| self.values[slot as usize]).fold(0.0, f64::max);
        if !typical.is_finite() {
            return Err(failed.into());
        }
        let mut before = 0.0;
        for &shift in self.system.shifts() {
            for &slot in self.diagonal.iter() {
                let value = &mut self.values[slot as usize];
                // A tiny part relative to the largest entry covers rows that are zero altogether.
                *value += (shift - before) * (*value + 1e-6 * typical);
            }
            before = shift;
            self.factorizations += 1;
            match self.system.factor(&self.symbolic, &self.values) {
                Ok(()) => return Ok(()),
                Err(error) => failed = error,
            }
        }
        Err(match failed {
            FactorError::NonPositivePivot { unknown } => QpError::NotConvex { unknown, shift: before },
            other => other.into(),
        })
    }

    /// The diagonal of the quadratic form on the free unknowns, 1 at the fixed ones.
    pub(super) fn diagonal_values(&self) -> Vec<f64> {
        (0..self.unknowns).map(|unknown| self.diagonal_of(unknown)).collect()
    }

    /// Adds a part of itself to each diagonal entry of the values.
    pub(super) fn shift_values(&mut self, relative: f64) {
        for &slot in self.diagonal.iter() {
            self.values[slot as usize] *= 1.0 + relative;
        }
    }

    /// Largest diagonal entry of the values, which is their largest entry.
    pub(super) fn largest_diagonal(&self) -> f64 {
        (0..self.unknowns).map(|unknown| self.diagonal_of(unknown)).fold(0.0, f64::max)
    }

    /// The diagonal entry of the quadratic form at an unknown.
    pub(super) fn diagonal_of(&self, unknown: usize) -> f64 {
        self.base[self.diagonal[unknown] as usize] + self.chain_diagonal.get(unknown).copied().unwrap_or(0.0)
    }

    /// Zero at the fixed unknowns.
    pub(super) fn mask(&self, vector: &mut [f64]) {
        for (slot, &fixed) in vector.iter_mut().zip(&self.is_fixed) {
            if fixed {
                *slot = 0.0;
            }
        }
    }

    /// Solves `(P + Aᵀ W A) d = r` on the free unknowns: conjugate gradients on the product form, preconditioned with the
    /// factor, so that one step is a plain solve and the next ones are refinement.
    ///
    /// # Arguments
    /// * `rows`: A without fixed columns, W, and work memory of a number a row; `None` for P alone.
    /// * `side`: r, zero at the fixed unknowns; `direction`: d, overwritten.
    /// * `tolerance`: on the residual's 2-norm relative to that of r; `steps`: most solves.
    ///
    /// # Returns
    /// The number of solves and the relative residual reached (1 if it was not measured).
    pub(super) fn solve_refined(
        &mut self,
        objective: &Objective,
        mut rows: Option<(&Rows, &Scaling, &mut [f64])>,
        side: &[f64],
        direction: &mut [f64],
        (tolerance, steps): (f64, usize),
    ) -> (usize, f64) {
        let (steps, patience) = self.system.steps(steps);
        let [mut residual, mut solved, mut search, mut image] = std::mem::take(&mut self.refinement);
        residual.copy_from_slice(side);
        direction.fill(0.0);
        let size = dot(side, side).sqrt();
        let mut previous = 0.0;
        let mut taken = 0;
        let mut reached = 1.0;
        let (mut least, mut idle) = (f64::INFINITY, 0);
        while taken < steps && size > 0.0 {
            solved.copy_from_slice(&residual);
            self.system.solve_in_place(&self.symbolic, &mut solved);
            taken += 1;
            let product = dot(&residual, &solved);
            if taken == 1 {
                search.copy_from_slice(&solved);
            } else {
                let ratio = product / previous;
                for (slot, value) in search.iter_mut().zip(&solved) {
                    *slot = value + ratio * *slot;
                }
            }
            previous = product;
            if steps == 1 {
                direction.copy_from_slice(&search);
                break;
            }
            objective.product_into(&search, &mut image, &mut self.scratch);
            if let Some((rows, scaling, work)) = &mut rows {
                rows.add_normal_product(scaling, &search, &mut image, work);
            }
            self.mask(&mut image);
            let length = product / dot(&search, &image);
            if !length.is_finite() || length <= 0.0 {
                if taken == 1 {
                    direction.copy_from_slice(&search);
                }
                break;
            }
            add(direction, length, &search);
            add(&mut residual, -length, &image);
            let now = dot(&residual, &residual).sqrt() / size;
            let is_worse = now > 2.0 * reached;
            reached = now;
            idle = if now < 0.9 * least { 0 } else { idle + 1 };
            least = least.min(now);
            let is_over = if patience == 1 { taken > 1 && is_worse } else { idle >= patience };
            if now <= tolerance || is_over {
                break;
            }
        }
        self.refinement = [residual, solved, search, image];
        (taken, reached)
    }
}

/// The matrix of a term, a chain without its scale; `None` for a diagonal.
fn formed_matrix(term: &Term) -> Option<CsrMatrix> {
    match term {
        Term::Matrix(matrix) => Some(matrix.clone()),
        Term::Diagonal(_) => None,
        Term::Chain { stiffness, weights, order, .. } => {
            let mut product = stiffness.clone();
            for _ in 1..*order {
                product = stiffness.weighted_product(weights, &product);
            }
            Some(product)
        }
    }
}

/// Whether two terms have the same matrix up to the scale of a chain.
fn same_matrix(one: &Term, other: &Term) -> bool {
    match (one, other) {
        (Term::Matrix(one), Term::Matrix(other)) => one == other,
        (Term::Diagonal(_), Term::Diagonal(_)) => true,
        (
            Term::Chain { stiffness: one, weights: w, order: k, .. },
            Term::Chain { stiffness: other, weights: v, order: l, .. },
        ) => k == l && w == v && one == other,
        _ => false,
    }
}
