//! `morsmooth geodesic`: distances along a mesh, and a smooth field with their maxima.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use clap::{Args, ValueEnum};
use morsmooth::audit::{AuditReport, Plateaus};
use morsmooth::geodesic::{ExactGeodesic, GeodesicError, HeatBoundary, HeatGeodesic, HeatOptions, HeatTriangles};
use morsmooth::io::{
    ArrayData, DataArray, DataSet, MaskSources, PendingFile, domain, mask, read, write_temporary,
};
use morsmooth::mesh::{Domain, check};
use morsmooth::operators::OperatorError;
use morsmooth::morse::{ExtremumPair, Selection};
use morsmooth::smooth::{Length, MeasuredField, SmoothOptions, Smoothed, Smoother};

use crate::Outcome;
use crate::args::{FieldArgs, TalkArgs, fraction};
use crate::common::beside::{fitting, read_back};
use crate::common::ground::Grounds;
use crate::common::input::FieldInput;
use crate::common::output::{check_directory, check_output};
use crate::common::report::write_report;
use crate::common::talk::Talk;
use crate::common::written::{OrderArrays, Produced, write_and_audit};
use crate::failure::Failure;
use crate::functions::geodesic_report::GeodesicJob;
use crate::functions::geodesic_sources::{SourceArgs, Sources};

/// Array of the distance.
pub const DISTANCE: &str = "geodesic_distance";
/// Array of the smooth field.
pub const SMOOTH: &str = "geodesic_distance_smooth";

/// `morsmooth geodesic`.
#[derive(Debug, Args)]
pub struct GeodesicArgs {
    /// Mesh to read: VTK's .vtp .vtu .vtk, or .obj .off .ply .stl .mesh .msh.
    pub input: PathBuf,

    /// File to write, with the arrays geodesic_distance and geodesic_distance_smooth and all that the input holds.
    pub output: PathBuf,

    /// Where distances start.
    #[command(flatten)]
    pub sources: SourceArgs,

    /// Write an array for each source, geodesic_distance_0, geodesic_distance_1 ..., in the place of the distance from the nearest: --source,
    /// then --source-point, as they are given, then the curve.
    #[arg(long, conflicts_with = "smooth")]
    pub each: bool,

    /// How distances are found.
    #[arg(long, value_enum, default_value_t = MethodKind::Exact)]
    pub method: MethodKind,

    /// Time of the heat flow in units of the squared mean length of the edges. Longer is smoother and less accurate.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, allow_negative_numbers = true)]
    pub heat_time: f64,

    /// Triangles between which heat flows on a surface.
    #[arg(long, value_enum, default_value_t = HeatTrianglesKind::Delaunay)]
    pub heat_triangles: HeatTrianglesKind,

    /// What happens to heat at a boundary.
    #[arg(long, value_enum, default_value_t = HeatBoundaryKind::Mean)]
    pub heat_boundary: HeatBoundaryKind,

    /// Array whose zeros are holes in the domain.
    #[arg(long, value_name = "NAME")]
    pub mask: Option<String>,

    /// Write NaN where no path from a source arrives, instead of an error.
    #[arg(long)]
    pub allow_unreached: bool,

    /// Also write a smooth field that has the maxima of the distance, places and values, its minima at the sources, and no other extremum.
    #[arg(long)]
    pub smooth: bool,

    /// Smoothing length as a part of the diagonal of the bounding box.
    #[arg(long, value_name = "FRACTION", value_parser = fraction, default_value = "2%", requires = "smooth", allow_hyphen_values = true)]
    pub length: f64,

    /// Order of the polyharmonic energy, 1 to 4.
    #[arg(long, value_name = "K", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=4), requires = "smooth")]
    pub order: u8,

    /// Keep only the maxima whose persistence exceeds this part of the range; every maximum by default.
    #[arg(long, value_name = "FRACTION", value_parser = fraction, default_value = "0", requires = "smooth", allow_hyphen_values = true)]
    pub persistence: f64,

