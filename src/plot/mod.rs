//! Pictures to look at: fields before and after, persistence curves and diagrams, deformed shapes, warped photographs.
//!
//! Pictures are PNG, charts are SVG. No file or font of the system is read, and the same input gives the same bytes.

mod camera;
mod canvas;
mod chart;
mod colour;
mod counts;
mod cover;
mod curve;
mod dates;
mod error;
mod file;
mod frame;
mod marks;
mod overlay;
mod paint;
mod panel;
mod photograph;
mod picture;
mod raster;
mod series;
mod shape;
mod ticks;

pub use chart::{CurveChart, DiagramPoint, persistence_curve, persistence_diagram};
pub use colour::ColourMap;
pub use counts::{CountsChart, StepCounts};
pub use error::PlotError;
pub use file::write_atomically;
pub use overlay::complex_picture;
pub use photograph::Photograph;
pub use paint::{Painting, PixelSize, is_in_gamut, paint, to_bytes};
pub use picture::{FieldView, Picture, PictureOptions, before_after, field_picture};
pub use series::{PlaceKind, SeriesChart};
pub use shape::{ShapeView, shape_picture};
