//! Nesterov–Todd scaling of the slacks and duals, cone by cone.

use rayon::prelude::*;

use crate::linalg::small::{
    Square, cholesky, composed, congruence, from_scaled, identity, product, scaled_length, singular_values, smallest_eigenvalue,
    symmetric_eigen, to_scaled, transposed,
};

use super::blocks::{GRAIN, two_sided};
use super::interior::Triple;
use super::rows::Rows;

/// The scaling of one block: `Rᵀ Z R = R⁻¹ S R⁻ᵀ = diag(spectrum)`.
#[derive(Clone)]
pub(super) struct Scaled<const D: usize> {
    root: Square<D>,
    inverse: Square<D>,
    spectrum: [f64; D],
    /// `(R Rᵀ)⁻¹`: the metric V maps dS to `metric dS metric`.
    metric: Square<D>,
}

impl<const D: usize> Scaled<D> {
    /// The scaling point of a slack and a dual; `None` unless both are positive definite in floating point.
    ///
    /// # Source
    /// Todd, Toh, Tütüncü 1998, section 4.1: with `S = L Lᵀ`, `Z = K Kᵀ` and `Kᵀ L = U diag(spectrum) Vᵀ`, `R = L V spectrum^(-1/2)`.
    pub fn new(s: &[f64], z: &[f64]) -> Option<Self> {
        let (l, k) = (cholesky::<D>(&from_scaled(s))?, cholesky::<D>(&from_scaled(z))?);
        let svd = singular_values(&product(&transposed(&k), &l));
        let roots = svd.values.map(f64::sqrt);
        if roots.iter().any(|&root| !(root > 0.0 && root.is_finite())) {
            return None;
        }
        let (lv, ku) = (product(&l, &svd.right), product(&k, &svd.left));
        let root = std::array::from_fn(|i| std::array::from_fn(|j| lv[i][j] / roots[j]));
        let inverse: Square<D> = std::array::from_fn(|i| std::array::from_fn(|j| ku[j][i] / roots[i]));
        let transpose = transposed(&inverse);
        Some(Self { root, inverse, spectrum: svd.values, metric: congruence(&transpose, &identity()) })
    }

    /// The scaling of two identities.
    fn trivial() -> Self {
        let one = identity();
        Self { root: one, inverse: one, spectrum: [1.0; D], metric: one }
    }

    /// `out := V x`.
    #[inline]
    pub fn metric_times(&self, x: &[f64], out: &mut [f64]) {
        two_sided(&self.metric, x, out);
    }

    /// V as a symmetric matrix over scaled vectors.
    pub fn metric_rows<const R: usize>(&self) -> [[f64; R]; R] {
        let mut rows = [[0.0; R]; R];
        for (place, row) in rows.iter_mut().enumerate() {
            let mut unit = [0.0; R];
            unit[place] = 1.0;
            self.metric_times(&unit, row);
        }
        rows
    }

    /// `R⁻¹ dS R⁻ᵀ`.
    fn slack(&self, ds: &[f64]) -> Square<D> {
        congruence(&self.inverse, &from_scaled(ds))
    }

    /// `Rᵀ dZ R`.
    fn dual(&self, dz: &[f64]) -> Square<D> {
        congruence(&transposed(&self.root), &from_scaled(dz))
    }

    /// `out := R⁻ᵀ N R⁻¹` where N solves `(diag(spectrum) N + N diag(spectrum)) / 2 = target`.
    fn divide(&self, target: &Square<D>, out: &mut [f64]) {
        let divided: Square<D> = std::array::from_fn(|i| {
            std::array::from_fn(|j| (target[i][j] + target[j][i]) / (self.spectrum[i] + self.spectrum[j]))
        });
        to_scaled(&congruence(&transposed(&self.inverse), &divided), out);
    }

