//! `weights`.

use std::sync::Arc;

use morsmooth::audit::{PlateauReport, audit_plateaus};
use morsmooth::field::Precision;
use morsmooth::interpolate::{
    BoundaryValues, Guide, InterpolateError, InterpolateOptions, Interpolator, Mass, Method, Partition, WeightOptions, skinning_weights,
};
use morsmooth::mesh::check;
use morsmooth::operators::OperatorError;
use morsmooth::qp::QpStatus;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use serde_json::json;

use crate::failure::Failure;
use crate::job::{self, Control};
use crate::mesh::Mesh;
use crate::rig::{Scene, Source};
use crate::smooth::choice;

/// The options of [`weights`], in the words of the program's.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Options {
    method: String,
    order: usize,
    partition: String,
    strongest: Option<usize>,
    mass: String,
    representative: String,
    refine: usize,
    gap: f64,
    at_once: Option<usize>,
    precision: u8,
}

/// The words for methods.
pub const METHODS: [(&str, Method); 4] = [
    ("monotone", Method::Monotone),
    ("bounded", Method::Bounded),
    ("harmonic", Method::Harmonic),
    ("polyharmonic", Method::Polyharmonic),
];

impl Options {
    fn resolve(&self) -> Result<WeightOptions, Failure> {
        let method = choice("method", &self.method, &METHODS)?;
        let partitions = [("free", Partition::Free), ("normalised", Partition::Normalised), ("coupled", Partition::Coupled)];
        let partition = choice("partition", &self.partition, &partitions)?;
        if partition == Partition::Coupled && method != Method::Monotone {
            return Err(Failure::input("found partition 'coupled' with another method; expected method 'monotone'")
                .hint("the weights of linear methods sum to 1 by themselves; bounded ones are normalised"));
        }
        if self.strongest == Some(0) {
            return Err(Failure::input("strongest is 0; expected at least 1"));
        }
        let guides =
            [("automatic", Guide::Automatic), ("smooth-then-simplify", Guide::SmoothThenSimplify), ("harmonic", Guide::Harmonic)];
        let function = InterpolateOptions {
            guide: choice("representative", &self.representative, &guides)?,
            refine: self.refine,
            precision: if self.precision == 32 { Precision::F32 } else { Precision::F64 },
            bounds: Some((0.0, 1.0)),
            relative_gap: self.gap,
            at_once: self.at_once,
        };
        Ok(WeightOptions { method, function, partition, strongest: self.strongest })
    }
}

/// What is found: `points x handles` weights row by row, names, pivots, and a report as JSON.
type Found = (Vec<f64>, Vec<String>, Vec<[f64; 3]>, String);

/// The same for Python.
type Returned = (Py<PyAny>, Vec<String>, Vec<[f64; 3]>, String);

/// Weights of handles: `n x h`, the names, `h x 3` pivots, and the report as JSON.
#[pyfunction]
pub fn weights(
    py: Python<'_>,
    mesh: &Mesh,
    handles: Source,
    options: Options,
    control: Control,
) -> PyResult<Returned> {
    let dataset = Arc::clone(&mesh.dataset);
    let (rows, names, pivots, report): Found = job::run(py, &control, move |talk| {
        talk.stage("reading", 0.0);
        let asked = options.resolve()?;
        let scene = Scene::new(&dataset, &handles)?;
        drop(dataset);
        scene.check_for_weights()?;
        let fail = |error: InterpolateError| match (&error, check(&scene.domain)) {
            (InterpolateError::Operator(OperatorError::ZeroMeasure { .. }), Err(fault)) => Failure::input(fault),
            _ => Failure::input(error),
        };
        let given: Vec<BoundaryValues> = (0..scene.attached.len()).map(|handle| scene.attached.boundary_values(handle).into()).collect();
        talk.stage("operators and analysis", 0.1);
        let mass = choice("mass", &options.mass, &[("voronoi", Mass::Voronoi), ("barycentric", Mass::Barycentric)])?;
        let mut interpolator = Interpolator::with_mass(scene.complex(), options.order, mass).map_err(fail)?;
        talk.stage(&format!("weights of {} handles", given.len()), 0.2);
        let found = skinning_weights(&mut interpolator, &given, &asked).map_err(fail)?;
        talk.stage("audit", 0.95);
        let judged = found.weights.iter().zip(&given).map(|(weights, given)| audit_plateaus(scene.complex(), weights, &given.values));
        let verdicts: Vec<PlateauReport> = judged.collect::<Result<_, _>>().map_err(Failure::input)?;
        let names = scene.attached.names().to_vec();
        let failed: Vec<&str> = names.iter().zip(&verdicts).filter(|(_, verdict)| !verdict.passed).map(|(name, _)| name.as_str()).collect();
        // What is cut off afterwards takes the guarantee with it, as the documentation says.
        if asked.method == Method::Monotone && asked.strongest.is_none() && !failed.is_empty() {
            return Err(Failure::guarantee(format!("the audit of the result failed: extrema beside the handles of {}", failed.join(", "))));
        }
        let listed = names.iter().zip(found.reports.iter().zip(&verdicts)).map(|(name, (report, verdict))| {
            json!({
                "name": name,
                "passed": verdict.passed,
                "minima": verdict.found_minima,
                "maxima": verdict.found_maxima,
                "spurious": verdict.spurious.count,
                "missing": verdict.missing.count,
                "energy": report.energy,
                "solved": report.function.status == QpStatus::Solved,
                "gap": report.function.gap,
                "residual": report.function.residual,
                "iterations": report.function.iterations,
            })
        });
        let report = json!({
            "program": "morsmooth",
            "version": env!("CARGO_PKG_VERSION"),
            "vertices": scene.complex().vertex_count(),
            "simplices": scene.complex().simplex_count(),
            "dimension": scene.complex().dimension(),
            "notes": scene.domain.notes.iter().map(ToString::to_string).collect::<Vec<_>>(),
            "handles": listed.collect::<Vec<_>>(),
            "passed": failed.is_empty(),
            "energy": found.energy,
            "off_unity": found.off_unity.1,
        });
        let pivots: Result<Vec<_>, _> = (0..scene.handles.len()).map(|handle| scene.handles.pivot(handle, scene.complex())).collect();
        let count = names.len();
        let mut rows = vec![0.0; scene.domain.point_count() * count];
        for (handle, weights) in found.weights.iter().enumerate() {
            for (&point, &weight) in scene.domain.point_of_vertex().iter().zip(weights) {
                rows[point as usize * count + handle] = weight;
            }
        }
        talk.stage("done", 1.0);
        Ok((rows, names, pivots.map_err(Failure::input)?, report.to_string()))
    })?;
    let points = rows.len() / names.len().max(1);
    let rows = PyArray1::from_vec(py, rows).reshape([points, names.len()])?;
    Ok((rows.into_any().unbind(), names, pivots, report))
}
