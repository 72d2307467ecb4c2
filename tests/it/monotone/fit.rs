//! The metric half: energies, representative functions on hard domains, the fit and its bounds.

use morsmooth::field::{VertexId, VertexOrder};
use morsmooth::mesh::{Domain, Grid, GridGeometry, Mask, SimplicialComplex};
use morsmooth::monotone::{
    EdgeSet, EnergyWeights, Fitter, MonotoneConstraints, MonotonicityGraph, Operators, ValueRule, energy_parts, harmonic,
    has_exactly, levels, representative, separatrix,
};
use morsmooth::morse::{ExtremumKind, Selection, Threshold, WantedExtrema, extremum_pairs, select};
use morsmooth::qp::{QpStatus, Settings};

/// Noise that looks random, the same in every run, in [-1, 1].
fn noise(i: usize) -> f64 {
    (i as f64 * 12.9898).sin() * 43_758.547 % 1.0
}

fn noisy_waves(width: usize, height: usize) -> (SimplicialComplex, Vec<f64>) {
    let grid = Grid::image([width, height, 1], [0.0; 3], [0.1, 0.1, 1.0]);
    let complex = Domain::from_grid(&grid, &Mask::none()).unwrap().complex;
    let wave = |p: &[f64; 3]| (1.7 * p[0]).sin() * (1.3 * p[1]).cos();
    let data = complex.points().iter().enumerate().map(|(i, p)| wave(p) + 0.3 * noise(i)).collect();
    (complex, data)
}

fn wanted(complex: &SimplicialComplex, data: &[f64], fraction: f64) -> (VertexOrder, WantedExtrema) {
    let order = VertexOrder::of_values(data).unwrap();
    let [minima, maxima] =
        [ExtremumKind::Minimum, ExtremumKind::Maximum].map(|kind| extremum_pairs(complex, &order, kind));
    let wanted = select(&minima, &maxima, data, &Selection::Threshold(Threshold::Fraction(fraction))).unwrap();
    (order, wanted)
}

fn weights(order: usize, length: f64) -> EnergyWeights<'static> {
    EnergyWeights { order, length, confidence: None, smoothness: None }
}

fn total(operators: &Operators, data: &[f64], weights: &EnergyWeights<'_>, field: &[f64]) -> f64 {
    let (smoothness, distance) = energy_parts(operators, data, weights, field);
    smoothness + distance
}

/// A grid of `body x body` points with a tail of `width` points across and `length` along.
fn with_tail(body: usize, width: usize, length: usize) -> SimplicialComplex {
    let dims = [body + length, body, 1];
    let keep = (0..dims[0] * dims[1]).map(|point| point % dims[0] < body || point / dims[0] < width).collect();
    let mask = Mask { keep_points: Some(keep), keep_cells: None };
    Domain::from_grid(&Grid::image(dims, [0.0; 3], [1.0; 3]), &mask).unwrap().complex
}

#[test]
fn the_harmonic_function_is_valid_in_tails_where_its_differences_sink_below_rounding() {
    for (width, length) in [(2, 60), (4, 120), (3, 200)] {
        let complex = with_tail(20, width, length);
        // Both extrema sit in the body, so that the tail carries nothing but rounding.
        let far = complex.vertex_count() - 1;
        let wanted = WantedExtrema { minima: vec![VertexId(5)], maxima: vec![VertexId::from(far)] };
        let function = harmonic(&complex, &wanted).unwrap();
        assert!(has_exactly(&complex, &function.order, &wanted), "tail {width} x {length}");
    }
}

#[test]
fn the_harmonic_function_is_valid_on_squashed_grids() {
    // Cotangents of either sign: the plain Laplacian breaks the maximum principle here.
    let points: Vec<[f64; 3]> =
        (0..900).map(|i| [(i % 30) as f64 + 0.4 * noise(i), 0.05 * ((i / 30) as f64 + 0.4 * noise(i + 7)), 0.0]).collect();
    let grid = Grid { dims: [30, 30, 1], geometry: GridGeometry::Curvilinear { points } };
    let complex = Domain::from_grid(&grid, &Mask::none()).unwrap().complex;
    let vertex = VertexId;
    let wanted = WantedExtrema { minima: vec![vertex(0), vertex(455)], maxima: vec![vertex(29), vertex(640), vertex(899)] };
    assert!(has_exactly(&complex, &harmonic(&complex, &wanted).unwrap().order, &wanted));
}

#[test]
fn separatrices_give_a_valid_function_at_every_threshold() {
    let (complex, data) = noisy_waves(40, 30);
    for fraction in [0.0, 0.02, 0.1, 0.3, 0.6] {
        let (order, wanted) = wanted(&complex, &data, fraction);
        let function = separatrix(&complex, &data, &order, &wanted).unwrap();
        assert!(has_exactly(&complex, &function.order, &wanted), "threshold {fraction}");
    }
}

