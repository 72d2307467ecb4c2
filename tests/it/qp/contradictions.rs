//! Blocks that contradict each other are named, with a proof that is checked here.

use morsmooth::qp::{Certificate, Engine, Problem, QpStatus, Settings, Solution};

use super::blocks::eigenvalues;
use super::scenes::{Scene, bent, swirl, turned_triangle};

fn solve_scene(scene: &Scene) -> Solution {
    let coupling = scene.problem.constraints.coupling();
    let mut engine = Engine::new(&scene.problem.objective, Some(&coupling), Some(&scene.coordinates)).unwrap();
    engine.solve(&scene.problem, None, &Settings::default(), &mut |_| {}).unwrap()
}

fn named(solution: &Solution) -> &Certificate {
    match &solution.status {
        QpStatus::Infeasible(certificate) => certificate,
        other => panic!("{other:?} after {} iterations, {:?}", solution.iterations, solution.kkt),
    }
}

/// Recomputes what a certificate claims.
fn assert_certified(problem: &Problem, solution: &Solution) {
    let certificate = named(solution);
    let constraints = &problem.constraints;
    let mut ray = certificate.ray.clone();
    ray.resize(constraints.offset.len(), 0.0);
    assert!(eigenvalues(constraints, &ray).iter().all(|&least| least >= -1e-12), "the ray leaves the cone");
    let image = constraints.matrix.transpose().multiply(&ray);
    let mut conflict: f64 = constraints.offset.iter().zip(&ray).map(|(b, y)| b * y).sum();
    let mut residual = 0.0f64;
    for (image, fixed) in image.iter().zip(&problem.fixed) {
        match fixed {
            Some(value) => conflict += image * value,
            None => residual = residual.max(image.abs()),
        }
    }
    assert!(conflict < 0.0 && (conflict - certificate.conflict).abs() < 1e-9 * conflict.abs());
    assert!(residual <= certificate.residual * 1.01 + 1e-12, "{residual:e} {:e}", certificate.residual);
    if certificate.least_objective.is_none() {
        // Forces times the size of the scene are comparable with the conflict.
        let reach = solution.x.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        assert!(residual * reach < 1e-3 * -conflict, "conflict {conflict:e}, residual {residual:e}");
    }
    assert!(certificate.constraints.is_sorted() && certificate.multipliers.iter().all(|&y| y > 0.0 && y <= 1.0));
}

#[test]
fn one_triangle_turned_against_its_neighbours_is_named() {
    for side in [4, 20, 40] {
        let (scene, chosen) = turned_triangle(side, 180.0);
        let solution = solve_scene(&scene);
        let found = named(&solution);
        assert_certified(&scene.problem, &solution);
        let heaviest = (0..found.constraints.len()).max_by(|&a, &b| found.multipliers[a].total_cmp(&found.multipliers[b])).unwrap();
        assert_eq!(found.constraints[heaviest], chosen, "{side}");
        assert!(found.relaxations.is_empty() || found.relaxations.iter().any(|&(block, _)| block == chosen));
        // A feasible scene of this kind takes eight to eleven.
        assert!(solution.factorizations <= 30, "{side}: {}", solution.factorizations);
    }
}

#[test]
fn turns_that_no_mesh_of_this_size_allows_are_named() {
    let scene = swirl(20, 720.0);
    let solution = solve_scene(&scene);
    let found = named(&solution);
    assert_certified(&scene.problem, &solution);
    // What had to give way lies at the disc.
    assert!(!found.constraints.is_empty());
}

#[test]
fn the_scale_of_a_contradiction_does_not_matter() {
    for (length, force) in [(1e-8, 1.0), (1e8, 1.0), (1.0, 1e-8), (1.0, 1e8)] {
        let (mut scene, chosen) = turned_triangle(10, 180.0);
        let objective = &mut scene.problem.objective;
        let morsmooth::qp::Term::Matrix(form) = &objective.terms[0] else { unreachable!("one matrix") };
        let form = form.weighted_product(&vec![force; form.rows()], &identity(form.rows()));
        objective.terms[0] = morsmooth::qp::Term::Matrix(form);
        objective.linear.iter_mut().for_each(|q| *q *= force * length);
        objective.constant *= force * length * length;
        scene.problem.constraints.offset.iter_mut().for_each(|b| *b *= length);
        let solution = solve_scene(&scene);
        let found = named(&solution);
        assert_certified(&scene.problem, &solution);
        assert!(found.constraints.contains(&chosen));
    }
}

fn identity(size: usize) -> morsmooth::linalg::CsrMatrix {
    let triplets: Vec<(u32, u32, f64)> = (0..size as u32).map(|i| (i, i, 1.0)).collect();
    morsmooth::linalg::CsrMatrix::from_triplets(size, size, &triplets).unwrap()
}

#[test]
fn nearly_contradicting_blocks_end_honestly() {
    for degrees in [170.0, 179.0, 179.5, 179.9, 179.95, 179.99, 179.999] {
        let (scene, chosen) = turned_triangle(10, degrees);
        let solution = solve_scene(&scene);
        match &solution.status {
            QpStatus::Infeasible(found) => {
                assert!(degrees > 179.8);
                assert_certified(&scene.problem, &solution);
                assert!(found.constraints.contains(&chosen));
            }
            QpStatus::Solved => assert!(solution.kkt.duality_gap <= 1e-8 && solution.kkt.primal <= 1e-8),
            QpStatus::Stalled | QpStatus::IterationLimit => assert!(degrees > 179.2, "{degrees}: {:?}", solution.kkt),
            QpStatus::CutOff => panic!("no cutoff was asked for"),
        }
    }
}

#[test]
fn a_feasible_bar_is_never_called_infeasible() {
    for degrees in [90.0, 300.0, 500.0] {
        assert_eq!(solve_scene(&bent(10, 3, degrees)).status, QpStatus::Solved, "{degrees}");
    }
}
