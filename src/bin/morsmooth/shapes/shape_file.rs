//! Deformed shapes as files: written beside their place, read back, judged by exact predicates.

use std::path::Path;

use morsmooth::audit::{OrientationReport, orientations};
use morsmooth::field::Precision;
use morsmooth::io::{ArrayData, DataArray, PendingFile, set_positions};
use morsmooth::plot::Photograph;
use serde_json::{Value, json};

use crate::common::beside::{fitting, read_back, with_vertices, write_beside, write_image};
use crate::failure::Failure;
use crate::shapes::posed::Posed;
use crate::shapes::shape::Shape;

/// A file that waits for its audit to be looked at.
pub struct Written {
    /// The file.
    pub pending: PendingFile,
    /// Its points as they are, and rounded to 32 bits.
    pub audit: [OrientationReport; 2],
    /// What the format had no room for.
    pub lost: Vec<String>,
}

/// Writes a posed shape beside `output`, and judges the points that are in the file then.
pub fn write_and_audit(output: &Path, shape: &Shape, posed: &Posed, folded: &[usize]) -> Result<Written, Failure> {
    let mut dataset = shape.dataset.clone();
    let places = with_vertices(dataset.points_f64(), &shape.domain, &posed.points);
    set_positions(&mut dataset, &places).map_err(|text| Failure::file(&shape.path, text))?;
    for array in cell_arrays(shape, posed) {
        dataset.cell_data.set(array);
    }
    let dataset = fitting(dataset, output)?;
    let (pending, lost) = write_beside(output, &dataset)?;
    drop(dataset);
    let written = read_back(&pending)?;
    if written.point_count() != shape.domain.point_count() {
        let extension = output.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        let text = format!(
            "the format .{extension} does not keep the numbers of points ({} of {} are left); expected another one",
            written.point_count(),
            shape.domain.point_count()
        );
        return Err(Failure::file(output, text));
    }
    let points = written.points_f64();
    let vertices: Vec<[f64; 3]> = shape.domain.point_of_vertex().iter().map(|&point| points[point as usize]).collect();
    let audit = judge(shape, folded, &vertices)?;
    Ok(Written { pending, audit, lost })
}

/// Writes a photograph, carried along by a posed shape, beside `output`.
pub fn write_warped(output: &Path, photograph: &Photograph, shape: &Shape, posed: &Posed) -> Result<PendingFile, Failure> {
    let warped = photograph.warped(shape.complex(), &posed.points).map_err(|error| Failure::file(output, error))?;
    let [width, height] = warped.size().map(|pixels| pixels as u32);
    write_image(output, (width, height), warped.pixels().as_flattened())
}

/// The orientations of all elements at some places, in both precisions.
pub fn judge(shape: &Shape, folded: &[usize], points: &[[f64; 3]]) -> Result<[OrientationReport; 2], Failure> {
    let judge = |precision| {
        orientations(shape.complex(), folded, points, precision).map_err(|error| Failure::file(&shape.path, error))
    };
    Ok([judge(Precision::F64)?, judge(Precision::F32)?])
}

/// `det_F`, `smallest_eigenvalue`, `energy_density` and `active_constraint` of every cell.
///
/// A cell of several elements has the smallest of the first two, the mean by measure of the third, and any of the last. Cells that are
/// no elements have NaN and 0.
fn cell_arrays(shape: &Shape, posed: &Posed) -> Vec<DataArray> {
    let cells = shape.dataset.cell_count();
    let owners = shape.domain.cell_of_simplex();
    let least = |values: &[f64]| {
        let mut found = vec![f64::NAN; cells];
        // `min` takes the number where one of the two is NaN.
        owners.iter().zip(values).for_each(|(&cell, value)| found[cell as usize] = found[cell as usize].min(*value));
        found
    };
    let (mut sums, mut measures) = (vec![0.0; cells], vec![0.0; cells]);
    for (element, &cell) in owners.iter().enumerate() {
        let measure = shape.complex().measure(element);
        sums[cell as usize] += measure * posed.densities[element];
        measures[cell as usize] += measure;
    }
    // 0 / 0 is NaN, for cells without elements.
    let densities = sums.iter().zip(&measures).map(|(sum, measure)| sum / measure).collect();
    let real = |name: &str, values: Vec<f64>| DataArray::new(name, 1, ArrayData::F64(values));
    let mut arrays = vec![
        real("det_F", least(&posed.determinants)),
        real("smallest_eigenvalue", least(&posed.eigenvalues)),
        real("energy_density", densities),
    ];
    if let Some(active) = &posed.active {
        let mut marks = vec![0u8; cells];
        owners.iter().zip(active).filter(|(_, active)| **active).for_each(|(&cell, _)| marks[cell as usize] = 1);
        arrays.push(DataArray::new("active_constraint", 1, ArrayData::U8(marks)));
    }
    arrays
}

/// What the audit says, elements as cells of the file.
pub fn audit_json(shape: &Shape, audit: &[OrientationReport; 2]) -> Value {
    let one = |report: &OrientationReport| {
        json!({
            "precision": report.precision, "elements": report.elements, "smallest_det_F": report.smallest,
            "cell_of_smallest": report.where_smallest.map(|element| shape.domain.cell_of_simplex()[element]),
            "inverted": report.inverted.len(), "degenerate": report.degenerate.len(),
            "inverted_cells": shape.cells_of(&report.inverted[..report.inverted.len().min(100)]),
        })
    };
    json!({ "passed": audit.iter().all(OrientationReport::is_clean), "as_written": one(&audit[0]), "in_32_bits": one(&audit[1]) })
}

/// The same in a line.
pub fn audit_line(audit: &[OrientationReport; 2]) -> String {
    let bad = |report: &OrientationReport| report.inverted.len() + report.degenerate.len();
    match (bad(&audit[0]), bad(&audit[1])) {
        (0, 0) => format!(
            "passed: no inverted element of {}, smallest det F {:.3e} as written, {:.3e} in 32 bits",
            audit[0].elements, audit[0].smallest, audit[1].smallest
        ),
        (0, rounded) => format!("failed in 32 bits: {rounded} inverted elements of {}; none as written", audit[1].elements),
        (written, _) => format!("failed: {written} inverted elements of {}, smallest det F {:.3e}", audit[0].elements, audit[0].smallest),
    }
}
