//! Whole pictures: one field, or two side by side on one scale.

use super::camera::View;
use super::canvas::{Align, Canvas, LABEL, TITLE};
use super::colour::{ColourMap, FAINT_INK, INK, MAXIMUM, MINIMUM, OUTSIDE, Rgb};
use super::curve::{draw_curve, places};
use super::error::PlotError;
use super::file::write_atomically;
use super::overlay::{Overlay, SADDLE};
use super::panel::{Area, Panel, Scale, draw_field, draw_mark};
use super::raster::visible_triangles;
use super::ticks::{number, round_step, ticks};
use crate::field::{FieldError, VertexId, check_finite};
use crate::mesh::SimplicialComplex;
use std::path::Path;

const LEAST_WIDTH: u32 = 480;
const MOST_WIDTH: u32 = 8192;
const MARGIN: i64 = 24;
const TITLE_HEIGHT: i64 = 40;
const LEGEND_HEIGHT: i64 = 36;
const BAR_WIDTH: i64 = 22;
/// Bar, ticks and their labels.
const BAR_COLUMN: i64 = 124;
/// About so many isolines from the lowest to the highest value.
const ISOLINES: f64 = 16.0;
/// Part of the values at either end, of the noisier field, that may run off the colour scale.
const OUTLIERS: f64 = 0.005;

/// A field to show, with the extrema to mark on it.
#[derive(Debug, Clone, Copy)]
pub struct FieldView<'a> {
    /// What stands above the panel; cut where it does not fit.
    pub title: &'a str,
    /// `n` finite values, one a vertex.
    pub values: &'a [f64],
    /// Vertices marked as minima, in blue.
    pub minima: &'a [VertexId],
    /// Vertices marked as maxima, in red.
    pub maxima: &'a [VertexId],
}

/// How a picture is made; the default suits most fields.
#[derive(Debug, Clone)]
pub struct PictureOptions {
    /// Width in pixels, 480 to 8192; the height follows from the aspect of the domain.
    pub width: u32,
    /// What the values are, such as `vorticity_magnitude [1/s]`.
    pub label: String,
    /// Values of the two ends of the colour scale. By default that of the last field and of 99 % of the others' values, so
    /// that single noise peaks do not take the colours of all else; symmetric about zero for the diverging map.
    pub range: Option<[f64; 2]>,
    /// The colour map. By default the diverging one where both signs matter, else viridis.
    pub colours: Option<ColourMap>,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self { width: 1600, label: String::new(), range: None, colours: None }
    }
}

/// A finished picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<Rgb>,
}

impl Picture {
    /// A picture of pixels, row by row from the upper left corner.
    pub(super) fn of_pixels(width: u32, height: u32, pixels: Vec<Rgb>) -> Self {
        Self { width, height, pixels }
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Red, green and blue of a pixel, counted from the upper left corner; `None` outside.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 3]> {
        let inside = x < self.width && y < self.height;
        inside.then(|| self.pixels[y as usize * self.width as usize + x as usize])
    }

