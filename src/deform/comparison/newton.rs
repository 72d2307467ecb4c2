//! Newton's method for a sum of energies of elements and springs at the handles.

use super::compared::Ending;
use super::local::ElementEnergy;
use crate::deform::rest::CHUNK;
use crate::deform::{DeformError, Deformer, Hold};
use crate::linalg::{Cholesky, CsrMatrix, SymbolicCholesky, fill_reducing_order};
use rayon::prelude::*;

/// Stands for a pair of unknowns of which one is fixed.
const NONE: u32 = u32::MAX;

/// Part of the predicted decrease that a step must reach, and the factor between trials (Boyd and Vandenberghe 2004, algorithm 9.2).
const SLOPE: f64 = 1e-2;
const SHRINK: f64 = 0.5;

/// Trials of a line search; the last is too short to be a step.
const TRIALS: usize = 60;

/// Decrement relative to the energy below which its change cannot be told from rounding, and the full step is taken.
const ROUNDING: f64 = 1e-11;

/// Shifts relative to the diagonal that are tried in turn when a pivot fails.
const SHIFTS: [f64; 5] = [1e-14, 1e-12, 1e-10, 1e-8, 1e-6];

/// When a minimisation ends.
#[derive(Clone, Copy)]
pub(super) struct Rule {
    /// `gᵀ H⁻¹ g` relative to the energy.
    pub tolerance: f64,
    /// Newton steps at most.
    pub steps: usize,
}

/// The common part of all minimisations on one shape with one set of handles.
pub(super) struct Newton<'a> {
    deformer: &'a Deformer,
    symbolic: SymbolicCholesky,
    factor: Cholesky,
    /// Places of the lower triangle of every element's matrix.
    slots: Vec<u32>,
    diagonal: Vec<u32>,
    is_fixed: Vec<bool>,
    values: Vec<f64>,
    /// Newton steps so far; each is one factorisation, or a few where pivots failed.
    pub steps: usize,
}

/// A function called with the number of each step and its positions.
pub(super) type Watch<'w> = &'w mut dyn FnMut(usize, &[f64]);

impl<'a> Newton<'a> {
    pub fn new(deformer: &'a Deformer) -> Result<Self, DeformError> {
        let rest = deformer.rest();
        let dimension = rest.dimension();
        let (elements, width) = (rest.element_count(), (dimension + 1) * dimension);
        let unknowns = rest.vertex_count() * dimension;
        let names = |element: usize| {
            let axes = move |&vertex: &u32| (0..dimension as u32).map(move |axis| vertex * dimension as u32 + axis);
            rest.corners(element).iter().flat_map(axes)
        };
        let indices: Vec<u32> = (0..elements).flat_map(names).collect();
        let offsets = (0..=elements).map(|element| (element * width) as u32).collect();
        let ones = vec![1.0; indices.len()];
        let members = CsrMatrix::from_parts(elements, unknowns, offsets, indices, ones);
        let pattern = members.transpose().weighted_product(&vec![1.0; elements], &members);
        let order = fill_reducing_order(&pattern, Some(&deformer.coordinates()))?;
        let symbolic = SymbolicCholesky::new(&pattern, order)?;
        let mut is_fixed = vec![false; unknowns];
        if deformer.options().hold == Hold::Hard {
            for vertex in deformer.handles() {
                is_fixed[vertex.index() * dimension..][..dimension].fill(true);
            }
        }
        let mut slots = Vec::with_capacity(elements * width * (width + 1) / 2);
        for element in 0..elements {
            let names = members.row(element).0;
            for (place, &row) in names.iter().enumerate() {
                for &column in &names[..=place] {
                    let (row, column) = (row as usize, column as usize);
                    let slot = if is_fixed[row] || is_fixed[column] { NONE } else { symbolic.slot(row, column)? };
                    slots.push(slot);
                }
            }
        }
        let diagonal = (0..unknowns).map(|unknown| symbolic.slot(unknown, unknown)).collect::<Result<Vec<u32>, _>>()?;
        let factor = Cholesky::new(&symbolic, 1);
        let values = vec![0.0; symbolic.entries()];
        Ok(Self { deformer, symbolic, factor, slots, diagonal, is_fixed, values, steps: 0 })
    }

