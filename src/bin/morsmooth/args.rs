//! The command line as typed. Nothing is looked up or computed here.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use morsmooth::interpolate::{Guide, Method};
use morsmooth::mesh::{OutlineOptions, Size};
use morsmooth::smooth::Length;

/// Smooth scalar fields with exactly the wanted minima and maxima.
#[derive(Debug, Parser)]
#[command(name = "morsmooth", version, about, long_about = None, max_term_width = 110)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Deform a mesh through poses between key poses; write a ParaView collection with a file a frame.
    ///
    /// Frames are independent and run in parallel; each has the same bits for any number of threads. Rotations in the plane are
    /// blended by angle, so that turns count; quaternions along the shorter arc.
    ///
    /// Exit codes: as for 'deform', for all frames together; nothing is written unless every frame is.
    Animate(Box<crate::shapes::animate::AnimateArgs>),
    /// Deform a planar or solid mesh, an outline or a photograph by handles, so that no element turns inside out.
    ///
    /// Rotations of the handles are blended by weights; the shape of least energy that follows them without an inverted element is the
    /// optimum of a convex problem, and comes with a certificate. The file gets the cell arrays det_F, smallest_eigenvalue,
    /// energy_density and active_constraint.
    ///
    /// Exit codes: 0 if the file written was read back and has no inverted element, as written and rounded to 32 bits, by exact
    /// predicates; 1 if it has, or if handles contradict each other (then nothing is written without --keep-best or --keep-unaudited);
    /// 2 for a wrong command line or input. A solver that stops before the asked gap gives a line 'warning:'.
    Deform(Box<crate::shapes::deform::DeformArgs>),
    /// Write the distance of every vertex from one or more sources along the mesh, and a smooth version with the same maxima.
    ///
    /// Exit codes: 0 if the arrays written were read back, and the smooth one has exactly the wanted extrema; 1 if it has not; 2 for a
    /// wrong command line or input.
    Geodesic(Box<crate::functions::geodesic::GeodesicArgs>),
    /// Show what a file holds: data set, arrays, domain, what is wrong with it. Of a list (.vtm .pvd), all that it names.
    Info(InfoArgs),
    /// Count the extrema of a field, list their persistence, and show what thresholds would leave.
    Extrema(ExtremaArgs),
    /// Write a smooth field with exactly the wanted minima and maxima.
    ///
    /// Exit codes: 0 if the file written was read back and has exactly the wanted extrema; 1 if it has not (then nothing
    /// is written without --keep-unaudited); 2 for a wrong command line or input. They say nothing of optimality: a solver
    /// that stops before the asked gap gives a line 'warning:' on standard error, even with --quiet.
    ///
    /// Of several data sets (a .pvd, a .vtm, or a pattern in quotes such as 'step_*.vti') every one is smoothed on its own, as many
    /// at once as there are threads, and written beside OUT as OUT_0000 and so on; OUT lists them, times and names of blocks kept.
    /// A run that was interrupted goes on where it was: OUT.pvd.jsonl tells which steps are finished, of which input and with
    /// which settings. Exit codes then: 2 if a step could not be read or smoothed (the others are written, and the list names them), else
    /// 1 if a step failed the audit, else 0. Seams between blocks are not bridged: each block has its own extrema.
    Smooth(Box<SmoothArgs>),
    /// Write the field itself with exactly the wanted minima and maxima: topological simplification, nothing is smoothed.
    Simplify(Box<crate::fields::simplify::SimplifyArgs>),
    /// Write the persistence diagram, draw the persistence curve, and suggest thresholds.
    ///
    /// Two things are told, and they differ. The table and the curve count extremum pairs: dimension 0 of the field (minima) and of
    /// the negated field (maxima). They decide what 'smooth' and 'simplify' keep, and include extrema on the boundary of the
    /// domain. The diagram file is that of the sublevel sets in all dimensions, as TTK and GUDHI compute it: a maximum on the
    /// boundary fills no hole of a sublevel set, so it is not in it, while the saddle–saddle pairs of a volume are. On closed
    /// surfaces both list the same maxima.
    ///
    /// A threshold is suggested where the curve is flat on a logarithmic axis. Noise and features differ in persistence by a factor,
    /// not by an amount: a plateau from a to b says that the threshold may be off by the factor b/a without any effect. The
    /// widest differences are listed as well; they favour the few largest extrema, which are far apart in any field.
    Persistence(Box<crate::fields::persistence::PersistenceArgs>),
    /// Find the smoothest function with exactly the minima and maxima that someone wants, without data.
    ///
    /// Exit codes: 0 if the file written was read back and has exactly the wanted extrema, or the method promises none; 1 if it has not;
    /// 2 for a wrong command line or input, such as wishes that contradict each other.
    Interpolate(Box<crate::functions::interpolate::InterpolateArgs>),
    /// Spread colours that are given at points and along curves over a shape or an image.
    ///
    /// Exit codes: 0 if no channel has an extremum but at given colours, or the method does not promise it; 1 otherwise; 2 for a wrong
    /// command line or input.
    Diffuse(Box<crate::functions::diffuse::DiffuseArgs>),
    /// Smooth the columns of a table along one of them, numbers or dates, with exactly the wanted minima and maxima.
    ///
    /// Steps may be irregular and values missing. Every line ends in extrema: where the data have none there above the threshold, the ends
    /// keep their values and may have a corner. Exit codes as those of 'smooth'.
    Series(Box<crate::functions::series::SeriesArgs>),
    /// Audit a field: are its extrema exactly the wanted ones?
    Check(CheckArgs),
    /// Write the Morse–Smale complex: critical points, separatrices, segmentation, in the layout of TTK.
    ///
    /// Three files in the output directory, named after the input: ...CriticalPoints.vtp, ...1Separatrices.vtp, and
    /// ...Segmentation with the input and three more arrays. Without a threshold the complex is not simplified.
    Complex(crate::fields::complex::ComplexArgs),
    /// Move a shape by its weights and a pose: linear blend or dual-quaternion skinning.
    ///
    /// Skinning is direct and promises nothing: elements that it turns inside out are counted on the file as written and
    /// said. 'morsmooth deform' promises none.
    Pose(crate::shapes::pose::PoseArgs),
    /// Write a data set in another format, with a warning for everything that the format cannot hold.
    ///
    /// A list (.vtm .pvd, or a pattern in quotes) becomes a list: every data set is written beside OUT as OUT_0000 and so on.
    Convert(ConvertArgs),
    /// Write skinning weights: a function a handle, 1 on its own vertices and 0 on those of the others.
    ///
    /// Monotone weights have no extremum but at handles; the others are what they are compared with. A handle of several joined
    /// vertices is one place: an extremum as a whole. Exit codes: 0 if the file written was read back and, for monotone weights, has exactly
    /// the wanted extrema; 1 if it has not (then nothing is written without --keep-unaudited); 2 for a wrong command line or input.
    Weights(Box<crate::functions::weights::WeightsArgs>),
}

