//! Handles on a rest shape, and the convex problem for given rotations and targets.

use super::rest::finite;
use super::{DeformEnergy, DeformError, RestShape, cones};
use crate::field::VertexId;
use crate::linalg::CsrMatrix;
use crate::mesh::SimplicialComplex;
use crate::qp::{Cone, Constraints, Objective, Problem, Term};

/// How handles hold their vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hold {
    /// The vertices are drawn to their targets by `alpha |x_v - d_v|²`; always has a solution for feasible rotations.
    Soft {
        /// alpha, positive, in energy per squared length; the paper takes 1e4 everywhere.
        alpha: f64,
    },
    /// The vertices are at their targets. Handles that contradict each other make the problem infeasible.
    Hard,
}

/// What the energy and the cones weigh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeformOptions {
    /// How handles hold.
    pub hold: Hold,
    /// nu, the weight of linearised incompressibility, not negative; 0 leaves it out.
    pub incompressibility: f64,
    /// Margin of each element, as a multiple of what rounding its corners to 32-bit numbers can take ([`RestShape::rounding`]), not
    /// negative.
    pub margin: f64,
}

impl Default for DeformOptions {
    /// Soft handles with alpha = 1e4, no incompressibility, twice the rounding.
    fn default() -> Self {
        Self { hold: Hold::Soft { alpha: 1e4 }, incompressibility: 0.0, margin: 2.0 }
    }
}

/// A rest shape with handles: everything that depends on neither rotations nor targets.
///
/// One [`Engine`](crate::qp::Engine) serves all its problems, since rotations and targets move numbers but no pattern.
///
/// # Example
/// ```
/// use morsmooth::{deform::{DeformOptions, Deformer}, mesh::SimplicialComplex};
/// // Two triangles of a unit square, held at two corners, stay at rest for rotations that are the identity.
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let square = SimplicialComplex::new(2, points.clone(), vec![0, 1, 2, 0, 2, 3])?;
/// let deformer = Deformer::new(&square, &[0.into(), 2.into()], DeformOptions::default())?;
/// let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let problem = deformer.problem(&[identity; 2], &[points[0], points[2]])?;
/// assert_eq!(problem.objective.value(&[0.0; 8]), 0.0);
/// let positions = deformer.positions(&[points[0], points[2]], &[0.0; 8])?;
/// assert_eq!(deformer.rest().determinants(&positions)?, [1.0, 1.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Deformer {
    rest: RestShape,
    handles: Vec<VertexId>,
    options: DeformOptions,
    stiffness: CsrMatrix,
    /// Largest absolute rest coordinate.
    extent: f64,
}

impl Deformer {
    /// Prepares a mesh.
    ///
    /// # Arguments
    /// * `complex`: `n` vertices; triangles in a plane z = constant, or tetrahedra. Vertices of no element must be handles.
    /// * `handles`: the vertices that are held, each once, at least one in every connected part.
    ///
    /// # Errors
    /// As [`RestShape::new`]; [`DeformError::Handle`], [`DeformError::NoHandle`]; [`DeformError::Number`] for an option out of range;
    /// [`DeformError::TooLarge`].
    ///
    /// # Cost
    /// O(m log m) for m elements.
    pub fn new(complex: &SimplicialComplex, handles: &[VertexId], options: DeformOptions) -> Result<Self, DeformError> {
        Self::with_rest(RestShape::new(complex)?, handles, options)
    }

    /// As [`Deformer::new`], with a rest shape of one's own, such as [`RestShape::untangled`].
    ///
    /// # Errors
    /// As [`Deformer::new`].
    pub fn with_rest(rest: RestShape, handles: &[VertexId], options: DeformOptions) -> Result<Self, DeformError> {
        check_options(options)?;
        let dimension = rest.dimension();
        let entries = rest.element_count() * cones::block(dimension) * (dimension + 1) * dimension;
        if u32::try_from(entries).is_err() {
            return Err(DeformError::TooLarge { found: entries });
        }
        check_handles(&rest, handles)?;
        let extent = rest.positions().iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        Ok(Self { stiffness: rest.stiffness()?, handles: handles.to_vec(), rest, options, extent })
    }

    /// The rest shape.
    pub fn rest(&self) -> &RestShape {
        &self.rest
    }

    /// The vertices that are held.
    pub fn handles(&self) -> &[VertexId] {
        &self.handles
    }

    /// What the energy and the cones weigh.
    pub fn options(&self) -> DeformOptions {
        self.options
    }

