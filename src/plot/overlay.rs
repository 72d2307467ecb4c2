//! The Morse–Smale complex over a field: separatrices and saddles.

use super::canvas::Canvas;
use super::colour::{MAXIMUM, MINIMUM, Rgb, WHITE, mix};
use super::error::PlotError;
use super::panel::{Spot, draw_mark};
use super::picture::{FieldView, Picture, PictureOptions, compose_with};
use crate::mesh::{Cell, Corners, SimplicialComplex, Triangulation};
use crate::morse::{LineKind, MorseSmaleComplex};

pub(super) const SADDLE: Rgb = [250, 176, 36];

/// What is drawn over a field.
pub(super) struct Overlay<'a> {
    smale: &'a MorseSmaleComplex,
    dimension: u8,
    corners: &'a dyn Fn(Cell) -> Corners,
}

impl Overlay<'_> {
    /// Draws lines, then saddles; `spot` tells where a mean of vertices lies on the sheet, and whether it is in sight.
    ///
    /// # Arguments
    /// * `radius`: that of the marks of extrema, in pixels.
    pub(super) fn draw(&self, canvas: &mut Canvas, spot: &dyn Fn(&[u32]) -> Spot, radius: f64) {
        let place = |cell: Cell| {
            let corners = (self.corners)(cell);
            let numbers = [0, 1, 2, 3].map(|corner| corners.get(corner).map_or(0, |vertex| vertex.0));
            spot(&numbers[..corners.len()])
        };
        // Many lines are drawn thin, so that the field shows through.
        let width = (24.0 / (self.smale.lines.len().max(1) as f64).sqrt()).clamp(0.35, 1.1);
        for line in &self.smale.lines {
            let colour = match line.kind {
                LineKind::Descending => mix(MINIMUM, WHITE, 0.4),
                LineKind::Ascending => mix(MAXIMUM, WHITE, 0.3),
                LineKind::Connector => SADDLE,
            };
            let spots: Vec<Spot> = line.cells.iter().map(|&cell| place(cell)).collect();
            for step in spots.windows(2).filter(|step| !step[0].is_hidden && !step[1].is_hidden) {
                canvas.segment(step[0].at, step[1].at, width, colour);
            }
        }
        for point in self.smale.points.iter().filter(|point| (1..self.dimension).contains(&point.cell.dimension)) {
            let spot = place(point.cell);
            if !spot.is_hidden {
                draw_mark(canvas, spot.at, 0.7 * radius, SADDLE);
            }
        }
    }
}

/// A picture of a field with the critical points and 1-separatrices of its Morse–Smale complex.
///
/// As [`field_picture`](super::field_picture), with the lines over the colours: blue down to minima, red up to maxima, amber
/// between saddles, which are amber discs. On curves only the extrema are marked.
///
/// # Arguments
/// * `complex`: `n` vertices, dimension 1, 2 or 3: what is coloured.
/// * `cells`: the same vertices with the cells that `smale` names; `complex` itself, or a grid that it is made of.
/// * `smale`: a Morse–Smale complex; its extrema are marked, whatever `field` lists.
/// * `field`: `n` values and a title.
/// * `options`: width, label, colours.
///
/// # Errors
/// As [`field_picture`](super::field_picture).
///
/// # Cost
/// O(n + pixels), and the pixels that lines cover.
pub fn complex_picture<T: Triangulation>(
    complex: &SimplicialComplex,
    cells: &T,
    smale: &MorseSmaleComplex,
    field: &FieldView<'_>,
    options: &PictureOptions,
) -> Result<Picture, PlotError> {
    let marked = FieldView { minima: smale.minima.extrema(), maxima: smale.maxima.extrema(), ..*field };
    let corners = |cell: Cell| cells.cell_vertices(cell);
    let overlay = Overlay { smale, dimension: complex.dimension() as u8, corners: &corners };
    compose_with(complex, &[&marked], options, Some(&overlay))
}
