//! `morsmooth smooth` of several data sets: as many at once as there are threads, each on its own, none twice.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use morsmooth::io::{CollectionKind, DataSet, PendingFile, fingerprint, read, write_temporary};
use rayon::ThreadPoolBuilder;
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::{FieldsArgs, SelectionArgs, SmoothArgs};
use crate::common::ground::Grounds;
use crate::common::input::has_fields;
use crate::common::journal::{Journal, Record, hexadecimal, place};
use crate::common::output::{check_directory, check_output, is_same_place};
use crate::common::steps::{Series, Step};
use crate::common::steps_report::{Ended, Made, SeriesReport};
use crate::common::talk::Talk;
use crate::common::wishes::{check_any, check_keep};
use crate::failure::Failure;
use crate::fields::smooth::{Request, SmoothedFile, smooth_file};

/// Runs the command on several data sets.
pub fn run(args: &SmoothArgs, series: &Series) -> Result<Outcome, Failure> {
    let begin = Instant::now();
    check(args, series)?;
    let settings = settings(args)?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage(&format!("{} {}", series.steps.len(), series.noun()));
    let grounds = Grounds::across_files();
    let journal = Journal::open(&args.output)?;
    let work = Work { args, series, settings: &settings, grounds: &grounds, journal: &journal, talk: &talk };
    let mut ended = work.all()?;
    if ended.iter().all(|ended| ended.made == Made::Unchanged) {
        let text = format!("found no array to work on in any of {} blocks; expected one in at least one block", ended.len());
        return Err(Failure::file(&args.field.input, text).hint(format!("'morsmooth info {}' lists what is there", args.field.input.display())));
    }
    let waiting = ended.iter_mut().filter_map(|ended| ended.pending.take());
    waiting.into_iter().try_for_each(PendingFile::commit).map_err(|error| Failure::usage(error.to_string()))?;
    talk.stage("writing the list");
    let files: Vec<Option<PathBuf>> = ended.iter().map(|ended| ended.file.clone()).collect();
    let report = SeriesReport { args, series, ended: &ended, domains: grounds.made(), begin };
    let pending = series.write(&files, &report.times())?;
    if let Some(directory) = &args.plots {
        talk.stage("pictures");
        report.draw(directory)?;
    }
    let is_written = !pending.is_empty();
    pending.into_iter().try_for_each(PendingFile::commit).map_err(|error| Failure::usage(error.to_string()))?;
    let finished: Vec<&Record> = ended.iter().filter_map(|ended| ended.record.as_ref()).collect();
    journal.close(&finished)?;
    talk.finish();
    report.tell(&talk, is_written)?;
    match report.failure() {
        Some(failure) => Err(failure),
        None if ended.iter().any(Ended::is_not_met) => Ok(Outcome::NotMet),
        None => Ok(Outcome::Done),
    }
}

/// What can be refused before any work.
fn check(args: &SmoothArgs, series: &Series) -> Result<(), Failure> {
    let keep: Vec<&Path> = args.selection.keep.as_deref().into_iter().collect();
    check_output(&args.field.input, &args.output, args.talk.report.as_deref(), &keep)?;
    check_keep(&args.selection, &args.output)?;
    check_directory(args.plots.as_deref())?;
    check_any(&args.selection)?;
    let journal = place(&args.output);
    let others = [Some(args.field.input.as_path()), args.selection.keep.as_deref(), args.talk.report.as_deref()];
    if let Some(other) = others.iter().flatten().find(|other| is_same_place(other, &journal)) {
        return Err(Failure::file(other, "the list of finished steps would overwrite this file; expected another name"));
    }
    series.check(&args.output, &others)
}

/// Everything that decides on the bits of an output but its input, in words: a step made with other settings is made again.
fn settings(args: &SmoothArgs) -> Result<String, Failure> {
    let SmoothArgs {
        field: FieldsArgs { input: _, array, array_pattern, mask, derive },
        output: _,
        output_array,
        selection: SelectionArgs { persistence, persistence_abs, extrema, keep },
        select,
        values,
        keep_also,
        order,
        length,
        confidence,
        smoothness,
        representative,
        edges,
        refine,
        gap,
        raw,
        plots: _,
        keep_unaudited,
        talk: _,
    } = args;
    let told = |error: morsmooth::io::IoError| Failure::usage(error.to_string());
    let keep = keep.as_ref().map(|keep| fingerprint(keep).map(hexadecimal)).transpose().map_err(told)?;
    let field = format!("{:?}", (array, array_pattern, mask, derive, output_array, confidence, smoothness));
    let wanted = format!("{:?}", (persistence, persistence_abs, extrema, keep, select, values, keep_also));
    let energy = format!("{:?}", (order, length, representative, edges, refine, gap, raw, keep_unaudited));
    Ok(format!("morsmooth {} {field} {wanted} {energy}", env!("CARGO_PKG_VERSION")))
}

/// What the threads share.
struct Work<'a> {
    args: &'a SmoothArgs,
    series: &'a Series,
    settings: &'a str,
    grounds: &'a Grounds,
    journal: &'a Journal,
    talk: &'a Talk,
}

