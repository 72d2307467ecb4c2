//! The methods and what may be asked of them.

use crate::field::Precision;
use crate::mesh::SimplicialComplex;
use crate::monotone::Operators;
use crate::operators::{OperatorError, mixed_voronoi_mass};

/// How a function is found from boundary values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Least Dirichlet energy, whatever the order asked for. Not smooth at the given values; within their range where no angle of the mesh
    /// is obtuse.
    Harmonic,
    /// Least energy of the order asked for, no other constraint (Botsch and Kobbelt 2004).
    Polyharmonic,
    /// Least energy within bounds (Jacobson, Baran, Popović, Sorkine 2011).
    Bounded,
    /// Least energy without any extremum but at given values (Jacobson, Weinkauf, Sorkine 2012).
    #[default]
    Monotone,
}

impl std::fmt::Display for Method {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Harmonic => "harmonic",
            Self::Polyharmonic => "polyharmonic",
            Self::Bounded => "bounded",
            Self::Monotone => "monotone",
        })
    }
}

/// The lumped mass between the Laplacians of an energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mass {
    /// Mixed Voronoi areas on triangles (Meyer, Desbrun, Schröder, Barr 2003), equal shares in other dimensions: the choice of the papers
    /// and of libigl.
    #[default]
    Voronoi,
    /// Equal shares of every simplex to its corners.
    Barycentric,
}

impl Mass {
    /// Laplacian and this mass.
    pub(super) fn operators(self, complex: &SimplicialComplex) -> Result<Operators, OperatorError> {
        let operators = Operators::new(complex)?;
        Ok(match self {
            Self::Barycentric => operators,
            Self::Voronoi => Operators { mass: mixed_voronoi_mass(complex)?, ..operators },
        })
    }
}

/// The field whose vertex order gives the monotonicity edges their direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Guide {
    /// For orders 1 and 2 the polyharmonic function; for 3 and 4 also the harmonic one, unless the first result is within a per cent of
    /// the least possible energy, and the result with less energy. Measured on planar,
    /// surface and solid meshes: within a per cent of each other at order 2; at order 4 either was up to 2.5 times better.
    #[default]
    Automatic,
    /// The polyharmonic function, flooded to exactly the wanted extrema.
    SmoothThenSimplify,
    /// The harmonic function for positive edge weights (Jacobson, Weinkauf, Sorkine 2012, eq. 15–17).
    Harmonic,
}

/// What may be asked of a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterpolateOptions {
    /// Representative function of [`Method::Monotone`].
    pub guide: Guide,
    /// Times that the solution of [`Method::Monotone`] becomes the representative function of another solve.
    pub refine: usize,
    /// Width in which the result will be stored; [`Method::Monotone`] is strict in it. All values are of this width.
    pub precision: Precision,
    /// Bounds of [`Method::Bounded`]; the range of the given values if absent.
    pub bounds: Option<(f64, f64)>,
    /// Duality gap, relative to the energy, at which a solve ends.
    pub relative_gap: f64,
    /// Most functions that are solved for at the same time; as many as there are threads if absent. Each needs a factor of its own.
    pub at_once: Option<usize>,
}

impl Default for InterpolateOptions {
    fn default() -> Self {
        Self {
            guide: Guide::default(),
            refine: 0,
            precision: Precision::F64,
            bounds: None,
            relative_gap: 1e-6,
            at_once: None,
        }
    }
}

