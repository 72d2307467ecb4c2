//! `morsmooth info`: what a file holds.

use std::path::Path;

use morsmooth::io::{ArrayData, DataArray, DataSet, MaskSources, domain, mask, read};
use morsmooth::mesh::{MeshFault, faults};
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::InfoArgs;
use crate::common::input::describe;
use crate::common::output::check_report;
use crate::common::report::{print_lines, write_report};
use crate::common::steps::Series;
use crate::common::talk::Talk;
use crate::failure::Failure;

/// Faults listed on the screen; the report has them all.
const SHOWN: usize = 20;

/// Runs the command.
pub fn run(args: &InfoArgs) -> Result<Outcome, Failure> {
    check_report(args.talk.report.as_deref(), &[&args.input])?;
    let talk = Talk::new(args.talk.quiet);
    if let Some(series) = Series::listed(&args.input)? {
        return run_several(args, &series, &talk);
    }
    talk.stage("reading");
    let dataset = read(&args.input).map_err(|error| Failure::usage(error.to_string()))?;
    talk.stage("domain");
    let seen = look(args, &args.input, &dataset)?;
    talk.finish();
    if let Some(path) = &args.talk.report {
        write_report(path, &seen.report)?;
    }
    if !args.talk.quiet {
        print_lines(&seen.lines);
    }
    match seen.fault {
        None => Ok(Outcome::Done),
        Some(failure) => Err(failure),
    }
}

/// Every data set of a list. One that cannot be read is named, and the others are shown.
fn run_several(args: &InfoArgs, series: &Series, talk: &Talk) -> Result<Outcome, Failure> {
    let mut lines = vec![format!("{}: {} {}", args.input.display(), series.steps.len(), series.noun())];
    let (mut reports, mut failed) = (Vec::new(), Vec::new());
    for step in &series.steps {
        talk.stage(&step.label);
        let seen = read(&step.input)
            .map_err(|error| Failure::usage(error.to_string()))
            .and_then(|dataset| look(args, &step.input, &dataset));
        lines.push(String::new());
        lines.push(step.label.clone());
        let mut report = match seen {
            Ok(seen) => {
                lines.extend(seen.lines);
                seen.report
            }
            Err(failure) => {
                lines.push(format!("unreadable   {}", failure.text()));
                failed.push(format!("{}: {}", step.label, failure.text()));
                json!({ "input": step.input, "error": failure.text() })
            }
        };
        report["address"] = json!(step.address);
        report["time"] = json!(step.time);
        reports.push(report);
    }
    for empty in &series.empty {
        lines.extend([String::new(), format!("block {empty} (empty, without a file)")]);
    }
    talk.finish();
    if let Some(path) = &args.talk.report {
        let report = json!({
            "program": "morsmooth", "version": env!("CARGO_PKG_VERSION"), "input": args.input, "kind": series.noun(),
            "empty": series.empty, series.noun(): reports,
        });
        write_report(path, &report)?;
    }
    if !args.talk.quiet {
        print_lines(&lines);
    }
    match failed.is_empty() {
        true => Ok(Outcome::Done),
        false => {
            let text = format!("{} of {} {} cannot be read\n{}", failed.len(), series.steps.len(), series.noun(), failed.join("\n"));
            Err(Failure::file(&args.input, text))
        }
    }
}

/// What was seen of one data set.
struct Seen {
    lines: Vec<String>,
    report: Value,
    /// Why it is no domain.
    fault: Option<Failure>,
}

fn look(args: &InfoArgs, path: &Path, dataset: &DataSet) -> Result<Seen, Failure> {
    let sources = MaskSources { array: args.mask.clone(), ..MaskSources::default() };
    let kept = mask(dataset, &sources).map_err(|error| Failure::file(path, error))?;
    let built = domain(dataset, &kept);
    let found: Vec<MeshFault> = built.as_ref().map(faults).unwrap_or_default();
    let mut lines = vec![
        format!("{}: {}, {} points, {} cells", path.display(), dataset.geometry.name(), dataset.point_count(), dataset.cell_count()),
    ];
    for (what, arrays) in [
        ("point array", &dataset.point_data.arrays),
        ("cell array", &dataset.cell_data.arrays),
        ("field array", &dataset.field_data),
    ] {
        for array in arrays {
            lines.push(format!("{what:<12} {} {}{}", array.data.value_type().xml_name(), describe(array), holes(array)));
        }
    }
    match &built {
        Ok(domain) => {
            let complex = &domain.complex;
            let (_, components) = complex.components();
            lines.push(format!(
                "domain       dimension {}, {} vertices, {} edges, {} simplices, {components} component(s), Euler characteristic {}",
                complex.dimension(),
                complex.vertex_count(),
                complex.edges().len(),
                complex.simplex_count(),
                euler(complex)
            ));
        }
        Err(error) => lines.push(format!("domain       none: {error}")),
    }
    for fault in found.iter().take(SHOWN) {
        lines.push(format!("{:<12} {fault}", format!("{:?}", fault.severity()).to_lowercase()));
    }
    if found.len() > SHOWN {
        lines.push(format!("             and {} more", found.len() - SHOWN));
    }
    let report = report(path, dataset, built.as_ref().ok(), &found);
    Ok(Seen { lines, report, fault: built.err().map(|error| Failure::file(path, error)) })
}

fn holes(array: &DataArray) -> String {
    let is_float = matches!(array.data, ArrayData::F32(_) | ArrayData::F64(_));
    let count = if is_float && array.components == 1 { array.to_f64(0).iter().filter(|value| value.is_nan()).count() } else { 0 };
    if count == 0 { String::new() } else { format!(", {count} NaN") }
}

fn euler(complex: &morsmooth::mesh::SimplicialComplex) -> i64 {
    let used = (0..complex.vertex_count()).filter(|&vertex| !complex.neighbours(vertex.into()).is_empty()).count() as i64;
    let (edges, triangles) = (complex.edges().len() as i64, complex.triangles().len() as i64);
    let solid = if complex.dimension() == 3 { complex.simplex_count() as i64 } else { 0 };
    used - edges + triangles - solid
}

fn report(
    path: &Path,
    dataset: &DataSet,
    domain: Option<&morsmooth::mesh::Domain>,
    found: &[MeshFault],
) -> Value {
    let arrays = |arrays: &[DataArray]| -> Vec<Value> {
        arrays
            .iter()
            .map(|array| json!({ "name": array.name, "type": array.data.value_type().xml_name(), "components": array.components, "tuples": array.tuples() }))
            .collect()
    };
    json!({
        "program": "morsmooth",
        "version": env!("CARGO_PKG_VERSION"),
        "input": path.display().to_string(),
        "kind": dataset.geometry.name(),
        "points": dataset.point_count(),
        "cells": dataset.cell_count(),
        "point_arrays": arrays(&dataset.point_data.arrays),
        "cell_arrays": arrays(&dataset.cell_data.arrays),
        "field_arrays": arrays(&dataset.field_data),
        "domain": domain.map(|domain| json!({
            "dimension": domain.complex.dimension(),
            "vertices": domain.complex.vertex_count(),
            "edges": domain.complex.edges().len(),
            "simplices": domain.complex.simplex_count(),
            "components": domain.complex.components().1,
            "euler_characteristic": euler(&domain.complex),
        })),
        "faults": found
            .iter()
            .map(|fault| json!({ "severity": format!("{:?}", fault.severity()).to_lowercase(), "message": fault.to_string() }))
            .collect::<Vec<_>>(),
    })
}
