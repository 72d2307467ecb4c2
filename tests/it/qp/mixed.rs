//! The two forms of the linear systems against each other.

use morsmooth::linalg::CsrMatrix;
use morsmooth::qp::{Engine, KktForm, Objective, Problem, QpStatus, Settings, Term};

use super::problems::{Case, instance};

fn largest_difference(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
}

#[test]
fn both_forms_find_the_same_minimisers() {
    for k in 2..=4 {
        for case in [Case::Data, Case::NoData] {
            let made = instance(31, k, case, 5);
            let Problem { objective, fixed, .. } = &made.problem;
            let [formed, mixed] = [KktForm::Formed, KktForm::Mixed].map(|form| {
                let mut engine = Engine::in_form(objective, None, Some(&made.coordinates), form).unwrap();
                assert_eq!(engine.is_mixed(), form == KktForm::Mixed);
                engine.minimise(objective, fixed).unwrap()
            });
            assert!((formed.objective - mixed.objective).abs() <= 1e-12 * formed.objective, "{k} {case:?}");
            assert!(largest_difference(&formed.x, &mixed.x) < 1e-9, "{k} {case:?}: {}", largest_difference(&formed.x, &mixed.x));
            // Without data at order 4 the forces themselves are near the rounding of the gradient.
            assert!(mixed.stationarity <= f64::max(1e-9, 10.0 * formed.stationarity));
        }
    }
}

#[test]
fn both_forms_find_the_same_optima() {
    for k in 2..=4 {
        for case in [Case::Data, Case::NoData] {
            let made = instance(25, k, case, 3);
            let settings = Settings { relative_gap: 1e-10, ..Settings::default() };
            let [formed, mixed] = [KktForm::Formed, KktForm::Mixed].map(|form| {
                let mut engine = Engine::in_form(&made.problem.objective, None, Some(&made.coordinates), form).unwrap();
                let solution = engine.solve(&made.problem, Some(&made.start), &settings, &mut |_| {}).unwrap();
                assert_eq!(solution.status, QpStatus::Solved, "{k} {case:?} {form:?} {:?}", solution.kkt);
                solution
            });
            // Each lies within its gap above the optimum.
            assert!((formed.objective - mixed.objective).abs() <= 3e-10 * formed.objective, "{k} {case:?}");
        }
    }
}

#[test]
fn the_mixed_form_is_taken_where_rounding_would_win() {
    let is_mixed = |side: usize, k: usize, case: Case| {
        let made = instance(side, k, case, 3);
        Engine::new(&made.problem.objective, None, Some(&made.coordinates)).unwrap().is_mixed()
    };
    assert!(!is_mixed(40, 2, Case::NoData));
    assert!(!is_mixed(40, 3, Case::NoData));
    assert!(!is_mixed(110, 4, Case::Data));
    assert!(is_mixed(110, 4, Case::NoData));
}

#[test]
fn without_digits_in_the_formed_matrix_the_mixed_form_still_solves() {
    let made = instance(110, 4, Case::NoData, 3);
    let Problem { objective, fixed, .. } = &made.problem;
    // Numbered backwards, everything is eliminated in another order with other rounding.
    let minimum = |backwards: bool| {
        let mut objective = objective.clone();
        let mut fixed = fixed.clone();
        let Term::Chain { stiffness, weights, .. } = &mut objective.terms[0] else { panic!("the chain comes first") };
        if backwards {
            let n = weights.len() as u32;
            let mirrored: Vec<(u32, u32, f64)> = (0..n)
                .flat_map(|row| {
                    let (columns, values) = stiffness.row(row as usize);
                    columns.iter().zip(values).map(move |(&column, &value)| (n - 1 - row, n - 1 - column, value)).collect::<Vec<_>>()
                })
                .collect();
            *stiffness = CsrMatrix::from_triplets(n as usize, n as usize, &mirrored).unwrap();
            weights.reverse();
            fixed.reverse();
        }
        Engine::in_form(&objective, None, None, KktForm::Mixed).unwrap().minimise(&objective, &fixed).unwrap().objective
    };
    let (one, other) = (minimum(false), minimum(true));
    assert!((one - other).abs() <= 1e-8 * one, "{one:e} {other:e}");
    let mut engine = Engine::in_form(objective, None, Some(&made.coordinates), KktForm::Mixed).unwrap();
    let solution = engine.solve(&made.problem, Some(&made.start), &Settings::default(), &mut |_| {}).unwrap();
    assert_eq!(solution.status, QpStatus::Solved, "{:?}", solution.kkt);
    assert!(solution.objective >= one * (1.0 - 1e-8));
}

