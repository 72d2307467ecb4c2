//! Augmented Lagrangian methods for the same semidefinite problem as the interior point and the penalty continuation.

// Entries of small matrices are named by their indices, as in the formulas.
#![allow(clippy::needless_range_loop)]

use super::compared::{Compared, Comparison, Ending};
use super::det_penalty::positive;
use super::lagrangian::{Lagrangian, trace_of_product};
use super::local::{Elastic, ElementEnergy, Local};
use super::newton::{Newton, Rule};
use crate::deform::DeformError;
use crate::linalg::small::{Square, identity, smallest_eigenvalue};
use rayon::prelude::*;

/// The parameters of an augmented Lagrangian method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AugmentedOptions {
    /// Which one.
    pub kind: Lagrangian,
    /// p_0, the first penalty parameter, positive; PENNON's grows to twice the largest violation if that is more.
    pub start: f64,
    /// Factor from one parameter to the next, between 0 and 1.
    pub shrink: f64,
    /// The smallest parameter, positive.
    pub smallest: f64,
    /// The first multiplier of every block, times its rest measure, positive.
    pub multiplier: f64,
    /// `gᵀ H⁻¹ g` relative to the energy at which multipliers are updated in the first round, positive; it falls tenfold a round, down to
    /// the square of the relative gap.
    pub tolerance: f64,
    /// Largest violation of a block by an eigenvalue, and largest gap `trace(U S)` relative to the energy, at the end.
    pub accuracy: f64,
    /// Newton steps at most.
    pub max_iterations: usize,
}

impl AugmentedOptions {
    /// What was found to need the fewest steps on the quads of table 2 (see `tools/bench/comparison.rs`).
    pub fn new(kind: Lagrangian) -> Self {
        let (start, shrink) = match kind {
            Lagrangian::Spectral => (1.0, 0.1),
            Lagrangian::Pennon => (1.0, 0.3),
        };
        Self { kind, start, shrink, smallest: 1e-8, multiplier: 1.0, tolerance: 1e-2, accuracy: 1e-6, max_iterations: 1000 }
    }
}

/// The elastic energy plus the augmented terms of one round; multipliers are by rest measure.
struct Augmented<'a, const D: usize> {
    elastic: Elastic<'a>,
    kind: Lagrangian,
    margins: &'a [f64],
    multipliers: &'a [Square<D>],
    p: f64,
}

impl<const D: usize> Augmented<'_, D> {
    /// `S = sym(RᵀF) - eps I`.
    fn block<const N: usize>(&self, element: usize, f: &[f64; N]) -> Square<D> {
        let r = &self.elastic.rotations[element];
        let turned = |i: usize, j: usize| (0..D).map(|c| r[c][i] * f[c * D + j]).sum::<f64>();
        std::array::from_fn(|i| {
            std::array::from_fn(|j| 0.5 * (turned(i, j) + turned(j, i)) - if i == j { self.margins[element] } else { 0.0 })
        })
    }
}

impl<const D: usize, const N: usize> ElementEnergy<D, N> for Augmented<'_, D> {
    fn value(&self, element: usize, f: &[f64; N]) -> f64 {
        let term = self.kind.value(&self.multipliers[element], self.p, &self.block(element, f));
        ElementEnergy::<D, N>::value(&self.elastic, element, f) + self.elastic.measures[element] * term
    }

    fn expand(&self, element: usize, f: &[f64; N]) -> Local<N> {
        let mut local = ElementEnergy::<D, N>::expand(&self.elastic, element, f);
        let Some(term) = self.kind.expand(&self.multipliers[element], self.p, &self.block(element, f)) else {
            local.value = f64::INFINITY;
            return local;
        };
        let (r, v) = (&self.elastic.rotations[element], self.elastic.measures[element]);
        local.value += v * term.value;
        // A matrix G by S is R G by F.
        let by_f = |g: &Square<D>| -> [f64; N] { std::array::from_fn(|n| (0..D).map(|c| r[n / D][c] * g[c][n % D]).sum()) };
        for (slot, part) in local.gradient.iter_mut().zip(by_f(&term.slope)) {
            *slot += v * part;
        }
        for (weight, a, b) in &term.squares {
            let symmetric: Square<D> = std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (a[i] * b[j] + a[j] * b[i])));
            let direction = by_f(&symmetric);
            for i in 0..N {
                for j in 0..N {
                    local.hessian[i][j] += v * weight * direction[i] * direction[j];
                }
            }
        }
        local
    }
}

