//! Photographs: read, triangulated, and warped by a deformation of the triangulation.

use super::cover::{UNCOVERED, cover};
use super::error::PlotError;
use super::file::write_atomically;
use crate::mesh::{MeshError, SimplicialComplex};
use image::ImageEncoder;
use image::codecs::png::PngEncoder;
use rayon::prelude::*;
use std::path::Path;

/// Samples a pixel along each axis: where a warp compresses, it averages.
const SAMPLES: usize = 3;

/// A picture of red, green, blue and opacity, row by row from the upper left corner.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Photograph {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 4]>,
}

impl Photograph {
    /// Reads a PNG file of any depth and kind of colour.
    ///
    /// # Errors
    /// [`PlotError::Read`], [`PlotError::Decode`].
    pub fn read_png(path: &Path) -> Result<Self, PlotError> {
        let bytes = std::fs::read(path).map_err(|source| PlotError::Read { path: path.to_path_buf(), source })?;
        let decoded = image::load_from_memory_with_format(&bytes, image::ImageFormat::Png)
            .map_err(|error| PlotError::Decode { path: path.to_path_buf(), message: error.to_string() })?
            .into_rgba8();
        let (width, height) = (decoded.width() as usize, decoded.height() as usize);
        let pixels = decoded.into_raw().chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect();
        Ok(Self { width, height, pixels })
    }

