//! The explicit simplicial complex: points, top simplices, edges, triangles and the incidence that everything needs.

use super::incidence::{self, Star};
use crate::field::VertexId;
use rayon::prelude::*;

/// An edge of a complex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EdgeId(pub u32);

/// A triangle of a complex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TriangleId(pub u32);

/// Why lists of points and simplices are not a simplicial complex.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The dimension is not 1, 2 or 3.
    #[error("simplices of dimension {found}; expected 1, 2 or 3")]
    Dimension {
        /// The dimension asked for.
        found: usize,
    },
    /// The list of vertices is no multiple of the vertices of one simplex.
    #[error("{found} vertex numbers; expected a multiple of {stride}")]
    Stride {
        /// Length of the list.
        found: usize,
        /// Vertices of one simplex.
        stride: usize,
    },
    /// A simplex names a vertex that does not exist.
    #[error("simplex {simplex} names vertex {vertex}; expected less than {vertices}")]
    VertexOutOfRange {
        /// The simplex, in the order given.
        simplex: usize,
        /// The vertex that it names.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A simplex names a vertex twice.
    #[error("simplex {simplex} names vertex {vertex} twice")]
    RepeatedVertex {
        /// The simplex, in the order given.
        simplex: usize,
        /// The vertex named twice.
        vertex: u32,
    },
    /// Two simplices have the same vertices.
    #[error("simplices {first} and {second} have the same vertices")]
    DuplicateSimplex {
        /// The first of the two.
        first: usize,
        /// The second of the two.
        second: usize,
    },
    /// More than 32-bit numbers can name.
    #[error("{found} {what}; at most {} can be handled", u32::MAX)]
    TooLarge {
        /// Vertices, corners of simplices, or vertices and ends of edges.
        what: &'static str,
        /// How many there are.
        found: usize,
    },
}

/// A pure simplicial complex of dimension 1, 2 or 3, with boundary, any number of components and any genus.
///
/// Top simplices keep the order and orientation in which they were given. Edges and triangles are listed once each, by
/// rising vertices, in lexicographic order. Non-manifold edges and vertices are allowed.
#[derive(Debug, Clone)]
pub struct SimplicialComplex {
    dimension: usize,
    points: Vec<[f64; 3]>,
    /// Top simplices, `dimension + 1` vertices each.
    simplices: Vec<u32>,
    edges: Vec<[VertexId; 2]>,
    /// Empty for dimension 1. For dimension 2 they are the top simplices again, sorted.
    triangles: Vec<[VertexId; 3]>,
    /// First triangle of each lowest vertex, and the number of triangles.
    triangle_offsets: Vec<u32>,
    neighbour_offsets: Vec<u32>,
    neighbours: Vec<VertexId>,
    incident_edges: Vec<EdgeId>,
    /// Top simplices at each vertex.
    star: Star,
}

impl SimplicialComplex {
    /// Builds a complex and its incidence.
    ///
    /// # Arguments
    /// * `dimension`: 1, 2 or 3.
    /// * `points`: `n x 3` positions, in the units of the file.
    /// * `simplices`: `m x (dimension + 1)` vertex numbers, flat. Vertices of no simplex are allowed; they have no
    ///   neighbours.
    ///
    /// # Errors
    /// [`MeshError`] names the first simplex that is out of range, degenerate or given twice.
    ///
    /// # Cost
    /// O(m s log s) for stars of s simplices, in parallel; about 150 bytes a vertex in 2-D.
    pub fn new(dimension: usize, points: Vec<[f64; 3]>, simplices: Vec<u32>) -> Result<Self, MeshError> {
        if !(1..=3).contains(&dimension) {
            return Err(MeshError::Dimension { found: dimension });
        }
        let stride = dimension + 1;
        if !simplices.len().is_multiple_of(stride) {
            return Err(MeshError::Stride { found: simplices.len(), stride });
        }
        check_size("vertices", points.len())?;
        check_size("corners of simplices", simplices.len())?;
        check_corners(points.len(), stride, &simplices)?;
        let star = Star::new(points.len(), stride, &simplices);
        if let Some(&(first, second)) = incidence::duplicates(&star, stride, &simplices).first() {
            return Err(MeshError::DuplicateSimplex { first: first as usize, second: second as usize });
        }
        Self::from_star(dimension, points, simplices, star)
    }

    /// Builds a complex of simplices that are known to be in range, not degenerate and given once.
    pub(super) fn from_star(
        dimension: usize,
        points: Vec<[f64; 3]>,
        simplices: Vec<u32>,
        star: Star,
    ) -> Result<Self, MeshError> {
        let stride = dimension + 1;
        let edges = incidence::edges(&star, stride, &simplices);
        // As many entries as a matrix with an entry for every vertex and two for every edge has.
        check_size("vertices and ends of edges", points.len() + edges.len() * 2)?;
        let triangles = if dimension == 1 { Vec::new() } else { incidence::triangles(&star, stride, &simplices) };
        let triangle_offsets = incidence::group_offsets(points.len(), triangles.iter().map(|triangle| triangle[0]));
        let (neighbour_offsets, neighbours, incident_edges) = incidence::adjacency(points.len(), &edges);
        Ok(Self {
            dimension,
            points,
            simplices,
            edges,
            triangles,
            triangle_offsets,
            neighbour_offsets,
            neighbours,
            incident_edges,
            star,
        })
    }

