//! Noisy field in, smooth field with exactly the wanted extrema out.

mod automatic;
mod checks;
mod error;
mod guidance;
mod keep;
mod length;
mod options;
mod pipeline;
mod report;
mod result;
mod rounds;
mod select;
mod simplify;
mod smoother;

pub use checks::{check_field, constant_components};
pub use error::SmoothError;
pub use length::{ChosenLength, cross_validated_length};
pub use options::{ExtremumValues, KeepAlso, Length, SelectOn, SmoothOptions};
pub use pipeline::{SmoothProgress, Smoothed, smooth};
pub use report::{
    ChangeReport, EnergyReport, ExtremumCount, KeptReport, LengthReport, RepairReport, RepresentativeReport, SmoothReport, SolverReport,
    Timing,
};
pub use select::{MeasuredField, Selected, select_extrema};
pub use simplify::{PairReport, Simplified, SimplifyChange, SimplifyReport, simplify};
pub use smoother::Smoother;
