//! What is said of several data sets together: one report, one summary, one set of charts.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use morsmooth::io::{CollectionKind, PendingFile};
use morsmooth::plot::{CountsChart, StepCounts, write_atomically};
use serde::Serialize;
use serde_json::{Value, json};

use crate::args::SmoothArgs;
use crate::common::journal::Record;
use crate::common::report::{command_line, print_lines, write_report};
use crate::common::steps::{Series, Step};
use crate::common::talk::Talk;
use crate::failure::Failure;

/// Failures named on the screen; the report has them all.
const SHOWN: usize = 10;

/// What became of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Made {
    /// Smoothed, and the audit passed.
    Smoothed,
    /// Smoothed, and the audit failed.
    NotMet,
    /// A block without the array, written as it is.
    Unchanged,
    /// Finished by an earlier run.
    Found,
    /// Neither read nor smoothed.
    Failed,
}

/// How a step ended.
pub struct Ended {
    /// What became of it.
    pub made: Made,
    /// The file in its place.
    pub file: Option<PathBuf>,
    /// What was measured, now or then.
    pub told: Value,
    /// What nobody may miss.
    pub warnings: Vec<String>,
    /// Why it failed.
    pub failure: Option<Failure>,
    /// What makes it finished for the next run.
    pub record: Option<Record>,
    /// A file that takes its place when all steps have ended.
    pub pending: Option<PendingFile>,
}

impl Ended {
    /// It failed.
    pub fn failed(failure: Failure) -> Self {
        Self { made: Made::Failed, file: None, told: json!({}), warnings: Vec::new(), failure: Some(failure), record: None, pending: None }
    }

    /// An earlier run finished it.
    pub fn found(step: &Step, record: Record) -> Self {
        let file = step.stem.with_file_name(&record.file);
        Self { made: Made::Found, file: Some(file), told: record.told.clone(), warnings: Vec::new(), failure: None, record: Some(record), pending: None }
    }

    /// Whether its audit failed, in this run or in the one that wrote its file (--keep-unaudited).
    pub fn is_not_met(&self) -> bool {
        self.made == Made::NotMet || self.told["made"] == json!(Made::NotMet)
    }

    /// In a line.
    pub fn line(&self) -> String {
        let counts: Vec<String> = self.counts().map(|(_, before, after)| format!("{} -> {} extrema", total(before), total(after))).collect();
        match self.made {
            Made::Smoothed => counts.join(", "),
            Made::NotMet => format!("{}, the audit FAILED", counts.join(", ")),
            Made::Unchanged => "has no such array, written unchanged".to_owned(),
            Made::Found => "finished before".to_owned(),
            Made::Failed => "failed".to_owned(),
        }
    }

    /// Of each result the name of its array, and its minima and maxima before and after.
    fn counts(&self) -> impl Iterator<Item = (&str, [usize; 2], [usize; 2])> {
        let results = self.told["results"].as_array().map(Vec::as_slice).unwrap_or_default();
        results.iter().filter_map(|result| {
            let number = |value: &Value| value.as_u64().and_then(|count| usize::try_from(count).ok());
            let pair = |of: &Value| Some([number(&of["minima"])?, number(&of["maxima"])?]);
            Some((result["output_array"].as_str()?, pair(&result["smooth"]["before"])?, pair(&result["audit"])?))
        })
    }
}

/// The blocks of one time count together.
fn together(steps: &[StepCounts]) -> Vec<StepCounts> {
    let sum = |of: fn(&StepCounts) -> [usize; 2], steps: &[StepCounts]| {
        steps.iter().map(of).fold([0; 2], |sum: [usize; 2], counts| [sum[0] + counts[0], sum[1] + counts[1]])
    };
    let at_once = steps.chunk_by(|a, b| a.time == b.time);
    at_once.map(|steps| StepCounts { time: steps[0].time, before: sum(|step| step.before, steps), after: sum(|step| step.after, steps) }).collect()
}

fn total(counts: [usize; 2]) -> usize {
    counts[0] + counts[1]
}