    /// A photograph from its pixels.
    ///
    /// # Errors
    /// [`PlotError::Pixels`] unless there are `width x height` of them, and at least one.
    pub fn new(width: usize, height: usize, pixels: Vec<[u8; 4]>) -> Result<Self, PlotError> {
        if pixels.is_empty() || width.checked_mul(height) != Some(pixels.len()) {
            return Err(PlotError::Pixels { width, height, found: pixels.len() });
        }
        Ok(Self { width, height, pixels })
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Red, green, blue and opacity of the pixels, row by row from the upper left corner.
    pub fn pixels(&self) -> &[[u8; 4]] {
        &self.pixels
    }

    /// A triangulation of about so many triangles, in pixels: x to the right, y upwards, the origin in the lower left corner.
    ///
    /// Squares as nearly as the sides allow, each cut along one diagonal, neighbours along different ones.
    ///
    /// # Errors
    /// [`MeshError`] never for a photograph that was read.
    pub fn triangulation(&self, triangles: usize) -> Result<SimplicialComplex, MeshError> {
        let (width, height) = (self.width as f64, self.height as f64);
        let across = ((triangles as f64 / 2.0 * width / height).sqrt().round() as usize).max(1);
        let down = ((triangles as f64 / 2.0 / across as f64).round() as usize).max(1);
        let place = |count: usize, at: usize, length: f64| if at == count { length } else { length * at as f64 / count as f64 };
        let points = (0..=down).flat_map(|j| (0..=across).map(move |i| [place(across, i, width), place(down, j, height), 0.0]));
        let mut simplices = Vec::with_capacity(6 * across * down);
        for j in 0..down {
            for i in 0..across {
                let at = |i: usize, j: usize| (j * (across + 1) + i) as u32;
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                simplices.extend(if (i + j) % 2 == 0 { [a, b, c, a, c, d] } else { [a, b, d, b, c, d] });
            }
        }
        SimplicialComplex::new(2, points.collect(), simplices)
    }

    /// The photograph carried along by a deformation, in a frame of the same size.
    ///
    /// Every output sample looks up where it comes from, with bilinear interpolation, nine samples a pixel. What no triangle covers is
    /// transparent; what is carried out of the frame is lost. Where triangles overlap the first one is seen.
    ///
    /// # Arguments
    /// * `rest`: a triangulation in pixels, as [`Photograph::triangulation`] makes it; `points`: its deformed positions, one a vertex.
    ///
    /// # Errors
    /// [`PlotError::Field`] unless there is a position for every vertex.
    ///
    /// # Cost
    /// O(pixels + triangles), in parallel.
    pub fn warped(&self, rest: &SimplicialComplex, points: &[[f64; 3]]) -> Result<Self, PlotError> {
        if points.len() != rest.vertex_count() {
            let error = crate::field::FieldError::LengthMismatch { expected: rest.vertex_count(), found: points.len() };
            return Err(error.into());
        }
        let fine = SAMPLES as f64;
        let places: Vec<[f64; 3]> =
            points.iter().map(|point| [point[0] * fine, (self.height as f64 - point[1]) * fine, 0.0]).collect();
        let triangles: Vec<[u32; 3]> = rest.simplices().chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        let (width, height) = (self.width * SAMPLES, self.height * SAMPLES);
        let found = cover(&triangles, &places, (width, height));
        let sample = |at: usize| -> Option<[f64; 4]> {
            let triangle = found.triangle[at];
            if triangle == UNCOVERED {
                return None;
            }
            let [a, b, c] = triangles[triangle as usize].map(|vertex| rest.points()[vertex as usize]);
            let [wb, wc] = found.weights[at];
            let from = [0, 1].map(|axis| (1.0 - wb - wc) * a[axis] + wb * b[axis] + wc * c[axis]);
            Some(self.between(from[0], self.height as f64 - from[1]))
        };
        let pixel = |at: usize| {
            let (x, y) = (at % self.width * SAMPLES, at / self.width * SAMPLES);
            let mut sum = [0.0; 4];
            for inner in 0..SAMPLES * SAMPLES {
                let place = (y + inner / SAMPLES) * width + x + inner % SAMPLES;
                if let Some(colour) = sample(place) {
                    // Colours count by their opacity.
                    (0..3).for_each(|channel| sum[channel] += colour[channel] * colour[3]);
                    sum[3] += colour[3];
                }
            }
            let byte = |value: f64| value.round().clamp(0.0, 255.0) as u8;
            let colour = |channel: usize| if sum[3] > 0.0 { byte(sum[channel] / sum[3]) } else { 0 };
            [colour(0), colour(1), colour(2), byte(sum[3] / (SAMPLES * SAMPLES) as f64)]
        };
        let pixels = (0..self.pixels.len()).into_par_iter().with_min_len(4096).map(pixel).collect();
        Ok(Self { width: self.width, height: self.height, pixels })
    }

    /// The colour at a place in pixels from the upper left corner; bilinear between the middles of pixels.
    fn between(&self, x: f64, y: f64) -> [f64; 4] {
        let corner = |place: f64, count: usize| {
            let from = (place - 0.5).clamp(0.0, (count - 1) as f64);
            let low = (from as usize).min(count.saturating_sub(2));
            (low, (low + 1).min(count - 1), from - low as f64)
        };
        let ((x0, x1, s), (y0, y1, t)) = (corner(x, self.width), corner(y, self.height));
        let at = |x: usize, y: usize| self.pixels[y * self.width + x].map(f64::from);
        let (a, b, c, d) = (at(x0, y0), at(x1, y0), at(x0, y1), at(x1, y1));
        std::array::from_fn(|k| (1.0 - t) * ((1.0 - s) * a[k] + s * b[k]) + t * ((1.0 - s) * c[k] + s * d[k]))
    }

    /// The photograph as the bytes of a PNG file.
    ///
    /// # Errors
    /// [`PlotError::Encode`] if the encoder fails.
    pub fn to_png(&self) -> Result<Vec<u8>, PlotError> {
        let mut png = Vec::new();
        let (width, height) = (self.width as u32, self.height as u32);
        PngEncoder::new(&mut png).write_image(self.pixels.as_flattened(), width, height, image::ExtendedColorType::Rgba8)?;
        Ok(png)
    }

    /// Writes a PNG file, whole or not at all.
    ///
    /// # Errors
    /// [`PlotError::Encode`], [`PlotError::Write`].
    pub fn write_png(&self, path: &Path) -> Result<(), PlotError> {
        write_atomically(path, &self.to_png()?)
    }
}
