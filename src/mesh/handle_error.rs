//! Why handles cannot be attached to a mesh.

use crate::field::VertexId;

/// Why handles cannot be attached to a mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HandleError {
    /// There is no handle.
    #[error("no handle; expected at least one")]
    None,
    /// Two handles have the same name.
    #[error("handles {first} and {second} are both named \"{name}\"; expected different names")]
    DuplicateName {
        /// The name.
        name: String,
        /// Place of the first in the list.
        first: usize,
        /// Place of the second in the list.
        second: usize,
    },
    /// A handle lies far from every vertex.
    #[error("handle \"{name}\" is outside the mesh: {place:?} is {distance:.3e} from the nearest vertex {vertex}; expected at most {allowed:.3e}")]
    Outside {
        /// The handle.
        name: String,
        /// The place asked for.
        place: [f64; 3],
        /// The nearest vertex.
        vertex: VertexId,
        /// Its distance.
        distance: f64,
        /// The greatest distance allowed.
        allowed: f64,
    },
    /// A coordinate is NaN or infinite.
    #[error("handle \"{name}\" is at {place:?}; expected finite numbers")]
    NotFinite {
        /// The handle.
        name: String,
        /// The place asked for.
        place: [f64; 3],
    },
    /// A bone has no length.
    #[error("bone \"{name}\" starts and ends at {place:?}; expected two places")]
    NoLength {
        /// The handle.
        name: String,
        /// Both its ends.
        place: [f64; 3],
    },
    /// A handle has no vertex of its own.
    #[error("handle \"{name}\" has no vertex: {reason}")]
    NoVertex {
        /// The handle.
        name: String,
        /// Why, in words.
        reason: String,
    },
    /// A region names a vertex that does not exist.
    #[error("region \"{name}\" names vertex {vertex}; expected less than {vertices}")]
    VertexOutOfRange {
        /// The handle.
        name: String,
        /// The vertex named.
        vertex: VertexId,
        /// Number of vertices.
        vertices: usize,
    },
    /// A region names a point that is not in the domain.
    #[error("region \"{name}\" names point {point}, which is not in the domain; expected points of cells that are not masked")]
    NotInDomain {
        /// The handle.
        name: String,
        /// The point named.
        point: VertexId,
    },
    /// Two handles need the same vertex.
    #[error("handles \"{first}\" and \"{second}\" are both at vertex {vertex} at {place:?}; expected a vertex each: move one of them or refine the mesh")]
    Shared {
        /// One handle.
        first: String,
        /// The other.
        second: String,
        /// The vertex.
        vertex: VertexId,
        /// Its place.
        place: [f64; 3],
    },
    /// A cage edge does not join two point handles.
    #[error("cage edge {edge} joins {first} and {second}; expected two different point handles")]
    CageEdge {
        /// The edge, in the order given.
        edge: usize,
        /// What its first end is, in words.
        first: String,
        /// What its second end is, in words.
        second: String,
    },
    /// A connected part of the mesh has no handle.
    #[error("the part of {vertices} vertices around vertex {vertex} at {place:?} has no handle ({parts} connected parts in all); expected a handle on every part")]
    PartWithoutHandle {
        /// The lowest vertex of the part.
        vertex: VertexId,
        /// Its place.
        place: [f64; 3],
        /// Vertices of the part.
        vertices: usize,
        /// Connected parts of the mesh.
        parts: usize,
    },
    /// A vertex is a corner of no simplex.
    #[error("vertex {vertex} at {place:?} is not a corner of any cell ({count} such vertices); expected none: remove them first")]
    Unreferenced {
        /// The first such vertex.
        vertex: VertexId,
        /// Its place.
        place: [f64; 3],
        /// How many there are.
        count: usize,
    },
}