/// Which field of which file, on which part of the domain.
#[derive(Debug, Clone, Args)]
pub struct FieldArgs {
    /// File to read: VTK's .vti .vtu .vtp .vtr .vts .vtk .vtkhdf, a mesh (.obj .off .ply .stl .mesh .msh), or a table (.csv .tsv).
    ///
    /// FILE.vtm/NAME or FILE.pvd/NUMBER is one data set of a list; 'morsmooth info FILE.vtm' names them. So are FILE.vtkhdf/NUMBER
    /// and FILE.vtkhdf/BLOCK.
    pub input: PathBuf,

    /// Point array to work on. Needed only where the file has several.
    #[arg(long, value_name = "NAME")]
    pub array: Option<String>,

    /// Array whose zeros are holes in the domain (a point array, or else a cell array).
    ///
    /// Ghost and blank flags of the file, and NaN in the array worked on, are holes as well.
    #[arg(long, value_name = "NAME")]
    pub mask: Option<String>,

    /// Work on a scalar derived from the vector array named by --array.
    #[arg(long, value_enum, value_name = "KIND")]
    pub derive: Option<DeriveKind>,
}

/// Which fields of which file, on which part of the domain.
#[derive(Debug, Clone, Args)]
pub struct FieldsArgs {
    /// File to read: VTK's .vti .vtu .vtp .vtr .vts .vtk .vtkhdf, a mesh (.obj .off .ply .stl .mesh .msh), or a table (.csv .tsv).
    ///
    /// FILE.vtm/NAME or FILE.pvd/NUMBER is one data set of a list; 'morsmooth info FILE.vtm' names them. So are FILE.vtkhdf/NUMBER
    /// and FILE.vtkhdf/BLOCK.
    pub input: PathBuf,

    /// Point array to work on. Needed only where the file has several. May be given several times, or as a list a,b,c: each
    /// gives a result, and they share what depends on the mesh only.
    #[arg(long, value_name = "NAME")]
    pub array: Vec<String>,

