//! `morsmooth weights`: skinning weights of handles, written, read back, judged.

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use morsmooth::audit::{PlateauReport, audit_plateaus};
use morsmooth::field::{Precision, VertexId};
use morsmooth::interpolate::{
    BoundaryValues, InterpolateError, InterpolateOptions, Interpolator, Mass, Partition, SkinningWeights, WeightOptions, skinning_weights,
};
use morsmooth::io::{
    ArrayData, DataArray, DataSet, PendingFile, domain, is_same_file, read_handles, read_mesh_or_outline, region_handles, write_temporary,
};
use morsmooth::mesh::{AttachOptions, AttachedHandles, Domain, HandleSet, Mask, MeshFault, check, folds};
use morsmooth::operators::OperatorError;

use crate::Outcome;
use crate::args::{GuideKind, MethodKind, OutlineArgs, TalkArgs};
use crate::common::beside::{fitting, read_back};
use crate::common::output::{check_directory, check_output};
use crate::common::report::write_report;
use crate::common::talk::Talk;
use crate::failure::Failure;
use crate::functions::weights_report::{WeightsJob, pictures};

/// `morsmooth weights`.
#[derive(Debug, Args)]
pub struct WeightsArgs {
    /// Mesh: .vtu .vtp .vts .vtk .obj .off .ply .stl .mesh .msh, or an outline .csv, which is filled with triangles.
    pub mesh: PathBuf,

    /// File to write, .vtu .vtp or .vtk: the mesh file with one point array a handle, named after it, and the field data arrays
    /// 'handle_names' and 'handle_pivots'.
    pub output: PathBuf,

    /// Handles: a .json or .tgf file, or the name of an array of the mesh whose numbers say which points are which handle.
    ///
    /// {"handles": [{"name": "head", "point": [x, y, z]}, {"name": "arm", "bone": [[x, y, z], [x, y, z]]}, {"name": "base", "region":
    /// [point numbers]}], "cage": [["head", "foot"]]}.
    #[arg(long, value_name = "FILE")]
    pub handles: PathBuf,

    /// How weights are found.
    #[arg(long, value_enum, default_value_t = MethodKind::Monotone)]
    pub method: MethodKind,

    /// Order of the energy; harmonic weights are of order 1 whatever it is.
    #[arg(long, value_name = "K", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=4))]
    pub order: u8,

    /// Whether the weights of a point sum to 1.
    #[arg(long, value_enum, default_value_t = PartitionKind::Normalised)]
    pub partition: PartitionKind,

    /// Leave only so many of the greatest weights at each point, and divide them by their sum. Monotone weights lose their guarantee.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub strongest: Option<u16>,

    /// Point array whose nonzero entries are locked: there the weights stay what the mesh file's arrays of the handles' names say, 0
    /// where there is none.
    #[arg(long, value_name = "NAME")]
    pub locked: Option<String>,

    /// What comes before the name of the handle in the names of the arrays.
    #[arg(long, value_name = "TEXT", default_value = "")]
    pub prefix: String,

    /// Width of the arrays written.
    #[arg(long, value_name = "BITS", default_value_t = 64, value_parser = parse_precision)]
    pub precision: u8,

    /// Mass between the Laplacians.
    #[arg(long, value_enum, default_value_t = MassKind::Voronoi)]
    pub mass: MassKind,

    /// Representative function of monotone weights.
    #[arg(long, value_enum, default_value_t = GuideKind::Automatic)]
    pub representative: GuideKind,

    /// Solve again so many times, with the last solution as representative function; stops where the energy does.
    #[arg(long, value_name = "ROUNDS", default_value_t = 0)]
    pub refine: usize,

    /// Duality gap, relative to the energy, at which a solve ends.
    #[arg(long, value_name = "GAP", default_value_t = 1e-6)]
    pub gap: f64,

    /// Most handles that are solved for at the same time; each needs a factor of its own. As many as threads by default.
    #[arg(long, value_name = "N")]
    pub at_once: Option<usize>,

