//! `morsmooth interpolate`: a function with exactly the extrema that someone wants, on any mesh, without data.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use morsmooth::audit::Plateaus;
use morsmooth::interpolate::{
    BoundaryValues, InterpolateError, InterpolateOptions, Interpolated, Interpolator, interpolate_near, interpolate_wanted,
};
use morsmooth::monotone::ValueRule;
use morsmooth::plot::{FieldView, PictureOptions, field_picture};
use morsmooth::qp::QpStatus;
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::{GuideKind, LengthArgs, MethodKind, OutlineArgs, TalkArgs};
use crate::common::beside::fitting;
use crate::common::input::FieldInput;
use crate::common::number::short;
use crate::common::output::{check_output, check_target};
use crate::common::report::{audit_json, audit_line, command_line, header, status_name, wanted_json, write_report};
use crate::common::shape_input::{domain, load};
use crate::common::talk::Talk;
use crate::common::written::{OrderArrays, Produced, write_and_audit};
use crate::failure::Failure;
use crate::functions::by_hand::{HandWish, wanted, wishes};
use crate::functions::interpolate_data::Data;

/// `morsmooth interpolate`.
#[derive(Debug, Args)]
pub struct InterpolateArgs {
    /// Mesh, grid or image; a table .csv with columns x and y, or without a header, is an outline to be filled, any other a series.
    pub input: PathBuf,

    /// File to write: the input with one more array.
    pub output: PathBuf,

    /// Wanted minima, one a line: 'point' or 'point,value' or 'x,y,value' or 'x,y,z,value', or columns of these names; or JSON:
    /// [{"point": 17, "value": 0.5}, {"position": [x, y, z], "value": [0.2, 0.8]}], or a report of 'smooth' or 'interpolate'.
    ///
    /// A value may be missing (free) or an interval (0.2..0.8). A position means the nearest vertex.
    #[arg(long, value_name = "FILE")]
    pub minima: Option<PathBuf>,

    /// Wanted maxima, likewise.
    #[arg(long, value_name = "FILE")]
    pub maxima: Option<PathBuf>,

    /// How the function is found. Only monotone promises that it has no other extrema, and only it takes free values and intervals.
    #[arg(long, value_enum, default_value_t = MethodKind::Monotone)]
    pub method: MethodKind,

    /// Order of the energy, 1 to 4.
    #[arg(long, value_name = "K", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=4))]
    pub order: u8,

    /// The function that gives every edge its direction.
    #[arg(long, value_enum, default_value_t = GuideKind::Automatic)]
    pub representative: GuideKind,

    /// Point array of the input to stay close to, by --method monotone; then every value may be left free. Points with NaN have no data.
    #[arg(long, value_name = "NAME")]
    pub data: Option<String>,

    /// With --data: how far noise is averaged away.
    #[command(flatten)]
    pub length: LengthArgs,

    /// Rounds in which the solution becomes the representative function of the next.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub refine: usize,

    /// Array whose zeros are holes in the domain.
    #[arg(long, value_name = "NAME")]
    pub mask: Option<String>,

    /// Name of the array written.
    #[arg(long, value_name = "NAME", default_value = "interpolated", visible_alias = "name")]
    pub output_array: String,

    /// How an outline is filled.
    #[command(flatten)]
    pub outline: OutlineArgs,

    /// Draw the function and its extrema: .png.
    #[arg(long, value_name = "FILE.png")]
    pub plot: Option<PathBuf>,

