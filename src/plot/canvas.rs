//! A sheet of pixels and what is drawn on it: rectangles, smooth lines and discs, text.
//!
//! The letters are Noto Sans Mono (SIL Open Font License 1.1), rasterised inside of the crate `noto-sans-mono-bitmap`.

use super::colour::{Rgb, WHITE, mix};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Where a text lies about its place.
#[derive(Clone, Copy)]
pub(super) enum Align {
    Left,
    Centre,
    Right,
}

/// How a text looks.
#[derive(Clone, Copy)]
pub(super) struct Font {
    pub(super) height: RasterHeight,
    pub(super) weight: FontWeight,
}

pub(super) const TITLE: Font = Font { height: RasterHeight::Size20, weight: FontWeight::Bold };
pub(super) const LABEL: Font = Font { height: RasterHeight::Size16, weight: FontWeight::Regular };

impl Font {
    pub(super) fn width(self, text: &str) -> i64 {
        (text.chars().count() * get_raster_width(self.weight, self.height)) as i64
    }

    pub(super) fn height(self) -> i64 {
        self.height.val() as i64
    }

    /// `text`, cut with two dots where it is wider than `width` pixels.
    pub(super) fn fitted(self, text: &str, width: i64) -> String {
        if self.width(text) <= width {
            return text.to_owned();
        }
        let fitting = (width / self.width("m")).max(2) as usize - 2;
        text.chars().take(fitting).chain("..".chars()).collect()
    }
}

/// A white sheet; the origin is its upper left corner. Whatever lies outside of it is not drawn.
pub(super) struct Canvas {
    width: i64,
    height: i64,
    pixels: Vec<Rgb>,
}

impl Canvas {
    pub(super) fn new(width: u32, height: u32) -> Self {
        let pixels = vec![WHITE; width as usize * height as usize];
        Self { width: i64::from(width), height: i64::from(height), pixels }
    }

    pub(super) fn into_pixels(self) -> Vec<Rgb> {
        self.pixels
    }

    /// Lays a part `alpha` of `colour` over a pixel.
    pub(super) fn blend(&mut self, x: i64, y: i64, colour: Rgb, alpha: f64) {
        if (0..self.width).contains(&x) && (0..self.height).contains(&y) {
            let pixel = &mut self.pixels[(y * self.width + x) as usize];
            *pixel = mix(*pixel, colour, alpha.clamp(0.0, 1.0));
        }
    }

    pub(super) fn rectangle(&mut self, left: i64, top: i64, width: i64, height: i64, colour: Rgb) {
        for y in top..top + height {
            for x in left..left + width {
                self.blend(x, y, colour, 1.0);
            }
        }
    }

    /// Outline of one pixel, inside the rectangle.
    pub(super) fn frame(&mut self, left: i64, top: i64, width: i64, height: i64, colour: Rgb) {
        self.rectangle(left, top, width, 1, colour);
        self.rectangle(left, top + height - 1, width, 1, colour);
        self.rectangle(left, top, 1, height, colour);
        self.rectangle(left + width - 1, top, 1, height, colour);
    }

    /// Covers pixels within `radius` of the segment from `a` to `b`, with a soft rim.
    pub(super) fn segment(&mut self, a: [f64; 2], b: [f64; 2], radius: f64, colour: Rgb) {
        let reach = radius + 1.0;
        let (left, right) = (a[0].min(b[0]) - reach, a[0].max(b[0]) + reach);
        let (top, bottom) = (a[1].min(b[1]) - reach, a[1].max(b[1]) + reach);
        if !(left.is_finite() && right.is_finite() && top.is_finite() && bottom.is_finite()) {
            return;
        }
        let along = [b[0] - a[0], b[1] - a[1]];
        let length_squared = along[0] * along[0] + along[1] * along[1];
        for y in (top.floor() as i64).max(0)..=(bottom.ceil() as i64).min(self.height - 1) {
            for x in (left.floor() as i64).max(0)..=(right.ceil() as i64).min(self.width - 1) {
                let from = [x as f64 + 0.5 - a[0], y as f64 + 0.5 - a[1]];
                let place = if length_squared > 0.0 {
                    ((from[0] * along[0] + from[1] * along[1]) / length_squared).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let distance = (from[0] - place * along[0]).hypot(from[1] - place * along[1]);
                let alpha = radius + 0.5 - distance;
                if alpha > 0.0 {
                    self.blend(x, y, colour, alpha);
                }
            }
        }
    }

    /// A disc with a soft rim.
    pub(super) fn disc(&mut self, centre: [f64; 2], radius: f64, colour: Rgb) {
        self.segment(centre, centre, radius, colour);
    }

    /// Text whose upper edge is at `y`. Characters that the font lacks show as a question mark.
    pub(super) fn text(&mut self, x: i64, y: i64, align: Align, font: Font, colour: Rgb, text: &str) {
        let mut left = match align {
            Align::Left => x,
            Align::Centre => x - font.width(text) / 2,
            Align::Right => x - font.width(text),
        };
        for character in text.chars() {
            let shape = get_raster(character, font.weight, font.height)
                .or_else(|| get_raster('?', font.weight, font.height));
            if let Some(shape) = shape {
                for (row, line) in shape.rows().enumerate() {
                    for (column, &alpha) in line.iter().enumerate() {
                        if alpha > 0 {
                            self.blend(left + column as i64, y + row as i64, colour, f64::from(alpha) / 255.0);
                        }
                    }
                }
            }
            left += font.width("m");
        }
    }
}
