//! Union–find against matrix reduction; symmetry, renumbering, ties and the smallest inputs.

use morsmooth::field::{VertexId, VertexOrder};
use morsmooth::mesh::SimplicialComplex;
use morsmooth::morse::{ExtremumKind, ExtremumPair, extremum_pairs};
use proptest::prelude::*;

use super::{brute, meshes};

fn order_of(values: &[f64]) -> VertexOrder {
    VertexOrder::of_values(values).unwrap()
}

fn bare(pairs: &[ExtremumPair]) -> Vec<(VertexId, Option<VertexId>)> {
    pairs.iter().map(|pair| (pair.extremum, pair.saddle)).collect()
}

/// Multiset of births and deaths of positive persistence.
fn diagram(complex: &SimplicialComplex, values: &[f64], kind: ExtremumKind) -> Vec<(f64, f64)> {
    let mut diagram: Vec<(f64, f64)> = extremum_pairs(complex, &order_of(values), kind)
        .iter()
        .map(|pair| {
            let death = pair.saddle.map_or(f64::INFINITY, |saddle| values[saddle.index()]);
            (values[pair.extremum.index()], death)
        })
        .filter(|(birth, death)| birth != death)
        .collect();
    diagram.sort_by(|a, b| a.partial_cmp(b).unwrap());
    diagram
}

proptest! {
    #[test]
    fn union_find_agrees_with_matrix_reduction((complex, values) in meshes::random_field()) {
        let order = order_of(&values);
        let minima = extremum_pairs(&complex, &order, ExtremumKind::Minimum);
        prop_assert_eq!(bare(&minima), brute::minimum_pairs(&complex, &order));
        let maxima = extremum_pairs(&complex, &order, ExtremumKind::Maximum);
        prop_assert_eq!(bare(&maxima), brute::minimum_pairs(&complex, &order.reversed()));
    }

    #[test]
    fn turning_the_order_upside_down_swaps_minima_and_maxima((complex, values) in meshes::random_field()) {
        let order = order_of(&values);
        let maxima = extremum_pairs(&complex, &order, ExtremumKind::Maximum);
        let mut minima = extremum_pairs(&complex, &order.reversed(), ExtremumKind::Minimum);
        minima.iter_mut().for_each(|pair| pair.kind = ExtremumKind::Maximum);
        prop_assert_eq!(maxima, minima);
    }

    #[test]
    fn renumbering_changes_no_pair_of_positive_persistence(
        (complex, values) in meshes::random_field(),
        seed in any::<u64>(),
    ) {
        let n = values.len();
        let keys = meshes::noise(n, seed, 1 << 40);
        let mut new_number: Vec<usize> = (0..n).collect();
        new_number.sort_by(|&a, &b| keys[a].total_cmp(&keys[b]));
        let simplices = complex.simplices().iter().map(|&vertex| new_number[vertex as usize] as u32).collect();
        let renumbered = SimplicialComplex::new(complex.dimension(), vec![[0.0; 3]; n], simplices).unwrap();
        let mut moved = vec![0.0; n];
        for (vertex, &value) in values.iter().enumerate() {
            moved[new_number[vertex]] = value;
        }
        for kind in [ExtremumKind::Minimum, ExtremumKind::Maximum] {
            prop_assert_eq!(diagram(&complex, &values, kind), diagram(&renumbered, &moved, kind));
        }
    }

    #[test]
    fn every_component_has_one_essential_pair_of_each_kind((complex, values) in meshes::random_field()) {
        let order = order_of(&values);
        let (component, count) = complex.components();
        let names = |kind| {
            let pairs = extremum_pairs(&complex, &order, kind);
            let mut names: Vec<VertexId> =
                pairs.iter().filter(|pair| pair.is_essential()).map(|pair| pair.component).collect();
            names.sort_unstable();
            for pair in &pairs {
                assert_eq!(component[pair.extremum.index()], component[pair.component.index()]);
            }
            names
        };
        let expected: Vec<VertexId> = (0..count as u32)
            .map(|number| VertexId::from(component.iter().position(|&c| c == number).unwrap()))
            .filter(|&vertex| !complex.neighbours(vertex).is_empty())
            .collect();
        prop_assert_eq!(names(ExtremumKind::Minimum), expected.clone());
        prop_assert_eq!(names(ExtremumKind::Maximum), expected);
    }
}

#[test]
fn larger_meshes_agree_with_matrix_reduction() {
    for (name, complex, _) in meshes::all() {
        for levels in [4, 1 << 40] {
            let values = meshes::noise(complex.vertex_count(), 7, levels);
            let order = order_of(&values);
            let found = bare(&extremum_pairs(&complex, &order, ExtremumKind::Minimum));
            assert_eq!(found, brute::minimum_pairs(&complex, &order), "{name}, {levels} levels");
        }
    }
}

#[test]
fn a_single_edge_has_one_minimum_and_one_maximum() {
    let edge = meshes::line(2);
    let order = order_of(&[1.0, 1.0]);
    assert_eq!(bare(&extremum_pairs(&edge, &order, ExtremumKind::Minimum)), [(VertexId(0), None)]);
    assert_eq!(bare(&extremum_pairs(&edge, &order, ExtremumKind::Maximum)), [(VertexId(1), None)]);
}

#[test]
fn a_constant_field_has_one_minimum_and_the_zero_pairs_of_its_order() {
    let grid = meshes::grid(20, 20);
    let values = vec![3.5; 400];
    let order = order_of(&values);
    let minima = extremum_pairs(&grid, &order, ExtremumKind::Minimum);
    let maxima = extremum_pairs(&grid, &order, ExtremumKind::Maximum);
    assert_eq!(bare(&minima), [(VertexId(0), None)]);
    assert_eq!(bare(&maxima), [(VertexId(399), None)]);
}

#[test]
fn isolated_vertices_are_no_extrema() {
    let complex = SimplicialComplex::new(1, vec![[0.0; 3]; 4], vec![1, 3]).unwrap();
    let order = order_of(&[-9.0, 1.0, 9.0, 2.0]);
    let minima = extremum_pairs(&complex, &order, ExtremumKind::Minimum);
    assert_eq!(bare(&minima), [(VertexId(1), None)]);
    assert_eq!(minima[0].component, VertexId(1));
    assert_eq!(bare(&extremum_pairs(&complex, &order, ExtremumKind::Maximum)), [(VertexId(3), None)]);
}

#[test]
fn pairs_of_a_series_are_as_drawn() {
    //          5
    //      4   |   3
    //    2 |   |   |
    //      0   1   2   (minima) -> values along the line
    let values = [2.0, 0.0, 4.0, 1.0, 5.0, 2.0, 3.0];
    let order = order_of(&values);
    let line = meshes::line(7);
    let v = VertexId;
    assert_eq!(
        bare(&extremum_pairs(&line, &order, ExtremumKind::Minimum)),
        [(v(1), None), (v(3), Some(v(2))), (v(5), Some(v(4)))]
    );
    assert_eq!(
        bare(&extremum_pairs(&line, &order, ExtremumKind::Maximum)),
        [(v(4), None), (v(2), Some(v(3))), (v(6), Some(v(5))), (v(0), Some(v(1)))]
    );
}

#[test]
#[should_panic(expected = "same number of vertices")]
fn an_order_of_another_mesh_is_refused() {
    extremum_pairs(&meshes::line(3), &order_of(&[0.0; 4]), ExtremumKind::Minimum);
}
