//! Values and gradients of an objective, by multiplying through its terms.

use rayon::prelude::*;

use super::{Objective, Term};

/// Two vectors of n numbers for the steps of a chain.
#[derive(Debug, Clone, Default)]
pub(super) struct Scratch {
    first: Vec<f64>,
    second: Vec<f64>,
}

impl Scratch {
    pub(super) fn new(unknowns: usize) -> Self {
        Self { first: vec![0.0; unknowns], second: vec![0.0; unknowns] }
    }
}

impl Objective {
    /// The value `1/2 xᵀ P x + qᵀ x + c`, chains by differences and as a sum of squares.
    ///
    /// # Arguments
    /// * `x`: n numbers.
    pub fn value(&self, x: &[f64]) -> f64 {
        let mut scratch = Scratch::new(self.unknowns());
        self.quadratic(x, &mut scratch) + dot(&self.linear, x) + self.constant
    }

    /// The gradient `g := P x + q`.
    ///
    /// # Arguments
    /// * `x`: n numbers; `gradient`: n numbers, overwritten.
    pub fn gradient_into(&self, x: &[f64], gradient: &mut [f64]) {
        let mut scratch = Scratch::new(self.unknowns());
        self.product_into(x, gradient, &mut scratch);
        for (slot, linear) in gradient.iter_mut().zip(&self.linear) {
            *slot += linear;
        }
    }

    /// `1/2 xᵀ P x`.
    pub(super) fn quadratic(&self, x: &[f64], scratch: &mut Scratch) -> f64 {
        let mut sum = 0.0;
        for term in &self.terms {
            sum += match term {
                Term::Matrix(matrix) => {
                    matrix.multiply_into(x, &mut scratch.first);
                    0.5 * dot(x, &scratch.first)
                }
                Term::Diagonal(diagonal) => 0.5 * diagonal.iter().zip(x).map(|(d, x)| d * x * x).sum::<f64>(),
                Term::Chain { scale, stiffness, weights, order } => {
                    // y := (W L)^(k div 2) x, one factor at a time; then half yᵀ L y or, with y short of one W, half yᵀ W y.
                    let Scratch { first, second } = scratch;
                    first.copy_from_slice(x);
                    for step in 0..order / 2 {
                        stiffness.multiply_differences_into(first, second);
                        if 2 * (step + 1) < *order {
                            for ((to, from), weight) in first.iter_mut().zip(second.iter()).zip(weights) {
                                *to = weight * from;
                            }
                        }
                    }
                    scale
                        * if order % 2 == 0 {
                            0.5 * second.iter().zip(weights).map(|(y, w)| w * y * y).sum::<f64>()
                        } else {
                            (0..stiffness.rows())
                                .map(|row| {
                                    let here = first[row];
                                    let (columns, values) = stiffness.row(row);
                                    let squares = columns.iter().zip(values).map(|(&j, value)| {
                                        let step = first[j as usize] - here;
                                        value * step * step
                                    });
                                    // Each edge is met from both ends, and L has -w off its diagonal.
                                    -0.25 * squares.sum::<f64>()
                                })
                                .sum::<f64>()
                        }
                }
            };
        }
        sum
    }

    /// `y := P x`.
    pub(super) fn product_into(&self, x: &[f64], y: &mut [f64], scratch: &mut Scratch) {
        y.fill(0.0);
        for term in &self.terms {
            match term {
                Term::Matrix(matrix) => {
                    matrix.multiply_into(x, &mut scratch.first);
                    add(y, 1.0, &scratch.first);
                }
                Term::Diagonal(diagonal) => {
                    for ((slot, d), x) in y.iter_mut().zip(diagonal).zip(x) {
                        *slot += d * x;
                    }
                }
                Term::Chain { scale, stiffness, weights, order } => {
                    let Scratch { first, second } = scratch;
                    stiffness.multiply_differences_into(x, second);
                    for _ in 1..*order {
                        for ((to, from), weight) in first.iter_mut().zip(second.iter()).zip(weights) {
                            *to = weight * from;
                        }
                        stiffness.multiply_differences_into(first, second);
                    }
                    add(y, *scale, second);
                }
            }
        }
    }

    /// The size of the addends in `P x`: what rounding of x and of each factor leaves in the gradient, over one ulp.
    pub(super) fn addends_into(&self, x: &[f64], y: &mut [f64], scratch: &mut Scratch) {
        y.fill(0.0);
        for term in &self.terms {
            let Scratch { first, second } = scratch;
            for (to, x) in first.iter_mut().zip(x) {
                *to = x.abs();
            }
            match term {
                Term::Matrix(matrix) => {
                    matrix.multiply_absolute_into(first, second);
                    add(y, 1.0, second);
                }
                Term::Diagonal(diagonal) => {
                    for ((slot, d), x) in y.iter_mut().zip(diagonal).zip(first.iter()) {
                        *slot += d * x;
                    }
                }
                Term::Chain { scale, stiffness, weights, order } => {
                    stiffness.multiply_absolute_into(first, second);
                    for _ in 1..*order {
                        for ((to, from), weight) in first.iter_mut().zip(second.iter()).zip(weights) {
                            *to = weight * from;
                        }
                        stiffness.multiply_absolute_into(first, second);
                    }
                    add(y, *scale, second);
                }
            }
        }
    }
}

/// Numbers that are summed one after the other; sums of such chunks are added in their order.
const CHUNK: usize = 16_384;

/// Vectors below this length are not worth waking a thread for.
const SHORT: usize = 4 * CHUNK;

/// Whether a loop over this many numbers is shared among threads.
fn is_shared(length: usize) -> bool {
    length >= SHORT && rayon::current_num_threads() > 1
}

/// `y += a x`.
pub(super) fn add(y: &mut [f64], a: f64, x: &[f64]) {
    let one = |(y, x): (&mut [f64], &[f64])| {
        for (slot, x) in y.iter_mut().zip(x) {
            *slot += a * x;
        }
    };
    if is_shared(y.len()) { y.par_chunks_mut(CHUNK).zip(x.par_chunks(CHUNK)).for_each(one) } else { one((y, x)) }
}

/// Summed in chunks of fixed length, so that the bits never depend on threads.
pub(super) fn dot(x: &[f64], y: &[f64]) -> f64 {
    let one = |(x, y): (&[f64], &[f64])| -> f64 { x.iter().zip(y).map(|(x, y)| x * y).sum() };
    if is_shared(x.len()) {
        let sums: Vec<f64> = x.par_chunks(CHUNK).zip(y.par_chunks(CHUNK)).map(one).collect();
        sums.iter().sum()
    } else {
        x.chunks(CHUNK).zip(y.chunks(CHUNK)).map(one).sum()
    }
}

/// Largest absolute value; NaN if there is one.
pub(super) fn largest(x: &[f64]) -> f64 {
    let one = |x: &[f64]| x.iter().fold(0.0, larger);
    let larger = |most: f64, x: f64| larger(most, &x);
    if is_shared(x.len()) { x.par_chunks(CHUNK).map(one).reduce(|| 0.0, larger) } else { one(x) }
}

/// The larger absolute value; NaN where one is, which no later value replaces.
fn larger(most: f64, x: &f64) -> f64 {
    if x.abs() > most || x.is_nan() { x.abs() } else { most }
}
