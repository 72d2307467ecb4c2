//! Charts of persistence, as SVG.

use super::error::PlotError;
use super::ticks::number;
use plotters::coord::Shift;
use plotters::prelude::*;

const SIZE: (u32, u32) = (900, 640);
/// Room to the right of the diagram.
const LEGEND_WIDTH: u32 = 215;
const BLUE: RGBColor = RGBColor(24, 84, 214);
const RED: RGBColor = RGBColor(214, 30, 38);
const INK: RGBColor = RGBColor(38, 38, 42);
/// Stretches of the curve that are flat.
const PLATEAU: RGBColor = RGBColor(244, 190, 60);
const FAINT: RGBColor = RGBColor(226, 226, 230);
/// Persistence of less than this part of the largest is drawn at the left end: noise in the last digit, plateaus.
const LEAST_PART: f64 = 1e-5;

/// One extremum in a persistence diagram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiagramPoint {
    /// Value of the extremum.
    pub birth: f64,
    /// Value of the saddle that ends it; `None` for the last extremum of a component, which nothing ends.
    pub death: Option<f64>,
    /// The extremum is kept.
    pub kept: bool,
}

/// Sizes between which axes have round numbers: beyond, steps overflow or vanish. Nothing measured lies beyond.
const DRAWABLE: (f64, f64) = (1e-290, 1e290);

type Sheet<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// How many extrema have a persistence above a threshold, over the threshold, both axes logarithmic.
///
/// # Arguments
/// * `minima`, `maxima`: persistences, in units of the values; those without a saddle as the whole range.
/// * `threshold`: the chosen threshold, marked by a line; absent if extrema were chosen otherwise. Not drawn where 0.
/// * `kept`: how many minima and maxima are kept, for the legend.
/// * `label`: what the values are, such as `vorticity_magnitude [1/s]`.
///
/// # Returns
/// An SVG document. The same numbers in any order give the same bytes.
///
/// # Errors
/// [`PlotError::Number`] for a number that is not finite or negative, [`PlotError::Chart`] if drawing fails.
///
/// # Cost
/// O(n log n).
pub fn persistence_curve(
    minima: &[f64],
    maxima: &[f64],
    threshold: Option<f64>,
    kept: [usize; 2],
    label: &str,
) -> Result<String, PlotError> {
    CurveChart { minima, maxima, threshold, kept: Some(kept), plateaus: &[], label }.svg()
}

/// A persistence curve with everything that can be marked in it.
#[derive(Debug, Clone, Copy)]
pub struct CurveChart<'a> {
    /// Persistences of the minima, in units of the values; those without a saddle as the whole range.
    pub minima: &'a [f64],
    /// Those of the maxima.
    pub maxima: &'a [f64],
    /// The chosen threshold, marked by a line. Not drawn where 0.
    pub threshold: Option<f64>,
    /// How many minima and maxima are kept, for the legend.
    pub kept: Option<[usize; 2]>,
    /// Stretches of thresholds, each from its least to its greatest, widest first: shaded and named in the legend.
    pub plateaus: &'a [(f64, f64)],
    /// What the values are.
    pub label: &'a str,
}

impl CurveChart<'_> {
    /// Draws the curve, both axes logarithmic.
    ///
    /// # Returns
    /// An SVG document.
    ///
    /// # Errors
    /// [`PlotError::Number`] for a number that is not finite or negative, [`PlotError::Chart`] if drawing fails.
    ///
    /// # Cost
    /// O(n log n).
    pub fn svg(&self) -> Result<String, PlotError> {
        for &found in self.minima.iter().chain(self.maxima) {
            check(found, "a persistence", found >= 0.0)?;
        }
        for found in self.plateaus.iter().flat_map(|&(from, to)| [from, to]) {
            check(found, "the end of a plateau", found >= 0.0)?;
        }
        check(self.threshold.unwrap_or(0.0), "the threshold", self.threshold.is_none_or(|threshold| threshold >= 0.0))?;
        draw(|sheet| draw_curves(sheet, self))
    }
}

/// Birth and death of every extremum, minima above and maxima below the diagonal, with the band of what is removed.
///
/// # Arguments
/// * `minima`, `maxima`: in units of the values; a maximum is born above the saddle that ends it.
/// * `threshold`: half the height of the grey band about the diagonal: what lies in it is removed. Absent if extrema were
///   chosen otherwise: no band.
/// * `label`: what the values are.
///
/// # Returns
/// An SVG document. What nothing ends is drawn as a triangle at the end of the range.
///
/// # Errors
/// [`PlotError::Number`] for a number that is not finite or a negative threshold, [`PlotError::Chart`] if drawing fails.
///
/// # Cost
/// O(n).
pub fn persistence_diagram(
    minima: &[DiagramPoint],
    maxima: &[DiagramPoint],
    threshold: Option<f64>,
    label: &str,
) -> Result<String, PlotError> {
    for point in minima.iter().chain(maxima) {
        check(point.birth, "a birth", true)?;
        check(point.death.unwrap_or(point.birth), "a death", true)?;
    }
    check(threshold.unwrap_or(0.0), "the threshold", threshold.is_none_or(|threshold| threshold >= 0.0))?;
    draw(|sheet| draw_diagram(sheet, minima, maxima, threshold.unwrap_or(0.0), label))
}