/// Everything about one run.
pub struct SeriesReport<'a> {
    pub args: &'a SmoothArgs,
    pub series: &'a Series,
    /// One a step.
    pub ended: &'a [Ended],
    /// How many meshes were made into domains and analysed.
    pub domains: usize,
    pub begin: Instant,
}

impl SeriesReport<'_> {
    /// The time of every step: that of the list, else that of the files if all that are there tell one, else its number.
    pub fn times(&self) -> Vec<f64> {
        let steps = || self.series.steps.iter().zip(self.ended);
        let number = |(number, _)| number as f64;
        if let Some(times) = steps().map(|(step, _)| step.time).collect() {
            return times;
        }
        let told = |ended: &Ended| ended.told["time_value"].as_f64();
        let all_tell = steps().filter(|(_, ended)| ended.file.is_some()).all(|(_, ended)| told(ended).is_some());
        match all_tell && self.ended.iter().all(|ended| ended.file.is_some()) {
            true => self.ended.iter().filter_map(told).collect(),
            false => self.ended.iter().enumerate().map(number).collect(),
        }
    }

    fn count(&self, made: Made) -> usize {
        self.ended.iter().filter(|ended| ended.made == made).count()
    }

    /// Charts of the numbers of extrema, one pair an array.
    pub fn draw(&self, directory: &Path) -> Result<(), Failure> {
        std::fs::create_dir_all(directory).map_err(|error| Failure::file(directory, format!("cannot be made a directory: {error}")))?;
        let times = match self.series.kind {
            CollectionKind::Steps => self.times(),
            CollectionKind::Blocks => (0..self.ended.len()).map(|number| number as f64).collect(),
        };
        let mut arrays: BTreeMap<&str, Vec<StepCounts>> = BTreeMap::new();
        for (ended, &time) in self.ended.iter().zip(&times) {
            for (array, before, after) in ended.counts() {
                arrays.entry(array).or_default().push(StepCounts { time, before, after });
            }
        }
        let many = arrays.len() > 1;
        for (array, mut steps) in arrays {
            steps.sort_by(|a, b| a.time.total_cmp(&b.time));
            let steps = together(&steps);
            let place = if self.series.kind == CollectionKind::Steps { "time" } else { "block" };
            let chart = CountsChart { title: &format!("extrema of {array}"), place, steps: &steps };
            let name = if many { format!("extrema_over_time_{}", array.replace(['/', '\\'], "_")) } else { "extrema_over_time".to_owned() };
            let (svg, png) = (directory.join(format!("{name}.svg")), directory.join(format!("{name}.png")));
            let failed = |target: &Path, error: &dyn std::fmt::Display| Failure::file(target, error);
            chart.svg().and_then(|text| write_atomically(&svg, text.as_bytes())).map_err(|error| failed(&svg, &error))?;
            chart.picture().and_then(|picture| picture.write_png(&png)).map_err(|error| failed(&png, &error))?;
        }
        Ok(())
    }

    /// Warnings, the report, the summary.
    pub fn tell(&self, talk: &Talk, is_written: bool) -> Result<(), Failure> {
        for (step, ended) in self.series.steps.iter().zip(self.ended) {
            ended.warnings.iter().for_each(|warning| talk.warn(&format!("{}: {warning}", step.label)));
            match ended.made {
                Made::Unchanged => talk.warn(&format!("{}: it has no such array and was written unchanged", step.label)),
                Made::NotMet => talk.warn(&format!("{}: the audit FAILED{}", step.label, if ended.file.is_some() { "" } else { "; not written" })),
                _ => {}
            }
        }
        let empty = &self.series.empty;
        if !empty.is_empty() {
            talk.line(&format!("note: blocks without a file stay empty: {}", empty.join(", ")));
        }
        if let Some(path) = &self.args.talk.report {
            write_report(path, &self.to_json(is_written))?;
        }
        if !self.args.talk.quiet {
            print_lines(&self.summary(is_written));
        }
        Ok(())
    }

    fn to_json(&self, is_written: bool) -> Value {
        let times = self.times();
        let one = |(number, ((step, ended), time)): (usize, ((&Step, &Ended), &f64))| {
            json!({
                "number": number, "address": step.address, "time": time, "input": step.input, "output": ended.file, "status": ended.made,
                "error": ended.failure.as_ref().map(Failure::text), "results": ended.told["results"],
            })
        };
        let steps: Vec<Value> = self.series.steps.iter().zip(self.ended).zip(&times).enumerate().map(one).collect();
        json!({
            "program": "morsmooth", "version": env!("CARGO_PKG_VERSION"), "command": command_line(),
            "input": self.args.field.input, "output": self.args.output, "written": is_written,
            "kind": self.series.noun(), "empty": self.series.empty,
            "counts": {
                "all": self.ended.len(), "smoothed": self.count(Made::Smoothed), "found": self.count(Made::Found),
                "unchanged": self.count(Made::Unchanged), "not_met": self.count(Made::NotMet), "failed": self.count(Made::Failed),
            },
            "meshes_analysed": self.domains,
            self.series.noun(): steps,
            "seconds": self.begin.elapsed().as_secs_f64(),
        })
    }

    fn summary(&self, is_written: bool) -> Vec<String> {
        let mut parts = Vec::new();
        for (made, what) in [
            (Made::Smoothed, "smoothed"),
            (Made::Found, "finished before"),
            (Made::Unchanged, "unchanged"),
            (Made::NotMet, "with a failed audit"),
            (Made::Failed, "failed"),
        ] {
            if self.count(made) > 0 {
                parts.push(format!("{} {what}", self.count(made)));
            }
        }
        let mut lines = vec![(self.series.noun().to_owned(), format!("{}: {}", self.ended.len(), parts.join(", ")))];
        let mut ranges: BTreeMap<&str, [(usize, usize); 2]> = BTreeMap::new();
        for (array, before, after) in self.ended.iter().flat_map(Ended::counts) {
            let range = ranges.entry(array).or_insert([(usize::MAX, 0); 2]);
            for (range, counts) in range.iter_mut().zip([before, after]) {
                *range = (range.0.min(total(counts)), range.1.max(total(counts)));
            }
        }
        for (array, [before, after]) in ranges {
            lines.push(("extrema".to_owned(), format!("{array}: {} to {} before, {} to {} after", before.0, before.1, after.0, after.1)));
        }
        lines.push(("meshes".to_owned(), format!("{} analysed", self.domains)));
        let audited = || self.ended.iter().filter(|ended| ended.counts().next().is_some());
        let good = audited().filter(|ended| ended.told["results"].as_array().is_some_and(|all| all.iter().all(|one| one["audit"]["passed"] == true)));
        lines.push(("audit".to_owned(), format!("passed in {} of {} {}", good.count(), audited().count(), self.series.noun())));
        lines.push(("time".to_owned(), format!("{:.2} s", self.begin.elapsed().as_secs_f64())));
        let target = self.args.output.display();
        lines.push(("output".to_owned(), if is_written { target.to_string() } else { format!("none: {target} was not written") }));
        lines.into_iter().map(|(what, text)| format!("{what:<15} {text}")).collect()
    }

    /// What the run ends with if steps failed.
    pub fn failure(&self) -> Option<Failure> {
        let failed: Vec<(&Step, &Failure)> =
            self.series.steps.iter().zip(self.ended).filter_map(|(step, ended)| Some((step, ended.failure.as_ref()?))).collect();
        if failed.is_empty() {
            return None;
        }
        let named: Vec<String> = failed.iter().take(SHOWN).map(|(step, failure)| format!("{}: {}", step.label, failure.text())).collect();
        let more = if failed.len() > SHOWN { format!("\nand {} more", failed.len() - SHOWN) } else { String::new() };
        let all = self.ended.len();
        let others = match all - failed.len() {
            0 => String::new(),
            _ => format!("; the others are in {}", self.args.output.display()),
        };
        let noun = self.series.noun();
        let text = format!("{} of {all} {noun} failed{others}\n{}{more}", failed.len(), named.join("\n"));
        Some(Failure::usage(text).hint(format!("the same command again goes on with the {noun} that are not finished")))
    }
}