    /// 1, 2 or 3.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.points.len()
    }

    /// Number of top simplices.
    pub fn simplex_count(&self) -> usize {
        self.simplices.len() / (self.dimension + 1)
    }

    /// Positions, one a vertex.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// Position of a vertex.
    pub fn point(&self, vertex: VertexId) -> [f64; 3] {
        self.points[vertex.index()]
    }

    /// The vertices of top simplex `simplex`, `dimension + 1` numbers, oriented as given.
    pub fn simplex(&self, simplex: usize) -> &[u32] {
        let stride = self.dimension + 1;
        &self.simplices[simplex * stride..(simplex + 1) * stride]
    }

    /// All top simplices, flat, `dimension + 1` numbers each.
    pub fn simplices(&self) -> &[u32] {
        &self.simplices
    }

    /// Edges by rising vertices, sorted; [`EdgeId`] is the place in this list.
    pub fn edges(&self) -> &[[VertexId; 2]] {
        &self.edges
    }

    /// Triangles by rising vertices, sorted; [`TriangleId`] is the place in this list. Empty for dimension 1.
    pub fn triangles(&self) -> &[[VertexId; 3]] {
        &self.triangles
    }

    /// Vertices that share an edge with `vertex`, by rising index.
    pub fn neighbours(&self, vertex: VertexId) -> &[VertexId] {
        &self.neighbours[self.neighbour_range(vertex)]
    }

    /// Edges at `vertex`, in the order of [`Self::neighbours`].
    pub fn incident_edges(&self, vertex: VertexId) -> &[EdgeId] {
        &self.incident_edges[self.neighbour_range(vertex)]
    }

    /// Top simplices at `vertex`, by rising number.
    pub fn star(&self, vertex: VertexId) -> &[u32] {
        self.star.of(vertex.index())
    }

    /// The edge between two vertices, if there is one.
    pub fn edge(&self, a: VertexId, b: VertexId) -> Option<EdgeId> {
        let range = self.neighbour_range(a);
        let position = self.neighbours[range.clone()].binary_search(&b).ok()?;
        Some(self.incident_edges[range.start + position])
    }

    /// The triangle on three vertices in any order, if there is one. O(log t) for t triangles with the same lowest vertex.
    pub fn triangle(&self, mut vertices: [VertexId; 3]) -> Option<TriangleId> {
        vertices.sort_unstable();
        let (first, end) = (self.triangle_offsets[vertices[0].index()], self.triangle_offsets[vertices[0].index() + 1]);
        let group = &self.triangles[first as usize..end as usize];
        group.binary_search(&vertices).ok().map(|position| TriangleId(first + position as u32))
    }

    /// Component of every vertex, numbered by the lowest vertex of each, and the number of components.
    pub fn components(&self) -> (Vec<u32>, usize) {
        const UNSEEN: u32 = u32::MAX;
        let mut component = vec![UNSEEN; self.vertex_count()];
        let mut count = 0;
        let mut stack = Vec::new();
        for seed in 0..self.vertex_count() {
            if component[seed] != UNSEEN {
                continue;
            }
            component[seed] = count;
            stack.push(VertexId::from(seed));
            while let Some(vertex) = stack.pop() {
                for &neighbour in self.neighbours(vertex) {
                    if component[neighbour.index()] == UNSEEN {
                        component[neighbour.index()] = count;
                        stack.push(neighbour);
                    }
                }
            }
            count += 1;
        }
        (component, count as usize)
    }

    /// Diagonal of the axis-parallel bounding box, in the units of the points; 0 without points.
    pub fn bounding_box_diagonal(&self) -> f64 {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for point in &self.points {
            for axis in 0..3 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        if self.points.is_empty() {
            return 0.0;
        }
        (0..3).map(|axis| (high[axis] - low[axis]).powi(2)).sum::<f64>().sqrt()
    }

    fn neighbour_range(&self, vertex: VertexId) -> std::ops::Range<usize> {
        self.neighbour_offsets[vertex.index()] as usize..self.neighbour_offsets[vertex.index() + 1] as usize
    }
}

/// Refuses what 32-bit numbers cannot name.
pub(super) fn check_size(what: &'static str, found: usize) -> Result<(), MeshError> {
    if u32::try_from(found).is_ok() { Ok(()) } else { Err(MeshError::TooLarge { what, found }) }
}

fn check_corners(vertices: usize, stride: usize, simplices: &[u32]) -> Result<(), MeshError> {
    let fault = |(simplex, corners): (usize, &[u32])| {
        corners.iter().enumerate().find_map(|(position, &vertex)| {
            if vertex as usize >= vertices {
                return Some(MeshError::VertexOutOfRange { simplex, vertex, vertices });
            }
            corners[..position].contains(&vertex).then_some(MeshError::RepeatedVertex { simplex, vertex })
        })
    };
    // The first fault in the order given, however the search is split among threads.
    let first = simplices.par_chunks_exact(stride).with_min_len(8192).enumerate().find_map_first(fault);
    first.map_or(Ok(()), Err)
}
