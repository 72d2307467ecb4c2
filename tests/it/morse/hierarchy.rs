//! The hierarchy of cancellations: every threshold from one computation, up and down.

use morsmooth::field::{VertexId, VertexOrder};
use morsmooth::mesh::SimplicialComplex;
use morsmooth::morse::{
    BasinHierarchy, Cell, CellCancellation, DiscreteGradient, ExtremumGraph, ExtremumKind, MorseComplex, MorseHierarchy, SaddlePairs,
    Selection, Threshold,
    discrete_gradient, extremum_pairs, select,
};
use proptest::prelude::*;

use super::gradient::assert_is_gradient;
use super::meshes;

const KINDS: [ExtremumKind; 2] = [ExtremumKind::Minimum, ExtremumKind::Maximum];

fn highest(complex: &SimplicialComplex, order: &VertexOrder, gradient: &DiscreteGradient) -> Vec<VertexId> {
    let tops = gradient.critical_cells(complex.dimension());
    let mut vertices: Vec<VertexId> = tops.map(|cell| cell.highest_vertex(complex, order)).collect();
    vertices.sort_unstable();
    vertices
}

/// Everything that is promised of one threshold.
fn check_state(complex: &SimplicialComplex, values: &[f64], hierarchy: &MorseHierarchy<'_, SimplicialComplex>, threshold: f64, is_manifold: bool) {
    let (gradient, order) = (hierarchy.gradient(), hierarchy.order());
    gradient.check_euler().unwrap();
    assert_is_gradient(complex, gradient);
    assert_eq!(MorseComplex::new(complex, gradient).boundary_defect(), None);
    let [minima, maxima] = KINDS.map(|kind| extremum_pairs(complex, order, kind));
    let selection = Selection::Threshold(Threshold::Absolute(threshold));
    let wanted = select(&minima, &maxima, values, &selection).unwrap();
    let left: Vec<VertexId> = gradient.critical_cells(0).map(|cell| VertexId(cell.index)).collect();
    assert_eq!(left, wanted.minima, "minima above {threshold}");
    assert_eq!(hierarchy.minimum_segmentation().extrema(), wanted.minima);
    assert_eq!(hierarchy.maximum_segmentation().extrema(), wanted.maxima);
    if is_manifold && complex.dimension() > 1 {
        let tops = highest(complex, order, gradient);
        let interior: Vec<VertexId> = {
            let all = highest(complex, order, &discrete_gradient(complex, order).unwrap());
            wanted.maxima.iter().copied().filter(|vertex| all.binary_search(vertex).is_ok()).collect()
        };
        assert_eq!(tops, interior, "maxima of the interior above {threshold}");
    }
}

/// Moves through thresholds up and down; the state depends on the last one only.
fn check(complex: &SimplicialComplex, values: &[f64], thresholds: &[f64], is_manifold: bool) {
    let order = VertexOrder::of_values(values).unwrap();
    for saddles in [SaddlePairs::Keep, SaddlePairs::Cancel] {
        check_hierarchy(&MorseHierarchy::new(complex, values, &order, saddles).unwrap(), values, thresholds, is_manifold);
    }
}

fn check_hierarchy(fresh: &MorseHierarchy<'_, SimplicialComplex>, values: &[f64], thresholds: &[f64], is_manifold: bool) {
    let (complex, order) = (fresh.complex(), fresh.order());
    assert!(fresh.cancellations().windows(2).all(|pair| pair[0].level <= pair[1].level));
    assert!(fresh.cancellations().iter().all(|pair| pair.level >= pair.persistence));
    assert_eq!(fresh.gradient(), &discrete_gradient(complex, order).unwrap());
    let mut wandering = fresh.clone();
    for &threshold in thresholds {
        let mut direct = fresh.clone();
        assert!(wandering.at(threshold) == direct.at(threshold), "wandering and direct differ at {threshold}");
        if threshold < 0.0 {
            assert!(wandering.gradient() == fresh.gradient(), "restored");
            continue;
        }
        check_state(complex, values, &wandering, threshold, is_manifold);
        if is_manifold {
            let of_extrema = |pairs: &mut dyn Iterator<Item = &CellCancellation>| pairs.filter(|pair| pair.extremum.is_some()).count();
            let due = of_extrema(&mut fresh.cancellations().iter().filter(|pair| pair.level <= threshold));
            assert_eq!(of_extrema(&mut wandering.cancelled()), due, "every cancellation of an extremum is possible");
        }
    }
}

