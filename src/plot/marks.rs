//! Charts as lists of lines, discs and words, which become SVG or pixels alike.

use std::fmt::Write;

use super::canvas::{Align, Canvas, LABEL, TITLE};
use super::colour::{INK, Rgb};
use super::panel::draw_mark;
use super::picture::Picture;

const SPIKE: Rgb = [232, 150, 20];

/// A part of the drawing, in pixels from the upper left corner.
pub(super) enum Mark {
    Line(Vec<[f64; 2]>, f64, Rgb),
    Disc([f64; 2], f64, Rgb),
    Star([f64; 2]),
    Text([f64; 2], Align, bool, String),
}

/// A drawing as an SVG document.
pub(super) fn svg((width, height): (i64, i64), marks: &[Mark]) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    for mark in marks {
        // Writing to a String cannot fail.
        let _ = mark.write_svg(&mut svg);
    }
    svg.push_str("</svg>\n");
    svg
}

/// A drawing as pixels.
pub(super) fn picture((width, height): (i64, i64), marks: &[Mark]) -> Picture {
    let mut canvas = Canvas::new(width as u32, height as u32);
    marks.iter().for_each(|mark| mark.draw(&mut canvas));
    Picture::of_pixels(width as u32, height as u32, canvas.into_pixels())
}

/// Corners of a star with five rays.
fn star([x, y]: [f64; 2]) -> Vec<[f64; 2]> {
    (0..=10)
        .map(|corner| {
            let (angle, radius) = (std::f64::consts::PI * f64::from(corner) / 5.0, if corner % 2 == 0 { 11.0 } else { 4.6 });
            [x + radius * angle.sin(), y - radius * angle.cos()]
        })
        .collect()
}

impl Mark {
    fn draw(&self, canvas: &mut Canvas) {
        match self {
            Self::Line(points, radius, colour) => {
                points.windows(2).for_each(|ends| canvas.segment(ends[0], ends[1], *radius, *colour));
            }
            Self::Disc(centre, radius, colour) => draw_mark(canvas, *centre, *radius, *colour),
            Self::Star(centre) => {
                let corners = star(*centre);
                corners.windows(2).for_each(|ends| canvas.segment(ends[0], ends[1], 1.0, SPIKE));
                corners.windows(2).for_each(|ends| canvas.segment(*centre, ends[0], 1.6, SPIKE));
            }
            Self::Text([x, y], align, is_title, text) => {
                let font = if *is_title { TITLE } else { LABEL };
                canvas.text(x.round() as i64, y.round() as i64 - font.height() / 2, *align, font, INK, text);
            }
        }
    }

    fn write_svg(&self, svg: &mut String) -> std::fmt::Result {
        let hex = |[r, g, b]: Rgb| format!("#{r:02x}{g:02x}{b:02x}");
        let path = |points: &[[f64; 2]]| points.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect::<Vec<_>>().join(" ");
        match self {
            Self::Line(points, radius, colour) => writeln!(
                svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:.1}\" stroke-linejoin=\"round\"/>",
                path(points),
                hex(*colour),
                2.0 * radius
            ),
            Self::Disc([x, y], radius, colour) => writeln!(
                svg,
                "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius}\" fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1\"/>",
                hex(*colour)
            ),
            Self::Star(centre) => {
                writeln!(svg, "<polygon points=\"{}\" fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1\"/>", path(&star(*centre)), hex(SPIKE))
            }
            Self::Text([x, y], align, is_title, text) => {
                let anchor = match align {
                    Align::Left => "start",
                    Align::Centre => "middle",
                    Align::Right => "end",
                };
                let (size, weight) = if *is_title { (20, "bold") } else { (15, "normal") };
                let escaped = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
                writeln!(
                    svg,
                    "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\" font-family=\"sans-serif\" font-size=\"{size}\" \
                     font-weight=\"{weight}\" fill=\"{}\">{escaped}</text>",
                    y + 5.0,
                    hex(INK)
                )
            }
        }
    }
}
