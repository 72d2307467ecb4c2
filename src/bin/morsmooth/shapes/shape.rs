//! From the command line to a shape with handles and weights: what `deform` and `animate` share.

use std::path::{Path, PathBuf};

use clap::Args;
use morsmooth::deform::HeldVertices;
use morsmooth::interpolate::{BoundaryValues, InterpolateOptions, Interpolator, Method};
use morsmooth::io::{
    ArrayData, CellArray, DataArray, DataSet, Geometry, MaskSources, domain, mask, read_handles, read_mesh_or_outline, region_handles,
};
use morsmooth::mesh::{AttachOptions, AttachedHandles, Domain, HandleError, HandleSet, Pose, SimplicialComplex};
use morsmooth::plot::Photograph;

use crate::args::{MethodKind, OutlineArgs};
use crate::common::weight_arrays::{Mesh, WeightFile, rows};
use crate::failure::Failure;

/// The shape and what moves it.
#[derive(Debug, Clone, Args)]
pub struct RigArgs {
    /// Handles: points, bones and regions in a .json file, or a skeleton in a .tgf file.
    #[arg(long, value_name = "FILE", required_unless_present = "handle_array")]
    pub handles: Option<PathBuf>,

    /// Take handles from an array of whole numbers in MESH instead: points, or cells, of one number are one handle, NAME_<number>.
    #[arg(long, value_name = "NAME", conflicts_with = "handles")]
    pub handle_array: Option<String>,

    /// File whose point arrays, named after the handles, are their weights. Computed if absent.
    #[arg(long, value_name = "FILE")]
    pub weights: Option<PathBuf>,

    /// What comes before the name of a handle in the name of its array.
    #[arg(long, value_name = "TEXT", default_value = "", requires = "weights")]
    pub weights_prefix: String,

    /// How weights are computed.
    #[arg(long, value_enum, default_value_t = MethodKind::Monotone, conflicts_with = "weights")]
    pub weight_method: MethodKind,

    /// Order of the energy of computed weights, 1 to 4.
    #[arg(long, value_name = "K", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=4), conflicts_with = "weights")]
    pub weight_order: u8,

    /// How an outline is filled.
    #[command(flatten)]
    pub outline: OutlineArgs,

    /// Triangles into which a photograph is cut, about.
    #[arg(long, value_name = "N", default_value_t = 60_000, value_parser = clap::value_parser!(u32).range(2..=20_000_000))]
    pub triangles: u32,
}

/// A shape at rest.
pub struct Shape {
    /// The file.
    pub path: PathBuf,
    /// All of it; of a photograph, its triangulation.
    pub dataset: DataSet,
    /// The elements.
    pub domain: Domain,
    /// The photograph, where that was the file.
    pub photograph: Option<Photograph>,
}

/// Handles on a shape, with their weights.
pub struct Rig {
    /// The handles; regions in vertices.
    pub set: HandleSet,
    /// The held vertices.
    pub attached: AttachedHandles,
    /// The same for the solver.
    pub held: HeldVertices,
    /// `n x h`, vertex by vertex.
    pub weights: Vec<f64>,
    /// Where they come from.
    pub source: String,
}

/// Whether a path is that of a photograph.
pub fn is_png(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"))
}

impl Shape {
    /// Reads a mesh, an outline, or a photograph.
    pub fn load(path: &Path, args: &RigArgs) -> Result<Self, Failure> {
        let fail = |error: &dyn std::fmt::Display| Failure::usage(error.to_string());
        let (dataset, photograph) = if is_png(path) {
            let photograph = Photograph::read_png(path).map_err(|error| fail(&error))?;
            let complex = photograph.triangulation(args.triangles as usize).map_err(|error| Failure::file(path, error))?;
            (triangles(&complex), Some(photograph))
        } else {
            (read_mesh_or_outline(path, &args.outline.options()).map_err(|error| fail(&error))?, None)
        };
        if matches!(dataset.geometry, Geometry::ImageData { .. } | Geometry::RectilinearGrid { .. }) {
            let text = format!("found {}, whose points cannot move; expected a mesh", dataset.geometry.name());
            return Err(Failure::file(path, text).hint("ParaView's filter Tetrahedralize makes an unstructured grid of it"));
        }
        let kept = mask(&dataset, &MaskSources::default()).map_err(|error| Failure::file(path, error))?;
        let domain = domain(&dataset, &kept).map_err(|error| Failure::file(path, error))?;
        Ok(Self { path: path.to_owned(), dataset, domain, photograph })
    }

    /// The elements.
    pub fn complex(&self) -> &SimplicialComplex {
        &self.domain.complex
    }

