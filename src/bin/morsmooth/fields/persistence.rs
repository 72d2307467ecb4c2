//! `morsmooth persistence`: the diagram as a file, the curve as a picture, and thresholds to choose from.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use morsmooth::field::Precision;
use morsmooth::io::{DiagramField, DiagramLayout, PendingFile, ValueType, diagram_dataset, write_temporary};
use morsmooth::morse::{PersistenceCurve, PersistenceDiagram, PersistenceGap, Selection, Threshold, persistence_diagram};
use morsmooth::plot::write_atomically;
use morsmooth::smooth::{ExtremumCount, LengthReport, MeasuredField, SelectOn, SmoothOptions, Smoother, check_field};
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::{FieldArgs, LengthArgs, SelectKind, TalkArgs};
use crate::common::input::FieldInput;
use crate::common::number::{plain, short};
use crate::common::output::{check_directory, check_output, check_report, is_same_place};
use crate::common::report::{header, pairs, write_report};
use crate::common::talk::Talk;
use crate::failure::Failure;
use crate::fields::table::threshold_table;

/// Plateaus that are listed and drawn.
const PLATEAUS: usize = 4;
/// Plateaus by factor begin here, as a part of the range: below, factors are large and mean nothing.
const LEAST_PART: f64 = 0.005;

/// A plateau of this factor separates features from noise.
const CLEAR_FACTOR: f64 = 1.5;
/// With fewer extrema there is not much to separate.
const MANY: usize = 50;

/// `morsmooth persistence`.
#[derive(Debug, Args)]
pub struct PersistenceArgs {
    /// The field.
    #[command(flatten)]
    pub field: FieldArgs,

    /// File for the persistence diagram, in the layout of TTK: .vtu.
    pub diagram: Option<PathBuf>,

    /// Put the points of the diagram at their places in the domain, not into the plane of birth and death.
    #[arg(long, requires = "diagram")]
    pub embed: bool,

    /// Draw the persistence curve with its widest plateaus into this file.
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,

    /// Draw the field (field.png), the curve and the diagram of extremum pairs (two SVG charts) into this directory.
    #[arg(long, value_name = "DIR")]
    pub plots: Option<PathBuf>,

    /// Write the curve of the diagram's pairs as a table with the columns of TTK's PersistenceCurve: .csv.
    ///
    /// "Persistence (all pairs)" and "Number Of Pairs (all pairs)", the number of pairs of at least this persistence; further
    /// columns count the pairs by type. The global pair is one of them.
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,

    /// Field that is measured: the data, or the unconstrained smooth field that 'smooth --select smooth' uses.
    #[arg(long, value_enum, default_value_t = SelectKind::Data)]
    pub select: SelectKind,

    /// With --select smooth: order of the polyharmonic energy, 1 to 4.
    #[arg(long, value_name = "K", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=4))]
    pub order: u8,

