//! How solves end when they do not end well.

use morsmooth::linalg::CsrMatrix;
use morsmooth::qp::{Certificate, Constraints, Engine, Problem, QpStatus, Settings, solve};

use super::problems::{Case, Instance, instance};
use super::{distance, order};

/// Recomputes what a certificate claims.
fn assert_certified(problem: &Problem, certificate: &Certificate) {
    let n = problem.fixed.len();
    let mut image = vec![0.0; n];
    let mut conflict = 0.0;
    for (&row, &y) in certificate.constraints.iter().zip(&certificate.multipliers) {
        assert!(y > 0.0);
        conflict += y * problem.constraints.offset[row];
        let (columns, values) = problem.constraints.matrix.row(row);
        for (&column, &value) in columns.iter().zip(values) {
            match problem.fixed[column as usize] {
                Some(known) => conflict += y * value * known,
                None => image[column as usize] += y * value,
            }
        }
    }
    let residual = image.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    assert!(conflict < 0.0 && residual < 1e-5 * -conflict, "conflict {conflict:e}, residual {residual:e}");
}

fn certificate(problem: &Problem) -> Certificate {
    let solution = solve(problem, None, None, &Settings::default()).unwrap();
    match solution.status {
        QpStatus::Infeasible(certificate) => certificate,
        other => panic!("{other:?} after {} iterations, {:?}", solution.iterations, solution.kkt),
    }
}

#[test]
fn two_fixed_values_in_the_wrong_order_are_named() {
    let problem = Problem {
        objective: distance(&[0.0; 2], &[1.0; 2]),
        fixed: vec![Some(1.0), Some(0.0)],
        constraints: order(2, &[(0, 1, 0.0)]),
    };
    let found = certificate(&problem);
    assert_eq!((found.constraints.clone(), found.conflict), (vec![0], -1.0));
    assert_certified(&problem, &found);
}

#[test]
fn a_path_between_contradicting_values_is_named() {
    for length in [3u32, 10, 100] {
        let n = 2 * length as usize;
        let mut fixed = vec![None; n];
        (fixed[0], fixed[length as usize - 1]) = (Some(1.0), Some(0.0));
        // The second half has nothing to do with it.
        let arcs: Vec<(u32, u32, f64)> =
            (1..n as u32).filter(|&i| i != length).map(|i| (i - 1, i, 0.0)).collect();
        let target: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
        let problem = Problem { objective: distance(&target, &vec![1.0; n]), fixed, constraints: order(n, &arcs) };
        let found = certificate(&problem);
        assert_certified(&problem, &found);
        assert!(found.constraints.iter().all(|&row| row < length as usize - 1), "{:?}", found.constraints);
    }
}

#[test]
fn a_cycle_of_margins_is_named() {
    let problem = Problem {
        objective: distance(&[0.0, 5.0, 1.0, 2.0], &[1.0; 4]),
        fixed: vec![None; 4],
        constraints: order(4, &[(0, 1, 1.0), (1, 2, 1.0), (2, 0, 1.0), (2, 3, 0.0)]),
    };
    let found = certificate(&problem);
    assert_certified(&problem, &found);
    assert_eq!(found.constraints, [0, 1, 2]);
}

#[test]
fn a_contradiction_in_a_mesh_is_named_whatever_its_scale() {
    for scale in [1.0, 1e-8, 1e8] {
        for k in [1, 2, 3] {
            let mut made = instance(25, k, Case::Data, 8);
            let rows = &made.problem.constraints.matrix;
            // Follow the order upwards from a fixed vertex and ask for a lower value at the end of the walk.
            let mut here = (0..made.problem.fixed.len()).find(|&i| made.problem.fixed[i].is_some_and(|v| v < 0.0)).unwrap();
            for _ in 0..6 {
                let up = (0..rows.rows()).find(|&r| rows.get(r, here) == -1.0).unwrap();
                here = rows.row(up).0.iter().map(|&c| c as usize).find(|&c| c != here).unwrap();
            }
            made.problem.fixed[here] = Some(-4.0);
            let objective = &mut made.problem.objective;
            objective.linear.iter_mut().for_each(|q| *q *= scale);
            objective.constant *= scale * scale;
            made.problem.fixed.iter_mut().flatten().for_each(|v| *v *= scale);
            let found = certificate(&made.problem);
            assert_certified(&made.problem, &found);
        }
    }
}

