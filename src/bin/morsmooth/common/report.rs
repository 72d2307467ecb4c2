//! Reports: JSON with everything measured, and the summary for people.

use std::path::Path;

use morsmooth::audit::{AuditReport, Defects, ExtremumType};
use morsmooth::field::{Precision, VertexId};
use morsmooth::monotone::ValueRule;
use morsmooth::morse::{ExtremumPair, WantedExtrema, reported_persistences};
use morsmooth::plot::write_atomically;
use morsmooth::qp::QpStatus;
use morsmooth::smooth::{ExtremumCount, MeasuredField, SelectOn, Smoothed};
use serde_json::{Value, json};

use crate::args::SmoothArgs;
use crate::common::input::FieldInput;
use crate::common::number::short;
use crate::failure::Failure;

/// Writes a report.
pub fn write_report(path: &Path, report: &Value) -> Result<(), Failure> {
    let mut text = serde_json::to_string_pretty(report)
        .map_err(|error| Failure::file(path, format!("the report cannot be put into JSON: {error}")))?;
    text.push('\n');
    write_atomically(path, text.as_bytes()).map_err(|error| Failure::usage(error.to_string()))
}

/// The facts that every report begins with.
pub fn header(input: &FieldInput) -> Value {
    let domain = &input.domain;
    json!({
        "program": "morsmooth",
        "version": env!("CARGO_PKG_VERSION"),
        "input": input.path.display().to_string(),
        "array": input.name,
        "mask": input.mask,
        "points": domain.point_count(),
        "vertices": domain.complex.vertex_count(),
        "simplices": domain.complex.simplex_count(),
        "dimension": domain.complex.dimension(),
        "notes": input.notes,
    })
}

/// Extremum pairs as (birth, death), the death of an essential one `null`.
pub fn pairs(pairs: &[ExtremumPair], values: &[f64]) -> Vec<(f64, Option<f64>)> {
    pairs.iter().map(|pair| (values[pair.extremum.index()], pair.saddle.map(|saddle| values[saddle.index()]))).collect()
}

/// Wanted extrema as a user finds them in the file: point number, position, value, and whether that value had to be kept.
pub fn wanted_json(input: &FieldInput, wanted: &WantedExtrema, values: &[f64], rules: &[ValueRule]) -> Value {
    let extrema = |vertices: &[VertexId]| -> Vec<Value> {
        vertices
            .iter()
            .map(|&vertex| {
                let rule = rules[vertex.index()];
                let mut entry = json!({
                    "point": input.domain.point_of_vertex()[vertex.index()],
                    "position": input.domain.complex.point(vertex),
                    "value": values[vertex.index()],
                    "value_kept": matches!(rule, ValueRule::Exactly(_)),
                });
                if let ValueRule::Within(low, high) = rule {
                    entry["within"] = json!([low, high]);
                }
                entry
            })
            .collect()
    };
    json!({ "minima": extrema(&wanted.minima), "maxima": extrema(&wanted.maxima) })
}

/// The command as typed, word by word.
pub fn command_line() -> Vec<String> {
    std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect()
}

/// The verdict of the audit, vertices translated to points.
pub fn audit_json(input: &FieldInput, audit: &AuditReport) -> Value {
    let named = |defects: &Defects<(VertexId, ExtremumType)>| -> Vec<Value> {
        let name = |kind| if kind == ExtremumType::Minimum { "minimum" } else { "maximum" };
        let point = |vertex: VertexId| input.domain.point_of_vertex()[vertex.index()];
        defects.first.iter().map(|&(vertex, kind)| json!({ "point": point(vertex), "kind": name(kind) })).collect()
    };
    json!({
        "passed": audit.passed,
        "minima": audit.found_minima,
        "maxima": audit.found_maxima,
        "missing": audit.missing.count,
        "missing_first": named(&audit.missing),
        "spurious": audit.spurious.count,
        "spurious_first": named(&audit.spurious),
        "moved_values": audit.moved_values.count,
        "plateaus": audit.plateaus.count,
        "plateaus_first": input.domain.points_of(&audit.plateaus.first),
    })
}

