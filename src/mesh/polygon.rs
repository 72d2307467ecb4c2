//! Triangulation of one polygon cell: a fan where it fits, ears otherwise.
//!
//! Literature: Meisters 1975, *Polygons have ears*; Eberly 2008, *Triangulation by ear clipping*.

use super::measure::{cross, dot, minus, norm};

/// Ears thinner than this (twice the area over the square of the longest side) are not cut while there are others.
///
/// Ten times what counts as zero measure, since the projection onto a coordinate plane costs up to a factor of 3.
const THIN: f64 = 20.0 * super::ZERO_MEASURE;

/// Whether the outline of a polygon could be triangulated without overlaps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Outline {
    Simple,
    Tangled,
}

/// Cuts a polygon into triangles of its own orientation.
///
/// A fan from the smallest point number if all its triangles are properly oriented (always so for strictly convex
/// polygons); else ears, the best-shaped first; else, for an outline that crosses itself, the fan all the same.
///
/// # Arguments
/// * `outline`: at least three point numbers without neighbours that are equal. A point may be named again further on,
///   as in a polygon whose hole is tied to its outline by a bridge.
pub(super) fn triangulate(outline: &[u32], points: &[[f64; 3]], mut emit: impl FnMut([u32; 3])) -> Outline {
    let count = outline.len();
    let smallest = (0..count).min_by_key(|&corner| outline[corner]).unwrap_or(0);
    let fan = |step: usize| [smallest, (smallest + step) % count, (smallest + step + 1) % count];
    let ids = |corners: [usize; 3]| corners.map(|corner| outline[corner]);
    if count == 3 {
        emit(ids([0, 1, 2]));
        return Outline::Simple;
    }
    // A flat outline has no plane; its fan has zero measure and is refused by name later.
    let plane = project(outline, points);
    if plane.as_ref().is_none_or(|plane| (1..count - 1).all(|step| shape(plane, fan(step)) > THIN)) {
        (1..count - 1).for_each(|step| emit(ids(fan(step))));
        return Outline::Simple;
    }
    match plane.and_then(|plane| clip_ears(outline, &plane)) {
        Some(ears) => {
            ears.into_iter().for_each(|ear| emit(ids(ear)));
            Outline::Simple
        }
        None => {
            (1..count - 1).for_each(|step| emit(ids(fan(step))));
            Outline::Tangled
        }
    }
}

/// The outline in the coordinate plane that it faces most, counter-clockwise; `None` if it has no area.
fn project(outline: &[u32], points: &[[f64; 3]]) -> Option<Vec<[f64; 2]>> {
    let first = points[outline[0] as usize];
    let spokes: Vec<[f64; 3]> = outline.iter().map(|&point| minus(points[point as usize], first)).collect();
    let mut normal = [0.0; 3];
    for pair in spokes.windows(2) {
        let area = cross(pair[0], pair[1]);
        for (sum, part) in normal.iter_mut().zip(area) {
            *sum += part;
        }
    }
    let reach = spokes.iter().map(|&spoke| dot(spoke, spoke)).fold(0.0, f64::max);
    let area = norm(normal);
    if area.is_nan() || area <= THIN * reach {
        return None;
    }
    let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(2);
    let (mut u, mut v) = ((axis + 1) % 3, (axis + 2) % 3);
    if normal[axis] < 0.0 {
        std::mem::swap(&mut u, &mut v);
    }
    Some(spokes.iter().map(|spoke| [spoke[u], spoke[v]]).collect())
}

/// Twice the signed area of a triangle over the square of its longest side: the scale-free shape of an ear.
fn shape(plane: &[[f64; 2]], corners: [usize; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| plane[corner]);
    let sides = [[a, b], [b, c], [c, a]].map(|[p, q]| (q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2));
    turn(a, b, c) / sides.into_iter().fold(f64::MIN_POSITIVE, f64::max)
}

/// Twice the signed area of a triangle, positive if counter-clockwise.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Cuts ears until three corners are left; `None` if at some point there is no ear.
fn clip_ears(outline: &[u32], plane: &[[f64; 2]]) -> Option<Vec<[usize; 3]>> {
    let mut ring: Vec<usize> = (0..outline.len()).collect();
    let mut ears = Vec::with_capacity(outline.len() - 2);
    let mut quality: Vec<Option<f64>> = Vec::new();
    while ring.len() > 3 {
        if quality.iter().all(Option::is_none) {
            quality = (0..ring.len()).map(|corner| ear(outline, plane, &ring, corner)).collect();
        }
        let best = (0..ring.len())
            .filter_map(|corner| quality[corner].map(|shape| (shape, corner)))
            .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)))?
            .1;
        ears.push(around(&ring, best));
        ring.remove(best);
        quality.remove(best);
        // Only the two neighbours of a clipped ear change; corners that it blocked are found when no ear is left.
        for corner in [(best + ring.len() - 1) % ring.len(), best % ring.len()] {
            quality[corner] = ear(outline, plane, &ring, corner);
        }
    }
    let last = [ring[0], ring[1], ring[2]];
    (shape(plane, last) > THIN).then(|| {
        ears.push(last);
        ears
    })
}

/// The shape of the ear at a corner of the ring, or `None` if the triangle there is no ear.
fn ear(outline: &[u32], plane: &[[f64; 2]], ring: &[usize], corner: usize) -> Option<f64> {
    let triangle = around(ring, corner);
    let shape = shape(plane, triangle);
    if shape <= THIN || shape.is_nan() {
        return None;
    }
    let [a, b, c] = triangle.map(|corner| plane[corner]);
    let own = triangle.map(|corner| outline[corner]);
    // A point on the rim blocks too: cutting across it would leave an outline that touches itself.
    let blocks = |&other: &usize| {
        let p = plane[other];
        !own.contains(&outline[other]) && turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0
    };
    (!ring.iter().any(blocks)).then_some(shape)
}

fn around(ring: &[usize], corner: usize) -> [usize; 3] {
    [ring[(corner + ring.len() - 1) % ring.len()], ring[corner], ring[(corner + 1) % ring.len()]]
}