#[test]
fn a_contradiction_by_a_hair_ends_honestly() {
    for excess in [1e-3, 1e-6, 1e-9] {
        let problem = Problem {
            objective: distance(&[0.3, 0.9, 0.1, 0.4], &[1.0; 4]),
            fixed: vec![Some(1.0 + excess), None, None, Some(1.0)],
            constraints: order(4, &[(0, 1, 0.0), (1, 2, 0.0), (2, 3, 0.0)]),
        };
        let solution = solve(&problem, None, None, &Settings::default()).unwrap();
        match &solution.status {
            QpStatus::Infeasible(found) => assert_certified(&problem, found),
            // A violation of 1e-9 of the values lies within the tolerance of 1e-8.
            QpStatus::Solved => assert!(excess < 1e-8, "{excess}"),
            QpStatus::IterationLimit | QpStatus::Stalled => {}
            QpStatus::CutOff => panic!("no cutoff was asked for"),
        }
    }
}

#[test]
fn a_single_feasible_point_is_found_or_left_honestly() {
    let problem = Problem {
        objective: distance(&[0.3, 0.9, 0.1, 0.4], &[1.0; 4]),
        fixed: vec![Some(1.0), None, None, Some(1.0)],
        constraints: order(4, &[(0, 1, 0.0), (1, 2, 0.0), (2, 3, 0.0)]),
    };
    let solution = solve(&problem, None, None, &Settings::default()).unwrap();
    assert!(!matches!(solution.status, QpStatus::Infeasible(_)));
    assert!(solution.x.iter().all(|x| (x - 1.0).abs() < 1e-3), "{:?}", solution.x);
}

#[test]
fn iterations_run_out_and_say_so() {
    let made = instance(20, 2, Case::Data, 1);
    let mut engine = Engine::new(&made.problem.objective, None, None).unwrap();
    let settings = Settings { max_iterations: 2, ..Settings::default() };
    let mut seen = Vec::new();
    let solution = engine.solve(&made.problem, Some(&made.start), &settings, &mut |p| seen.push(p)).unwrap();
    assert_eq!((solution.status, solution.iterations), (QpStatus::IterationLimit, 2));
    assert_eq!(seen.iter().map(|p| p.iteration).collect::<Vec<_>>(), [0, 1, 2]);
    assert!(solution.kkt.duality_gap > 1e-8);
}

#[test]
fn what_no_double_can_reach_is_not_called_solved() {
    let made = instance(20, 2, Case::Data, 1);
    let mut engine = Engine::new(&made.problem.objective, None, None).unwrap();
    let settings = Settings { relative_gap: 1e-30, ..Settings::default() };
    let solution = engine.solve(&made.problem, Some(&made.start), &settings, &mut |_| {}).unwrap();
    assert!(matches!(solution.status, QpStatus::Stalled | QpStatus::IterationLimit), "{:?}", solution.status);
    assert!(solution.kkt.duality_gap < 1e-8 && solution.iterations < 100);
}

/// Appends `width` of room around the start at one free unknown: the start stays strictly feasible, by half of it.
fn squeezed(made: &Instance, unknown: usize, width: f64) -> Problem {
    let mut problem = made.problem.clone();
    let rows = &problem.constraints.matrix;
    let mut triplets = Vec::new();
    for row in 0..rows.rows() {
        let (columns, values) = rows.row(row);
        triplets.extend(columns.iter().zip(values).map(|(&column, &value)| (row as u32, column, value)));
    }
    let mut offset = problem.constraints.offset.clone();
    for sign in [1.0, -1.0] {
        triplets.push((offset.len() as u32, unknown as u32, sign));
        offset.push(0.5 * width - sign * made.start[unknown]);
    }
    let matrix = CsrMatrix::from_triplets(offset.len(), problem.fixed.len(), &triplets).unwrap();
    problem.constraints = Constraints::nonnegative(matrix, offset);
    problem
}

#[test]
fn a_start_with_hardly_any_room_in_a_row_does_not_stall() {
    for k in [1, 2, 3] {
        let made = instance(20, k, Case::Data, 1);
        let unknown = (0..made.start.len()).filter(|&i| made.problem.fixed[i].is_none()).nth(100).unwrap();
        for width in [1e-3, 1e-6, 1e-9, 1e-11, 1e-12, 1e-13, 1e-14] {
            let problem = squeezed(&made, unknown, width);
            let mut engine = Engine::new(&problem.objective, Some(&problem.constraints.matrix), None).unwrap();
            let mut seen = Vec::new();
            let solution =
                engine.solve(&problem, Some(&made.start), &Settings::default(), &mut |p| seen.push(p.iteration)).unwrap();
            assert_eq!(solution.status, QpStatus::Solved, "k = {k}, width {width:e}: {:?}", solution.kkt);
            assert!((solution.x[unknown] - made.start[unknown]).abs() < 0.5 * width + 1e-6);
            assert!(seen.windows(2).all(|pair| pair[0] < pair[1]) && solution.iterations < 60, "{seen:?}");
        }
    }
}
