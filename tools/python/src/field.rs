//! A scalar field on the part of its points that is the domain, and which of its extrema are wanted.

use std::sync::Arc;

use morsmooth::audit::{AuditReport, ExtremumType, Plateaus, Wanted, audit, moved_values};
use morsmooth::field::{Precision, VertexId};
use morsmooth::io::{ArrayData, DataArray, DataSet, MaskSources, domain, mask};
use morsmooth::mesh::{Domain, Mask, check};
use morsmooth::monotone::ValueRule;
use morsmooth::morse::{ExtremumPair, Selection, Threshold, WantedExtrema};
use morsmooth::operators::OperatorError;
use morsmooth::smooth::{SmoothError, constant_components};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::failure::Failure;

/// A field and its domain.
pub struct Field {
    /// Name of the array.
    pub name: String,
    /// Its type is that of the results.
    pub precision: Precision,
    /// The domain.
    pub domain: Domain,
    /// Value at every point of the mesh.
    pub on_points: Vec<f64>,
    /// Value at every vertex of the domain.
    pub values: Vec<f64>,
    /// What was found and handled while the domain was made.
    pub notes: Vec<String>,
}

/// Which extrema are wanted; one of the four.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Wishes {
    persistence: Option<f64>,
    persistence_abs: Option<f64>,
    extrema: Option<usize>,
    keep: Option<Vec<u64>>,
}

impl Field {
    /// The field of a point array.
    pub fn new(dataset: &Arc<DataSet>, name: &str, mask_name: Option<&str>) -> Result<Self, Failure> {
        let fail = |error: &dyn std::fmt::Display| Failure::input(error);
        let array = dataset.point_array(name).ok_or_else(|| Failure::input(format!("found no point array '{name}'")))?;
        if array.components != 1 {
            return Err(Failure::input(format!("array '{name}' has {} components; expected 1", array.components)));
        }
        let sources = MaskSources { array: mask_name.map(str::to_owned), holes: vec![name.to_owned()], ..MaskSources::default() };
        let mut kept = mask(dataset, &sources).map_err(|error| fail(&error))?;
        let mut domain = self::domain(dataset, &kept).map_err(|error| fail(&error))?;
        let precision = match array.data {
            ArrayData::F32(_) => Precision::F32,
            _ => Precision::F64,
        };
        let on_points = array.to_f64(0);
        let mut values = domain.restrict(&on_points);
        if let Some(vertex) = values.iter().position(|value| !value.is_finite()) {
            let point = domain.point_of_vertex()[vertex];
            let text = format!("array {name} is {} at point {point}; expected a finite number", values[vertex]);
            return Err(Failure::input(text).hint("NaN marks a hole; an infinite value must be masked or repaired"));
        }
        let mut notes: Vec<String> = domain.notes.iter().map(ToString::to_string).collect();
        // No strict field is near a part with one value, so it is left out; a field without any variation is refused later.
        let constant = constant_components(&domain.complex, &values);
        let left_out: usize = constant.iter().map(Vec::len).sum();
        if left_out > 0 && left_out < values.len() {
            for vertices in &constant {
                notes.push(format!(
                    "the field is constant (value {:?}) on a part of {} points, first point {}; left out, they keep their value",
                    values[vertices[0].index()],
                    vertices.len(),
                    domain.point_of_vertex()[vertices[0].index()]
                ));
            }
            let points: Vec<u32> = constant.iter().flat_map(|vertices| domain.points_of(vertices)).collect();
            leave_out(&mut kept, dataset.point_count(), &points);
            domain = self::domain(dataset, &kept).map_err(|error| fail(&error))?;
            values = domain.restrict(&on_points);
        }
        Ok(Self { name: name.to_owned(), precision, domain, on_points, values, notes })
    }

    /// A point array of weights, on the vertices.
    pub fn weights(&self, dataset: &DataSet, name: Option<&str>) -> Result<Option<Vec<f64>>, Failure> {
        let Some(name) = name else { return Ok(None) };
        match dataset.point_array(name) {
            Some(array) if array.components == 1 => Ok(Some(self.domain.restrict(&array.to_f64(0)))),
            Some(array) => Err(Failure::input(format!("array '{name}' has {} components; expected one number a point", array.components))),
            None => Err(Failure::input(format!("found no point array '{name}'"))),
        }
    }

