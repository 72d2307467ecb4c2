//! Colours on a planar mesh as an image: a pixel shows the mesh at its middle, without frame, isolines or smoothing of rims.

use super::camera::View;
use super::error::PlotError;
use super::raster::{Fit, rasterise, visible_triangles};
use crate::field::{FieldError, check_finite};
use crate::mesh::SimplicialComplex;

/// How large a pixel is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PixelSize {
    /// So that the image has this width.
    Width(u32),
    /// In the units of the points.
    Units(f64),
}

/// An image, and how many of its pixels no screen can show.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Painting {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Red, green, blue and alpha of every pixel, row by row from the top; alpha 0 beside the mesh.
    pub rgba: Vec<u8>,
    /// Pixels on the mesh.
    pub covered: usize,
    /// Of these, pixels with a channel below 0 or above 1; shown as the nearest colour.
    pub out_of_gamut: usize,
}

/// How far a channel may leave [0, 1] by rounding alone.
const ROUNDING: f64 = 1e-9;
/// The largest image, in pixels along a side.
const LARGEST: f64 = 16_384.0;

/// Whether a colour is one that a screen can show, up to rounding.
pub fn is_in_gamut(colour: [f64; 3]) -> bool {
    colour.iter().all(|channel| (-ROUNDING..=1.0 + ROUNDING).contains(channel))
}

/// The nearest colour of 8 bits a channel.
pub fn to_bytes(colour: [f64; 3]) -> [u8; 3] {
    colour.map(|channel| (channel.clamp(0.0, 1.0) * 255.0).round() as u8)
}

/// Paints colours on a planar mesh.
///
/// # Arguments
/// * `channels`: red, green and blue, `n` numbers each, 0 to 1; linear on every triangle.
///
/// # Errors
/// [`PlotError::Field`] for numbers that are not finite or too few, [`PlotError::Empty`] for meshes without triangles or not in a plane,
/// [`PlotError::Width`] for images of no pixel or more than 16,384 along a side.
///
/// # Cost
/// O(pixels + triangles), in parallel.
pub fn paint(complex: &SimplicialComplex, channels: [&[f64]; 3], size: PixelSize) -> Result<Painting, PlotError> {
    for channel in channels {
        if channel.len() != complex.vertex_count() {
            return Err(FieldError::LengthMismatch { expected: complex.vertex_count(), found: channel.len() }.into());
        }
        check_finite(channel)?;
    }
    let view = View::of(complex);
    let triangles = visible_triangles(complex);
    if complex.dimension() != 2 || triangles.is_empty() || !view.planar {
        return Err(PlotError::Empty);
    }
    let extent = view.extent();
    let pixel = match size {
        PixelSize::Width(width) => extent[0] / f64::from(width),
        PixelSize::Units(length) => length,
    };
    let [width, height] = extent.map(|length| (length / pixel).ceil().max(1.0));
    if !(pixel > 0.0 && width <= LARGEST && height <= LARGEST) {
        let found = width.max(height);
        return Err(PlotError::Width { found: if found.is_finite() { found as u32 } else { u32::MAX }, least: 1, most: LARGEST as u32 });
    }
    let fit = Fit { scale: 1.0 / pixel, left: view.low[0], top: view.high[1] };
    let (width, height) = (width as usize, height as usize);
    let samples = channels.map(|channel| rasterise(&triangles, &view, channel, fit, (width, height)).value);
    let mut painting = Painting { width: width as u32, height: height as u32, rgba: Vec::new(), covered: 0, out_of_gamut: 0 };
    painting.rgba.reserve(4 * width * height);
    let [red, green, blue] = &samples;
    for ((&red, &green), &blue) in red.iter().zip(green).zip(blue) {
        let colour = [red, green, blue];
        if colour[0].is_nan() {
            painting.rgba.extend([0; 4]);
            continue;
        }
        painting.covered += 1;
        painting.out_of_gamut += usize::from(!is_in_gamut(colour));
        painting.rgba.extend(to_bytes(colour));
        painting.rgba.push(255);
    }
    Ok(painting)
}
