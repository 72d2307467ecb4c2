//! The heat method: distances from two linear systems whose factors are kept.

use rayon::prelude::*;

use super::error::GeodesicError;
use super::intrinsic::Intrinsic;
use super::source::SurfacePoint;
use super::surface::check_measures;
use crate::field::VertexId;
use crate::linalg::{Cholesky, CsrMatrix, MatrixError, SymbolicCholesky, fill_reducing_order};
use crate::mesh::{SimplicialComplex, minus, norm};
use crate::operators::{cotangent_laplacian, dual_basis, lumped_mass};

/// Simplices or vertices handled by one parallel task. Any size gives the same result.
const CHUNK: usize = 4096;

/// The triangles between which heat flows on a surface. Vertices and distances are the same on both.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum HeatTriangles {
    /// Those of the intrinsic Delaunay triangulation: edges are flipped within the surface until no two angles opposite to one exceed a half
    /// turn together (Bobenko, Springborn 2007). Slivers and obtuse angles do less harm.
    #[default]
    IntrinsicDelaunay,
    /// Those of the mesh.
    Given,
}

/// What happens to heat at a boundary.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum HeatBoundary {
    /// The mean of the flows with insulated (Neumann) and with cold (Dirichlet) boundary, as Crane et al. 2013 propose: closer by a fifth behind
    /// holes and slits of a square.
    #[default]
    Mean,
    /// No heat leaves (Neumann): one factorisation less, and closer where much of a surface is near its boundary (by a quarter on a scanned beetle,
    /// by 20 to 70 % on strips and around corners).
    Insulated,
}

/// How far heat flows, between which triangles, and what happens to it at a boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeatOptions {
    /// Time of the flow in units of the squared mean length of the edges; 1 by default. A longer time gives a smoother, less accurate
    /// distance.
    pub time: f64,
    /// The triangles, on surfaces.
    pub triangles: HeatTriangles,
    /// The boundary, where there is one.
    pub boundary: HeatBoundary,
}

impl Default for HeatOptions {
    fn default() -> Self {
        Self { time: 1.0, triangles: HeatTriangles::default(), boundary: HeatBoundary::default() }
    }
}

/// Distances by the heat method, for many sources one after the other: what depends on the mesh only is factored once.
///
/// Heat flows from the sources for a short time t: `(M + t L) u = δ`. Its normalised negative gradient X is nearly that of the distance φ,
/// which is found from `L φ = div X`. On domains with a boundary u is what
/// [`HeatBoundary`] says.
///
/// The distance is smooth and approximate: of first order in the length of the edges on regular meshes. It obeys no bound, and it is
/// sensitive to obtuse angles, the less so on the intrinsic Delaunay triangulation of a surface; [`ExactGeodesic`](super::ExactGeodesic) is
/// exact.
///
/// # Example
/// ```
/// use morsmooth::{field::VertexId, geodesic::{HeatGeodesic, HeatOptions, SurfacePoint}, mesh::{Domain, Grid, Mask}};
/// let square = Domain::from_grid(&Grid::image([41, 41, 1], [0.0; 3], [0.025; 3]), &Mask::none())?.complex;
/// let mut heat = HeatGeodesic::new(&square, HeatOptions::default())?;
/// let distances = heat.distances(&[SurfacePoint::Vertex(VertexId(20 * 41 + 20))])?; // the centre
/// assert!((distances[20 * 41 + 40] - 0.5).abs() < 0.02); // the middle of a side
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct HeatGeodesic<'a> {
    complex: &'a SimplicialComplex,
    /// The triangles, where they are others than those of the complex.
    flat: Option<Flat>,
    components: Vec<u32>,
    symbolic: SymbolicCholesky,
    insulated: Cholesky,
    /// Only where there is a boundary that takes part in the mean.
    cold: Option<Cholesky>,
    /// Whether a vertex is on the boundary.
    is_boundary: Vec<bool>,
    poisson: Cholesky,
    /// The vertex of each component whose distance is set to 0 while the second system is solved.
    pins: Vec<u32>,
}

