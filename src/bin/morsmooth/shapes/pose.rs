//! `morsmooth pose`: a shape moved by skinning with weights that are there.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use morsmooth::deform::skinning::{dual_quaternion, linear_blend};
use morsmooth::io::{
    ArrayData, DataArray, DataSet, PendingFile, domain, is_same_file, read_handles, read_mesh_or_outline, read_pose, set_positions,
};
use morsmooth::mesh::{Domain, Handle, HandleSet, HandleShape, Mask, Pose};
use serde_json::json;

use crate::Outcome;
use crate::args::{OutlineArgs, TalkArgs};
use crate::common::beside::{fitting, read_back, with_vertices, write_beside};
use crate::common::number::short;
use crate::common::output::{check_directory, check_output};
use crate::common::report::{command_line, write_report};
use crate::common::talk::Talk;
use crate::common::weight_arrays::{Mesh, WeightFile, rows};
use crate::failure::Failure;
use crate::shapes::pose_audit::{Inversions, inversions};

/// Name of the array that says how far each point moved.
const DISPLACEMENT: &str = "displacement";
/// Field data of a file of weights: the places about which its handles turn.
const HANDLE_PIVOTS: &str = "handle_pivots";
/// Sums of weights this far from 1 are worth a word.
const UNITY: f64 = 1e-6;
/// Rounding to 32 bits or to seven digits, as a part of the greatest coordinate.
const ROUNDING: f64 = 1e-6;

/// `morsmooth pose`.
#[derive(Debug, Args)]
pub struct PoseArgs {
    /// Mesh to move: .vtu .vtp .vts .vtk .obj .off .ply .stl .mesh .msh, or an outline .csv.
    pub mesh: PathBuf,

    /// File with the weights as 'morsmooth weights' writes them; may be the mesh file itself.
    ///
    /// One point array a handle, named after it; the field data array handle_names lists the names. Weights of a point are
    /// divided by their sum.
    pub weights: PathBuf,

    /// Pose: .json, or .dmat with a quaternion a bone (needs --handles).
    ///
    /// {"handles": {"head": {"rotation_degrees": 90, "axis": [0, 0, 1], "translation": [1, 0, 0], "scale": 1, "pivot": [0, 0, 0]}}};
    /// every entry may be left out, "quaternion": [w, x, y, z] may take the place of the first two, and handles that are not named stay.
    pub pose: PathBuf,

    /// File to write: the mesh file with its points moved and the array 'displacement'.
    pub output: PathBuf,

    /// How transforms are blended.
    #[arg(long, value_enum, default_value_t = SkinningKind::Dqs)]
    pub method: SkinningKind,

    /// Handles (.json, .tgf): the pivots, and the bones that a .dmat pose needs.
    ///
    /// Without it, a handle turns about its place in the field data array handle_pivots, or else about the middle of the points where
    /// its weight is greatest, unless the pose says otherwise.
    #[arg(long, value_name = "FILE")]
    pub handles: Option<PathBuf>,

    /// What comes before the name of the handle in the names of the arrays.
    #[arg(long, value_name = "TEXT", default_value = "")]
    pub prefix: String,

    /// How an outline is filled.
    #[command(flatten)]
    pub outline: OutlineArgs,

    /// Draw the shape before and after into this directory, inverted elements red.
    #[arg(long, value_name = "DIR")]
    pub plots: Option<PathBuf>,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// Values of `--method`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SkinningKind {
    /// Linear blend skinning: shrinks where rotations differ.
    Lbs,
    /// Dual-quaternion skinning: every point moves rigidly.
    Dqs,
}

/// What a run works on.
struct Scene {
    dataset: DataSet,
    domain: Domain,
    handles: HandleSet,
    /// `n x h`, on the vertices of the domain.
    weights: Vec<f64>,
    /// Largest distance of a sum of weights from 1.
    off_unity: f64,
}

