//! Which triangle covers each sample of a rectangle, and where in it.

use super::raster::{STRIP, strips};
use rayon::prelude::*;

/// Stands for a sample without a triangle.
pub(super) const UNCOVERED: u32 = u32::MAX;

/// The triangle of every sample, row by row from the upper left corner.
pub(super) struct Cover {
    /// Place in the list of triangles, or [`UNCOVERED`].
    pub triangle: Vec<u32>,
    /// Barycentric coordinates of the second and third corner.
    pub weights: Vec<[f64; 2]>,
}

/// Finds the nearest triangle of every sample; of equally near ones the first in the list.
///
/// # Arguments
/// * `places`: right, down and towards the eye in samples, one a vertex.
pub(super) fn cover(triangles: &[[u32; 3]], places: &[[f64; 3]], (width, height): (usize, usize)) -> Cover {
    let count = width * height;
    let mut found = Cover { triangle: vec![UNCOVERED; count], weights: vec![[0.0; 2]; count] };
    let members = strips(triangles, places, height);
    let strip = STRIP * width;
    let rows = found.triangle.par_chunks_mut(strip).zip(found.weights.par_chunks_mut(strip)).enumerate();
    rows.for_each(|(at, (triangle, weights))| {
        let mut depth = vec![f64::NEG_INFINITY; triangle.len()];
        let first = at * STRIP;
        for &member in &members[at] {
            let corners = triangles[member as usize].map(|vertex| places[vertex as usize]);
            each_inside(corners, (width, first, triangle.len() / width), |sample, [wb, wc]| {
                let [a, b, c] = corners.map(|corner| corner[2]);
                let here = (1.0 - wb - wc) * a + wb * b + wc * c;
                if here > depth[sample] {
                    depth[sample] = here;
                    triangle[sample] = member;
                    weights[sample] = [wb, wc];
                }
            });
        }
    });
    found
}

/// Calls with every sample of some rows whose middle lies in a triangle.
fn each_inside([a, b, c]: [[f64; 3]; 3], (width, first, rows): (usize, usize, usize), mut visit: impl FnMut(usize, [f64; 2])) {
    let bounds = |axis: usize, begin: usize, length: usize| {
        let low = a[axis].min(b[axis]).min(c[axis]) - 0.5 - begin as f64;
        let high = a[axis].max(b[axis]).max(c[axis]) + 0.5 - begin as f64;
        // Conversion to an integer is saturating: what lies before the first row starts at it.
        (low.floor() as usize, (high.ceil().max(0.0) as usize).min(length))
    };
    let (top, bottom) = bounds(1, first, rows);
    let (left, right) = bounds(0, 0, width);
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if area == 0.0 || area.is_nan() {
        return;
    }
    let inverse = 1.0 / area;
    for y in top..bottom {
        let down = (y + first) as f64 + 0.5 - a[1];
        for x in left..right {
            let across = x as f64 + 0.5 - a[0];
            let wb = (across * (c[1] - a[1]) - down * (c[0] - a[0])) * inverse;
            let wc = ((b[0] - a[0]) * down - (b[1] - a[1]) * across) * inverse;
            // A little overlap, or rounding would leave pinholes along shared edges.
            if wb >= -1e-9 && wc >= -1e-9 && wb + wc <= 1.0 + 1e-9 {
                visit(y * width + x, [wb, wc]);
            }
        }
    }
}
