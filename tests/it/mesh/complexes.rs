//! Incidence against brute force, and Euler's formula.

use super::shapes::{grid, sphere, torus, with_threads};
use morsmooth::field::VertexId;
use morsmooth::mesh::{EdgeId, MeshError, SimplicialComplex, TriangleId};
use proptest::prelude::*;
use std::collections::BTreeSet;

/// Alternating sum of the numbers of cells.
fn euler(complex: &SimplicialComplex) -> i64 {
    let [v, e, t] = [complex.vertex_count(), complex.edges().len(), complex.triangles().len()].map(|count| count as i64);
    match complex.dimension() {
        1 => v - e,
        2 => v - e + t,
        _ => v - e + t - complex.simplex_count() as i64,
    }
}

#[test]
fn euler_characteristic_of_known_shapes() {
    assert_eq!(euler(&sphere(0)), 2);
    assert_eq!(euler(&sphere(4)), 2);
    assert_eq!(euler(&torus(7, 5)), 0);
    for dims in [[9, 1, 1], [1, 1, 4], [5, 7, 1], [1, 3, 4], [4, 3, 5], [2, 2, 2]] {
        assert_eq!(euler(&grid(dims)), 1, "a grid {dims:?} is contractible");
    }
}

#[test]
fn a_long_complex_spans_many_parallel_tasks_and_has_one_result() {
    // More vertices than one task holds, and one vertex of very high degree.
    let n = 30_000u32;
    let fan: Vec<u32> = (1..n - 1).flat_map(|v| [0, v, v + 1]).collect();
    let points = (0..n).map(|v| [v as f64, (v as f64).powi(2), 0.0]).collect::<Vec<_>>();
    let [one, four] = with_threads(|| SimplicialComplex::new(2, points.clone(), fan.clone()).unwrap());
    assert_eq!((one.edges(), one.triangles()), (four.edges(), four.triangles()));
    assert_eq!(one.neighbours(VertexId(0)).len(), n as usize - 1);
    assert_eq!(euler(&one), 1);
}

#[test]
fn components_are_numbered_by_their_lowest_vertex() {
    let complex = SimplicialComplex::new(1, vec![[0.0; 3]; 6], vec![5, 1, 0, 4, 4, 2]).unwrap();
    assert_eq!(complex.components(), (vec![0, 1, 0, 2, 0, 1], 3)); // vertex 3 is of no simplex
}

#[test]
fn every_mesh_error() {
    let points = || vec![[0.0; 3]; 4];
    let error = |dimension, simplices: &[u32]| SimplicialComplex::new(dimension, points(), simplices.to_vec()).unwrap_err();
    assert_eq!(error(0, &[]), MeshError::Dimension { found: 0 });
    assert_eq!(error(4, &[]).to_string(), "simplices of dimension 4; expected 1, 2 or 3");
    assert_eq!(error(2, &[0, 1, 2, 3]), MeshError::Stride { found: 4, stride: 3 });
    assert_eq!(error(1, &[0, 1, 2, 4]), MeshError::VertexOutOfRange { simplex: 1, vertex: 4, vertices: 4 });
    assert_eq!(error(2, &[0, 1, 2, 3, 1, 3]), MeshError::RepeatedVertex { simplex: 1, vertex: 3 });
    assert_eq!(error(3, &[3, 1, 2, 0, 0, 1, 2, 3]), MeshError::DuplicateSimplex { first: 0, second: 1 });
    assert_eq!(error(1, &[2, 3, 0, 1, 1, 0, 3, 2]).to_string(), "simplices 1 and 2 have the same vertices");
}

/// Random simplices without repeated vertices or duplicates, in any order and orientation.
fn random_simplices(dimension: usize) -> impl Strategy<Value = Vec<u32>> {
    let simplex = proptest::sample::subsequence((0..9u32).collect::<Vec<_>>(), dimension + 1);
    proptest::collection::btree_set(simplex, 1..30)
        .prop_flat_map(|set| Just(set.into_iter().collect::<Vec<_>>()).prop_shuffle())
        .prop_flat_map(|list| list.into_iter().map(|simplex| Just(simplex).prop_shuffle()).collect::<Vec<_>>())
        .prop_map(|list| list.concat())
}

fn subsets(simplex: &[u32], size: usize) -> Vec<Vec<VertexId>> {
    let chosen = (0u32..1 << simplex.len()).filter(|set| set.count_ones() as usize == size);
    chosen
        .map(|set| {
            let mut face: Vec<VertexId> =
                (0..simplex.len()).filter(|corner| set >> corner & 1 == 1).map(|corner| VertexId(simplex[corner])).collect();
            face.sort();
            face
        })
        .collect()
}

proptest! {
    #[test]
    fn incidence_equals_brute_force((dimension, simplices) in (1usize..4).prop_flat_map(|d| (Just(d), random_simplices(d)))) {
        let complex = SimplicialComplex::new(dimension, vec![[0.0; 3]; 9], simplices.clone()).unwrap();
        let faces = |size| simplices.chunks(dimension + 1).flat_map(|s| subsets(s, size)).collect::<BTreeSet<_>>();
        let edges: Vec<Vec<VertexId>> = complex.edges().iter().map(|e| e.to_vec()).collect();
        prop_assert_eq!(&edges, &faces(2).into_iter().collect::<Vec<_>>());
        let triangles: Vec<Vec<VertexId>> = complex.triangles().iter().map(|t| t.to_vec()).collect();
        let expected = if dimension > 1 { faces(3).into_iter().collect() } else { Vec::new() };
        prop_assert_eq!(&triangles, &expected);
        for (id, edge) in complex.edges().iter().enumerate() {
            prop_assert_eq!(complex.edge(edge[1], edge[0]), Some(EdgeId(id as u32)));
        }
        for (id, &[a, b, c]) in complex.triangles().iter().enumerate() {
            prop_assert_eq!(complex.triangle([c, a, b]), Some(TriangleId(id as u32)));
        }
        for vertex in (0..9).map(VertexId) {
            let star: Vec<u32> = (0..complex.simplex_count() as u32)
                .filter(|&s| complex.simplex(s as usize).contains(&vertex.0)).collect();
            prop_assert_eq!(complex.star(vertex), star);
            let neighbours: Vec<VertexId> = (0..9).map(VertexId)
                .filter(|&other| complex.edges().contains(&[vertex.min(other), vertex.max(other)])).collect();
            prop_assert_eq!(complex.neighbours(vertex), neighbours);
            for (&neighbour, &edge) in complex.neighbours(vertex).iter().zip(complex.incident_edges(vertex)) {
                prop_assert_eq!(complex.edges()[edge.0 as usize], [vertex.min(neighbour), vertex.max(neighbour)]);
            }
        }
    }
}
