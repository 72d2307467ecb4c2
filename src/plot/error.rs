//! What can go wrong in a picture.

use crate::field::{FieldError, VertexId};

/// Why a picture was not made or not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// The values are not a finite field on the complex.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// An extremum to be marked is not a vertex.
    #[error("extremum at vertex {vertex}; expected less than {vertices}")]
    UnknownVertex {
        /// The vertex named.
        vertex: VertexId,
        /// Number of vertices of the complex.
        vertices: usize,
    },
    /// There is nothing to show.
    #[error("the complex has no simplex to draw")]
    Empty,
    /// The width is outside of what can be drawn.
    #[error("picture of {found} pixels in width; expected {least} to {most}")]
    Width {
        /// Width asked for.
        found: u32,
        /// Least width.
        least: u32,
        /// Greatest width.
        most: u32,
    },
    /// A number of a chart or a colour range is NaN or infinite, or a persistence is negative.
    #[error("{what} is {found}; expected a finite number{expected}")]
    Number {
        /// Which number.
        what: &'static str,
        /// The value found.
        found: f64,
        /// What else was expected of it.
        expected: &'static str,
    },
    /// An image file could not be read.
    #[error("{path}: {source}", path = path.display())]
    Read {
        /// The file.
        path: std::path::PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file is no image in the format of its name.
    #[error("{path}: found no PNG image that can be decoded ({message}); expected one", path = path.display())]
    Decode {
        /// The file.
        path: std::path::PathBuf,
        /// What the decoder said.
        message: String,
    },
    /// Pixels do not fill a rectangle.
    #[error("{found} pixels for a photograph of {width} x {height}; expected their product, and at least one")]
    Pixels {
        /// Width asked for.
        width: usize,
        /// Height asked for.
        height: usize,
        /// Pixels given.
        found: usize,
    },
    /// The encoder of the image failed.
    #[error("image not encoded: {0}")]
    Encode(#[from] image::ImageError),
    /// The chart could not be drawn.
    #[error("chart not drawn: {0}")]
    Chart(String),
    /// A file could not be written.
    #[error("{path} not written: {source}", path = path.display())]
    Write {
        /// The file asked for.
        path: std::path::PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}