/// Runs the command.
pub fn run(args: &PoseArgs) -> Result<Outcome, Failure> {
    let begin = Instant::now();
    let others: Vec<&Path> = [&args.weights, &args.pose].into_iter().chain(&args.handles).map(PathBuf::as_path).collect();
    check_output(&args.mesh, &args.output, args.talk.report.as_deref(), &others)?;
    if let Some(other) = others.iter().find(|other| is_same_file(other, &args.output)) {
        return Err(Failure::file(&args.output, format!("the output would overwrite {}; expected another name", other.display())));
    }
    check_directory(args.plots.as_deref())?;
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let scene = load(args)?;
    let pose = read_pose(&args.pose, &scene.handles, &scene.domain.complex).map_err(|error| Failure::usage(error.to_string()))?;
    if scene.off_unity > UNITY {
        talk.line(&format!("note: weights sum to 1 within {}; they are divided by their sums", short(scene.off_unity)));
    }
    talk.stage("skinning");
    let skin = match args.method {
        SkinningKind::Lbs => linear_blend,
        SkinningKind::Dqs => dual_quaternion,
    };
    let rest = scene.domain.complex.points();
    let moved = skin(rest, &scene.weights, &pose).map_err(|error| Failure::file(&args.weights, error))?;
    talk.stage("writing");
    let (pending, lost) = write(args, &scene, &moved)?;
    // What is in the file, in its own precision, is what is judged.
    let written = read_back(&pending)?;
    let places = written.points_f64();
    let found = match keeps_numbers(&scene, &moved, &places) {
        true => inversions(&scene.domain, &places),
        false => Inversions::Unknown("the format keeps no numbers of points".to_owned()),
    };
    if let Some(directory) = &args.plots {
        talk.stage("pictures");
        let before: Vec<[f64; 3]> = pose.transforms.iter().map(|transform| transform.pivot).collect();
        let after: Vec<[f64; 3]> = pose.transforms.iter().map(|transform| transform.apply(transform.pivot)).collect();
        crate::common::pictures::shapes(directory, &scene.domain.complex, &moved, found.determinants(), [&before, &after])?;
    }
    let report = report(args, &scene, &pose, &found, begin.elapsed().as_secs_f64());
    if let Some(path) = &args.talk.report {
        write_report(path, &report)?;
    }
    pending.commit().map_err(|error| Failure::usage(error.to_string()))?;
    talk.finish();
    lost.iter().for_each(|what| talk.line(&format!("warning: {} has no room for {what}", args.output.display())));
    if !args.talk.quiet {
        print(args, &scene, &found, begin.elapsed().as_secs_f64());
    }
    Ok(Outcome::Done)
}

fn load(args: &PoseArgs) -> Result<Scene, Failure> {
    let options = args.outline.options();
    let dataset = read_mesh_or_outline(&args.mesh, &options).map_err(|error| Failure::usage(error.to_string()))?;
    let domain = domain(&dataset, &Mask::none()).map_err(|error| Failure::file(&args.mesh, error))?;
    let mesh = Mesh { path: &args.mesh, dataset: &dataset, domain: &domain };
    let file = WeightFile::read(&args.weights, &mesh, &options)?;
    let given = args.handles.as_ref().map(|path| {
        let set = read_handles(path).map_err(|error| Failure::usage(error.to_string()))?;
        set.renumbered(domain.vertex_of_point()).map_err(|error| Failure::file(path, error))
    });
    let given = given.transpose()?;
    let names = match &given {
        Some(set) => set.names(),
        None => file.handle_names().ok_or_else(|| {
            Failure::file(&args.weights, "found no field data array 'handle_names'; expected the names of the handles")
                .hint("'morsmooth weights' writes it; or give the handles with --handles")
        })?,
    };
    let columns = file.columns(&names, ("--prefix", &args.prefix))?;
    let weights = rows(&columns);
    let off_unity = weights.chunks_exact(names.len().max(1)).map(|row| (row.iter().sum::<f64>() - 1.0).abs()).fold(0.0, f64::max);
    let handles = given.unwrap_or_else(|| placed(file.dataset(), &domain, names, &columns));
    Ok(Scene { dataset, domain, handles, weights, off_unity })
}

