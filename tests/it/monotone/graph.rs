//! The combinatorial half: flood, block structure, st-numbering, levels, sweep and exact repair.

use morsmooth::field::{Precision, VertexId, VertexOrder};
use morsmooth::mesh::SimplicialComplex;
use morsmooth::monotone::{
    EdgeSet, MonotonicityGraph, Strictness, ValueRule, flood, has_exactly, levels, repair, st_numbering, sweep,
    unreachable_regions,
};
use morsmooth::morse::{ExtremumKind, ExtremumPair, WantedExtrema, extremum_pairs};
use proptest::prelude::*;

/// A `width x height` grid of which the listed points are left out, and nothing isolated.
fn masked_grid(width: usize, height: usize, hole: &[bool]) -> Option<SimplicialComplex> {
    let mut triangles = Vec::new();
    for y in 0..height - 1 {
        for x in 0..width - 1 {
            let corner = |dx: usize, dy: usize| (y + dy) * width + x + dx;
            for triangle in [[corner(0, 0), corner(1, 0), corner(1, 1)], [corner(0, 0), corner(1, 1), corner(0, 1)]] {
                if triangle.iter().all(|&point| !hole[point]) {
                    triangles.push(triangle);
                }
            }
        }
    }
    let mut number = vec![u32::MAX; width * height];
    let mut points = Vec::new();
    for &point in triangles.iter().flatten() {
        if number[point] == u32::MAX {
            number[point] = points.len() as u32;
            points.push([(point % width) as f64, (point / width) as f64, 0.0]);
        }
    }
    let simplices: Vec<u32> = triangles.iter().flatten().map(|&point| number[point]).collect();
    (!points.is_empty()).then(|| SimplicialComplex::new(2, points, simplices).unwrap())
}

/// Extrema whose persistence exceeds a threshold, the last of each component always.
fn kept(pairs: &[ExtremumPair], values: &[f64], threshold: f64) -> Vec<VertexId> {
    pairs
        .iter()
        .filter(|pair| pair.persistence(values).is_none_or(|persistence| persistence > threshold))
        .map(|pair| pair.extremum)
        .collect()
}

/// Adds, in each part that cannot do without, the most persistent extremum.
fn completed(complex: &SimplicialComplex, values: &[f64], pairs: [&[ExtremumPair]; 2], mut wanted: WantedExtrema) -> WantedExtrema {
    loop {
        let regions = unreachable_regions(complex, &wanted);
        if regions.is_empty() {
            return wanted;
        }
        for region in regions {
            let best = pairs
                .iter()
                .flat_map(|pairs| pairs.iter())
                .filter(|pair| region.contains(&pair.extremum))
                .max_by(|a, b| a.persistence(values).unwrap().total_cmp(&b.persistence(values).unwrap()))
                .expect("a part that hangs on one vertex has an extremum of its own");
            match best.kind {
                ExtremumKind::Minimum => wanted.minima.push(best.extremum),
                ExtremumKind::Maximum => wanted.maxima.push(best.extremum),
            }
        }
    }
}

