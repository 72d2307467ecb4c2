//! Where a path may go on at a vertex: not nearer than half a turn to where it came from, on either hand.

use std::f64::consts::PI;

use super::surface::{Side, Surface};
use super::wavefront::Arrival;
use crate::field::VertexId;
use crate::mesh::SimplicialComplex;

/// Directions so little inside of half a turn are allowed, so that no gap opens beside a straight path.
const WIDENING: f64 = 1e-8;

/// The parts of the sides opposite to `vertex` through which shortest paths may leave it.
///
/// # Arguments
/// * `arrival`: how the shortest path came; `None` lets paths leave everywhere.
///
/// # Returns
/// Sides with `vertex` as apex, and an interval on each.
pub(super) fn sectors(
    complex: &SimplicialComplex,
    surface: &Surface,
    vertex: u32,
    arrival: Option<Arrival>,
) -> Vec<(u32, [f64; 2])> {
    let star = complex.star(VertexId(vertex));
    let opposite = |&triangle: &u32| surface.opposite(triangle, vertex);
    let whole = |number: u32| (number, [0.0, surface.sides[number as usize].length]);
    let Some(arrival) = arrival else { return star.iter().map(|triangle| whole(opposite(triangle))).collect() };

    let side = &surface.sides[arrival.side as usize];
    let to_left = angle_from_left(side, arrival.from).clamp(0.0, side.apex_angle());
    let first = arrival.side;
    let left = Walk { surface, vertex, number: first, is_leftward: true }.fan(first);
    let is_closed = left.is_closed;
    let mut sectors = Vec::new();
    let total: f64 = side.apex_angle() + left.steps.iter().map(|step| surface.sides[step.number as usize].apex_angle()).sum::<f64>();
    // Around a closed fan the other hand is reached by the same walk.
    let most = if is_closed { total - PI + WIDENING } else { f64::INFINITY };
    allowed(surface, &left.steps, to_left, most, &mut sectors);
    let mut seen: Vec<u32> = left.steps.iter().map(|step| step.number / 3).collect();
    if !is_closed {
        let right = Walk { surface, vertex, number: first, is_leftward: false }.fan(first);
        allowed(surface, &right.steps, side.apex_angle() - to_left, f64::INFINITY, &mut sectors);
        seen.extend(right.steps.iter().map(|step| step.number / 3));
        // Other fans touch this one in the vertex only.
        seen.push(first / 3);
        let others = star.iter().filter(|triangle| !seen.contains(triangle));
        sectors.extend(others.map(|triangle| whole(opposite(triangle))));
    } else if seen.len() + 1 < star.len() {
        seen.push(first / 3);
        let others = star.iter().filter(|triangle| !seen.contains(triangle));
        sectors.extend(others.map(|triangle| whole(opposite(triangle))));
    }
    sectors
}

/// Angle at the apex from the direction of `a` to that of a point.
fn angle_from_left(side: &Side, from: [f64; 2]) -> f64 {
    let [x, y] = side.apex;
    let (to_a, to_point) = ([-x, -y], [from[0] - x, from[1] - y]);
    (to_a[0] * to_point[1] - to_a[1] * to_point[0]).atan2(to_a[0] * to_point[0] + to_a[1] * to_point[1])
}

/// A triangle met on a walk around a vertex.
struct Step {
    /// Its side with the vertex as apex.
    number: u32,
    /// Whether the walk came into it across the side from its apex to its `a`.
    is_from_left: bool,
}

struct Fan {
    steps: Vec<Step>,
    is_closed: bool,
}

/// A walk around a vertex, out of a side with it as apex.
struct Walk<'a> {
    surface: &'a Surface,
    vertex: u32,
    number: u32,
    is_leftward: bool,
}

impl Walk<'_> {
    /// The triangles met until the boundary or the first triangle again.
    fn fan(mut self, first: u32) -> Fan {
        let mut steps = Vec::new();
        loop {
            let side = &self.surface.sides[self.number as usize];
            let link = if self.is_leftward { side.left } else { side.right };
            let Some((entry, _)) = link.get() else { return Fan { steps, is_closed: false } };
            let number = self.surface.opposite(entry / 3, self.vertex);
            if number / 3 == first / 3 {
                return Fan { steps, is_closed: true };
            }
            // The side after the one opposite to the apex runs from b to the apex.
            let is_from_left = entry % 3 != (number + 1) % 3;
            steps.push(Step { number, is_from_left });
            self.is_leftward = !is_from_left;
            self.number = number;
        }
    }
}

/// Adds the parts of a walk between half a turn and `most`.
fn allowed(surface: &Surface, steps: &[Step], start: f64, most: f64, sectors: &mut Vec<(u32, [f64; 2])>) {
    let mut angle = start;
    for step in steps {
        let side = &surface.sides[step.number as usize];
        let apex_angle = side.apex_angle();
        let (from, to) = ((PI - WIDENING - angle).max(0.0), (most - angle).min(apex_angle));
        if from < to {
            let (left, right) = if step.is_from_left { (from, to) } else { (apex_angle - to, apex_angle - from) };
            let begin = if left <= 0.0 { 0.0 } else { foot(side, left) };
            let end = if right >= apex_angle { side.length } else { foot(side, right) };
            if begin < end {
                sectors.push((step.number, [begin, end]));
            }
        }
        angle += apex_angle;
        if angle >= most {
            break;
        }
    }
}

/// Where a ray from the apex meets the side, by its angle from the direction of `a`.
fn foot(side: &Side, angle: f64) -> f64 {
    let [x, y] = side.apex;
    let (sine, cosine) = angle.sin_cos();
    // The direction of a, turned towards b.
    let direction = [-x * cosine + y * sine, -x * sine - y * cosine];
    (x - direction[0] * y / direction[1]).clamp(0.0, side.length)
}