    /// Write the output even if the audit fails.
    #[arg(long)]
    pub keep_unaudited: bool,

    /// Draw isolines of the distance, and of the smooth field beside it, into this directory.
    #[arg(long, value_name = "DIR")]
    pub plots: Option<PathBuf>,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// Values of `--method`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodKind {
    /// The exact length of shortest paths on triangles.
    Exact,
    /// Fast and approximate, also in tetrahedra.
    Heat,
}

/// Values of `--heat-triangles`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum HeatTrianglesKind {
    /// Those of the intrinsic Delaunay triangulation: more accurate where angles are obtuse.
    Delaunay,
    /// Those of the mesh.
    Given,
}

impl HeatTrianglesKind {
    fn triangles(self) -> HeatTriangles {
        match self {
            Self::Delaunay => HeatTriangles::IntrinsicDelaunay,
            Self::Given => HeatTriangles::Given,
        }
    }
}

/// Values of `--heat-boundary`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum HeatBoundaryKind {
    /// The mean of an insulated and a cold one: closer behind holes.
    Mean,
    /// No heat leaves: faster, and closer on narrow parts.
    Insulated,
}

impl HeatBoundaryKind {
    fn boundary(self) -> HeatBoundary {
        match self {
            Self::Mean => HeatBoundary::Mean,
            Self::Insulated => HeatBoundary::Insulated,
        }
    }
}

fn heat_options(args: &GeodesicArgs) -> HeatOptions {
    HeatOptions { time: args.heat_time, triangles: args.heat_triangles.triangles(), boundary: args.heat_boundary.boundary() }
}

/// Distances of all vertices.
pub struct Distance {
    /// Name of the array.
    pub array: String,
    /// The source in words, if it is one of several by itself.
    pub source: Option<String>,
    /// One a vertex, infinite where no path arrives.
    pub values: Vec<f64>,
}

impl Distance {
    /// Vertices that no path reaches.
    pub fn unreached(&self) -> usize {
        self.values.iter().filter(|distance| distance.is_infinite()).count()
    }
}

/// Runs the command.
pub fn run(args: &GeodesicArgs) -> Result<Outcome, Failure> {
    let begin = Instant::now();
    let others: Vec<&Path> = args.sources.source_curve.as_deref().into_iter().collect();
    check_output(&args.input, &args.output, args.talk.report.as_deref(), &others)?;
    check_directory(args.plots.as_deref())?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let dataset = read(&args.input).map_err(|error| Failure::usage(error.to_string()))?;
    let mut dataset = fitting(dataset, &args.output)?;
    let holes = MaskSources { array: args.mask.clone(), ..MaskSources::default() };
    let kept = mask(&dataset, &holes).map_err(|error| Failure::file(&args.input, error))?;
    let domain = domain(&dataset, &kept).map_err(|error| Failure::file(&args.input, error))?;
    domain.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
    let sources = Sources::resolve(&args.sources, &args.input, &domain)?;
    sources.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));

    talk.stage("distances");
    let clock = Instant::now();
    let distances = distances(args, &domain, &sources)?;
    let distance_seconds = clock.elapsed().as_secs_f64();
    for distance in &distances {
        check_reached(args, &domain, distance)?;
        dataset.set_point_array(array(&domain, distance));
    }

    let mut job = GeodesicJob {
        args, sources: &sources, domain: &domain, distances: &distances, distance_seconds,
        smoothed: None, audit: None, seconds: 0.0,
    };
    let (pending, outcome) = if args.smooth {
        let input = field(args, dataset, DISTANCE)?;
        let smoothed = smooth(args, &input, &domain, &sources, &talk)?;
        talk.stage("writing, and audit of the file as written");
        let produced = Produced {
            input: &input,
            name: SMOOTH,
            values: &smoothed.values,
            wanted: &smoothed.wanted,
            rules: &smoothed.rules,
            plateaus: Plateaus::Refused,
        };
        let (pending, mut verdicts) = write_and_audit(&args.output, &[produced], OrderArrays::Omitted)?;
        let verdict: Option<AuditReport> = verdicts.pop();
        let passed = verdict.as_ref().is_some_and(|verdict| verdict.passed);
        if let Some(directory) = &args.plots {
            talk.stage("pictures");
            crate::common::pictures::before_and_after(directory, &input, &smoothed)?;
        }
        (job.smoothed, job.audit) = (Some((input, smoothed)), verdict);
        (pending, if passed { Outcome::Done } else { Outcome::NotMet })
    } else {
        talk.stage("writing");
        if let Some(directory) = &args.plots {
            for Distance { array, .. } in &distances {
                let name = if args.each { array.as_str() } else { "distance" };
                crate::common::pictures::distance(directory, name, &field(args, dataset.clone(), array)?)?;
            }
        }
        let names: Vec<&str> = distances.iter().map(|distance| distance.array.as_str()).collect();
        (write(&args.output, &dataset, &names)?, Outcome::Done)
    };
    job.seconds = begin.elapsed().as_secs_f64();
    if outcome == Outcome::Done || args.keep_unaudited {
        pending.commit().map_err(|error| Failure::usage(error.to_string()))?;
    }
    talk.finish();
    if let Some(path) = &args.talk.report {
        write_report(path, &job.to_json())?;
    }
    if !args.talk.quiet {
        job.print_summary();
    }
    Ok(outcome)
}

