//! One field on curves: value over place, as a line chart.

use super::canvas::{Align, Canvas, LABEL};
use super::colour::{FAINT_INK, INK, MAXIMUM, MINIMUM};
use super::panel::{Area, draw_mark, mark_radius};
use super::picture::FieldView;
use super::ticks::ticks;
use crate::field::VertexId;
use crate::mesh::SimplicialComplex;

const LEFT_LABELS: i64 = 84;
const BOTTOM_LABELS: i64 = 30;
const GRID: [u8; 3] = [226, 226, 230];
const LINE: [u8; 3] = [60, 72, 88];

/// A place on the horizontal axis for every vertex: the coordinate along an axis-parallel line, else arc length, one
/// component after the other.
pub(super) fn places(complex: &SimplicialComplex) -> Vec<f64> {
    let points = complex.points();
    let varying: Vec<usize> =
        (0..3).filter(|&axis| points.iter().any(|point| point[axis] != points[0][axis])).collect();
    if let [axis] = varying[..] {
        return points.iter().map(|point| point[axis]).collect();
    }
    let mut place = vec![f64::NAN; complex.vertex_count()];
    let mut end = 0.0;
    // Ends of lines first, so that a line is walked from one end to the other; then what is closed.
    let vertices = || (0..complex.vertex_count()).map(VertexId::from);
    let ends = vertices().filter(|&v| complex.neighbours(v).len() == 1);
    for seed in ends.chain(vertices()) {
        if !place[seed.index()].is_nan() {
            continue;
        }
        place[seed.index()] = end;
        let mut stack = vec![seed];
        while let Some(vertex) = stack.pop() {
            for &next in complex.neighbours(vertex) {
                if place[next.index()].is_nan() {
                    place[next.index()] = place[vertex.index()] + distance(complex.point(vertex), complex.point(next));
                    end = f64::max(end, place[next.index()]);
                    stack.push(next);
                }
            }
        }
    }
    place
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

/// Draws the chart into `area`, values from `low` to `high`.
pub(super) fn draw_curve(
    canvas: &mut Canvas,
    area: Area,
    complex: &SimplicialComplex,
    place: &[f64],
    field: &FieldView<'_>,
    (low, high): (f64, f64),
) {
    let chart = Area {
        left: area.left + LEFT_LABELS,
        top: area.top,
        width: area.width - LEFT_LABELS,
        height: area.height - BOTTOM_LABELS,
    };
    let drawn = || complex.simplices().iter().map(|&vertex| place[vertex as usize]);
    let (first, last) = (drawn().fold(f64::INFINITY, f64::min), drawn().fold(f64::NEG_INFINITY, f64::max));
    let across = if last > first { last - first } else { 1.0 };
    // Room for the marks of the lowest and the highest value.
    let padding = 0.04 * if high > low { high - low } else { 1.0 };
    let (low, high) = (low - padding, high + padding);
    let x = |at: f64| chart.left as f64 + (at - first) / across * (chart.width - 12) as f64 + 6.0;
    let y = |value: f64| chart.top as f64 + (high - value) / (high - low) * chart.height as f64;
    for (value, text) in ticks(low, high, 6) {
        let row = y(value).round() as i64;
        canvas.rectangle(chart.left, row, chart.width, 1, GRID);
        canvas.text(chart.left - 8, row - LABEL.height() / 2, Align::Right, LABEL, INK, &text);
    }
    for (at, text) in ticks(first, last, 10) {
        let column = x(at).round() as i64;
        canvas.rectangle(column, chart.top, 1, chart.height, GRID);
        canvas.text(column, chart.top + chart.height + 8, Align::Centre, LABEL, INK, &text);
    }
    canvas.frame(chart.left, chart.top, chart.width, chart.height, FAINT_INK);
    for ends in complex.simplices().chunks_exact(2) {
        let [a, b] = [ends[0] as usize, ends[1] as usize];
        // The edge that closes a loop would run back across the whole chart.
        let straight = (place[a] - place[b]).abs() <= distance(complex.points()[a], complex.points()[b]) * (1.0 + 1e-9);
        if straight {
            let end = |v: usize| [x(place[v]), y(field.values[v])];
            canvas.segment(end(a), end(b), 0.6, LINE);
        }
    }
    let radius = mark_radius(field.minima.len() + field.maxima.len());
    for (vertices, colour) in [(field.minima, MINIMUM), (field.maxima, MAXIMUM)] {
        for vertex in vertices {
            let centre = [x(place[vertex.index()]), y(field.values[vertex.index()])];
            draw_mark(canvas, centre, radius, colour);
        }
    }
}
