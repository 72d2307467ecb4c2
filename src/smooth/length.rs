//! The smoothing length by cross-validation over neighbourhoods.
//!
//! A value is predicted from the data farther than `r` edges away, and compared with what was measured there. Sums over
//! many such places, with whole neighbourhoods left out of the data at once, give the score
//!
//! ```text
//! CV(l) = 1/|S| Σ_{i in S} (f_i - h_i)²        f = A_l h without the values within r edges of S
//! ```
//!
//! whose expectation is the noise variance plus the mean square error of the prediction. Leaving out one value at a time
//! (generalised cross-validation) takes correlated noise for signal, and measured fields have correlated noise: vectors of
//! overlapping windows, derivatives of them, resampled images. Neighbourhoods wider than the correlation see it as noise.
//! The discrepancy principle needs the noise beforehand, and an estimate a few per cent too high smooths far too much.
//!
//! Literature: Burman, Chow, Nolan 1994, *A cross-validatory method for dependent data*; Golub, Heath, Wahba 1979.

use crate::field::VertexId;
use crate::mesh::SimplicialComplex;
use crate::monotone::{EnergyWeights, Fitter};
use crate::qp::QpError;

/// Edges around a predicted vertex whose data are left out.
const RADIUS: usize = 2;
/// Ratio of neighbouring lengths in the first, coarse scan.
const SCAN_RATIO: f64 = 2.0;
/// Lengths tried by the refinement of the best one found by the scan.
const REFINEMENTS: usize = 3;
/// A score this much above the best ends the scan.
const CLEARLY_WORSE: f64 = 1.3;
/// Predictions after which no further fold is made.
const PREDICTIONS: usize = 600;
/// Most folds; each costs a factorisation a length.
const FOLDS: usize = 6;

/// A length chosen by cross-validation.
#[derive(Debug, Clone)]
pub struct ChosenLength {
    /// In the units of the points.
    pub length: f64,
    /// Root mean square of what was not predicted, in the units of the values: the standard deviation of the noise, and on top the
    /// error of the prediction, which is largest near boundaries. `None` where too few values were left to predict from.
    pub noise: Option<f64>,
    /// Lengths tried.
    pub trials: usize,
}

/// Vertices to predict, and the confidence that leaves their neighbourhoods out.
struct Fold {
    predicted: Vec<VertexId>,
    confidence: Vec<f64>,
}

/// One trial of the search.
#[derive(Debug, Clone, Copy)]
struct Trial {
    log_length: f64,
    score: f64,
}

/// The smoothing length that predicts neighbourhoods best.
///
/// # Arguments
/// * `weights`: order, confidence and mask are used; its length is ignored.
/// * `shortest`, `longest`: bounds of the search, in the units of the points; useful are one or two edges and a quarter of
///   the bounding box.
///
/// # Returns
/// The length of least score. On a mesh too small to leave anything out it is the shortest.
///
/// # Errors
/// [`QpError`] if a linear system cannot be solved.
///
/// # Cost
/// About eight lengths, with a factorisation a fold each; one fold from about 12,000 vertices on.
///
/// # Source
/// Burman, Chow, Nolan 1994, section 2, h-block cross-validation.
pub fn cross_validated_length(
    fitter: &mut Fitter<'_>,
    data: &[f64],
    weights: &EnergyWeights<'_>,
    (shortest, longest): (f64, f64),
) -> Result<ChosenLength, QpError> {
    let folds = folds(fitter.complex(), weights.confidence);
    if folds.is_empty() {
        return Ok(ChosenLength { length: shortest, noise: None, trials: 0 });
    }
    let mut trials: Vec<Trial> = Vec::new();
    let mut attempt = |log_length: f64, trials: &mut Vec<Trial>| -> Result<Trial, QpError> {
        let trial = Trial { log_length, score: score(fitter, data, weights, &folds, log_length.exp())? };
        let place = trials.partition_point(|other| other.log_length < log_length);
        trials.insert(place, trial);
        Ok(trial)
    };
    // Scan upwards and stop once the score has clearly passed its minimum: the longest lengths are the worst conditioned.
    let mut log_length = shortest.ln();
    let mut best = attempt(log_length, &mut trials)?;
    while log_length + SCAN_RATIO.ln() <= longest.ln() {
        log_length += SCAN_RATIO.ln();
        let trial = attempt(log_length, &mut trials)?;
        if trial.score < best.score {
            best = trial;
        } else if trial.score > CLEARLY_WORSE * best.score {
            break;
        }
    }
    for _ in 0..REFINEMENTS {
        let place = trials.iter().position(|trial| trial.log_length == best.log_length).unwrap_or(0);
        let (left, right) = (place.checked_sub(1).map(|left| trials[left]), trials.get(place + 1).copied());
        let log_length = match (left, right) {
            (Some(left), Some(right)) => parabola_minimum(left, best, right),
            // The best one is the first or the last tried: look between it and its only neighbour.
            (Some(only), None) | (None, Some(only)) => 0.6 * best.log_length + 0.4 * only.log_length,
            (None, None) => break,
        };
        let next = attempt(log_length, &mut trials)?;
        if next.score < best.score {
            best = next;
        }
    }
    Ok(ChosenLength { length: best.log_length.exp(), noise: Some(best.score.sqrt()), trials: trials.len() })
}