impl Comparison<'_> {
    /// An augmented Lagrangian method: Newton's method for fixed multipliers, then new multipliers and a smaller parameter.
    ///
    /// Starts at the ex-rotated minimiser. Ends where all eigenvalues of `sym(RᵀF) - eps I` are above `-accuracy` and the gap of the
    /// multipliers is below `accuracy` of the energy: the tolerances of the other methods.
    ///
    /// # Arguments
    /// * `watch`: called with the number of each step and its positions.
    ///
    /// # Errors
    /// [`DeformError::Number`] for an option out of range; [`DeformError::Factor`].
    ///
    /// # Cost
    /// A factorisation a step.
    ///
    /// # Source
    /// See [`Lagrangian`]; Liu et al. 2016, table 2.
    pub fn augmented(
        &self,
        options: &AugmentedOptions,
        watch: &mut dyn FnMut(usize, &[f64]),
    ) -> Result<Compared, DeformError> {
        let AugmentedOptions { start, shrink, smallest, multiplier, tolerance, accuracy, .. } = *options;
        positive(&[start, shrink, 1.0 - shrink, smallest, multiplier, tolerance, accuracy])?;
        match self.deformer.rest().dimension() {
            2 => self.augmented_in::<2, 4>(options, watch),
            _ => self.augmented_in::<3, 9>(options, watch),
        }
    }

    fn augmented_in<const D: usize, const N: usize>(
        &self,
        options: &AugmentedOptions,
        watch: &mut dyn FnMut(usize, &[f64]),
    ) -> Result<Compared, DeformError> {
        let kind = options.kind;
        let margins = self.deformer.margins(self.targets);
        let mut newton = Newton::new(self.deformer)?;
        let mut x = self.deformer.reference(self.targets)?;
        self.minimise_elastic(&mut newton, &mut x)?;
        watch(newton.steps, &x);
        let first = identity::<D>().map(|row| row.map(|entry| options.multiplier * entry));
        let mut multipliers = vec![first; self.deformer.rest().element_count()];
        let mut p = options.start;
        if kind == Lagrangian::Pennon {
            p = p.max(-2.0 * self.judged(&margins, &multipliers, &x)?.0);
        }
        let (mut rounds, mut ending, mut tolerance) = (0, Ending::IterationLimit, options.tolerance);
        while newton.steps < options.max_iterations {
            rounds += 1;
            let energy = Augmented { elastic: self.elastic(), kind, margins: &margins, multipliers: &multipliers, p };
            let rule = Rule { tolerance, steps: options.max_iterations - newton.steps };
            ending = newton.minimise::<D, N>(&energy, (self.targets, &mut x), rule, watch)?;
            if ending != Ending::Converged {
                break;
            }
            let next: Option<Vec<Square<D>>> = self
                .states::<D, N>(&energy, &x)
                .enumerate()
                .map(|(element, s)| kind.expand(&multipliers[element], p, &s).map(|term| term.next))
                .collect();
            let Some(next) = next else {
                ending = Ending::Stuck;
                break;
            };
            multipliers = next;
            let (least, gap) = self.judged(&margins, &multipliers, &x)?;
            let scale = self.deformer.energy(self.rotations, self.targets, &x)?.total().max(f64::MIN_POSITIVE);
            if least >= -options.accuracy && gap <= options.accuracy * scale && tolerance <= options.accuracy {
                break;
            }
            ending = Ending::IterationLimit;
            p = (options.shrink * p).max(options.smallest);
            if kind == Lagrangian::Pennon {
                // The point at hand must stay in the domain of the next round.
                p = p.max(-1.5 * least);
            }
            tolerance = (0.1 * tolerance).max(options.accuracy * options.accuracy);
        }
        self.compared(x, ending, (newton.steps, rounds))
    }

    /// S of every element.
    fn states<'s, const D: usize, const N: usize>(
        &'s self,
        energy: &'s Augmented<'_, D>,
        x: &'s [f64],
    ) -> impl IndexedParallelIterator<Item = Square<D>> + 's {
        let rest = self.deformer.rest();
        (0..rest.element_count()).into_par_iter().map(move |element| {
            let matrix = rest.deformation_gradient(element, x);
            let f: [f64; N] = std::array::from_fn(|entry| matrix[entry / D][entry % D]);
            energy.block(element, &f)
        })
    }

    /// The smallest eigenvalue of all blocks, and `sum v |trace(U S)|`.
    fn judged<const D: usize>(&self, margins: &[f64], multipliers: &[Square<D>], x: &[f64]) -> Result<(f64, f64), DeformError> {
        let (mut least, mut gap) = (f64::INFINITY, 0.0);
        let rest = self.deformer.rest();
        for element in 0..rest.element_count() {
            let matrix = rest.deformation_gradient(element, x);
            let r = &self.rotations[element];
            let turned = |i: usize, j: usize| (0..D).map(|c| r[c][i] * matrix[c][j]).sum::<f64>();
            let s: Square<D> = std::array::from_fn(|i| {
                std::array::from_fn(|j| 0.5 * (turned(i, j) + turned(j, i)) - if i == j { margins[element] } else { 0.0 })
            });
            least = least.min(smallest_eigenvalue(&s));
            gap += rest.measures()[element] * trace_of_product(&multipliers[element], &s).abs();
        }
        Ok((least, gap))
    }
}
