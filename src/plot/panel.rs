//! One field on a planar domain or a surface: colours, isolines, marks.

use super::camera::View;
use super::canvas::Canvas;
use super::colour::{INK, MAXIMUM, MINIMUM, OUTSIDE, Rgb, TABLE_LENGTH, WHITE, mix};
use super::overlay::Overlay;
use super::picture::FieldView;
use super::raster::{Fit, Samples, rasterise};
use crate::field::VertexId;
use rayon::prelude::*;

/// Samples along each side of a pixel; their mean is the pixel, which smooths rims and isolines.
const OVERSAMPLING: usize = 2;
/// Pixels about the domain, so that marks on its rim fit in.
const RIM: f64 = 8.0;
/// Ink of an isoline, 0 to 1.
const ISOLINE_INK: f64 = 0.55;
/// Part of the domain that isolines may cover before they fade, so that noise does not turn the picture black.
const ISOLINE_COVER: f64 = 0.12;

/// How values are shown in all panels of a picture.
pub(super) struct Scale {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) table: Vec<Rgb>,
    /// Distance of isolines in values; `None` for a constant field.
    pub(super) isoline_step: Option<f64>,
}

impl Scale {
    pub(super) fn colour(&self, value: f64) -> Rgb {
        let part = if self.high > self.low { (value - self.low) / (self.high - self.low) } else { 0.5 };
        self.table[(part.clamp(0.0, 1.0) * (TABLE_LENGTH - 1) as f64).round() as usize]
    }
}

/// A rectangle of the sheet, in pixels.
#[derive(Clone, Copy)]
pub(super) struct Area {
    pub(super) left: i64,
    pub(super) top: i64,
    pub(super) width: i64,
    pub(super) height: i64,
}

/// What a panel leaves out.
pub(super) struct Shown {
    /// A planar domain does not fill its rectangle.
    pub(super) has_outside: bool,
    /// Extrema behind the surface.
    pub(super) hidden: usize,
}

/// A place on the sheet.
pub(super) struct Spot {
    /// In pixels from the upper left corner.
    pub(super) at: [f64; 2],
    /// Behind the surface.
    pub(super) is_hidden: bool,
}

/// What a panel shows.
pub(super) struct Panel<'a> {
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) view: &'a View,
    pub(super) field: &'a FieldView<'a>,
    pub(super) overlay: Option<&'a Overlay<'a>>,
}

/// Draws a field into `area`.
pub(super) fn draw_field(canvas: &mut Canvas, area: Area, panel: &Panel<'_>, scale: &Scale) -> Shown {
    let &Panel { triangles, view, field, overlay } = panel;
    let size = (area.width as usize * OVERSAMPLING, area.height as usize * OVERSAMPLING);
    let radius = mark_radius(field.minima.len() + field.maxima.len());
    let fit = fit(view, size, RIM * OVERSAMPLING as f64);
    let samples = rasterise(triangles, view, field.values, fit, size);
    let mut has_outside = false;
    if view.planar {
        let corner = fit.place([view.low[0], view.high[1], 0.0]);
        let extent = view.extent().map(|length| length * fit.scale / OVERSAMPLING as f64);
        let at = |c: f64| (c / OVERSAMPLING as f64).round() as i64;
        let (left, top) = (area.left + at(corner[0]), area.top + at(corner[1]));
        canvas.rectangle(left, top, extent[0].round() as i64, extent[1].round() as i64, OUTSIDE);
        let covered = samples.value.iter().filter(|value| !value.is_nan()).count() as f64;
        // The samples along the rim may fall on either side of it.
        has_outside = covered < 0.995 * extent[0] * extent[1] * (OVERSAMPLING * OVERSAMPLING) as f64;
    }
    paint(canvas, area, &samples, scale);
    if let Some(overlay) = overlay {
        let spot = |vertices: &[u32]| spot(&samples, area, fit, view, vertices);
        overlay.draw(canvas, &spot, radius);
    }
    let hidden = draw_marks(canvas, area, &samples, fit, view, field, radius);
    Shown { has_outside, hidden }
}

/// Centres the view in the rectangle, true to its aspect, with a margin for marks on the rim.
fn fit(view: &View, (width, height): (usize, usize), margin: f64) -> Fit {
    let room = [width as f64 - 2.0 * margin, height as f64 - 2.0 * margin];
    let extent = view.extent();
    let scale = (0..2)
        .filter(|&axis| extent[axis] > 0.0)
        .map(|axis| room[axis] / extent[axis])
        .fold(f64::INFINITY, f64::min);
    let scale = if scale.is_finite() { scale } else { 1.0 };
    let middle = [0, 1].map(|axis| 0.5 * (view.low[axis] + view.high[axis]));
    Fit { scale, left: middle[0] - 0.5 * width as f64 / scale, top: middle[1] + 0.5 * height as f64 / scale }
}