    /// With --select smooth: how far noise is averaged away.
    #[command(flatten)]
    pub length: LengthArgs,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// Runs the command.
pub fn run(args: &PersistenceArgs) -> Result<Outcome, Failure> {
    check_targets(args)?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let input = FieldInput::load(&args.field)?;
    input.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
    let (field, length) = measured(args, &input, &talk)?;
    let curve = PersistenceCurve::new(&field.minima, &field.maxima, &field.values);
    let suggested = Suggested::new(&curve, field.range());
    let wants_diagram = args.diagram.is_some() || args.csv.is_some() || args.talk.report.is_some();
    let diagram = match wants_diagram {
        true => {
            talk.stage("persistence diagram");
            let diagram = persistence_diagram(&input.domain.complex, &field.order);
            Some(diagram.map_err(|error| input.smooth_failure(&error.into()))?)
        }
        false => None,
    };
    talk.stage("writing");
    // Everything is written before anything is put in its place.
    let mut pending: Option<PendingFile> = None;
    if let (Some(path), Some(diagram)) = (&args.diagram, &diagram) {
        let value_type = value_type(args, &input);
        let described =
            DiagramField { domain: &input.domain, values: &field.values, value_type };
        let layout = if args.embed { DiagramLayout::Embedded } else { DiagramLayout::Plane };
        let dataset = diagram_dataset(diagram, &described, layout);
        pending = Some(write_temporary(path, &dataset).map_err(|error| Failure::usage(error.to_string()))?);
    }
    if let (Some(path), Some(diagram)) = (&args.csv, &diagram) {
        write_atomically(path, csv(diagram, &field).as_bytes()).map_err(|error| Failure::file(path, error))?;
    }
    if let Some(path) = &args.plot {
        crate::common::pictures::curve(path, &input, &field, &suggested.plateaus())?;
    }
    if let Some(directory) = &args.plots {
        crate::common::pictures::persistence(directory, &input, &field, &suggested.plateaus())?;
    }
    if let Some(pending) = pending {
        pending.commit().map_err(|error| Failure::usage(error.to_string()))?;
    }
    talk.finish();
    if let Some(path) = &args.talk.report {
        write_report(path, &report(&input, &field, length, &suggested, diagram.as_ref()))?;
    }
    if !args.talk.quiet {
        let mut out = std::io::stdout().lock();
        for line in lines(args, &input, &field, length, (&curve, &suggested), diagram.as_ref()) {
            let _ = writeln!(out, "{line}");
        }
    }
    Ok(Outcome::Done)
}

/// The data, or the smooth field with the length that was used.
fn measured(args: &PersistenceArgs, input: &FieldInput, talk: &Talk) -> Result<(MeasuredField, Option<LengthReport>), Failure> {
    let complex = &input.domain.complex;
    let failure = |error| input.smooth_failure(&error);
    if args.select == SelectKind::Data {
        talk.stage("extrema");
        return Ok((MeasuredField::new(complex, input.values.clone()).map_err(failure)?, None));
    }
    let options = SmoothOptions {
        select_on: SelectOn::Smooth,
        order: usize::from(args.order),
        length: args.length.length(),
        // No selection is made; any would do.
        ..SmoothOptions::new(Selection::Threshold(Threshold::Fraction(0.0)))
    };
    check_field(complex, &input.values, &options).map_err(failure)?;
    talk.stage("operators");
    let mut smoother = Smoother::new(complex, options.order).map_err(failure)?;
    let (field, length) = smoother.measured(&input.values, &options, &mut |step| talk.progress(&step)).map_err(failure)?;
    Ok((MeasuredField::clone(&field), Some(length)))
}

/// The type of the array in the file; of a smooth field, the one in which it would be stored.
fn value_type(args: &PersistenceArgs, input: &FieldInput) -> ValueType {
    let stored = match input.precision {
        Precision::F32 => ValueType::F32,
        Precision::F64 => ValueType::F64,
    };
    match input.dataset.point_array(&input.name) {
        Some(array) if args.select == SelectKind::Data && !input.is_derived => array.data.value_type(),
        _ => stored,
    }
}

/// Refuses targets that cannot be written, or that are one another or the input.
fn check_targets(args: &PersistenceArgs) -> Result<(), Failure> {
    let targets: Vec<&Path> =
        [&args.diagram, &args.plot, &args.csv].into_iter().filter_map(|target| target.as_deref()).collect();
    for (place, target) in targets.iter().enumerate() {
        check_output(&args.field.input, target, None, &[])?;
        if let Some(other) = targets[..place].iter().find(|other| is_same_place(target, other)) {
            return Err(Failure::file(target, format!("would overwrite {}; expected another name", other.display())));
        }
    }
    check_report(args.talk.report.as_deref(), &[&[args.field.input.as_path()], targets.as_slice()].concat())?;
    check_directory(args.plots.as_deref())
}

/// The plateaus worth a threshold.
struct Suggested {
    range: f64,
    by_factor: Vec<PersistenceGap>,
    by_width: Vec<PersistenceGap>,
}

impl Suggested {
    fn new(curve: &PersistenceCurve, (low, high): (f64, f64)) -> Self {
        let range = high - low;
        Self { range, by_factor: curve.widest_ratios(PLATEAUS, LEAST_PART * range), by_width: curve.widest_gaps(PLATEAUS) }
    }

    /// In per cent of the range.
    fn percent(&self, value: f64) -> f64 {
        if self.range > 0.0 { 100.0 * value / self.range } else { 0.0 }
    }

    /// A round threshold within a plateau, in per cent of the range.
    fn threshold(&self, gap: &PersistenceGap) -> f64 {
        PersistenceGap { from: self.percent(gap.from), to: self.percent(gap.to), ..*gap }.round_threshold()
    }

    /// Ends of the plateaus to be drawn.
    fn plateaus(&self) -> Vec<(f64, f64)> {
        self.by_factor.iter().map(|gap| (gap.from, gap.to)).collect()
    }