    /// Largest share of a scaled step down to the boundary: `1 / length` of the longest step, 0 if there is no end.
    fn hindrance(&self, step: &Square<D>) -> f64 {
        let relative: Square<D> = std::array::from_fn(|i| {
            std::array::from_fn(|j| step[i][j] / (self.spectrum[i] * self.spectrum[j]).sqrt())
        });
        (-smallest_eigenvalue(&relative)).max(0.0)
    }

    /// What to aim at so that the products after the predictor step become `centre`.
    fn corrected(&self, centre: f64, (ds, dz): (&[f64], &[f64]), out: &mut [f64]) {
        let second = product(&self.slack(ds), &self.dual(dz));
        // `divide` takes the symmetric part.
        let target = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let diagonal = if i == j { centre - self.spectrum[i] * self.spectrum[i] } else { 0.0 };
                diagonal - second[i][j]
            })
        });
        self.divide(&target, out);
    }

    /// What to add so that the products of a step of length `wanted` come back near `centre` (Gondzio 1996, on the eigenvalues).
    fn recentred(&self, centre: f64, wanted: f64, (ds, dz): (&[f64], &[f64]), out: &mut [f64]) {
        let trial = |step: Square<D>| -> Square<D> {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| wanted * step[i][j] + if i == j { self.spectrum[i] } else { 0.0 })
            })
        };
        let products = product(&trial(self.slack(ds)), &trial(self.dual(dz)));
        let symmetric = std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (products[i][j] + products[j][i])));
        let (values, vectors) = symmetric_eigen(&symmetric);
        let corrections = values.map(|value| (value.clamp(0.1 * centre, 10.0 * centre) - value).max(-10.0 * centre));
        self.divide(&composed(&corrections, &vectors), out);
    }
}

/// The scaling of all rows: `V = z / s` for a nonnegative row, matrices for the blocks.
pub(super) struct Scaling {
    /// One weight a nonnegative row.
    pub weights: Vec<f64>,
    pub two: Vec<Scaled<2>>,
    pub three: Vec<Scaled<3>>,
}

impl Scaling {
    pub fn new(rows: &Rows) -> Self {
        Self {
            weights: vec![0.0; rows.order],
            two: vec![Scaled::trivial(); rows.two.len()],
            three: vec![Scaled::trivial(); rows.three.len()],
        }
    }

    /// Scales anew; false if a slack or dual block is not positive definite.
    pub fn update(&mut self, rows: &Rows, point: &Triple) -> bool {
        for ((weight, z), s) in self.weights.iter_mut().zip(&point.z).zip(&point.s) {
            *weight = z / s;
        }
        let (two, three) = (rows.two.rows(), rows.three.rows());
        update_blocks(&mut self.two, &point.s[two.clone()], &point.z[two])
            && update_blocks(&mut self.three, &point.s[three.clone()], &point.z[three])
    }

    /// `out := V v`.
    pub fn times(&self, rows: &Rows, v: &[f64], out: &mut [f64]) {
        for ((out, weight), v) in out.iter_mut().zip(&self.weights).zip(v) {
            *out = weight * v;
        }
        let (two, three) = (rows.two.rows(), rows.three.rows());
        each(&self.two, &mut out[two.clone()], |scaled, i, out| scaled.metric_times(at(v, two.start, i, 2), out));
        each(&self.three, &mut out[three.clone()], |scaled, i, out| scaled.metric_times(at(v, three.start, i, 3), out));
    }

    /// The goal of the corrector: dual steps `goal - V ds` that bring all products to `centre`, second order included.
    pub fn corrected(&self, rows: &Rows, centre: f64, (point, step): (&Triple, &Triple), goal: &mut [f64]) {
        for (row, slot) in goal[..rows.order].iter_mut().enumerate() {
            *slot = (centre - step.s[row] * step.z[row]) / point.s[row] - point.z[row];
        }
        let (two, three) = (rows.two.rows(), rows.three.rows());
        each(&self.two, &mut goal[two.clone()], |scaled, i, out| {
            scaled.corrected(centre, (at(&step.s, two.start, i, 2), at(&step.z, two.start, i, 2)), out);
        });
        each(&self.three, &mut goal[three.clone()], |scaled, i, out| {
            scaled.corrected(centre, (at(&step.s, three.start, i, 3), at(&step.z, three.start, i, 3)), out);
        });
    }