    /// The rest position of the vertex of each unknown, for the order of elimination.
    pub fn coordinates(&self) -> Vec<[f64; 3]> {
        self.rest.points().iter().flat_map(|&point| std::iter::repeat_n(point, self.rest.dimension())).collect()
    }

    /// eps of every element: the options' multiple of its rounding, for coordinates as large as those of the rest shape and the targets.
    ///
    /// # Arguments
    /// * `targets`: a place for each handle.
    pub fn margins(&self, targets: &[[f64; 3]]) -> Vec<f64> {
        let dimension = self.rest.dimension();
        let extent = targets.iter().flat_map(|target| &target[..dimension]).fold(self.extent, |most, value| most.max(value.abs()));
        (0..self.rest.element_count()).map(|element| self.options.margin * self.rest.rounding(element, extent)).collect()
    }

    /// The positions from which the problem counts displacements: targets at handles, rest positions elsewhere.
    ///
    /// Counted from here, soft handles have no linear term and no constant. Those of positions themselves are alpha, 1e4, times larger than the
    /// energy, and their cancellation would hide it.
    ///
    /// # Arguments
    /// * `targets`: a place for each handle.
    ///
    /// # Errors
    /// [`DeformError::Length`], [`DeformError::Number`].
    pub fn reference(&self, targets: &[[f64; 3]]) -> Result<Vec<f64>, DeformError> {
        self.check_targets(targets)?;
        let mut reference = self.rest.positions();
        self.held(targets).for_each(|(place, target)| reference[place] = target);
        Ok(reference)
    }

    /// The convex problem for given rotations and targets.
    ///
    /// # Arguments
    /// * `rotations`: one rotation an element, by rows; in 2-D the leading 2 x 2 block is read.
    /// * `targets`: a place for each handle; in 2-D the third coordinate is not read.
    ///
    /// # Returns
    /// A problem whose unknowns are displacements from [`Deformer::reference`], `x[vertex * dim + axis]`, with one semidefinite block an
    /// element, in the order of the elements. Its objective is the energy, constant included.
    ///
    /// # Errors
    /// [`DeformError::Length`], [`DeformError::Number`], [`DeformError::NotARotation`].
    ///
    /// # Cost
    /// O(m), the rows in parallel.
    pub fn problem(&self, rotations: &[[[f64; 3]; 3]], targets: &[[f64; 3]]) -> Result<Problem, DeformError> {
        self.rest.check_rotations(rotations)?;
        let reference = self.reference(targets)?;
        let (dimension, unknowns) = (self.rest.dimension(), self.stiffness.rows());
        let nu = self.options.incompressibility;
        let linear = self.rest.forces(nu, rotations, &reference);
        let constant = self.energy(rotations, targets, &reference)?.total();
        // Differences keep the digits that a formed matrix loses.
        let elastic = Term::Chain { scale: 1.0, stiffness: self.stiffness.clone(), weights: vec![1.0; unknowns], order: 1 };
        let mut terms = vec![elastic];
        if nu > 0.0 {
            let traces = self.rest.traces(rotations);
            let weights: Vec<f64> = self.rest.measures().iter().map(|measure| nu * measure).collect();
            terms.push(Term::Matrix(traces.transpose().weighted_product(&weights, &traces)));
        }
        let mut fixed = vec![None; unknowns];
        match self.options.hold {
            Hold::Soft { alpha } => {
                let mut diagonal = vec![0.0; unknowns];
                self.held(targets).for_each(|(place, _)| diagonal[place] = 2.0 * alpha);
                terms.push(Term::Diagonal(diagonal));
            }
            Hold::Hard => self.held(targets).for_each(|(place, _)| fixed[place] = Some(0.0)),
        }
        let elements = self.rest.element_count();
        let constraints = Constraints {
            matrix: cones::matrix(&self.rest, rotations),
            offset: cones::offset(&self.rest, rotations, &self.margins(targets), &reference),
            cones: vec![if dimension == 2 { Cone::Psd2(elements) } else { Cone::Psd3(elements) }],
        };
        Ok(Problem { objective: Objective { terms, linear, constant }, fixed, constraints })
    }

    /// Positions from displacements.
    ///
    /// # Arguments
    /// * `targets`: those of the problem; `displacements`: its unknowns, `n x dim`.
    ///
    /// # Errors
    /// [`DeformError::Length`], [`DeformError::Number`].
    pub fn positions(&self, targets: &[[f64; 3]], displacements: &[f64]) -> Result<Vec<f64>, DeformError> {
        self.rest.check_positions(displacements)?;
        let mut positions = self.reference(targets)?;
        positions.iter_mut().zip(displacements).for_each(|(slot, displacement)| *slot += displacement);
        Ok(positions)
    }

