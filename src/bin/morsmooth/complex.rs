//! `morsmooth complex`: the Morse–Smale complex in TTK's layout.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use morsmooth::field::VertexOrder;
use morsmooth::io::{ArrayData, DataArray, DataSet, Numbering, PendingFile, TtkComplex, TtkError, is_same_file, write_temporary};
use morsmooth::monotone::Precision;
use morsmooth::morse::{
    ExtremumKind, LineKind, MorseError, MorseHierarchy, MorseSmaleComplex, SaddlePairs, Selection, Threshold, extremum_pairs,
    range, select,
};
use serde_json::{Value, json};

use crate::Outcome;
use crate::args::{FieldArgs, TalkArgs, fraction};
use crate::failure::Failure;
use crate::input::FieldInput;
use crate::number::short;
use crate::output::{check_directory, check_report};
use crate::report::{header, write_report};
use crate::talk::Talk;

/// `morsmooth complex`.
#[derive(Debug, Args)]
pub struct ComplexArgs {
    /// The field.
    #[command(flatten)]
    pub field: FieldArgs,

    /// Directory to write to; made if it does not exist.
    pub output: PathBuf,

    /// How far the complex is simplified.
    #[command(flatten)]
    pub level: LevelArgs,

    /// Pairs of a 1-saddle and a 2-saddle in 3-D: cancel those that one V-path connects, or keep them all.
    #[arg(long, value_enum, default_value_t = SaddlesKind::Cancel)]
    pub saddles: SaddlesKind,

    /// Draw the field with its critical points and separatrices (complex.png) into this directory.
    #[arg(long, value_name = "DIR")]
    pub plots: Option<PathBuf>,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// Values of `--saddles`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SaddlesKind {
    /// They cancel where one V-path connects them.
    Cancel,
    /// They stay.
    Keep,
}

/// How far the complex is simplified; not at all by default.
#[derive(Debug, Clone, Args)]
#[group(multiple = false)]
pub struct LevelArgs {
    /// Keep extrema whose persistence exceeds this part of the range: 10% or 0.1.
    #[arg(long, value_name = "FRACTION", value_parser = fraction, allow_hyphen_values = true)]
    pub persistence: Option<f64>,

    /// Keep extrema whose persistence exceeds this, in the units of the array.
    #[arg(long, value_name = "VALUE", allow_negative_numbers = true)]
    pub persistence_abs: Option<f64>,

    /// Keep this many extrema, minima and maxima together, the most persistent ones.
    #[arg(long, value_name = "N")]
    pub extrema: Option<usize>,
}

impl LevelArgs {
    fn selection(&self) -> Option<Selection> {
        match (self.persistence, self.persistence_abs, self.extrema) {
            (Some(fraction), _, _) => Some(Selection::Threshold(Threshold::Fraction(fraction))),
            (_, Some(value), _) => Some(Selection::Threshold(Threshold::Absolute(value))),
            (_, _, Some(count)) => Some(Selection::Count(count)),
            (None, None, None) => None,
        }
    }
}