impl Work<'_> {
    /// Every step, in the order of the list.
    ///
    /// Each worker has a pool of its own, so that what waits within a step never begins another one: at any moment there
    /// are as many steps in memory as workers.
    fn all(&self) -> Result<Vec<Ended>, Failure> {
        let (steps, threads) = (&self.series.steps, rayon::current_num_threads());
        let workers = threads.min(steps.len()).max(1);
        let pools = (0..workers).map(|worker| ThreadPoolBuilder::new().num_threads(threads / workers + usize::from(worker < threads % workers)).build());
        let pools = pools.collect::<Result<Vec<_>, _>>().map_err(|error| Failure::usage(format!("{threads} threads could not be started: {error}")))?;
        let (next, ended) = (AtomicUsize::new(0), Mutex::new(Vec::with_capacity(steps.len())));
        std::thread::scope(|scope| {
            for pool in &pools {
                let (next, ended) = (&next, &ended);
                scope.spawn(move || {
                    pool.install(|| {
                        while let Some((number, step)) = Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|number| Some((number, steps.get(number)?))) {
                            let one = self.one(step);
                            self.talk.line(&format!("{}: {}", step.label, one.line()));
                            ended.lock().unwrap_or_else(PoisonError::into_inner).push((number, one));
                        }
                    });
                });
            }
        });
        let mut ended = ended.into_inner().unwrap_or_else(PoisonError::into_inner);
        ended.sort_by_key(|(number, _)| *number);
        Ok(ended.into_iter().map(|(_, ended)| ended).collect())
    }

    /// One step: found finished, or made. Its failure is its own.
    fn one(&self, step: &Step) -> Ended {
        let begin = Instant::now();
        match self.found_or_made(step, begin) {
            Ok(ended) => ended,
            Err(failure) => Ended::failed(failure),
        }
    }

    fn found_or_made(&self, step: &Step, begin: Instant) -> Result<Ended, Failure> {
        let input = hexadecimal(fingerprint(&step.input).map_err(|error| Failure::usage(error.to_string()))?);
        if let Some(record) = self.journal.finished(&step.stem, self.settings, &input) {
            return Ok(Ended::found(step, record.clone()));
        }
        let dataset = Arc::new(read(&step.input).map_err(|error| Failure::usage(error.to_string()))?);
        let target = step.target(dataset.geometry.extension());
        let time = time_value(&dataset);
        let passes_by = self.series.kind == CollectionKind::Blocks && !has_fields(&dataset, &self.args.field);
        let (pending, made, results, warnings) = if passes_by {
            let pending = write_temporary(&target, &dataset).map_err(|error| Failure::usage(error.to_string()))?;
            (pending, Made::Unchanged, Vec::new(), Vec::new())
        } else {
            let quiet = Talk::new(true);
            let request = Request { args: self.args, input: &step.input, grounds: self.grounds, talk: &quiet };
            let file = smooth_file(&request, &dataset, &target, begin)?;
            let (results, warnings) = facts(self.args, &file);
            let made = if file.passed { Made::Smoothed } else { Made::NotMet };
            if !file.is_kept {
                return Ok(Ended { made, file: None, told: json!({ "time_value": time, "results": results }), warnings, failure: None, record: None, pending: None });
            }
            (file.pending, made, results, warnings)
        };
        let told = json!({ "made": made, "time_value": time, "results": results });
        let failed = |error: morsmooth::io::IoError| Failure::usage(error.to_string());
        let content = hexadecimal(fingerprint(pending.path()).map_err(failed)?);
        let bytes = std::fs::metadata(pending.path()).map_err(|error| Failure::file(pending.path(), error))?.len();
        let name = target.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let record = Record { file: name, bytes, content, input, settings: self.settings.to_owned(), told: told.clone() };
        let mut ended = Ended { made, file: Some(target), told, warnings, failure: None, record: None, pending: None };
        if made == Made::Unchanged {
            // It is worth a file only if another block is.
            ended.pending = Some(pending);
        } else {
            // The file first: what the journal says is finished is.
            pending.commit().map_err(failed)?;
            self.journal.add(&record)?;
        }
        ended.record = Some(record);
        Ok(ended)
    }
}

/// The report of each result without what is as large as its field, and what nobody may miss.
fn facts(args: &SmoothArgs, file: &SmoothedFile) -> (Vec<Value>, Vec<String>) {
    let jobs = file.jobs(args);
    let results = jobs.iter().map(|job| {
        let mut report = job.to_json();
        if let Value::Object(entries) = &mut report {
            ["program", "version", "command", "wanted", "minima_pairs", "maxima_pairs"].iter().for_each(|key| drop(entries.remove(*key)));
        }
        report
    });
    (results.collect(), jobs.iter().filter_map(|job| job.warning()).collect())
}

/// The time that a file itself tells.
fn time_value(dataset: &DataSet) -> Option<f64> {
    let array = dataset.field_data.iter().find(|array| array.name == "TimeValue")?;
    array.to_f64(0).first().copied().filter(|time| time.is_finite())
}
