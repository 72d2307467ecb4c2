//! `morsmooth complex`: the Morse–Smale complex in TTK's layout.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use clap::{Args, ValueEnum};
use morsmooth::field::{Precision, VertexOrder};
use morsmooth::io::{
    ArrayData, DataArray, DataSet, MaskSources, Numbering, PendingFile, TtkComplex, TtkError, grid, is_same_file, mask, read,
    write_temporary,
};
use morsmooth::mesh::{ImplicitGrid, Mask, Triangulation};
use morsmooth::morse::{
    ExtremumKind, MorseError, MorseHierarchy, MorseSmaleComplex, SaddlePairs, Selection, Threshold, extremum_pairs, range,
    select,
};

use crate::Outcome;
use crate::args::{FieldArgs, TalkArgs, fraction};
use crate::common::ground::Grounds;
use crate::common::input::{FieldInput, choose};
use crate::common::output::{check_directory, check_report};
use crate::common::report::write_report;
use crate::common::talk::Talk;
use crate::failure::Failure;
use crate::fields::complex_report::ComplexJob;

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

/// A field with all that is said of it, whatever its cells are.
pub struct Field {
    /// The file.
    pub path: PathBuf,
    /// All of it.
    pub dataset: Arc<DataSet>,
    /// The field on the points of the file, in the type and under the name of its array.
    pub scalar: DataArray,
    /// The mask asked for.
    pub mask: Option<String>,
    /// Value at every vertex.
    pub values: Vec<f64>,
    /// What was found and handled.
    pub notes: Vec<String>,
}

/// Runs the command.
pub fn run(args: &ComplexArgs) -> Result<Outcome, Failure> {
    check_directory(Some(&args.output))?;
    check_report(args.talk.report.as_deref(), &[&args.field.input])?;
    check_directory(args.plots.as_deref())?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let dataset = Arc::new(read(&args.field.input).map_err(|error| Failure::usage(error.to_string()))?);
    let array = choose(&dataset, &args.field)?;
    let ttk = |error: TtkError| Failure::file(&args.field.input, error);
    if let Some((grid, field)) = whole_grid(args, &dataset, array)? {
        let numbering = Numbering::of_points(grid.vertex_count()).map_err(ttk)?;
        return work(&Run { args, field: &field, talk: &talk }, &grid, numbering, &|job| match &args.plots {
            // Pictures need the cells.
            Some(directory) => {
                let input = FieldInput::of_array(&dataset, array, &args.field, &Grounds::of_one_file())?;
                crate::fields::complex_report::picture(directory, job, &input.domain.complex, &grid)
            }
            None => Ok(()),
        });
    }
    let input = FieldInput::of_array(&dataset, array, &args.field, &Grounds::of_one_file())?;
    let field = Field {
        path: input.path.clone(),
        dataset: Arc::clone(&dataset),
        scalar: scalar(&input),
        mask: input.mask.clone(),
        values: input.values.clone(),
        notes: input.notes.clone(),
    };
    let numbering = Numbering::new(&input.domain).map_err(ttk)?;
    let complex = &input.domain.complex;
    work(&Run { args, field: &field, talk: &talk }, complex, numbering, &|job| match &args.plots {
        Some(directory) => crate::fields::complex_report::picture(directory, job, complex, complex),
        None => Ok(()),
    })
}

/// The field on a grid of which nothing is masked, whose cells need not be stored.
fn whole_grid(args: &ComplexArgs, dataset: &Arc<DataSet>, array: &DataArray) -> Result<Option<(ImplicitGrid, Field)>, Failure> {
    if args.field.derive.is_some() {
        return Ok(None);
    }
    let sources =
        MaskSources { array: args.field.mask.clone(), holes: vec![array.name.clone()], ..MaskSources::default() };
    let kept = mask(dataset, &sources).map_err(|error| Failure::file(&args.field.input, error))?;
    let values = array.to_f64(0);
    if kept != Mask::none() || values.iter().any(|value| !value.is_finite()) {
        return Ok(None);
    }
    // Whatever a grid is refused for, the domain of stored cells says it in the usual words.
    let grid = grid(dataset).and_then(|grid| ImplicitGrid::new(grid).ok());
    Ok(grid.map(|grid| {
        let field = Field {
            path: args.field.input.clone(),
            dataset: Arc::clone(dataset),
            scalar: array.clone(),
            mask: args.field.mask.clone(),
            values,
            notes: Vec::new(),
        };
        (grid, field)
    }))
}

