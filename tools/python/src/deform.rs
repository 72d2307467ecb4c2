//! `deform`.

use std::sync::Arc;

use morsmooth::deform::{
    DeformError, DeformOptions, DeformSolver, DeformStatus, Deformed, HeldVertices, Hold, OnContradiction, RestShape, SolveOptions, rotations,
};
use morsmooth::interpolate::{BoundaryValues, InterpolateOptions, Interpolator};
use morsmooth::io::Geometry;
use morsmooth::mesh::Pose;
use morsmooth::qp::Settings;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;

use crate::failure::Failure;
use crate::job::{self, Control, Talk};
use crate::mesh::Mesh;
use crate::rig::{Scene, Source};
use crate::smooth::choice;
use crate::weights::METHODS;

/// Memory that a factor may take, as in the program.
const MEMORY: usize = 16 << 30;

/// The options of [`deform`], in the words of the program's.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Options {
    weight_method: String,
    weight_order: usize,
    hard: bool,
    alpha: f64,
    incompressible: f64,
    rotation_rounds: usize,
    untangle: bool,
    gap: f64,
    keep_best: bool,
}

/// Weights given, point by point, and the number of points.
type Given = Option<(Vec<f64>, [usize; 2])>;

/// Places of the points, one number or mark for every cell, and the report as JSON.
struct Shaped {
    points: Vec<f64>,
    cells: Vec<(&'static str, Vec<f64>)>,
    active: Vec<u8>,
    report: String,
}

/// Moves a shape: `n x 3` places, a dict of arrays on the cells, and the report as JSON.
#[pyfunction]
pub fn deform<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    handles: Source,
    pose: Source,
    weights: Option<PyReadonlyArray2<'py, f64>>,
    options: Options,
    control: Control,
) -> PyResult<(Py<PyAny>, Bound<'py, PyDict>, String)> {
    let dataset = Arc::clone(&mesh.dataset);
    let given = weights.map(|weights| Ok::<_, PyErr>((weights.as_slice()?.to_vec(), [weights.shape()[0], weights.shape()[1]]))).transpose()?;
    let shaped = job::run(py, &control, move |talk| {
        talk.stage("reading", 0.0);
        if let Geometry::ImageData { .. } | Geometry::RectilinearGrid { .. } = dataset.geometry {
            let text = format!("found {}, whose points cannot move; expected a mesh", dataset.geometry.name());
            return Err(Failure::input(text).hint("ParaView's filter Tetrahedralize makes an unstructured grid of it"));
        }
        let scene = Scene::new(&dataset, &handles)?;
        let pose = scene.pose(&pose)?;
        talk.stage("weights", 0.1);
        let weights = rows(&scene, given, &options)?;
        let deformed = solve(&scene, (&weights, &pose), &options, talk)?;
        shaped(&scene, &deformed, (dataset.points_f64(), dataset.cell_count()))
    })?;
    let points = PyArray1::from_vec(py, shaped.points);
    let count = points.len() / 3;
    let cells = PyDict::new(py);
    for (name, values) in shaped.cells {
        cells.set_item(name, PyArray1::from_vec(py, values))?;
    }
    cells.set_item("active_constraint", PyArray1::from_vec(py, shaped.active))?;
    Ok((points.reshape([count, 3])?.into_any().unbind(), cells, shaped.report))
}

/// `n x h` weights, vertex by vertex: those given, or computed.
fn rows(scene: &Scene, given: Given, options: &Options) -> Result<Vec<f64>, Failure> {
    let (count, points) = (scene.attached.len(), scene.domain.point_count());
    if let Some((rows, shape)) = given {
        if shape != [points, count] {
            return Err(Failure::input(format!("found weights of shape {} x {}; expected {points} points x {count} handles", shape[0], shape[1])));
        }
        if let Some(place) = rows.iter().position(|weight| !weight.is_finite()) {
            return Err(Failure::input(format!("the weight at point {} is {}; expected a finite number", place / count, rows[place])));
        }
        let of_point = |&point: &u32| rows[point as usize * count..][..count].to_vec();
        return Ok(scene.domain.point_of_vertex().iter().flat_map(of_point).collect());
    }
    if count == 1 {
        return Ok(vec![1.0; scene.complex().vertex_count()]);
    }
    let method = choice("weight_method", &options.weight_method, &METHODS)?;
    let given: Vec<BoundaryValues> = (0..count).map(|handle| scene.attached.boundary_values(handle).into()).collect();
    let found = Interpolator::new(scene.complex(), options.weight_order)
        .and_then(|mut interpolator| interpolator.solve_each(method, &given, &InterpolateOptions::default()))
        .map_err(|error| {
            Failure::input(format!("no weights: {error}"))
                .hint("weights may come from elsewhere; weight_method 'harmonic' is the least demanding")
        })?;
    Ok((0..scene.complex().vertex_count()).flat_map(|vertex| found.iter().map(move |column| column.values[vertex])).collect())
}

/// Held vertices and where the pose wants them: own ones of the handles, then shared ones.
fn held(scene: &Scene, pose: &Pose) -> (HeldVertices, Vec<[f64; 3]>) {
    let (attached, complex) = (&scene.attached, scene.complex());
    let mut held = HeldVertices { vertices: Vec::new(), owners: Vec::new(), names: attached.names().to_vec() };
    let mut targets = Vec::new();
    for (handle, vertices) in attached.vertices().iter().enumerate() {
        for &vertex in vertices {
            held.vertices.push(vertex);
            held.owners.push(handle);
            targets.push(pose.transforms[handle].apply(complex.point(vertex)));
        }
    }
    for shared in attached.shared() {
        held.vertices.push(shared.vertex);
        held.owners.push(shared.shares.first().map_or(0, |&(handle, _)| handle));
        targets.push(shared.shares.iter().fold([0.0; 3], |sum, &(handle, share)| {
            let place = pose.transforms[handle].apply(complex.point(shared.vertex));
            [0, 1, 2].map(|axis| sum[axis] + share * place[axis])
        }));
    }
    (held, targets)
}