/// The distance from all sources, or from each.
fn distances(args: &GeodesicArgs, domain: &Domain, sources: &Sources) -> Result<Vec<Distance>, Failure> {
    let complex = &domain.complex;
    let sets = if args.each { sources.each() } else { vec![sources.points.clone()] };
    let result = match args.method {
        MethodKind::Exact => ExactGeodesic::new(complex).and_then(|exact| exact.distances_each(&sets)),
        MethodKind::Heat => HeatGeodesic::new(complex, heat_options(args)).and_then(|mut heat| sets.iter().map(|set| heat.distances(set)).collect::<Result<Vec<_>, _>>()),
    };
    let found = result.map_err(|error| failure(args, domain, &error))?;
    let named = |(number, values): (usize, Vec<f64>)| match args.each {
        true => Distance { array: format!("{DISTANCE}_{number}"), source: Some(sources.given[number].0.clone()), values },
        false => Distance { array: DISTANCE.to_owned(), source: None, values },
    };
    Ok(found.into_iter().enumerate().map(named).collect())
}

/// An error of the library as one about the file, vertices translated to points.
fn failure(args: &GeodesicArgs, domain: &Domain, error: &GeodesicError) -> Failure {
    let point = |vertex: morsmooth::field::VertexId| domain.point_of_vertex()[vertex.index()];
    let file = |text: String| Failure::file(&args.input, text);
    match error {
        GeodesicError::Operator(OperatorError::ZeroMeasure { .. }) => match check(domain) {
            Err(fault) => Failure::file(&args.input, fault),
            Ok(()) => Failure::file(&args.input, error),
        },
        GeodesicError::NonManifoldEdge { vertices, triangles } => file(format!(
            "the edge between the points {} and {} has {triangles} triangles; expected at most 2 for exact distances",
            point(vertices[0]),
            point(vertices[1])
        ))
        .hint("--method heat takes such edges; or mask one of the sheets with --mask"),
        GeodesicError::Dimension { .. } => {
            Failure::file(&args.input, error).hint("--method heat works on lines and in tetrahedra as well")
        }
        GeodesicError::HeatVanished { vertex } => {
            file(format!("no heat arrives at point {}; expected some everywhere", point(*vertex)))
                .hint("take a greater --heat-time, or --method exact")
        }
        _ => Failure::file(&args.input, error),
    }
}