/// The segmentation by merging equals following the V-paths of the simplified extremum graph.
fn check_segmentation(complex: &SimplicialComplex, values: &[f64], threshold: f64) {
    let order = VertexOrder::of_values(values).unwrap();
    let pairs = KINDS.map(|kind| extremum_pairs(complex, &order, kind));
    let selection = Selection::Threshold(Threshold::Absolute(threshold));
    let wanted = select(&pairs[0], &pairs[1], values, &selection).unwrap();
    for ((kind, pairs), wanted) in KINDS.into_iter().zip(&pairs).zip([wanted.minima, wanted.maxima]) {
        let basins = BasinHierarchy::new(complex, values, &order, kind).unwrap();
        assert_eq!(basins.extrema().len(), pairs.len());
        let segmentation = basins.at(threshold);
        assert_eq!(segmentation.extrema(), wanted);
        let mut graph = ExtremumGraph::new(complex, &order, kind).unwrap();
        graph.simplify(values, &wanted).unwrap();
        let inside = |vertex: VertexId| !complex.neighbours(vertex).is_empty();
        for vertex in (0..values.len()).map(VertexId::from) {
            let label = segmentation.label(vertex).map(|label| segmentation.extrema()[label as usize]);
            let expected = inside(vertex).then(|| *graph.path(vertex).last().unwrap());
            assert_eq!(label, expected, "{kind:?} of vertex {vertex} above {threshold}");
        }
        let covered: usize = segmentation.sizes().iter().sum();
        assert_eq!(covered, (0..values.len()).filter(|&vertex| inside(vertex.into())).count());
        assert!(segmentation.sizes().iter().all(|&size| size > 0));
    }
}

proptest! {
    #[test]
    fn any_random_complex_simplifies_up_and_down(
        (complex, values) in meshes::random_field(),
        thresholds in prop::collection::vec((-1..8i32).prop_map(f64::from), 1..5),
    ) {
        check(&complex, &values, &thresholds, false);
    }

    #[test]
    fn segments_are_the_ends_of_v_paths(
        (complex, values) in meshes::random_field(),
        threshold in (0..8i32).prop_map(f64::from),
    ) {
        check_segmentation(&complex, &values, threshold);
    }

    #[test]
    fn manifolds_with_ties_and_boundary_simplify_up_and_down(
        mesh in 0..8usize,
        seed in any::<u64>(),
        levels in prop::sample::select(vec![2u64, 3, 7, 1 << 40]),
        thresholds in prop::collection::vec(prop::sample::select(vec![-1.0, 0.0, 0.1, 0.35, 0.5, 0.8, 2.0]), 1..5),
    ) {
        let (_, complex, _) = meshes::all().swap_remove(mesh);
        let values = meshes::noise(complex.vertex_count(), seed, levels);
        check(&complex, &values, &thresholds, true);
    }
}

#[test]
fn noise_on_every_mesh_simplifies_up_and_down() {
    for (_, complex, _) in meshes::all() {
        for levels in [1, 5, 1 << 40] {
            let values = meshes::noise(complex.vertex_count(), 23, levels);
            check(&complex, &values, &[0.0, 0.5, 2.0, 0.2, -1.0, 0.8], true);
            for threshold in [0.0, 0.3, 0.7, 2.0] {
                check_segmentation(&complex, &values, threshold);
            }
        }
    }
}

#[test]
fn a_number_of_extrema_is_met_exactly() {
    // With ties the threshold alone would keep too many or too few.
    for (_, complex, _) in meshes::all() {
        let values = meshes::noise(complex.vertex_count(), 5, 4);
        let order = VertexOrder::of_values(&values).unwrap();
        let [minima, maxima] = KINDS.map(|kind| extremum_pairs(&complex, &order, kind));
        let mut hierarchy = MorseHierarchy::new(&complex, &values, &order, SaddlePairs::Cancel).unwrap();
        let essential = minima.iter().chain(&maxima).filter(|pair| pair.is_essential()).count();
        let all = minima.len() + maxima.len();
        for count in [essential, essential + 1, (essential + all) / 2, all] {
            let wanted = select(&minima, &maxima, &values, &Selection::Count(count)).unwrap();
            hierarchy.keeping(&wanted);
            let kept: Vec<VertexId> = hierarchy.gradient().critical_cells(0).map(|cell| VertexId(cell.index)).collect();
            assert_eq!(kept, wanted.minima);
            assert_eq!(hierarchy.maximum_segmentation().extrema(), wanted.maxima);
            hierarchy.gradient().check_euler().unwrap();
            assert_is_gradient(&complex, hierarchy.gradient());
        }
    }
}