/// Runs the command.
pub fn run(args: &ComplexArgs) -> Result<Outcome, Failure> {
    let begin = Instant::now();
    let stem = args.field.input.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    check_directory(Some(&args.output))?;
    check_report(args.talk.report.as_deref(), &[&args.field.input])?;
    check_directory(args.plots.as_deref())?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let input = FieldInput::load(&args.field)?;
    input.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
    let targets = ["CriticalPoints.vtp", "1Separatrices.vtp", &format!("Segmentation.{}", input.dataset.geometry.extension())]
        .map(|name| args.output.join(format!("{stem}{name}")));
    check_targets(args, &targets)?;

    talk.stage("discrete gradient");
    let morse = |error: MorseError| Failure::file(&input.path, error);
    let order = VertexOrder::of_values(&input.values).map_err(|error| Failure::file(&input.path, error))?;
    let selection = args.level.selection();
    let saddles = match args.saddles {
        SaddlesKind::Cancel if selection.is_some() => SaddlePairs::Cancel,
        SaddlesKind::Cancel | SaddlesKind::Keep => SaddlePairs::Keep,
    };
    let mut hierarchy = MorseHierarchy::new(&input.domain.complex, &input.values, &order, saddles).map_err(morse)?;
    let unsimplified = hierarchy.gradient().critical_counts();
    talk.stage("simplification");
    let threshold = simplify(selection.as_ref(), &input, &mut hierarchy).map_err(morse)?;
    talk.stage("separatrices and segmentation");
    let complex = MorseSmaleComplex::new(&hierarchy);
    let seconds = begin.elapsed().as_secs_f64();

    talk.stage("writing");
    let ttk = |error: TtkError| Failure::file(&input.path, error);
    let scalar = scalar(&input);
    let layout = TtkComplex {
        triangulation: &input.domain.complex,
        order: &order,
        scalar: &scalar,
        complex: &complex,
        numbering: Numbering::new(&input.domain).map_err(ttk)?,
    };
    let files = [
        layout.critical_points().map_err(ttk)?,
        layout.separatrices().map_err(ttk)?,
        layout.segmentation(&input.dataset).map_err(ttk)?,
    ];
    let job = Job { input: &input, complex: &complex, unsimplified, threshold, targets: &targets, seconds };
    write_all(&args.output, &targets, &files)?;
    if let Some(directory) = &args.plots {
        talk.stage("pictures");
        crate::pictures::complex(directory, &input, &complex)?;
    }
    talk.finish();
    if let Some(path) = &args.talk.report {
        write_report(path, &job.to_json())?;
    }
    if !args.talk.quiet {
        job.print();
    }
    Ok(Outcome::Done)
}

/// Refuses to write over a file that decides on the result.
fn check_targets(args: &ComplexArgs, targets: &[PathBuf]) -> Result<(), Failure> {
    for target in targets {
        if target.is_dir() {
            return Err(Failure::file(target, "the output is a directory; expected a file name"));
        }
        if is_same_file(&args.field.input, target) {
            return Err(Failure::file(target, "the output would overwrite the input; expected another directory"));
        }
    }
    let others: Vec<&Path> = targets.iter().map(PathBuf::as_path).collect();
    if args.output.is_dir() { check_report(args.talk.report.as_deref(), &others) } else { Ok(()) }
}

/// Simplifies as asked; the threshold in the units of the field, where there is one.
fn simplify(
    selection: Option<&Selection>,
    input: &FieldInput,
    hierarchy: &mut MorseHierarchy<'_>,
) -> Result<Option<f64>, MorseError> {
    let Some(selection) = selection else { return Ok(None) };
    let (complex, order) = (hierarchy.complex(), hierarchy.order());
    let [minima, maxima] =
        [ExtremumKind::Minimum, ExtremumKind::Maximum].map(|kind| extremum_pairs(complex, order, kind));
    match selection {
        Selection::Threshold(threshold) => {
            let resolved = threshold.resolve(range(&minima, &maxima, &input.values))?;
            hierarchy.at(resolved);
            Ok(Some(resolved))
        }
        Selection::Count(_) | Selection::Set(_) => {
            hierarchy.keeping(&select(&minima, &maxima, &input.values, selection)?);
            Ok(None)
        }
    }
}

/// The field on the points of the file, in the type of its array.
fn scalar(input: &FieldInput) -> DataArray {
    match input.dataset.point_array(&input.name) {
        Some(array) if array.components == 1 => array.clone(),
        _ => {
            let data = match input.precision {
                Precision::F32 => ArrayData::F32(input.on_points.iter().map(|&value| value as f32).collect()),
                Precision::F64 => ArrayData::F64(input.on_points.clone()),
            };
            DataArray::new(input.name.clone(), 1, data)
        }
    }
}

/// Writes all files beside their places, then puts all of them there.
fn write_all(directory: &Path, targets: &[PathBuf], files: &[DataSet]) -> Result<(), Failure> {
    std::fs::create_dir_all(directory)
        .map_err(|error| Failure::file(directory, format!("cannot be made a directory: {error}")))?;
    let refused = |error: morsmooth::io::IoError| Failure::usage(error.to_string());
    let pending: Vec<PendingFile> =
        targets.iter().zip(files).map(|(target, file)| write_temporary(target, file).map_err(refused)).collect::<Result<_, _>>()?;
    pending.into_iter().try_for_each(|file| file.commit().map_err(refused))
}

