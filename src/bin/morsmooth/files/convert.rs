//! `morsmooth convert`: one file format into another.

use std::path::PathBuf;

use morsmooth::io::{PendingFile, is_same_file, outline_dataset, read, resolve, write_temporary};
use serde_json::json;

use crate::Outcome;
use crate::args::ConvertArgs;
use crate::common::beside::{fitting, write_beside};
use crate::common::output::{check_report, check_target};
use crate::common::report::write_report;
use crate::common::steps::Series;
use crate::common::talk::Talk;
use crate::failure::Failure;

/// Runs the command.
pub fn run(args: &ConvertArgs) -> Result<Outcome, Failure> {
    check_target(&args.output)?;
    check_report(args.talk.report.as_deref(), &[&args.input, &args.output])?;
    let own = resolve(&args.input).unwrap_or_else(|_| args.input.clone());
    if is_same_file(&own, &args.output) {
        return Err(Failure::file(&args.output, "the output is the input; expected another file"));
    }
    if !args.outline
        && let Some(series) = Series::find(&args.input, &args.output)?
    {
        return run_several(args, &series);
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

/// Every data set of a list, each in the format of its kind, and the list; all or nothing.
fn run_several(args: &ConvertArgs, series: &Series) -> Result<Outcome, Failure> {
    let report = args.talk.report.as_deref();
    series.check(&args.output, &[Some(&args.input), report])?;
    let talk = Talk::new(args.talk.quiet);
    let told = |error: morsmooth::io::IoError| Failure::usage(error.to_string());
    let (mut pending, mut files, mut facts): (Vec<PendingFile>, Vec<Option<PathBuf>>, Vec<_>) = Default::default();
    for step in &series.steps {
        talk.stage(&step.label);
        let dataset = read(&step.input).map_err(told)?;
        let target = step.target(dataset.geometry.extension());
        pending.push(write_temporary(&target, &dataset).map_err(told)?);
        facts.push(json!({
            "address": step.address, "time": step.time, "input": step.input, "output": target, "geometry": dataset.geometry.name(),
            "points": dataset.point_count(), "cells": dataset.cell_count(),
        }));
        files.push(Some(target));
    }
    let times: Vec<f64> = (0..files.len()).map(|number| number as f64).collect();
    pending.extend(series.write(&files, &times)?);
    if let Some(report) = report {
        let told = json!({ "input": args.input, "output": args.output, "empty": series.empty, series.noun(): facts });
        write_report(report, &told)?;
    }
    // The lists last, inner ones before those that name them.
    pending.into_iter().try_for_each(PendingFile::commit).map_err(told)?;
    talk.finish();
    talk.line(&format!("{}: {} {}", args.output.display(), files.len(), series.noun()));
    Ok(Outcome::Done)
}