fn solve(scene: &Scene, (weights, pose): (&[f64], &Pose), options: &Options, talk: &mut Talk) -> Result<Deformed, Failure> {
    if !(options.gap > 0.0 && options.gap < 1.0) {
        return Err(Failure::input(format!("found gap {}; expected a number between 0 and 1", options.gap)));
    }
    let complex = scene.complex();
    let fail = |error: DeformError| {
        let failure = Failure::input(&error);
        match &error {
            DeformError::Inverted { elements } | DeformError::ZeroMeasure { elements, .. } => {
                let cells: Vec<String> = elements.iter().take(10).map(|&element| scene.domain.cell_of_simplex()[element].to_string()).collect();
                failure.hint(format!("cells of the mesh: {}{}", cells.join(", "), if elements.len() > 10 { ", ..." } else { "" }))
            }
            _ => failure,
        }
    };
    talk.stage("analysis", 0.3);
    let (held, targets) = held(scene, pose);
    let hold = if options.hard { Hold::Hard } else { Hold::Soft { alpha: options.alpha } };
    let how = DeformOptions { hold, incompressibility: options.incompressible, ..DeformOptions::default() };
    let rest = if options.untangle { RestShape::untangled(complex) } else { RestShape::new(complex) };
    let mut solver = rest.and_then(|rest| DeformSolver::with_rest(complex, rest, held, how)).map_err(fail)?;
    solver.choose_factor(morsmooth::deform::FactorChoice::Automatic, MEMORY);
    let blended = rotations::blend(complex, weights, pose).map_err(fail)?;
    let wishes = SolveOptions {
        settings: Settings { relative_gap: options.gap, ..SolveOptions::default().settings },
        rounds: options.rotation_rounds,
        on_contradiction: if options.keep_best { OnContradiction::KeepBest } else { OnContradiction::Name },
        ..SolveOptions::default()
    };
    let mut each = |at: morsmooth::deform::DeformPreview<'_>| {
        let digits = -at.gap.clamp(1e-9, 1.0).log10();
        talk.stage(&format!("deforming, iteration {}, relative gap {:.1e}", at.iteration, at.gap), 0.4 + 0.06 * digits);
    };
    let deformed = solver.solve(&blended, &targets, &wishes, &mut each).map_err(fail)?;
    match &deformed.status {
        DeformStatus::Contradiction(blame) if deformed.substitute.is_none() || !deformed.is_inversion_free() => {
            let cells: Vec<String> = blame.elements.iter().take(5).map(|&element| scene.domain.cell_of_simplex()[element].to_string()).collect();
            Err(Failure::contradiction(blame)
                .hint(format!("in the mesh these are the cells {}", cells.join(", ")))
                .hint("keep_best=True would look for the closest shape without inversions"))
        }
        _ if !deformed.is_inversion_free() => {
            let bad = |place: usize| deformed.audit[place].inverted.len() + deformed.audit[place].degenerate.len();
            let text = format!("the audit of the result failed: {} inverted elements in 64 bits, {} in 32 bits", bad(0), bad(1));
            Err(Failure::guarantee(text))
        }
        _ => Ok(deformed),
    }
}

/// Results as arrays on the points and cells of the mesh.
fn shaped(scene: &Scene, deformed: &Deformed, (mut places, cells): (Vec<[f64; 3]>, usize)) -> Result<Shaped, Failure> {
    for (&point, place) in scene.domain.point_of_vertex().iter().zip(&deformed.points) {
        places[point as usize] = *place;
    }
    let owners = scene.domain.cell_of_simplex();
    // A cell of several elements has the least of the first two, the mean by measure of the third, any of the marks.
    let least = |values: &[f64]| {
        let mut found = vec![f64::NAN; cells];
        owners.iter().zip(values).for_each(|(&cell, value)| found[cell as usize] = found[cell as usize].min(*value));
        found
    };
    let (mut sums, mut measures, mut active) = (vec![0.0; cells], vec![0.0; cells], vec![0u8; cells]);
    for (element, &cell) in owners.iter().enumerate() {
        let measure = scene.complex().measure(element);
        sums[cell as usize] += measure * deformed.elements.energy_densities[element];
        measures[cell as usize] += measure;
        active[cell as usize] |= u8::from(deformed.elements.active[element]);
    }
    let densities = sums.iter().zip(&measures).map(|(sum, measure)| sum / measure).collect();
    let report = json!({
        "program": "morsmooth",
        "version": env!("CARGO_PKG_VERSION"),
        "vertices": scene.complex().vertex_count(),
        "elements": scene.complex().simplex_count(),
        "dimension": scene.complex().dimension(),
        "handles": scene.attached.names(),
        "status": deformed.status,
        "substitute": deformed.substitute,
        "optimal": deformed.is_certified(),
        "energy": deformed.energy,
        "certificate": deformed.certificate,
        "effort": deformed.effort,
        "audit": deformed.audit,
    });
    Ok(Shaped {
        points: places.into_flattened(),
        cells: vec![
            ("det_F", least(&deformed.elements.determinants)),
            ("smallest_eigenvalue", least(&deformed.elements.smallest_eigenvalues)),
            ("energy_density", densities),
        ],
        active,
        report: report.to_string(),
    })
}
