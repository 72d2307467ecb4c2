//! `geodesic`.

use std::sync::Arc;

use morsmooth::field::VertexId;
use morsmooth::geodesic::{ExactGeodesic, GeodesicError, HeatGeodesic, HeatOptions, SurfacePoint, nearest_point};
use morsmooth::io::{MaskSources, domain, mask};
use morsmooth::mesh::{Domain, check};
use morsmooth::operators::OperatorError;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::failure::Failure;
use crate::job::{self, Control};
use crate::mesh::Mesh;
use crate::smooth::choice;

/// The options of [`geodesic`], in the words of the program's.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Options {
    method: String,
    heat_time: f64,
    tolerance: f64,
    allow_unreached: bool,
    mask: Option<String>,
}

#[derive(Clone, Copy, PartialEq)]
enum Method {
    Exact,
    Heat,
}

/// Distances from the nearest of some points and places, on every point of the mesh.
#[pyfunction]
pub fn geodesic(
    py: Python<'_>,
    mesh: &Mesh,
    points: Vec<u64>,
    places: Vec<[f64; 3]>,
    options: Options,
    control: Control,
) -> PyResult<Py<PyAny>> {
    let dataset = Arc::clone(&mesh.dataset);
    let distances = job::run(py, &control, move |talk| {
        talk.stage("reading", 0.0);
        let method = choice("method", &options.method, &[("exact", Method::Exact), ("heat", Method::Heat)])?;
        let sources = MaskSources { array: options.mask.clone(), ..MaskSources::default() };
        let kept = mask(&dataset, &sources).map_err(Failure::input)?;
        let domain = domain(&dataset, &kept).map_err(Failure::input)?;
        drop(dataset);
        let sources = resolve(&domain, &points, &places, options.tolerance)?;
        talk.stage("distances", 0.2);
        let result = match method {
            Method::Exact => ExactGeodesic::new(&domain.complex).and_then(|exact| exact.distances(&sources)),
            Method::Heat => {
                HeatGeodesic::new(&domain.complex, HeatOptions { time: options.heat_time, ..HeatOptions::default() }).and_then(|mut heat| heat.distances(&sources))
            }
        };
        let distances = result.map_err(|error| failure(&domain, &error))?;
        let unreached = distances.iter().filter(|distance| distance.is_infinite()).count();
        if let (Some(vertex), false) = (distances.iter().position(|distance| distance.is_infinite()), options.allow_unreached) {
            let text = format!(
                "no path leads from the sources to {unreached} of {} points, first point {}; expected a source in every part",
                distances.len(),
                domain.point_of_vertex()[vertex]
            );
            return Err(Failure::input(text).hint("add a source there, or allow_unreached=True for NaN"));
        }
        let mut on_points = vec![f64::NAN; domain.point_count()];
        let finite: Vec<f64> = distances.iter().map(|&distance| if distance.is_finite() { distance } else { f64::NAN }).collect();
        domain.extend(&finite, &mut on_points);
        talk.stage("done", 1.0);
        Ok(on_points)
    })?;
    Ok(PyArray1::from_vec(py, distances).into_any().unbind())
}

fn resolve(domain: &Domain, points: &[u64], places: &[[f64; 3]], tolerance: f64) -> Result<Vec<SurfacePoint>, Failure> {
    let mut sources = Vec::with_capacity(points.len() + places.len());
    for &point in points {
        let found = usize::try_from(point).ok().and_then(|point| domain.vertex_of_point().get(point));
        sources.push(SurfacePoint::Vertex(match found {
            Some(Some(vertex)) => *vertex,
            Some(None) => {
                return Err(Failure::input(format!("source {point} is not in the domain; expected a point of a cell that is not masked")));
            }
            None => {
                let last = domain.point_count().saturating_sub(1);
                return Err(Failure::input(format!("found source {point}; the mesh has points 0 to {last}")));
            }
        }));
    }
    let most = tolerance * domain.complex.bounding_box_diagonal();
    for at in places {
        let what = format!("the source {},{},{}", at[0], at[1], at[2]);
        if !at.iter().all(|part| part.is_finite()) {
            return Err(Failure::input(format!("{what} is no place; expected three finite numbers")));
        }
        let Some((point, off)) = nearest_point(&domain.complex, *at) else {
            return Err(Failure::input(format!("{what} needs a surface of triangles; found dimension {}", domain.complex.dimension())));
        };
        if off > most {
            let text = format!("{what} lies {off:e} off the surface; expected at most {most:e}");
            return Err(Failure::input(text).hint("source_tolerance allows more"));
        }
        sources.push(point);
    }
    if sources.is_empty() { Err(Failure::input("found no source; expected at least one")) } else { Ok(sources) }
}

/// An error of the library, vertices translated to points.
fn failure(domain: &Domain, error: &GeodesicError) -> Failure {
    let point = |vertex: VertexId| domain.point_of_vertex()[vertex.index()];
    match error {
        GeodesicError::Operator(OperatorError::ZeroMeasure { .. }) => match check(domain) {
            Err(fault) => Failure::input(fault),
            Ok(()) => Failure::input(error),
        },
        GeodesicError::NonManifoldEdge { vertices, triangles } => Failure::input(format!(
            "the edge between the points {} and {} has {triangles} triangles; expected at most 2 for exact distances",
            point(vertices[0]),
            point(vertices[1])
        ))
        .hint("method 'heat' takes such edges; or mask one of the sheets"),
        GeodesicError::Dimension { .. } => Failure::input(error).hint("method 'heat' works on lines and in tetrahedra as well"),
        GeodesicError::HeatVanished { vertex } => {
            Failure::input(format!("no heat arrives at point {}; expected some everywhere", point(*vertex)))
                .hint("take a greater heat_time, or method 'exact'")
        }
        _ => Failure::input(error),
    }
}
