//! `morsmooth convert`: one file format into another.

use morsmooth::io::{is_same_file, outline_dataset, read};
use serde_json::json;

use crate::Outcome;
use crate::args::ConvertArgs;
use crate::beside::{fitting, write_beside};
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
    let dataset = fitting(dataset, &args.output)?;
    talk.stage("writing");
    let (pending, lost) = write_beside(&args.output, &dataset)?;
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