/// What an audit found, for people.
pub fn audit_line(audit: &AuditReport) -> String {
    if audit.passed {
        return format!(
            "passed: the file has exactly {}",
            ExtremumCount { minima: audit.found_minima, maxima: audit.found_maxima }
        );
    }
    let mut faults = Vec::new();
    for (count, what) in [
        (audit.missing.count, "wanted extrema missing"),
        (audit.spurious.count, "extrema that nobody wanted"),
        (audit.moved_values.count, "wanted values not kept"),
        (audit.plateaus.count, "points on plateaus"),
    ] {
        if count > 0 {
            faults.push(format!("{count} {what}"));
        }
    }
    format!("FAILED: {}", faults.join(", "))
}

/// Everything about one run of `morsmooth smooth`.
pub struct SmoothJob<'a> {
    pub args: &'a SmoothArgs,
    pub output: &'a Path,
    pub input: &'a FieldInput,
    pub output_array: &'a str,
    pub result: &'a Smoothed,
    pub audit: &'a AuditReport,
    pub written: bool,
    pub read_seconds: f64,
    pub write_seconds: f64,
    pub seconds: f64,
}

impl SmoothJob<'_> {
    /// The report.
    pub fn to_json(&self) -> Value {
        let field = &self.result.selected_on;
        let mut report = header(self.input);
        if let Value::Object(entries) = &mut report {
            entries.insert("command".into(), json!(command_line()));
            entries.insert("output".into(), json!(self.output.display().to_string()));
            entries.insert("output_array".into(), json!(self.output_array));
            entries.insert("raw".into(), json!(self.args.raw));
            entries.insert("written".into(), json!(self.written));
            entries.insert("audit".into(), audit_json(self.input, self.audit));
            entries.insert("smooth".into(), json!(self.result.report));
            let result = self.result;
            entries.insert("wanted".into(), wanted_json(self.input, &result.wanted, &result.values, &result.rules));
            entries.insert("minima_pairs".into(), json!(pairs(&field.minima, &field.values)));
            entries.insert("maxima_pairs".into(), json!(pairs(&field.maxima, &field.values)));
            entries.insert(
                "seconds".into(),
                json!({ "read": self.read_seconds, "write_and_audit": self.write_seconds, "total": self.seconds }),
            );
        }
        report
    }

    /// What to say of a result that is not proven optimal.
    pub fn warning(&self) -> Option<String> {
        let solver = &self.result.report.solver;
        let status = match solver.status {
            QpStatus::Solved => return None,
            QpStatus::Infeasible(_) => "infeasible",
            QpStatus::IterationLimit => "at its iteration limit",
            QpStatus::Stalled => "stalled",
            QpStatus::CutOff => "cut off",
        };
        let extrema = if self.audit.passed { "has exactly the wanted extrema but is" } else { "failed the audit and is" };
        Some(format!("the solver ended {status}: the field {extrema} not proven optimal (relative gap {:.1e})", solver.kkt.duality_gap))
    }

    /// The summary, line by line.
    pub fn summary(&self) -> Vec<String> {
        let report = &self.result.report;
        let (low, high) = report.data_range;
        let mut lines = vec![
            ("field", format!("{} on {} vertices, values {} to {}", self.input.name, report.vertices, short(low), short(high))),
            ("extrema before", report.before.to_string()),
        ];
        if report.select_on == SelectOn::Smooth {
            let (low, high) = report.selection_range;
            lines.push(("smooth field", format!("{}, values {} to {}", report.selection_extrema, short(low), short(high))));
        }
        let rule = match report.threshold {
            Some(threshold) => format!(" (persistence above {})", short(threshold)),
            None => String::new(),
        };
        lines.push(("extrema wanted", format!("{}{rule}", report.wanted)));
        if report.unavoidable > 0 {
            lines.push(("", format!("{} of them only because {}", report.unavoidable, unavoidable_reason(report.dimension))));
        }
        let noise = match report.length.noise {
            Some(noise) => format!(", chosen by cross-validation; prediction error about {}", short(noise)),
            None => String::new(),
        };
        lines.push((
            "smoothing",
            format!(
                "order {}, length {} ({:.2} % of the diagonal){noise}",
                report.order,
                short(report.length.absolute),
                100.0 * report.length.of_diagonal
            ),
        ));
        let function = &report.representative;
        let why = function.why.as_ref().map_or(String::new(), |why| format!(" instead of {}: {why}", function.asked));
        lines.push(("representative", format!("{}{why}", function.used)));
        lines.push((
            "energy",
            format!(
                "{:.6e}: {} above the least possible with these extrema's values, {} above the unconstrained field",
                report.energy.result,
                percent(report.energy.above_bound),
                percent(report.energy.above_unconstrained)
            ),
        ));
        if let Some(kept) = &report.kept_also {
            lines.push((
                "kept besides",
                format!(
                    "values at {} saddles and {} points of separatrices, for {} of energy",
                    kept.saddles,
                    kept.separatrix_vertices,
                    percent(kept.paid)
                ),
            ));
        }
        let rounding = report.energy.rounds.last().map_or(0.0, |round| report.energy.result / round - 1.0);
        if rounding.is_finite() && rounding.abs() > 1e-3 {
            let cause = match report.precision {
                Precision::F32 => "storing 32-bit values",
                Precision::F64 => "the exact repair",
            };
            lines.push(("rounding", format!("{cause} adds {} to the energy", percent(rounding))));
        }
        lines.push((
            "solver",
            format!(
                "{}, {} iterations, {} of {} constraints active, relative gap {:.1e}",
                crate::common::report::status_name(&report.solver.status),
                report.solver.iterations,
                report.solver.active_rows,
                report.solver.rows,
                report.solver.kkt.duality_gap
            ),
        ));
        lines.push((
            "change",
            format!(
                "rms {} ({:.2} % of the range), largest {}",
                short(report.change.rms),
                100.0 * report.change.rms_of_range,
                short(report.change.largest)
            ),
        ));
        lines.push(("repair", format!("{} vertices, by at most {:.1e}", report.repair.moved, report.repair.largest_move)));
        let stages: Vec<String> =
            report.timing.stages.iter().map(|(stage, seconds)| format!("{stage} {seconds:.2}")).collect();
        lines.push((
            "time",
            format!(
                "{:.2} s (read {:.2}, {}, write and audit {:.2})",
                self.seconds,
                self.read_seconds,
                stages.join(", "),
                self.write_seconds
            ),
        ));
        lines.push(("audit", audit_line(self.audit)));
        let target = self.output.display();
        lines.push((
            "output",
            match self.written {
                true => format!("{target}, array {}", self.output_array),
                false => format!("none: {target} was not written (--keep-unaudited would)"),
            },
        ));
        lines.into_iter().map(|(what, text)| format!("{what:<15} {text}")).collect()
    }
}