    /// The picture as the bytes of a PNG file.
    ///
    /// # Errors
    /// [`PlotError::Encode`] if the encoder fails.
    pub fn to_png(&self) -> Result<Vec<u8>, PlotError> {
        use image::ImageEncoder;
        use image::codecs::png::{CompressionType, FilterType, PngEncoder};
        let mut png = Vec::new();
        PngEncoder::new_with_quality(&mut png, CompressionType::Fast, FilterType::Adaptive).write_image(
            self.pixels.as_flattened(),
            self.width,
            self.height,
            image::ExtendedColorType::Rgb8,
        )?;
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

/// A picture of one field: colours, isolines, extrema, colour bar.
///
/// A planar domain is shown in its own plane, true to its aspect, on grey where it has no point; a surface or the hull of
/// a solid from one side, lit; a curve as a chart of value over coordinate or arc length. Minima are blue discs, maxima red ones.
/// Isolines lie on round values.
///
/// # Arguments
/// * `complex`: `n` vertices, dimension 1, 2 or 3.
/// * `field`: `n` values and the vertices to mark.
/// * `options`: width, label, colours.
///
/// # Errors
/// [`PlotError::Field`] for values that are missing or not finite, [`PlotError::UnknownVertex`] for a mark outside of
/// the complex, [`PlotError::Empty`], [`PlotError::Width`], and [`PlotError::Number`] for a colour range that is not finite.
///
/// # Cost
/// O(n + pixels).
///
/// # Example
/// ```
/// use morsmooth::field::VertexId;
/// use morsmooth::mesh::SimplicialComplex;
/// use morsmooth::plot::{FieldView, PictureOptions, field_picture};
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let triangle = SimplicialComplex::new(2, points, vec![0, 1, 2])?;
/// let (minima, maxima) = ([VertexId(0)], [VertexId(2)]);
/// let field = FieldView { title: "one triangle", values: &[0.0, 1.0, 2.0], minima: &minima, maxima: &maxima };
/// let picture = field_picture(&triangle, &field, &PictureOptions::default())?;
/// assert_eq!(picture.width(), 1600);
/// assert!(picture.to_png()?.starts_with(b"\x89PNG"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn field_picture(
    complex: &SimplicialComplex,
    field: &FieldView<'_>,
    options: &PictureOptions,
) -> Result<Picture, PlotError> {
    compose(complex, &[field], options)
}

/// Two fields on one complex side by side, curves one above the other, with one colour scale.
///
/// # Arguments, Errors, Cost
/// As [`field_picture`]; the colour scale is that of `after`, widened to 99 % of the values of `before`.
pub fn before_after(
    complex: &SimplicialComplex,
    before: &FieldView<'_>,
    after: &FieldView<'_>,
    options: &PictureOptions,
) -> Result<Picture, PlotError> {
    compose(complex, &[before, after], options)
}

fn compose(
    complex: &SimplicialComplex,
    fields: &[&FieldView<'_>],
    options: &PictureOptions,
) -> Result<Picture, PlotError> {
    compose_with(complex, fields, options, None)
}

/// Draws all panels, with something over each of them where a panel is no chart.
pub(super) fn compose_with(
    complex: &SimplicialComplex,
    fields: &[&FieldView<'_>],
    options: &PictureOptions,
    overlay: Option<&Overlay<'_>>,
) -> Result<Picture, PlotError> {
    check(complex, fields, options)?;
    if complex.dimension() == 1 {
        return Ok(charts(complex, fields, options));
    }
    Ok(panels(complex, fields, options, overlay))
}

fn check(complex: &SimplicialComplex, fields: &[&FieldView<'_>], options: &PictureOptions) -> Result<(), PlotError> {
    let vertices = complex.vertex_count();
    if !(LEAST_WIDTH..=MOST_WIDTH).contains(&options.width) {
        return Err(PlotError::Width { found: options.width, least: LEAST_WIDTH, most: MOST_WIDTH });
    }
    if complex.simplex_count() == 0 {
        return Err(PlotError::Empty);
    }
    for field in fields {
        if field.values.len() != vertices {
            return Err(FieldError::LengthMismatch { expected: vertices, found: field.values.len() }.into());
        }
        check_finite(field.values)?;
        if let Some(&vertex) = field.minima.iter().chain(field.maxima).find(|v| v.index() >= vertices) {
            return Err(PlotError::UnknownVertex { vertex, vertices });
        }
    }
    match options.range.into_iter().flatten().find(|end| !end.is_finite()) {
        Some(found) => Err(PlotError::Number { what: "an end of the colour range", found, expected: "" }),
        None => Ok(()),
    }
}

fn panels(
    complex: &SimplicialComplex,
    fields: &[&FieldView<'_>],
    options: &PictureOptions,
    overlay: Option<&Overlay<'_>>,
) -> Picture {
    let view = View::of(complex);
    let scale = scale(complex, fields, options);
    let count = fields.len() as i64;
    let width = (i64::from(options.width) - 2 * MARGIN - BAR_COLUMN - (count - 1) * MARGIN) / count;
    let extent = view.extent();
    let aspect = if extent[0] > 0.0 { extent[1] / extent[0] } else { f64::INFINITY };
    let height = ((width as f64 * aspect).round() as i64).clamp(width / 3, width * 11 / 10);
    let total = MARGIN + TITLE_HEIGHT + height + LEGEND_HEIGHT + MARGIN;
    let mut canvas = Canvas::new(options.width, total as u32);
    let triangles = visible_triangles(complex);
    let top = MARGIN + TITLE_HEIGHT;
    let mut has_outside = false;
    for (field, at) in fields.iter().zip(0..) {
        let left = MARGIN + at * (width + MARGIN);
        canvas.text(left, MARGIN, Align::Left, TITLE, INK, &TITLE.fitted(field.title, width));
        let area = Area { left, top, width, height };
        let shown = draw_field(&mut canvas, area, &Panel { triangles: &triangles, view: &view, field, overlay }, &scale);
        has_outside |= shown.has_outside;
        if shown.hidden > 0 {
            let text = format!("{} extrema out of sight", shown.hidden);
            let bottom = top + height - LABEL.height();
            canvas.text(left + width, bottom, Align::Right, LABEL, FAINT_INK, &text);
        }
    }
    let bar = Area { left: MARGIN + count * (width + MARGIN), top, width: BAR_WIDTH, height };
    colour_bar(&mut canvas, bar, &scale);
    let legend_top = top + height + 14;
    let range = fields.iter().map(|field| range(complex, field.values)).fold((f64::INFINITY, f64::NEG_INFINITY), wider);
    let clipped = range.0 < scale.low || range.1 > scale.high;
    let note = clipped.then(|| format!("all values: {} to {}", number(range.0), number(range.1)));
    let mut also = Vec::new();
    also.extend(overlay.map(|_| (SADDLE, "saddle")));
    also.extend(has_outside.then_some((OUTSIDE, "outside, masked")));
    legend(&mut canvas, legend_top, &also, options, note);
    picture(canvas, options.width, total)
}

fn charts(complex: &SimplicialComplex, fields: &[&FieldView<'_>], options: &PictureOptions) -> Picture {
    let width = i64::from(options.width) - 2 * MARGIN;
    let height = (width / 4).max(200);
    let count = fields.len() as i64;
    let total = count * (MARGIN + TITLE_HEIGHT + height) + LEGEND_HEIGHT + MARGIN;
    let mut canvas = Canvas::new(options.width, total as u32);
    let place = places(complex);
    let (low, high) = match options.range {
        Some([a, b]) => (a.min(b), a.max(b)),
        None => fields.iter().map(|field| range(complex, field.values)).fold((f64::INFINITY, f64::NEG_INFINITY), wider),
    };
    for (field, at) in fields.iter().zip(0..) {
        let top = MARGIN + at * (MARGIN + TITLE_HEIGHT + height);
        canvas.text(MARGIN, top, Align::Left, TITLE, INK, &TITLE.fitted(field.title, width));
        let area = Area { left: MARGIN, top: top + TITLE_HEIGHT, width, height };
        draw_curve(&mut canvas, area, complex, &place, field, (low, high));
    }
    legend(&mut canvas, total - MARGIN - LEGEND_HEIGHT + 18, &[], options, None);
    picture(canvas, options.width, total)
}

/// What was drawn, as a picture.
pub(super) fn picture(canvas: Canvas, width: u32, height: i64) -> Picture {
    Picture { width, height: height as u32, pixels: canvas.into_pixels() }
}

fn wider(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0.min(b.0), a.1.max(b.1))
}

/// Least and greatest value on vertices that are drawn.
fn range(complex: &SimplicialComplex, values: &[f64]) -> (f64, f64) {
    let drawn = complex.simplices().iter().map(|&vertex| values[vertex as usize]);
    drawn.fold((f64::INFINITY, f64::NEG_INFINITY), |range, value| wider(range, (value, value)))
}

/// Range of all but the outermost values.
fn inner_range(complex: &SimplicialComplex, values: &[f64]) -> (f64, f64) {
    let mut drawn: Vec<f64> =
        values.iter().zip(0..).filter(|&(_, v)| !complex.star(VertexId(v)).is_empty()).map(|(&value, _)| value).collect();
    drawn.sort_by(f64::total_cmp);
    let cut = (OUTLIERS * drawn.len() as f64) as usize;
    (drawn[cut], drawn[drawn.len() - 1 - cut])
}

fn scale(complex: &SimplicialComplex, fields: &[&FieldView<'_>], options: &PictureOptions) -> Scale {
    let (mut low, mut high) = match (options.range, fields) {
        (Some([a, b]), _) => (a.min(b), a.max(b)),
        (None, [others @ .., last]) => others
            .iter()
            .map(|field| inner_range(complex, field.values))
            .fold(range(complex, last.values), wider),
        (None, []) => (0.0, 1.0),
    };
    // Both signs matter where the smaller side is at least a fifth of the larger one.
    let both_signs = low < 0.0 && high > 0.0 && (-low).min(high) >= 0.2 * (-low).max(high);
    let colours = options.colours.unwrap_or(if both_signs { ColourMap::Diverging } else { ColourMap::Viridis });
    if colours == ColourMap::Diverging && options.range.is_none() {
        (low, high) = (low.min(-high), high.max(-low));
    }
    let isoline_step = (high > low).then(|| round_step((high - low) / ISOLINES));
    Scale { low, high, table: colours.table(), isoline_step }
}

fn colour_bar(canvas: &mut Canvas, bar: Area, scale: &Scale) {
    let value = |row: i64| scale.high - (scale.high - scale.low) * (row as f64 + 0.5) / bar.height as f64;
    for row in 0..bar.height {
        canvas.rectangle(bar.left, bar.top + row, bar.width, 1, scale.colour(value(row)));
    }
    canvas.frame(bar.left, bar.top, bar.width, bar.height, FAINT_INK);
    for (tick, text) in ticks(scale.low, scale.high, 8) {
        let part = if scale.high > scale.low { (scale.high - tick) / (scale.high - scale.low) } else { 0.5 };
        let row = bar.top + (part * (bar.height - 1) as f64).round() as i64;
        canvas.rectangle(bar.left + bar.width, row, 5, 1, FAINT_INK);
        canvas.text(bar.left + bar.width + 9, row - LABEL.height() / 2, Align::Left, LABEL, INK, &text);
    }
}

fn legend(canvas: &mut Canvas, top: i64, also: &[(Rgb, &str)], options: &PictureOptions, note: Option<String>) {
    let middle = (top + LABEL.height() / 2) as f64;
    let mut left = MARGIN;
    let mut say = |canvas: &mut Canvas, colour: Option<Rgb>, text: &str| {
        if let Some(colour) = colour {
            draw_mark(canvas, [left as f64 + 7.0, middle], 5.0, colour);
            left += 20;
        }
        canvas.text(left, top, Align::Left, LABEL, INK, text);
        left += LABEL.width(text) + 24;
    };
    say(canvas, Some(MINIMUM), "minimum");
    say(canvas, Some(MAXIMUM), "maximum");
    for &(colour, text) in also {
        say(canvas, Some(colour), text);
    }
    if let Some(note) = note {
        say(canvas, None, &note);
    }
    let right = i64::from(options.width) - MARGIN;
    canvas.text(right, top, Align::Right, LABEL, INK, &LABEL.fitted(&options.label, right - left));
}