struct Job<'a> {
    input: &'a FieldInput,
    complex: &'a MorseSmaleComplex,
    unsimplified: [usize; 4],
    threshold: Option<f64>,
    targets: &'a [PathBuf],
    seconds: f64,
}

/// What critical points of each dimension are called.
fn names(dimension: usize) -> Vec<&'static str> {
    match dimension {
        1 => vec!["minima", "maxima"],
        2 => vec!["minima", "saddles", "maxima"],
        _ => vec!["minima", "1-saddles", "2-saddles", "maxima"],
    }
}

impl Job<'_> {
    fn dimension(&self) -> usize {
        self.input.domain.complex.dimension()
    }

    fn lines(&self, kind: LineKind) -> usize {
        self.complex.lines.iter().filter(|line| line.kind == kind).count()
    }

    fn to_json(&self) -> Value {
        let counts = |counts: [usize; 4]| -> Value {
            names(self.dimension()).into_iter().zip(counts).map(|(name, count)| (name.to_owned(), json!(count))).collect()
        };
        let mut report = header(self.input);
        report["threshold"] = json!(self.threshold);
        report["critical_cells_unsimplified"] = counts(self.unsimplified);
        report["critical_points"] = counts(self.complex.counts);
        report["maxima_on_the_boundary_only"] = json!(self.complex.boundary_maxima);
        report["separatrices"] = json!({
            "descending": self.lines(LineKind::Descending),
            "ascending": self.lines(LineKind::Ascending),
            "saddle_connectors": self.lines(LineKind::Connector),
            "tangled_saddle_pairs": self.complex.tangled,
        });
        report["segments"] = json!({
            "minima": self.complex.minima.extrema().len(),
            "maxima": self.complex.maxima.extrema().len(),
            "both": self.complex.regions.pairs().len(),
        });
        report["outputs"] = self.targets.iter().map(|target| target.display().to_string()).collect();
        report["seconds"] = json!({ "read_and_compute": self.seconds });
        report
    }

    /// The summary, on standard output; a closed pipe is not an error.
    fn print(&self) {
        let list = |counts: [usize; 4]| {
            let named = names(self.dimension()).into_iter().zip(counts);
            named.map(|(name, count)| format!("{count} {name}")).collect::<Vec<_>>().join(", ")
        };
        let (low, high) = self.input.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
        let mut lines = vec![
            ("field", format!("{} on {} vertices, values {} to {}", self.input.name, self.input.values.len(), short(low), short(high))),
            ("critical cells", list(self.unsimplified)),
        ];
        let rule = self.threshold.map_or(String::new(), |threshold| format!(" (persistence above {})", short(threshold)));
        lines.push(("kept", format!("{}{rule}", list(self.complex.counts))));
        if self.complex.boundary_maxima > 0 {
            lines.push(("", format!("{} of the maxima are on the boundary, where no cell is critical", self.complex.boundary_maxima)));
        }
        let connectors = match self.dimension() {
            3 => format!(", {} saddle connectors", self.lines(LineKind::Connector)),
            _ => String::new(),
        };
        lines.push((
            "separatrices",
            format!("{} descending, {} ascending{connectors}", self.lines(LineKind::Descending), self.lines(LineKind::Ascending)),
        ));
        if self.complex.tangled > 0 {
            lines.push(("", format!("{} pairs of saddles have too many V-paths between them to draw one", self.complex.tangled)));
        }
        lines.push((
            "segments",
            format!(
                "{} of minima, {} of maxima, {} of both",
                self.complex.minima.extrema().len(),
                self.complex.maxima.extrema().len(),
                self.complex.regions.pairs().len()
            ),
        ));
        lines.push(("time", format!("{:.2} s", self.seconds)));
        lines.extend(self.targets.iter().map(|target| ("output", target.display().to_string())));
        let mut stdout = std::io::stdout().lock();
        for (what, text) in lines {
            let _ = writeln!(stdout, "{what:<15} {text}");
        }
    }
}
