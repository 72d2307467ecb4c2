//! What the functions of each method are, by theorems.

use super::{block, comb, handles_of_comb, nearest, of_handles};
use crate::mesh::shapes::{Noise, mapped, sphere, with_threads};
use morsmooth::audit::audit_plateaus;
use morsmooth::field::{Precision, VertexId};
use morsmooth::interpolate::{BoundaryValues, Guide, InterpolateOptions, Interpolator, Mass, Method};
use morsmooth::mesh::SimplicialComplex;
use morsmooth::morse::WantedExtrema;
use morsmooth::qp::QpStatus;

fn options() -> InterpolateOptions {
    InterpolateOptions::default()
}

fn polyline(lengths: &[f64]) -> SimplicialComplex {
    let mut points = vec![[0.0; 3]];
    for length in lengths {
        points.push([points[points.len() - 1][0] + length, 0.0, 0.0]);
    }
    let ends = (0..lengths.len() as u32).flat_map(|i| [i, i + 1]).collect();
    SimplicialComplex::new(1, points, ends).unwrap()
}

#[test]
fn on_a_line_methods_of_first_order_are_linear() {
    let line = polyline(&[0.3, 1.0, 0.5, 0.2, 0.7, 1.1]);
    let length = line.points()[6][0];
    let given: BoundaryValues = vec![(VertexId(0), 2.0), (VertexId(6), 5.0)].into();
    for order in 1..=4 {
        let mut interpolator = Interpolator::new(&line, order).unwrap();
        for method in [Method::Harmonic, Method::Polyharmonic, Method::Bounded, Method::Monotone] {
            // Higher orders end at right angles to the boundary, in the mean.
            if order > 1 && method != Method::Harmonic {
                continue;
            }
            let found = interpolator.solve(method, &given, &options()).unwrap();
            for (value, point) in found.values.iter().zip(line.points()) {
                assert!((value - (2.0 + 3.0 * point[0] / length)).abs() < 1e-4, "{method} {order}: {:?}", found.values);
            }
        }
    }
}

#[test]
fn linear_methods_minimise_their_energy_and_reproduce_constants() {
    for complex in [comb(), block(), sphere(3)] {
        let n = complex.vertex_count();
        let handles = [nearest(&complex, [0.0; 3]), VertexId::from(n / 2), VertexId::from(n - 1)].map(|vertex| vec![vertex]);
        let given = of_handles(&handles);
        let mut noise = Noise(3);
        for order in 1..=3 {
            let mut interpolator = Interpolator::new(&complex, order).unwrap();
            let found = interpolator.solve_each(Method::Polyharmonic, &given, &options()).unwrap();
            for vertex in 0..n {
                let sum: f64 = found.iter().map(|found| found.values[vertex]).sum();
                assert!((sum - 1.0).abs() < 1e-9, "order {order}, vertex {vertex}: {sum}");
            }
            let least = interpolator.energy(&found[0].values);
            for _ in 0..5 {
                let change = |i: usize, noise: f64| if handles.iter().flatten().any(|v| v.index() == i) { 0.0 } else { 1e-3 * (noise - 0.5) };
                let other: Vec<f64> =
                    found[0].values.iter().enumerate().map(|(i, value)| value + change(i, noise.next())).collect();
                assert!(interpolator.energy(&other) > least, "order {order}");
            }
        }
    }
}

