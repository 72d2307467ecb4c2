//! From a noisy field to a smooth one, in one call.

use std::sync::Arc;

use crate::mesh::SimplicialComplex;
use crate::monotone::ValueRule;
use crate::morse::WantedExtrema;
use crate::qp::Progress;

use super::checks::check_field;
use super::error::SmoothError;
use super::options::SmoothOptions;
use super::report::SmoothReport;
use super::select::MeasuredField;
use super::smoother::Smoother;

/// What [`smooth`] is doing.
#[derive(Debug, Clone)]
pub enum SmoothProgress {
    /// It begins a stage.
    Stage(&'static str),
    /// The solver finished an iteration.
    Solver(Progress),
}

/// A smooth field with exactly the wanted extrema, and the evidence.
#[derive(Debug, Clone)]
pub struct Smoothed {
    /// `n` values of the asked width.
    pub values: Vec<f64>,
    /// The extrema that were wanted, and that the values have.
    pub wanted: WantedExtrema,
    /// What was asked of the value at each vertex.
    pub rules: Vec<ValueRule>,
    /// The field on which extrema were selected, with its extremum pairs.
    pub selected_on: Arc<MeasuredField>,
    /// What was measured.
    pub report: SmoothReport,
}

/// Smooths a field so that it has exactly the wanted minima and maxima.
///
/// # Arguments
/// * `data`: `n` finite values, one a vertex of `complex`.
/// * `progress`: told of every stage and solver iteration.
///
/// # Returns
/// Values of the asked precision whose extrema under (value, vertex index) are exactly the wanted ones; and unless
/// [`Strictness::TiesByIndex`](crate::monotone::Strictness::TiesByIndex) was asked, every other vertex has a strictly smaller and a strictly greater neighbour.
/// This holds however the solver ended; `report.solver.status` says whether they are also optimal. Vertices without
/// neighbours keep their value.
///
/// # Errors
/// [`SmoothError`].
///
/// # Cost
/// With automatic length about a dozen factorisations, then one an iteration of the solver, 10 to 25.
///
/// # Source
/// Jacobson, Weinkauf, Sorkine 2012, section 3.
pub fn smooth(
    complex: &SimplicialComplex,
    data: &[f64],
    options: &SmoothOptions<'_>,
    progress: &mut dyn FnMut(SmoothProgress),
) -> Result<Smoothed, SmoothError> {
    // What is wrong with the field is said before the mesh is looked at.
    check_field(complex, data, options)?;
    progress(SmoothProgress::Stage("operators"));
    Smoother::new(complex, options.order)?.smooth(data, options, progress)
}
