//! The Morse complex: its homology is that of the domain, and its separatrices are V-paths.

use std::collections::BTreeSet;

use morsmooth::field::VertexOrder;
use morsmooth::mesh::SimplicialComplex;
use morsmooth::morse::{Cell, DiscreteGradient, MorseComplex, Pairing, discrete_gradient};
use proptest::prelude::*;

use super::gradient::vertices;
use super::{brute, meshes};

/// Betti numbers of the chain complex that critical cells and separatrices form.
fn morse_betti(complex: &MorseComplex) -> [usize; 4] {
    let cells: Vec<Cell> = complex.critical_cells().collect();
    let mut ranks = [0; 5];
    let mut counts = [0; 4];
    for dimension in 0..4u8 {
        let of_dimension: Vec<Cell> = cells.iter().copied().filter(|cell| cell.dimension == dimension).collect();
        counts[dimension as usize] = of_dimension.len();
        let columns = of_dimension
            .iter()
            .map(|&cell| {
                let mut column = BTreeSet::new();
                for (end, separatrix) in complex.below(cell) {
                    let row = cells.binary_search(&end).unwrap();
                    if separatrix.multiplicity % 2 == 1 && !column.remove(&row) {
                        column.insert(row);
                    }
                }
                column
            })
            .collect();
        ranks[dimension as usize] = brute::rank_modulo_2(columns);
    }
    [0, 1, 2, 3].map(|dimension| counts[dimension] - ranks[dimension] - ranks[dimension + 1])
}

fn check(complex: &SimplicialComplex, gradient: &DiscreteGradient) -> MorseComplex {
    let morse = MorseComplex::new(complex, gradient);
    assert_eq!(morse.boundary_defect(), None);
    for (top, bottom, separatrix) in morse.separatrices() {
        let cells = &separatrix.cells;
        assert_eq!((cells[0], cells[cells.len() - 1]), (top, bottom));
        if separatrix.multiplicity > 1 {
            assert_eq!(cells.iter().collect::<BTreeSet<_>>().len(), cells.len(), "a cell is listed twice");
            continue;
        }
        for (place, step) in cells.windows(2).enumerate() {
            let (large, small) = if place % 2 == 0 { (step[0], step[1]) } else { (step[1], step[0]) };
            assert_eq!(large.dimension, small.dimension + 1);
            let (outer, inner) = (vertices(complex, large), vertices(complex, small));
            assert!(inner.iter().all(|vertex| outer.contains(vertex)), "steps lead through facets");
            assert_eq!(place % 2 == 1, gradient.pairing(small) == Pairing::Up(large), "every other step is an arrow");
        }
    }
    morse
}

#[test]
fn homology_of_the_morse_complex_is_that_of_the_domain() {
    let expected = [
        [1, 0, 0, 0],
        [1, 0, 0, 0],
        [1, 1, 0, 0],
        [2, 0, 0, 0],
        [1, 2, 1, 0],
        [1, 0, 1, 0],
        [1, 0, 0, 0],
        [1, 3, 3, 1],
    ];
    for ((name, complex, _), betti) in meshes::all().into_iter().zip(expected) {
        for levels in [6, 1 << 40] {
            let values = meshes::noise(complex.vertex_count(), 11, levels);
            let order = VertexOrder::of_values(&values).unwrap();
            let morse = check(&complex, &discrete_gradient(&complex, &order).unwrap());
            assert_eq!(morse_betti(&morse), betti, "{name}, {levels} levels");
        }
    }
}

proptest! {
    #[test]
    fn homology_is_that_of_any_random_complex((complex, values) in meshes::random_field()) {
        let order = VertexOrder::of_values(&values).unwrap();
        let morse = check(&complex, &discrete_gradient(&complex, &order).unwrap());
        prop_assert_eq!(morse_betti(&morse), brute::betti_numbers(&complex));
    }
}

#[test]
fn a_saddle_joined_twice_to_one_minimum_has_two_arcs() {
    let circle = SimplicialComplex::new(1, vec![[0.0; 3]; 4], vec![0, 1, 1, 2, 2, 3, 3, 0]).unwrap();
    let order = VertexOrder::of_values(&[0.0, 1.0, 2.0, 1.0]).unwrap();
    let morse = MorseComplex::new(&circle, &discrete_gradient(&circle, &order).unwrap());
    assert_eq!(morse.critical_cells().count(), 2);
    let minimum = Cell { dimension: 0, index: 0 };
    let above: Vec<_> = morse.above(minimum).collect();
    assert_eq!(above.len(), 2);
    assert!(above.iter().all(|(_, separatrix)| separatrix.multiplicity == 1));
    assert_ne!(above[0].1.cells, above[1].1.cells);
}

#[test]
fn threads_change_no_separatrix() {
    let ball = meshes::cubes([9, 9, 9]);
    let order = VertexOrder::of_values(&meshes::noise(729, 2, 90)).unwrap();
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let morse = pool.install(|| MorseComplex::new(&ball, &discrete_gradient(&ball, &order).unwrap()));
        let arcs: Vec<_> = morse.separatrices().map(|(top, bottom, arc)| (top, bottom, arc.clone())).collect();
        arcs
    };
    assert_eq!(with_threads(1), with_threads(2));
}
