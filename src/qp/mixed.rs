//! The system with auxiliary unknowns: no product of matrices is formed, so that far fewer digits are lost.
//!
//! With `M = inverse(W)` and H for everything but the chain (data, rows), the unknowns of a vertex, in this order, and their rows are
//!
//! ```text
//! order 2:  y: L x - M y          x: H x + L y
//! order 3:  y: L y + M l          l: -L x + M y     x: H x - L l
//! order 4:  w: L y - M w          y: M l + L w      l: -L x + M y     x: H x - L l
//! ```
//!
//! Eliminating all but x leaves `H + L (W L)^(order - 1)`. In this order within each vertex every leading minor is nonzero,
//! whatever the order of the vertices. M is divided by its mean m, and everything but H is multiplied by `scale / m^(order - 1)`:
//! then all blocks but H are of one size.

use crate::linalg::{Compliance, CsrMatrix, FactorError, Lblt, Permutation, SparseRow, SymbolicCholesky, fill_reducing_order};

use super::{Objective, Term};

/// The largest rounding error of the formed matrix, relative to what the objective weighs its flattest functions with, at which its factor
/// is still used: refinement in product form contracts well below it, and not at all ten to a hundred times above.
const FORMED: f64 = 30.0;

/// The largest eigenvalue of `W L` in units of the typical diagonal entry, about, on triangles and tetrahedra.
const TOP: f64 = 2.0;

/// Which linear systems an engine factors.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum KktForm {
    /// The mixed form where rounding would spoil the formed matrix, by an estimate from the chain's order, the number of unknowns and the
    /// weight of the data; else the formed one, which is faster at order 2 and no slower at order 3.
    #[default]
    Automatic,
    /// `P + Aᵀ W A` with all products formed.
    Formed,
    /// With auxiliary unknowns between the factors of a chain, where the objective has exactly one chain and it is of order 2, 3 or 4
    /// with positive weights; else the formed matrix.
    Mixed,
}

/// Two unknowns of a vertex, by their places, and the sign of the block between them.
type Block = (usize, usize, f64);

/// How the unknowns lie that stand between the factors of a chain of the given order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    pub order: usize,
}

impl Layout {
    /// The layout for an objective in the form asked for; none for the formed matrix.
    pub fn choose(objective: &Objective, form: KktForm) -> Option<Self> {
        let mut chains = objective.terms.iter().filter(|term| matches!(term, Term::Chain { order: 2.., .. }));
        let term = chains.next()?;
        let Term::Chain { scale, stiffness, weights, order } = term else { return None };
        if chains.next().is_some() || *order > 4 || weights.iter().any(|&weight| weight <= 0.0) {
            return None;
        }
        let is_mixed = match form {
            KktForm::Formed => false,
            KktForm::Mixed => true,
            KktForm::Automatic => {
                let n = weights.len().max(1) as f64;
                // A typical diagonal entry of W L, the square of an inverse spacing.
                let spacing = (0..weights.len()).map(|row| weights[row] * stiffness.get(row, row)).sum::<f64>() / n;
                let data: f64 = objective.terms.iter().map(|term| weighted_mean(term, weights)).sum();
                // Without data the flattest functions are as long as the domain: about n spacings squared, in the plane.
                let flattest = (data / scale).max((spacing / n).powi(*order as i32));
                f64::EPSILON * (TOP * spacing).powi(*order as i32) > FORMED * flattest
            }
        };
        is_mixed.then_some(Self { order: *order })
    }

    /// The chain among the terms that is not formed.
    pub fn chain_in(&self, terms: &[Term]) -> Option<usize> {
        terms.iter().position(|term| matches!(term, Term::Chain { order, .. } if *order == self.order))
    }

    /// The place of x at a vertex among all unknowns of the system.
    pub fn unknown(&self, vertex: usize) -> usize {
        vertex * self.order + self.order - 1
    }

    /// The vertex whose x an unknown of the system is, if it is one.
    pub fn vertex(&self, unknown: usize) -> Option<usize> {
        (unknown % self.order == self.order - 1).then_some(unknown / self.order)
    }

    /// The chain's entries in the system without its scale, each pair of unknowns once.
    pub fn entries(&self, term: &Term) -> Vec<(u32, u32, f64)> {
        let Term::Chain { stiffness, weights, order, .. } = term else { return Vec::new() };
        // A weight of zero would be an infinite mass; this one is as good as infinite.
        let least = 1e-12 * weights.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let mass = |weight: f64| 1.0 / weight.max(least);
        let mean = weights.iter().map(|&weight| mass(weight)).sum::<f64>() / weights.len().max(1) as f64;
        let unit = mean.powi(1 - *order as i32);
        let mut entries = Vec::with_capacity(2 * stiffness.entries() + 2 * weights.len());
        let at = |vertex: usize, place: usize| (vertex * order + place) as u32;
        let mut products = |first: usize, second: usize, sign: f64| {
            for row in 0..stiffness.rows() {
                let (columns, values) = stiffness.row(row);
                for (&column, value) in columns.iter().zip(values) {
                    if first != second || column as usize <= row {
                        entries.push((at(row, first), at(column as usize, second), sign * unit * value));
                    }
                }
            }
        };
        let (blocks, masses): (&[Block], Block) = match order {
            2 => (&[(1, 0, 1.0)], (0, 0, -1.0)),
            3 => (&[(2, 1, -1.0), (0, 0, 1.0)], (0, 1, 1.0)),
            _ => (&[(3, 2, -1.0), (1, 0, 1.0)], (1, 2, 1.0)),
        };
        for &(first, second, sign) in blocks {
            products(first, second, sign);
        }
        let mut add_masses = |(first, second, sign): Block| {
            let values = weights.iter().enumerate();
            entries.extend(values.map(|(vertex, &weight)| (at(vertex, first), at(vertex, second), sign * unit * mass(weight) / mean)));
        };
        add_masses(masses);
        if *order == 4 {
            add_masses((0, 0, -1.0));
        }
        entries
    }

