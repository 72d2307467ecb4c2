//! Optima known by hand or by another algorithm.

use morsmooth::qp::{Constraints, Objective, Problem, Term};

use super::problems::Random;
use super::{distance, order, path_laplacian, solved};

#[test]
fn two_unknowns_in_the_wrong_order_meet_in_the_middle() {
    let problem =
        Problem { objective: distance(&[2.0, 1.0], &[1.0, 1.0]), fixed: vec![None; 2], constraints: order(2, &[(0, 1, 0.0)]) };
    let solution = solved(&problem);
    assert!((solution.x[0] - 1.5).abs() < 1e-5 && (solution.x[1] - 1.5).abs() < 1e-5);
    assert!((solution.objective - 0.25).abs() < 1e-8 * 0.25 * 4.0);
    // The multiplier is the force that holds them together.
    assert!((solution.dual[0] - 0.5).abs() < 1e-5);
}

#[test]
fn rows_that_do_not_bind_cost_nothing() {
    let problem =
        Problem { objective: distance(&[1.0, 2.0], &[1.0, 1.0]), fixed: vec![None; 2], constraints: order(2, &[(0, 1, 0.5)]) };
    let solution = solved(&problem);
    // The objective is exactly zero at the optimum; the engine judges the gap against what rounding leaves of its addends.
    assert!((solution.x[0] - 1.0).abs() < 1e-4 && (solution.x[1] - 2.0).abs() < 1e-4 && solution.objective < 1e-7);
}

#[test]
fn margins_are_kept() {
    let problem = Problem {
        objective: distance(&[0.0, 0.0, 0.0], &[1.0; 3]),
        fixed: vec![None; 3],
        constraints: order(3, &[(0, 1, 1.0), (1, 2, 1.0)]),
    };
    let solution = solved(&problem);
    assert!([-1.0, 0.0, 1.0].iter().zip(&solution.x).all(|(known, x)| (known - x).abs() < 1e-6));
}

/// Isotonic regression by pooling adjacent violators, exact in finitely many steps.
fn pooled(target: &[f64], weights: &[f64]) -> Vec<f64> {
    let mut pools: Vec<(f64, f64, usize)> = Vec::new();
    for (&t, &w) in target.iter().zip(weights) {
        let mut pool = (t, w, 1);
        while let Some(&(mean, weight, count)) = pools.last() {
            if mean < pool.0 {
                break;
            }
            pools.pop();
            pool = ((mean * weight + pool.0 * pool.1) / (weight + pool.1), weight + pool.1, count + pool.2);
        }
        pools.push(pool);
    }
    pools.iter().flat_map(|&(mean, _, count)| std::iter::repeat_n(mean, count)).collect()
}

#[test]
fn isotonic_regression_agrees_with_pooling() {
    for seed in 0..5 {
        let mut random = Random(seed);
        let n = 300;
        let target: Vec<f64> = (0..n).map(|i| i as f64 / 100.0 + random.normal()).collect();
        let weights: Vec<f64> = (0..n).map(|_| 0.1 + random.unit()).collect();
        let arcs: Vec<(u32, u32, f64)> = (1..n as u32).map(|i| (i - 1, i, 0.0)).collect();
        let problem = Problem { objective: distance(&target, &weights), fixed: vec![None; n], constraints: order(n, &arcs) };
        let solution = solved(&problem);
        let known = pooled(&target, &weights);
        let energy = problem.objective.value(&known);
        assert!((solution.objective - energy).abs() <= 2e-8 * energy);
        // A gap g leaves x within sqrt(2 g / smallest weight).
        let far = (2.0 * 2e-8 * energy / 0.1).sqrt();
        assert!(solution.x.iter().zip(&known).all(|(x, k)| (x - k).abs() < far));
    }
}

#[test]
fn the_monotone_spline_through_two_values_is_a_line() {
    let n = 40;
    for k in 1..=4 {
        let chain = Term::Chain { scale: 2.0, stiffness: path_laplacian(n), weights: vec![1.0; n], order: k };
        let mut fixed = vec![None; n];
        (fixed[0], fixed[n - 1]) = (Some(0.0), Some(1.0));
        let arcs: Vec<(u32, u32, f64)> = (1..n as u32).map(|i| (i - 1, i, 0.0)).collect();
        let objective = Objective { terms: vec![chain], linear: vec![0.0; n], constant: 0.0 };
        let solution = solved(&Problem { objective, fixed, constraints: order(n, &arcs) });
        assert!(solution.x.windows(2).all(|pair| pair[1] >= pair[0] - 1e-9));
        if k == 1 {
            assert!(solution.x.iter().enumerate().all(|(i, x)| (x - i as f64 / (n - 1) as f64).abs() < 1e-5));
            assert!((solution.objective - 1.0 / (n - 1) as f64).abs() < 1e-9);
        }
    }
}

#[test]
fn nothing_free_nothing_to_do() {
    let problem = Problem {
        objective: distance(&[1.0, 1.0], &[1.0, 1.0]),
        fixed: vec![Some(2.0), Some(3.0)],
        constraints: order(2, &[(0, 1, 0.0)]),
    };
    let solution = solved(&problem);
    assert_eq!((solution.x, solution.objective, solution.iterations), (vec![2.0, 3.0], 2.5, 0));
    assert_eq!((solution.slack, solution.dual), (vec![1.0], vec![0.0]));
}

#[test]
fn one_unknown_with_and_without_rows() {
    let free = Problem { objective: distance(&[3.0], &[2.0]), fixed: vec![None], constraints: Constraints::none(1) };
    assert_eq!(solved(&free).x, [3.0]);
    // x <= 1, as a row with one entry.
    let matrix = morsmooth::linalg::CsrMatrix::from_triplets(1, 1, &[(0, 0, -1.0)]).unwrap();
    let bounded = Problem { constraints: Constraints::nonnegative(matrix, vec![1.0]), ..free };
    let solution = solved(&bounded);
    assert!((solution.x[0] - 1.0).abs() < 1e-7 && (solution.dual[0] - 4.0).abs() < 1e-5);
}

#[test]
fn without_rows_the_answer_is_the_minimiser() {
    let problem = Problem {
        objective: distance(&[5.0, -1.0, 2.0], &[1.0, 2.0, 3.0]),
        fixed: vec![None, Some(7.0), None],
        constraints: Constraints::none(3),
    };
    let solution = solved(&problem);
    assert_eq!((solution.x, solution.iterations), (vec![5.0, 7.0, 2.0], 0));
}
