//! `morsmooth convert`: one file format into another.

use morsmooth::io::{GeometryKind, is_same_file, losses, outline_dataset, read, reshape, write_temporary};
use serde_json::json;

use crate::Outcome;
use crate::args::ConvertArgs;
use crate::failure::Failure;
use crate::output::{check_report, check_target};
use crate::report::write_report;
use crate::talk::Talk;

/// Runs the command.
pub fn run(args: &ConvertArgs) -> Result<Outcome, Failure> {
    check_target(&args.output)?;
    check_report(args.talk.report.as_deref(), &[&args.input, &args.output])?;
    if is_same_file(&args.input, &args.output) {
        return Err(Failure::file(&args.output, "the output is the input; expected another file"));
    }
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let found = if args.outline { outline_dataset(&args.input, &args.fill.options()) } else { read(&args.input) };
    let dataset = found.map_err(|error| Failure::usage(error.to_string()))?;
    let (points, cells) = (dataset.point_count(), dataset.cell_count());
    let extension = args.output.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let dataset = match GeometryKind::of_extension(extension) {
        // Gmsh and Medit hold surfaces as well as volumes, and both come as unstructured grids.
        Some(kind) => reshape(dataset, kind).map_err(|error| Failure::file(&args.output, error))?,
        None => dataset,
    };
    let lost = losses(&args.output, &dataset).map_err(|error| Failure::usage(error.to_string()))?;
    talk.stage("writing");
    let pending = write_temporary(&args.output, &dataset).map_err(|error| Failure::usage(error.to_string()))?;
    if let Some(report) = &args.talk.report {
        let told = json!({
            "input": args.input, "output": args.output, "geometry": dataset.geometry.name(),
            "points": points, "cells": cells, "lost": lost,
        });
        write_report(report, &told)?;
    }
    pending.commit().map_err(|error| Failure::usage(error.to_string()))?;
    talk.finish();
    for what in &lost {
        talk.line(&format!("warning: .{extension} has no room for {what}"));
    }
    talk.line(&format!("{}: {}, {points} points, {cells} cells", args.output.display(), dataset.geometry.name()));
    Ok(Outcome::Done)
}