    /// The pattern of the system and an order of elimination: vertices dissected, the unknowns of each together.
    ///
    /// # Arguments
    /// * `others`: the patterns of H, `n x n` each.
    pub fn pattern(
        &self,
        objective: &Objective,
        others: &[&CsrMatrix],
        coordinates: Option<&[[f64; 3]]>,
    ) -> Result<(CsrMatrix, Permutation), FactorError> {
        let term = self.chain_in(&objective.terms).map(|index| &objective.terms[index]);
        let n = objective.unknowns();
        let size = n * self.order;
        let mut triplets = Vec::new();
        for (row, column, _) in term.map_or_else(Vec::new, |term| self.entries(term)) {
            triplets.extend([(row, column, 0.0), (column, row, 0.0)]);
        }
        let place = |vertex: u32| self.unknown(vertex as usize) as u32;
        let mut graphs = others.to_vec();
        if let Some(Term::Chain { stiffness, .. }) = term {
            // Rows between neighbours, and matrices like this one, must find their places.
            graphs.push(stiffness);
        }
        for graph in &graphs {
            for row in 0..n as u32 {
                triplets.extend(graph.row(row as usize).0.iter().map(|&column| (place(row), place(column), 0.0)));
            }
        }
        triplets.extend((0..size as u32).map(|unknown| (unknown, unknown, 0.0)));
        let outside = |_| FactorError::NotSquare { rows: size, columns: size };
        let pattern = CsrMatrix::from_triplets(size, size, &triplets).map_err(outside)?;
        drop(triplets);
        let vertices = fill_reducing_order(&CsrMatrix::union_of_patterns(n, &graphs), coordinates)?;
        let order = self.order as u32;
        let expanded = vertices.order().iter().flat_map(|&vertex| (0..order).map(move |place| vertex * order + place)).collect();
        Ok((pattern, Permutation::new(expanded)?))
    }

    /// The diagonal of the chain's matrix without its scale.
    pub fn diagonal(&self, term: &Term) -> Vec<f64> {
        let Term::Chain { stiffness, weights, order, .. } = term else { return Vec::new() };
        let mut half = stiffness.clone();
        for _ in 1..order / 2 {
            half = half.weighted_product(weights, stiffness);
        }
        let other = if order % 2 == 0 { None } else { Some(half.weighted_product(weights, stiffness)) };
        let row_sum = |row: usize| {
            let (columns, values) = half.row(row);
            let second = |place: usize, column: u32| other.as_ref().map_or(values[place], |other| other.get(row, column as usize));
            columns.iter().enumerate().map(|(place, &column)| values[place] * weights[column as usize] * second(place, column)).sum()
        };
        (0..stiffness.rows()).map(row_sum).collect()
    }
}

/// The mean over the vertices of a term's diagonal times the chain's weights; a chain counts nothing.
fn weighted_mean(term: &Term, weights: &[f64]) -> f64 {
    let n = weights.len().max(1) as f64;
    match term {
        Term::Chain { .. } => 0.0,
        Term::Diagonal(diagonal) => diagonal.iter().zip(weights).map(|(d, w)| d * w).sum::<f64>() / n,
        // A matrix may be singular on the flattest functions.
        Term::Matrix(_) => 0.0,
    }
}

/// A factor in the mixed form, with the memory that carries right-hand sides into it.
pub(super) struct Mixed {
    pub layout: Layout,
    factor: Lblt,
    work: Vec<f64>,
    columns: usize,
}

impl Mixed {
    pub fn new(layout: Layout, symbolic: &SymbolicCholesky, columns: usize) -> Self {
        Self { layout, factor: Lblt::new(symbolic, columns), work: vec![0.0; symbolic.size() * columns], columns }
    }

    /// Factors the system; errors name vertices.
    pub fn factor(&mut self, symbolic: &SymbolicCholesky, values: &[f64]) -> Result<(), FactorError> {
        self.factor.factor(symbolic, values).map_err(|error| match error {
            FactorError::SingularPivot { unknown } => FactorError::SingularPivot { unknown: unknown / self.layout.order },
            other => other,
        })
    }

    /// Adds rows, whose unknowns are those of the system, to a compliance.
    pub fn comply(&self, symbolic: &SymbolicCholesky, compliance: &mut Compliance, rows: &[SparseRow]) {
        self.factor.comply(symbolic, compliance, rows);
    }

    /// Overwrites right-hand sides of x, the others being zero, with the solution's x.
    pub fn solve_in_place(&mut self, symbolic: &SymbolicCholesky, sides: &mut [f64]) {
        let size = symbolic.size();
        let n = size / self.layout.order;
        if n == 0 {
            return;
        }
        let (order, last) = (self.layout.order, self.layout.order - 1);
        for block in sides.chunks_mut(n * self.columns) {
            let work = &mut self.work[..block.len() * order];
            for (all, value) in work.chunks_mut(order).zip(block.iter()) {
                all.fill(0.0);
                all[last] = *value;
            }
            self.factor.solve_in_place(symbolic, work);
            for (all, value) in work.chunks(order).zip(block) {
                *value = all[last];
            }
        }
    }
}