#[test]
fn energies_are_those_of_the_chain_multiplied_out() {
    let (complex, data) = noisy_waves(9, 7);
    let operators = Operators::new(&complex).unwrap();
    let field: Vec<f64> = (0..data.len()).map(|i| noise(3 * i + 1)).collect();
    let mask: Vec<f64> = (0..data.len()).map(|i| 0.5 + 0.5 * noise(i)).collect();
    for order in 1..=4 {
        let weights = EnergyWeights { smoothness: Some(&mask), ..weights(order, 0.7) };
        // f' L (Λ M^-1 L)^(k-1) f, one factor after another.
        let mut image = operators.laplacian.multiply(&field);
        for _ in 1..order {
            let scaled: Vec<f64> = (0..image.len()).map(|i| image[i] * mask[i] / operators.mass[i]).collect();
            image = operators.laplacian.multiply(&scaled);
        }
        let square: f64 = field.iter().zip(&image).map(|(a, b)| a * b).sum();
        let expected = 0.7f64.powi(2 * order as i32) * 0.5 * square;
        let (smoothness, _) = energy_parts(&operators, &data, &weights, &field);
        assert!((smoothness - expected).abs() <= 1e-12 * expected.abs(), "order {order}: {smoothness} {expected}");
    }
}

#[test]
fn the_minimiser_has_less_energy_than_its_neighbours_and_keeps_pins() {
    let (complex, data) = noisy_waves(25, 20);
    let operators = Operators::new(&complex).unwrap();
    for order in 1..=4 {
        let weights = weights(order, 0.2);
        let mut fitter = Fitter::new(&complex, &operators, order).unwrap();
        let mut pins = vec![None; data.len()];
        pins[7] = Some(2.5);
        pins[300] = Some(-1.25);
        let field = fitter.minimiser(&data, &weights, &pins).unwrap();
        assert_eq!((field[7], field[300]), (2.5, -1.25));
        let least = total(&operators, &data, &weights, &field);
        for vertex in (0..data.len()).step_by(11).filter(|vertex| pins[*vertex].is_none()) {
            for step in [-1e-3, 1e-3] {
                let mut other = field.clone();
                other[vertex] += step;
                assert!(total(&operators, &data, &weights, &other) > least, "order {order}, vertex {vertex}");
            }
        }
    }
}

#[test]
fn the_fit_lies_between_the_pinned_bound_and_every_feasible_field() {
    let (complex, data) = noisy_waves(30, 24);
    let operators = Operators::new(&complex).unwrap();
    let (_, wanted) = wanted(&complex, &data, 0.3);
    let mut rules = vec![ValueRule::Free; data.len()];
    let mut pins = vec![None; data.len()];
    for &extremum in wanted.minima.iter().chain(&wanted.maxima) {
        rules[extremum.index()] = ValueRule::Exactly(data[extremum.index()]);
        pins[extremum.index()] = Some(data[extremum.index()]);
    }
    for order in 1..=4 {
        let weights = weights(order, 0.15);
        let mut fitter = Fitter::new(&complex, &operators, order).unwrap();
        let pinned = fitter.minimiser(&data, &weights, &pins).unwrap();
        let bound = total(&operators, &data, &weights, &pinned);
        let function = representative(&complex, &VertexOrder::of_values(&pinned).unwrap(), &wanted).unwrap();
        let mut energies = Vec::new();
        for set in [EdgeSet::Minimal, EdgeSet::All] {
            let graph = MonotonicityGraph::new(&complex, &function.order, &wanted, set);
            let levels = levels(&graph, &rules, (-3.0, 3.0)).unwrap();
            let constraints =
                MonotoneConstraints { graph: &graph, levels: &levels, rules: &rules, margin: 1e-6, feasible: None };
            let fit = fitter
                .monotone(&data, &weights, &constraints, &pinned, &Settings::default(), &mut |_| {})
                .unwrap();
            assert_eq!(fit.status, QpStatus::Solved);
            assert!(fit.kkt.stationarity <= 1e-8 && fit.kkt.duality_gap <= 1e-8, "order {order}: {:?}", fit.kkt);
            for edge in graph.edges() {
                assert!(fit.values[edge.low.index()] < fit.values[edge.high.index()]);
            }
            assert!(fit.energy >= bound * (1.0 - 1e-12), "the pinned field bounds from below");
            assert!(fit.energy <= total(&operators, &data, &weights, &levels.values), "the levels are feasible");
            energies.push(fit.energy);
        }
        assert!(energies[0] <= energies[1] * (1.0 + 1e-7), "more edges cannot cost less: {energies:?}");
    }
}