#[test]
fn monotone_functions_have_exactly_their_plateaus_as_extrema_and_energies_are_in_order() {
    let complex = comb();
    let given = of_handles(&handles_of_comb(&complex));
    for order in 1..=4 {
        let mut interpolator = Interpolator::new(&complex, order).unwrap();
        let free = interpolator.solve_each(Method::Polyharmonic, &given, &options()).unwrap();
        let bounded = interpolator.solve_each(Method::Bounded, &given, &options()).unwrap();
        let monotone = interpolator.solve_each(Method::Monotone, &given, &options()).unwrap();
        let mut spurious = 0;
        for (handle, given) in given.iter().enumerate() {
            let report = &monotone[handle].report;
            // At order 4 without data, the end may lie below rounding.
            if order < 4 {
                assert_eq!(report.status, QpStatus::Solved, "order {order}, handle {handle}");
                assert!(report.gap <= 1e-6 && report.residual < 1e-6, "{report:?}");
            }
            let verdict = audit_plateaus(&complex, &monotone[handle].values, &given.values).unwrap();
            assert!(verdict.passed, "order {order}, handle {handle}: {verdict:?}");
            assert_eq!((verdict.found_minima, verdict.found_maxima), (2, 1));
            assert_eq!((report.minima.len(), report.maxima.len()), (2, 1));
            // Each method's functions are among those of the one before.
            let energies = [&free, &bounded, &monotone].map(|found| found[handle].report.energy);
            assert!(energies[0] <= energies[1] * (1.0 + 1e-5), "{energies:?}");
            assert!(order == 4 || energies[1] <= energies[2] * (1.0 + 1e-4), "{energies:?}");
            let (low, high) = audit_plateaus(&complex, &bounded[handle].values, &given.values).unwrap().range;
            assert_eq!((low, high), (0.0, 1.0));
            spurious += audit_plateaus(&complex, &free[handle].values, &given.values).unwrap().spurious.count;
        }
        assert!(order < 2 || spurious > 0, "the comb no longer makes polyharmonic functions oscillate");
    }
}