/// Mean square error of the prediction over all folds.
fn score(
    fitter: &mut Fitter<'_>,
    data: &[f64],
    weights: &EnergyWeights<'_>,
    folds: &[Fold],
    length: f64,
) -> Result<f64, QpError> {
    let (mut sum, mut count) = (0.0, 0usize);
    for fold in folds {
        let weights = EnergyWeights { length, confidence: Some(&fold.confidence), ..weights.clone() };
        let predicted = fitter.smoothed(&weights, &[data])?;
        sum += fold.predicted.iter().map(|vertex| (predicted[0][vertex.index()] - data[vertex.index()]).powi(2)).sum::<f64>();
        count += fold.predicted.len();
    }
    Ok(sum / count as f64)
}

/// Sets of vertices so far apart that the neighbourhoods left out do not meet.
fn folds(complex: &SimplicialComplex, confidence: Option<&[f64]>) -> Vec<Fold> {
    let n = complex.vertex_count();
    let weight = |i: usize| confidence.map_or(1.0, |confidence| confidence[i]);
    // A fixed shuffle: places without a pattern, the same in every run.
    let mut sequence: Vec<VertexId> = (0..n).map(VertexId::from).collect();
    sequence.sort_by_key(|vertex| (mix(u64::from(vertex.0)), vertex.0));
    let counted = (0..n).filter(|&i| weight(i) > 0.0).count();
    let mut folds: Vec<Fold> = Vec::new();
    let mut was_predicted = vec![false; n];
    let mut predictions = 0;
    let mut ball = Ball::new(n);
    while folds.len() < FOLDS && predictions < PREDICTIONS {
        let mut is_left_out = vec![false; n];
        let mut taken = vec![false; n];
        let mut predicted = Vec::new();
        for &vertex in &sequence {
            if was_predicted[vertex.index()] || taken[vertex.index()] || weight(vertex.index()) == 0.0 {
                continue;
            }
            if complex.neighbours(vertex).is_empty() {
                continue;
            }
            for &near in ball.around(complex, vertex, RADIUS) {
                is_left_out[near.index()] = true;
            }
            for &near in ball.around(complex, vertex, 2 * RADIUS + 1) {
                taken[near.index()] = true;
            }
            was_predicted[vertex.index()] = true;
            predicted.push(vertex);
        }
        let confidence: Vec<f64> = (0..n).map(|i| if is_left_out[i] { 0.0 } else { weight(i) }).collect();
        // Without enough data left there is nothing to predict from.
        let left = confidence.iter().filter(|&&weight| weight > 0.0).count();
        if predicted.is_empty() || 3 * left < counted {
            break;
        }
        predictions += predicted.len();
        folds.push(Fold { predicted, confidence });
    }
    folds
}

/// Breadth-first search with marks that need no clearing.
struct Ball {
    visit: Vec<u32>,
    current: u32,
    reached: Vec<VertexId>,
}

impl Ball {
    fn new(vertices: usize) -> Self {
        Self { visit: vec![0; vertices], current: 0, reached: Vec::new() }
    }

    /// Vertices at most `radius` edges from the centre, centre first.
    fn around(&mut self, complex: &SimplicialComplex, centre: VertexId, radius: usize) -> &[VertexId] {
        self.current += 1;
        self.reached.clear();
        self.reached.push(centre);
        self.visit[centre.index()] = self.current;
        let mut begin = 0;
        for _ in 0..radius {
            let end = self.reached.len();
            for place in begin..end {
                for &neighbour in complex.neighbours(self.reached[place]) {
                    if self.visit[neighbour.index()] != self.current {
                        self.visit[neighbour.index()] = self.current;
                        self.reached.push(neighbour);
                    }
                }
            }
            begin = end;
        }
        &self.reached
    }
}

/// Where the parabola through three scores has its minimum, kept off the points already tried.
fn parabola_minimum(left: Trial, middle: Trial, right: Trial) -> f64 {
    let (a, b) = (middle.log_length - left.log_length, middle.log_length - right.log_length);
    let (fa, fb) = (middle.score - right.score, middle.score - left.score);
    let denominator = a * fa - b * fb;
    let step = if denominator == 0.0 { 0.0 } else { 0.5 * (a * a * fa - b * b * fb) / denominator };
    let (low, high) = (left.log_length, right.log_length);
    let margin = 0.1 * (high - low);
    let found = (middle.log_length - step).clamp(low + margin, high - margin);
    if found.is_finite() && (found - middle.log_length).abs() >= 0.05 * (high - low) {
        return found;
    }
    // The wider side has more to tell.
    if a > -b { middle.log_length - 0.4 * a } else { middle.log_length - 0.4 * b }
}

/// A bijective hash of a number (Steele, Lea, Flood 2014, *SplitMix*).
fn mix(number: u64) -> u64 {
    let mut bits = number.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}
