//! `morsmooth info`: what a file holds.

use std::io::Write;

use morsmooth::io::{ArrayData, DataArray, MaskSources, domain, mask, read};
use morsmooth::mesh::{MeshFault, faults};
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::InfoArgs;
use crate::failure::Failure;
use crate::input::describe;
use crate::output::check_report;
use crate::report::write_report;
use crate::talk::Talk;

/// Faults listed on the screen; the report has them all.
const SHOWN: usize = 20;

/// Runs the command.
pub fn run(args: &InfoArgs) -> Result<Outcome, Failure> {
    check_report(args.talk.report.as_deref(), &[&args.input])?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let dataset = read(&args.input).map_err(|error| Failure::usage(error.to_string()))?;
    let sources = MaskSources { array: args.mask.clone(), ..MaskSources::default() };
    let kept = mask(&dataset, &sources).map_err(|error| Failure::file(&args.input, error))?;
    talk.stage("domain");
    let built = domain(&dataset, &kept);
    let found: Vec<MeshFault> = built.as_ref().map(faults).unwrap_or_default();
    talk.finish();

    let mut lines = vec![
        format!("{}: {}, {} points, {} cells", args.input.display(), dataset.geometry.name(), dataset.point_count(), dataset.cell_count()),
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
    if let Some(path) = &args.talk.report {
        write_report(path, &report(args, &dataset, built.as_ref().ok(), &found))?;
    }
    if !args.talk.quiet {
        let mut out = std::io::stdout().lock();
        for line in lines {
            let _ = writeln!(out, "{line}");
        }
    }
    match built {
        Ok(_) => Ok(Outcome::Done),
        Err(error) => Err(Failure::file(&args.input, error)),
    }
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
    args: &InfoArgs,
    dataset: &morsmooth::io::DataSet,
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
        "input": args.input.display().to_string(),
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
