//! The pictures of `--plots`.

use std::path::Path;

use morsmooth::audit::extrema as extrema_of;
use morsmooth::field::VertexId;
use morsmooth::mesh::SimplicialComplex;
use morsmooth::morse::ExtremumPair;
use morsmooth::plot::{
    CurveChart, DiagramPoint, FieldView, PictureOptions, PlotError, ShapeView, before_after, field_picture, persistence_curve,
    persistence_diagram, shape_picture, write_atomically,
};
use morsmooth::smooth::{MeasuredField, SelectOn, Smoothed};

use crate::common::input::FieldInput;
use crate::common::report::{SmoothJob, persistences};
use crate::failure::Failure;

/// Before and after, persistence curve and diagram of a smoothing run.
pub fn smooth(directory: &Path, job: &SmoothJob<'_>) -> Result<(), Failure> {
    let (input, result) = (job.input, job.result);
    let report = &result.report;
    before_and_after(directory, input, result)?;
    let kept = |vertex: VertexId| {
        result.wanted.minima.binary_search(&vertex).is_ok() || result.wanted.maxima.binary_search(&vertex).is_ok()
    };
    let label = match report.select_on {
        SelectOn::Data => input.name.clone(),
        SelectOn::Smooth => format!("{}, smooth field", input.name),
    };
    charts(directory, &result.selected_on, report.threshold, &label, kept)
}

/// A field before and after smoothing, side by side.
pub fn before_and_after(directory: &Path, input: &FieldInput, result: &Smoothed) -> Result<(), Failure> {
    let complex = &input.domain.complex;
    prepare(directory)?;
    let before = extrema_of(complex, &input.values).map_err(|error| Failure::file(&input.path, error))?;
    let options = PictureOptions { label: input.name.clone(), ..PictureOptions::default() };
    let report = &result.report;
    let titles = (format!("before: {}", report.before), format!("after: {}", report.wanted));
    let left = FieldView { title: &titles.0, values: &input.values, minima: &before.minima, maxima: &before.maxima };
    let right =
        FieldView { title: &titles.1, values: &result.values, minima: &result.wanted.minima, maxima: &result.wanted.maxima };
    let target = directory.join("before_after.png");
    before_after(complex, &left, &right, &options)
        .and_then(|picture| picture.write_png(&target))
        .map_err(|error| plot_failure(&target, &error))
}

/// Isolines of a distance, in `<name>.png`.
pub fn distance(directory: &Path, name: &str, input: &FieldInput) -> Result<(), Failure> {
    prepare(directory)?;
    let complex = &input.domain.complex;
    let found = extrema_of(complex, &input.values).map_err(|error| Failure::file(&input.path, error))?;
    let title = format!("{} minima, {} maxima", found.minima.len(), found.maxima.len());
    let view = FieldView { title: &title, values: &input.values, minima: &found.minima, maxima: &found.maxima };
    let options = PictureOptions { label: input.name.clone(), ..PictureOptions::default() };
    let target = directory.join(format!("{name}.png"));
    field_picture(complex, &view, &options)
        .and_then(|picture| picture.write_png(&target))
        .map_err(|error| plot_failure(&target, &error))
}

/// The field, its persistence curve and diagram.
pub fn extrema(directory: &Path, input: &FieldInput, field: &MeasuredField) -> Result<(), Failure> {
    persistence(directory, input, field, &[])
}

