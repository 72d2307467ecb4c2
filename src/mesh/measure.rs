//! Length, area and volume of top simplices, and the test for zero measure.

use super::SimplicialComplex;
use rayon::prelude::*;

/// A simplex counts as one of zero measure below this ratio of measure to longest edge to the power of the dimension.
///
/// About fifty times the relative rounding error of the ratio. The ratio of an equilateral triangle is 0.43, that of a
/// right-angled triangle of aspect ratio 1 : r is 1 / 2r, so only triangles thinner than 1 : 5e13 fall below.
pub const ZERO_MEASURE: f64 = 1e-14;

impl SimplicialComplex {
    /// Length, area or volume of a top simplex, never negative, in `[length^dimension]`.
    pub fn measure(&self, simplex: usize) -> f64 {
        let (ratio, longest) = self.ratio_and_longest_edge(simplex);
        ratio * longest.powi(self.dimension() as i32)
    }

    /// Measure of a top simplex over its longest edge to the power of the dimension; no unit, 0 to 1.
    ///
    /// Differences of coordinates are scaled before they are multiplied, so that neither 1e-120 nor 1e120 is lost.
    /// A simplex whose points coincide has ratio 0, and so has one with a coordinate that is not finite.
    pub fn measure_ratio(&self, simplex: usize) -> f64 {
        self.ratio_and_longest_edge(simplex).0
    }

    /// The first top simplex of zero measure (see [`ZERO_MEASURE`]) and its ratio.
    ///
    /// # Cost
    /// O(m), in parallel.
    pub fn first_zero_measure(&self) -> Option<(usize, f64)> {
        let below = |simplex: usize| {
            let ratio = self.measure_ratio(simplex);
            (ratio < ZERO_MEASURE).then_some((simplex, ratio))
        };
        (0..self.simplex_count()).into_par_iter().with_min_len(8192).find_map_first(below)
    }

    /// All top simplices of zero measure and their ratios.
    pub fn zero_measures(&self) -> Vec<(usize, f64)> {
        let ratios = (0..self.simplex_count()).into_par_iter().with_min_len(8192);
        ratios.map(|simplex| (simplex, self.measure_ratio(simplex))).filter(|&(_, ratio)| ratio < ZERO_MEASURE).collect()
    }

    fn ratio_and_longest_edge(&self, simplex: usize) -> (f64, f64) {
        let corners = self.simplex(simplex);
        let at = |corner: usize| self.points()[corners[corner] as usize];
        let mut sides = [[0.0; 3]; 3];
        for (side, slot) in sides[..self.dimension()].iter_mut().enumerate() {
            *slot = minus(at(side + 1), at(0));
        }
        let scale = sides.iter().flatten().fold(0.0f64, |most, side| most.max(side.abs()));
        if !(scale > 0.0 && scale.is_finite()) {
            return (0.0, 0.0);
        }
        let [a, b, c] = sides.map(|side| side.map(|part| part / scale));
        let (measure, longest) = match self.dimension() {
            1 => (norm(a), norm(a)),
            2 => (norm(cross(a, b)) / 2.0, norm(a).max(norm(b)).max(norm(minus(b, a)))),
            _ => {
                let sides = [a, b, c, minus(b, a), minus(c, a), minus(c, b)];
                (dot(cross(a, b), c).abs() / 6.0, sides.map(norm).into_iter().fold(0.0, f64::max))
            }
        };
        let ratio = measure / longest.powi(self.dimension() as i32);
        // A NaN coordinate hides from max(); it must not pass as a measure.
        if ratio.is_finite() { (ratio, longest * scale) } else { (0.0, 0.0) }
    }
}

pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
