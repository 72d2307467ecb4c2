//! Implicit grids: the same gradient and the same pairs as on the explicit complex, at any number of threads.

use std::collections::HashMap;

use morsmooth::field::{VertexId, VertexOrder};
use morsmooth::mesh::{Cell, Domain, Grid, ImplicitGrid, Mask, SimplicialComplex, Triangulation};
use morsmooth::morse::{DiscreteGradient, ExtremumKind, Pairing, discrete_gradient, extremum_pairs};
use proptest::prelude::*;

use super::{brute, meshes};

fn pair(dims: [usize; 3]) -> (ImplicitGrid, SimplicialComplex) {
    let grid = Grid::image(dims, [0.0; 3], [1.0; 3]);
    let explicit = Domain::from_grid(&grid, &Mask::none()).unwrap().complex;
    (ImplicitGrid::new(grid).unwrap(), explicit)
}

/// The cells of the explicit complex by those of the implicit one, through their vertices.
fn explicit_cells(implicit: &ImplicitGrid, explicit: &SimplicialComplex) -> HashMap<Cell, Cell> {
    let cells = (0..4).flat_map(|dimension| implicit.cells(dimension));
    cells.map(|cell| (cell, explicit.cell_of(&implicit.cell_vertices(cell)).unwrap())).collect()
}

fn assert_same_gradient(implicit: &ImplicitGrid, explicit: &SimplicialComplex, order: &VertexOrder) {
    let ours = discrete_gradient(implicit, order).unwrap();
    let theirs = discrete_gradient(explicit, order).unwrap();
    let explicit_of = explicit_cells(implicit, explicit);
    for (&cell, &other) in &explicit_of {
        let translated = match ours.pairing(cell) {
            Pairing::Up(partner) => Pairing::Up(explicit_of[&partner]),
            Pairing::Down(partner) => Pairing::Down(explicit_of[&partner]),
            other => other,
        };
        assert_eq!(translated, theirs.pairing(other), "{cell:?} on {:?}", implicit.cell_vertices(cell));
        assert_eq!(ours.is_critical(cell), theirs.is_critical(other));
    }
    assert_eq!(ours.critical_counts(), theirs.critical_counts());
    assert_eq!(ours.cell_counts(), theirs.cell_counts());
    ours.check_euler().unwrap();
    for dimension in 0..4 {
        let critical: Vec<Cell> = ours.critical_cells(dimension).map(|cell| explicit_of[&cell]).collect();
        assert_eq!(critical, theirs.critical_cells(dimension).collect::<Vec<_>>());
        let gaps = (0..implicit.cell_bound(dimension) as u32).map(|index| Cell { dimension: dimension as u8, index });
        for gap in gaps.filter(|&cell| !implicit.is_cell(cell)) {
            assert_eq!(ours.pairing(gap), Pairing::Outside);
        }
    }
    for vertex in (0..order.len()).map(VertexId::from) {
        assert_eq!(ours.descent(implicit, vertex), theirs.descent(explicit, vertex));
    }
}

fn assert_same_pairs(implicit: &ImplicitGrid, explicit: &SimplicialComplex, order: &VertexOrder) {
    for kind in [ExtremumKind::Minimum, ExtremumKind::Maximum] {
        assert_eq!(extremum_pairs(implicit, order, kind), extremum_pairs(explicit, order, kind));
    }
}

#[test]
fn gradients_and_pairs_are_those_of_the_explicit_grid() {
    let dims = [
        [2, 1, 1], [1, 40, 1], [1, 1, 9], [2, 2, 1], [9, 1, 7], [1, 8, 5], [31, 17, 1], [2, 2, 2], [2, 3, 9], [9, 2, 3],
        [7, 8, 9], [2, 60, 60],
    ];
    for dims in dims {
        let (implicit, explicit) = pair(dims);
        for levels in [1, 2, 5, 1 << 40] {
            for seed in 0..3 {
                let values = meshes::noise(implicit.vertex_count(), seed, levels);
                let order = VertexOrder::of_values(&values).unwrap();
                assert_same_gradient(&implicit, &explicit, &order);
                assert_same_gradient(&implicit, &explicit, &order.reversed());
                assert_same_pairs(&implicit, &explicit, &order);
            }
        }
    }
}

