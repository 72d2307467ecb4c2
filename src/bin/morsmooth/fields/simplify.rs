//! `morsmooth simplify`: the field itself with exactly the wanted extrema.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use morsmooth::audit::{AuditReport, Plateaus};
use morsmooth::morse::Selection;
use morsmooth::smooth::{Simplified, simplify};
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::{FieldsArgs, SelectionArgs, TalkArgs};
use crate::common::input::FieldInput;
use crate::common::number::short;
use crate::common::output::check_output;
use crate::common::report::{audit_json, audit_line, command_line, header, wanted_json, write_report};
use crate::common::talk::Talk;
use crate::common::wishes::{array_names, check_keep, check_single_name, wishes};
use crate::common::written::{OrderArrays, Produced, write_and_audit};
use crate::failure::Failure;

/// `morsmooth simplify`.
#[derive(Debug, Args)]
pub struct SimplifyArgs {
    /// The fields.
    #[command(flatten)]
    pub field: FieldsArgs,

    /// File to write; same kind of data set as the input.
    pub output: PathBuf,

    /// Name of the array written; <ARRAY>_simplified by default. Of several thresholds each adds its own ending.
    #[arg(long, value_name = "NAME", visible_alias = "name")]
    pub output_array: Option<String>,

    /// Which extrema are wanted.
    #[command(flatten)]
    pub selection: SelectionArgs,

    /// Write the array <NAME>_Order as well: Int32, the rank of every point by (value, point number), as TTK reads it.
    ///
    /// Nothing needs it: the values are strict under a plain <, so TTK and every other program see exactly the wanted extrema in
    /// them. It saves TTK the sorting. It belongs to the values written; do not keep it beside values that are changed later.
    #[arg(long)]
    pub order_array: bool,

    /// Write the output even if the audit fails.
    #[arg(long)]
    pub keep_unaudited: bool,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// One simplified field with its name.
struct Job {
    input: usize,
    name: String,
    result: Simplified,
}

/// Runs the command.
pub fn run(args: &SimplifyArgs) -> Result<Outcome, Failure> {
    let begin = Instant::now();
    let keep: Vec<_> = args.selection.keep.as_deref().into_iter().collect();
    check_output(&args.field.input, &args.output, args.talk.report.as_deref(), &keep)?;
    check_keep(&args.selection, &args.output)?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let inputs = FieldInput::load_all(&args.field)?;
    check_single_name(args.output_array.as_deref(), &inputs)?;
    let read_seconds = begin.elapsed().as_secs_f64();
    let mut jobs: Vec<Job> = Vec::new();
    for (place, input) in inputs.iter().enumerate() {
        input.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
        let wishes = wishes(&args.selection, input)?;
        let roles = [("--mask", args.field.mask.as_deref())];
        let names = array_names(args.output_array.as_deref(), "_simplified", input, &wishes, &roles)?;
        names.iter().filter(|name| input.dataset.point_array(name).is_some()).for_each(|name| {
            talk.line(&format!("note: the array {name} of the input is replaced in the output"));
        });
        let selections: Vec<Selection> = wishes.into_iter().map(|wish| wish.selection).collect();
        let results = simplify(&input.domain.complex, &input.values, &selections, input.precision, &mut |step| talk.progress(&step))
            .map_err(|error| input.smooth_failure(&error))?;
        jobs.extend(names.into_iter().zip(results).map(|(name, result)| Job { input: place, name, result }));
    }
    talk.stage("writing, and audit of the file as written");
    let writing = Instant::now();
    let written: Vec<Produced<'_>> = jobs
        .iter()
        .map(|job| Produced {
            input: &inputs[job.input],
            name: &job.name,
            values: &job.result.values,
            wanted: &job.result.wanted,
            rules: &job.result.rules,
            plateaus: Plateaus::Refused,
        })
        .collect();
    let orders = if args.order_array { OrderArrays::Written } else { OrderArrays::Omitted };
    let (pending, verdicts) = write_and_audit(&args.output, &written, orders)?;
    let write_seconds = writing.elapsed().as_secs_f64();
    let passed = verdicts.iter().all(|verdict| verdict.passed);
    let is_kept = passed || args.keep_unaudited;
    if is_kept {
        pending.commit().map_err(|error| Failure::usage(error.to_string()))?;
    } else {
        drop(pending);
    }
    talk.finish();
    let report = Report { args, inputs: &inputs, jobs: &jobs, verdicts: &verdicts, is_kept };
    let seconds = [read_seconds, write_seconds, begin.elapsed().as_secs_f64()];
    if let Some(path) = &args.talk.report {
        write_report(path, &report.to_json(seconds))?;
    }
    if !args.talk.quiet {
        report.print(seconds);
    }
    Ok(if passed { Outcome::Done } else { Outcome::NotMet })
}

/// What is said of a run.
struct Report<'a> {
    args: &'a SimplifyArgs,
    inputs: &'a [FieldInput],
    jobs: &'a [Job],
    verdicts: &'a [AuditReport],
    is_kept: bool,
}