fn paint(canvas: &mut Canvas, area: Area, samples: &Samples, scale: &Scale) {
    let isoline = isolines(samples, scale);
    let (covered, lines) = samples.value.iter().zip(&isoline).fold((0usize, 0usize), |(covered, lines), (v, &line)| {
        (covered + usize::from(!v.is_nan()), lines + usize::from(line))
    });
    let cover = lines as f64 / covered.max(1) as f64;
    let ink = ISOLINE_INK * (ISOLINE_COVER / cover.max(ISOLINE_COVER));
    let share = 1.0 / (OVERSAMPLING * OVERSAMPLING) as f64;
    let pixel = |x: usize, y: usize| {
        let (mut sum, mut hits) = ([0.0; 3], 0usize);
        for sub in 0..OVERSAMPLING * OVERSAMPLING {
            let column = x * OVERSAMPLING + sub % OVERSAMPLING;
            let row = y * OVERSAMPLING + sub / OVERSAMPLING;
            let sample = row * samples.width + column;
            let value = samples.value[sample];
            if value.is_nan() {
                continue;
            }
            hits += 1;
            let plain = scale.colour(value);
            let inked = if isoline[sample] { mix(plain, INK, ink) } else { plain };
            let light = f64::from(samples.light[sample]);
            for channel in 0..3 {
                sum[channel] += f64::from(inked[channel]) * light;
            }
        }
        (sum.map(|channel| (channel / hits.max(1) as f64).round() as u8), hits as f64 * share)
    };
    let (width, height) = (area.width as usize, area.height as usize);
    let rows: Vec<Vec<(Rgb, f64)>> =
        (0..height).into_par_iter().map(|y| (0..width).map(|x| pixel(x, y)).collect()).collect();
    for (row, y) in rows.iter().zip(area.top..) {
        for (&(colour, alpha), x) in row.iter().zip(area.left..) {
            canvas.blend(x, y, colour, alpha);
        }
    }
}

/// Samples whose right or lower neighbour lies in another band of values.
fn isolines(samples: &Samples, scale: &Scale) -> Vec<bool> {
    let Some(step) = scale.isoline_step else {
        return vec![false; samples.value.len()];
    };
    let band: Vec<f64> = samples.value.par_iter().map(|&value| (value / step).floor()).collect();
    // A jump in depth is a rim behind which another part of the surface begins, not an isoline.
    let nearest = samples.width as f32 * 0.01;
    let differs = |a: usize, b: usize| {
        band[a] != band[b]
            && !band[a].is_nan()
            && !band[b].is_nan()
            && (samples.depth[a] - samples.depth[b]).abs() < nearest.max(4.0)
    };
    (0..samples.value.len())
        .into_par_iter()
        .map(|at| {
            let (x, y) = (at % samples.width, at / samples.width);
            (x + 1 < samples.width && differs(at, at + 1)) || (y + 1 < samples.height && differs(at, at + samples.width))
        })
        .collect()
}

/// Discs shrink where there are many, down to what can still be told from a pixel.
pub(super) fn mark_radius(count: usize) -> f64 {
    (40.0 / (count.max(1) as f64).sqrt()).clamp(1.6, 5.0)
}

/// A disc with a white rim.
pub(super) fn draw_mark(canvas: &mut Canvas, centre: [f64; 2], radius: f64, colour: Rgb) {
    canvas.disc(centre, radius + if radius > 3.0 { 1.5 } else { 0.8 }, WHITE);
    canvas.disc(centre, radius, colour);
}

fn draw_marks(
    canvas: &mut Canvas,
    area: Area,
    samples: &Samples,
    fit: Fit,
    view: &View,
    field: &FieldView<'_>,
    radius: f64,
) -> usize {
    let mut hidden = 0;
    for (vertices, colour) in [(field.minima, MINIMUM), (field.maxima, MAXIMUM)] {
        for &VertexId(vertex) in vertices {
            let spot = spot(samples, area, fit, view, &[vertex]);
            if spot.is_hidden {
                hidden += 1;
            } else {
                draw_mark(canvas, spot.at, radius, colour);
            }
        }
    }
    hidden
}

/// Where the mean of some vertices is drawn.
fn spot(samples: &Samples, area: Area, fit: Fit, view: &View, vertices: &[u32]) -> Spot {
    let mut mean = [0.0; 3];
    for &vertex in vertices {
        for (slot, coordinate) in mean.iter_mut().zip(view.positions[vertex as usize]) {
            *slot += coordinate / vertices.len() as f64;
        }
    }
    let place = fit.place(mean);
    let tolerance = 0.01 * (samples.width + samples.height) as f64;
    let pixel = |axis: usize| place[axis] / OVERSAMPLING as f64;
    Spot {
        at: [area.left as f64 + pixel(0), area.top as f64 + pixel(1)],
        is_hidden: !view.planar && is_behind(samples, place, tolerance),
    }
}

/// Whether everything drawn about `place` lies before it by more than `tolerance`.
fn is_behind(samples: &Samples, place: [f64; 3], tolerance: f64) -> bool {
    let around = |c: f64, most: usize| {
        let middle = (c.floor().max(0.0) as usize).min(most - 1);
        middle.saturating_sub(2)..=(middle + 2).min(most - 1)
    };
    let columns = around(place[0], samples.width);
    around(place[1], samples.height).all(|y| {
        columns.clone().all(|x| {
            let depth = f64::from(samples.depth[y * samples.width + x]);
            depth == f64::NEG_INFINITY || depth > place[2] + tolerance
        })
    })
}
