//! `smooth` and `simplify`.

use std::sync::Arc;

use morsmooth::audit::Plateaus;
use morsmooth::io::ArrayData;
use morsmooth::monotone::{EdgeSet, Strategy, Strictness};
use morsmooth::qp::QpStatus;
use morsmooth::smooth::{ExtremumValues, KeepAlso, Length, SelectOn, SmoothOptions};
use pyo3::prelude::*;
use serde_json::json;

use crate::failure::Failure;
use crate::field::{Field, Wishes, audit_faults, pairs, to_numpy};
use crate::job::{self, Control};
use crate::mesh::Mesh;

/// The options of [`smooth`], in the words of the program's.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Options {
    array: String,
    mask: Option<String>,
    select: String,
    /// Part of the range for `within`.
    values: String,
    within: f64,
    keep_also: Option<String>,
    order: usize,
    length: Option<f64>,
    length_abs: Option<f64>,
    confidence: Option<String>,
    smoothness: Option<String>,
    representative: String,
    edges: String,
    refine: usize,
    gap: f64,
    raw: bool,
}

/// The value that belongs to a word.
pub fn choice<T: Copy>(option: &str, found: &str, known: &[(&str, T)]) -> Result<T, Failure> {
    known.iter().find(|(word, _)| *word == found).map(|&(_, value)| value).ok_or_else(|| {
        let words: Vec<&str> = known.iter().map(|&(word, _)| word).collect();
        Failure::input(format!("{option} is '{found}'; expected one of: {}", words.join(", ")))
    })
}

impl Options {
    fn resolve<'a>(&self, field: &Field, wishes: &Wishes, weights: [Option<&'a [f64]>; 2]) -> Result<SmoothOptions<'a>, Failure> {
        if self.length.is_some() && self.length_abs.is_some() {
            return Err(Failure::input("found length and length_abs; expected one"));
        }
        let keep_also = match &self.keep_also {
            None => KeepAlso::Nothing,
            Some(word) => {
                let known = [("saddles", KeepAlso::Saddles), ("separatrices", KeepAlso::Separatrices), ("both", KeepAlso::Both)];
                choice("keep_also", word, &known)?
            }
        };
        let [confidence, smoothness] = weights;
        Ok(SmoothOptions {
            select_on: choice("select", &self.select, &[("data", SelectOn::Data), ("smooth", SelectOn::Smooth)])?,
            order: self.order,
            length: match (self.length, self.length_abs) {
                (Some(fraction), _) => Length::OfDiagonal(fraction),
                (None, Some(length)) => Length::Absolute(length),
                (None, None) => Length::Automatic,
            },
            confidence,
            smoothness,
            values: choice(
                "extremum_values",
                &self.values,
                &[("keep", ExtremumValues::Keep), ("free", ExtremumValues::Free), ("within", ExtremumValues::Within(self.within))],
            )?,
            keep_also,
            strategy: choice(
                "representative",
                &self.representative,
                &[
                    ("smooth-then-simplify", Strategy::SmoothThenSimplify),
                    ("flood", Strategy::Flood),
                    ("separatrix", Strategy::Separatrix),
                    ("harmonic", Strategy::Harmonic),
                ],
            )?,
            edges: choice("edges", &self.edges, &[("minimal", EdgeSet::Minimal), ("all", EdgeSet::All)])?,
            refine: self.refine,
            precision: field.precision,
            strictness: if self.raw { Strictness::TiesByIndex } else { Strictness::Plain },
            relative_gap: self.gap,
            ..SmoothOptions::new(field.selection(wishes)?)
        })
    }
}

/// The array of a result with its report as JSON.
type Result1 = (ArrayData, String);

/// Smooths a point array: the new array, and the report as JSON.
#[pyfunction]
pub fn smooth(py: Python<'_>, mesh: &Mesh, options: Options, wishes: Wishes, control: Control) -> PyResult<(Py<PyAny>, String)> {
    let dataset = Arc::clone(&mesh.dataset);
    let (array, report): Result1 = job::run(py, &control, move |talk| {
        talk.stage("reading", 0.0);
        let field = Field::new(&dataset, &options.array, options.mask.as_deref())?;
        let confidence = field.weights(&dataset, options.confidence.as_deref())?;
        let smoothness = field.weights(&dataset, options.smoothness.as_deref())?;
        drop(dataset);
        let asked = options.resolve(&field, &wishes, [confidence.as_deref(), smoothness.as_deref()])?;
        let result = morsmooth::smooth::smooth(&field.domain.complex, &field.values, &asked, &mut |step| talk.progress(&step))
            .map_err(|error| field.failure(&error))?;
        talk.stage("audit", 0.97);
        let array = field.array(&result.values);
        let plateaus = if options.raw { Plateaus::Allowed } else { Plateaus::Refused };
        let audit = field.judge(&array, (&result.wanted, &result.rules), plateaus)?;
        if !audit.passed {
            return Err(Failure::guarantee(audit_faults(&audit)));
        }
        let mut report = field.header();
        report["raw"] = json!(options.raw);
        report["smooth"] = json!(result.report);
        report["optimal"] = json!(result.report.solver.status == QpStatus::Solved);
        field.evidence(&mut report, &audit, (&result.wanted, &result.values));
        let measured = &result.selected_on;
        report["minima_pairs"] = json!(pairs(&measured.minima, &measured.values));
        report["maxima_pairs"] = json!(pairs(&measured.maxima, &measured.values));
        talk.stage("done", 1.0);
        Ok((array, report.to_string()))
    })?;
    Ok((to_numpy(py, array), report))
}

/// Simplifies a point array: the new array, and the report as JSON.
#[pyfunction]
pub fn simplify(
    py: Python<'_>,
    mesh: &Mesh,
    array: String,
    mask: Option<String>,
    wishes: Wishes,
    control: Control,
) -> PyResult<(Py<PyAny>, String)> {
    let dataset = Arc::clone(&mesh.dataset);
    let (array, report): Result1 = job::run(py, &control, move |talk| {
        talk.stage("reading", 0.0);
        let field = Field::new(&dataset, &array, mask.as_deref())?;
        drop(dataset);
        let selection = [field.selection(&wishes)?];
        let results =
            morsmooth::smooth::simplify(&field.domain.complex, &field.values, &selection, field.precision, &mut |step| talk.progress(&step))
                .map_err(|error| field.failure(&error))?;
        let result = results.into_iter().next().ok_or_else(|| Failure::internal("internal error: no result"))?;
        talk.stage("audit", 0.9);
        let array = field.array(&result.values);
        let audit = field.judge(&array, (&result.wanted, &result.rules), Plateaus::Refused)?;
        if !audit.passed {
            return Err(Failure::guarantee(audit_faults(&audit)));
        }
        let mut report = field.header();
        report["simplify"] = json!(result.report);
        field.evidence(&mut report, &audit, (&result.wanted, &result.values));
        talk.stage("done", 1.0);
        Ok((array, report.to_string()))
    })?;
    Ok((to_numpy(py, array), report))
}