    /// Write the output even if the audit fails.
    #[arg(long)]
    pub keep_unaudited: bool,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// Runs the command.
pub fn run(args: &InterpolateArgs) -> Result<Outcome, Failure> {
    let begin = Instant::now();
    let lists: Vec<&Path> = [&args.minima, &args.maxima].into_iter().flatten().map(PathBuf::as_path).collect();
    check_output(&args.input, &args.output, args.talk.report.as_deref(), &lists)?;
    if let Some(list) = lists.iter().find(|list| morsmooth::io::is_same_file(list, &args.output)) {
        return Err(Failure::file(&args.output, format!("the output would overwrite {}; expected another name", list.display())));
    }
    args.plot.as_deref().map_or(Ok(()), check_target)?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let dataset = fitting(load(&args.input, &args.outline)?, &args.output)?;
    if dataset.point_array(&args.output_array).is_some() {
        let text = format!("the result would replace the array '{}' of the input; expected another --output-array", args.output_array);
        return Err(Failure::file(&args.input, text));
    }
    let input = domain(&args.input, dataset, args.mask.as_ref(), &args.output_array)?;
    input.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
    let wishes = wishes(args.minima.as_deref(), args.maxima.as_deref(), &input)?;
    let (extrema, rules) = wanted(&wishes, input.domain.complex.vertex_count());
    let data = Data::of(args, &input, &talk)?;
    talk.stage("solving");
    let found = solve(args, &input, &wishes, data.as_ref())?;

    talk.stage("writing, and audit of the file as written");
    let produced = Produced {
        input: &input,
        name: &args.output_array,
        values: &found.values,
        wanted: &extrema,
        rules: &rules,
        plateaus: Plateaus::Refused,
    };
    let (pending, verdicts) = write_and_audit(&args.output, std::slice::from_ref(&produced), OrderArrays::Omitted)?;
    let audit = &verdicts[0];
    let promised = args.method == MethodKind::Monotone;
    let is_kept = audit.passed || !promised || args.keep_unaudited;
    if let Some(target) = &args.plot {
        let spurious = |count: usize, wanted: usize| format!("{count} of which {wanted} wanted");
        let title = format!(
            "{}, order {}: minima {}, maxima {}",
            args.method.method(),
            args.order,
            spurious(audit.found_minima, extrema.minima.len()),
            spurious(audit.found_maxima, extrema.maxima.len())
        );
        let real = morsmooth::audit::extrema(&input.domain.complex, &found.values).map_err(|error| Failure::file(&args.input, error))?;
        let view = FieldView { title: &title, values: &found.values, minima: &real.minima, maxima: &real.maxima };
        let options = PictureOptions { label: args.output_array.clone(), ..PictureOptions::default() };
        field_picture(&input.domain.complex, &view, &options)
            .and_then(|picture| picture.write_png(target))
            .map_err(|error| Failure::file(target, error))?;
    }
    match is_kept {
        true => pending.commit().map_err(|error| Failure::usage(error.to_string()))?,
        false => drop(pending),
    }
    talk.finish();
    let report = &found.report;
    if report.status != QpStatus::Solved {
        let gap = report.gap;
        talk.warn(&format!("the solver ended {}: not proven optimal (relative gap {gap:.1e})", status_name(&report.status)));
    }
    let verdict = match (audit.passed, promised) {
        (true, _) | (false, true) => audit_line(audit),
        (false, false) => {
            format!("{} spurious, {} missing extrema; this method promises none", audit.spurious.count, audit.missing.count)
        }
    };
    let range = found.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)));
    if let Some(path) = &args.talk.report {
        let mut told = header(&input);
        told["command"] = json!(command_line());
        told["output"] = json!(args.output);
        told["output_array"] = json!(args.output_array);
        told["method"] = json!(args.method.method());
        told["order"] = json!(args.order);
        told["written"] = json!(is_kept);
        told["audit"] = audit_json(&input, audit);
        told["wanted"] = wanted_json(&input, &extrema, &found.values, &rules);
        told["range"] = json!([range.0, range.1]);
        told["energy"] = json!(report.energy);
        told["data"] = json!(data.as_ref().map(|data| data.told(&found.values)));
        told["solver"] = solver_json(&found);
        told["seconds"] = json!(begin.elapsed().as_secs_f64());
        write_report(path, &told)?;
    }
    if !args.talk.quiet {
        use std::io::Write;
        let mut out = std::io::stdout().lock();
        let mut lines = vec![
            ("domain", format!("{} vertices, dimension {}", input.values.len(), input.domain.complex.dimension())),
            ("wanted", format!("{} minima, {} maxima", extrema.minima.len(), extrema.maxima.len())),
            ("method", format!("{} of order {}", args.method.method(), args.order)),
            ("values", format!("{} to {}", short(range.0), short(range.1))),
            ("energy", format!("{:.6e}", report.energy)),
            ("solver", format!("{}, {} iterations, {} of {} constraints active", status_name(&report.status), report.iterations, report.active_rows, report.rows)),
            ("audit", verdict),
            ("output", if is_kept { format!("{}, array {}", args.output.display(), args.output_array) } else { "none".to_owned() }),
        ];
        if let Some(data) = &data {
            lines.insert(3, ("data", data.line(&found.values)));
        }
        for (what, text) in lines {
            let _ = writeln!(out, "{what:<15} {text}");
        }
    }
    Ok(if audit.passed || !promised { Outcome::Done } else { Outcome::NotMet })
}

