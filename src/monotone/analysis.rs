//! What fits on one mesh have in common, apart from the mesh itself: many threads can fit on it at once.

use crate::mesh::SimplicialComplex;
use crate::operators::OperatorError;
use crate::qp::{Engine, QpError};

use super::energy::Operators;
use super::fit::Fitter;

/// Why a mesh could not be analysed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AnalysisError {
    /// The mesh has no operators.
    #[error(transparent)]
    Operator(#[from] OperatorError),
    /// The solver refused the pattern.
    #[error(transparent)]
    Solver(#[from] QpError),
}

/// The operators of a mesh, the order of elimination and the symbolic analysis of its energies of one order.
///
/// It borrows nothing, so it can be kept beside its mesh and handed from thread to thread: for the steps of a series.
pub struct FitAnalysis {
    operators: Operators,
    engine: Engine,
    order: usize,
}

impl FitAnalysis {
    /// Assembles the operators and analyses the pattern of the energy.
    ///
    /// # Arguments
    /// * `order`: k of all energies that will be minimised, 1 to 4.
    ///
    /// # Errors
    /// [`AnalysisError`].
    ///
    /// # Cost
    /// O(n + m), a fill-reducing ordering and a symbolic analysis.
    pub fn new(complex: &SimplicialComplex, order: usize) -> Result<Self, AnalysisError> {
        let operators = Operators::new(complex)?;
        let engine = Fitter::new(complex, &operators, order)?.into_engine();
        Ok(Self { operators, engine, order })
    }

    /// The order of the energies.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The number of vertices of the mesh.
    pub fn vertices(&self) -> usize {
        self.operators.mass.len()
    }

    /// A fitter with a factor of its own; everything else is shared, not copied.
    ///
    /// # Arguments
    /// * `complex`: the mesh that was analysed, or an equal one.
    ///
    /// # Cost
    /// Memory for one factor and a few vectors; no arithmetic.
    pub fn fitter<'a>(&'a self, complex: &'a SimplicialComplex) -> Fitter<'a> {
        Fitter::with_engine(complex, &self.operators, self.engine.fork())
    }
}
