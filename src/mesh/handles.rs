//! Handles: what the user moves or colours, as a file names them and as a mesh carries them.

use super::attach::{self, AttachOptions};
use super::{HandleError, SimplicialComplex};
use crate::field::VertexId;

/// Where a handle is.
#[derive(Debug, Clone, PartialEq)]
pub enum HandleShape {
    /// A point; the nearest vertex carries it.
    Point([f64; 3]),
    /// A segment from its root to its tip; the vertices on it, or the nearest ones along it, carry it.
    Bone([[f64; 3]; 2]),
    /// Vertices, given.
    Region(Vec<VertexId>),
}

/// One handle.
#[derive(Debug, Clone, PartialEq)]
pub struct Handle {
    /// Its name, unlike those of the others.
    pub name: String,
    /// Where it is.
    pub shape: HandleShape,
}

/// All handles of a mesh, in the order of the file; weights and poses count in this order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HandleSet {
    /// The handles.
    pub handles: Vec<Handle>,
    /// Edges of a cage between two point handles, by their places in `handles`; no handles of their own. Vertices on them
    /// belong to both ends, linearly.
    pub cage_edges: Vec<[usize; 2]>,
}

/// A vertex that several handles hold together: on a cage edge, or at the joint of bones.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedVertex {
    /// The vertex.
    pub vertex: VertexId,
    /// Handles, rising, and their shares, positive and of sum 1.
    pub shares: Vec<(usize, f64)>,
}

/// The vertices that carry each handle.
///
/// Every handle has a vertex of its own, and no vertex is listed twice. A vertex where bones meet, or on a cage edge, is
/// shared and not among the vertices of any handle.
#[derive(Debug, Clone, PartialEq)]
pub struct AttachedHandles {
    names: Vec<String>,
    vertices: Vec<Vec<VertexId>>,
    shared: Vec<SharedVertex>,
}

impl HandleSet {
    /// Number of handles.
    pub fn len(&self) -> usize {
        self.handles.len()
    }

    /// Whether there is no handle.
    pub fn is_empty(&self) -> bool {
        self.handles.is_empty()
    }

    /// Names in the order of the handles.
    pub fn names(&self) -> Vec<String> {
        self.handles.iter().map(|handle| handle.name.clone()).collect()
    }

    /// Finds the vertices that carry each handle.
    ///
    /// A point is carried by the nearest vertex. A bone is carried by the vertices that lie on it, if they cover it, otherwise by
    /// the vertices nearest to points spaced half an edge along it, joined along edges of the mesh where they are not
    /// neighbours. A cage edge shares out the vertices along it between its two ends. A vertex that bones with a common
    /// joint both claim is shared equally.
    ///
    /// # Arguments
    /// * `complex`: `n` vertices, all of them corners of simplices.
    ///
    /// # Errors
    /// [`HandleError`] names the handle or the two handles, the place, and what was expected.
    ///
    /// # Cost
    /// O(n) a handle, in parallel.
    pub fn attach(&self, complex: &SimplicialComplex, options: &AttachOptions) -> Result<AttachedHandles, HandleError> {
        attach::attach(self, complex, options)
    }

    /// The same handles with the numbers of their regions translated, as from the points of a file to the vertices of its domain.
    ///
    /// # Arguments
    /// * `vertex_of`: for every old number the new one, `None` where there is none.
    ///
    /// # Errors
    /// [`HandleError::VertexOutOfRange`], [`HandleError::NotInDomain`].
    pub fn renumbered(&self, vertex_of: &[Option<VertexId>]) -> Result<Self, HandleError> {
        let mut set = self.clone();
        for Handle { name, shape } in &mut set.handles {
            let HandleShape::Region(vertices) = shape else { continue };
            for vertex in vertices {
                let found = *vertex;
                let new = vertex_of.get(found.index());
                let new = new.ok_or_else(|| HandleError::VertexOutOfRange { name: name.clone(), vertex: found, vertices: vertex_of.len() })?;
                *vertex = new.ok_or_else(|| HandleError::NotInDomain { name: name.clone(), point: found })?;
            }
        }
        Ok(set)
    }

    /// The place about which a handle turns unless its pose says otherwise: the point, the root of the bone, the middle of the region.
    ///
    /// # Errors
    /// [`HandleError::VertexOutOfRange`] and [`HandleError::NoVertex`] for a region.
    ///
    /// # Panics
    /// If `handle` is not below [`Self::len`].
    pub fn pivot(&self, handle: usize, complex: &SimplicialComplex) -> Result<[f64; 3], HandleError> {
        let Handle { name, shape } = &self.handles[handle];
        match shape {
            HandleShape::Point(point) | HandleShape::Bone([point, _]) => Ok(*point),
            HandleShape::Region(vertices) => {
                attach::check_region(name, vertices, complex)?;
                let mut middle = [0.0; 3];
                for vertex in vertices {
                    for (sum, part) in middle.iter_mut().zip(complex.point(*vertex)) {
                        *sum += part / vertices.len() as f64;
                    }
                }
                Ok(middle)
            }
        }
    }
}

impl AttachedHandles {
    /// Takes what [`attach`](HandleSet::attach) found; all lists are sorted.
    pub(super) fn new(names: Vec<String>, vertices: Vec<Vec<VertexId>>, shared: Vec<SharedVertex>) -> Self {
        Self { names, vertices, shared }
    }

    /// Number of handles.
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Whether there is no handle.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// Names in the order of the handles.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The vertices of each handle, rising, at least one each, no vertex twice.
    pub fn vertices(&self) -> &[Vec<VertexId>] {
        &self.vertices
    }

    /// Vertices that several handles hold together, rising; none of them is in [`Self::vertices`].
    pub fn shared(&self) -> &[SharedVertex] {
        &self.shared
    }

    /// What the weight of a handle must be at every vertex that any handle holds: 1 at its own, 0 at those of others, its share at
    /// shared ones.
    ///
    /// # Returns
    /// Vertices, rising, and values in [0, 1].
    ///
    /// # Panics
    /// If `handle` is not below [`Self::len`].
    pub fn boundary_values(&self, handle: usize) -> Vec<(VertexId, f64)> {
        assert!(handle < self.len(), "handle {handle} of {}", self.len());
        let own = self.vertices.iter().enumerate();
        let own = own.flat_map(|(owner, vertices)| {
            let value = if owner == handle { 1.0 } else { 0.0 };
            vertices.iter().map(move |&vertex| (vertex, value))
        });
        let shared = self.shared.iter().map(|shared| {
            let share = shared.shares.iter().find(|&&(owner, _)| owner == handle);
            (shared.vertex, share.map_or(0.0, |&(_, share)| share))
        });
        let mut values: Vec<(VertexId, f64)> = own.chain(shared).collect();
        values.sort_unstable_by_key(|&(vertex, _)| vertex);
        values
    }
}