#[test]
fn smooth_fields_and_ramps_are_those_of_the_explicit_grid() {
    let (implicit, explicit) = pair([12, 11, 10]);
    let fields: [fn([f64; 3]) -> f64; 3] = [
        |[x, y, z]| (x * 0.9).sin() + (y * 0.8).cos() + (z * 0.7).sin(),
        |[x, y, z]| x - y + z,
        |[x, y, z]| (x - 5.5).abs().max((y - 5.0).abs()).max((z - 4.5).abs()),
    ];
    for field in fields {
        let values: Vec<f64> = (0..1320).map(|vertex| field(implicit.point(VertexId(vertex)))).collect();
        let order = VertexOrder::of_values(&values).unwrap();
        assert_same_gradient(&implicit, &explicit, &order);
        assert_same_pairs(&implicit, &explicit, &order);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn random_grids_agree_with_the_explicit_grid_and_with_matrix_reduction(
        dims in [1usize..6, 1usize..6, 2usize..6],
        seed in any::<u64>(),
        levels in prop::sample::select(vec![2u64, 4, 9, 1 << 40]),
    ) {
        let (implicit, explicit) = pair(dims);
        let order = VertexOrder::of_values(&meshes::noise(implicit.vertex_count(), seed, levels)).unwrap();
        assert_same_gradient(&implicit, &explicit, &order);
        for (kind, order_of_kind) in [(ExtremumKind::Minimum, order.clone()), (ExtremumKind::Maximum, order.reversed())] {
            let found = extremum_pairs(&implicit, &order, kind);
            let bare: Vec<_> = found.iter().map(|pair| (pair.extremum, pair.saddle)).collect();
            prop_assert_eq!(bare, brute::minimum_pairs(&explicit, &order_of_kind));
            prop_assert_eq!(found, extremum_pairs(&explicit, &order, kind));
        }
    }
}

#[test]
fn threads_change_no_bit() {
    let (implicit, _) = pair([33, 31, 29]);
    let values = meshes::noise(implicit.vertex_count(), 5, 500);
    let with_threads = |threads: usize| -> (DiscreteGradient, Vec<_>, Vec<_>) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let order = VertexOrder::of_values(&values).unwrap();
            let pairs = |kind| extremum_pairs(&implicit, &order, kind);
            let gradient = discrete_gradient(&implicit, &order).unwrap();
            (gradient, pairs(ExtremumKind::Minimum), pairs(ExtremumKind::Maximum))
        })
    };
    let one = with_threads(1);
    assert_eq!(one, with_threads(2));
    assert_eq!(one, with_threads(3));
}

#[test]
fn cancelling_on_a_grid_reverses_the_same_paths() {
    let (implicit, explicit) = pair([9, 8, 1]);
    let order = VertexOrder::of_values(&meshes::noise(72, 4, 1 << 40)).unwrap();
    let explicit_of = explicit_cells(&implicit, &explicit);
    let mut ours = discrete_gradient(&implicit, &order).unwrap();
    let mut theirs = discrete_gradient(&explicit, &order).unwrap();
    let saddles: Vec<Cell> = ours.critical_cells(1).collect();
    for saddle in saddles {
        let ends = implicit.cell_vertices(saddle);
        let minimum = ours.descent_end(&implicit, ends[0]);
        let edge = |cell: Cell| morsmooth::mesh::EdgeId(cell.index);
        let found = ours.cancel(&implicit, edge(saddle), minimum);
        let expected = theirs.cancel(&explicit, edge(explicit_of[&saddle]), minimum);
        assert_eq!(found.is_ok(), expected.is_ok());
    }
    assert_eq!(ours.critical_counts(), theirs.critical_counts());
    ours.check_euler().unwrap();
    for vertex in (0..72).map(VertexId) {
        assert_eq!(ours.descent(&implicit, vertex), theirs.descent(&explicit, vertex));
    }
}