    /// Work on every scalar point array whose name fits the pattern; * stands for any characters, ? for one.
    #[arg(long, value_name = "PATTERN", conflicts_with = "array")]
    pub array_pattern: Option<String>,

    /// Array whose zeros are holes in the domain (a point array, or else a cell array).
    ///
    /// Ghost and blank flags of the file, and NaN in the array worked on, are holes as well.
    #[arg(long, value_name = "NAME")]
    pub mask: Option<String>,

    /// Work on a scalar derived from the vector array named by --array.
    #[arg(long, value_enum, value_name = "KIND")]
    pub derive: Option<DeriveKind>,
}

/// A scalar derived from a vector field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DeriveKind {
    /// Curl: its component out of the plane in 2-D (signed), its magnitude in 3-D.
    Vorticity,
    /// Trace of the gradient.
    Divergence,
    /// Length of the vector.
    Magnitude,
    /// Second invariant of the gradient.
    QCriterion,
    /// Strain squared minus vorticity squared.
    OkuboWeiss,
}

/// How much to say, and with how many threads to work.
#[derive(Debug, Clone, Args)]
pub struct TalkArgs {
    /// Write everything measured to this JSON file.
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<PathBuf>,

    /// Threads to use; all cores by default. The result has the same bits for any number.
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,

    /// Say nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
}

/// How an outline (.csv) is filled with triangles; without effect on meshes.
#[derive(Debug, Clone, Args)]
pub struct OutlineArgs {
    /// Longest edge of the triangles that fill an outline (.csv), as a part of the diagonal of its bounding box.
    #[arg(long, value_name = "FRACTION", default_value = "2%", value_parser = fraction, allow_hyphen_values = true)]
    pub max_edge: f64,

    /// Largest area of the triangles that fill an outline, in its squared units.
    #[arg(long, value_name = "AREA", allow_negative_numbers = true)]
    pub max_area: Option<f64>,

    /// Smallest angle of the triangles that fill an outline, 0 to 33 degrees; sharper corners of the outline itself stay.
    #[arg(long, value_name = "DEGREES", default_value_t = 25.0, allow_negative_numbers = true)]
    pub min_angle: f64,
}

impl OutlineArgs {
    /// As the library takes them.
    pub fn options(&self) -> OutlineOptions {
        OutlineOptions {
            max_edge: Size::Fraction(self.max_edge),
            max_area: self.max_area,
            min_angle: self.min_angle,
            ..OutlineOptions::default()
        }
    }
}

/// `morsmooth info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// File to read.
    pub input: PathBuf,

    /// Array whose zeros are holes in the domain.
    #[arg(long, value_name = "NAME")]
    pub mask: Option<String>,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// `morsmooth extrema`.
#[derive(Debug, Args)]
pub struct ExtremaArgs {
    /// The field.
    #[command(flatten)]
    pub field: FieldArgs,

    /// Draw the field (field.png) and the persistence curve and diagram (two SVG charts) into this directory.
    #[arg(long, value_name = "DIR")]
    pub plots: Option<PathBuf>,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// Which extrema are wanted.
#[derive(Debug, Clone, Args)]
#[group(multiple = false)]
pub struct SelectionArgs {
    /// Keep extrema whose persistence exceeds this part of the range: 10% or 0.1.
    ///
    /// A list such as 1%,5%,20% gives a result for each, from one computation of what they share; the name of each array ends
    /// in its threshold, as in h_smooth_5pct.
    #[arg(long, value_name = "FRACTION", value_parser = fraction, value_delimiter = ',', allow_hyphen_values = true)]
    pub persistence: Vec<f64>,

    /// Keep extrema whose persistence exceeds this, in the units of the array. A list gives a result for each.
    #[arg(long, value_name = "VALUE", value_delimiter = ',', allow_negative_numbers = true)]
    pub persistence_abs: Vec<f64>,

    /// Keep this many extrema, minima and maxima together, the most persistent ones. A list gives a result for each.
    ///
    /// At least this many: extrema that the domain itself demands, such as the ends of a line, are kept besides.
    #[arg(long, value_name = "N", value_delimiter = ',')]
    pub extrema: Vec<usize>,

