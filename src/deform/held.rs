//! The vertices that are held, and the handles that they belong to.

use super::DeformError;
use crate::field::VertexId;

/// Vertices that are held, each with its handle.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldVertices {
    /// The vertices, each once.
    pub vertices: Vec<VertexId>,
    /// The handle of each vertex, by its place in the names; of a vertex that several handles share, one of them.
    pub owners: Vec<usize>,
    /// Names of the handles.
    pub names: Vec<String>,
}

impl HeldVertices {
    /// Every vertex is a handle of its own, named after it.
    pub fn unnamed(vertices: Vec<VertexId>) -> Self {
        Self {
            owners: (0..vertices.len()).collect(),
            names: vertices.iter().map(|vertex| format!("vertex {vertex}")).collect(),
            vertices,
        }
    }

    /// Refuses lists that do not fit.
    pub(super) fn check(&self) -> Result<(), DeformError> {
        if self.owners.len() != self.vertices.len() {
            return Err(DeformError::Length { what: "owners", expected: self.vertices.len(), found: self.owners.len() });
        }
        match self.owners.iter().position(|&owner| owner >= self.names.len()) {
            Some(place) => Err(DeformError::Owner { place, found: self.owners[place], names: self.names.len() }),
            None => Ok(()),
        }
    }
}