    /// How an outline is filled.
    #[command(flatten)]
    pub outline: OutlineArgs,

    /// Write the output even if the audit of monotone weights fails.
    #[arg(long)]
    pub keep_unaudited: bool,

    /// Draw every handle's weights into this directory, with isolines and extrema.
    #[arg(long, value_name = "DIR")]
    pub plots: Option<PathBuf>,

    /// What is said, and threads.
    #[command(flatten)]
    pub talk: TalkArgs,
}

/// Values of `--partition`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PartitionKind {
    /// Not asked for.
    Free,
    /// Divided by the sum afterwards; monotone weights are led back into their order.
    Normalised,
    /// One problem for all handles (monotone, few handles, small meshes).
    Coupled,
}

/// Values of `--mass`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MassKind {
    /// Mixed Voronoi areas on triangles, as in libigl; equal shares otherwise.
    Voronoi,
    /// Equal shares.
    Barycentric,
}

fn parse_precision(text: &str) -> Result<u8, String> {
    match text {
        "32" => Ok(32),
        "64" => Ok(64),
        _ => Err("expected 32 or 64".to_owned()),
    }
}

/// The mesh and its handles.
pub struct Scene {
    /// The file.
    pub dataset: DataSet,
    /// What is computed on.
    pub domain: Domain,
    /// As in the file, regions in vertices.
    pub handles: HandleSet,
    /// The vertices that carry them.
    pub attached: AttachedHandles,
    /// Values given to every handle's weights.
    pub given: Vec<BoundaryValues>,
}

/// Runs the command.
pub fn run(args: &WeightsArgs) -> Result<Outcome, Failure> {
    let begin = Instant::now();
    check_output(&args.mesh, &args.output, args.talk.report.as_deref(), &[&args.handles])?;
    if is_same_file(&args.handles, &args.output) {
        return Err(Failure::file(&args.output, "the output would overwrite the handles; expected another name"));
    }
    check_directory(args.plots.as_deref())?;
    if args.partition == PartitionKind::Coupled && args.method != MethodKind::Monotone {
        return Err(Failure::usage("found --partition coupled with another method; expected --method monotone")
            .hint("the weights of linear methods sum to 1 by themselves; bounded ones are normalised"));
    }
    let talk = Talk::new(args.talk.quiet);
    talk.stage("reading");
    let scene = Scene::load(args)?;
    scene.domain.notes.iter().for_each(|note| talk.line(&format!("note: {note}")));
    let read_seconds = begin.elapsed().as_secs_f64();
    talk.stage("operators and analysis");
    let clock = Instant::now();
    let mass = match args.mass {
        MassKind::Voronoi => Mass::Voronoi,
        MassKind::Barycentric => Mass::Barycentric,
    };
    let failed = |error: InterpolateError| scene.failure(args, &error);
    let order = usize::from(args.order);
    let mut interpolator = Interpolator::with_mass(&scene.domain.complex, order, mass).map_err(failed)?;
    let analysis_seconds = clock.elapsed().as_secs_f64();
    talk.stage(&format!("weights of {} handles", scene.given.len()));
    let clock = Instant::now();
    let found = skinning_weights(&mut interpolator, &scene.given, &args.options()).map_err(failed)?;
    let solve_seconds = clock.elapsed().as_secs_f64();
    talk.stage("writing, and audit of the file as written");
    let (pending, verdicts) = scene.write_and_audit(args, &found)?;
    let passed = args.method != MethodKind::Monotone || verdicts.iter().all(|verdict| verdict.passed);
    let is_kept = passed || args.keep_unaudited;
    let job = WeightsJob {
        args,
        scene: &scene,
        found: &found,
        verdicts: &verdicts,
        is_mixed: interpolator.is_mixed(),
        factor_entries: interpolator.factor_entries(),
        is_kept,
        seconds: [read_seconds, analysis_seconds, solve_seconds, begin.elapsed().as_secs_f64()],
    };
    if let Some(directory) = &args.plots {
        talk.stage("pictures");
        pictures(directory, &job)?;
    }
    if let Some(path) = &args.talk.report {
        write_report(path, &job.to_json())?;
    }
    // Last, so that whatever fails before leaves no output.
    if is_kept {
        pending.commit().map_err(|error| Failure::usage(error.to_string()))?;
    } else {
        drop(pending);
    }
    talk.finish();
    job.warnings().iter().for_each(|warning| talk.warn(warning));
    if !args.talk.quiet {
        job.print();
    }
    Ok(if passed { Outcome::Done } else { Outcome::NotMet })
}

