//! Cancellation against union–find; separatrices that are left.

use std::collections::BTreeSet;

use morsmooth::field::{VertexId, VertexOrder};
use morsmooth::mesh::SimplicialComplex;
use morsmooth::morse::{
    ExtremumGraph, ExtremumKind, MorseComplex, MorseError, Selection, Threshold, extremum_pairs, select, separatrices,
};
use proptest::prelude::*;

use super::gradient::assert_is_gradient;
use super::meshes;

const KINDS: [ExtremumKind; 2] = [ExtremumKind::Minimum, ExtremumKind::Maximum];

fn assert_is_path(complex: &SimplicialComplex, path: &[VertexId]) {
    assert!(path.windows(2).all(|step| complex.edge(step[0], step[1]).is_some()));
    assert_eq!(path.iter().collect::<BTreeSet<_>>().len(), path.len(), "{path:?} visits a vertex twice");
}

/// Simplifies to the extrema above a threshold and checks everything that is promised.
fn check(complex: &SimplicialComplex, values: &[f64], threshold: f64) {
    let order = VertexOrder::of_values(values).unwrap();
    let pairs = KINDS.map(|kind| extremum_pairs(complex, &order, kind));
    let selection = Selection::Threshold(Threshold::Absolute(threshold));
    let wanted = select(&pairs[0], &pairs[1], values, &selection).unwrap();
    for ((kind, pairs), wanted) in KINDS.into_iter().zip(&pairs).zip([wanted.minima, wanted.maxima]) {
        let mut graph = ExtremumGraph::new(complex, &order, kind).unwrap();
        let cancelled = graph.simplify(values, &wanted).unwrap();
        assert!(cancelled.windows(2).all(|pair| pair[0].persistence <= pair[1].persistence));
        let mut found: Vec<_> = cancelled.iter().map(|pair| (pair.extremum, Some(pair.saddle_vertex))).collect();
        let unwanted = pairs.iter().filter(|pair| wanted.binary_search(&pair.extremum).is_err());
        let mut expected: Vec<_> = unwanted.map(|pair| (pair.extremum, pair.saddle)).collect();
        found.sort_unstable();
        expected.sort_unstable();
        assert_eq!(found, expected, "cancellation and union–find");
        check_graph(complex, &graph, &wanted);
        let components = pairs.iter().filter(|pair| pair.is_essential()).count();
        let joins = graph.saddles().iter().filter(|saddle| saddle.joins).count();
        assert_eq!(joins, wanted.len() - components);
    }
}

fn check_graph(complex: &SimplicialComplex, graph: &ExtremumGraph<'_>, wanted: &[VertexId]) {
    assert_eq!(graph.extrema(), wanted);
    graph.gradient().check_euler().unwrap();
    assert_is_gradient(complex, graph.gradient());
    let successors = graph.successors();
    for saddle in graph.saddles() {
        let ends = complex.edges()[saddle.edge.0 as usize];
        let separatrices = graph.separatrices(&saddle);
        for separatrix in &separatrices {
            assert_eq!(separatrix[0], saddle.vertex);
            assert!(wanted.binary_search(separatrix.last().unwrap()).is_ok());
        }
        let [own, across] = &separatrices;
        assert_is_path(complex, own);
        assert!(ends.contains(&across[0]) && ends.contains(&across[1]));
        assert!(own.windows(2).chain(across[1..].windows(2)).all(|s| successors[s[0].index()] == Some(s[1])));
        if saddle.joins {
            assert_is_path(complex, across);
            assert!(across[1..].iter().all(|vertex| !own.contains(vertex)), "the two share the saddle only");
        }
    }
}

