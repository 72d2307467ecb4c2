//! The discrete gradient: Euler characteristic, lower links, no closed V-path, the same bits for any thread count.

use std::collections::BTreeMap;

use morsmooth::audit::extrema;
use morsmooth::field::{VertexId, VertexOrder};
use morsmooth::mesh::{EdgeId, SimplicialComplex};
use morsmooth::morse::{Cell, DiscreteGradient, MorseError, Pairing, discrete_gradient};
use proptest::prelude::*;

use super::{brute, meshes};

/// Vertices of a cell by rising number.
pub fn vertices(complex: &SimplicialComplex, cell: Cell) -> Vec<u32> {
    let index = cell.index as usize;
    let mut vertices: Vec<u32> = match cell.dimension {
        0 => vec![cell.index],
        1 => complex.edges()[index].map(|vertex| vertex.0).to_vec(),
        2 => complex.triangles()[index].map(|vertex| vertex.0).to_vec(),
        _ => complex.simplex(index).to_vec(),
    };
    vertices.sort_unstable();
    vertices
}

fn cells(complex: &SimplicialComplex) -> Vec<Cell> {
    let tetrahedra = if complex.dimension() == 3 { complex.simplex_count() } else { 0 };
    let counts = [complex.vertex_count(), complex.edges().len(), complex.triangles().len(), tetrahedra];
    (0u8..4)
        .flat_map(|dimension| (0..counts[dimension as usize] as u32).map(move |index| Cell { dimension, index }))
        .filter(|cell| cell.dimension > 0 || !complex.neighbours(VertexId(cell.index)).is_empty())
        .collect()
}

/// Asserts that pairs are facet and cofacet and point at each other, and that no V-path is closed.
pub fn assert_is_gradient(complex: &SimplicialComplex, gradient: &DiscreteGradient) {
    let cells = cells(complex);
    let by_vertices: BTreeMap<Vec<u32>, Cell> = cells.iter().map(|&cell| (vertices(complex, cell), cell)).collect();
    // In the Hasse diagram with the arrows of the pairs turned upwards, V-paths are walks: it must have no cycle.
    let mut outgoing: BTreeMap<Cell, Vec<Cell>> = BTreeMap::new();
    let mut incoming: BTreeMap<Cell, usize> = cells.iter().map(|&cell| (cell, 0)).collect();
    for &cell in &cells {
        match gradient.pairing(cell) {
            Pairing::Up(upper) => assert_eq!(gradient.pairing(upper), Pairing::Down(cell)),
            Pairing::Down(lower) => {
                assert_eq!(gradient.pairing(lower), Pairing::Up(cell));
                let (small, large) = (vertices(complex, lower), vertices(complex, cell));
                assert!(small.len() + 1 == large.len() && small.iter().all(|vertex| large.contains(vertex)));
            }
            Pairing::Critical => assert!(gradient.is_critical(cell)),
            Pairing::Outside => panic!("{cell:?} is a cell of a simplex"),
        }
        let corners = vertices(complex, cell);
        for omitted in 0..if corners.len() > 1 { corners.len() } else { 0 } {
            let mut facet = corners.clone();
            facet.remove(omitted);
            let facet = by_vertices[&facet];
            let (from, to) = if gradient.pairing(facet) == Pairing::Up(cell) { (facet, cell) } else { (cell, facet) };
            outgoing.entry(from).or_default().push(to);
            *incoming.get_mut(&to).unwrap() += 1;
        }
    }
    let mut ready: Vec<Cell> = incoming.iter().filter(|&(_, &count)| count == 0).map(|(&cell, _)| cell).collect();
    let mut sorted = 0;
    while let Some(cell) = ready.pop() {
        sorted += 1;
        for next in outgoing.get(&cell).into_iter().flatten() {
            let count = incoming.get_mut(next).unwrap();
            *count -= 1;
            if *count == 0 {
                ready.push(*next);
            }
        }
    }
    assert_eq!(sorted, cells.len(), "a V-path is closed");
}

/// Number of components of the lower link of every vertex.
fn lower_link_components(complex: &SimplicialComplex, order: &VertexOrder) -> Vec<usize> {
    (0..complex.vertex_count())
        .map(|vertex| {
            let vertex = VertexId::from(vertex);
            let mut left: Vec<VertexId> =
                complex.neighbours(vertex).iter().copied().filter(|&w| order.is_below(w, vertex)).collect();
            let joined = |a: VertexId, b: VertexId| {
                complex.star(vertex).iter().any(|&simplex| {
                    let corners = complex.simplex(simplex as usize);
                    corners.contains(&a.0) && corners.contains(&b.0)
                })
            };
            let mut components = 0;
            while let Some(seed) = left.pop() {
                components += 1;
                let mut stack = vec![seed];
                while let Some(member) = stack.pop() {
                    let (near, far) = left.iter().partition(|&&other| joined(member, other));
                    left = far;
                    stack.extend::<Vec<VertexId>>(near);
                }
            }
            components
        })
        .collect()
}