impl WeightsArgs {
    /// Width of the arrays written.
    pub fn width(&self) -> Precision {
        if self.precision == 32 { Precision::F32 } else { Precision::F64 }
    }

    fn options(&self) -> WeightOptions {
        WeightOptions {
            method: self.method.method(),
            function: InterpolateOptions {
                guide: self.representative.guide(),
                refine: self.refine,
                precision: self.width(),
                bounds: Some((0.0, 1.0)),
                relative_gap: self.gap,
                at_once: self.at_once,
            },
            partition: match self.partition {
                PartitionKind::Free => Partition::Free,
                PartitionKind::Normalised => Partition::Normalised,
                PartitionKind::Coupled => Partition::Coupled,
            },
            strongest: self.strongest.map(usize::from),
        }
    }
}

impl Scene {
    fn load(args: &WeightsArgs) -> Result<Self, Failure> {
        let dataset = read_mesh_or_outline(&args.mesh, &args.outline.options()).map_err(|error| Failure::usage(error.to_string()))?;
        let file = |error: &dyn std::fmt::Display| Failure::file(&args.mesh, error);
        let domain = domain(&dataset, &Mask::none()).map_err(|error| file(&error))?;
        check(&domain).map_err(|fault| file(&fault))?;
        let loose = |note: &&MeshFault| matches!(note, MeshFault::UnreferencedPoints { .. } | MeshFault::IsolatedPoints { .. });
        if let Some(MeshFault::UnreferencedPoints { count, first } | MeshFault::IsolatedPoints { count, first }) =
            domain.notes.iter().find(loose)
        {
            let text = format!("{count} points belong to no cell, first point {first}; expected every point to be a corner of one");
            return Err(file(&text).hint("no handle reaches them, so they have no weights: remove them from the mesh"));
        }
        if let Some(fold) = folds(&domain.complex).first() {
            let cells = [fold.first, fold.second].map(|simplex| domain.cell_of_simplex()[simplex]);
            let corners = [fold.first, fold.second].map(|simplex| {
                let vertices: Vec<VertexId> = domain.complex.simplex(simplex).iter().map(|&vertex| VertexId(vertex)).collect();
                domain.points_of(&vertices)
            });
            let text = format!(
                "cells {} and {} (points {:?} and {:?}) lie on the same side of what they share: one of them is inverted; expected \
                 neighbours on either side",
                cells[0], cells[1], corners[0], corners[1]
            );
            return Err(file(&text));
        }
        let set = match args.handles.to_str().filter(|name| !args.handles.exists() && has_array(&dataset, name)) {
            Some(name) => region_handles(&dataset, name).map_err(|error| file(&error))?,
            None => read_handles(&args.handles).map_err(|error| Failure::usage(error.to_string()))?,
        };
        let named = |error: morsmooth::mesh::HandleError| Failure::file(&args.handles, error);
        let handles = set.renumbered(domain.vertex_of_point()).map_err(named)?;
        let attached = handles.attach(&domain.complex, &AttachOptions::default()).map_err(named)?;
        let mut scene = Self { dataset, domain, handles, attached, given: Vec::new() };
        scene.given = scene.boundary_values(args)?;
        Ok(scene)
    }