    /// Keep the extrema listed in this file: point numbers in a text file, or a persistence diagram (.vtu) with the array
    /// ttkVertexScalarField.
    #[arg(long, value_name = "FILE")]
    pub keep: Option<PathBuf>,
}

/// How far noise is averaged away.
#[derive(Debug, Clone, Copy, Args)]
pub struct LengthArgs {
    /// Smoothing length as a part of the diagonal of the bounding box, of a series that of its axis: 2% or 0.02. Chosen from the noise
    /// by default.
    #[arg(long, value_name = "FRACTION", value_parser = fraction, conflicts_with = "length_abs", allow_hyphen_values = true)]
    pub length: Option<f64>,

    /// Smoothing length in the units of the points, of dates in days.
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    pub length_abs: Option<f64>,
}

impl LengthArgs {
    /// As the library takes it.
    pub fn length(&self) -> Length {
        match (self.length, self.length_abs) {
            (Some(fraction), _) => Length::OfDiagonal(fraction),
            (None, Some(length)) => Length::Absolute(length),
            (None, None) => Length::Automatic,
        }
    }
}

/// `morsmooth smooth`.
#[derive(Debug, Args)]
pub struct SmoothArgs {
    /// The fields.
    #[command(flatten)]
    pub field: FieldsArgs,

    /// File to write; same kind of data set as the input.
    pub output: PathBuf,

    /// Name of the array written; <ARRAY>_smooth by default. Of several thresholds each adds its own ending.
    #[arg(long, value_name = "NAME", visible_alias = "name")]
    pub output_array: Option<String>,

    /// Which extrema are wanted.
    #[command(flatten)]
    pub selection: SelectionArgs,

    /// Field on which extrema are measured, and whose values they keep: the data (trusted values), or the unconstrained
    /// smooth field (noisy data).
    #[arg(long, value_enum, default_value_t = SelectKind::Data)]
    pub select: SelectKind,

    /// Values at the extrema: keep, free, or within a part of the range such as 5%.
    #[arg(long, value_name = "keep|free|FRACTION", default_value = "keep", value_parser = extremum_values, allow_hyphen_values = true)]
    pub values: ValuesKind,

    /// Keep more of the Morse complex than its extrema: values at saddles, values along separatrices, or both.
    ///
    /// They are the values of the field on which extrema are measured, simplified to the wanted ones. The report says what
    /// energy they cost.
    #[arg(long, value_enum, value_name = "WHAT")]
    pub keep_also: Option<KeepAlsoKind>,

    /// Order of the polyharmonic energy, 1 to 4.
    #[arg(long, value_name = "K", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=4))]
    pub order: u8,

    /// How far noise is averaged away.
    #[command(flatten)]
    pub length: LengthArgs,

    /// Point array with the confidence in each value, 0 or more.
    #[arg(long, value_name = "NAME")]
    pub confidence: Option<String>,

    /// Point array with the smoothness asked at each point, from 0 (a spike is allowed) to 1.
    #[arg(long, value_name = "NAME")]
    pub smoothness: Option<String>,

    /// The function that gives every edge its direction.
    #[arg(long, value_enum, default_value_t = StrategyKind::SmoothThenSimplify)]
    pub representative: StrategyKind,

    /// Which edges keep their direction.
    #[arg(long, value_enum, default_value_t = EdgesKind::Minimal)]
    pub edges: EdgesKind,

    /// Rounds in which the solution becomes the representative function of the next.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub refine: usize,

    /// Relative duality gap at which the solver stops.
    #[arg(long, value_name = "GAP", default_value_t = 1e-8, allow_negative_numbers = true)]
    pub gap: f64,

    /// Write the raw optimum: ties are left where the point numbers break them, so a plain < may see plateaus.
    #[arg(long)]
    pub raw: bool,

    /// Draw before and after, the persistence curve and diagram into this directory.
    #[arg(long, value_name = "DIR")]
    pub plots: Option<PathBuf>,

    /// Write the output even if the audit fails.
    #[arg(long)]
    pub keep_unaudited: bool,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// `morsmooth check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// The field to judge.
    #[command(flatten)]
    pub field: FieldArgs,

    /// File with the points that must be the minima (point numbers), or a persistence diagram, of which the minima count.
    ///
    /// Maxima are judged only if --maxima is given too.
    #[arg(long, value_name = "FILE")]
    pub minima: Option<PathBuf>,

    /// File with the points that must be the maxima (point numbers), or a persistence diagram, of which the maxima count.
    ///
    /// Minima are judged only if --minima is given too.
    #[arg(long, value_name = "FILE")]
    pub maxima: Option<PathBuf>,

