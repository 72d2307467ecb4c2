//! `morsmooth check`: the audit alone, of any file.

use std::io::Write;
use std::path::Path;

use morsmooth::audit::{AuditReport, Plateaus, Wanted, audit, extrema, strict_extrema};
use morsmooth::field::VertexId;
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::CheckArgs;
use crate::failure::Failure;
use crate::input::{FieldInput, read_points};
use crate::output::check_report;
use crate::report::{audit_json, audit_line, header, write_report};
use crate::talk::Talk;

/// Runs the command.
pub fn run(args: &CheckArgs) -> Result<Outcome, Failure> {
    let given = [&args.minima, &args.maxima, &args.against];
    let read: Vec<&Path> = given.into_iter().flatten().chain([&args.field.input]).map(|path| path.as_path()).collect();
    check_report(args.talk.report.as_deref(), &read)?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let input = FieldInput::load(&args.field)?;
    input.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
    talk.stage("audit");
    let complex = &input.domain.complex;
    let failure = |error: morsmooth::field::FieldError| Failure::file(&input.path, error);
    let found = extrema(complex, &input.values).map_err(failure)?;
    let plain = strict_extrema(complex, &input.values).map_err(failure)?;
    let verdict = match wanted(args, &input)? {
        Some((minima, maxima)) => {
            let unruled = |vertices: &[VertexId]| vertices.iter().map(|&vertex| (vertex, None)).collect::<Vec<_>>();
            let (minima, maxima) = (unruled(&minima), unruled(&maxima));
            let wanted = Wanted { minima: &minima, maxima: &maxima, plateaus: Plateaus::Refused };
            Some(audit(complex, &input.values, &wanted).map_err(failure)?)
        }
        None => None,
    };
    talk.finish();
    if let Some(path) = &args.talk.report {
        let mut report = header(&input);
        if let Value::Object(entries) = &mut report {
            entries.insert("minima".into(), json!(input.domain.points_of(&found.minima)));
            entries.insert("maxima".into(), json!(input.domain.points_of(&found.maxima)));
            entries.insert("strict_minima".into(), json!(plain.minima.len()));
            entries.insert("strict_maxima".into(), json!(plain.maxima.len()));
            entries.insert("plateaus".into(), json!(plain.plateaus.len()));
            entries.insert("audit".into(), verdict.as_ref().map_or(Value::Null, |verdict| audit_json(&input, verdict)));
        }
        write_report(path, &report)?;
    }
    if !args.talk.quiet {
        let mut out = std::io::stdout().lock();
        let _ = writeln!(out, "{} on {} vertices", input.name, complex.vertex_count());
        let _ = writeln!(
            out,
            "{} minima, {} maxima by (value, point); {} and {} under a plain <; {} points on plateaus",
            found.minima.len(),
            found.maxima.len(),
            plain.minima.len(),
            plain.maxima.len(),
            plain.plateaus.len()
        );
        if let Some(verdict) = &verdict {
            let _ = writeln!(out, "audit {}", audit_line(verdict));
        }
    }
    Ok(if verdict.as_ref().is_none_or(|verdict: &AuditReport| verdict.passed) { Outcome::Done } else { Outcome::NotMet })
}

type Extrema = (Vec<VertexId>, Vec<VertexId>);

/// The extrema that the field must have, if any were named.
fn wanted(args: &CheckArgs, input: &FieldInput) -> Result<Option<Extrema>, Failure> {
    if let Some(path) = &args.against {
        return of_report(path, input).map(Some);
    }
    if args.minima.is_none() && args.maxima.is_none() {
        return Ok(None);
    }
    let list = |path: &Option<std::path::PathBuf>| path.as_deref().map_or(Ok(Vec::new()), |path| read_points(path, input));
    Ok(Some((list(&args.minima)?, list(&args.maxima)?)))
}

/// The wanted extrema that `morsmooth smooth --report` lists.
fn of_report(path: &Path, input: &FieldInput) -> Result<Extrema, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| Failure::file(path, format!("cannot be read: {error}")))?;
    let report: Value = serde_json::from_str(&text).map_err(|error| Failure::file(path, format!("is no JSON report: {error}")))?;
    let list = |kind: &str| -> Result<Vec<VertexId>, Failure> {
        let entries = report["wanted"][kind]
            .as_array()
            .ok_or_else(|| Failure::file(path, format!("found no list wanted.{kind}; expected a report of 'morsmooth smooth'")))?;
        entries
            .iter()
            .map(|entry| {
                let point = entry["point"]
                    .as_u64()
                    .ok_or_else(|| Failure::file(path, format!("an entry of wanted.{kind} has no point number")))?;
                input.vertex_of_point(path, point)
            })
            .collect()
    };
    Ok((list("minima")?, list("maxima")?))
}
