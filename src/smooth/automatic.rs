//! The smoothing length: as given, or searched between the edges of the mesh and a quarter of its size.

use crate::field::VertexId;
use crate::mesh::SimplicialComplex;
use crate::monotone::{EnergyWeights, Fitter};

use super::checks::check_power;
use super::error::SmoothError;
use super::length::cross_validated_length;
use super::options::{Length, SmoothOptions};
use super::report::LengthReport;

/// Shortest automatic length, in mean edges: shorter ones leave the noise between neighbours as it is.
const SHORTEST_EDGES: f64 = 1.5;

/// The length to be used, with what is known of the noise.
pub(super) fn resolve_length(
    fitter: &mut Fitter<'_>,
    data: &[f64],
    unit: f64,
    options: &SmoothOptions<'_>,
) -> Result<LengthReport, SmoothError> {
    let diagonal = fitter.complex().bounding_box_diagonal();
    let report = |absolute: f64, noise: Option<f64>| LengthReport {
        absolute,
        of_diagonal: absolute / diagonal,
        automatic: false,
        noise,
    };
    let given = |absolute: f64| check_power(absolute, options.order).map(|()| report(absolute, None));
    Ok(match options.length {
        Length::Absolute(length) => given(length)?,
        Length::OfDiagonal(fraction) => given(fraction * diagonal)?,
        Length::Automatic => {
            let weights = EnergyWeights {
                order: options.order,
                length: 0.0,
                confidence: options.confidence,
                smoothness: options.smoothness,
            };
            let shortest = SHORTEST_EDGES * mean_edge(fitter.complex());
            let longest = 0.25 * diagonal.max(4.0 * shortest);
            check_power(shortest, options.order)?;
            check_power(longest, options.order)?;
            let in_units: Vec<f64> = data.iter().map(|value| value / unit).collect();
            let chosen = cross_validated_length(fitter, &in_units, &weights, (shortest, longest))?;
            LengthReport { automatic: true, ..report(chosen.length, chosen.noise.map(|noise| noise * unit)) }
        }
    })
}

fn mean_edge(complex: &SimplicialComplex) -> f64 {
    let length = |&[a, b]: &[VertexId; 2]| {
        let (a, b) = (complex.point(a), complex.point(b));
        (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
    };
    complex.edges().iter().map(length).sum::<f64>() / complex.edges().len().max(1) as f64
}
