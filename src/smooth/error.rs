//! Why a field was not smoothed.

use crate::field::{FieldError, Precision, VertexId};
use crate::monotone::{Contradiction, NotRepresentable, RepresentativeError, SimplifyError};
use crate::morse::MorseError;
use crate::operators::OperatorError;
use crate::qp::QpError;

/// Why a field was not smoothed. Vertices are those of the domain; [`SmoothError::vertices`] lists them, so that a caller can
/// translate them to the points of a file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SmoothError {
    /// The data are no field on the mesh.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// The mesh has a simplex without length, area or volume.
    #[error(transparent)]
    Operator(#[from] OperatorError),
    /// The selection of extrema does not fit the field.
    #[error(transparent)]
    Morse(#[from] MorseError),
    /// The wanted extrema admit no field.
    #[error(transparent)]
    Representative(#[from] RepresentativeError),
    /// The engine refused the problem.
    #[error(transparent)]
    Solver(#[from] QpError),
    /// There is nothing to smooth.
    #[error("the mesh has {vertices} vertices and {simplices} simplices; expected at least one simplex")]
    Empty {
        /// Number of vertices.
        vertices: usize,
        /// Number of top simplices.
        simplices: usize,
    },
    /// A component has one value only: no strict field is near it.
    #[error(
        "the field is constant (value {value:?}) on the component of vertex {vertex} ({vertices} vertices); expected at least two \
         values: leave that component out with a mask"
    )]
    Constant {
        /// The lowest vertex of the component.
        vertex: VertexId,
        /// Its number of vertices.
        vertices: usize,
        /// The value.
        value: f64,
    },
    /// Two values at wanted extrema contradict the order that the representative function gives.
    #[error(
        "the wanted values contradict each other: vertex {} (value {:?}) must stay below vertex {} (value {:?}); \
         free them (values free, or within an interval) or drop one of the two extrema", .0.low, .0.low_value, .0.high, .0.high_value
    )]
    Contradiction(Contradiction),
    /// Between two wanted values there are fewer numbers of the stored width than vertices in a row.
    #[error(
        "no strictly monotone field fits into {} at vertex {vertex}: its wanted neighbours in value are too close; expected \
         more distance between extrema: raise the threshold, or free their values{}",
        match precision { Precision::F32 => "32-bit numbers", Precision::F64 => "64-bit numbers" },
        match precision { Precision::F32 => ", or convert the array to 64 bits", Precision::F64 => "" }
    )]
    NotRepresentable {
        /// The vertex without a value left.
        vertex: VertexId,
        /// The stored width.
        precision: Precision,
    },
    /// Smoothing leaves nothing of a component on which extrema could be selected.
    #[error(
        "the smooth field is constant (value {value:?}) on the component of vertex {vertex} ({vertices} vertices); expected at \
         least two values: ask for a shorter smoothing length, or select on the data"
    )]
    SmoothedAway {
        /// The lowest vertex of the component.
        vertex: VertexId,
        /// Its number of vertices.
        vertices: usize,
        /// The value.
        value: f64,
    },
    /// No data value of a component counts.
    #[error("confidence is 0 at every vertex of the component of vertex {vertex}; expected a number above 0 at one of them at least")]
    NoConfidence {
        /// The lowest vertex of the component.
        vertex: VertexId,
    },
    /// The values lie so far apart that their difference is no number.
    #[error("the values range from {low:e} to {high:e}; expected a range below 1.7e308: rescale the values")]
    Range {
        /// Least value.
        low: f64,
        /// Greatest value.
        high: f64,
    },
    /// A power of the smoothing length leaves the range of numbers.
    #[error(
        "a smoothing length of {length:e} in the units of the points to the power of {power} is no number; \
         expected one between 1e-300 and 1e300: rescale the points, or ask for a lower order"
    )]
    LengthPower {
        /// The length, or an end of the range in which it would be searched.
        length: f64,
        /// Twice the order.
        power: i32,
    },
    /// A list given as an option has the wrong length.
    #[error("{option} has {found} values for {expected} vertices")]
    OptionLength {
        /// Name of the option.
        option: &'static str,
        /// Number of vertices.
        expected: usize,
        /// Number of values.
        found: usize,
    },
    /// A value of a list given as an option is out of its range.
    #[error("{option} is {found:?} at vertex {vertex}; expected {expected}")]
    OptionValue {
        /// Name of the option.
        option: &'static str,
        /// The vertex.
        vertex: VertexId,
        /// The value.
        found: f64,
        /// What would be right, in words.
        expected: &'static str,
    },
    /// A single number given as an option is out of its range.
    #[error("{option} is {found:?}; expected {expected}")]
    OptionRange {
        /// Name of the option.
        option: &'static str,
        /// The number.
        found: f64,
        /// What would be right, in words.
        expected: &'static str,
    },
}

impl From<Contradiction> for SmoothError {
    fn from(contradiction: Contradiction) -> Self {
        Self::Contradiction(contradiction)
    }
}

impl SmoothError {
    pub(super) fn not_representable(found: NotRepresentable, precision: Precision) -> Self {
        Self::NotRepresentable { vertex: found.vertex, precision }
    }

    pub(super) fn of_simplify(error: SimplifyError, precision: Precision) -> Self {
        match error {
            SimplifyError::Representative(error) => Self::Representative(error),
            SimplifyError::Contradiction(found) => Self::Contradiction(found),
            SimplifyError::NotRepresentable(found) => Self::not_representable(found, precision),
        }
    }

    /// The vertices that the message names, in its order.
    pub fn vertices(&self) -> Vec<VertexId> {
        match self {
            Self::Field(FieldError::NonFinite { vertex, .. })
            | Self::Constant { vertex, .. }
            | Self::SmoothedAway { vertex, .. }
            | Self::NoConfidence { vertex }
            | Self::NotRepresentable { vertex, .. }
            | Self::OptionValue { vertex, .. }
            | Self::Operator(OperatorError::Scale { vertex, .. } | OperatorError::NonFinite { vertex, .. })
            | Self::Representative(RepresentativeError::Unreachable { vertex, .. })
            | Self::Morse(MorseError::NotAnExtremum { vertex }) => vec![*vertex],
            Self::Morse(MorseError::ComponentWithout { component, .. }) => vec![*component],
            Self::Contradiction(found) => vec![found.low, found.high],
            _ => Vec::new(),
        }
    }
}
