//! Skinning weights: one function a handle, 1 on its own vertices and 0 on those of the others.
//!
//! Literature: Jacobson, Weinkauf, Sorkine 2012, section 4; Jacobson, Baran, Popović, Sorkine 2011.

use crate::audit::{PlateauReport, audit_plateaus};
use crate::field::Precision;

use super::coupled::coupled;
use super::method::{InterpolateOptions, Method};
use super::partition::{distance_from_unity, keep_strongest, normalise, normalise_in_order};
use super::{BoundaryValues, InterpolateError, InterpolateReport, Interpolator};

/// Distance of the sums of weights from 1 at which the turns of normalisation and sweep end.
const UNITY: f64 = 1e-6;

/// Whether the weights at a vertex sum to one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Partition {
    /// Each handle's weights stay as they are found.
    Free,
    /// They are divided by their sum afterwards. Monotone weights would lose their guarantee: they are moved back into an order with the
    /// wanted extrema, and divided again, in turns, and keep it; their sums come as near to 1 as the turns bring them.
    #[default]
    Normalised,
    /// [`Method::Monotone`]: all handles are one problem with the sum as a constraint. For few handles on small meshes.
    Coupled,
}

/// What may be asked of skinning weights.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WeightOptions {
    /// How each function is found.
    pub method: Method,
    /// What is asked of each function.
    pub function: InterpolateOptions,
    /// Whether the weights sum to one.
    pub partition: Partition,
    /// Only so many of the greatest weights are left at each vertex, and divided by their sum.
    pub strongest: Option<usize>,
}

/// What became of the weights of one handle.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightReport {
    /// How the function was found.
    pub function: InterpolateReport,
    /// Extrema of the function as it was found.
    pub found: PlateauReport,
    /// Extrema after plain division by the sums, had it ended there; absent where nothing was divided.
    pub divided: Option<PlateauReport>,
    /// Extrema of the weights in the end.
    pub extrema: PlateauReport,
    /// `wᵀ (L M⁻¹)^(k-1) L w` of the weights in the end.
    pub energy: f64,
}

/// Skinning weights of all handles.
#[derive(Debug, Clone, PartialEq)]
pub struct SkinningWeights {
    /// `n` weights for every handle.
    pub weights: Vec<Vec<f64>>,
    /// One a handle.
    pub reports: Vec<WeightReport>,
    /// `trace(Wᵀ (L M⁻¹)^(k-1) L W)`.
    pub energy: f64,
    /// Largest distance of a sum of weights from 1, as found and in the end.
    pub off_unity: (f64, f64),
    /// Turns of division and return to the order.
    pub turns: usize,
    /// Largest sum of weights that was cut off at a vertex.
    pub cut_off: f64,
}

/// Skinning weights for all handles of a mesh.
///
/// # Arguments
/// * `given`: the boundary values of every handle.
///
/// # Returns
/// Weights of the asked width. Of [`Method::Monotone`], without pruning, every handle's weights have no extremum but its given values;
/// `reports` has the audit.
///
/// # Errors
/// [`InterpolateError`].
///
/// # Cost
/// As [`Interpolator::solve_each`].
pub fn skinning_weights(
    interpolator: &mut Interpolator<'_>,
    given: &[BoundaryValues],
    options: &WeightOptions,
) -> Result<SkinningWeights, InterpolateError> {
    let complex = interpolator.complex();
    let precision = options.function.precision;
    let judge = |weights: &[Vec<f64>]| -> Result<Vec<PlateauReport>, InterpolateError> {
        let audits = weights.iter().zip(given).map(|(weights, given)| audit_plateaus(complex, weights, &given.values));
        Ok(audits.collect::<Result<Vec<_>, _>>()?)
    };
    let is_monotone = options.method == Method::Monotone;
    let (functions, mut frames): (Vec<_>, Vec<_>) = match (is_monotone, options.partition) {
        (true, Partition::Coupled) => (coupled(interpolator, given, &options.function)?, Vec::new()),
        (true, _) => {
            let (functions, frames): (Vec<_>, Vec<_>) = interpolator.framed(given, &options.function)?.into_iter().unzip();
            (functions, frames.into_iter().flatten().collect())
        }
        _ => (interpolator.solve_each(options.method, given, &options.function)?, Vec::new()),
    };
    let (mut weights, functions): (Vec<Vec<f64>>, Vec<InterpolateReport>) =
        functions.into_iter().map(|found| (found.values, found.report)).unzip();
    let before = distance_from_unity(&weights);
    let found = judge(&weights)?;
    let mut divided = vec![None; weights.len()];
    let mut turns = 0;
    if options.partition == Partition::Normalised {
        let mut plain = weights.clone();
        normalise(&mut plain)?;
        round(&mut plain, precision);
        divided = judge(&plain)?.into_iter().map(Some).collect();
        if is_monotone {
            drop(plain);
            turns = normalise_in_order(&mut weights, &mut frames, (interpolator.smooth(), &options.function), UNITY)?;
        } else {
            weights = plain;
        }
    }
    drop(frames);
    let mut cut_off = 0.0;
    if let Some(most) = options.strongest {
        cut_off = keep_strongest(&mut weights, most)?;
    }
    round(&mut weights, precision);
    let extrema = judge(&weights)?;
    let mut reports = Vec::with_capacity(weights.len());
    for ((((function, found), divided), extrema), weights) in functions.into_iter().zip(found).zip(divided).zip(extrema).zip(&weights) {
        reports.push(WeightReport { function, found, divided, extrema, energy: interpolator.energy(weights) });
    }
    let energy = reports.iter().map(|report| report.energy).sum();
    let off_unity = (before, distance_from_unity(&weights));
    Ok(SkinningWeights { weights, reports, energy, off_unity, turns, cut_off })
}

fn round(weights: &mut [Vec<f64>], precision: Precision) {
    weights.iter_mut().flatten().for_each(|weight| *weight = precision.round(*weight));
}