struct Run<'a> {
    args: &'a ComplexArgs,
    field: &'a Field,
    talk: &'a Talk,
}

/// Computes, writes, draws, reports.
fn work<T: Triangulation>(
    &Run { args, field, talk }: &Run<'_>,
    triangulation: &T,
    numbering: Numbering<'_>,
    draw: &dyn Fn(&ComplexJob<'_>) -> Result<(), Failure>,
) -> Result<Outcome, Failure> {
    let begin = Instant::now();
    field.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
    let stem = field.path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let segmentation = format!("Segmentation.{}", field.dataset.geometry.extension());
    let targets = ["CriticalPoints.vtp", "1Separatrices.vtp", &segmentation].map(|name| args.output.join(format!("{stem}{name}")));
    check_targets(args, &targets)?;

    talk.stage("discrete gradient");
    let morse = |error: MorseError| Failure::file(&field.path, error);
    let order = VertexOrder::of_values(&field.values).map_err(|error| Failure::file(&field.path, error))?;
    let selection = args.level.selection();
    let saddles = match args.saddles {
        SaddlesKind::Cancel if selection.is_some() => SaddlePairs::Cancel,
        SaddlesKind::Cancel | SaddlesKind::Keep => SaddlePairs::Keep,
    };
    let mut hierarchy = MorseHierarchy::new(triangulation, &field.values, &order, saddles).map_err(morse)?;
    let unsimplified = hierarchy.gradient().critical_counts();
    talk.stage("simplification");
    let threshold = simplify(selection.as_ref(), &field.values, &mut hierarchy).map_err(morse)?;
    talk.stage("separatrices and segmentation");
    let complex = MorseSmaleComplex::new(&hierarchy);
    drop(hierarchy);
    let seconds = begin.elapsed().as_secs_f64();

    talk.stage("writing");
    let ttk = |error: TtkError| Failure::file(&field.path, error);
    let layout = TtkComplex { triangulation, order: &order, scalar: &field.scalar, complex: &complex, numbering };
    let files = [
        layout.critical_points().map_err(ttk)?,
        layout.separatrices().map_err(ttk)?,
        layout.segmentation(&field.dataset).map_err(ttk)?,
    ];
    write_all(&args.output, &targets, &files)?;
    let cells = [0, 1, 2, 3].map(|dimension| triangulation.cell_count(dimension));
    let dimension = triangulation.dimension();
    let job = ComplexJob { field, complex: &complex, cells, dimension, unsimplified, threshold, targets: &targets, seconds };
    draw(&job)?;
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
fn simplify<T: Triangulation>(
    selection: Option<&Selection>,
    values: &[f64],
    hierarchy: &mut MorseHierarchy<'_, T>,
) -> Result<Option<f64>, MorseError> {
    let Some(selection) = selection else { return Ok(None) };
    let (complex, order) = (hierarchy.complex(), hierarchy.order());
    let [minima, maxima] =
        [ExtremumKind::Minimum, ExtremumKind::Maximum].map(|kind| extremum_pairs(complex, order, kind));
    match selection {
        Selection::Threshold(threshold) => {
            let resolved = threshold.resolve(range(&minima, &maxima, values))?;
            hierarchy.at(resolved);
            Ok(Some(resolved))
        }
        Selection::Count(_) | Selection::Set(_) => {
            hierarchy.keeping(&select(&minima, &maxima, values, selection)?);
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
