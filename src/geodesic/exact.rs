//! Exact distances on a triangle mesh.

use super::error::GeodesicError;
use super::source::SurfacePoint;
use super::surface::Surface;
use super::wavefront::Wavefront;
use crate::mesh::SimplicialComplex;
use rayon::prelude::*;

/// Exact distances along a triangle mesh, for many sources one after the other: what depends on the mesh only is made once.
///
/// The distance of two points is the length of the shortest path on the triangles between them: straight in every triangle
/// and across every edge, bent at most at vertices whose angles sum to more than a full turn, or at the boundary.
///
/// # Example
/// ```
/// use morsmooth::{field::VertexId, geodesic::{ExactGeodesic, SurfacePoint}, mesh::SimplicialComplex};
/// // Two triangles of a square.
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let square = SimplicialComplex::new(2, points, vec![0, 1, 3, 1, 2, 3])?;
/// let geodesic = ExactGeodesic::new(&square)?;
/// let distances = geodesic.distances(&[SurfacePoint::Vertex(VertexId(0))])?;
/// assert_eq!(distances[1], 1.0);
/// assert!((distances[2] - 2f64.sqrt()).abs() < 1e-15); // across the edge 1-3
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct ExactGeodesic<'a> {
    complex: &'a SimplicialComplex,
    surface: Surface,
}

impl<'a> ExactGeodesic<'a> {
    /// Lays every triangle into a plane and finds the vertices at which shortest paths may bend.
    ///
    /// # Arguments
    /// * `complex`: triangles in the plane or in space, with or without boundary, of any genus, orientable or not.
    ///
    /// # Errors
    /// [`GeodesicError::Dimension`], [`GeodesicError::Operator`] for a triangle of zero area, [`GeodesicError::NonManifoldEdge`]
    /// with the first edge of more than two triangles, [`GeodesicError::TooLarge`].
    ///
    /// # Cost
    /// O(m) for m triangles; 200 bytes a triangle.
    pub fn new(complex: &'a SimplicialComplex) -> Result<Self, GeodesicError> {
        Ok(Self { complex, surface: Surface::new(complex)? })
    }

    /// The distance of every vertex from the nearest of several sources.
    ///
    /// # Arguments
    /// * `sources`: vertices, points of edges, points of faces.
    ///
    /// # Returns
    /// `n` distances in the units of the points, exact but for rounding; **infinite** at vertices that no path from a source
    /// reaches: those of other components, and those of no triangle.
    ///
    /// # Errors
    /// [`GeodesicError::NoSource`], or what is wrong with a source.
    ///
    /// # Cost
    /// O(w log m) for w windows, about ten to fifty a triangle on usual meshes, O(m²) at worst; on one thread.
    ///
    /// # Source
    /// Windows: Mitchell, Mount, Papadimitriou 1987, *The discrete geodesic problem*. Their lower envelope on a side: Surazhsky et al.
    /// 2005. The test against distances of vertices: Xin, Wang 2009, *Improving Chen and Han's algorithm*. All windows of a side
    /// cross its triangle together: Qin et al. 2016, *Triangle-oriented wavefront propagation*.
    pub fn distances(&self, sources: &[SurfacePoint]) -> Result<Vec<f64>, GeodesicError> {
        if sources.is_empty() {
            return Err(GeodesicError::NoSource);
        }
        let sources: Result<Vec<_>, _> =
            sources.iter().enumerate().map(|(number, source)| source.simplest(self.complex, number)).collect();
        Ok(Wavefront::new(self.complex, &self.surface, &sources?).run())
    }

    /// The distances from each of several sets of sources, computed side by side on all threads.
    ///
    /// # Arguments, Errors
    /// As [`Self::distances`], for each set.
    ///
    /// # Returns
    /// One list of `n` distances a set, the same bits as alone.
    ///
    /// # Cost
    /// That of [`Self::distances`] for each, shared by the threads.
    pub fn distances_each(&self, sets: &[Vec<SurfacePoint>]) -> Result<Vec<Vec<f64>>, GeodesicError> {
        sets.par_iter().map(|sources| self.distances(sources)).collect()
    }
}

/// The exact distance of every vertex from the nearest source: [`ExactGeodesic`] for one use.
///
/// # Arguments, Returns, Errors, Cost, Source
/// As [`ExactGeodesic::new`] and [`ExactGeodesic::distances`].
pub fn exact_distances(complex: &SimplicialComplex, sources: &[SurfacePoint]) -> Result<Vec<f64>, GeodesicError> {
    ExactGeodesic::new(complex)?.distances(sources)
}