proptest! {
    #[test]
    fn cancellation_agrees_with_union_find(
        (complex, values) in meshes::random_field(),
        threshold in (0..8i32).prop_map(f64::from),
    ) {
        check(&complex, &values, threshold);
    }

    #[test]
    fn any_set_with_one_extremum_a_component_can_be_kept(
        (complex, values) in meshes::random_field(),
        seed in any::<u64>(),
    ) {
        let order = VertexOrder::of_values(&values).unwrap();
        for kind in KINDS {
            let pairs = extremum_pairs(&complex, &order, kind);
            let luck = meshes::noise(pairs.len(), seed, 2);
            let mut wanted: Vec<VertexId> =
                pairs.iter().zip(&luck).filter(|(_, luck)| **luck > 0.0).map(|(pair, _)| pair.extremum).collect();
            wanted.sort_unstable();
            let served = |component| {
                pairs.iter().any(|pair| pair.component == component && wanted.binary_search(&pair.extremum).is_ok())
            };
            let unserved = pairs.iter().map(|pair| pair.component).filter(|&component| !served(component)).min();
            let mut graph = ExtremumGraph::new(&complex, &order, kind).unwrap();
            let untouched = graph.gradient().clone();
            match unserved {
                Some(component) => {
                    let refused = graph.simplify(&values, &wanted).unwrap_err();
                    prop_assert_eq!(refused, MorseError::ComponentWithout { kind, component });
                    prop_assert_eq!(graph.gradient(), &untouched);
                }
                None => {
                    graph.simplify(&values, &wanted).unwrap();
                    check_graph(&complex, &graph, &wanted);
                }
            }
        }
    }
}

#[test]
fn noise_on_every_mesh_simplifies_to_any_threshold() {
    for (_, complex, _) in meshes::all() {
        for levels in [5, 1 << 40] {
            let values = meshes::noise(complex.vertex_count(), 23, levels);
            for threshold in [0.0, 0.2, 0.5, 0.8, 2.0] {
                check(&complex, &values, threshold);
            }
        }
    }
}

#[test]
fn steps_of_simplification_add_up() {
    let grid = meshes::grid(30, 20);
    let values = meshes::noise(600, 9, 1 << 40);
    let order = VertexOrder::of_values(&values).unwrap();
    let pairs = KINDS.map(|kind| extremum_pairs(&grid, &order, kind));
    let wanted = |threshold| {
        select(&pairs[0], &pairs[1], &values, &Selection::Threshold(Threshold::Absolute(threshold))).unwrap().minima
    };
    let mut stepwise = ExtremumGraph::new(&grid, &order, ExtremumKind::Minimum).unwrap();
    let mut at_once = stepwise.clone();
    for threshold in [0.1, 0.3, 0.7] {
        stepwise.simplify(&values, &wanted(threshold)).unwrap();
    }
    at_once.simplify(&values, &wanted(0.7)).unwrap();
    assert_eq!(stepwise.gradient(), at_once.gradient());
    assert_eq!(stepwise.cancellations(), at_once.cancellations());
    let morse = MorseComplex::new(&grid, stepwise.gradient());
    assert_eq!(morse.boundary_defect(), None);
}

#[test]
fn on_a_closed_surface_saddles_of_both_sides_are_the_same() {
    for (complex, characteristic) in [(meshes::sphere(9), 2), (meshes::torus(16), 0)] {
        // Smooth enough for simple saddles at a high threshold; noise for many extrema to cancel.
        let values = meshes::noise(complex.vertex_count(), 4, 1 << 40);
        let order = VertexOrder::of_values(&values).unwrap();
        let pairs = KINDS.map(|kind| extremum_pairs(&complex, &order, kind));
        for threshold in [0.3, 0.6, 0.75] {
            let selection = Selection::Threshold(Threshold::Absolute(threshold));
            let wanted = select(&pairs[0], &pairs[1], &values, &selection).unwrap();
            let [mut minima, mut maxima] = KINDS.map(|kind| ExtremumGraph::new(&complex, &order, kind).unwrap());
            minima.simplify(&values, &wanted.minima).unwrap();
            maxima.simplify(&values, &wanted.maxima).unwrap();
            let skeleton = separatrices(&minima, &maxima);
            // χ = minima - saddles + maxima; a degenerate saddle counts more than once.
            let expected = (wanted.minima.len() + wanted.maxima.len()) as i64 - characteristic;
            let found = skeleton.saddles.len() as i64;
            assert!(found <= expected && found >= expected / 2, "{found} saddles; {expected} with multiplicity");
            for saddle in &skeleton.saddles {
                for side in [&skeleton.descending, &skeleton.ascending] {
                    let from_saddle = side.iter().filter(|path| path[0] == *saddle).count();
                    assert!(from_saddle >= 2, "vertex {saddle} has {from_saddle} separatrices on one side");
                }
            }
            let order = skeleton.order().expect("no boundary, no contradiction");
            let place = |vertex: VertexId| order.iter().position(|&listed| listed == vertex).unwrap();
            assert!(skeleton.descending.iter().flat_map(|p| p.windows(2)).all(|s| place(s[0]) > place(s[1])));
            assert!(skeleton.ascending.iter().flat_map(|p| p.windows(2)).all(|s| place(s[0]) < place(s[1])));
            assert!(skeleton.descending.iter().all(|path| wanted.minima.contains(path.last().unwrap())));
            assert!(skeleton.ascending.iter().all(|path| wanted.maxima.contains(path.last().unwrap())));
        }
    }
}