fn check(complex: &SimplicialComplex, values: &[f64]) -> DiscreteGradient {
    let order = VertexOrder::of_values(values).unwrap();
    let gradient = discrete_gradient(complex, &order).unwrap();
    assert_is_gradient(complex, &gradient);
    gradient.check_euler().unwrap();
    let found = extrema(complex, values).unwrap();
    let critical = |gradient: &DiscreteGradient| -> Vec<VertexId> {
        gradient.critical_cells(0).map(|cell| VertexId(cell.index)).collect()
    };
    assert_eq!(critical(&gradient), found.minima);
    let reversed = discrete_gradient(complex, &order.reversed()).unwrap();
    assert_eq!(critical(&reversed), found.maxima);
    // One critical edge for every component of the lower link but the first.
    let mut critical_edges = vec![0; complex.vertex_count()];
    for edge in gradient.critical_cells(1) {
        critical_edges[edge.highest_vertex(complex, &order).index()] += 1;
    }
    let expected: Vec<usize> =
        lower_link_components(complex, &order).into_iter().map(|components| components.saturating_sub(1)).collect();
    assert_eq!(critical_edges, expected);
    gradient
}

#[test]
fn critical_cells_alternate_to_the_euler_characteristic() {
    for (name, complex, characteristic) in meshes::all() {
        for levels in [1, 5, 1 << 40] {
            let gradient = check(&complex, &meshes::noise(complex.vertex_count(), 3, levels));
            let [c0, c1, c2, c3] = gradient.critical_counts().map(|count| count as i64);
            assert_eq!(c0 - c1 + c2 - c3, characteristic, "{name}, {levels} levels");
        }
    }
}

proptest! {
    #[test]
    fn every_random_complex_obeys_the_morse_inequalities((complex, values) in meshes::random_field()) {
        let counts = check(&complex, &values).critical_counts();
        let betti = brute::betti_numbers(&complex);
        let (mut of_cells, mut of_betti) = (0i64, 0i64);
        for dimension in 0..4 {
            prop_assert!(counts[dimension] >= betti[dimension]);
            of_cells = counts[dimension] as i64 - of_cells;
            of_betti = betti[dimension] as i64 - of_betti;
            prop_assert!(of_cells >= of_betti, "strong inequality in dimension {}", dimension);
        }
        prop_assert_eq!(of_cells, of_betti);
    }
}

#[test]
fn a_monotone_field_has_no_critical_cell_but_its_minimum() {
    let ball = meshes::cubes([5, 5, 5]);
    let values: Vec<f64> = (0..125).map(f64::from).collect();
    assert_eq!(check(&ball, &values).critical_counts(), [1, 0, 0, 0]);
}

#[test]
fn a_vertex_with_thousands_of_neighbours_is_no_trouble() {
    let n = 5000u32;
    let triangles = (1..n).flat_map(|rim| [0, rim, rim % (n - 1) + 1]).collect();
    let fan = SimplicialComplex::new(2, vec![[0.0; 3]; n as usize], triangles).unwrap();
    let mut values = meshes::noise(n as usize, 1, 1 << 40);
    values[0] = 2.0;
    let order = VertexOrder::of_values(&values).unwrap();
    let gradient = discrete_gradient(&fan, &order).unwrap();
    gradient.check_euler().unwrap();
    assert_eq!(gradient.critical_cells(2).count(), 1);
}

#[test]
fn threads_change_no_bit() {
    let ball = meshes::cubes([17, 16, 15]);
    let values = meshes::noise(ball.vertex_count(), 5, 50);
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| discrete_gradient(&ball, &VertexOrder::of_values(&values).unwrap()).unwrap())
    };
    assert_eq!(with_threads(1), with_threads(2));
}

#[test]
fn refusals_name_what_was_found() {
    let line = meshes::line(3);
    let order = VertexOrder::of_values(&[0.0; 4]).unwrap();
    let error = discrete_gradient(&line, &order).unwrap_err();
    assert_eq!(error, MorseError::OrderLength { expected: 3, found: 4 });
    assert_eq!(error.to_string(), "vertex order of 4 vertices; expected 3, as in the complex");

    let order = VertexOrder::of_values(&[0.0, 5.0, 1.0]).unwrap();
    let mut gradient = discrete_gradient(&line, &order).unwrap();
    let untouched = gradient.clone();
    assert_eq!(gradient.cancel(&line, EdgeId(0), VertexId(2)), Err(MorseError::NotCritical { edge: EdgeId(0) }));
    let missed = MorseError::PathCount { saddle: EdgeId(1), extremum: VertexId(1), found: 0 };
    assert_eq!(gradient.cancel(&line, EdgeId(1), VertexId(1)), Err(missed));
    assert_eq!(gradient, untouched);

    // On a circle the saddle is joined to the minimum twice: cancelling it would close a V-path.
    let circle = SimplicialComplex::new(1, vec![[0.0; 3]; 4], vec![0, 1, 1, 2, 2, 3, 3, 0]).unwrap();
    let order = VertexOrder::of_values(&[0.0, 1.0, 2.0, 1.0]).unwrap();
    let mut gradient = discrete_gradient(&circle, &order).unwrap();
    let saddle = EdgeId(gradient.critical_cells(1).next().unwrap().index);
    let twice = MorseError::PathCount { saddle, extremum: VertexId(0), found: 2 };
    assert_eq!(gradient.cancel(&circle, saddle, VertexId(0)), Err(twice));
}
