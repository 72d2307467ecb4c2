//! Several fields, or several sets of extrema, on one mesh: what depends on the mesh and the order is made once.

use std::sync::Arc;

use crate::mesh::SimplicialComplex;
use crate::monotone::{AnalysisError, EnergyWeights, FitAnalysis, Fitter, Operators};
use crate::morse::Selection;

use super::automatic::resolve_length;
use super::checks::{check_field, constant_components, unit};
use super::error::SmoothError;
use super::options::{SelectOn, SmoothOptions};
use super::pipeline::{SmoothProgress, Smoothed};
use super::report::{ExtremumCount, LengthReport, Timing};
use super::result::{Shared, smooth_selected};
use super::select::MeasuredField;

/// Smooths fields on one mesh with one order of the energy.
///
/// It holds the operators of the mesh, the fill-reducing ordering and the symbolic analysis of the energy's matrix: for
/// the steps of a time series, the members of an ensemble, several arrays of one file.
///
/// # Example
/// ```
/// use morsmooth::mesh::SimplicialComplex;
/// use morsmooth::morse::{Selection, Threshold};
/// use morsmooth::smooth::{Length, SmoothOptions, Smoother};
/// let n = 40u32;
/// let points = (0..n).map(|i| [f64::from(i), 0.0, 0.0]).collect();
/// let line = SimplicialComplex::new(1, points, (0..n - 1).flat_map(|i| [i, i + 1]).collect())?;
/// let above = |part: f64| Selection::Threshold(Threshold::Fraction(part));
/// let options = SmoothOptions { length: Length::Absolute(2.0), ..SmoothOptions::new(above(0.5)) };
/// let mut smoother = Smoother::new(&line, 2)?;
/// for step in 0..3 {
///     let data: Vec<f64> = (0..n).map(|i| (f64::from(i) / 5.0 + f64::from(step)).sin()).collect();
///     let results = smoother.smooth_each(&data, &[above(0.1), above(0.5)], &options, &mut |_| {})?;
///     assert_eq!(results.len(), 2);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Smoother<'a> {
    fitter: Fitter<'a>,
    order: usize,
    /// Of what was made once; goes to the first field.
    timing: Timing,
}

impl<'a> Smoother<'a> {
    /// Assembles the operators and analyses the pattern of the energy.
    ///
    /// # Arguments
    /// * `order`: k of the polyharmonic energy, 1 to 4.
    ///
    /// # Errors
    /// [`SmoothError::Empty`], [`SmoothError::OptionRange`], [`SmoothError::Operator`], [`SmoothError::Solver`].
    ///
    /// # Cost
    /// O(n + m), a fill-reducing ordering and a symbolic analysis.
    pub fn new(complex: &'a SimplicialComplex, order: usize) -> Result<Self, SmoothError> {
        check_mesh(complex, order)?;
        let mut timing = Timing::default();
        let operators = timing.measure("operators", || Operators::new(complex))?;
        let fitter = timing.measure("analysis", || Fitter::new(complex, operators, order))?;
        Ok(Self { fitter, order, timing })
    }