    /// Moves positions to a minimum.
    ///
    /// # Arguments
    /// * `targets`: places of the handles; `x`: `n x dim` coordinates with a finite energy, those of hard handles at their targets.
    pub fn minimise<const D: usize, const N: usize>(
        &mut self,
        energy: &impl ElementEnergy<D, N>,
        (targets, x): (&[[f64; 3]], &mut Vec<f64>),
        rule: Rule,
        watch: Watch<'_>,
    ) -> Result<Ending, DeformError> {
        let mut step = vec![0.0; x.len()];
        for _ in 0..rule.steps {
            let value = self.assemble(energy, targets, x, &mut step);
            let gradient = step.clone();
            if !self.solve(&mut step) {
                return Ok(Ending::Stuck);
            }
            self.steps += 1;
            let decrement: f64 = gradient.iter().zip(&step).map(|(g, d)| g * d).sum();
            if !decrement.is_finite() {
                return Ok(Ending::Stuck);
            }
            let scale = value.abs().max(f64::MIN_POSITIVE);
            let mut length = 1.0;
            let mut moved = along(x, &step, length);
            if decrement > ROUNDING * scale || !self.value(energy, targets, &moved).is_finite() {
                let mut trials = 1;
                // Infinite and NaN energies are no decrease either.
                let decreases = |moved: &[f64], length: f64| {
                    let reached = self.value(energy, targets, moved);
                    reached.is_finite() && reached <= value - SLOPE * length * decrement
                };
                while !decreases(&moved, length) {
                    if trials == TRIALS {
                        return Ok(Ending::Stuck);
                    }
                    trials += 1;
                    length *= SHRINK;
                    moved = along(x, &step, length);
                }
            }
            *x = moved;
            watch(self.steps, x);
            if decrement <= rule.tolerance * scale {
                return Ok(Ending::Converged);
            }
        }
        Ok(Ending::IterationLimit)
    }

    /// The energy with that of the springs.
    pub fn value<const D: usize, const N: usize>(
        &self,
        energy: &impl ElementEnergy<D, N>,
        targets: &[[f64; 3]],
        x: &[f64],
    ) -> f64 {
        let count = self.deformer.rest().element_count();
        let chunk = |index: usize| {
            let elements = index * CHUNK..((index + 1) * CHUNK).min(count);
            elements.map(|element| energy.value(element, &self.gradient_of::<D, N>(element, x))).sum::<f64>()
        };
        let sums: Vec<f64> = (0..count.div_ceil(CHUNK)).into_par_iter().map(chunk).collect();
        let springs: f64 = self.springs(targets).map(|(place, alpha, target)| alpha * (x[place] - target).powi(2)).sum();
        sums.iter().sum::<f64>() + springs
    }

    fn gradient_of<const D: usize, const N: usize>(&self, element: usize, x: &[f64]) -> [f64; N] {
        let matrix = self.deformer.rest().deformation_gradient(element, x);
        std::array::from_fn(|entry| matrix[entry / D][entry % D])
    }

    /// Unknown, alpha and target value of each softly held coordinate.
    fn springs<'t>(&'t self, targets: &'t [[f64; 3]]) -> impl Iterator<Item = (usize, f64, f64)> + 't {
        let dimension = self.deformer.rest().dimension();
        let alpha = match self.deformer.options().hold {
            Hold::Soft { alpha } => Some(alpha),
            Hold::Hard => None,
        };
        let held = self.deformer.handles().iter().zip(targets);
        held.flat_map(move |(vertex, target)| {
            let place = move |axis: usize| alpha.map(|alpha| (vertex.index() * dimension + axis, alpha, target[axis]));
            (0..dimension).filter_map(place)
        })
    }