fn check(found: f64, what: &'static str, in_range: bool) -> Result<(), PlotError> {
    if found.is_finite() && in_range {
        return Ok(());
    }
    Err(PlotError::Number { what, found, expected: " and, for a persistence or threshold, at least 0" })
}

fn draw<F>(body: F) -> Result<String, PlotError>
where
    F: for<'a> FnOnce(&Sheet<'a>) -> Result<(), Box<dyn std::error::Error>>,
{
    let mut svg = String::new();
    {
        let sheet = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        let chart = |error: Box<dyn std::error::Error>| PlotError::Chart(error.to_string());
        sheet.fill(&WHITE).map_err(|error| chart(error.into()))?;
        body(&sheet).map_err(chart)?;
        sheet.present().map_err(|error| chart(error.into()))?;
    }
    Ok(svg)
}

fn font(size: u32) -> TextStyle<'static> {
    ("sans-serif", size).into_font().color(&INK)
}

/// Corners of the staircase: (persistence, extrema of at least this persistence), by falling count.
fn staircase(persistences: &[f64], least: f64, most: f64) -> Vec<(f64, f64)> {
    let mut sorted: Vec<f64> = persistences.iter().map(|p| p.clamp(least, most)).collect();
    sorted.sort_by(f64::total_cmp);
    let mut corners = vec![(least, sorted.len() as f64)];
    for (below, &persistence) in sorted.iter().enumerate() {
        corners.push((persistence, (sorted.len() - below) as f64));
        if below + 1 < sorted.len() {
            corners.push((persistence, (sorted.len() - below - 1) as f64));
        }
    }
    corners.dedup();
    corners
}

fn draw_curves(sheet: &Sheet<'_>, curve: &CurveChart<'_>) -> Result<(), Box<dyn std::error::Error>> {
    let CurveChart { minima, maxima, kept, plateaus, label, .. } = *curve;
    let threshold = curve.threshold.unwrap_or(0.0);
    let largest = minima.iter().chain(maxima).fold(threshold, |a, &b| a.max(b));
    let most = if largest > 0.0 { largest.clamp(DRAWABLE.0, DRAWABLE.1) } else { 1.0 };
    let threshold_place = threshold.min(most);
    let smallest = minima.iter().chain(maxima).filter(|&&p| p > 0.0).fold(most, |a, &b| a.min(b));
    let smallest = if threshold > 0.0 { smallest.min(threshold) } else { smallest };
    let least = smallest.max(most * LEAST_PART).min(most * 0.5);
    let count = minima.len().max(maxima.len()).max(1) as f64;
    let mut chart = ChartBuilder::on(sheet)
        .margin(18)
        .caption("Extrema by persistence", font(24))
        .x_label_area_size(52)
        .y_label_area_size(66)
        .build_cartesian_2d((least..most * 1.15).log_scale(), (0.8..count * 1.6).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(FAINT)
        .axis_style(INK)
        .label_style(font(15))
        .axis_desc_style(font(17))
        .x_desc(described("persistence", label))
        .y_desc("extrema of at least this persistence")
        .x_label_formatter(&|value| number(*value))
        .y_label_formatter(&|value| number(*value))
        .draw()?;
    for (place, &(from, to)) in plateaus.iter().enumerate() {
        let above = |persistences: &[f64]| persistences.iter().filter(|&&persistence| persistence > from).count();
        let text = format!("plateau: {} minima, {} maxima", above(minima), above(maxima));
        // The widest is the darkest.
        let shade = PLATEAU.mix(0.75 / (1.0 + 0.6 * place as f64)).filled();
        let corners = [(from.clamp(least, most), 0.8), (to.clamp(least, most), count * 1.6)];
        let series = chart.draw_series(std::iter::once(Rectangle::new(corners, shade)))?;
        series.label(text).legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 24, y + 5)], shade));
    }
    for (persistences, colour, name, number) in [(minima, BLUE, "minima", 0), (maxima, RED, "maxima", 1)] {
        let text = match kept {
            Some(kept) => format!("{name}: {} of {} kept", kept[number], persistences.len()),
            None => format!("{name}: {}", persistences.len()),
        };
        let series = chart.draw_series(LineSeries::new(staircase(persistences, least, most), colour.stroke_width(2)))?;
        series.label(text).legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], colour.stroke_width(2)));
    }
    if threshold > 0.0 {
        let ends = [(threshold_place.max(least), 0.8), (threshold_place.max(least), count * 1.6)];
        let series = chart.draw_series(DashedLineSeries::new(ends, 6, 4, INK.stroke_width(1)))?;
        series
            .label(format!("threshold {}", number(threshold)))
            .legend(|(x, y)| PathElement::new([(x, y), (x + 9, y), (x + 15, y), (x + 24, y)], INK.stroke_width(1)));
    }
    legend(&mut chart)
}

