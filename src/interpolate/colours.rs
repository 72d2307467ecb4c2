//! Colour diffusion: colours given at some vertices, spread over the mesh channel by channel, or as a blend of basis functions.
//!
//! Literature: Jacobson, Weinkauf, Sorkine 2012, eq. 2, figures 4 and 11; Finch, Snyder, Hoppe 2011, *Freeform vector graphics with
//! controlled thin-plate splines*.

use crate::field::VertexId;

use super::InterpolateError;
use super::interpolator::{BoundaryValues, InterpolateReport, Interpolator};
use super::method::{InterpolateOptions, Method};
use super::partition::normalise;

/// What is interpolated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Blend {
    /// Red, green and blue, each by itself: three functions, and a guarantee of [`Method::Monotone`] is one about the colours themselves.
    #[default]
    Channels,
    /// A basis function for every given colour, 1 where it is given and 0 at all others, divided by their sum: eq. 2 of the paper. A
    /// guarantee of the basis functions does not survive the sum.
    Basis,
}

/// Colours at all vertices.
#[derive(Debug, Clone, PartialEq)]
pub struct Diffused {
    /// Red, green and blue, `n` numbers each, in the units of the given ones.
    pub channels: [Vec<f64>; 3],
    /// One report a function that was solved for.
    pub reports: Vec<InterpolateReport>,
}

/// Spreads colours over a mesh.
///
/// # Arguments
/// * `given`: vertices with red, green and blue; at least one in every connected part.
///
/// # Returns
/// The given colours where they are given. With [`Method::Monotone`] and [`Blend::Channels`] no channel has an extremum but at given
/// colours, so every channel stays within the range of the given ones.
///
/// # Errors
/// [`InterpolateError`].
///
/// # Cost
/// Three functions, or one for each given colour.
///
/// # Source
/// Jacobson, Weinkauf, Sorkine 2012, eq. 2.
///
/// # Example
/// ```
/// use morsmooth::{field::VertexId, interpolate::{Blend, Interpolator, Method, diffuse}, mesh::{Domain, Grid, Mask}};
/// let complex = Domain::from_grid(&Grid::image([9, 7, 1], [0.0; 3], [1.0; 3]), &Mask::none())?.complex;
/// let given = [(VertexId(0), [1.0, 0.0, 0.2]), (VertexId(62), [0.0, 0.5, 0.2]), (VertexId(8), [0.3, 1.0, 0.2])];
/// let mut interpolator = Interpolator::new(&complex, 2)?;
/// let found = diffuse(&mut interpolator, &given, (Method::Monotone, Blend::Channels), &Default::default())?;
/// assert_eq!(found.channels[1][8], 1.0);
/// assert!(found.channels[0].iter().all(|value| (0.0..=1.0).contains(value)));
/// assert!(found.channels[2].iter().all(|&value| value == 0.2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn diffuse(
    interpolator: &mut Interpolator<'_>,
    given: &[(VertexId, [f64; 3])],
    (method, blend): (Method, Blend),
    options: &InterpolateOptions,
) -> Result<Diffused, InterpolateError> {
    match blend {
        Blend::Channels => by_channel(interpolator, given, method, options),
        Blend::Basis => by_basis(interpolator, given, method, options),
    }
}

fn by_channel(
    interpolator: &mut Interpolator<'_>,
    given: &[(VertexId, [f64; 3])],
    method: Method,
    options: &InterpolateOptions,
) -> Result<Diffused, InterpolateError> {
    let values = |channel: usize| given.iter().map(|&(vertex, colour)| (vertex, colour[channel])).collect::<Vec<_>>();
    let n = interpolator.complex().vertex_count();
    // A channel with one value needs no solve, which would only add rounding.
    let varying: Vec<usize> = (0..3).filter(|&channel| given.iter().any(|(_, colour)| colour[channel] != given[0].1[channel])).collect();
    let asked: Vec<BoundaryValues> = varying.iter().map(|&channel| values(channel).into()).collect();
    let found = interpolator.solve_each(method, &asked, options)?;
    let mut channels = [0, 1, 2].map(|channel| vec![given.first().map_or(0.0, |(_, colour)| colour[channel]); n]);
    let mut reports = Vec::new();
    for (&channel, function) in varying.iter().zip(found) {
        channels[channel] = function.values;
        reports.push(function.report);
    }
    Ok(Diffused { channels, reports })
}

fn by_basis(
    interpolator: &mut Interpolator<'_>,
    given: &[(VertexId, [f64; 3])],
    method: Method,
    options: &InterpolateOptions,
) -> Result<Diffused, InterpolateError> {
    let mut colours: Vec<[f64; 3]> = Vec::new();
    let number: Vec<usize> = given
        .iter()
        .map(|(_, colour)| {
            colours.iter().position(|own| own == colour).unwrap_or_else(|| {
                colours.push(*colour);
                colours.len() - 1
            })
        })
        .collect();
    let indicator = |own: usize| {
        let value = |(&(vertex, _), &number): (&(VertexId, [f64; 3]), &usize)| (vertex, if number == own { 1.0 } else { 0.0 });
        BoundaryValues::from(given.iter().zip(&number).map(value).collect::<Vec<_>>())
    };
    if colours.len() < 2 {
        return by_channel(interpolator, given, method, options);
    }
    let asked: Vec<BoundaryValues> = (0..colours.len()).map(indicator).collect();
    let found = interpolator.solve_each(method, &asked, options)?;
    let (mut basis, mut reports) = (Vec::new(), Vec::new());
    for function in found {
        basis.push(function.values);
        reports.push(function.report);
    }
    normalise(&mut basis)?;
    let n = interpolator.complex().vertex_count();
    let blended = |channel: usize| {
        (0..n).map(|vertex| basis.iter().zip(&colours).map(|(function, colour)| function[vertex] * colour[channel]).sum()).collect()
    };
    Ok(Diffused { channels: [0, 1, 2].map(blended), reports })
}