    /// Writes the gradient, fills the values with the Hessian, and returns the energy.
    fn assemble<const D: usize, const N: usize>(
        &mut self,
        energy: &impl ElementEnergy<D, N>,
        targets: &[[f64; 3]],
        x: &[f64],
        gradient: &mut [f64],
    ) -> f64 {
        let rest = self.deformer.rest();
        let width = (D + 1) * D;
        let triangle = width * (width + 1) / 2;
        let count = rest.element_count();
        let mut energies = vec![0.0; count];
        let mut forces = vec![0.0; count * width];
        let mut matrices = vec![0.0; count * triangle];
        let places = energies.par_iter_mut().zip(forces.par_chunks_mut(width)).zip(matrices.par_chunks_mut(triangle));
        places.with_min_len(CHUNK).enumerate().for_each(|(element, ((value, force), matrix))| {
            let local = energy.expand(element, &self.gradient_of::<D, N>(element, x));
            *value = local.value;
            let corners = rest.gradients(element);
            // Column q = (corner, axis) of H G, N numbers.
            let image = |q: usize, row: usize| {
                let (corner, axis) = (q / D, q % D);
                (0..D).map(|e| local.hessian[row][axis * D + e] * corners[corner][e]).sum::<f64>()
            };
            let mut slot = 0;
            for (p, slot_of_force) in force.iter_mut().enumerate() {
                let (corner, axis) = (p / D, p % D);
                *slot_of_force = (0..D).map(|c| corners[corner][c] * local.gradient[axis * D + c]).sum();
                for q in 0..=p {
                    matrix[slot] = (0..D).map(|c| corners[corner][c] * image(q, axis * D + c)).sum();
                    slot += 1;
                }
            }
        });
        // In the order of the elements, so that the bits do not depend on the number of threads.
        gradient.fill(0.0);
        self.values.fill(0.0);
        for (element, force) in forces.chunks(width).enumerate() {
            for (corner, force) in rest.corners(element).iter().zip(force.chunks(D)) {
                for (axis, part) in force.iter().enumerate() {
                    gradient[*corner as usize * D + axis] += part;
                }
            }
        }
        for (&slot, value) in self.slots.iter().zip(&matrices).filter(|(slot, _)| **slot != NONE) {
            self.values[slot as usize] += value;
        }
        let mut sum: f64 = energies.chunks(CHUNK).map(|chunk| chunk.iter().sum::<f64>()).sum();
        let springs: Vec<_> = self.springs(targets).collect();
        for (place, alpha, target) in springs {
            let off = x[place] - target;
            sum += alpha * off * off;
            gradient[place] += 2.0 * alpha * off;
            self.values[self.diagonal[place] as usize] += 2.0 * alpha;
        }
        for (unknown, _) in self.is_fixed.iter().enumerate().filter(|(_, fixed)| **fixed) {
            gradient[unknown] = 0.0;
            self.values[self.diagonal[unknown] as usize] = 1.0;
        }
        sum
    }

    /// Overwrites a gradient with `H⁻¹ g`; false if no shift makes the factor exist.
    fn solve(&mut self, side: &mut [f64]) -> bool {
        let typical = self.diagonal.iter().map(|&slot| self.values[slot as usize]).fold(0.0, f64::max);
        let mut done = 0.0;
        for shift in std::iter::once(0.0).chain(SHIFTS) {
            for &slot in &self.diagonal {
                self.values[slot as usize] += (shift - done) * typical;
            }
            done = shift;
            if self.factor.factor(&self.symbolic, &self.values).is_ok() {
                self.factor.solve_in_place(&self.symbolic, side);
                return true;
            }
        }
        false
    }
}

fn along(x: &[f64], step: &[f64], length: f64) -> Vec<f64> {
    x.iter().zip(step).map(|(x, d)| x - length * d).collect()
}