fn draw_diagram(
    sheet: &Sheet<'_>,
    minima: &[DiagramPoint],
    maxima: &[DiagramPoint],
    threshold: f64,
    label: &str,
) -> Result<(), Box<dyn std::error::Error>> {
    let place = |value: f64| value.clamp(-DRAWABLE.1, DRAWABLE.1);
    let points = || minima.iter().chain(maxima);
    let ends = points().flat_map(|point| [Some(point.birth), point.death].into_iter().flatten());
    let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    let (low, high) = if low.is_finite() { (low, high) } else { (0.0, 1.0) };
    let (low, high) = (place(low), place(high));
    // Steps of the axes must be told apart in the last digit of the values.
    let finest = (1e-9 * low.abs().max(high.abs())).max(DRAWABLE.0);
    let room = if high > low { (0.04 * (high - low)).max(finest) } else { 0.5 * low.abs().max(1.0) };
    let (least, most) = (low - room, high + room);
    let mut chart = ChartBuilder::on(sheet)
        .margin(18)
        .margin_right(LEGEND_WIDTH)
        .caption("Persistence diagram", font(24))
        .x_label_area_size(52)
        .y_label_area_size(84)
        .build_cartesian_2d(least..most, least..most)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(FAINT)
        .axis_style(INK)
        .label_style(font(15))
        .axis_desc_style(font(17))
        .x_labels(8)
        .y_labels(8)
        .x_desc(described("value of the extremum", label))
        .y_desc("value of its saddle")
        .x_label_formatter(&|value| number(tidy(*value, most - least)))
        .y_label_formatter(&|value| number(tidy(*value, most - least)))
        .draw()?;
    let t = threshold.min(most - least);
    let band = vec![(least, least), (least, least + t), (most - t, most), (most, most), (most, most - t), (least + t, least)];
    chart.draw_series([Polygon::new(band, RGBColor(238, 238, 241).filled())])?;
    chart.draw_series(LineSeries::new([(least, least), (most, most)], INK.stroke_width(1)))?;
    let mut entries = 0;
    // Removed ones first, so that the few kept ones lie on top.
    for kept in [false, true] {
        for (points, colour, name, end) in [(minima, BLUE, "minima", high), (maxima, RED, "maxima", low)] {
            let shown: Vec<&DiagramPoint> = points.iter().filter(|point| point.kept == kept).collect();
            let style = if kept { colour.filled() } else { colour.mix(0.3).filled() };
            let size = if kept { 5 } else { 2 };
            let paired = shown.iter().filter_map(|point| point.death.map(|death| (place(point.birth), place(death))));
            chart.draw_series(paired.map(|place| Circle::new(place, size, style)))?;
            let word = if kept { "kept" } else { "removed" };
            let (mark, text) = beside(sheet, &mut entries);
            sheet.draw(&Circle::new(mark, size, style))?;
            sheet.draw(&Text::new(format!("{name} {word}: {}", shown.len()), text, font(15)))?;
            let unpaired = shown.iter().filter(|point| point.death.is_none()).map(|point| (place(point.birth), end));
            chart.draw_series(unpaired.map(|place| TriangleMarker::new(place, size + 3, style)))?;
        }
    }
    if points().any(|point| point.death.is_none()) {
        let (mark, text) = beside(sheet, &mut entries);
        sheet.draw(&TriangleMarker::new(mark, 6, INK.filled()))?;
        sheet.draw(&Text::new("triangle: never dies", text, font(15)))?;
    }
    Ok(())
}

/// Places of the next mark and text of the legend beside the axes, where no data lies.
fn beside(sheet: &Sheet<'_>, entries: &mut i32) -> ((i32, i32), (i32, i32)) {
    let (width, _) = sheet.dim_in_pixel();
    let (x, y) = (width as i32 - LEGEND_WIDTH as i32 + 12, 64 + 22 * *entries);
    *entries += 1;
    ((x, y), (x + 14, y - 8))
}

/// Zero instead of the rounding that an axis step leaves of it.
fn tidy(value: f64, range: f64) -> f64 {
    if value.abs() < 1e-9 * range { 0.0 } else { value }
}

fn described(what: &str, label: &str) -> String {
    if label.is_empty() { what.to_owned() } else { format!("{what}: {label}") }
}

fn legend<'a, C: CoordTranslate>(
    chart: &mut ChartContext<'a, SVGBackend<'a>, C>,
) -> Result<(), Box<dyn std::error::Error>> {
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.9))
        .border_style(FAINT)
        .label_font(font(15))
        .margin(10)
        .draw()
        .map_err(|error| error.to_string().into())
}