    /// The selection that is meant.
    pub fn selection(&self, wishes: &Wishes) -> Result<Selection, Failure> {
        let Wishes { persistence, persistence_abs, extrema, keep } = wishes;
        let given = [persistence.is_some(), persistence_abs.is_some(), extrema.is_some(), keep.is_some()];
        match given.iter().filter(|given| **given).count() {
            0 => return Err(Failure::input("found no wanted extrema; expected one of persistence, persistence_abs, extrema, keep")),
            1 => {}
            many => return Err(Failure::input(format!("found {many} of persistence, persistence_abs, extrema, keep; expected one"))),
        }
        if let Some(part) = *persistence {
            if !(0.0..=1.0).contains(&part) {
                return Err(Failure::input(format!("persistence is {part}; expected a part of the range from 0 to 1")));
            }
            return Ok(Selection::Threshold(Threshold::Fraction(part)));
        }
        if let Some(value) = *persistence_abs {
            return Ok(Selection::Threshold(Threshold::Absolute(value)));
        }
        if let Some(count) = *extrema {
            return Ok(Selection::Count(count));
        }
        let points = keep.as_deref().unwrap_or_default();
        if points.is_empty() {
            return Err(Failure::input("found no point number in keep; expected at least one"));
        }
        let mut vertices = points.iter().map(|&point| self.vertex(point)).collect::<Result<Vec<_>, _>>()?;
        vertices.sort_unstable();
        vertices.dedup();
        Ok(Selection::Set(vertices))
    }

    fn vertex(&self, point: u64) -> Result<VertexId, Failure> {
        let found = usize::try_from(point).ok().and_then(|point| self.domain.vertex_of_point().get(point));
        match found {
            Some(Some(vertex)) => Ok(*vertex),
            Some(None) => {
                Err(Failure::input(format!("point {point} is not in the domain; expected a point that is neither masked nor left out")))
            }
            None => {
                let last = self.domain.point_count().saturating_sub(1);
                Err(Failure::input(format!("found point {point}; the mesh has points 0 to {last}")))
            }
        }
    }

    /// An error of the library as one about the mesh, vertices translated to points.
    pub fn failure(&self, error: &SmoothError) -> Failure {
        if let SmoothError::Operator(OperatorError::ZeroMeasure { .. }) = error
            && let Err(fault) = check(&self.domain)
        {
            return Failure::input(fault);
        }
        let failure = Failure::input(error);
        let vertices = error.vertices();
        let points = self.domain.points_of(&vertices);
        if vertices.iter().zip(&points).all(|(vertex, point)| vertex.0 == *point) {
            return failure;
        }
        let names: Vec<String> =
            vertices.iter().zip(&points).map(|(vertex, point)| format!("vertex {vertex} is point {point} of the mesh")).collect();
        failure.hint(names.join(", "))
    }

    /// The array of a result: its values on the domain, those of the field elsewhere, in the type of the field.
    pub fn array(&self, values: &[f64]) -> ArrayData {
        let mut on_points = self.on_points.clone();
        self.domain.extend(values, &mut on_points);
        match self.precision {
            Precision::F32 => ArrayData::F32(on_points.iter().map(|&value| value as f32).collect()),
            Precision::F64 => ArrayData::F64(on_points),
        }
    }

    /// The verdict on an array as it is returned.
    pub fn judge(&self, array: &ArrayData, (wanted, rules): (&WantedExtrema, &[ValueRule]), plateaus: Plateaus) -> Result<AuditReport, Failure> {
        let values = self.domain.restrict(&DataArray::new(&self.name, 1, array.clone()).to_f64(0));
        let rule = |vertex: VertexId| match rules[vertex.index()] {
            ValueRule::Free => None,
            ValueRule::Exactly(value) => Some(morsmooth::audit::ValueRule::Exactly(value)),
            ValueRule::Within(low, high) => Some(morsmooth::audit::ValueRule::Within(low, high)),
        };
        let ruled = |vertices: &[VertexId]| -> Vec<_> { vertices.iter().map(|&vertex| (vertex, rule(vertex))).collect() };
        let (minima, maxima) = (ruled(&wanted.minima), ruled(&wanted.maxima));
        let asked = Wanted { minima: &minima, maxima: &maxima, plateaus };
        let mut verdict = audit(&self.domain.complex, &values, &asked).map_err(Failure::input)?;
        // Values that are kept besides, at saddles and along separatrices.
        let is_extremum = |vertex: VertexId| wanted.minima.binary_search(&vertex).is_ok() || wanted.maxima.binary_search(&vertex).is_ok();
        let others: Vec<_> = (0..rules.len())
            .map(VertexId::from)
            .filter_map(|vertex| Some((vertex, rule(vertex)?)))
            .filter(|&(vertex, _)| !is_extremum(vertex))
            .collect();
        let moved = moved_values(&values, &others);
        verdict.passed &= moved.is_empty();
        verdict.moved_values.count += moved.count;
        Ok(verdict)
    }