/// The same with plateaus marked in the curve.
pub fn persistence(directory: &Path, input: &FieldInput, field: &MeasuredField, plateaus: &[(f64, f64)]) -> Result<(), Failure> {
    prepare(directory)?;
    let vertices = |pairs: &[ExtremumPair]| -> Vec<VertexId> { pairs.iter().map(|pair| pair.extremum).collect() };
    let (minima, maxima) = (vertices(&field.minima), vertices(&field.maxima));
    let title = format!("{} minima, {} maxima", minima.len(), maxima.len());
    let view = FieldView { title: &title, values: &input.values, minima: &minima, maxima: &maxima };
    let options = PictureOptions { label: input.name.clone(), ..PictureOptions::default() };
    let target = directory.join("field.png");
    field_picture(&input.domain.complex, &view, &options)
        .and_then(|picture| picture.write_png(&target))
        .map_err(|error| plot_failure(&target, &error))?;
    charts(directory, field, None, &input.name, |_| true)?;
    match plateaus {
        [] => Ok(()),
        // Once more, with what is marked.
        plateaus => curve(&directory.join("persistence_curve.svg"), input, field, plateaus),
    }
}

/// The persistence curve alone, with plateaus marked.
pub fn curve(target: &Path, input: &FieldInput, field: &MeasuredField, plateaus: &[(f64, f64)]) -> Result<(), Failure> {
    let (minima, maxima) = persistences(field);
    CurveChart { minima: &minima, maxima: &maxima, threshold: None, kept: None, plateaus, label: &input.name }
        .svg()
        .and_then(|svg| write_atomically(target, svg.as_bytes()))
        .map_err(|error| plot_failure(target, &error))
}

/// `before_after.png`: a shape before and after it was moved, inverted elements red.
///
/// # Arguments
/// * `after`: a place for every vertex; `determinants`: det F of every element, if it is known; `marks`: places of handles, before and after.
pub fn shapes(
    directory: &Path,
    rest: &SimplicialComplex,
    after: &[[f64; 3]],
    determinants: Option<&[f64]>,
    marks: [&[[f64; 3]]; 2],
) -> Result<(), Failure> {
    prepare(directory)?;
    let ones = determinants.map(|determinants| vec![1.0; determinants.len()]);
    let title = match determinants.map(|determinants| determinants.iter().filter(|det| **det <= 0.0).count()) {
        Some(count) => format!("after: {count} inverted elements"),
        None => "after".to_owned(),
    };
    let views = [
        ShapeView { title: "before", points: rest.points(), determinants: ones.as_deref(), marks: marks[0] },
        ShapeView { title: &title, points: after, determinants, marks: marks[1] },
    ];
    let target = directory.join("before_after.png");
    shape_picture(rest, &views, 1600)
        .and_then(|picture| picture.write_png(&target))
        .map_err(|error| plot_failure(&target, &error))
}

fn charts(
    directory: &Path,
    field: &MeasuredField,
    threshold: Option<f64>,
    label: &str,
    kept: impl Fn(VertexId) -> bool,
) -> Result<(), Failure> {
    let (minima, maxima) = persistences(field);
    let count = |pairs: &[ExtremumPair]| pairs.iter().filter(|pair| kept(pair.extremum)).count();
    let counts = [count(&field.minima), count(&field.maxima)];
    let target = directory.join("persistence_curve.svg");
    persistence_curve(&minima, &maxima, threshold, counts, label)
        .and_then(|svg| write_atomically(&target, svg.as_bytes()))
        .map_err(|error| plot_failure(&target, &error))?;
    let points = |pairs: &[ExtremumPair]| -> Vec<DiagramPoint> {
        pairs
            .iter()
            .map(|pair| DiagramPoint {
                birth: field.values[pair.extremum.index()],
                death: pair.saddle.map(|saddle| field.values[saddle.index()]),
                kept: kept(pair.extremum),
            })
            .collect()
    };
    let target = directory.join("persistence_diagram.svg");
    persistence_diagram(&points(&field.minima), &points(&field.maxima), threshold, label)
        .and_then(|svg| write_atomically(&target, svg.as_bytes()))
        .map_err(|error| plot_failure(&target, &error))
}

/// Makes the directory.
pub fn prepare(directory: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(directory).map_err(|error| Failure::file(directory, format!("cannot be made a directory: {error}")))
}

/// What is said of a picture that could not be drawn or written.
pub fn plot_failure(target: &Path, error: &PlotError) -> Failure {
    Failure::file(target, error)
}