/// Refuses vertices that no path reaches, unless they are allowed.
fn check_reached(args: &GeodesicArgs, domain: &Domain, distance: &Distance) -> Result<(), Failure> {
    let (unreached, distances) = (distance.unreached(), &distance.values);
    let (from, expected) = match &distance.source {
        Some(source) => (source.as_str(), "one part"),
        None => ("the sources", "a source in every part"),
    };
    match distances.iter().position(|distance| distance.is_infinite()) {
        Some(vertex) if !args.allow_unreached => Err(Failure::file(
            &args.input,
            format!(
                "no path leads from {from} to {unreached} of {} points, first point {}; expected {expected}",
                distances.len(),
                domain.point_of_vertex()[vertex]
            ),
        )
        .hint("add a source there, or --allow-unreached to write NaN")),
        _ => Ok(()),
    }
}

/// The distances as an array of the file: NaN outside of the domain and where no path arrives.
fn array(domain: &Domain, distance: &Distance) -> DataArray {
    let mut on_points = vec![f64::NAN; domain.point_count()];
    let finite: Vec<f64> = distance.values.iter().map(|&distance| if distance.is_finite() { distance } else { f64::NAN }).collect();
    domain.extend(&finite, &mut on_points);
    DataArray::new(distance.array.as_str(), 1, ArrayData::F64(on_points))
}

/// A distance as a field of the file.
fn field(args: &GeodesicArgs, dataset: DataSet, name: &str) -> Result<FieldInput, Failure> {
    let field = FieldArgs { input: args.input.clone(), array: Some(name.to_owned()), mask: args.mask.clone(), derive: None };
    let dataset = Arc::new(dataset);
    let array = crate::common::input::choose(&dataset, &field)?;
    FieldInput::of_array(&dataset, array, &field, &Grounds::of_one_file())
}

fn smooth(args: &GeodesicArgs, input: &FieldInput, domain: &Domain, sources: &Sources, talk: &Talk) -> Result<Smoothed, Failure> {
    let complex = &input.domain.complex;
    let say = |error: &morsmooth::smooth::SmoothError| input.smooth_failure(error);
    let measured = MeasuredField::new(complex, input.values.clone()).map_err(|error| say(&error))?;
    let (low, high) = measured.range();
    let persists = |pair: &&ExtremumPair, least: f64| pair.persistence(&measured.values).is_none_or(|persistence| persistence > least);
    let maxima = measured.maxima.iter().filter(|pair| persists(pair, args.persistence * (high - low)));
    // Every other minimum is an artefact: linear interpolation makes some in obtuse triangles.
    let at_source = |pair: &&ExtremumPair| {
        let point = input.domain.point_of_vertex()[pair.extremum.index()];
        domain.vertex_of_point()[point as usize].is_some_and(|vertex| sources.is_near(domain, vertex))
    };
    let minima = measured.minima.iter().filter(|pair| pair.is_essential() || (at_source(pair) && persists(pair, sources.spacing)));
    let wanted = maxima.chain(minima).map(|pair| pair.extremum).collect();
    let options = SmoothOptions {
        order: usize::from(args.order),
        length: Length::OfDiagonal(args.length),
        ..SmoothOptions::new(Selection::Set(wanted))
    };
    let mut smoother = Smoother::new(complex, options.order).map_err(|error| say(&error))?;
    smoother.smooth(&input.values, &options, &mut |step| talk.progress(&step)).map_err(|error| say(&error))
}

/// Writes beside the target, and reads the distances back.
fn write(output: &Path, dataset: &DataSet, names: &[&str]) -> Result<PendingFile, Failure> {
    let pending = write_temporary(output, dataset).map_err(|error| Failure::usage(error.to_string()))?;
    let written = read_back(&pending)?;
    let bits = |dataset: &DataSet, name: &str| -> Option<Vec<u64>> {
        dataset.point_array(name).map(|array| array.to_f64(0).iter().map(|value| value.to_bits()).collect())
    };
    match names.iter().find(|name| bits(&written, name) != bits(dataset, name)) {
        None => Ok(pending),
        Some(name) => Err(Failure::file(output, format!("the format has no room for the array {name}; expected .vtp, .vtu, .vtk or .ply"))),
    }
}
