//! `morsmooth smooth`: read, smooth, write beside, read back, audit, rename.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use morsmooth::audit::{AuditReport, Plateaus};
use morsmooth::io::{DataSet, PendingFile, read};
use morsmooth::monotone::{EdgeSet, Strategy, Strictness};
use morsmooth::morse::Selection;
use morsmooth::smooth::{ExtremumValues, KeepAlso, SelectOn, SmoothError, SmoothOptions, Smoothed, Smoother, check_field};
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::{EdgesKind, FieldsArgs, KeepAlsoKind, SelectKind, SmoothArgs, StrategyKind, ValuesKind};
use crate::common::ground::Grounds;
use crate::common::input::{FieldInput, weights_array};
use crate::common::output::{check_directory, check_output};
use crate::common::report::{SmoothJob, print_lines, write_report};
use crate::common::steps::Series;
use crate::common::talk::Talk;
use crate::common::wishes::{Wish, array_names, check_keep, check_single_name, wishes};
use crate::common::written::{OrderArrays, Produced, write_and_audit};
use crate::failure::Failure;

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

/// One file to smooth.
pub struct Request<'a> {
    /// What is asked.
    pub args: &'a SmoothArgs,
    /// The file to read.
    pub input: &'a Path,
    /// Domains that other files may have too.
    pub grounds: &'a Grounds,
    /// Who listens.
    pub talk: &'a Talk,
}

/// A file smoothed, written beside its place and audited.
pub struct SmoothedFile {
    /// Its fields.
    pub inputs: Vec<FieldInput>,
    /// Whether every array passed the audit.
    pub passed: bool,
    /// Whether it shall be put in its place.
    pub is_kept: bool,
    /// The file as written.
    pub pending: PendingFile,
    output: PathBuf,
    /// Of each result the number of its field and the name of its array.
    names: Vec<(usize, String)>,
    results: Vec<Smoothed>,
    verdicts: Vec<AuditReport>,
    read_seconds: f64,
    write_seconds: f64,
    seconds: f64,
}

impl SmoothedFile {
    /// What there is to tell of each result.
    pub fn jobs<'a>(&'a self, args: &'a SmoothArgs) -> Vec<SmoothJob<'a>> {
        self.names
            .iter()
            .zip(&self.results)
            .zip(&self.verdicts)
            .map(|(((input, output_array), result), audit)| SmoothJob {
                args,
                output: &self.output,
                input: &self.inputs[*input],
                output_array,
                result,
                audit,
                written: self.is_kept,
                read_seconds: self.read_seconds,
                write_seconds: self.write_seconds,
                seconds: self.seconds,
            })
            .collect()
    }
}

/// Runs the command.
pub fn run(args: &SmoothArgs) -> Result<Outcome, Failure> {
    if let Some(series) = Series::find(&args.field.input, &args.output)? {
        return crate::fields::smooth_series::run(args, &series);
    }
    let begin = Instant::now();
    let keep: Vec<&Path> = args.selection.keep.as_deref().into_iter().collect();
    check_output(&args.field.input, &args.output, args.talk.report.as_deref(), &keep)?;
    check_keep(&args.selection, &args.output)?;
    check_directory(args.plots.as_deref())?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let request = Request { args, input: &args.field.input, grounds: &Grounds::of_one_file(), talk: &talk };
    let dataset = Arc::new(read(request.input).map_err(|error| Failure::usage(error.to_string()))?);
    let mut file = smooth_file(&request, &dataset, &args.output, begin)?;
    file.seconds = begin.elapsed().as_secs_f64();
    if let Some(directory) = &args.plots {
        talk.stage("pictures");
        let jobs = file.jobs(args);
        for job in &jobs {
            // One result draws into the directory itself, several each into a directory of its own.
            let own = if jobs.len() > 1 { directory.join(job.output_array.replace(['/', '\\'], "_")) } else { directory.clone() };
            crate::common::pictures::smooth(&own, job)?;
        }
    }
    talk.finish();
    let reports: Vec<Value> = file.jobs(args).iter().map(SmoothJob::to_json).collect();
    let told: Vec<(Option<String>, Vec<String>)> = file.jobs(args).iter().map(|job| (job.warning(), job.summary())).collect();
    let passed = file.passed;
    // Last, so that whatever fails before leaves no output.
    if file.is_kept {
        file.pending.commit().map_err(|error| Failure::usage(error.to_string()))?;
    }
    told.iter().filter_map(|(warning, _)| warning.as_ref()).for_each(|warning| talk.warn(warning));
    if let Some(path) = &args.talk.report {
        let report = match reports.as_slice() {
            [only] => only.clone(),
            many => json!({ "program": "morsmooth", "version": env!("CARGO_PKG_VERSION"), "results": many }),
        };
        write_report(path, &report)?;
    }
    if !args.talk.quiet {
        told.iter().for_each(|(_, summary)| print_lines(summary));
    }
    Ok(if passed { Outcome::Done } else { Outcome::NotMet })
}