#[test]
fn one_engine_factors_one_matrix_after_another() {
    let made = instance(31, 4, Case::NoData, 5);
    let Problem { objective, fixed, .. } = &made.problem;
    let n = fixed.len();
    let other = Objective {
        terms: vec![Term::Diagonal((0..n).map(|unknown| 1.0 + (unknown % 7) as f64).collect())],
        linear: (0..n).map(|unknown| (unknown as f64).sin()).collect(),
        constant: 0.0,
    };
    let fresh = || Engine::in_form(objective, None, Some(&made.coordinates), KktForm::Mixed).unwrap();
    let mut engine = fresh();
    engine.minimise(objective, fixed).unwrap();
    assert_eq!(engine.factor_and_solve(&other, fixed).unwrap(), fresh().factor_and_solve(&other, fixed).unwrap());
}

#[test]
fn scales_and_units_leave_the_mixed_form_as_it_is() {
    let made = instance(31, 4, Case::Data, 5);
    let solve = |objective: &Objective| {
        let mut engine = Engine::in_form(objective, None, Some(&made.coordinates), KktForm::Mixed).unwrap();
        engine.minimise(objective, &made.problem.fixed).unwrap().x
    };
    let plain = solve(&made.problem.objective);
    for factor in [1e-12, 1e12] {
        let mut changed = made.problem.objective.clone();
        for term in &mut changed.terms {
            match term {
                // The same problem with a unit of length whose square is `factor`, and an energy scaled at will.
                Term::Chain { scale, weights, .. } => {
                    weights.iter_mut().for_each(|weight| *weight /= factor);
                    *scale *= factor.powi(3) * 7.0;
                }
                Term::Diagonal(diagonal) => diagonal.iter_mut().for_each(|value| *value *= 7.0),
                Term::Matrix(_) => {}
            }
        }
        changed.linear.iter_mut().for_each(|value| *value *= 7.0);
        assert!(largest_difference(&solve(&changed), &plain) < 1e-8);
    }
}

#[test]
fn a_mixed_engine_serves_objectives_without_its_chain() {
    let made = instance(31, 3, Case::Data, 5);
    let Problem { objective, fixed, .. } = &made.problem;
    let mut mixed = Engine::in_form(objective, None, None, KktForm::Mixed).unwrap();
    mixed.minimise(objective, fixed).unwrap();
    let Term::Chain { stiffness, .. } = &objective.terms[0] else { panic!("the chain comes first") };
    let harmonic = Objective { terms: vec![Term::Matrix(stiffness.clone())], linear: objective.linear.clone(), constant: 0.0 };
    let there = mixed.minimise(&harmonic, fixed).unwrap();
    let here = Engine::new(&harmonic, None, None).unwrap().minimise(&harmonic, fixed).unwrap();
    assert!(largest_difference(&there.x, &here.x) < 1e-9);
    // And back, with some fixed unknowns let go.
    let fewer: Vec<Option<f64>> = fixed.iter().enumerate().map(|(i, f)| if i % 2 == 0 { *f } else { None }).collect();
    let again = mixed.minimise(objective, &fewer).unwrap();
    let fresh = Engine::in_form(objective, None, None, KktForm::Formed).unwrap().minimise(objective, &fewer).unwrap();
    assert!(largest_difference(&again.x, &fresh.x) < 1e-9);
}
