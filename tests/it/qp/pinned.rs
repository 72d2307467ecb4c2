//! Minimisers without rows: accuracy, many right-hand sides, new weights and new fixed sets on one analysis.

use morsmooth::qp::{Constraints, Engine, Objective, Problem, Term};

use super::agreement::gradient_in_double;
use super::problems::{Case, instance};

#[test]
fn minimisers_are_exact_to_rounding_for_every_order() {
    for k in 1..=4 {
        let made = instance(50, k, Case::Data, 11);
        let Problem { objective, fixed, .. } = &made.problem;
        let mut engine = Engine::new(objective, None, Some(&made.coordinates)).unwrap();
        let minimum = engine.minimise(objective, fixed).unwrap();
        let bare = Problem { constraints: Constraints::none(fixed.len()), ..made.problem.clone() };
        let gradient = gradient_in_double(&bare, &minimum.x, &[]);
        let most = |fixed_ones: bool| {
            gradient.iter().zip(fixed).filter(|(_, f)| f.is_some() == fixed_ones).fold(0.0f64, |m, (g, _)| m.max(g.abs()))
        };
        assert!(most(false) <= 1e-9 * most(true), "{k}: {:e} of {:e}", most(false), most(true));
        assert!(minimum.stationarity <= 1e-9);
        assert!(fixed.iter().zip(&minimum.x).all(|(f, x)| f.is_none_or(|f| f == *x)));
    }
}

#[test]
fn one_engine_serves_new_weights_and_new_fixed_unknowns() {
    let made = instance(30, 2, Case::Data, 2);
    let Problem { objective, fixed, .. } = &made.problem;
    let mut engine = Engine::new(objective, None, Some(&made.coordinates)).unwrap();
    for (factor, pins) in [(1.0, true), (100.0, true), (0.01, false), (1.0, true)] {
        let mut changed = objective.clone();
        if let Term::Chain { scale, .. } = &mut changed.terms[0] {
            *scale *= factor;
        }
        let pins: Vec<Option<f64>> = if pins { fixed.clone() } else { vec![None; fixed.len()] };
        let reused = engine.minimise(&changed, &pins).unwrap();
        let fresh = Engine::new(&changed, None, Some(&made.coordinates)).unwrap().minimise(&changed, &pins).unwrap();
        assert_eq!(reused.x, fresh.x, "same matrix, same factor, same bits");
    }
}

#[test]
fn many_sides_are_solved_as_one_by_one() {
    let made = instance(25, 3, Case::Data, 4);
    let Problem { objective, fixed, .. } = &made.problem;
    let n = fixed.len();
    let mut engine = Engine::new(objective, None, None).unwrap();
    let mut pinned = engine.pin(objective, fixed).unwrap();
    let sides: Vec<f64> = (0..19 * n).map(|i| (i as f64 * 0.37).sin()).collect();
    let mut together = sides.clone();
    assert!(pinned.solve(&mut together).unwrap() < 1e-11);
    for (side, solution) in sides.chunks(n).zip(together.chunks(n)) {
        let mut alone = side.to_vec();
        pinned.solve(&mut alone).unwrap();
        let size = alone.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        assert!(alone.iter().zip(solution).all(|(a, b)| (a - b).abs() <= 1e-11 * size));
        assert!(fixed.iter().zip(solution).all(|(f, x)| f.is_none() || *x == 0.0));
    }
}

#[test]
fn a_form_with_a_null_space_is_shifted_and_still_minimised() {
    // Nothing pins the constants of this chain, and the linear term does not push them.
    let chain = Term::Chain { scale: 1.0, stiffness: super::path_laplacian(10), weights: vec![1.0; 10], order: 2 };
    let mut linear = vec![0.0; 10];
    (linear[2], linear[7]) = (1.0, -1.0);
    let objective = Objective { terms: vec![chain], linear, constant: 0.0 };
    let minimum = Engine::new(&objective, None, None).unwrap().minimise(&objective, &[None; 10]).unwrap();
    assert!(minimum.stationarity < 1e-8, "{minimum:?}");
}
