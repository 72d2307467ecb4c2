//! Commands on fields that were measured: what their extrema are, which are kept, and the fields that have exactly those.

pub mod check;
pub mod complex;
pub mod complex_report;
pub mod extrema;
pub mod persistence;
pub mod simplify;
pub mod smooth;
pub mod smooth_series;
pub mod table;