#[test]
fn refinement_and_the_choice_of_the_guide_never_cost_energy() {
    let complex = comb();
    let given = of_handles(&handles_of_comb(&complex)).swap_remove(0);
    for order in [2, 3] {
        let mut interpolator = Interpolator::new(&complex, order).unwrap();
        let mut energy = |guide, refine| {
            let options = InterpolateOptions { guide, refine, ..options() };
            let found = interpolator.solve(Method::Monotone, &given, &options).unwrap();
            assert!(audit_plateaus(&complex, &found.values, &given.values).unwrap().passed);
            found.report.energy
        };
        let (smooth, harmonic) = (energy(Guide::SmoothThenSimplify, 0), energy(Guide::Harmonic, 0));
        assert!(energy(Guide::Harmonic, 3) <= harmonic * (1.0 + 1e-6));
        assert!(energy(Guide::SmoothThenSimplify, 3) <= smooth * (1.0 + 1e-6));
        if order == 3 {
            assert!((energy(Guide::Automatic, 0) / smooth.min(harmonic) - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn the_same_bits_alone_or_together_on_any_number_of_threads_and_lanes() {
    let complex = block();
    let handles = [0, 50, 100, 209].map(|vertex| vec![VertexId(vertex)]);
    let given = of_handles(&handles);
    let work = |at_once| {
        let mut interpolator = Interpolator::new(&complex, 2).unwrap();
        let options = InterpolateOptions { at_once, ..options() };
        let found = interpolator.solve_each(Method::Monotone, &given, &options).unwrap();
        let values: Vec<Vec<f64>> = found.into_iter().map(|found| found.values).collect();
        values
    };
    let [one, four] = with_threads(|| work(None));
    assert_eq!(one, four);
    assert_eq!(one, work(Some(1)));
    assert_eq!(one, work(Some(3)));
    let mut interpolator = Interpolator::new(&complex, 2).unwrap();
    for (given, values) in given.iter().zip(&one) {
        assert_eq!(&interpolator.solve(Method::Monotone, given, &options()).unwrap().values, values);
    }
}

#[test]
fn a_part_that_a_handle_cuts_off_is_constant() {
    // A strip cut in two by a column of the second handle: behind it, nothing but its value is monotone.
    let strip = crate::mesh::shapes::grid([12, 4, 1]);
    let column = |x: u32| (0..4).map(|y| VertexId(12 * y + x)).collect::<Vec<_>>();
    let given = of_handles(&[column(0), column(6)]);
    for order in [2, 3] {
        let mut interpolator = Interpolator::new(&strip, order).unwrap();
        let found = interpolator.solve_each(Method::Monotone, &given, &options()).unwrap();
        for (found, given) in found.iter().zip(&given) {
            assert_eq!(found.report.constant, 20);
            let value = found.values[6];
            assert!((0..4).all(|y| found.values[12 * y + 7..12 * y + 12].iter().all(|&other| other == value)));
            assert!(audit_plateaus(&strip, &found.values, &given.values).unwrap().passed);
        }
    }
}

#[test]
fn values_between_the_ends_need_not_be_extrema_and_may_be() {
    let complex = comb();
    let at = |x, y| nearest(&complex, [x, y, 0.0]);
    let (low, high) = (at(1.0, 8.0), at(32.0, 8.0));
    // 0.9 at the far end of a tooth is a maximum; in the middle of the bar, the value that is there anyway is none.
    let mut given: BoundaryValues = vec![(low, 0.0), (high, 1.0), (at(11.0, 8.0), 0.9)].into();
    let mut interpolator = Interpolator::new(&complex, 2).unwrap();
    let middle = at(16.0, 1.0);
    let there = interpolator.solve(Method::Harmonic, &given, &options()).unwrap().values[middle.index()];
    given.values.push((middle, there));
    let found = interpolator.solve(Method::Monotone, &given, &options()).unwrap();
    assert_eq!(found.report.minima, [low]);
    let mut maxima = vec![high, at(11.0, 8.0)];
    maxima.sort_unstable();
    assert_eq!(found.report.maxima, maxima);
    assert!(audit_plateaus(&complex, &found.values, &given.values).unwrap().passed);
}

#[test]
fn wanted_extrema_may_be_named() {
    let complex = comb();
    let at = |x, y| nearest(&complex, [x, y, 0.0]);
    let (a, b, c) = (at(1.0, 8.0), at(32.0, 8.0), at(16.0, 1.0));
    let mut maxima = vec![b, c];
    maxima.sort_unstable();
    let wanted = WantedExtrema { minima: vec![a], maxima };
    let given = BoundaryValues { values: vec![(a, -1.0), (b, 3.0), (c, 2.9)], wanted: Some(wanted) };
    let mut interpolator = Interpolator::new(&complex, 2).unwrap();
    let found = interpolator.solve(Method::Monotone, &given, &options()).unwrap();
    let extrema = morsmooth::audit::extrema(&complex, &found.values).unwrap();
    let wanted = given.wanted.unwrap();
    assert_eq!((extrema.minima, extrema.maxima), (wanted.minima, wanted.maxima));
}

#[test]
fn units_do_not_matter_and_values_scale() {
    let complex = comb();
    let given = of_handles(&handles_of_comb(&complex)).swap_remove(1);
    let mut interpolator = Interpolator::new(&complex, 3).unwrap();
    let unit = interpolator.solve(Method::Monotone, &given, &options()).unwrap();
    for scale in [1e-8, 1e8] {
        let scaled = mapped(&complex, |p| p.map(|part| part * scale));
        let found = Interpolator::new(&scaled, 3).unwrap().solve(Method::Monotone, &given, &options()).unwrap();
        for (a, b) in unit.values.iter().zip(&found.values) {
            assert!((a - b).abs() < 1e-4, "{scale}: {a} {b}");
        }
    }
    let warmer = given.values.iter().map(|&(vertex, value)| (vertex, 300.0 + 0.5 * value)).collect::<Vec<_>>().into();
    let found = interpolator.solve(Method::Monotone, &warmer, &options()).unwrap();
    for (a, b) in unit.values.iter().zip(&found.values) {
        assert!((300.0 + 0.5 * a - b).abs() < 1e-4);
    }
}

#[test]
fn single_precision_is_strict_as_it_is_stored() {
    let complex = comb();
    let given = of_handles(&handles_of_comb(&complex));
    let mut interpolator = Interpolator::new(&complex, 2).unwrap();
    let options = InterpolateOptions { precision: Precision::F32, ..options() };
    for (found, given) in interpolator.solve_each(Method::Monotone, &given, &options).unwrap().iter().zip(&given) {
        assert!(found.values.iter().all(|&value| f64::from(value as f32) == value));
        assert!(audit_plateaus(&complex, &found.values, &given.values).unwrap().passed);
    }
}

#[test]
fn the_mass_makes_a_difference_on_triangles_only() {
    let surface = comb();
    let given = of_handles(&handles_of_comb(&surface)).swap_remove(0);
    let of = |complex: &SimplicialComplex, given: &BoundaryValues, mass| {
        Interpolator::with_mass(complex, 2, mass).unwrap().solve(Method::Polyharmonic, given, &options()).unwrap().values
    };
    assert_ne!(of(&surface, &given, Mass::Voronoi), of(&surface, &given, Mass::Barycentric));
    let given: BoundaryValues = vec![(VertexId(0), 0.0), (VertexId(209), 1.0)].into();
    assert_eq!(of(&block(), &given, Mass::Voronoi), of(&block(), &given, Mass::Barycentric));
}
