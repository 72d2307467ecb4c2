//! Results as arrays of a file: written beside its place, read back, judged.

use std::path::Path;

use morsmooth::audit::{AuditReport, Plateaus, Wanted, audit, moved_values};
use morsmooth::field::{Precision, VertexId};
use morsmooth::io::{ArrayData, DataArray, PendingFile, write_temporary};
use morsmooth::monotone::ValueRule;
use morsmooth::morse::WantedExtrema;

use crate::common::beside::read_back;
use crate::common::input::FieldInput;
use crate::failure::Failure;

/// One array to be written, and what is promised of it.
pub struct Produced<'a> {
    /// The field it was made of.
    pub input: &'a FieldInput,
    /// Its name.
    pub name: &'a str,
    /// A value for every vertex of the domain.
    pub values: &'a [f64],
    /// Its extrema.
    pub wanted: &'a WantedExtrema,
    /// What is asked of each value.
    pub rules: &'a [ValueRule],
    /// Whether equal neighbours break the promise.
    pub plateaus: Plateaus,
}

/// Whether each array gets one that orders its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OrderArrays {
    /// No.
    Omitted,
    /// `<name>_Order`, as TTK names it: Int32, the rank of each point by (value, point number).
    Written,
}

/// Writes the arrays into a copy of the input beside `output`, and judges what is in the file then.
pub fn write_and_audit(
    output: &Path,
    results: &[Produced<'_>],
    orders: OrderArrays,
) -> Result<(PendingFile, Vec<AuditReport>), Failure> {
    let Some(first) = results.first() else { return Err(Failure::usage("found no result to write; expected at least one")) };
    let mut dataset = morsmooth::io::DataSet::clone(&first.input.dataset);
    for result in results {
        let array = result.array();
        let order = (orders == OrderArrays::Written).then(|| order_array(&array));
        dataset.set_point_array(array);
        order.into_iter().for_each(|order| dataset.set_point_array(order));
    }
    let pending = write_temporary(output, &dataset).map_err(|error| Failure::usage(error.to_string()))?;
    drop(dataset);
    let path = pending.path();
    let written = read_back(&pending)?;
    let verdicts: Result<Vec<AuditReport>, Failure> = results
        .iter()
        .map(|result| {
            let array = written
                .point_array(result.name)
                .ok_or_else(|| Failure::file(path, format!("the array {} just written is not in the file", result.name)))?;
            let mut verdict = result.judge(&result.input.domain.restrict(&array.to_f64(0))).map_err(|error| Failure::file(path, error))?;
            if orders == OrderArrays::Written {
                verdict.passed &= written.point_array(&order_name(result.name)) == Some(&order_array(array));
            }
            Ok(verdict)
        })
        .collect();
    let verdicts = verdicts?;
    Ok((pending, verdicts))
}

impl Produced<'_> {
    /// The array: the result on the domain, the input's own values elsewhere.
    pub fn array(&self) -> DataArray {
        let mut on_points = self.input.on_points.clone();
        self.input.domain.extend(self.values, &mut on_points);
        let data = match self.input.precision {
            Precision::F32 => ArrayData::F32(on_points.iter().map(|&value| value as f32).collect()),
            Precision::F64 => ArrayData::F64(on_points),
        };
        DataArray::new(self.name, 1, data)
    }

    /// The verdict on values read from the file.
    pub fn judge(&self, values: &[f64]) -> Result<AuditReport, morsmooth::field::FieldError> {
        let rule = |vertex: VertexId| match self.rules[vertex.index()] {
            ValueRule::Free => None,
            ValueRule::Exactly(value) => Some(morsmooth::audit::ValueRule::Exactly(value)),
            ValueRule::Within(low, high) => Some(morsmooth::audit::ValueRule::Within(low, high)),
        };
        let ruled = |vertices: &[VertexId]| -> Vec<_> { vertices.iter().map(|&vertex| (vertex, rule(vertex))).collect() };
        let (minima, maxima) = (ruled(&self.wanted.minima), ruled(&self.wanted.maxima));
        let wanted = Wanted { minima: &minima, maxima: &maxima, plateaus: self.plateaus };
        let mut verdict = audit(&self.input.domain.complex, values, &wanted)?;
        // Values that are kept besides, at saddles and along separatrices.
        let is_extremum = |vertex: VertexId| self.wanted.minima.binary_search(&vertex).is_ok() || self.wanted.maxima.binary_search(&vertex).is_ok();
        let others: Vec<_> = (0..self.rules.len())
            .map(VertexId::from)
            .filter_map(|vertex| Some((vertex, rule(vertex)?)))
            .filter(|&(vertex, _)| !is_extremum(vertex))
            .collect();
        let moved = moved_values(values, &others);
        verdict.passed &= moved.is_empty();
        verdict.moved_values.count += moved.count;
        verdict.moved_values.first.extend(moved.first);
        Ok(verdict)
    }
}

fn order_name(array: &str) -> String {
    format!("{array}_Order")
}

/// The rank of every point by (value, point number), points without a value last.
fn order_array(array: &DataArray) -> DataArray {
    let values = array.to_f64(0);
    let mut sequence: Vec<usize> = (0..values.len()).collect();
    // Both zeros are the same value; the sort is stable, so that equal values stay by point number.
    sequence.sort_by(|&a, &b| {
        (values[a].is_nan(), values[a] + 0.0).partial_cmp(&(values[b].is_nan(), values[b] + 0.0)).unwrap_or(std::cmp::Ordering::Equal)
    });
    let mut ranks = vec![0i32; values.len()];
    for (rank, &point) in sequence.iter().enumerate() {
        ranks[point] = rank as i32;
    }
    DataArray::new(order_name(&array.name), 1, ArrayData::I32(ranks))
}