/// The solver's part of a report.
pub fn solver_json(found: &Interpolated) -> Value {
    let report = &found.report;
    json!({
        "status": status_name(&report.status), "iterations": report.iterations, "factorizations": report.factorizations,
        "rows": report.rows, "active_rows": report.active_rows, "residual": report.residual, "gap": report.gap,
        "guide_replaced": report.guide_replaced, "largest_repair": report.largest_repair, "seconds": report.seconds,
    })
}

fn solve(args: &InterpolateArgs, input: &FieldInput, wishes: &[HandWish], data: Option<&Data>) -> Result<Interpolated, Failure> {
    let complex = &input.domain.complex;
    let (extrema, rules) = wanted(wishes, complex.vertex_count());
    let options = InterpolateOptions {
        guide: args.representative.guide(),
        refine: args.refine,
        ..InterpolateOptions::default()
    };
    let told = |error: InterpolateError| failure(&error, input, wishes);
    let mut interpolator = Interpolator::new(complex, usize::from(args.order)).map_err(told)?;
    if let Some(data) = data {
        return interpolate_near(&interpolator, &extrema, &rules, &data.nearness(), &options).map_err(told);
    }
    let open = wishes.iter().find(|wish| !matches!(wish.rule, ValueRule::Exactly(_)));
    match (args.method, open) {
        (MethodKind::Monotone, Some(_)) => interpolate_wanted(&interpolator, &extrema, &rules, &options).map_err(told),
        (method, Some(open)) => Err(Failure::usage(format!(
            "{} has no single value, which the method {} needs; expected one, or --method monotone",
            open.described(input),
            method.method()
        ))),
        (method, None) => {
            let exact = |wish: &HandWish| match wish.rule {
                ValueRule::Exactly(value) => Some((wish.vertex, value)),
                ValueRule::Free | ValueRule::Within(..) => None,
            };
            let values = wishes.iter().filter_map(exact).collect();
            let given = BoundaryValues { values, wanted: Some(extrema) };
            interpolator.solve(method.method(), &given, &options).map_err(told)
        }
    }
}

/// A refusal in the words of the files that hold the wishes.
fn failure(error: &InterpolateError, input: &FieldInput, wishes: &[HandWish]) -> Failure {
    let described = |vertex| match wishes.iter().find(|wish| wish.vertex == vertex) {
        Some(wish) => wish.described(input),
        None => format!("point {}", input.domain.point_of_vertex()[vertex.index()]),
    };
    let text = match error {
        InterpolateError::Contradiction { low, low_value, high, high_value } => format!(
            "{} has the value {low_value:?} and {} the value {high_value:?}; expected the first below the second, since no function with \
             these extrema alone has them",
            described(*low),
            described(*high)
        ),
        other => other.to_string(),
    };
    Failure::file(&input.path, text)
}
