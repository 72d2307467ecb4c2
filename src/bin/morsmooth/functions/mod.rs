//! Commands that make functions: with wished extrema, as weights of handles, as colours, as distances, as curves.

pub mod by_hand;
pub mod diffuse;
pub mod diffuse_colours;
pub mod geodesic;
pub mod geodesic_report;
pub mod geodesic_sources;
pub mod interpolate;
pub mod interpolate_data;
pub mod series;
pub mod series_input;
pub mod weights;
pub mod weights_report;
