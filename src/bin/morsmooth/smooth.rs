//! `morsmooth smooth`: read, smooth, write beside, read back, audit, rename.

use std::path::Path;
use std::time::Instant;

use morsmooth::audit::{AuditReport, Plateaus, Wanted, audit};
use morsmooth::io::{ArrayData, DataArray, is_same_file, read, write_temporary};
use morsmooth::monotone::{EdgeSet, Precision, Strategy, Strictness, ValueRule};
use morsmooth::morse::{Selection, Threshold};
use morsmooth::smooth::{ExtremumValues, Length, SelectOn, SmoothOptions, Smoothed, smooth};

use crate::Outcome;
use crate::args::{EdgesKind, SelectKind, SelectionArgs, SmoothArgs, StrategyKind, ValuesKind};
use crate::failure::Failure;
use crate::input::{FieldInput, PointKind, read_points, weights_array};
use crate::output::{check_directory, check_report, check_target};
use crate::report::{SmoothJob, write_report};
use crate::talk::Talk;

/// Runs the command.
pub fn run(args: &SmoothArgs) -> Result<Outcome, Failure> {
    let begin = Instant::now();
    if is_same_file(&args.field.input, &args.output) {
        return Err(Failure::file(&args.output, "the output is the input file; expected another name")
            .hint("the input is never changed; write to another file and rename it yourself"));
    }
    check_target(&args.output)?;
    let keep = args.selection.keep.as_deref();
    let others: Vec<&Path> = [args.field.input.as_path(), args.output.as_path()].into_iter().chain(keep).collect();
    check_report(args.talk.report.as_deref(), &others)?;
    if keep.is_some_and(|keep| is_same_file(keep, &args.output)) {
        return Err(Failure::file(&args.output, "the output would overwrite the file of --keep; expected another name"));
    }
    check_directory(args.plots.as_deref())?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let input = FieldInput::load(&args.field)?;
    let read_seconds = begin.elapsed().as_secs_f64();
    for note in &input.notes {
        talk.line(&format!("note: {note}"));
    }
    let output_array = args.output_array.clone().unwrap_or_else(|| format!("{}_smooth", input.name));
    check_output_array(&output_array, args, &input)?;
    if input.dataset.point_array(&output_array).is_some() {
        talk.line(&format!("note: the array {output_array} of the input is replaced in the output"));
    }

    let confidence = args.confidence.as_deref().map(|name| weights_array(&input, name)).transpose()?;
    let smoothness = args.smoothness.as_deref().map(|name| weights_array(&input, name)).transpose()?;
    let options = SmoothOptions {
        select_on: match args.select {
            SelectKind::Data => SelectOn::Data,
            SelectKind::Smooth => SelectOn::Smooth,
        },
        order: usize::from(args.order),
        length: match (args.length, args.length_abs) {
            (Some(fraction), _) => Length::OfDiagonal(fraction),
            (None, Some(length)) => Length::Absolute(length),
            (None, None) => Length::Automatic,
        },
        confidence: confidence.as_deref(),
        smoothness: smoothness.as_deref(),
        values: match args.values {
            ValuesKind::Keep => ExtremumValues::Keep,
            ValuesKind::Free => ExtremumValues::Free,
            ValuesKind::Within(part) => ExtremumValues::Within(part),
        },
        strategy: match args.representative {
            StrategyKind::SmoothThenSimplify => Strategy::SmoothThenSimplify,
            StrategyKind::Flood => Strategy::Flood,
            StrategyKind::Separatrix => Strategy::Separatrix,
            StrategyKind::Harmonic => Strategy::Harmonic,
        },
        edges: match args.edges {
            EdgesKind::Minimal => EdgeSet::Minimal,
            EdgesKind::All => EdgeSet::All,
        },
        refine: args.refine,
        precision: input.precision,
        strictness: if args.raw { Strictness::TiesByIndex } else { Strictness::Plain },
        relative_gap: args.gap,
        ..SmoothOptions::new(selection(&args.selection, &input)?)
    };
    let result = smooth(&input.domain.complex, &input.values, &options, &mut |step| talk.progress(&step))
        .map_err(|error| input.smooth_failure(&error))?;

    talk.stage("writing");
    let writing = Instant::now();
    let mut dataset = input.dataset.clone();
    dataset.set_point_array(output_values(&input, &output_array, &result.values));
    let pending = write_temporary(&args.output, &dataset).map_err(|error| Failure::usage(error.to_string()))?;
    talk.stage("audit of the file as written");
    let verdict = audit_written(pending.path(), &input, &output_array, &result, args.raw)?;
    let write_seconds = writing.elapsed().as_secs_f64();
    let keep = verdict.passed || args.keep_unaudited;
    let job = SmoothJob {
        args,
        input: &input,
        output_array: &output_array,
        result: &result,
        audit: &verdict,
        written: keep,
        read_seconds,
        write_seconds,
        seconds: begin.elapsed().as_secs_f64(),
    };
    if let Some(directory) = &args.plots {
        talk.stage("pictures");
        crate::pictures::smooth(directory, &job)?;
    }
    // Last, so that whatever fails before leaves no output.
    if keep {
        pending.commit().map_err(|error| Failure::usage(error.to_string()))?;
    } else {
        drop(pending);
    }
    talk.finish();
    if let Some(warning) = job.warning() {
        talk.warn(&warning);
    }
    if let Some(path) = &args.talk.report {
        write_report(path, &job.to_json())?;
    }
    if !args.talk.quiet {
        job.print_summary();
    }
    Ok(if verdict.passed { Outcome::Done } else { Outcome::NotMet })
}