impl<'a> HeatGeodesic<'a> {
    /// Assembles and factors the matrices.
    ///
    /// # Arguments
    /// * `complex`: curves, triangles or tetrahedra; edges of more than two triangles are allowed.
    ///
    /// # Errors
    /// [`GeodesicError::Number`], [`GeodesicError::Operator`] for a simplex of zero measure, [`GeodesicError::Factor`].
    ///
    /// # Cost
    /// A fill-reducing ordering and two sparse factorisations, three with a boundary.
    ///
    /// # Source
    /// Crane, Weischedel, Wardetzky 2013, *Geodesics in heat*; the time and the mean of boundary conditions are theirs. On intrinsic Delaunay
    /// triangulations: Sharp, Soliman, Crane 2019, *Navigating intrinsic triangulations*.
    pub fn new(complex: &'a SimplicialComplex, options: HeatOptions) -> Result<Self, GeodesicError> {
        if !(options.time.is_finite() && options.time > 0.0) {
            return Err(GeodesicError::Number { what: "time of the heat flow", found: options.time });
        }
        let flat = match (options.triangles, complex.dimension()) {
            (HeatTriangles::IntrinsicDelaunay, 2) => {
                check_measures(complex)?;
                // A mesh that is Delaunay already is taken as it is.
                Some(Intrinsic::of(complex).flipped()).filter(|intrinsic| intrinsic.flips > 0).map(|intrinsic| Flat::new(intrinsic, complex))
            }
            _ => None,
        };
        let (laplacian, mass, edge) = match &flat {
            Some(flat) => (flat.laplacian()?, flat.mass(), flat.mean_edge_length()),
            None => (cotangent_laplacian(complex)?, lumped_mass(complex)?, mean_edge_length(complex)),
        };
        let time = options.time * edge.powi(2);
        let order = fill_reducing_order(&laplacian, Some(complex.points()))?;
        let symbolic = SymbolicCholesky::new(&laplacian, order)?;
        let slots = slots(&laplacian, &symbolic)?;
        let is_boundary = boundary(complex);
        let (components, count) = complex.components();
        let mut pins = vec![u32::MAX; count];
        for (vertex, &component) in components.iter().enumerate().rev() {
            pins[component as usize] = vertex as u32;
        }
        let is_pin = |vertex: usize| pins[components[vertex] as usize] as usize == vertex;
        let is_isolated = |vertex: usize| complex.star(VertexId::from(vertex)).is_empty();

        let factor = |entry: &dyn Fn(usize, usize, f64) -> f64, is_fixed: &dyn Fn(usize) -> bool| {
            let mut values = vec![0.0; symbolic.entries()];
            let mut place = 0;
            for row in 0..laplacian.rows() {
                let (columns, entries) = laplacian.row(row);
                for (&column, &value) in columns.iter().zip(entries) {
                    let column = column as usize;
                    let is_cut = is_fixed(row) || is_fixed(column);
                    let value = if is_cut { f64::from(u8::from(row == column)) } else { entry(row, column, value) };
                    if let Some(slot) = slots[place] {
                        values[slot as usize] = value;
                    }
                    place += 1;
                }
            }
            let mut factor = Cholesky::new(&symbolic, 1);
            factor.factor(&symbolic, &values).map(|()| factor)
        };
        let flow = |row: usize, column: usize, value: f64| time * value + if row == column { mass[row] } else { 0.0 };
        let insulated = factor(&flow, &is_isolated)?;
        let cold = match options.boundary == HeatBoundary::Mean && is_boundary.contains(&true) {
            true => Some(factor(&flow, &|vertex| is_isolated(vertex) || is_boundary[vertex])?),
            false => None,
        };
        let poisson = factor(&|_, _, value| value, &|vertex| is_isolated(vertex) || is_pin(vertex))?;
        Ok(Self { complex, flat, components, symbolic, insulated, cold, is_boundary, poisson, pins })
    }

    /// Edges that were flipped for the intrinsic Delaunay triangulation.
    pub fn flips(&self) -> usize {
        self.flat.as_ref().map_or(0, |flat| flat.intrinsic.flips)
    }