#[test]
fn a_hill_at_the_boundary_lives_as_long_as_an_extremum_pair() {
    // A ridge of height 9 that falls to 8 on the boundary beside it, and a hill of height 10 far off across a valley of 1:
    // in the sublevel filtration the ridge dies at 8, as an extremum it dies at 1.
    let grid = meshes::grid(9, 5);
    let height = |x: usize, y: usize| match (x, y) {
        (1, 2) => 9.0,
        (0, 2) => 8.0,
        (7, 2) => 10.0,
        (2..=6, 2) => 1.0,
        _ => 0.01 * (x + 9 * y) as f64,
    };
    let values: Vec<f64> = (0..45).map(|k| height(k % 9, k / 9)).collect();
    let order = VertexOrder::of_values(&values).unwrap();
    let mut hierarchy = MorseHierarchy::new(&grid, &values, &order, SaddlePairs::Keep).unwrap();
    let ridge = VertexId(2 * 9 + 1);
    let pair = hierarchy.cancellations().iter().find(|pair| pair.extremum == Some(ridge) && pair.upper.dimension == 2).unwrap();
    assert_eq!((pair.persistence, pair.level), (1.0, 8.0));
    assert!(highest(&grid, &order, hierarchy.at(7.9)).contains(&ridge));
    assert!(!highest(&grid, &order, hierarchy.at(8.0)).contains(&ridge));
}

#[test]
fn threads_change_no_bit() {
    let ball = meshes::cubes([9, 9, 9]);
    let values = meshes::noise(729, 2, 90);
    let order = VertexOrder::of_values(&values).unwrap();
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut hierarchy = MorseHierarchy::new(&ball, &values, &order, SaddlePairs::Cancel).unwrap();
            hierarchy.at(0.3);
            let listed: Vec<_> = hierarchy.cancellations().to_vec();
            (listed, hierarchy.gradient().clone(), morsmooth::morse::MorseSmaleComplex::new(&hierarchy))
        })
    };
    assert!(with_threads(1) == with_threads(3));
}

#[test]
fn isolated_vertices_belong_to_nothing() {
    let complex = SimplicialComplex::new(1, vec![[0.0; 3]; 4], vec![0, 1, 1, 3]).unwrap();
    let values = [1.0, 2.0, 0.0, 3.0];
    let order = VertexOrder::of_values(&values).unwrap();
    let mut hierarchy = MorseHierarchy::new(&complex, &values, &order, SaddlePairs::Cancel).unwrap();
    hierarchy.at(9.0);
    assert_eq!(hierarchy.minimum_segmentation().label(VertexId(2)), None);
    assert!(!hierarchy.gradient().is_critical(Cell::vertex(VertexId(2))));
}

#[test]
fn most_pairs_of_saddles_cancel_too() {
    let ball = meshes::cubes([9, 8, 7]);
    let values = meshes::noise(ball.vertex_count(), 31, 1 << 40);
    let order = VertexOrder::of_values(&values).unwrap();
    let counts = |saddles| {
        let mut hierarchy = MorseHierarchy::new(&ball, &values, &order, saddles).unwrap();
        let counts = hierarchy.at(2.0).critical_counts();
        assert_eq!(MorseComplex::new(&ball, hierarchy.gradient()).boundary_defect(), None);
        counts
    };
    let (kept, cancelled) = (counts(SaddlePairs::Keep), counts(SaddlePairs::Cancel));
    assert_eq!((kept[0], kept[3]), (cancelled[0], cancelled[3]));
    assert!(cancelled[1] * 4 < kept[1], "{kept:?} {cancelled:?}");
}
