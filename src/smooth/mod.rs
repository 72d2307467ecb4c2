//! Noisy field in, smooth field with exactly the wanted extrema out.

mod checks;
mod error;
mod length;
mod options;
mod pipeline;
mod report;
mod select;

pub use checks::constant_components;
pub use error::SmoothError;
pub use length::{ChosenLength, cross_validated_length};
pub use options::{ExtremumValues, Length, SelectOn, SmoothOptions};
pub use pipeline::{SmoothProgress, Smoothed, smooth};
pub use report::{
    ChangeReport, EnergyReport, ExtremumCount, LengthReport, RepairReport, RepresentativeReport, SmoothReport, SolverReport,
    Timing,
};
pub use select::{MeasuredField, Selected, select_extrema};
