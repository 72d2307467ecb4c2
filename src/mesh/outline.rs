//! What is asked of the triangles that fill an outline, and why an outline cannot be filled.

use super::MeshError;

/// A length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Size {
    /// A part of the diagonal of the bounding box.
    Fraction(f64),
    /// In the units of the outline.
    Absolute(f64),
    /// Any length.
    Unbounded,
}

/// How large and how blunt the triangles are that fill an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutlineOptions {
    /// The longest edge; holds in any case.
    pub max_edge: Size,
    /// The largest area, in the squared units of the outline; holds in any case.
    pub max_area: Option<f64>,
    /// The smallest angle, in degrees, 0 to 33. Angles between segments of the outline stay as they are, and next to them smaller ones can remain.
    pub min_angle: f64,
    /// Most vertices; more are refused.
    pub max_vertices: usize,
}

impl Default for OutlineOptions {
    /// Edges up to 2 % of the diagonal, angles from 25 degrees, up to two million vertices.
    fn default() -> Self {
        Self { max_edge: Size::Fraction(0.02), max_area: None, min_angle: 25.0, max_vertices: 2_000_000 }
    }
}

/// A place of an outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OutlinePlace {
    /// The ring, counted from 0.
    pub ring: usize,
    /// The place in the ring, counted from 0, equal places in a row counted once.
    pub point: usize,
}

impl std::fmt::Display for OutlinePlace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "point {} of ring {}", self.point, self.ring)
    }
}

/// Why an outline cannot be filled with triangles. Rings and points count from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OutlineError {
    /// There is no ring.
    #[error("the outline has no ring; expected at least one")]
    Empty,
    /// A ring has too few places.
    #[error("ring {ring} has {found} different points in a row; expected at least 3")]
    Short {
        /// The ring.
        ring: usize,
        /// Its places.
        found: usize,
    },
    /// A coordinate that is not finite, or too large or small to compute with.
    #[error("{place} is at {position:?}; expected finite numbers up to 1e30, and not closer to 0 than 1e-30 unless they are 0")]
    Coordinate {
        /// The place.
        place: OutlinePlace,
        /// What was found.
        position: [f64; 2],
    },
    /// Two segments cross.
    #[error(
        "the segment from {first} to point {} crosses the segment from {second} to point {} at ({:.6}, {:.6}); expected rings that do not cross",
        (first.point + 1) % lengths[0], (second.point + 1) % lengths[1], position[0], position[1]
    )]
    Crossing {
        /// Where one segment starts.
        first: OutlinePlace,
        /// Where the other starts.
        second: OutlinePlace,
        /// Places of the two rings.
        lengths: [usize; 2],
        /// Where they cross, to rounding.
        position: [f64; 2],
    },
    /// A ring touches itself or another one.
    #[error("the outline touches itself at ({:.6}, {:.6}): {first} and {second}; expected rings that keep apart", position[0], position[1])]
    Touching {
        /// One place, or the start of a segment.
        first: OutlinePlace,
        /// The other place.
        second: OutlinePlace,
        /// Where.
        position: [f64; 2],
    },
    /// An option is out of range.
    #[error("{what} is {value}; expected {expected}")]
    Option {
        /// The option.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What was expected, in words.
        expected: &'static str,
    },
    /// The triangulation needs more vertices than are allowed.
    #[error("the triangulation needs more than {allowed} vertices; expected larger triangles or a smaller least angle")]
    TooMany {
        /// The limit.
        allowed: usize,
    },
    /// Edges as short as asked are below rounding.
    #[error("edges of length {longest:e} cannot be told apart at these coordinates; expected larger triangles")]
    TooFine {
        /// The longest edge allowed.
        longest: f64,
    },
    /// A triangle without area is left.
    #[error("a triangle at ({:.6}, {:.6}) has no area (ratio {ratio:e}): the outline is too thin there", position[0], position[1])]
    Flat {
        /// Where.
        position: [f64; 2],
        /// Area by squared longest edge.
        ratio: f64,
    },
    /// The triangles are no complex.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Refuses what cannot be triangulated for reasons that need no triangulation; returns the diagonal of the bounding box.
pub(super) fn check(rings: &[Vec<[f64; 2]>], options: &OutlineOptions) -> Result<f64, OutlineError> {
    const LARGEST: f64 = 1e30;
    if rings.is_empty() {
        return Err(OutlineError::Empty);
    }
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for (ring, points) in rings.iter().enumerate() {
        for (point, &position) in points.iter().enumerate() {
            let is_sound = |part: f64| part == 0.0 || (1.0 / LARGEST..=LARGEST).contains(&part.abs());
            if !position.into_iter().all(is_sound) {
                return Err(OutlineError::Coordinate { place: OutlinePlace { ring, point }, position });
            }
            for axis in 0..2 {
                low[axis] = low[axis].min(position[axis]);
                high[axis] = high[axis].max(position[axis]);
            }
        }
        if points.len() < 3 {
            return Err(OutlineError::Short { ring, found: points.len() });
        }
    }
    let positive = |what, value: f64| match value > 0.0 && !value.is_nan() {
        true => Ok(()),
        false => Err(OutlineError::Option { what, value, expected: "a positive number" }),
    };
    if let Size::Fraction(value) | Size::Absolute(value) = options.max_edge {
        positive("the longest edge", value)?;
    }
    options.max_area.map_or(Ok(()), |value| positive("the largest area", value))?;
    if !(0.0..=33.0).contains(&options.min_angle) {
        let value = options.min_angle;
        // Beyond 33 degrees the refinement need not end.
        return Err(OutlineError::Option { what: "the smallest angle", value, expected: "0 to 33 degrees" });
    }
    Ok((high[0] - low[0]).hypot(high[1] - low[1]))
}