/// Smooths the fields of one data set, writes them beside `output`, and judges what was written.
pub fn smooth_file(request: &Request<'_>, dataset: &Arc<DataSet>, output: &Path, begin: Instant) -> Result<SmoothedFile, Failure> {
    let Request { args, talk, .. } = *request;
    let field = FieldsArgs { input: request.input.to_owned(), ..args.field.clone() };
    let inputs = FieldInput::all_of(dataset, &field, request.grounds)?;
    check_single_name(args.output_array.as_deref(), &inputs)?;
    let read_seconds = begin.elapsed().as_secs_f64();
    let plans = inputs.iter().map(|input| Plan::new(args, input, talk)).collect::<Result<Vec<_>, _>>()?;
    let results = smooth_all(request, &plans)?;
    let names: Vec<(usize, String)> =
        plans.iter().enumerate().flat_map(|(place, plan)| plan.names.iter().map(move |name| (place, name.clone()))).collect();
    drop(plans);

    talk.stage("writing, and audit of the file as written");
    let writing = Instant::now();
    let plateaus = if args.raw { Plateaus::Allowed } else { Plateaus::Refused };
    let arrays: Vec<Produced<'_>> = names
        .iter()
        .zip(&results)
        .map(|((input, name), result)| Produced {
            input: &inputs[*input],
            name,
            values: &result.values,
            wanted: &result.wanted,
            rules: &result.rules,
            plateaus,
        })
        .collect();
    let (pending, verdicts) = write_and_audit(output, &arrays, OrderArrays::Omitted)?;
    drop(arrays);
    let write_seconds = writing.elapsed().as_secs_f64();
    let passed = verdicts.iter().all(|verdict| verdict.passed);
    let is_kept = passed || args.keep_unaudited;
    let seconds = begin.elapsed().as_secs_f64();
    let output = output.to_owned();
    Ok(SmoothedFile { inputs, passed, is_kept, pending, output, names, results, verdicts, read_seconds, write_seconds, seconds })
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
fn smooth_all(request: &Request<'_>, plans: &[Plan<'_>]) -> Result<Vec<Smoothed>, Failure> {
    let Request { args, talk, .. } = *request;
    let mut results = Vec::new();
    for group in plans.chunk_by(|a, b| Arc::ptr_eq(&a.input.domain, &b.input.domain)) {
        let Some(first) = group.first().map(|plan| plan.input) else { continue };
        let complex = &first.domain.complex;
        for plan in group {
            // What is wrong with a field is said before its mesh is looked at.
            check_field(complex, &plan.input.values, &options(args, plan)?).map_err(|error| plan.input.smooth_failure(&error))?;
        }
        talk.stage("operators");
        let failed = |error: SmoothError| first.smooth_failure(&error);
        let shared = request.grounds.analysis(&first.domain, usize::from(args.order)).transpose().map_err(failed)?;
        let mut smoother = match &shared {
            Some(analysis) => Smoother::with_analysis(complex, analysis),
            None => Smoother::new(complex, usize::from(args.order)),
        }
        .map_err(failed)?;
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