    fn to_json(&self) -> Value {
        let list = |gaps: &[PersistenceGap]| -> Vec<Value> {
            let entry = |gap: &PersistenceGap| {
                json!({
                    "from": gap.from, "to": gap.to, "minima": gap.minima, "maxima": gap.maxima,
                    "factor": if gap.from > 0.0 { Some(gap.ratio()) } else { None },
                    "persistence": self.threshold(gap) / 100.0,
                })
            };
            gaps.iter().map(entry).collect()
        };
        json!({ "by_factor": list(&self.by_factor), "by_width": list(&self.by_width) })
    }
}

/// Number of pairs of each type of the diagram in TTK's sense, and its essential classes by dimension.
fn counts(diagram: &PersistenceDiagram) -> Value {
    json!({ "pairs": diagram.finite_counts(), "essential": diagram.betti_numbers() })
}

fn report(
    input: &FieldInput,
    field: &MeasuredField,
    length: Option<LengthReport>,
    suggested: &Suggested,
    diagram: Option<&PersistenceDiagram>,
) -> Value {
    let mut report = header(input);
    report["range"] = json!(field.range());
    report["select"] = json!(if length.is_some() { "smooth" } else { "data" });
    report["length"] = json!(length);
    report["minima"] = json!(field.minima.len());
    report["maxima"] = json!(field.maxima.len());
    report["minima_pairs"] = json!(pairs(&field.minima, &field.values));
    report["maxima_pairs"] = json!(pairs(&field.maxima, &field.values));
    report["plateaus"] = suggested.to_json();
    report["sublevel_diagram"] = diagram.map_or(Value::Null, counts);
    report
}

/// The table of TTK's PersistenceCurve: one row a persistence, with the number of pairs of at least that persistence.
fn csv(diagram: &PersistenceDiagram, field: &MeasuredField) -> String {
    let top = diagram.dimension().saturating_sub(1);
    let (low, high) = field.range();
    // Type of each pair in TTK's sense: 0 minimum–saddle, 1 saddle–saddle, 2 saddle–maximum.
    let kind = |dimension: usize| if dimension == 0 { 0 } else if dimension == top { 2 } else { 1 };
    let finite = diagram.pairs().iter().filter_map(|pair| Some((pair.persistence(&field.values)?, kind(usize::from(pair.dimension)))));
    let mut pairs: Vec<(f64, usize)> = finite.chain([(high - low, 0)]).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut left = [0usize; 3];
    pairs.iter().for_each(|&(_, kind)| left[kind] += 1);
    let mut text = String::from(
        "\"Persistence (all pairs)\",\"Number Of Pairs (all pairs)\",\"Number Of Pairs (minimum-saddle pairs)\",\
         \"Number Of Pairs (saddle-saddle pairs)\",\"Number Of Pairs (maximum-saddle pairs)\"\n",
    );
    for same in pairs.chunk_by(|a, b| a.0 == b.0) {
        let all: usize = left.iter().sum();
        text.push_str(&format!("{:?},{all},{},{},{}\n", same[0].0, left[0], left[1], left[2]));
        same.iter().for_each(|&(_, kind)| left[kind] -= 1);
    }
    text
}

/// What a person reads.
fn lines(
    args: &PersistenceArgs,
    input: &FieldInput,
    field: &MeasuredField,
    length: Option<LengthReport>,
    (curve, suggested): (&PersistenceCurve, &Suggested),
    diagram: Option<&PersistenceDiagram>,
) -> Vec<String> {
    let what = match length {
        Some(length) => format!(
            "{}, smooth field of order {} and length {} ({:.2} % of the diagonal),",
            input.name,
            args.order,
            short(length.absolute),
            100.0 * length.of_diagonal
        ),
        None => input.name.clone(),
    };
    let count = |minima, maxima| ExtremumCount { minima, maxima };
    let mut lines = threshold_table(&what, field, curve);
    let listed = |gap: &PersistenceGap, width: String| {
        format!(
            "  --persistence {:<8} leaves {:<24} plateau {:.2} % to {:.2} %, {width}",
            format!("{}%", plain(suggested.threshold(gap))),
            count(gap.minima, gap.maxima).to_string(),
            suggested.percent(gap.from),
            suggested.percent(gap.to)
        )
    };
    if !suggested.by_factor.is_empty() {
        lines.push(String::new());
        lines.push("suggested thresholds, by the factor that each may be off without any effect:".to_owned());
        lines.extend(suggested.by_factor.iter().map(|gap| listed(gap, format!("a factor of {:.2}", gap.ratio()))));
    }
    let is_clear = suggested.by_factor.first().is_some_and(|gap| gap.ratio() >= CLEAR_FACTOR);
    if !is_clear && length.is_none() && field.minima.len() + field.maxima.len() > MANY {
        lines.push(
            "no plateau is clear: noise and features overlap in persistence; --select smooth measures the smooth field instead".to_owned(),
        );
    }
    let others: Vec<&PersistenceGap> = suggested.by_width.iter().filter(|gap| !suggested.by_factor.contains(gap)).collect();
    if !others.is_empty() {
        lines.push("and by the widest difference, which favours the few largest extrema:".to_owned());
        lines.extend(others.into_iter().map(|gap| listed(gap, format!("{:.2} % wide", suggested.percent(gap.width())))));
    }
    if let (Some(path), Some(diagram)) = (&args.diagram, diagram) {
        let finite = diagram.finite_counts();
        let essential: usize = diagram.betti_numbers()[..diagram.dimension()].iter().sum();
        lines.push(String::new());
        lines.push(format!(
            "{}: sublevel diagram, {} finite pairs by dimension, {essential} that never die",
            path.display(),
            finite[..diagram.dimension()].iter().map(ToString::to_string).collect::<Vec<_>>().join(" + "),
        ));
    }
    lines
}