/// Handles as points at their pivots.
fn placed(source: &DataSet, domain: &Domain, names: Vec<String>, columns: &[Vec<f64>]) -> HandleSet {
    let pivots = source.field_data.iter().find(|array| array.name == HANDLE_PIVOTS && array.components == 3 && array.tuples() == names.len());
    let place = |handle: usize| match pivots {
        Some(array) => [0, 1, 2].map(|axis| array.to_f64(axis)[handle]),
        None => middle_of_greatest(domain, &columns[handle]),
    };
    let handles = names.into_iter().enumerate().map(|(handle, name)| Handle { name, shape: HandleShape::Point(place(handle)) });
    HandleSet { handles: handles.collect(), cage_edges: Vec::new() }
}

fn middle_of_greatest(domain: &Domain, weights: &[f64]) -> [f64; 3] {
    let greatest = weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let held: Vec<[f64; 3]> =
        weights.iter().zip(domain.complex.points()).filter(|(weight, _)| **weight == greatest).map(|(_, &point)| point).collect();
    std::array::from_fn(|axis| held.iter().map(|point| point[axis]).sum::<f64>() / held.len().max(1) as f64)
}

/// The moved mesh beside its place, and what its format has no room for.
fn write(args: &PoseArgs, scene: &Scene, moved: &[[f64; 3]]) -> Result<(PendingFile, Vec<String>), Failure> {
    let mut dataset = scene.dataset.clone();
    let rest = dataset.points_f64();
    let places = with_vertices(rest.clone(), &scene.domain, moved);
    let steps = places.iter().zip(&rest).flat_map(|(place, rest)| (0..3).map(move |axis| place[axis] - rest[axis]));
    let displacement = DataArray::new(DISPLACEMENT, 3, ArrayData::F64(steps.collect()));
    set_positions(&mut dataset, &places).map_err(|text| Failure::file(&args.mesh, text))?;
    dataset.set_point_array(displacement);
    write_beside(&args.output, &fitting(dataset, &args.output)?)
}

/// Whether the points of the file are those that were written, but for rounding: a format such as .stl puts them into an order of its own.
fn keeps_numbers(scene: &Scene, moved: &[[f64; 3]], places: &[[f64; 3]]) -> bool {
    let extent = moved.iter().flatten().fold(0.0f64, |most, part| most.max(part.abs()));
    let near = |a: &[f64; 3], b: &[f64; 3]| (0..3).all(|axis| (a[axis] - b[axis]).abs() <= ROUNDING * extent);
    let numbers = scene.domain.point_of_vertex().iter().zip(moved);
    places.len() == scene.dataset.point_count() && numbers.into_iter().all(|(&point, place)| near(&places[point as usize], place))
}

fn report(args: &PoseArgs, scene: &Scene, pose: &Pose, found: &Inversions, seconds: f64) -> serde_json::Value {
    let handles: Vec<_> = scene
        .handles
        .names()
        .into_iter()
        .zip(&pose.transforms)
        .map(|(name, transform)| {
            json!({
                "name": name, "quaternion": transform.rotation.quaternion(), "angle_degrees": transform.rotation.planar_angle().map(f64::to_degrees),
                "translation": transform.translation, "scale": transform.scale, "pivot": transform.pivot,
            })
        })
        .collect();
    json!({
        "program": "morsmooth", "version": env!("CARGO_PKG_VERSION"), "command": command_line(),
        "mesh": args.mesh, "weights": args.weights, "pose": args.pose, "output": args.output,
        "method": args.method.to_possible_value().map(|value| value.get_name().to_owned()),
        "points": scene.dataset.point_count(), "vertices": scene.domain.complex.vertex_count(), "elements": scene.domain.complex.simplex_count(),
        "handles": handles, "weights_off_unity": scene.off_unity, "inversions": found.to_json(), "seconds": seconds,
    })
}

/// On standard output; a closed pipe is not an error.
fn print(args: &PoseArgs, scene: &Scene, found: &Inversions, seconds: f64) {
    let mut out = std::io::stdout().lock();
    let mut say = |what: &str, text: String| {
        let _ = writeln!(out, "{what:<15} {text}");
    };
    let complex = &scene.domain.complex;
    say("mesh", format!("{} vertices, {} elements, {} handles", complex.vertex_count(), complex.simplex_count(), scene.handles.len()));
    say("inverted", found.to_string());
    say("time", format!("{seconds:.2} s"));
    say("output", format!("{}, array {DISPLACEMENT}", args.output.display()));
}