proptest! {
    #[test]
    fn separatrices_of_an_order_never_contradict_it((complex, values) in meshes::random_field()) {
        let order = VertexOrder::of_values(&values).unwrap();
        let [minima, maxima] = KINDS.map(|kind| ExtremumGraph::new(&complex, &order, kind).unwrap());
        let skeleton = separatrices(&minima, &maxima);
        prop_assert!(skeleton.order().is_some());
        for (paths, falls) in [(&skeleton.descending, true), (&skeleton.ascending, false)] {
            for path in paths {
                prop_assert!(path.windows(2).all(|step| order.is_below(step[1], step[0]) == falls));
            }
        }
        for saddle in skeleton.saddles {
            // In dimension 1 and where the mesh is pinched, minima are joined at maxima.
            let is_maximum = maxima.extrema().contains(&saddle);
            let is_minimum = minima.extrema().contains(&saddle);
            prop_assert!(is_minimum || skeleton.descending.iter().any(|path| path[0] == saddle));
            prop_assert!(is_maximum || skeleton.ascending.iter().any(|path| path[0] == saddle));
        }
    }
}

#[test]
fn on_a_line_minima_are_joined_at_maxima() {
    // Found by the property above: such a saddle has nothing above it.
    let line = meshes::line(3);
    let order = VertexOrder::of_values(&[0.0, 2.0, 1.0]).unwrap();
    let [minima, maxima] = KINDS.map(|kind| ExtremumGraph::new(&line, &order, kind).unwrap());
    let skeleton = separatrices(&minima, &maxima);
    let v = VertexId;
    assert_eq!(skeleton.saddles, [v(1)]);
    assert_eq!(skeleton.descending, [vec![v(1), v(0)], vec![v(1), v(2)]]);
    assert!(skeleton.ascending.is_empty());
    assert_eq!(skeleton.order().unwrap(), [v(0), v(2), v(1)]);
}

#[test]
fn refusals_leave_the_graph_as_it_was() {
    let line = meshes::line(5);
    let values = [0.0, 2.0, 1.0, 3.0, 0.5];
    let order = VertexOrder::of_values(&values).unwrap();
    let mut graph = ExtremumGraph::new(&line, &order, ExtremumKind::Minimum).unwrap();
    let before = graph.gradient().clone();
    let refused = [
        (graph.simplify(&values[1..], &[VertexId(0)]).unwrap_err(), MorseError::ValuesLength { expected: 5, found: 4 }),
        (graph.simplify(&values, &[VertexId(1)]).unwrap_err(), MorseError::NotAnExtremum { vertex: VertexId(1) }),
        (graph.simplify(&values, &[VertexId(77)]).unwrap_err(), MorseError::NotAnExtremum { vertex: VertexId(77) }),
        (
            graph.simplify(&values, &[]).unwrap_err(),
            MorseError::ComponentWithout { kind: ExtremumKind::Minimum, component: VertexId(0) },
        ),
    ];
    for (found, expected) in refused {
        assert_eq!(found, expected);
    }
    assert_eq!(graph.gradient(), &before);
    assert!(graph.cancellations().is_empty());
}
