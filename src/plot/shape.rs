//! Shapes before and after a deformation, side by side: a checkerboard carried along, coloured by how much elements grew.

use super::camera::{dot, frame};
use super::canvas::{Align, Canvas, LABEL, TITLE};
use super::colour::{ColourMap, FAINT_INK, INK, MAXIMUM, Rgb, WHITE, mix};
use super::cover::{UNCOVERED, cover};
use super::error::PlotError;
use super::panel::draw_mark;
use super::picture::{Picture, picture};
use super::raster::visible_triangles;
use crate::field::FieldError;
use crate::mesh::SimplicialComplex;

const MARGIN: i64 = 20;
const TITLE_HEIGHT: i64 = 36;
const LEGEND_HEIGHT: i64 = 44;
/// Samples a pixel along each axis.
const SAMPLES: usize = 2;
/// Squares of the checkerboard along the longer side.
const SQUARES: f64 = 20.0;
/// Growth at which the colours end, as a power of two.
const MOST: f64 = 2.0;
/// Inverted elements.
const INVERTED: Rgb = [226, 26, 28];
const SKIN: Rgb = [226, 222, 214];

/// A shape to show.
#[derive(Debug, Clone, Copy)]
pub struct ShapeView<'a> {
    /// What stands above it; cut where it does not fit.
    pub title: &'a str,
    /// A position for every vertex.
    pub points: &'a [[f64; 3]],
    /// `det F` of every element, or nothing: then elements have one colour. Those not above zero are red and before all others.
    pub determinants: Option<&'a [f64]>,
    /// Places that are marked, such as handles.
    pub marks: &'a [[f64; 3]],
}

