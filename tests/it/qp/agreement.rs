//! Two roads to the same optimum, and residuals computed by other code in twice the precision.

use morsmooth::qp::{Engine, Problem, QpStatus, Settings, Solution, Term};

use super::peer::clarabel;
use super::problems::{Case, instance};

/// An unevaluated sum of two doubles (Dekker 1971).
#[derive(Clone, Copy)]
struct Double(f64, f64);

impl Double {
    fn sum(self, other: Self) -> Self {
        let s = self.0 + other.0;
        let back = s - self.0;
        let error = (self.0 - (s - back)) + (other.0 - back) + self.1 + other.1;
        Self(s + error, error - ((s + error) - s))
    }

    fn scaled(self, factor: f64) -> Self {
        let p = self.0 * factor;
        let error = self.0.mul_add(factor, -p) + self.1 * factor;
        Self(p + error, error - ((p + error) - p))
    }
}

/// `P x + q - Aᵀ z` in twice the precision, plainly multiplied.
pub fn gradient_in_double(problem: &Problem, x: &[f64], z: &[f64]) -> Vec<f64> {
    let multiply = |matrix: &morsmooth::linalg::CsrMatrix, x: &[Double]| -> Vec<Double> {
        (0..matrix.rows())
            .map(|row| {
                let (columns, values) = matrix.row(row);
                // The diagonal of a Laplacian is what its row needs to sum to zero exactly.
                columns.iter().zip(values).filter(|(column, _)| **column as usize != row).fold(Double(0.0, 0.0), |sum, (&column, &value)| {
                    sum.sum(x[column as usize].sum(x[row].scaled(-1.0)).scaled(value))
                })
            })
            .collect()
    };
    let mut gradient: Vec<Double> = problem.objective.linear.iter().map(|&q| Double(q, 0.0)).collect();
    for term in &problem.objective.terms {
        let mut y: Vec<Double> = x.iter().map(|&x| Double(x, 0.0)).collect();
        match term {
            Term::Matrix(_) => unreachable!("these problems have none"),
            Term::Diagonal(diagonal) => y.iter_mut().zip(diagonal).for_each(|(y, &d)| *y = y.scaled(d)),
            Term::Chain { scale, stiffness, weights, order } => {
                y = multiply(stiffness, &y);
                for _ in 1..*order {
                    y.iter_mut().zip(weights).for_each(|(y, &w)| *y = y.scaled(w));
                    y = multiply(stiffness, &y);
                }
                y.iter_mut().for_each(|y| *y = y.scaled(*scale));
            }
        }
        gradient.iter_mut().zip(&y).for_each(|(g, y)| *g = g.sum(*y));
    }
    for (row, &z) in z.iter().enumerate() {
        let (columns, values) = problem.constraints.matrix.row(row);
        for (&column, &value) in columns.iter().zip(values) {
            gradient[column as usize] = gradient[column as usize].sum(Double(z, 0.0).scaled(-value));
        }
    }
    gradient.iter().map(|g| g.0 + g.1).collect()
}

fn assert_kkt(problem: &Problem, solution: &Solution) {
    let Solution { x, dual, .. } = solution;
    let gradient = gradient_in_double(problem, x, dual);
    let mut force = vec![0.0f64; x.len()];
    for (row, &z) in dual.iter().enumerate() {
        let (columns, values) = problem.constraints.matrix.row(row);
        columns.iter().zip(values).for_each(|(&column, &value)| force[column as usize] += value * z);
    }
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0f64, |most, value| most.max(value.abs()));
    let free = |i: &usize| problem.fixed[*i].is_none();
    let residual = most(&mut (0..x.len()).filter(free).map(|i| gradient[i]));
    let reaction = most(&mut (0..x.len()).filter(|i| !free(i)).map(|i| gradient[i]));
    let scale = most(&mut force.iter().copied()).max(reaction);
    assert!(residual <= 2e-8 * scale.max(solution.kkt.rounding * scale / 1e-8), "stationarity {residual:e} of {scale:e}");
    assert!(dual.iter().all(|&z| z >= 0.0));
    let mut gap = 0.0;
    for (row, &z) in dual.iter().enumerate() {
        let (columns, values) = problem.constraints.matrix.row(row);
        let value: f64 =
            problem.constraints.offset[row] + columns.iter().zip(values).map(|(&j, a)| a * x[j as usize]).sum::<f64>();
        assert!(value >= -1e-12, "row {row} is {value:e}");
        gap += z * value;
    }
    assert!(gap <= 1e-8 * solution.objective, "gap {gap:e} of {:e}", solution.objective);
    assert!(problem.fixed.iter().zip(x).all(|(fixed, x)| fixed.is_none_or(|fixed| fixed == *x)));
}

