//! What a deformation refuses.

use crate::audit::OrientationError;
use crate::field::VertexId;
use crate::linalg::{FactorError, MatrixError};
use crate::qp::QpError;

/// Why a shape cannot be deformed as asked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeformError {
    /// The mesh is a curve.
    #[error("the mesh has simplices of dimension {found}; triangles in a plane or tetrahedra were expected")]
    Dimension {
        /// Dimension of its top simplices.
        found: usize,
    },
    /// A triangle mesh that does not lie in a plane z = constant.
    #[error("vertex {vertex} has z = {found}, another one {expected}; triangles in a plane z = constant were expected")]
    NotPlanar {
        /// The first vertex off the plane.
        vertex: VertexId,
        /// Its height.
        found: f64,
        /// The height of the first vertex.
        expected: f64,
    },
    /// Rest elements without area or volume.
    #[error(
        "{} elements of the rest shape have zero measure, the first is {}: measure / longest edge^d is {ratio:e}",
        elements.len(), elements[0]
    )]
    ZeroMeasure {
        /// The elements, rising.
        elements: Vec<usize>,
        /// The ratio of the first one.
        ratio: f64,
    },
    /// Rest elements that are folded over their neighbours.
    #[error("{} elements of the rest shape are inverted against their neighbours, the first is {}", elements.len(), elements[0])]
    Inverted {
        /// The elements, rising: in each part that hangs together by facets, those of the orientation with the smaller measure.
        elements: Vec<usize>,
    },
    /// Coordinates so large or small that gradients leave the range of numbers.
    #[error("the gradients of element {element} are not finite; rescale the coordinates")]
    Scale {
        /// The first such element.
        element: usize,
    },
    /// A list has the wrong length.
    #[error("{found} {what} were given; {expected} were expected")]
    Length {
        /// What is listed.
        what: &'static str,
        /// Entries expected.
        expected: usize,
        /// Entries found.
        found: usize,
    },
    /// A number is NaN or infinite, or negative where it must not be.
    #[error("{what} {index} is {value}; {expected} was expected")]
    Number {
        /// What is listed.
        what: &'static str,
        /// Place in the list.
        index: usize,
        /// The number.
        value: f64,
        /// What was expected, in words.
        expected: &'static str,
    },
    /// A handle names a vertex that does not exist, or one that was named before.
    #[error("handle {handle} names vertex {vertex}; {expected}")]
    Handle {
        /// Place in the list of handles.
        handle: usize,
        /// The vertex that it names.
        vertex: VertexId,
        /// What was expected, in words.
        expected: &'static str,
    },
    /// A part of the mesh without a handle could be anywhere.
    #[error("no handle holds the part of the mesh with vertex {vertex}; at least one handle a connected part was expected")]
    NoHandle {
        /// The first vertex of the part.
        vertex: VertexId,
    },
    /// A target rotation is no rotation.
    #[error("the matrix of element {element} is off a rotation by {deviation:e}; at most 1e-8 and a positive determinant were expected")]
    NotARotation {
        /// The first such element.
        element: usize,
        /// Largest entry of `|RᵀR - I|`, or 2 for a reflection.
        deviation: f64,
    },
    /// More than 32-bit numbers can name.
    #[error("{found} entries of the rows; at most {} can be handled", u32::MAX)]
    TooLarge {
        /// Entries of the matrix of rows.
        found: usize,
    },
    /// A held vertex belongs to a handle that has no name.
    #[error("held vertex {place} belongs to handle {found}; a number below {names} was expected")]
    Owner {
        /// Place in the list of held vertices.
        place: usize,
        /// The handle that was given.
        found: usize,
        /// Handles with a name.
        names: usize,
    },
    /// The engine refuses the problem.
    #[error(transparent)]
    Engine(#[from] QpError),
    /// The result cannot be judged.
    #[error(transparent)]
    Audit(#[from] OrientationError),
    /// The assembled numbers are no matrix.
    #[error(transparent)]
    Matrix(#[from] MatrixError),
    /// A method of comparison that needs soft handles was given hard ones.
    #[error("the handles are hard; this method of comparison needs soft ones")]
    SoftHandles,
    /// A matrix of a method of comparison could not be analysed.
    #[error(transparent)]
    Factor(#[from] FactorError),
}