    /// The approximate distance of every vertex from the nearest of several sources.
    ///
    /// # Arguments
    /// * `sources`: vertices, and on triangles also points of edges and faces, whose heat goes to their corners.
    ///
    /// # Returns
    /// `n` distances in the units of the points, shifted so that the least one at a corner of a source is that of the source;
    /// **infinite** at vertices that no path from a source reaches.
    ///
    /// # Errors
    /// [`GeodesicError::NoSource`], what is wrong with a source, and [`GeodesicError::HeatVanished`] where so little heat arrives that its
    /// direction is lost: about 700 edges from the source at time 1.
    ///
    /// # Cost
    /// Two or three solves with kept factors and O(m), in parallel.
    pub fn distances(&mut self, sources: &[SurfacePoint]) -> Result<Vec<f64>, GeodesicError> {
        if sources.is_empty() {
            return Err(GeodesicError::NoSource);
        }
        let vertices = self.complex.vertex_count();
        let mut impulse = vec![0.0; vertices];
        // The distance of a corner from its source, for the shift.
        let mut anchors = Vec::new();
        for (number, source) in sources.iter().enumerate() {
            let source = source.simplest(self.complex, number)?;
            let position = source.position(self.complex);
            for (vertex, weight) in source.corners(self.complex) {
                impulse[vertex.index()] += weight;
                anchors.push((vertex, norm(minus(self.complex.point(vertex), position))));
            }
        }
        let mut heat = impulse.clone();
        self.insulated.solve_in_place(&self.symbolic, &mut heat);
        if let Some(cold) = &mut self.cold {
            let mut other = impulse;
            other.iter_mut().zip(&self.is_boundary).filter(|(_, is_boundary)| **is_boundary).for_each(|(value, _)| *value = 0.0);
            cold.solve_in_place(&self.symbolic, &mut other);
            // The factor of the mean does not matter: only the direction of the gradient is used.
            heat.iter_mut().zip(&other).for_each(|(value, other)| *value += other);
        }
        let count = self.pins.len();
        let mut is_reached = vec![false; count];
        anchors.iter().for_each(|(vertex, _)| is_reached[self.components[vertex.index()] as usize] = true);

        let mut distances = self.divergence(&heat, &is_reached)?;
        self.pins.iter().for_each(|&pin| distances[pin as usize] = 0.0);
        self.poisson.solve_in_place(&self.symbolic, &mut distances);
        let mut shift = vec![f64::NEG_INFINITY; count];
        for &(vertex, distance) in &anchors {
            let slot = &mut shift[self.components[vertex.index()] as usize];
            *slot = slot.max(distance - distances[vertex.index()]);
        }
        for (distance, &component) in distances.iter_mut().zip(&self.components) {
            let component = component as usize;
            *distance = if is_reached[component] { *distance + shift[component] } else { f64::INFINITY };
        }
        Ok(distances)
    }

    /// `∫ X · ∇ψ_i` for every vertex, X the normalised negative gradient of the heat.
    fn divergence(&self, heat: &[f64], is_reached: &[bool]) -> Result<Vec<f64>, GeodesicError> {
        let complex = self.complex;
        let simplices = (0..complex.simplex_count()).into_par_iter().with_min_len(CHUNK);
        let shares: Vec<Option<[f64; 4]>> = simplices
            .map(|simplex| match &self.flat {
                Some(Flat { intrinsic, .. }) => {
                    share(&intrinsic.corners[simplex], &intrinsic.gradients(simplex), intrinsic.area(simplex), heat)
                }
                None => share(complex.simplex(simplex), &dual_basis(complex, simplex), complex.measure(simplex), heat),
            })
            .collect();
        let first = |simplex: usize| self.flat.as_ref().map_or(complex.simplex(simplex)[0], |flat| flat.intrinsic.corners[simplex][0]);
        let lost = |simplex: &usize| shares[*simplex].is_none() && is_reached[self.components[first(*simplex) as usize] as usize];
        if let Some(simplex) = (0..shares.len()).find(lost) {
            return Err(GeodesicError::HeatVanished { vertex: VertexId(first(simplex)) });
        }
        let gathered = |vertex: usize| match &self.flat {
            Some(flat) => {
                let own = |&corner: &u32| shares[corner as usize / 3].map(|share| share[corner as usize % 3]);
                flat.corners_at(vertex).iter().filter_map(own).sum::<f64>()
            }
            None => {
                let own = |&simplex: &u32| {
                    let corner = complex.simplex(simplex as usize).iter().position(|&corner| corner as usize == vertex)?;
                    shares[simplex as usize].map(|share| share[corner])
                };
                complex.star(VertexId::from(vertex)).iter().filter_map(own).sum::<f64>()
            }
        };
        Ok((0..complex.vertex_count()).into_par_iter().with_min_len(CHUNK).map(gathered).collect())
    }
}

/// An intrinsic triangulation with the corners at every vertex.
struct Flat {
    intrinsic: Intrinsic,
    offsets: Vec<u32>,
    /// Corners, three times their triangle plus their number, vertex by vertex and rising.
    corners: Vec<u32>,
}

impl Flat {
    fn new(intrinsic: Intrinsic, complex: &SimplicialComplex) -> Self {
        let all = intrinsic.corners.as_flattened();
        let mut offsets = vec![0u32; complex.vertex_count() + 1];
        all.iter().for_each(|&vertex| offsets[vertex as usize + 1] += 1);
        (1..offsets.len()).for_each(|at| offsets[at] += offsets[at - 1]);
        let mut corners: Vec<u32> = (0..all.len() as u32).collect();
        // Stable: corners of a vertex stay in their order.
        corners.sort_by_key(|&corner| all[corner as usize]);
        Self { intrinsic, offsets, corners }
    }

    fn corners_at(&self, vertex: usize) -> &[u32] {
        &self.corners[self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize]
    }

