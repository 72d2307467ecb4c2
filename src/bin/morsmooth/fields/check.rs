//! `morsmooth check`: the audit alone, of any file.

use std::io::Write;
use std::path::{Path, PathBuf};

use morsmooth::audit::{AuditReport, Extrema, Plateaus, ValueRule, Wanted, audit, extrema, strict_extrema};
use morsmooth::field::VertexId;
use morsmooth::smooth::ExtremumCount;
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::CheckArgs;
use crate::common::input::{FieldInput, PointKind, read_points};
use crate::common::output::check_report;
use crate::common::report::{audit_json, audit_line, header, write_report};
use crate::common::talk::Talk;
use crate::failure::Failure;

/// Runs the command.
pub fn run(args: &CheckArgs) -> Result<Outcome, Failure> {
    let given = [&args.minima, &args.maxima, &args.against];
    let read: Vec<&Path> = given.into_iter().flatten().chain([&args.field.input]).map(|path| path.as_path()).collect();
    check_report(args.talk.report.as_deref(), &read)?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let report = args.against.as_deref().map(read_json).transpose()?;
    let mut field = args.field.clone();
    if let (None, Some(mask)) = (&field.mask, report.as_ref().and_then(|report| report["mask"].as_str())) {
        talk.line(&format!("note: --mask {mask}, as in the report"));
        field.mask = Some(mask.to_owned());
    }
    let input = FieldInput::load(&field)?;
    input.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
    talk.stage("audit");
    let complex = &input.domain.complex;
    let failure = |error: morsmooth::field::FieldError| Failure::file(&input.path, error);
    let found = extrema(complex, &input.values).map_err(failure)?;
    let plain = strict_extrema(complex, &input.values).map_err(failure)?;
    let verdict = match asked(args, report.as_ref(), &input, &found)? {
        Some(Asked { minima, maxima, plateaus }) => {
            let wanted = Wanted { minima: &minima, maxima: &maxima, plateaus };
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
            "{} by (value, point); {} and {} under a plain <; {} points on plateaus",
            ExtremumCount { minima: found.minima.len(), maxima: found.maxima.len() },
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

/// The wanted extrema with rules for their values, and whether plateaus matter.
struct Asked {
    minima: Vec<(VertexId, Option<ValueRule>)>,
    maxima: Vec<(VertexId, Option<ValueRule>)>,
    plateaus: Plateaus,
}

/// The extrema that the field must have, if any were named. Of a kind that was not named, those found are right.
fn asked(args: &CheckArgs, report: Option<&Value>, input: &FieldInput, found: &Extrema) -> Result<Option<Asked>, Failure> {
    if let (Some(path), Some(report)) = (&args.against, report) {
        return of_report(path, report, input).map(Some);
    }
    if args.minima.is_none() && args.maxima.is_none() {
        return Ok(None);
    }
    let list = |path: &Option<PathBuf>, kind, found: &[VertexId]| -> Result<Vec<_>, Failure> {
        let vertices = path.as_deref().map_or(Ok(found.to_vec()), |path| read_points(path, kind, input))?;
        Ok(vertices.into_iter().map(|vertex| (vertex, None)).collect())
    };
    Ok(Some(Asked {
        minima: list(&args.minima, PointKind::Minima, &found.minima)?,
        maxima: list(&args.maxima, PointKind::Maxima, &found.maxima)?,
        plateaus: Plateaus::Refused,
    }))
}

fn read_json(path: &Path) -> Result<Value, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| Failure::file(path, format!("cannot be read: {error}")))?;
    serde_json::from_str(&text).map_err(|error| Failure::file(path, format!("is no JSON report: {error}")))
}

/// The wanted extrema that `morsmooth smooth --report` lists, with the values that it kept.
fn of_report(path: &Path, report: &Value, input: &FieldInput) -> Result<Asked, Failure> {
    let list = |kind: &str| -> Result<Vec<_>, Failure> {
        let entries = report["wanted"][kind]
            .as_array()
            .ok_or_else(|| Failure::file(path, format!("found no list wanted.{kind}; expected a report of 'morsmooth smooth'")))?;
        entries
            .iter()
            .map(|entry| {
                let point = entry["point"]
                    .as_u64()
                    .ok_or_else(|| Failure::file(path, format!("an entry of wanted.{kind} has no point number")))?;
                let vertex = input.vertex_of_point(path, point)?;
                Ok((vertex, value_rule(entry, input.values[vertex.index()])))
            })
            .collect()
    };
    let plateaus = if report["raw"] == true { Plateaus::Allowed } else { Plateaus::Refused };
    Ok(Asked { minima: list("minima")?, maxima: list("maxima")?, plateaus })
}

/// What an entry of a report says of the value of its extremum, of which `found` is in the file.
fn value_rule(entry: &Value, found: f64) -> Option<ValueRule> {
    // Numbers read from JSON may be off in the last bit.
    if let (Some(low), Some(high)) = (entry["within"][0].as_f64(), entry["within"][1].as_f64()) {
        return Some(ValueRule::Within(low.next_down(), high.next_up()));
    }
    if entry["value_kept"] == false {
        return None;
    }
    let value = entry["value"].as_f64()?;
    let found_as_read = serde_json::from_str::<f64>(&json!(found).to_string()).ok();
    Some(ValueRule::Exactly(if found_as_read == Some(value) { found } else { value }))
}
