//! The persistence curve: how many extrema each threshold leaves, and where it is flat.

use super::pairs::ExtremumPair;

/// A stretch of thresholds that all leave the same extrema.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PersistenceGap {
    /// The least threshold of the stretch, in the units of the field; itself a persistence, or 0.
    pub from: f64,
    /// The first threshold beyond the stretch: the next persistence.
    pub to: f64,
    /// Number of minima left.
    pub minima: usize,
    /// Number of maxima left.
    pub maxima: usize,
}

impl PersistenceGap {
    /// `to - from`.
    pub fn width(&self) -> f64 {
        self.to - self.from
    }

    /// `to / from`: the width on a logarithmic axis; infinite from 0.
    pub fn ratio(&self) -> f64 {
        self.to / self.from
    }

    /// The number of fewest digits in the stretch, looked for about its middle on a logarithmic axis (half of `to`, where
    /// it begins at 0): a threshold that a person can remember.
    pub fn round_threshold(&self) -> f64 {
        let middle = if self.from > 0.0 { self.from * (self.to / self.from).sqrt() } else { 0.5 * self.to };
        let rounded = (0..17).filter_map(|digits| format!("{middle:.digits$e}").parse().ok());
        rounded.into_iter().find(|threshold| (self.from..self.to).contains(threshold)).unwrap_or(self.from)
    }
}

/// Number of minima and maxima that exceed a threshold, as a step function of it.
#[derive(Debug, Clone, PartialEq)]
pub struct PersistenceCurve {
    /// 0 and every positive finite persistence, strictly rising, in the units of the field.
    pub thresholds: Vec<f64>,
    /// Minima left at each threshold; constant up to the next one.
    pub minima: Vec<usize>,
    /// Maxima left at each threshold; constant up to the next one.
    pub maxima: Vec<usize>,
}

impl PersistenceCurve {
    /// Counts the extrema that exceed each threshold strictly; essential pairs exceed all.
    ///
    /// # Arguments
    /// * `minima`, `maxima`: all extremum pairs of a field.
    /// * `values`: its `n` values.
    ///
    /// # Cost
    /// O(p log p) for p pairs.
    pub fn new(minima: &[ExtremumPair], maxima: &[ExtremumPair], values: &[f64]) -> Self {
        let sorted = |pairs: &[ExtremumPair]| {
            let persistence = |pair: &ExtremumPair| pair.persistence(values).unwrap_or(f64::INFINITY);
            let mut persistences: Vec<f64> = pairs.iter().map(persistence).collect();
            persistences.sort_unstable_by(f64::total_cmp);
            persistences
        };
        let (minima, maxima) = (sorted(minima), sorted(maxima));
        let mut thresholds = vec![0.0];
        thresholds.extend(minima.iter().chain(&maxima).copied().filter(|&p| p > 0.0 && p.is_finite()));
        thresholds.sort_unstable_by(f64::total_cmp);
        thresholds.dedup();
        let exceeding = |persistences: &[f64], threshold: f64| {
            persistences.len() - persistences.partition_point(|&persistence| persistence <= threshold)
        };
        Self {
            minima: thresholds.iter().map(|&threshold| exceeding(&minima, threshold)).collect(),
            maxima: thresholds.iter().map(|&threshold| exceeding(&maxima, threshold)).collect(),
            thresholds,
        }
    }

    /// Number of minima and maxima that a threshold leaves.
    ///
    /// # Arguments
    /// * `threshold`: in the units of the field, at least 0.
    pub fn at(&self, threshold: f64) -> (usize, usize) {
        // The first threshold is 0; a negative one is answered like 0.
        let place = self.thresholds.partition_point(|&step| step <= threshold).saturating_sub(1);
        (self.minima[place], self.maxima[place])
    }

    /// The widest stretches on which the curve is flat, widest first; of equal widths the lower one first.
    ///
    /// The stretch above the greatest finite persistence is left out: any threshold there leaves the essential
    /// extrema only.
    pub fn widest_gaps(&self, count: usize) -> Vec<PersistenceGap> {
        let mut gaps: Vec<PersistenceGap> = self.gaps().collect();
        gaps.sort_by(|a, b| b.width().total_cmp(&a.width()));
        gaps.truncate(count);
        gaps
    }

    /// The stretches of thresholds that a user may choose by their width, on a logarithmic axis: each is as good as its ends are
    /// apart by a factor.
    ///
    /// Noise and features differ by a factor in persistence, not by an amount; on a logarithmic axis a flat stretch says by which,
    /// and a threshold in it may be wrong by that factor without any effect. Differences instead favour the few largest
    /// persistences, which are far apart in any field.
    ///
    /// # Arguments
    /// * `count`: how many, widest first; of equal widths the lower one first.
    /// * `least`: stretches that begin below it are left out, in the units of the field: near 0 every factor is large.
    ///
    /// Left out as well is what is no wider than the narrowest stretch: in data with integer values, their step.
    pub fn widest_ratios(&self, count: usize, least: f64) -> Vec<PersistenceGap> {
        let step = self.gaps().map(|gap| gap.width()).fold(f64::INFINITY, f64::min);
        let is_wide = |gap: &PersistenceGap| gap.from >= least && gap.from > 0.0 && gap.width() > 1.5 * step;
        let mut gaps: Vec<PersistenceGap> = self.gaps().filter(is_wide).collect();
        gaps.sort_by(|a, b| b.ratio().total_cmp(&a.ratio()));
        gaps.truncate(count);
        gaps
    }

    /// All stretches but the one above the greatest finite persistence, by rising threshold.
    fn gaps(&self) -> impl Iterator<Item = PersistenceGap> {
        (1..self.thresholds.len()).map(|next| PersistenceGap {
            from: self.thresholds[next - 1],
            to: self.thresholds[next],
            minima: self.minima[next - 1],
            maxima: self.maxima[next - 1],
        })
    }
}
