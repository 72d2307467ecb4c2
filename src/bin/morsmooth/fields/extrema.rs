//! `morsmooth extrema`: count, list persistence, suggest thresholds.

use std::io::Write;

use morsmooth::morse::PersistenceCurve;
use morsmooth::smooth::{ExtremumCount, MeasuredField};
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::ExtremaArgs;
use crate::common::input::FieldInput;
use crate::common::output::{check_directory, check_report};
use crate::common::report::{header, pairs, write_report};
use crate::common::talk::Talk;
use crate::failure::Failure;
use crate::fields::table::threshold_table;

/// Gaps of the persistence curve that are listed.
const GAPS: usize = 4;

/// Runs the command.
pub fn run(args: &ExtremaArgs) -> Result<Outcome, Failure> {
    check_report(args.talk.report.as_deref(), &[&args.field.input])?;
    check_directory(args.plots.as_deref())?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let input = FieldInput::load(&args.field)?;
    input.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
    talk.stage("extrema");
    let field = MeasuredField::new(&input.domain.complex, input.values.clone())
        .map_err(|error| input.smooth_failure(&error))?;
    let curve = PersistenceCurve::new(&field.minima, &field.maxima, &field.values);
    if let Some(directory) = &args.plots {
        talk.stage("pictures");
        crate::common::pictures::extrema(directory, &input, &field)?;
    }
    talk.finish();
    let (low, high) = field.range();
    let gaps = curve.widest_gaps(GAPS);
    if let Some(path) = &args.talk.report {
        let mut report = header(&input);
        if let Value::Object(entries) = &mut report {
            entries.insert("range".into(), json!([low, high]));
            entries.insert("minima".into(), json!(field.minima.len()));
            entries.insert("maxima".into(), json!(field.maxima.len()));
            entries.insert("minima_pairs".into(), json!(pairs(&field.minima, &field.values)));
            entries.insert("maxima_pairs".into(), json!(pairs(&field.maxima, &field.values)));
            let gaps: Vec<Value> = gaps
                .iter()
                .map(|gap| json!({ "from": gap.from, "to": gap.to, "minima": gap.minima, "maxima": gap.maxima }))
                .collect();
            entries.insert("widest_gaps".into(), json!(gaps));
        }
        write_report(path, &report)?;
    }
    if !args.talk.quiet {
        let mut out = std::io::stdout().lock();
        let mut lines = threshold_table(&input.name, &field, &curve);
        if !gaps.is_empty() {
            lines.push(String::new());
            lines.push("widest gaps of the persistence curve, good places for a threshold:".to_owned());
            for gap in gaps {
                let percent = |value: f64| if high > low { 100.0 * value / (high - low) } else { 0.0 };
                lines.push(format!(
                    "  {:.2} % to {:.2} % leaves {}",
                    percent(gap.from),
                    percent(gap.to),
                    ExtremumCount { minima: gap.minima, maxima: gap.maxima }
                ));
            }
        }
        for line in lines {
            let _ = writeln!(out, "{line}");
        }
    }
    Ok(Outcome::Done)
}