    /// Report written by `morsmooth smooth --report`: its wanted extrema must be exactly those of the field, with the
    /// values that it kept. Its mask is used unless --mask names another.
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["minima", "maxima"])]
    pub against: Option<PathBuf>,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// `morsmooth convert`.
#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// File to read: .vti .vtu .vtp .vtr .vts .vtk .vtkhdf, a mesh (.obj .off .ply .stl .mesh .msh), a table (.csv .tsv), an image (.png),
    /// an array (.npy), or a list (.vtm .pvd, a pattern in quotes).
    pub input: PathBuf,

    /// File to write; its extension, one of the same, chooses the format.
    pub output: PathBuf,

    /// Read a .csv file as an outline (columns x and y; an empty line or a column 'ring' parts rings) and fill it with triangles.
    #[arg(long)]
    pub outline: bool,

    /// How an outline is filled.
    #[command(flatten)]
    pub fill: OutlineArgs,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// Values of `--select`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SelectKind {
    /// The data.
    Data,
    /// The unconstrained smooth field.
    Smooth,
}

/// Values of `--keep-also`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum KeepAlsoKind {
    /// Values at the saddles between wanted extrema.
    Saddles,
    /// Values along the separatrices from these saddles to the extrema.
    Separatrices,
    /// Both.
    Both,
}

/// How a function is found whose values are given at some vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodKind {
    /// Least Dirichlet energy, whatever the order.
    Harmonic,
    /// Least energy of the order, no other constraint.
    Polyharmonic,
    /// Least energy within the range of the given values; of order 2, bounded biharmonic weights.
    Bounded,
    /// Least energy without an extremum but at given values.
    Monotone,
}

impl MethodKind {
    /// As the library has it.
    pub fn method(self) -> Method {
        match self {
            Self::Harmonic => Method::Harmonic,
            Self::Polyharmonic => Method::Polyharmonic,
            Self::Bounded => Method::Bounded,
            Self::Monotone => Method::Monotone,
        }
    }
}

/// Values of `--representative` where there are no data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GuideKind {
    /// For orders 1 and 2 the polyharmonic function, simplified; for 3 and 4 both, and what has less energy.
    Automatic,
    /// The polyharmonic function, simplified.
    SmoothThenSimplify,
    /// The harmonic function.
    Harmonic,
}

impl GuideKind {
    /// As the library has it.
    pub fn guide(self) -> Guide {
        match self {
            Self::Automatic => Guide::Automatic,
            Self::SmoothThenSimplify => Guide::SmoothThenSimplify,
            Self::Harmonic => Guide::Harmonic,
        }
    }
}

/// Values of `--representative` of `smooth`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StrategyKind {
    /// The smooth field, simplified.
    SmoothThenSimplify,
    /// The field on which extrema were selected, simplified.
    Flood,
    /// Values along the separatrices of the simplified Morse complex.
    Separatrix,
    /// Harmonic between the extrema.
    Harmonic,
}

/// Values of `--edges`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EdgesKind {
    /// Two edges a vertex, all at the extrema.
    Minimal,
    /// Every edge of the mesh.
    All,
}

/// Values of `--values`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ValuesKind {
    /// Kept.
    Keep,
    /// Free.
    Free,
    /// Within this fraction of the range.
    Within(f64),
}

/// Reads `10%` or `0.1`.
pub fn fraction(text: &str) -> Result<f64, String> {
    let number = |digits: &str| digits.trim().parse::<f64>().map_err(|_| format!("found '{text}'; expected a part such as 10% or 0.1"));
    let value = match text.trim().strip_suffix('%') {
        Some(digits) => number(digits)? / 100.0,
        None => number(text)?,
    };
    if !value.is_finite() || value < 0.0 {
        return Err(format!("found '{text}'; expected a finite part not below 0"));
    }
    if value > 1.0 {
        let hint = if text.contains('%') { String::new() } else { format!("; did you mean {}%?", text.trim()) };
        return Err(format!("found '{text}', which is {} %; expected at most 100 %{hint}", 100.0 * value));
    }
    Ok(value)
}

/// Reads `keep`, `free` or a part.
pub fn extremum_values(text: &str) -> Result<ValuesKind, String> {
    match text {
        "keep" => Ok(ValuesKind::Keep),
        "free" => Ok(ValuesKind::Free),
        _ => fraction(text).map(ValuesKind::Within).map_err(|error| match error.contains("at most") {
            true => error,
            false => format!("found '{text}'; expected keep, free or a part such as 5%"),
        }),
    }
}
