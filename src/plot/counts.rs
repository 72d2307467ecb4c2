//! How many extrema a field has, before and after, over the steps of a series: one drawing, as SVG or as PNG.

use super::canvas::{Align, LABEL};
use super::colour::{MAXIMUM, MINIMUM, Rgb, mix};
use super::error::PlotError;
use super::frame::Frame;
use super::marks::{self, Mark};
use super::picture::Picture;
use super::ticks::ticks;

const WIDTH: i64 = 1400;
const HEIGHT: i64 = 640;
/// Left, right, top and bottom.
const MARGINS: [i64; 4] = [96, 36, 56, 104];
/// Above this ratio of the largest to the smallest count the axis is logarithmic.
const WIDE: f64 = 20.0;

/// Numbers of extrema at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepCounts {
    /// The time.
    pub time: f64,
    /// Minima and maxima of the data.
    pub before: [usize; 2],
    /// Minima and maxima of the result.
    pub after: [usize; 2],
}

/// Numbers of minima and maxima over time.
#[derive(Debug, Clone, Copy)]
pub struct CountsChart<'a> {
    /// Above the chart.
    pub title: &'a str,
    /// What the times are called.
    pub place: &'a str,
    /// By rising time. What is missing is a gap without a mark.
    pub steps: &'a [StepCounts],
}

impl CountsChart<'_> {
    /// The chart as an SVG document.
    ///
    /// # Errors
    /// [`PlotError::Empty`] without a step, [`PlotError::Number`] for a time that is not finite.
    ///
    /// # Cost
    /// O(n).
    pub fn svg(&self) -> Result<String, PlotError> {
        Ok(marks::svg((WIDTH, HEIGHT), &self.marks()?))
    }

    /// The chart as a picture of 1400 x 640 pixels.
    ///
    /// # Errors
    /// As [`CountsChart::svg`].
    ///
    /// # Cost
    /// O(n + pixels).
    pub fn picture(&self) -> Result<Picture, PlotError> {
        Ok(marks::picture((WIDTH, HEIGHT), &self.marks()?))
    }

    fn marks(&self) -> Result<Vec<Mark>, PlotError> {
        let (Some(first), Some(last)) = (self.steps.first(), self.steps.last()) else { return Err(PlotError::Empty) };
        if let Some(step) = self.steps.iter().find(|step| !step.time.is_finite()) {
            return Err(PlotError::Number { what: "the time of a step", found: step.time, expected: "" });
        }
        let (first, last) = if last.time > first.time { (first.time, last.time) } else { (first.time - 0.5, first.time + 0.5) };
        let counts = || self.steps.iter().flat_map(|step| step.before.into_iter().chain(step.after)).map(|count| count as f64);
        let (least, most) = (counts().fold(f64::INFINITY, f64::min), counts().fold(1.0, f64::max));
        // Of nothing there is no logarithm.
        let is_logarithmic = least >= 1.0 && most > WIDE * least;
        let scaled = |count: f64| if is_logarithmic { count.log10() } else { count };
        let (low, high) = if is_logarithmic { (scaled(least) - 0.1, scaled(most) + 0.1) } else { (0.0, 1.06 * most) };
        let frame = Frame::new((WIDTH, HEIGHT), MARGINS);
        let Frame { left, right, top, bottom, .. } = frame;
        let x = |time: f64| left + (time - first) / (last - first) * (right - left);
        let y = |count: f64| top + (high - scaled(count)) / (high - low) * (bottom - top);

        let rows = if is_logarithmic { decades(low, high) } else { whole(high) };
        let rows = rows.into_iter().map(|(count, text)| (y(count), text)).collect();
        let columns = ticks(first, last, 10).into_iter().map(|(time, text)| (x(time), text)).collect();
        let mut marks = frame.marks(self.title, rows, columns);
        marks.push(Mark::Text([(left + right) / 2.0, bottom + 42.0], Align::Centre, false, self.place.to_owned()));

        let curves = [
            ("minima before", pale(MINIMUM), 0, true),
            ("maxima before", pale(MAXIMUM), 1, true),
            ("minima after", MINIMUM, 0, false),
            ("maxima after", MAXIMUM, 1, false),
        ];
        let radius = if self.steps.len() > 150 { 2.0 } else { 4.0 };
        let (mut across, row) = (left, bottom + 76.0);
        for (name, colour, kind, is_before) in curves {
            let at = |step: &StepCounts| [x(step.time), y(if is_before { step.before[kind] } else { step.after[kind] } as f64)];
            let points: Vec<[f64; 2]> = self.steps.iter().map(at).collect();
            marks.push(Mark::Line(points.clone(), 1.0, colour));
            marks.extend(points.into_iter().map(|point| Mark::Disc(point, radius, colour)));
            marks.push(Mark::Line(vec![[across, row], [across + 22.0, row]], 1.0, colour));
            marks.push(Mark::Disc([across + 11.0, row], 4.0, colour));
            marks.push(Mark::Text([across + 30.0, row], Align::Left, false, name.to_owned()));
            across += 30.0 + LABEL.width(name) as f64 + 34.0;
        }
        Ok(marks)
    }
}

fn pale(colour: Rgb) -> Rgb {
    mix(colour, [255; 3], 0.6)
}

/// 1, 2 and 5 times the powers of ten between two logarithms.
fn decades(low: f64, high: f64) -> Vec<(f64, String)> {
    let powers = (low.floor() as i32)..=(high.ceil() as i32);
    let counts = powers.flat_map(|power| [1.0, 2.0, 5.0].map(|lead| lead * 10f64.powi(power)));
    counts.filter(|count| (low..=high).contains(&count.log10()) && *count >= 1.0).map(|count| (count, format!("{count}"))).collect()
}

/// Whole numbers up to a count.
fn whole(high: f64) -> Vec<(f64, String)> {
    ticks(0.0, high, 7).into_iter().filter(|(count, _)| count.fract() == 0.0).map(|(count, _)| (count, format!("{count}"))).collect()
}
