//! `morsmooth smooth`: read, smooth, write beside, read back, audit, rename.

use std::path::Path;
use std::rc::Rc;
use std::time::Instant;

use morsmooth::audit::Plateaus;
use morsmooth::monotone::{EdgeSet, Strategy, Strictness};
use morsmooth::morse::Selection;
use morsmooth::smooth::{ExtremumValues, KeepAlso, SelectOn, SmoothOptions, Smoothed, Smoother, check_field};
use serde_json::json;

use crate::Outcome;
use crate::args::{EdgesKind, KeepAlsoKind, SelectKind, SmoothArgs, StrategyKind, ValuesKind};
use crate::failure::Failure;
use crate::input::{FieldInput, weights_array};
use crate::output::{check_directory, check_output};
use crate::report::{SmoothJob, write_report};
use crate::talk::Talk;
use crate::wishes::{Wish, array_names, check_keep, check_single_name, wishes};
use crate::written::{OrderArrays, Produced, write_and_audit};

/// A field, what is wanted of it, and the arrays that it will give.
pub struct Plan<'a> {
    /// The field.
    pub input: &'a FieldInput,
    /// What is wanted.
    pub wishes: Vec<Wish>,
    /// An array for each wish.
    pub names: Vec<String>,
    /// Confidence in each value.
    pub confidence: Option<Vec<f64>>,
    /// Smoothness asked at each vertex.
    pub smoothness: Option<Vec<f64>>,
}

/// Runs the command.
pub fn run(args: &SmoothArgs) -> Result<Outcome, Failure> {
    let begin = Instant::now();
    let keep: Vec<&Path> = args.selection.keep.as_deref().into_iter().collect();
    check_output(&args.field.input, &args.output, args.talk.report.as_deref(), &keep)?;
    check_keep(&args.selection, &args.output)?;
    check_directory(args.plots.as_deref())?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let inputs = FieldInput::load_all(&args.field)?;
    check_single_name(args.output_array.as_deref(), &inputs)?;
    let read_seconds = begin.elapsed().as_secs_f64();
    let plans = inputs.iter().map(|input| Plan::new(args, input, &talk)).collect::<Result<Vec<_>, _>>()?;
    let results = smooth_all(args, &plans, &talk)?;

    talk.stage("writing, and audit of the file as written");
    let writing = Instant::now();
    let plateaus = if args.raw { Plateaus::Allowed } else { Plateaus::Refused };
    let named = || plans.iter().flat_map(|plan| plan.names.iter().map(|name| (plan.input, name))).zip(&results);
    let arrays: Vec<Produced<'_>> = named()
        .map(|((input, name), result)| Produced {
            input,
            name,
            values: &result.values,
            wanted: &result.wanted,
            rules: &result.rules,
            plateaus,
        })
        .collect();
    let (pending, verdicts) = write_and_audit(&args.output, &arrays, OrderArrays::Omitted)?;
    let write_seconds = writing.elapsed().as_secs_f64();
    let passed = verdicts.iter().all(|verdict| verdict.passed);
    let is_kept = passed || args.keep_unaudited;
    let jobs: Vec<SmoothJob<'_>> = named()
        .zip(&verdicts)
        .map(|(((input, output_array), result), audit)| SmoothJob {
            args,
            input,
            output_array,
            result,
            audit,
            written: is_kept,
            read_seconds,
            write_seconds,
            seconds: begin.elapsed().as_secs_f64(),
        })
        .collect();
    if let Some(directory) = &args.plots {
        talk.stage("pictures");
        for job in &jobs {
            // One result draws into the directory itself, several each into a directory of its own.
            let own = if jobs.len() > 1 { directory.join(job.output_array.replace(['/', '\\'], "_")) } else { directory.clone() };
            crate::pictures::smooth(&own, job)?;
        }
    }
    // Last, so that whatever fails before leaves no output.
    if is_kept {
        pending.commit().map_err(|error| Failure::usage(error.to_string()))?;
    } else {
        drop(pending);
    }
    talk.finish();
    jobs.iter().filter_map(SmoothJob::warning).for_each(|warning| talk.warn(&warning));
    if let Some(path) = &args.talk.report {
        let report = match jobs.as_slice() {
            [only] => only.to_json(),
            many => {
                let results: Vec<_> = many.iter().map(SmoothJob::to_json).collect();
                json!({ "program": "morsmooth", "version": env!("CARGO_PKG_VERSION"), "results": results })
            }
        };
        write_report(path, &report)?;
    }
    if !args.talk.quiet {
        jobs.iter().for_each(SmoothJob::print_summary);
    }
    Ok(if passed { Outcome::Done } else { Outcome::NotMet })
}

