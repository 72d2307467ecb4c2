//! The heat method: near the truth, and nearer on finer meshes.

use morsmooth::field::VertexId;
use morsmooth::geodesic::{GeodesicError, HeatGeodesic, HeatOptions, SurfacePoint};
use morsmooth::mesh::{Domain, Grid, Mask, SimplicialComplex};

use super::{at, distance};

fn worst(mesh: &SimplicialComplex, source: usize) -> f64 {
    let found = HeatGeodesic::new(mesh, HeatOptions::default()).unwrap().distances(&[at(source)]).unwrap();
    let truth = |vertex: usize| distance(mesh.points()[source], mesh.points()[vertex]);
    (0..found.len()).map(|vertex| (found[vertex] - truth(vertex)).abs()).fold(0.0, f64::max)
}

fn box_grid(side: usize, dimension: usize) -> SimplicialComplex {
    let step = 1.0 / (side - 1) as f64;
    let dims = [side, side, if dimension == 3 { side } else { 1 }];
    Domain::from_grid(&Grid::image(dims, [0.0; 3], [step; 3]), &Mask::none()).unwrap().complex
}

#[test]
fn errors_fall_with_the_mesh_size_on_squares_and_cubes() {
    for (dimension, sides, most) in [(2, [11, 21, 41], 0.08), (3, [5, 9, 17], 0.2)] {
        let errors = sides.map(|side: usize| {
            let mesh = box_grid(side, dimension);
            worst(&mesh, mesh.vertex_count() / 2)
        });
        assert!(errors.is_sorted_by(|a, b| a > b) && errors[2] < most, "{dimension}: {errors:?}");
    }
}

#[test]
fn a_line_is_measured_exactly() {
    let points = (0..30).map(|k| [f64::from(k) * f64::from(k), 0.0, 0.0]).collect();
    let line = SimplicialComplex::new(1, points, (0..29).flat_map(|k| [k, k + 1]).collect()).unwrap();
    let found = HeatGeodesic::new(&line, HeatOptions::default()).unwrap().distances(&[at(7)]).unwrap();
    for (vertex, found) in found.iter().enumerate() {
        assert!((found - distance(line.points()[7], line.points()[vertex])).abs() < 1e-9, "{vertex}: {found}");
    }
}

#[test]
fn factors_serve_many_sources_and_parts_without_source_are_infinitely_far() {
    let mut points = box_grid(9, 2).points().to_vec();
    let n = points.len() as u32;
    let corners = box_grid(9, 2).simplices().to_vec();
    points.extend(points.clone().iter().map(|point| [point[0] + 5.0, point[1], 0.0]));
    let both = corners.iter().copied().chain(corners.iter().map(|vertex| vertex + n)).collect();
    let mesh = SimplicialComplex::new(2, points, both).unwrap();
    let mut heat = HeatGeodesic::new(&mesh, HeatOptions::default()).unwrap();
    let first = heat.distances(&[at(40)]).unwrap();
    assert!(first[..n as usize].iter().all(|distance| distance.is_finite()) && first[40].abs() < 1e-12);
    assert!(first[n as usize..].iter().all(|distance| *distance == f64::INFINITY));
    let second = heat.distances(&[at(40), at(n as usize)]).unwrap();
    assert!(second.iter().all(|distance| distance.is_finite()) && second[n as usize].abs() < 1e-12);
    assert_eq!(heat.distances(&[at(40)]).unwrap(), first, "nothing is left of other sources");
}

#[test]
fn what_cannot_be_done_is_refused() {
    let mesh = box_grid(5, 2);
    let time = |time| HeatGeodesic::new(&mesh, HeatOptions { time }).err();
    assert_eq!(time(0.0), Some(GeodesicError::Number { what: "time of the heat flow", found: 0.0 }));
    assert!(matches!(time(f64::NAN), Some(GeodesicError::Number { .. })));
    let mut heat = HeatGeodesic::new(&mesh, HeatOptions::default()).unwrap();
    assert_eq!(heat.distances(&[]), Err(GeodesicError::NoSource));
    let beyond = SurfacePoint::Vertex(VertexId(25));
    assert_eq!(heat.distances(&[beyond]), Err(GeodesicError::SourceVertex { source_number: 0, vertex: VertexId(25), vertices: 25 }));
    // Heat falls by a factor each edge, until no number is left.
    let points = (0..1500).map(|k| [f64::from(k), 0.0, 0.0]).collect();
    let line = SimplicialComplex::new(1, points, (0..1499).flat_map(|k| [k, k + 1]).collect()).unwrap();
    let mut heat = HeatGeodesic::new(&line, HeatOptions::default()).unwrap();
    assert!(matches!(heat.distances(&[at(0)]), Err(GeodesicError::HeatVanished { .. })));
    assert!(HeatGeodesic::new(&line, HeatOptions { time: 100.0 }).unwrap().distances(&[at(0)]).is_ok());
}