    /// Values at handles and locked vertices, one list a handle.
    fn boundary_values(&self, args: &WeightsArgs) -> Result<Vec<BoundaryValues>, Failure> {
        let mut given: Vec<Vec<(VertexId, f64)>> =
            (0..self.attached.len()).map(|handle| self.attached.boundary_values(handle)).collect();
        if let Some(name) = &args.locked {
            let column = |name: &str| self.dataset.point_array(name).map(|array| self.domain.restrict(&array.to_f64(0)));
            let Some(locked) = column(name) else {
                return Err(Failure::file(&args.mesh, format!("found no point array '{name}'; expected one that says what is locked")));
            };
            for (handle, given) in self.attached.names().iter().zip(&mut given) {
                let weights = column(&format!("{}{handle}", args.prefix));
                let held: std::collections::BTreeSet<VertexId> = given.iter().map(|&(vertex, _)| vertex).collect();
                let is_locked = |&vertex: &VertexId| locked[vertex.index()] != 0.0 && !held.contains(&vertex);
                let vertices = (0..locked.len()).map(VertexId::from).filter(is_locked);
                let round = |value: f64| args.width().round(value);
                given.extend(vertices.map(|vertex| (vertex, weights.as_ref().map_or(0.0, |weights| round(weights[vertex.index()])))));
            }
        }
        Ok(given.into_iter().map(BoundaryValues::from).collect())
    }

    /// Name of the array of a handle.
    pub fn array_name(&self, args: &WeightsArgs, handle: usize) -> String {
        format!("{}{}", args.prefix, self.attached.names()[handle])
    }

    /// Writes the arrays into a copy of the mesh file beside the output, and judges what is in it then.
    fn write_and_audit(&self, args: &WeightsArgs, found: &SkinningWeights) -> Result<(PendingFile, Vec<PlateauReport>), Failure> {
        let mut dataset = fitting(self.dataset.clone(), &args.output)?;
        for (handle, weights) in found.weights.iter().enumerate() {
            let mut on_points = vec![0.0; self.domain.point_count()];
            self.domain.extend(weights, &mut on_points);
            let data = match args.width() {
                Precision::F32 => ArrayData::F32(on_points.iter().map(|&value| value as f32).collect()),
                Precision::F64 => ArrayData::F64(on_points),
            };
            dataset.set_point_array(DataArray::new(self.array_name(args, handle), 1, data));
        }
        let names = self.attached.names().iter().map(|name| name.clone().into_bytes()).collect();
        let mut pivots = Vec::with_capacity(3 * self.handles.len());
        for handle in 0..self.handles.len() {
            pivots.extend(self.handles.pivot(handle, &self.domain.complex).map_err(|error| Failure::file(&args.handles, error))?);
        }
        dataset.field_data.retain(|array| array.name != "handle_names" && array.name != "handle_pivots");
        dataset.field_data.push(DataArray::new("handle_names", 1, ArrayData::String(names)));
        dataset.field_data.push(DataArray::new("handle_pivots", 3, ArrayData::F64(pivots)));
        let pending = write_temporary(&args.output, &dataset).map_err(|error| Failure::usage(error.to_string()))?;
        drop(dataset);
        let path = pending.path();
        let written = read_back(&pending)?;
        let judged = (0..found.weights.len()).map(|handle| {
            let name = self.array_name(args, handle);
            let array = written.point_array(&name).ok_or_else(|| {
                Failure::file(&args.output, format!("the format has no room for the array {name}; expected .vtu, .vtp or .vtk"))
            })?;
            let values = self.domain.restrict(&array.to_f64(0));
            audit_plateaus(&self.domain.complex, &values, &self.given[handle].values).map_err(|error| Failure::file(path, error))
        });
        let verdicts = judged.collect::<Result<Vec<_>, _>>()?;
        Ok((pending, verdicts))
    }

    /// An error of the library as one about the file.
    fn failure(&self, args: &WeightsArgs, error: &InterpolateError) -> Failure {
        if let InterpolateError::Operator(OperatorError::ZeroMeasure { .. }) = error
            && let Err(fault) = check(&self.domain)
        {
            return Failure::file(&args.mesh, fault);
        }
        Failure::file(&args.mesh, error)
    }
}

fn has_array(dataset: &DataSet, name: &str) -> bool {
    dataset.point_array(name).is_some() || dataset.cell_array(name).is_some()
}