/// Prints lines on standard output; a closed pipe is not an error.
pub fn print_lines(lines: &[String]) {
    use std::io::Write;
    let mut stdout = std::io::stdout().lock();
    for line in lines {
        let _ = writeln!(stdout, "{line}");
    }
}

/// Why an extremum had to be kept.
fn unavoidable_reason(dimension: usize) -> &'static str {
    match dimension {
        1 => "the end of a line is always an extremum",
        _ => "their part of the domain hangs on one vertex",
    }
}

/// An excess as a percentage; an energy of nothing has none.
fn percent(excess: f64) -> String {
    match excess {
        excess if !excess.is_finite() => "immeasurably".to_owned(),
        excess if excess < 1e4 => format!("{:.2} %", (1e4 * excess).round() / 100.0 + 0.0),
        excess => format!("{:.2e} times", excess + 1.0),
    }
}

/// How a solve ended, in a word.
pub fn status_name(status: &QpStatus) -> &'static str {
    match status {
        QpStatus::Solved => "solved",
        QpStatus::Infeasible(_) => "infeasible (the field written is feasible, not optimal)",
        QpStatus::IterationLimit => "iteration limit (the field written is feasible, not optimal)",
        QpStatus::CutOff => "cut off (the field written is feasible, not optimal)",
        QpStatus::Stalled => "stalled (the field written is feasible, not optimal to the asked gap)",
    }
}

/// Persistences of one kind, for curves and tables.
pub fn persistences(field: &MeasuredField) -> (Vec<f64>, Vec<f64>) {
    (
        reported_persistences(&field.minima, &field.maxima, &field.values),
        reported_persistences(&field.maxima, &field.minima, &field.values),
    )
}