    /// The goal of a centrality corrector for a step of length `wanted`.
    pub fn recentred(&self, rows: &Rows, (centre, wanted): (f64, f64), (point, step): (&Triple, &Triple), goal: &mut [f64]) {
        for (row, slot) in goal[..rows.order].iter_mut().enumerate() {
            let product = (point.s[row] + wanted * step.s[row]) * (point.z[row] + wanted * step.z[row]);
            let correction = product.clamp(0.1 * centre, 10.0 * centre) - product;
            *slot = correction.max(-10.0 * centre) / point.s[row];
        }
        let (two, three) = (rows.two.rows(), rows.three.rows());
        each(&self.two, &mut goal[two.clone()], |scaled, i, out| {
            scaled.recentred(centre, wanted, (at(&step.s, two.start, i, 2), at(&step.z, two.start, i, 2)), out);
        });
        each(&self.three, &mut goal[three.clone()], |scaled, i, out| {
            scaled.recentred(centre, wanted, (at(&step.s, three.start, i, 3), at(&step.z, three.start, i, 3)), out);
        });
    }

    /// The longest step, at most 1, that stays within `fraction` of the way to the boundary.
    pub fn reach(&self, rows: &Rows, fraction: f64, (point, step): (&Triple, &Triple)) -> f64 {
        let mut length = 1.0f64;
        let order = rows.order;
        let slacks = point.s[..order].iter().zip(&step.s);
        for (value, step) in slacks.chain(point.z[..order].iter().zip(&step.z)) {
            if *step < 0.0 {
                length = length.min(-fraction * value / step);
            }
        }
        let most = hindrance(&self.two, rows.two.first, step).max(hindrance(&self.three, rows.three.first, step));
        if most > 0.0 { length.min(fraction / most) } else { length }
    }
}

/// The scaled vector of block `i` of order `size`.
#[inline]
pub(super) fn at(vector: &[f64], first: usize, i: usize, size: usize) -> &[f64] {
    let length = scaled_length(size);
    &vector[first + i * length..][..length]
}

fn update_blocks<const D: usize>(scaled: &mut [Scaled<D>], s: &[f64], z: &[f64]) -> bool {
    let length = scaled_length(D);
    let pairs = s.par_chunks(length).zip(z.par_chunks(length));
    let update = |(scaled, (s, z)): (&mut Scaled<D>, (&[f64], &[f64]))| match Scaled::new(s, z) {
        Some(new) => {
            *scaled = new;
            true
        }
        None => false,
    };
    scaled.par_iter_mut().zip(pairs).with_min_len(GRAIN).map(update).reduce(|| true, |one, other| one && other)
}

fn each<const D: usize>(scaled: &[Scaled<D>], out: &mut [f64], f: impl Fn(&Scaled<D>, usize, &mut [f64]) + Sync) {
    out.par_chunks_mut(scaled_length(D))
        .zip(scaled)
        .with_min_len(GRAIN)
        .enumerate()
        .for_each(|(i, (out, scaled))| f(scaled, i, out));
}

fn hindrance<const D: usize>(scaled: &[Scaled<D>], first: usize, step: &Triple) -> f64 {
    let one = |(i, scaled): (usize, &Scaled<D>)| {
        let slack = scaled.hindrance(&scaled.slack(at(&step.s, first, i, D)));
        slack.max(scaled.hindrance(&scaled.dual(at(&step.z, first, i, D))))
    };
    scaled.par_iter().enumerate().with_min_len(GRAIN).map(one).reduce(|| 0.0, f64::max)
}