impl<'a> Plan<'a> {
    fn new(args: &SmoothArgs, input: &'a FieldInput, talk: &Talk) -> Result<Self, Failure> {
        input.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
        let wishes = wishes(&args.selection, input)?;
        let roles = [
            ("--mask", args.field.mask.as_deref()),
            ("--confidence", args.confidence.as_deref()),
            ("--smoothness", args.smoothness.as_deref()),
        ];
        let names = array_names(args.output_array.as_deref(), "_smooth", input, &wishes, &roles)?;
        for name in names.iter().filter(|name| input.dataset.point_array(name).is_some()) {
            talk.line(&format!("note: the array {name} of the input is replaced in the output"));
        }
        let weights = |name: &Option<String>| name.as_deref().map(|name| weights_array(input, name)).transpose();
        Ok(Self { input, wishes, names, confidence: weights(&args.confidence)?, smoothness: weights(&args.smoothness)? })
    }
}

/// One result a field and wish, in that order. Fields on one domain share its matrices and their analysis.
fn smooth_all(args: &SmoothArgs, plans: &[Plan<'_>], talk: &Talk) -> Result<Vec<Smoothed>, Failure> {
    let mut results = Vec::new();
    for group in plans.chunk_by(|a, b| Rc::ptr_eq(&a.input.domain, &b.input.domain)) {
        let Some(first) = group.first().map(|plan| plan.input) else { continue };
        let complex = &first.domain.complex;
        for plan in group {
            // What is wrong with a field is said before its mesh is looked at.
            check_field(complex, &plan.input.values, &options(args, plan)?).map_err(|error| plan.input.smooth_failure(&error))?;
        }
        talk.stage("operators");
        let mut smoother = Smoother::new(complex, usize::from(args.order)).map_err(|error| first.smooth_failure(&error))?;
        for plan in group {
            if plans.len() > 1 {
                talk.stage(&plan.input.name);
            }
            let selections: Vec<Selection> = plan.wishes.iter().map(|wish| wish.selection.clone()).collect();
            let smoothed =
                smoother.smooth_each(&plan.input.values, &selections, &options(args, plan)?, &mut |step| talk.progress(&step));
            results.extend(smoothed.map_err(|error| plan.input.smooth_failure(&error))?);
        }
    }
    Ok(results)
}

/// The options of the library for one field.
pub fn options<'a>(args: &SmoothArgs, plan: &'a Plan<'_>) -> Result<SmoothOptions<'a>, Failure> {
    let Some(wish) = plan.wishes.first() else { return Err(Failure::usage("found no wanted extrema; expected some")) };
    Ok(SmoothOptions {
        select_on: match args.select {
            SelectKind::Data => SelectOn::Data,
            SelectKind::Smooth => SelectOn::Smooth,
        },
        order: usize::from(args.order),
        length: args.length.length(),
        confidence: plan.confidence.as_deref(),
        smoothness: plan.smoothness.as_deref(),
        values: match args.values {
            ValuesKind::Keep => ExtremumValues::Keep,
            ValuesKind::Free => ExtremumValues::Free,
            ValuesKind::Within(part) => ExtremumValues::Within(part),
        },
        keep_also: match args.keep_also {
            None => KeepAlso::Nothing,
            Some(KeepAlsoKind::Saddles) => KeepAlso::Saddles,
            Some(KeepAlsoKind::Separatrices) => KeepAlso::Separatrices,
            Some(KeepAlsoKind::Both) => KeepAlso::Both,
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
        precision: plan.input.precision,
        strictness: if args.raw { Strictness::TiesByIndex } else { Strictness::Plain },
        relative_gap: args.gap,
        ..SmoothOptions::new(wish.selection.clone())
    })
}
