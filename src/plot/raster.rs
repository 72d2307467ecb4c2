//! Triangles to samples: value, depth and light at every sample of a rectangle, the nearest triangle in front.

use super::camera::{View, cross, dot};
use crate::mesh::SimplicialComplex;
use rayon::prelude::*;

/// Direction to the light: from the upper left, before the sheet.
const LIGHT: [f64; 3] = [-0.35, 0.45, 0.82];
/// Light that falls on everything.
const AMBIENT: f64 = 0.6;

/// A rectangle of samples, row by row from the upper left corner.
pub(super) struct Samples {
    pub(super) width: usize,
    pub(super) height: usize,
    /// NaN where there is no triangle.
    pub(super) value: Vec<f64>,
    /// Towards the eye, in samples.
    pub(super) depth: Vec<f32>,
    /// Part of the light that comes back, 0 to 1.
    pub(super) light: Vec<f32>,
}

/// From the view's units to samples.
#[derive(Clone, Copy)]
pub(super) struct Fit {
    pub(super) scale: f64,
    pub(super) left: f64,
    pub(super) top: f64,
}

impl Fit {
    /// Sample coordinates (right, down, towards the eye) of a position of the view.
    pub(super) fn place(self, position: [f64; 3]) -> [f64; 3] {
        [
            (position[0] - self.left) * self.scale,
            (self.top - position[1]) * self.scale,
            position[2] * self.scale,
        ]
    }
}

/// The triangles that can be seen: all of a surface, those of one tetrahedron only for a solid.
pub(super) fn visible_triangles(complex: &SimplicialComplex) -> Vec<[u32; 3]> {
    match complex.dimension() {
        2 => complex.simplices().chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]]).collect(),
        3 => {
            let mut faces: Vec<[u32; 3]> = Vec::with_capacity(4 * complex.simplex_count());
            for corners in complex.simplices().chunks_exact(4) {
                for omitted in 0..4 {
                    let mut face = [0; 3];
                    let kept = (0..4).filter(|&corner| corner != omitted);
                    for (slot, corner) in face.iter_mut().zip(kept) {
                        *slot = corners[corner];
                    }
                    face.sort_unstable();
                    faces.push(face);
                }
            }
            faces.sort_unstable();
            faces.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).map(|same| same[0]).collect()
        }
        _ => Vec::new(),
    }
}

/// Rows that one task fills. Every task takes the triangles in the same order, so the samples do not depend on threads.
pub(super) const STRIP: usize = 48;

/// Draws triangles into a `width x height` rectangle of samples.
pub(super) fn rasterise(
    triangles: &[[u32; 3]],
    view: &View,
    values: &[f64],
    fit: Fit,
    (width, height): (usize, usize),
) -> Samples {
    let light = vertex_light(triangles, view);
    let count = width * height;
    let mut samples = Samples {
        width,
        height,
        value: vec![f64::NAN; count],
        depth: vec![f32::NEG_INFINITY; count],
        light: vec![1.0; count],
    };
    let places: Vec<[f64; 3]> = view.positions.iter().map(|&position| fit.place(position)).collect();
    let members = strips(triangles, &places, height);
    let strip = STRIP * width;
    let rows = samples.value.par_chunks_mut(strip).zip(samples.depth.par_chunks_mut(strip));
    rows.zip(samples.light.par_chunks_mut(strip)).enumerate().for_each(|(at, ((value, depth), lit))| {
        let mut strip = Strip { width, first: at * STRIP, value, depth, light: lit };
        for &triangle in &members[at] {
            let corners = triangles[triangle as usize].map(|v| v as usize);
            strip.add(corners.map(|v| places[v]), corners.map(|v| values[v]), corners.map(|v| light[v]));
        }
    });
    samples
}

/// The triangles that reach into each strip, in their order.
pub(super) fn strips(triangles: &[[u32; 3]], places: &[[f64; 3]], height: usize) -> Vec<Vec<u32>> {
    let mut members = vec![Vec::new(); height.div_ceil(STRIP)];
    for (corners, triangle) in triangles.iter().zip(0..) {
        let down = corners.map(|v| places[v as usize][1]);
        let low = down[0].min(down[1]).min(down[2]) - 0.5;
        let high = down[0].max(down[1]).max(down[2]) + 0.5;
        // Conversion to an integer is saturating: what lies above the rectangle starts in its first strip.
        for strip in low as usize / STRIP..=(high as usize / STRIP).min(members.len() - 1) {
            members[strip].push(triangle);
        }
    }
    members
}

/// Some rows of the samples.
struct Strip<'a> {
    width: usize,
    /// The uppermost row.
    first: usize,
    value: &'a mut [f64],
    depth: &'a mut [f32],
    light: &'a mut [f32],
}

impl Strip<'_> {
    fn add(&mut self, [a, b, c]: [[f64; 3]; 3], values: [f64; 3], light: [f64; 3]) {
        let height = self.value.len() / self.width;
        let bounds = |axis: usize, first: usize, length: usize| {
            let low = a[axis].min(b[axis]).min(c[axis]) - 0.5 - first as f64;
            let high = a[axis].max(b[axis]).max(c[axis]) + 0.5 - first as f64;
            // Conversion to an integer is saturating: what lies before the first row starts at it.
            (low.floor() as usize, (high.ceil() as usize).min(length))
        };
        let (top, bottom) = bounds(1, self.first, height);
        if top >= bottom {
            return;
        }
        let (left, right) = bounds(0, 0, self.width);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        // Zero: seen from the edge, no sample of its own.
        if area == 0.0 || area.is_nan() {
            return;
        }
        let inverse = 1.0 / area;
        for y in top..bottom {
            let down = (y + self.first) as f64 + 0.5 - a[1];
            for x in left..right {
                let across = x as f64 + 0.5 - a[0];
                let wb = (across * (c[1] - a[1]) - down * (c[0] - a[0])) * inverse;
                let wc = ((b[0] - a[0]) * down - (b[1] - a[1]) * across) * inverse;
                let wa = 1.0 - wb - wc;
                // A little overlap, or rounding would leave pinholes along shared edges.
                if wa < -1e-9 || wb < -1e-9 || wc < -1e-9 {
                    continue;
                }
                let blend = |of: [f64; 3]| wa * of[0] + wb * of[1] + wc * of[2];
                let depth = blend([a[2], b[2], c[2]]) as f32;
                let sample = y * self.width + x;
                if depth > self.depth[sample] {
                    self.depth[sample] = depth;
                    self.value[sample] = blend(values);
                    self.light[sample] = blend(light) as f32;
                }
            }
        }
    }
}

/// Light at the vertices from the mean normal of their triangles, each turned to the eye.
fn vertex_light(triangles: &[[u32; 3]], view: &View) -> Vec<f64> {
    if view.planar {
        return vec![1.0; view.positions.len()];
    }
    let mut normals = vec![[0.0; 3]; view.positions.len()];
    for corners in triangles {
        let [a, b, c] = corners.map(|v| view.positions[v as usize]);
        let side = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
        let normal = cross(side(b), side(c));
        let sign = if normal[2] < 0.0 { -1.0 } else { 1.0 };
        for &vertex in corners {
            for axis in 0..3 {
                normals[vertex as usize][axis] += sign * normal[axis];
            }
        }
    }
    let bright = dot(LIGHT, LIGHT).sqrt();
    normals
        .into_iter()
        .map(|normal| {
            let length = dot(normal, normal).sqrt();
            let facing = if length > 0.0 { dot(normal, LIGHT) / (length * bright) } else { 1.0 };
            AMBIENT + (1.0 - AMBIENT) * facing.max(0.0)
        })
        .collect()
}