    /// Facts that every report begins with.
    pub fn header(&self) -> Value {
        json!({
            "program": "morsmooth",
            "version": env!("CARGO_PKG_VERSION"),
            "array": self.name,
            "points": self.domain.point_count(),
            "vertices": self.domain.complex.vertex_count(),
            "simplices": self.domain.complex.simplex_count(),
            "dimension": self.domain.complex.dimension(),
            "notes": self.notes,
        })
    }

    /// The audit, and the extrema as points.
    pub fn evidence(&self, report: &mut Value, audit: &AuditReport, (wanted, values): (&WantedExtrema, &[f64])) {
        let named = |&(vertex, kind): &(VertexId, ExtremumType)| {
            let kind = if kind == ExtremumType::Minimum { "minimum" } else { "maximum" };
            json!({ "point": self.domain.point_of_vertex()[vertex.index()], "kind": kind })
        };
        report["audit"] = json!({
            "passed": audit.passed,
            "minima": audit.found_minima,
            "maxima": audit.found_maxima,
            "missing": audit.missing.count,
            "missing_first": audit.missing.first.iter().map(named).collect::<Vec<_>>(),
            "spurious": audit.spurious.count,
            "spurious_first": audit.spurious.first.iter().map(named).collect::<Vec<_>>(),
            "moved_values": audit.moved_values.count,
            "plateaus": audit.plateaus.count,
        });
        let listed = |vertices: &[VertexId]| -> Vec<Value> {
            let entry = |&vertex: &VertexId| {
                json!({
                    "point": self.domain.point_of_vertex()[vertex.index()],
                    "position": self.domain.complex.point(vertex),
                    "value": values[vertex.index()],
                })
            };
            vertices.iter().map(entry).collect()
        };
        report["wanted"] = json!({ "minima": listed(&wanted.minima), "maxima": listed(&wanted.maxima) });
    }
}

/// Extremum pairs as (birth, death), the death of an essential one null.
pub fn pairs(pairs: &[ExtremumPair], values: &[f64]) -> Vec<(f64, Option<f64>)> {
    pairs.iter().map(|pair| (values[pair.extremum.index()], pair.saddle.map(|saddle| values[saddle.index()]))).collect()
}

/// What an audit found, in words.
pub fn audit_faults(audit: &AuditReport) -> String {
    let faults = [
        (audit.missing.count, "wanted extrema missing"),
        (audit.spurious.count, "extrema that nobody wanted"),
        (audit.moved_values.count, "wanted values not kept"),
        (audit.plateaus.count, "points on plateaus"),
    ];
    let found: Vec<String> = faults.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect();
    format!("the audit of the result failed: {}", found.join(", "))
}

/// Hands an array of floating-point numbers over to numpy without a copy.
pub fn to_numpy(py: Python<'_>, array: ArrayData) -> Py<PyAny> {
    match array {
        ArrayData::F32(values) => PyArray1::from_vec(py, values).into_any().unbind(),
        ArrayData::F64(values) => PyArray1::from_vec(py, values).into_any().unbind(),
        other => {
            let values = DataArray::new("", 1, other).to_f64(0);
            PyArray1::from_vec(py, values).to_dyn().clone().into_any().unbind()
        }
    }
}

fn leave_out(kept: &mut Mask, count: usize, points: &[u32]) {
    let keep = kept.keep_points.get_or_insert_with(|| vec![true; count]);
    points.iter().for_each(|&point| keep[point as usize] = false);
}