    /// The energy of given positions, summed from squares, so that nothing cancels.
    ///
    /// # Arguments
    /// * `rotations`, `targets`: as for [`Deformer::problem`]; `positions`: `n x dim` coordinates.
    ///
    /// # Errors
    /// As [`Deformer::problem`].
    pub fn energy(
        &self,
        rotations: &[[[f64; 3]; 3]],
        targets: &[[f64; 3]],
        positions: &[f64],
    ) -> Result<DeformEnergy, DeformError> {
        self.rest.check_rotations(rotations)?;
        self.check_targets(targets)?;
        self.rest.check_positions(positions)?;
        let strains = self.rest.strains(rotations, positions);
        let sum = |part: usize| strains.iter().zip(self.rest.measures()).map(|(strain, v)| 0.5 * v * strain[part]).sum::<f64>();
        let handles = match self.options.hold {
            Hold::Soft { alpha } => self.held(targets).map(|(place, target)| alpha * (positions[place] - target).powi(2)).sum(),
            Hold::Hard => 0.0,
        };
        Ok(DeformEnergy { elastic: sum(0), volume: self.options.incompressibility * sum(1), handles })
    }

    /// `1/2 (|F_i - R_i|² + nu (trace(R_iᵀ F_i) - dim)²)` of every element: energy by rest measure.
    ///
    /// # Errors
    /// [`DeformError::Length`], [`DeformError::Number`], [`DeformError::NotARotation`].
    pub fn energy_densities(&self, rotations: &[[[f64; 3]; 3]], positions: &[f64]) -> Result<Vec<f64>, DeformError> {
        self.rest.check_rotations(rotations)?;
        self.rest.check_positions(positions)?;
        let nu = self.options.incompressibility;
        Ok(self.rest.strains(rotations, positions).iter().map(|strain| 0.5 * (strain[0] + nu * strain[1])).collect())
    }

    /// Unknown and target value of each held coordinate.
    fn held<'a>(&'a self, targets: &'a [[f64; 3]]) -> impl Iterator<Item = (usize, f64)> + 'a {
        let dimension = self.rest.dimension();
        self.handles.iter().zip(targets).flat_map(move |(vertex, target)| {
            (0..dimension).map(move |axis| (vertex.index() * dimension + axis, target[axis]))
        })
    }

    fn check_targets(&self, targets: &[[f64; 3]]) -> Result<(), DeformError> {
        if targets.len() != self.handles.len() {
            return Err(DeformError::Length { what: "targets", expected: self.handles.len(), found: targets.len() });
        }
        let dimension = self.rest.dimension();
        match targets.iter().position(|target| finite("", &target[..dimension]).is_err()) {
            Some(index) => {
                let value = targets[index][..dimension].iter().copied().find(|part| !part.is_finite()).unwrap_or(f64::NAN);
                Err(DeformError::Number { what: "target", index, value, expected: "a finite place" })
            }
            None => Ok(()),
        }
    }
}

fn check_options(options: DeformOptions) -> Result<(), DeformError> {
    let alpha = if let Hold::Soft { alpha } = options.hold { alpha } else { 1.0 };
    if !(alpha > 0.0 && alpha.is_finite()) {
        return Err(DeformError::Number { what: "alpha, option", index: 0, value: alpha, expected: "a positive number" });
    }
    for (what, value) in [("incompressibility, option", options.incompressibility), ("margin, option", options.margin)] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(DeformError::Number { what, index: 0, value, expected: "a number not below zero" });
        }
    }
    Ok(())
}

fn check_handles(rest: &RestShape, handles: &[VertexId]) -> Result<(), DeformError> {
    let mut held = vec![false; rest.vertex_count()];
    let first = rest.first_of_parts();
    let mut reached = vec![false; first.len()];
    for (handle, &vertex) in handles.iter().enumerate() {
        let expected = match held.get(vertex.index()) {
            None => "a vertex of the mesh was expected",
            Some(true) => "each vertex at most once was expected",
            Some(false) => {
                held[vertex.index()] = true;
                reached[rest.parts[vertex.index()] as usize] = true;
                continue;
            }
        };
        return Err(DeformError::Handle { handle, vertex, expected });
    }
    match reached.iter().position(|&reached| !reached) {
        Some(part) => Err(DeformError::NoHandle { vertex: first[part] }),
        None => Ok(()),
    }
}