fn values_and_holes() -> impl Strategy<Value = (usize, usize, Vec<bool>, Vec<f64>, f64)> {
    (3usize..14, 3usize..14).prop_flat_map(|(width, height)| {
        let n = width * height;
        (
            Just(width),
            Just(height),
            prop::collection::vec(prop::bool::weighted(0.15), n),
            // Few distinct values: plateaus and ties are the rule.
            prop::collection::vec((0i32..12).prop_map(f64::from), n),
            0.0f64..8.0,
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn every_order_can_be_made_to_have_exactly_the_wanted_extrema((width, height, holes, data, threshold) in values_and_holes()) {
        let Some(complex) = masked_grid(width, height, &holes) else { return Ok(()) };
        let values = &data[..complex.vertex_count()];
        let order = VertexOrder::of_values(values).unwrap();
        let minima = extremum_pairs(&complex, &order, ExtremumKind::Minimum);
        let maxima = extremum_pairs(&complex, &order, ExtremumKind::Maximum);
        let asked = WantedExtrema { minima: kept(&minima, values, threshold), maxima: kept(&maxima, values, threshold) };
        let wanted = completed(&complex, values, [&minima, &maxima], asked);

        let flooded = flood(&complex, &order, &wanted);
        prop_assert!(flooded.valid, "the flood of the field's own order settles");
        prop_assert!(has_exactly(&complex, &flooded.order, &wanted));
        let last_resort = st_numbering(&complex, &wanted).expect("an order exists");
        prop_assert!(has_exactly(&complex, &last_resort, &wanted));

        for set in [EdgeSet::Minimal, EdgeSet::All] {
            let graph = MonotonicityGraph::new(&complex, &flooded.order, &wanted, set);
            let mut rules = vec![ValueRule::Free; values.len()];
            for &extremum in wanted.minima.iter().chain(&wanted.maxima) {
                rules[extremum.index()] = ValueRule::Exactly(values[extremum.index()]);
            }
            let Ok(feasible) = levels(&graph, &rules, (-1.0, 13.0)) else {
                // Only a component or part whose extrema all have one value has no strict field.
                continue;
            };
            for edge in graph.edges() {
                prop_assert!(feasible.values[edge.low.index()] < feasible.values[edge.high.index()]);
            }
            let swept = sweep(&graph, &feasible, values);
            for edge in graph.edges() {
                prop_assert!(swept[edge.low.index()] <= swept[edge.high.index()]);
            }
            for precision in [Precision::F32, Precision::F64] {
                let repaired = repair(&graph, &swept, &rules, precision, Strictness::Plain).unwrap();
                let f = &repaired.values;
                prop_assert!(graph.edges().iter().all(|edge| f[edge.low.index()] < f[edge.high.index()]));
                prop_assert!(f.iter().all(|&value| precision.round(value) == value));
                let result = VertexOrder::of_values(f).unwrap();
                prop_assert!(has_exactly(&complex, &result, &wanted));
                let ties = repair(&graph, &swept, &rules, precision, Strictness::TiesByIndex).unwrap();
                prop_assert!(has_exactly(&complex, &VertexOrder::of_values(&ties.values).unwrap(), &wanted));
            }
        }
    }

    #[test]
    fn the_flood_takes_extrema_of_another_field((width, height, holes, data, threshold) in values_and_holes(), shift in 1usize..50) {
        let Some(complex) = masked_grid(width, height, &holes) else { return Ok(()) };
        let n = complex.vertex_count();
        let order = VertexOrder::of_values(&data[..n]).unwrap();
        let minima = extremum_pairs(&complex, &order, ExtremumKind::Minimum);
        let maxima = extremum_pairs(&complex, &order, ExtremumKind::Maximum);
        let asked = WantedExtrema { minima: kept(&minima, &data, threshold), maxima: kept(&maxima, &data, threshold) };
        let wanted = completed(&complex, &data[..n], [&minima, &maxima], asked);
        let mut other = data[..n].to_vec();
        other.rotate_left(shift % n);
        let flooded = flood(&complex, &VertexOrder::of_values(&other).unwrap(), &wanted);
        prop_assert_eq!(flooded.valid, has_exactly(&complex, &flooded.order, &wanted));
        // The alternation need not settle on a foreign field; how often it does is what we measure.
        prop_assert!(flooded.valid, "passes {}", flooded.passes);
    }
}

#[test]
fn a_part_that_hangs_on_one_vertex_needs_an_extremum() {
    // Two triangles that share vertex 2 only.
    let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.0, 2.0, 0.0], [1.0, 2.0, 0.0]];
    let complex = SimplicialComplex::new(2, points, vec![0, 1, 2, 2, 3, 4]).unwrap();
    let vertex = VertexId;
    let wanted = WantedExtrema { minima: vec![vertex(0)], maxima: vec![vertex(1)] };
    assert_eq!(unreachable_regions(&complex, &wanted), [vec![vertex(3), vertex(4)]]);
    assert!(st_numbering(&complex, &wanted).is_none());
    let wanted = WantedExtrema { minima: vec![vertex(0)], maxima: vec![vertex(4)] };
    // Now 0 .. 4 is a path through the cut vertex.
    assert_eq!(unreachable_regions(&complex, &wanted), Vec::<Vec<VertexId>>::new());
    assert!(has_exactly(&complex, &st_numbering(&complex, &wanted).unwrap(), &wanted));
}

#[test]
fn a_component_without_a_wanted_maximum_is_named() {
    let points = (0..6).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    let complex = SimplicialComplex::new(1, points, vec![0, 1, 1, 2, 3, 4, 4, 5]).unwrap();
    let vertex = VertexId;
    let wanted = WantedExtrema { minima: vec![vertex(0), vertex(3)], maxima: vec![vertex(2)] };
    assert_eq!(unreachable_regions(&complex, &wanted), [vec![vertex(4), vertex(5)]]);
    // On a line both ends are extrema in every field.
    let wanted = WantedExtrema { minima: vec![vertex(0), vertex(3)], maxima: vec![vertex(2), vertex(4)] };
    assert_eq!(unreachable_regions(&complex, &wanted), [vec![vertex(5)]]);
}

#[test]
fn contradicting_values_are_named() {
    let points = (0..4).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    let complex = SimplicialComplex::new(1, points, vec![0, 1, 1, 2, 2, 3]).unwrap();
    let wanted = WantedExtrema { minima: vec![VertexId(0)], maxima: vec![VertexId(3)] };
    let order = VertexOrder::of_sequence((0..4).map(VertexId).collect()).unwrap();
    let graph = MonotonicityGraph::new(&complex, &order, &wanted, EdgeSet::Minimal);
    let mut rules = vec![ValueRule::Free; 4];
    rules[0] = ValueRule::Exactly(2.0);
    rules[3] = ValueRule::Exactly(1.0);
    let contradiction = levels(&graph, &rules, (0.0, 3.0)).unwrap_err();
    assert_eq!((contradiction.low, contradiction.high), (VertexId(0), VertexId(3)));
    assert_eq!((contradiction.low_value, contradiction.high_value), (2.0, 1.0));
}

#[test]
fn a_chain_with_more_vertices_than_numbers_is_refused() {
    let points = (0..5).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    let complex = SimplicialComplex::new(1, points, vec![0, 1, 1, 2, 2, 3, 3, 4]).unwrap();
    let wanted = WantedExtrema { minima: vec![VertexId(0)], maxima: vec![VertexId(4)] };
    let order = VertexOrder::of_sequence((0..5).map(VertexId).collect()).unwrap();
    let graph = MonotonicityGraph::new(&complex, &order, &wanted, EdgeSet::Minimal);
    let mut rules = vec![ValueRule::Free; 5];
    let low = f64::from(1.0f32);
    rules[0] = ValueRule::Exactly(low);
    // Two numbers of 32 bits lie strictly between; three are needed.
    rules[4] = ValueRule::Exactly(low + 3.0 * f64::from(f32::EPSILON));
    assert!(repair(&graph, &[1.0; 5], &rules, Precision::F32, Strictness::Plain).is_err());
    assert!(repair(&graph, &[1.0; 5], &rules, Precision::F64, Strictness::Plain).is_ok());
}