#[test]
fn optima_agree_with_clarabel_and_satisfy_the_conditions() {
    for case in [Case::Data, Case::NoData, Case::Smooth] {
        for k in 1..=4 {
            let made = instance(23, k, case, 100 + k as u64);
            let solution = {
                let mut engine = Engine::new(&made.problem.objective, None, Some(&made.coordinates)).unwrap();
                engine.solve(&made.problem, Some(&made.start), &Settings::default(), &mut |_| {}).unwrap()
            };
            assert_eq!(solution.status, QpStatus::Solved, "{case:?} {k} {:?}", solution.kkt);
            assert_kkt(&made.problem, &solution);
            let (_, _, energy) = clarabel(&made.problem);
            let difference = (solution.objective - energy) / energy;
            assert!(difference.abs() < 1e-6, "{case:?} {k}: ours {} theirs {energy}", solution.objective);
        }
    }
}

#[test]
fn a_start_changes_the_road_and_not_the_end() {
    let made = instance(31, 2, Case::Data, 5);
    let mut engine = Engine::new(&made.problem.objective, None, Some(&made.coordinates)).unwrap();
    let settings = Settings::default();
    let cold = engine.solve(&made.problem, None, &settings, &mut |_| {}).unwrap();
    let given = engine.solve(&made.problem, Some(&made.start), &settings, &mut |_| {}).unwrap();
    let warm = engine.solve_warm(&made.problem, (&given.x, &given.dual), &settings, &mut |_| {}).unwrap();
    for other in [&given, &warm] {
        assert_eq!(other.status, QpStatus::Solved);
        assert!((other.objective - cold.objective).abs() < 2e-8 * cold.objective);
    }
    assert!(warm.iterations <= given.iterations);
}

#[test]
fn larger_problems_of_every_order_reach_the_tolerances() {
    for case in [Case::Data, Case::Smooth] {
        for k in 1..=4 {
            let made = instance(60, k, case, 9);
            let mut engine = Engine::new(&made.problem.objective, None, Some(&made.coordinates)).unwrap();
            let solution = engine.solve(&made.problem, Some(&made.start), &Settings::default(), &mut |_| {}).unwrap();
            assert_eq!(solution.status, QpStatus::Solved, "{case:?} {k} {:?}", solution.kkt);
            assert_kkt(&made.problem, &solution);
        }
    }
}

#[test]
fn a_warm_start_saves_half_of_the_iterations() {
    let made = instance(50, 2, Case::Smooth, 6);
    let mut engine = Engine::new(&made.problem.objective, None, Some(&made.coordinates)).unwrap();
    let rough = Settings { relative_gap: 1e-3, residual: 1e-3, ..Settings::default() };
    let saved = engine.solve(&made.problem, Some(&made.start), &rough, &mut |_| {}).unwrap();
    let mut moved = made.problem.clone();
    moved.objective.linear.iter_mut().enumerate().for_each(|(i, q)| *q *= 1.0 + 0.01 * (i as f64).sin());
    let cold = engine.solve(&moved, Some(&made.start), &Settings::default(), &mut |_| {}).unwrap();
    let warm = engine.solve_warm(&moved, (&saved.x, &saved.dual), &Settings::default(), &mut |_| {}).unwrap();
    assert_eq!(warm.status, QpStatus::Solved);
    assert!(2 * warm.iterations <= cold.iterations, "{} against {}", warm.iterations, cold.iterations);
    assert!((warm.objective - cold.objective).abs() < 2e-8 * cold.objective);
}