    /// The positive semi-definite cotangent Laplacian.
    fn laplacian(&self) -> Result<CsrMatrix, MatrixError> {
        let n = self.offsets.len() - 1;
        let mut triplets = Vec::with_capacity(12 * self.intrinsic.corners.len() + n);
        // The diagonal has its place even at vertices of no triangle.
        triplets.extend((0..n as u32).map(|vertex| (vertex, vertex, 0.0)));
        for (triangle, corners) in self.intrinsic.corners.iter().enumerate() {
            let cotangents = self.intrinsic.cotangents(triangle);
            for (side, cotangent) in cotangents.into_iter().enumerate() {
                let (a, b, weight) = (corners[side], corners[(side + 1) % 3], 0.5 * cotangent);
                // A loop has no gradient along itself.
                if a != b {
                    triplets.extend([(a, a, weight), (b, b, weight), (a, b, -weight), (b, a, -weight)]);
                }
            }
        }
        CsrMatrix::from_triplets(n, n, &triplets)
    }

    /// A third of the area of every triangle at each of its corners.
    fn mass(&self) -> Vec<f64> {
        let areas: Vec<f64> = (0..self.intrinsic.corners.len()).map(|triangle| self.intrinsic.area(triangle) / 3.0).collect();
        let mass = |vertex: usize| self.corners_at(vertex).iter().map(|&corner| areas[corner as usize / 3]).sum();
        (0..self.offsets.len() - 1).map(mass).collect()
    }

    /// Inner edges count twice, as they do in every triangulation of a closed surface.
    fn mean_edge_length(&self) -> f64 {
        let lengths = self.intrinsic.lengths.as_flattened();
        self.intrinsic.scale * lengths.iter().sum::<f64>() / lengths.len().max(1) as f64
    }
}

/// What a simplex adds to the divergence at each of its corners; `None` without a direction of the heat.
///
/// # Arguments
/// * `basis`: the gradients of the barycentric coordinates of all corners but the first.
fn share(corners: &[u32], basis: &[[f64; 3]; 3], measure: f64, heat: &[f64]) -> Option<[f64; 4]> {
    let dimension = corners.len() - 1;
    let most = corners.iter().fold(0.0f64, |most, &corner| most.max(heat[corner as usize].abs()));
    // Below, digits are lost.
    if most < f64::MIN_POSITIVE / f64::EPSILON {
        return None;
    }
    let mut gradient = [0.0; 3];
    for (dual, &corner) in basis.iter().zip(&corners[1..]) {
        // Heat falls by many orders of magnitude; only ratios within a simplex matter.
        let rise = heat[corner as usize] / most - heat[corners[0] as usize] / most;
        gradient.iter_mut().zip(dual).for_each(|(slot, part)| *slot += rise * part);
    }
    let length = norm(gradient);
    let mut share = [0.0; 4];
    if length > 0.0 {
        for (corner, dual) in basis[..dimension].iter().enumerate() {
            let flow: f64 = dual.iter().zip(gradient).map(|(part, slope)| -part * slope / length * measure).sum();
            share[corner + 1] = flow;
            share[0] -= flow;
        }
    }
    Some(share)
}

fn mean_edge_length(complex: &SimplicialComplex) -> f64 {
    let edges = complex.edges();
    let total: f64 = edges.iter().map(|&[a, b]| norm(minus(complex.point(a), complex.point(b)))).sum();
    if edges.is_empty() { 1.0 } else { total / edges.len() as f64 }
}

/// Where each entry of a matrix goes in the values of its factor; `None` for the triangle that is not stored.
fn slots(matrix: &CsrMatrix, symbolic: &SymbolicCholesky) -> Result<Vec<Option<u32>>, GeodesicError> {
    let mut slots = Vec::with_capacity(matrix.entries());
    for row in 0..matrix.rows() {
        for &column in matrix.row(row).0 {
            let column = column as usize;
            slots.push(if symbolic.is_stored(row, column) { Some(symbolic.slot(row, column)?) } else { None });
        }
    }
    Ok(slots)
}

/// Whether each vertex is on the boundary: on a facet of one simplex only.
fn boundary(complex: &SimplicialComplex) -> Vec<bool> {
    let stride = complex.dimension() + 1;
    let mut facets: Vec<[u32; 3]> = Vec::with_capacity(complex.simplices().len());
    for simplex in complex.simplices().chunks_exact(stride) {
        for left_out in 0..stride {
            let mut facet = [u32::MAX; 3];
            let rest = simplex.iter().enumerate().filter(|&(corner, _)| corner != left_out);
            facet.iter_mut().zip(rest).for_each(|(slot, (_, &vertex))| *slot = vertex);
            facet.sort_unstable();
            facets.push(facet);
        }
    }
    facets.par_sort_unstable();
    let mut is_boundary = vec![false; complex.vertex_count()];
    for group in facets.chunk_by(|a, b| a == b).filter(|group| group.len() == 1) {
        group[0].iter().filter(|&&vertex| vertex != u32::MAX).for_each(|&vertex| is_boundary[vertex as usize] = true);
    }
    is_boundary
}