    /// Numbers of the cells of some elements, for messages.
    pub fn cells_of(&self, elements: &[usize]) -> Vec<u32> {
        elements.iter().map(|&element| self.domain.cell_of_simplex()[element]).collect()
    }
}

/// A triangulation as a data set.
fn triangles(complex: &SimplicialComplex) -> DataSet {
    let mut cells = CellArray::default();
    for corners in complex.simplices().chunks(3) {
        cells.push(corners.iter().map(|&vertex| i64::from(vertex)));
    }
    let points = DataArray::new("Points", 3, ArrayData::F64(complex.points().as_flattened().to_vec()));
    DataSet::new(Geometry::UnstructuredGrid { points, types: vec![5; cells.len()], cells, polyhedra: None })
}

impl Rig {
    /// Attaches handles, and reads or computes their weights.
    pub fn load(shape: &Shape, args: &RigArgs) -> Result<Self, Failure> {
        let set = match (&args.handles, &args.handle_array) {
            (Some(path), _) => read_handles(path).map_err(|error| Failure::usage(error.to_string()))?,
            (None, Some(array)) => region_handles(&shape.dataset, array).map_err(|error| Failure::file(&shape.path, error))?,
            (None, None) => return Err(Failure::usage("found no handles; expected --handles FILE or --handle-array NAME")),
        };
        let source = args.handles.as_deref().unwrap_or(&shape.path);
        let told = |error: HandleError| Failure::file(source, error);
        // Regions of a file count points; what follows counts vertices.
        let set = set.renumbered(shape.domain.vertex_of_point()).map_err(told)?;
        let attached = set.attach(shape.complex(), &AttachOptions::default()).map_err(told)?;
        let held = held(&attached);
        let (weights, source) = match &args.weights {
            Some(path) => {
                let mesh = Mesh { path: &shape.path, dataset: &shape.dataset, domain: &shape.domain };
                let file = WeightFile::read(path, &mesh, &args.outline.options())?;
                let columns = file.columns(attached.names(), ("--weights-prefix", &args.weights_prefix))?;
                (rows(&columns), path.display().to_string())
            }
            None => computed(shape, args, &attached)?,
        };
        Ok(Self { set, attached, held, weights, source })
    }

    /// Where a pose wants the held vertices.
    pub fn targets(&self, complex: &SimplicialComplex, pose: &Pose) -> Vec<[f64; 3]> {
        let own = self.attached.vertices().iter().enumerate();
        let own = own.flat_map(|(handle, vertices)| {
            vertices.iter().map(move |&vertex| pose.transforms[handle].apply(complex.point(vertex)))
        });
        let shared = self.attached.shared().iter().map(|shared| {
            shared.shares.iter().fold([0.0; 3], |sum, &(handle, share)| {
                let place = pose.transforms[handle].apply(complex.point(shared.vertex));
                [0, 1, 2].map(|axis| sum[axis] + share * place[axis])
            })
        });
        own.chain(shared).collect()
    }
}

/// Own vertices of the handles, then shared ones, in the order of [`Rig::targets`].
fn held(attached: &AttachedHandles) -> HeldVertices {
    let own = attached.vertices().iter().enumerate();
    let own = own.flat_map(|(handle, vertices)| vertices.iter().map(move |&vertex| (vertex, handle)));
    let shared = attached.shared().iter().map(|shared| (shared.vertex, shared.shares.first().map_or(0, |&(handle, _)| handle)));
    let (vertices, owners) = own.chain(shared).unzip();
    HeldVertices { vertices, owners, names: attached.names().to_vec() }
}

fn computed(shape: &Shape, args: &RigArgs, attached: &AttachedHandles) -> Result<(Vec<f64>, String), Failure> {
    let count = attached.len();
    if count == 1 {
        return Ok((vec![1.0; shape.complex().vertex_count()], "one handle has all the weight".to_owned()));
    }
    let method = args.weight_method.method();
    let fail = |error: &dyn std::fmt::Display| Failure::file(&shape.path, format!("no weights: {error}"));
    let given: Vec<BoundaryValues> = (0..count).map(|handle| attached.boundary_values(handle).into()).collect();
    let found = Interpolator::new(shape.complex(), usize::from(args.weight_order))
        .and_then(|mut interpolator| interpolator.solve_each(method, &given, &InterpolateOptions::default()))
        .map_err(|error| fail(&error).hint("--weights FILE takes weights from elsewhere; --weight-method harmonic is the least demanding"))?;
    let columns: Vec<Vec<f64>> = found.into_iter().map(|found| found.values).collect();
    let order = if method == Method::Harmonic { 1 } else { args.weight_order };
    Ok((rows(&columns), format!("computed, {method}, order {order}")))
}
