//! Windows: parts of a side that straight lines from one point reach through the same triangles.

use super::surface::Side;

/// A ray that passes an apex by less than this part of the side it came through is taken to hit it, so that rounding leaves no gap
/// between neighbouring windows.
const SNAP: f64 = 1e-11;
/// An apex outside of a window by less than this part of the side is still seen.
const SIGHT: f64 = 1e-9;

/// A part of a side seen from a point at a known distance, both in the plane of the triangle that the side leads into.
///
/// Distances within are `sigma + |(b, 0) - (x, y)|` for `begin <= b <= end`; the point lies below the side: `y <= 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window {
    pub begin: f64,
    pub end: f64,
    pub x: f64,
    pub y: f64,
    /// Distance of the point from the sources.
    pub sigma: f64,
}

impl Window {
    /// Distance at a place of the side.
    #[inline]
    pub fn distance(&self, at: f64) -> f64 {
        self.sigma + hypot(at - self.x, self.y)
    }

    /// Least distance in the window, from those at its ends.
    #[inline]
    pub fn least(&self, at_begin: f64, at_end: f64) -> f64 {
        if self.begin < self.x && self.x < self.end { self.sigma - self.y } else { at_begin.min(at_end) }
    }

    /// Sees the window from the other end of the side.
    #[inline]
    pub fn turned(self, length: f64) -> Self {
        Self { begin: length - self.end, end: length - self.begin, x: length - self.x, ..self }
    }
}

#[inline]
pub(super) fn hypot(x: f64, y: f64) -> f64 {
    // Lengths are scaled to about 1, so that no square leaves the range of numbers.
    (x * x + y * y).sqrt()
}

/// What a window does to its triangle.
pub(super) struct Passage {
    /// Distance at the apex, where the window sees it.
    pub apex: Option<f64>,
    /// The part that leaves through the side from `a` to `c`, with places counted from `a`, unfolded into its far side.
    pub left: Option<Window>,
    /// The part that leaves through the side from `c` to `b`, with places counted from `c`.
    pub right: Option<Window>,
}

/// A triangle that windows cross, with the directions of the sides through which they leave.
pub(super) struct Crossing<'a> {
    side: &'a Side,
    /// From `a` to `c`.
    left: [f64; 2],
    /// From `c` to `b`.
    right: [f64; 2],
}

impl<'a> Crossing<'a> {
    /// The triangle into which a side leads.
    pub fn new(side: &'a Side) -> Self {
        let [x, y] = side.apex;
        Self {
            side,
            left: [x / side.left_length, y / side.left_length],
            right: [(side.length - x) / side.right_length, -y / side.right_length],
        }
    }

    /// Carries a window across.
    #[inline]
    pub fn pass(&self, window: &Window) -> Passage {
        let Window { begin, end, x, y, sigma } = *window;
        let side = self.side;
        let [apex_x, apex_y] = side.apex;
        // Where the line from the point to the apex crosses the side.
        let middle = x - (apex_x - x) * y / (apex_y - y);
        let (snap, sight) = (SNAP * side.length, SIGHT * side.length);
        let apex = (begin - sight <= middle && middle <= end + sight).then(|| sigma + hypot(apex_x - x, apex_y - y));
        let left = (begin < middle - snap).then(|| {
            let [ux, uy] = self.left;
            // Where the ray through (b, 0) meets the side; 0 at a, 1 at c.
            let hit = |b: f64| (b * y / ((b - x) * apex_y + y * apex_x)).clamp(0.0, 1.0) * side.left_length;
            Window {
                begin: hit(begin),
                end: if middle <= end + snap { side.left_length } else { hit(end) },
                x: x * ux + y * uy,
                y: (ux * y - uy * x).min(0.0),
                sigma,
            }
        });
        let right = (end > middle + snap).then(|| {
            let [ux, uy] = self.right;
            let (wide, length) = (side.length - apex_x, side.right_length);
            // 0 at b, 1 at c.
            let hit = |b: f64| length - ((side.length - b) * y / ((x - b) * apex_y + y * wide)).clamp(0.0, 1.0) * length;
            let (from_x, from_y) = (x - apex_x, y - apex_y);
            Window {
                begin: if middle >= begin - snap { 0.0 } else { hit(begin) },
                end: hit(end),
                x: from_x * ux + from_y * uy,
                y: (ux * from_y - uy * from_x).min(0.0),
                sigma,
            }
        });
        Passage { apex, left, right }
    }
}
