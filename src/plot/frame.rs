//! The frame of a chart: title, grid lines with their labels, and the box around the curves.

use super::canvas::Align;
use super::colour::{FAINT_INK, Rgb};
use super::marks::Mark;

const GRID: Rgb = [228, 228, 232];

/// Where the curves of a chart lie, in pixels from the upper left corner.
pub(super) struct Frame {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
    width: f64,
}

impl Frame {
    /// # Arguments
    /// * `size`: width and height of the drawing; `margins`: left, right, top and bottom.
    pub fn new((width, height): (i64, i64), [left, right, top, bottom]: [i64; 4]) -> Self {
        let (width, height) = (width as f64, height as f64);
        Self { left: left as f64, right: width - right as f64, top: top as f64, bottom: height - bottom as f64, width }
    }

    /// What lies below the curves.
    ///
    /// # Arguments
    /// * `rows`, `columns`: heights and places across of the grid lines, with their labels.
    pub fn marks(&self, title: &str, rows: Vec<(f64, String)>, columns: Vec<(f64, String)>) -> Vec<Mark> {
        let Self { left, right, top, bottom, width } = *self;
        let mut marks = vec![Mark::Text([width / 2.0, 28.0], Align::Centre, true, title.to_owned())];
        for (y, text) in rows {
            marks.push(Mark::Line(vec![[left, y], [right, y]], 0.5, GRID));
            marks.push(Mark::Text([left - 10.0, y], Align::Right, false, text));
        }
        for (x, text) in columns {
            marks.push(Mark::Line(vec![[x, top], [x, bottom]], 0.5, GRID));
            marks.push(Mark::Text([x, bottom + 18.0], Align::Centre, false, text));
        }
        marks.push(Mark::Line(vec![[left, top], [right, top], [right, bottom], [left, bottom], [left, top]], 0.5, FAINT_INK));
        marks
    }
}
