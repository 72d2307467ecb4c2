//! The judge of a result: counts extrema by lower links and orientations by exact predicates, with no code of what produced the field or
//! the shape.

mod extrema;
mod orientation;
mod plateaus;
mod report;

pub use extrema::{Extrema, StrictExtrema, extrema, strict_extrema};
pub use orientation::{OrientationError, OrientationReport, orientations};
pub use plateaus::{PlateauReport, audit_plateaus};
pub use report::{
    AuditReport, Defects, ExtremumType, LISTED_DEFECTS, MovedValue, Plateaus, ValueRule, Wanted, audit, moved_values,
};