    /// What smoothers of one mesh share: for the steps of a series that several threads smooth at once.
    ///
    /// # Arguments
    /// * `order`: k of the polyharmonic energy, 1 to 4.
    ///
    /// # Errors
    /// As [`Smoother::new`].
    ///
    /// # Cost
    /// As [`Smoother::new`].
    ///
    /// # Example
    /// ```
    /// use morsmooth::mesh::SimplicialComplex;
    /// use morsmooth::morse::{Selection, Threshold};
    /// use morsmooth::smooth::{Length, SmoothOptions, Smoother, smooth};
    /// use rayon::prelude::*;
    /// let n = 40u32;
    /// let points = (0..n).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    /// let line = SimplicialComplex::new(1, points, (0..n - 1).flat_map(|i| [i, i + 1]).collect())?;
    /// let wanted = Selection::Threshold(Threshold::Fraction(0.5));
    /// let options = SmoothOptions { length: Length::Absolute(2.0), ..SmoothOptions::new(wanted) };
    /// let step = |t: u32| -> Vec<f64> { (0..n).map(|i| (f64::from(i) / 5.0 + f64::from(t)).sin()).collect() };
    /// let analysis = Smoother::analysis(&line, 2)?;
    /// let together = (0..3u32).into_par_iter().map(|t| {
    ///     Smoother::with_analysis(&line, &analysis)?.smooth(&step(t), &options, &mut |_| {})
    /// });
    /// let together = together.collect::<Result<Vec<_>, _>>()?;
    /// assert_eq!(together[2].values, smooth(&line, &step(2), &options, &mut |_| {})?.values);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn analysis(complex: &SimplicialComplex, order: usize) -> Result<FitAnalysis, SmoothError> {
        check_mesh(complex, order)?;
        FitAnalysis::new(complex, order).map_err(|error| match error {
            AnalysisError::Operator(error) => error.into(),
            AnalysisError::Solver(error) => error.into(),
        })
    }

    /// A smoother on an analysis that it shares with others, with a factor of its own.
    ///
    /// # Arguments
    /// * `complex`: the mesh that was analysed, or an equal one.
    ///
    /// # Returns
    /// A smoother whose results have the same bits as those of [`Smoother::new`].
    ///
    /// # Errors
    /// [`SmoothError::OptionLength`] if the mesh has another number of vertices than the one analysed.
    ///
    /// # Cost
    /// Memory for one factor; no arithmetic.
    pub fn with_analysis(complex: &'a SimplicialComplex, analysis: &'a FitAnalysis) -> Result<Self, SmoothError> {
        if analysis.vertices() != complex.vertex_count() {
            return Err(SmoothError::OptionLength { option: "analysis", expected: complex.vertex_count(), found: analysis.vertices() });
        }
        Ok(Self { fitter: analysis.fitter(complex), order: analysis.order(), timing: Timing::default() })
    }

    /// Smooths one field, as [`smooth`](super::smooth) does.
    ///
    /// # Arguments
    /// * `data`: `n` finite values.
    /// * `options`: with the order of this smoother.
    ///
    /// # Errors
    /// [`SmoothError`]; [`SmoothError::OptionRange`] for another order.
    ///
    /// # Cost
    /// As [`smooth`](super::smooth), without the operators and the analysis.
    pub fn smooth(
        &mut self,
        data: &[f64],
        options: &SmoothOptions<'_>,
        progress: &mut dyn FnMut(SmoothProgress),
    ) -> Result<Smoothed, SmoothError> {
        let shared = self.share(data, options, progress)?;
        smooth_selected(&mut self.fitter, &shared, &options.selection, options, progress)
    }

    /// Smooths one field once for each of several selections, from one smoothing length, one unconstrained field and one
    /// list of extremum pairs.
    ///
    /// # Arguments
    /// * `data`: `n` finite values.
    /// * `selections`: take the place of the options' own.
    ///
    /// # Returns
    /// One result a selection, each the same bits as alone. Each report holds the time of the shared stages as well.
    ///
    /// # Errors
    /// As [`Smoother::smooth`].
    ///
    /// # Cost
    /// For each selection one factorisation for the pinned field, and one an iteration of the solver.
    pub fn smooth_each(
        &mut self,
        data: &[f64],
        selections: &[Selection],
        options: &SmoothOptions<'_>,
        progress: &mut dyn FnMut(SmoothProgress),
    ) -> Result<Vec<Smoothed>, SmoothError> {
        let shared = self.share(data, options, progress)?;
        let one = |selection| smooth_selected(&mut self.fitter, &shared, selection, options, progress);
        selections.iter().map(one).collect()
    }

    /// The field on which extrema are selected, with its extremum pairs: the data, or the unconstrained smooth field.
    ///
    /// # Arguments
    /// * `data`: `n` finite values.
    /// * `options`: their selection is not used.
    ///
    /// # Returns
    /// The field, and the smoothing length that was used or would be.
    ///
    /// # Errors
    /// As [`Smoother::smooth`].
    ///
    /// # Cost
    /// As [`Smoother::smooth`] up to the selection.
    pub fn measured(
        &mut self,
        data: &[f64],
        options: &SmoothOptions<'_>,
        progress: &mut dyn FnMut(SmoothProgress),
    ) -> Result<(Arc<MeasuredField>, LengthReport), SmoothError> {
        let shared = self.share(data, options, progress)?;
        Ok((shared.selected_on, shared.length))
    }

    /// What all selections of a field share.
    fn share<'d>(
        &mut self,
        data: &'d [f64],
        options: &SmoothOptions<'d>,
        progress: &mut dyn FnMut(SmoothProgress),
    ) -> Result<Shared<'d>, SmoothError> {
        let complex = self.fitter.complex();
        check_field(complex, data, options)?;
        if options.order != self.order {
            return Err(SmoothError::OptionRange { option: "order", found: options.order as f64, expected: "the order of the smoother" });
        }
        let mut timing = std::mem::take(&mut self.timing);
        progress(SmoothProgress::Stage("extrema of the data"));
        let measured = timing.measure("extrema", || MeasuredField::new(complex, data.to_vec()))?;
        let unit = unit(measured.range())?;
        progress(SmoothProgress::Stage("smoothing length"));
        let length = timing.measure("length", || resolve_length(&mut self.fitter, data, unit, options))?;
        let weights = EnergyWeights {
            order: options.order,
            length: length.absolute,
            confidence: options.confidence,
            smoothness: options.smoothness,
        };
        progress(SmoothProgress::Stage("unconstrained field"));
        let unconstrained =
            timing.measure("unconstrained", || self.fitter.minimiser(data, &weights, &vec![None; data.len()]))?;
        let before = ExtremumCount { minima: measured.minima.len(), maxima: measured.maxima.len() };
        let data_range = measured.range();
        let selected_on = match options.select_on {
            SelectOn::Data => measured,
            SelectOn::Smooth => timing.measure("extrema", || MeasuredField::new(complex, unconstrained.clone()))?,
        };
        if let Some(constant) = constant_components(complex, &selected_on.values).first() {
            let (vertex, vertices) = (constant[0], constant.len());
            return Err(SmoothError::SmoothedAway { vertex, vertices, value: selected_on.values[vertex.index()] });
        }
        Ok(Shared { data, unit, weights, length, unconstrained, before, data_range, selected_on: Arc::new(selected_on), timing })
    }
}

fn check_mesh(complex: &SimplicialComplex, order: usize) -> Result<(), SmoothError> {
    if complex.simplex_count() == 0 {
        return Err(SmoothError::Empty { vertices: complex.vertex_count(), simplices: 0 });
    }
    if !(1..=4).contains(&order) {
        return Err(SmoothError::OptionRange { option: "order", found: order as f64, expected: "1, 2, 3 or 4" });
    }
    Ok(())
}
