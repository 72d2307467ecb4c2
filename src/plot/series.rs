//! A series and its smooth version over place or time, with the kept extrema marked: one drawing, as SVG or as PNG.

use super::canvas::{Align, LABEL};
use super::colour::{MAXIMUM, MINIMUM, Rgb};
use super::dates::date_ticks;
use super::error::PlotError;
use super::frame::Frame;
use super::marks::{self, Mark};
use super::picture::Picture;
use super::ticks::ticks;

const WIDTH: i64 = 1600;
const HEIGHT: i64 = 640;
/// Left, right, top and bottom.
const MARGINS: [i64; 4] = [110, 28, 56, 92];
const DATA: Rgb = [150, 166, 190];
const SMOOTH: Rgb = [20, 24, 34];

/// What the places of a series are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaceKind {
    /// Numbers.
    Numbers,
    /// Days since 1970-01-01, shown as dates.
    Days,
}

/// A series, its smooth version, and what is marked in it.
#[derive(Debug, Clone, Copy)]
pub struct SeriesChart<'a> {
    /// Above the chart.
    pub title: &'a str,
    /// What the places are called.
    pub place: &'a str,
    /// What they are.
    pub kind: PlaceKind,
    /// `n` places, rising strictly.
    pub places: &'a [f64],
    /// `n` values of the data; NaN where one is missing.
    pub data: &'a [f64],
    /// `n` values of the smooth series.
    pub smooth: &'a [f64],
    /// Numbers of its kept minima.
    pub minima: &'a [usize],
    /// Numbers of its kept maxima.
    pub maxima: &'a [usize],
    /// Numbers of the places where it may have a corner.
    pub spikes: &'a [usize],
}

impl SeriesChart<'_> {
    /// The chart as an SVG document.
    ///
    /// # Errors
    /// [`PlotError::Empty`] without two places, [`PlotError::Number`] for values that are not finite.
    ///
    /// # Cost
    /// O(n).
    pub fn svg(&self) -> Result<String, PlotError> {
        Ok(marks::svg((WIDTH, HEIGHT), &self.marks()?))
    }

    /// The chart as a picture of 1600 x 640 pixels.
    ///
    /// # Errors
    /// As [`SeriesChart::svg`].
    ///
    /// # Cost
    /// O(n + pixels).
    pub fn picture(&self) -> Result<Picture, PlotError> {
        Ok(marks::picture((WIDTH, HEIGHT), &self.marks()?))
    }

    fn marks(&self) -> Result<Vec<Mark>, PlotError> {
        let count = self.places.len().min(self.data.len()).min(self.smooth.len());
        if count < 2 {
            return Err(PlotError::Empty);
        }
        let (first, last) = (self.places[0], self.places[count - 1]);
        if let Some(&found) = self.places.iter().chain(self.smooth).find(|value| !value.is_finite()) {
            return Err(PlotError::Number { what: "a place or value of the series", found, expected: "" });
        }
        let values = || self.data.iter().chain(self.smooth).filter(|value| value.is_finite());
        let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)));
        let room = 0.05 * if high > low { high - low } else { 1.0 };
        let (low, high) = (low - room, high + room);
        let frame = Frame::new((WIDTH, HEIGHT), MARGINS);
        let Frame { left, right, top, bottom, .. } = frame;
        let x = |at: f64| left + (at - first) / (last - first) * (right - left);
        let y = |value: f64| top + (high - value) / (high - low) * (bottom - top);
        let across = match self.kind {
            PlaceKind::Numbers => ticks(first, last, 10),
            PlaceKind::Days => date_ticks(first, last, 9),
        };
        let rows = ticks(low, high, 7).into_iter().map(|(value, text)| (y(value), text)).collect();
        let columns = across.into_iter().map(|(at, text)| (x(at), text)).collect();
        let mut marks = frame.marks(self.title, rows, columns);
        let place = |index: usize, values: &[f64]| [x(self.places[index]), y(values[index])];
        let present: Vec<usize> = (0..count).filter(|&index| !self.data[index].is_nan()).collect();
        // A gap in the data is a gap in its line.
        for run in present.chunk_by(|a, b| a + 1 == *b) {
            marks.push(Mark::Line(run.iter().map(|&index| place(index, self.data)).collect(), 0.7, DATA));
        }
        marks.push(Mark::Line((0..count).map(|index| place(index, self.smooth)).collect(), 1.1, SMOOTH));
        let radius = if self.minima.len() + self.maxima.len() > 60 { 3.0 } else { 5.0 };
        for (indices, colour) in [(self.minima, MINIMUM), (self.maxima, MAXIMUM)] {
            let known = indices.iter().filter(|&&index| index < count);
            marks.extend(known.map(|&index| Mark::Disc(place(index, self.smooth), radius, colour)));
        }
        marks.extend(self.spikes.iter().filter(|&&index| index < count).map(|&index| Mark::Star(place(index, self.smooth))));
        self.add_legend(&mut marks, &frame);
        Ok(marks)
    }

    fn add_legend(&self, marks: &mut Vec<Mark>, frame: &Frame) {
        let row = frame.bottom + 62.0;
        let mut left = frame.left;
        let mut say = |marks: &mut Vec<Mark>, sign: Option<Mark>, text: String| {
            if let Some(sign) = sign {
                marks.push(sign);
                left += 24.0;
            }
            let width = LABEL.width(&text) as f64;
            marks.push(Mark::Text([left, row], Align::Left, false, text));
            left += width + 30.0;
        };
        let dash = |left: f64, radius: f64, colour: Rgb| Mark::Line(vec![[left, row], [left + 16.0, row]], radius, colour);
        let at = frame.left;
        let column = |texts: &[&str]| texts.iter().fold(at, |left, text| left + 24.0 + LABEL.width(text) as f64 + 30.0);
        let (minima, maxima) = (format!("{} minima", self.minima.len()), format!("{} maxima", self.maxima.len()));
        let words = ["data", "smooth", &minima, &maxima];
        say(marks, Some(dash(at, 0.9, DATA)), words[0].to_owned());
        say(marks, Some(dash(column(&words[..1]), 1.3, SMOOTH)), words[1].to_owned());
        say(marks, Some(Mark::Disc([column(&words[..2]) + 8.0, row], 5.0, MINIMUM)), words[2].to_owned());
        say(marks, Some(Mark::Disc([column(&words[..3]) + 8.0, row], 5.0, MAXIMUM)), words[3].to_owned());
        if !self.spikes.is_empty() {
            let text = format!("{} kept as a spike", self.spikes.len());
            say(marks, Some(Mark::Star([column(&words) + 8.0, row])), text);
        }
        marks.push(Mark::Text([frame.right, row], Align::Right, false, self.place.to_owned()));
    }
}
