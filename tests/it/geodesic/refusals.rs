//! What exact distances refuse, with the place.

use morsmooth::field::VertexId;
use morsmooth::geodesic::{ExactGeodesic, GeodesicError, SurfacePoint, exact_distances, sample_curve};
use morsmooth::mesh::{EdgeId, SimplicialComplex};

use super::at;

fn square() -> SimplicialComplex {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [7.0, 7.0, 7.0]];
    SimplicialComplex::new(2, points, vec![0, 1, 3, 1, 2, 3]).unwrap()
}

#[test]
fn sources_must_be_on_the_mesh() {
    let mesh = square();
    let refusal = |source: SurfacePoint| exact_distances(&mesh, &[at(0), source]).unwrap_err().to_string();
    assert_eq!(exact_distances(&mesh, &[]), Err(GeodesicError::NoSource));
    assert_eq!(refusal(at(5)), "source 1 is vertex 5; expected less than 5");
    assert_eq!(refusal(at(4)), "source 1 is vertex 4, which is in no simplex; expected a vertex of the mesh");
    assert_eq!(refusal(SurfacePoint::Edge { edge: EdgeId(5), share: 0.5 }), "source 1 lies on edge 5; expected less than 5");
    assert_eq!(refusal(SurfacePoint::Face { triangle: 2, weights: [1.0, 0.0, 0.0] }), "source 1 lies on face 2; expected less than 2");
    let words = "source 1 has the weights [0.5, 0.75, -0.25]; expected numbers not below 0 with sum 1";
    assert_eq!(refusal(SurfacePoint::Face { triangle: 0, weights: [0.5, 0.75, -0.25] }), words);
    assert!(refusal(SurfacePoint::Edge { edge: EdgeId(0), share: f64::NAN }).contains("NaN"));
    assert!(refusal(SurfacePoint::Face { triangle: 0, weights: [0.5, 0.5, 0.5] }).contains("sum 1"));
}

#[test]
fn meshes_that_cannot_be_unfolded_are_named() {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]];
    let book = SimplicialComplex::new(2, points.clone(), vec![0, 1, 2, 0, 1, 3, 0, 1, 4]).unwrap();
    let error = ExactGeodesic::new(&book).unwrap_err();
    assert_eq!(error, GeodesicError::NonManifoldEdge { vertices: [VertexId(0), VertexId(1)], triangles: 3 });
    assert_eq!(error.to_string(), "the edge 0-1 has 3 triangles; expected at most 2 for exact distances");
    let solid = SimplicialComplex::new(3, points.clone(), vec![0, 1, 2, 4]).unwrap();
    assert_eq!(ExactGeodesic::new(&solid).unwrap_err(), GeodesicError::Dimension { found: 3 });
    let flat = SimplicialComplex::new(2, vec![[0.0; 3], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]], vec![0, 1, 2]).unwrap();
    assert!(ExactGeodesic::new(&flat).unwrap_err().to_string().starts_with("simplex 0 on vertices 0, 1, 2 has zero measure"));
}

#[test]
fn curves_must_run_on_the_surface() {
    let mesh = square();
    assert_eq!(sample_curve(&mesh, &[at(0), at(2)], 0.1), Err(GeodesicError::CurveOffSurface { first: 0 }));
    assert_eq!(sample_curve(&mesh, &[], 0.1), Err(GeodesicError::NoSource));
    assert_eq!(sample_curve(&mesh, &[at(0)], 0.0), Err(GeodesicError::Number { what: "spacing of a curve", found: 0.0 }));
    assert_eq!(sample_curve(&mesh, &[at(0)], 0.1).unwrap(), [at(0)]);
}