/// Shapes of one mesh side by side, on one scale.
///
/// Planar meshes are shown in their plane, solids by their hull from one side, lit.
///
/// # Arguments
/// * `rest`: `n` vertices; triangles or tetrahedra. Its positions carry the checkerboard.
/// * `width`: pixels, 240 to 8192.
///
/// # Errors
/// [`PlotError::Field`] for positions or determinants that are missing or not finite, [`PlotError::Empty`], [`PlotError::Width`].
///
/// # Cost
/// O(m + pixels) a shape.
pub fn shape_picture(rest: &SimplicialComplex, shapes: &[ShapeView<'_>], width: u32) -> Result<Picture, PlotError> {
    check(rest, shapes, width)?;
    let (axes, _) = frame(rest.points());
    let seen = |points: &[[f64; 3]]| -> Vec<[f64; 3]> { points.iter().map(|&p| axes.map(|axis| dot(axis, p))).collect() };
    let places: Vec<Vec<[f64; 3]>> = shapes.iter().map(|shape| seen(shape.points)).collect();
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for place in places.iter().flatten() {
        for axis in 0..2 {
            low[axis] = low[axis].min(place[axis]);
            high[axis] = high[axis].max(place[axis]);
        }
    }
    let count = shapes.len() as i64;
    let panel = (i64::from(width) - (count + 1) * MARGIN) / count;
    let extent = [0, 1].map(|axis| (high[axis] - low[axis]).max(f64::MIN_POSITIVE));
    let height = ((panel as f64 * extent[1] / extent[0]).round() as i64).clamp(panel / 3, panel * 3 / 2);
    let scale = (panel as f64 / extent[0]).min(height as f64 / extent[1]) * 0.98;
    let total = MARGIN + TITLE_HEIGHT + height + LEGEND_HEIGHT;
    let mut canvas = Canvas::new(width, total as u32);
    let board = Board::of(&seen(rest.points()), rest.dimension());
    for (at, (shape, places)) in shapes.iter().zip(&places).enumerate() {
        let left = MARGIN + at as i64 * (panel + MARGIN);
        canvas.text(left, MARGIN, Align::Left, TITLE, INK, &TITLE.fitted(shape.title, panel));
        let centre = [0, 1].map(|axis| 0.5 * (low[axis] + high[axis]));
        let to_pixels = |p: [f64; 3]| {
            [(p[0] - centre[0]) * scale + 0.5 * panel as f64, 0.5 * height as f64 - (p[1] - centre[1]) * scale, p[2] * scale]
        };
        let fine: Vec<[f64; 3]> = places.iter().map(|&p| to_pixels(p).map(|part| part * SAMPLES as f64)).collect();
        let corner = (left, MARGIN + TITLE_HEIGHT);
        draw(&mut canvas, corner, (panel as usize, height as usize), (rest, shape, &fine), &board);
        let radius = (f64::from(width) / 320.0).clamp(2.0, 6.0);
        for mark in seen(shape.marks) {
            let place = to_pixels(mark);
            draw_mark(&mut canvas, [left as f64 + place[0], corner.1 as f64 + place[1]], radius, MAXIMUM);
        }
    }
    legend(&mut canvas, total - LEGEND_HEIGHT + 14);
    Ok(picture(canvas, width, total))
}

fn check(rest: &SimplicialComplex, shapes: &[ShapeView<'_>], width: u32) -> Result<(), PlotError> {
    const LEAST_WIDTH: u32 = 240;
    const MOST_WIDTH: u32 = 8192;
    if !(LEAST_WIDTH..=MOST_WIDTH).contains(&width) {
        return Err(PlotError::Width { found: width, least: LEAST_WIDTH, most: MOST_WIDTH });
    }
    if rest.simplex_count() == 0 || shapes.is_empty() {
        return Err(PlotError::Empty);
    }
    let length = |expected: usize, found: usize| {
        if expected == found { Ok(()) } else { Err(FieldError::LengthMismatch { expected, found }) }
    };
    for shape in shapes {
        length(rest.vertex_count(), shape.points.len())?;
        crate::field::check_finite(shape.points.as_flattened())?;
        if let Some(determinants) = shape.determinants {
            length(rest.simplex_count(), determinants.len())?;
        }
    }
    Ok(())
}

/// The checkerboard of the rest shape.
struct Board {
    places: Vec<[f64; 3]>,
    low: [f64; 3],
    square: f64,
    axes: usize,
}

impl Board {
    fn of(places: &[[f64; 3]], dimension: usize) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for place in places {
            for axis in 0..3 {
                low[axis] = low[axis].min(place[axis]);
                high[axis] = high[axis].max(place[axis]);
            }
        }
        let longest = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
        Self { places: places.to_vec(), low, square: longest / SQUARES, axes: dimension.min(3) }
    }

    fn is_dark(&self, corners: [u32; 3], weights: [f64; 3]) -> bool {
        let sum: i64 = (0..self.axes)
            .map(|axis| {
                let place: f64 = corners.iter().zip(weights).map(|(&v, w)| w * self.places[v as usize][axis]).sum();
                // Off the grid lines, on which whole sides may lie.
                ((place - self.low[axis]) / self.square + 1e-6).floor() as i64
            })
            .sum();
        sum.rem_euclid(2) == 1
    }
}

fn draw(
    canvas: &mut Canvas,
    (left, top): (i64, i64),
    (width, height): (usize, usize),
    (rest, shape, fine): (&SimplicialComplex, &ShapeView<'_>, &[[f64; 3]]),
    board: &Board,
) {
    let (triangles, owners) = seen_triangles(rest, shape.determinants);
    let found = cover(&triangles, fine, (width * SAMPLES, height * SAMPLES));
    let colours: Vec<Rgb> = triangles.iter().zip(&owners).map(|(corners, &owner)| {
        let growth = shape.determinants.map(|determinants| determinants[owner as usize]);
        let light = if rest.dimension() == 2 { 1.0 } else { lit(corners.map(|v| fine[v as usize])) };
        growth.map_or(SKIN, colour_of).map(|part| (f64::from(part) * light) as u8)
    }).collect();
    let share = 1.0 / (SAMPLES * SAMPLES) as f64;
    for y in 0..height {
        for x in 0..width {
            let mut sum = [0.0; 3];
            let mut covered = 0.0;
            for inner in 0..SAMPLES * SAMPLES {
                let at = (y * SAMPLES + inner / SAMPLES) * width * SAMPLES + x * SAMPLES + inner % SAMPLES;
                let triangle = found.triangle[at];
                if triangle != UNCOVERED {
                    let [wb, wc] = found.weights[at];
                    let is_dark = board.is_dark(triangles[triangle as usize], [1.0 - wb - wc, wb, wc]);
                    let shade = if is_dark { 0.82 } else { 1.0 };
                    (0..3).for_each(|c| sum[c] += shade * f64::from(colours[triangle as usize][c]));
                    covered += 1.0;
                }
            }
            if covered > 0.0 {
                let colour = sum.map(|part| (part / covered).round() as u8);
                canvas.blend(left + x as i64, top + y as i64, mix(WHITE, colour, 1.0), covered * share);
            }
        }
    }
}

/// Triangles with the element that each belongs to, inverted ones first.
fn seen_triangles(rest: &SimplicialComplex, determinants: Option<&[f64]>) -> (Vec<[u32; 3]>, Vec<u32>) {
    let triangles = visible_triangles(rest);
    let mut owned: Vec<([u32; 3], u32)> = if rest.dimension() == 2 {
        triangles.into_iter().zip(0..).collect()
    } else {
        // A face of the hull belongs to the one tetrahedron around its three corners.
        let around = |face: [u32; 3]| {
            let star = rest.star(crate::field::VertexId(face[0]));
            let holds = |&&simplex: &&u32| face.iter().all(|vertex| rest.simplex(simplex as usize).contains(vertex));
            star.iter().find(holds).copied().unwrap_or(0)
        };
        triangles.into_iter().map(|face| (face, around(face))).collect()
    };
    if let Some(determinants) = determinants {
        owned.sort_by_key(|&(_, owner)| determinants[owner as usize] > 0.0);
    }
    owned.into_iter().unzip()
}

/// Light of a triangle whose side to the eye does not matter.
fn lit([a, b, c]: [[f64; 3]; 3]) -> f64 {
    let side = |p: [f64; 3]| [p[0] - a[0], a[1] - p[1], p[2] - a[2]];
    let normal = super::camera::cross(side(b), side(c));
    let length = dot(normal, normal).sqrt();
    let light = [-0.33, 0.42, 0.84];
    if length > 0.0 { 0.5 + 0.5 * (dot(normal, light) * normal[2].signum() / length).max(0.0) } else { 1.0 }
}

/// Brown where elements grew, teal where they shrank, red where they are inverted.
fn colour_of(determinant: f64) -> Rgb {
    if determinant.is_nan() || determinant <= 0.0 {
        return INVERTED;
    }
    ColourMap::Diverging.colour(0.5 + 0.5 * (determinant.log2() / MOST).clamp(-1.0, 1.0))
}

fn legend(canvas: &mut Canvas, top: i64) {
    let mut left = MARGIN;
    canvas.text(left, top, Align::Left, LABEL, INK, "det F");
    left += LABEL.width("det F") + 12;
    for (power, text) in [(-2.0, "1/4"), (-1.0, "1/2"), (0.0, "1"), (1.0, "2"), (2.0, "4")] {
        canvas.rectangle(left, top, 16, LABEL.height(), colour_of(f64::powf(2.0, power)));
        canvas.frame(left, top, 16, LABEL.height(), FAINT_INK);
        canvas.text(left + 21, top, Align::Left, LABEL, INK, text);
        left += 21 + LABEL.width(text) + 12;
    }
    canvas.rectangle(left, top, 16, LABEL.height(), INVERTED);
    canvas.text(left + 21, top, Align::Left, LABEL, INK, "inverted");
}