impl Report<'_> {
    fn to_json(&self, [read, write, total]: [f64; 3]) -> Value {
        let mut results: Vec<Value> = self
            .jobs
            .iter()
            .zip(self.verdicts)
            .map(|(job, verdict)| {
                let input = &self.inputs[job.input];
                let mut entry = header(input);
                entry["command"] = json!(command_line());
                entry["output"] = json!(self.args.output.display().to_string());
                entry["output_array"] = json!(job.name);
                entry["order_array"] = json!(self.args.order_array.then(|| format!("{}_Order", job.name)));
                entry["written"] = json!(self.is_kept);
                entry["audit"] = audit_json(input, verdict);
                entry["simplify"] = json!(job.result.report);
                entry["wanted"] = wanted_json(input, &job.result.wanted, &job.result.values, &job.result.rules);
                entry["seconds"] = json!({ "read": read, "write_and_audit": write, "total": total });
                entry
            })
            .collect();
        match results.as_mut_slice() {
            [only] => only.take(),
            _ => json!({ "program": "morsmooth", "version": env!("CARGO_PKG_VERSION"), "results": results }),
        }
    }

    /// On standard output; a closed pipe is not an error.
    fn print(&self, [read, write, total]: [f64; 3]) {
        let mut out = std::io::stdout().lock();
        let mut say = |what: &str, text: String| {
            let _ = writeln!(out, "{what:<15} {text}");
        };
        for (job, verdict) in self.jobs.iter().zip(self.verdicts) {
            let report = &job.result.report;
            let (low, high) = report.data_range;
            let name = &self.inputs[job.input].name;
            say("field", format!("{name} on {} vertices, values {} to {}", report.vertices, short(low), short(high)));
            say("extrema before", report.before.to_string());
            let rule = report.threshold.map_or(String::new(), |threshold| format!(" (persistence above {})", short(threshold)));
            say("extrema wanted", format!("{}{rule}", report.wanted));
            if report.unavoidable > 0 {
                say("", format!("{} of them only because no field on this domain is without them", report.unavoidable));
            }
            if report.replaced {
                say("flood", "did not settle; a harmonic order took its place".to_owned());
            }
            let pairs = &report.pairs;
            let moved = pairs.found - pairs.same;
            say(
                "pairs",
                match moved {
                    0 => format!("{}, each with its values in the input", pairs.found),
                    _ => format!("{}; {moved} die elsewhere, by at most {}", pairs.found, short(pairs.largest_change)),
                },
            );
            let change = &report.change;
            say(
                "change",
                format!(
                    "rms {} ({:.2} % of the range), largest {}, {} of {} vertices",
                    short(change.rms),
                    100.0 * change.rms_of_range,
                    short(change.largest),
                    change.vertices,
                    report.vertices
                ),
            );
            let stages: Vec<String> = report.timing.stages.iter().map(|(stage, seconds)| format!("{stage} {seconds:.2}")).collect();
            say("time", format!("{total:.2} s (read {read:.2}, {}, write and audit {write:.2})", stages.join(", ")));
            say("audit", audit_line(verdict));
            let target = self.args.output.display();
            say(
                "output",
                match self.is_kept {
                    true => format!("{target}, array {}", job.name),
                    false => format!("none: {target} was not written (--keep-unaudited would)"),
                },
            );
        }
    }
}