/// Refuses a result in the place of an array that decided on it.
///
/// Every other array of the input stays as it is; only the array worked on and an earlier result may be replaced.
fn check_output_array(name: &str, args: &SmoothArgs, input: &FieldInput) -> Result<(), Failure> {
    if name.is_empty() {
        return Err(Failure::usage("found an empty name for --output-array; expected a name"));
    }
    let roles = [("--mask", &args.field.mask), ("--confidence", &args.confidence), ("--smoothness", &args.smoothness)];
    match roles.iter().find(|(_, array)| array.as_deref() == Some(name)) {
        Some((role, _)) => {
            Err(Failure::usage(format!("the result would replace the array '{name}' of {role}; expected another --output-array")))
        }
        None => {
            let is_worked_on = args.field.derive.is_none() && name == input.name;
            let is_earlier_result = name == format!("{}_smooth", input.name);
            if input.dataset.point_array(name).is_none() || is_worked_on || is_earlier_result {
                return Ok(());
            }
            Err(Failure::usage(format!("the result would replace the array '{name}' of the input; expected another --output-array")))
        }
    }
}

fn selection(args: &SelectionArgs, input: &FieldInput) -> Result<Selection, Failure> {
    if let Some(fraction) = args.persistence {
        return Ok(Selection::Threshold(Threshold::Fraction(fraction)));
    }
    if let Some(value) = args.persistence_abs {
        return Ok(Selection::Threshold(Threshold::Absolute(value)));
    }
    if let Some(count) = args.extrema {
        return Ok(Selection::Count(count));
    }
    if let Some(path) = &args.keep {
        return Ok(Selection::Set(read_points(path, PointKind::Extrema, input)?));
    }
    Err(Failure::usage("found no wanted extrema; expected one of --persistence, --persistence-abs, --extrema, --keep")
        .hint("'morsmooth extrema FILE' shows what each threshold would leave; --persistence 10% is a good start"))
}

/// The array written: smoothed on the domain, the input's own values elsewhere.
fn output_values(input: &FieldInput, name: &str, values: &[f64]) -> DataArray {
    let mut on_points = input.on_points.clone();
    input.domain.extend(values, &mut on_points);
    let data = match input.precision {
        Precision::F32 => ArrayData::F32(on_points.iter().map(|&value| value as f32).collect()),
        Precision::F64 => ArrayData::F64(on_points),
    };
    DataArray::new(name, 1, data)
}

/// Reads the written file back and judges the array in it.
fn audit_written(
    path: &Path,
    input: &FieldInput,
    array: &str,
    result: &Smoothed,
    raw: bool,
) -> Result<AuditReport, Failure> {
    let written = read(path).map_err(|error| Failure::usage(format!("the file just written cannot be read back: {error}")))?;
    let values = written
        .point_array(array)
        .map(|array| input.domain.restrict(&array.to_f64(0)))
        .ok_or_else(|| Failure::file(path, format!("the array {array} just written is not in the file")))?;
    let with_rule = |vertices: &[morsmooth::field::VertexId]| -> Vec<_> {
        let rule = |rule: &ValueRule| match *rule {
            ValueRule::Free => None,
            ValueRule::Exactly(value) => Some(morsmooth::audit::ValueRule::Exactly(value)),
            ValueRule::Within(low, high) => Some(morsmooth::audit::ValueRule::Within(low, high)),
        };
        vertices.iter().map(|&vertex| (vertex, rule(&result.rules[vertex.index()]))).collect()
    };
    let (minima, maxima) = (with_rule(&result.wanted.minima), with_rule(&result.wanted.maxima));
    let plateaus = if raw { Plateaus::Allowed } else { Plateaus::Refused };
    let wanted = Wanted { minima: &minima, maxima: &maxima, plateaus };
    audit(&input.domain.complex, &values, &wanted).map_err(|error| Failure::file(path, error))
}
