//! Whole solves: both methods, no inversions in either precision, previews, contradictions.

use super::scenes::{self, Scene};
use morsmooth::deform::{DeformError, DeformOptions, Deformer, Hold};
use morsmooth::qp::{Engine, Penalty, PenaltyOptions, Problem, QpStatus, Settings, Solution};

fn scenes() -> Vec<(&'static str, Scene)> {
    vec![
        ("quad", scenes::quad(12)),
        ("swirl 150", scenes::swirl(12, 150.0)),
        ("ball", scenes::ball(6)),
        ("bar", scenes::bar(10, 2, 170.0)),
    ]
}

fn engine(deformer: &Deformer, problem: &Problem) -> Engine {
    Engine::new(&problem.objective, Some(&problem.constraints.coupling()), Some(&deformer.coordinates())).unwrap()
}

/// Positions of a solution.
fn places(scene: &Scene, deformer: &Deformer, displacements: &[f64]) -> Vec<f64> {
    deformer.positions(&scene.targets, displacements).unwrap()
}

fn by_penalty(deformer: &Deformer, problem: &Problem, penalty: Penalty) -> Solution {
    let options = PenaltyOptions { weights: Some(deformer.rest().measures().to_vec()), ..PenaltyOptions::with(penalty) };
    engine(deformer, problem).solve_penalty(problem, None, &Settings::default(), &options, &mut |_| {}).unwrap()
}

fn by_interior_point(deformer: &Deformer, problem: &Problem) -> Solution {
    engine(deformer, problem).solve(problem, None, &Settings::default(), &mut |_| {}).unwrap()
}

/// The smallest determinant, and the smallest after rounding to single precision.
fn determinants(deformer: &Deformer, x: &[f64]) -> (f64, f64) {
    let rounded: Vec<f64> = x.iter().map(|&x| f64::from(x as f32)).collect();
    let least = |x: &[f64]| deformer.rest().determinants(x).unwrap().into_iter().fold(f64::INFINITY, f64::min);
    (least(x), least(&rounded))
}

#[test]
fn both_methods_end_without_inversions_at_the_same_energy() {
    for (name, scene) in scenes() {
        for options in [DeformOptions::default(), DeformOptions { incompressibility: 0.3, ..DeformOptions::default() }] {
            let deformer = scene.deformer(options);
            let problem = deformer.problem(&scene.rotations, &scene.targets).unwrap();
            let free = engine(&deformer, &problem).minimise(&problem.objective, &problem.fixed).unwrap();
            assert!(determinants(&deformer, &places(&scene, &deformer, &free.x)).0 < 0.0, "{name}: the scene inverts nothing without cones");
            let exact = by_interior_point(&deformer, &problem);
            assert_eq!(exact.status, QpStatus::Solved, "{name} {:?}", exact.kkt);
            let exact_places = places(&scene, &deformer, &exact.x);
            let energy = |x: &[f64]| deformer.energy(&scene.rotations, &scene.targets, x).unwrap().total();
            for solution in [by_penalty(&deformer, &problem, Penalty::Quadratic), exact.clone()] {
                assert_eq!(solution.status, QpStatus::Solved, "{name} {:?}", solution.kkt);
                let x = places(&scene, &deformer, &solution.x);
                let (least, rounded) = determinants(&deformer, &x);
                assert!(least > 0.0 && rounded > 0.0, "{name}: {least} {rounded}");
                let off = (energy(&x) - energy(&exact_places)).abs() / energy(&exact_places);
                assert!((solution.objective / energy(&x) - 1.0).abs() < 1e-9, "{name}: the objective is the energy");
                assert!(off < 1e-6, "{name}: {off}");
                let margins = deformer.margins(&scene.targets);
                let smallest = deformer.rest().smallest_eigenvalues(&scene.rotations, &x).unwrap();
                let worst = smallest.iter().zip(&margins).map(|(least, margin)| least - margin).fold(f64::INFINITY, f64::min);
                assert!(worst > -1e-7, "{name}: {worst}");
            }
        }
    }
}

#[test]
fn the_three_penalties_end_at_the_same_energy() {
    for (name, scene) in [("quad", scenes::quad(8)), ("bar", scenes::bar(10, 2, 170.0))] {
        let deformer = scene.deformer(DeformOptions::default());
        let problem = deformer.problem(&scene.rotations, &scene.targets).unwrap();
        let energies = [Penalty::Quadratic, Penalty::Cubic, Penalty::Spline].map(|penalty| {
            let solution = by_penalty(&deformer, &problem, penalty);
            assert_eq!(solution.status, QpStatus::Solved, "{name} {penalty:?} {:?}", solution.kkt);
            solution.objective
        });
        assert!(energies.iter().all(|energy| (energy / energies[0] - 1.0).abs() < 1e-6), "{name} {energies:?}");
    }
}

#[test]
fn hard_handles_are_met_exactly() {
    for scene in [scenes::quad(8), scenes::bar(8, 2, 60.0)] {
        let deformer = scene.deformer(DeformOptions { hold: Hold::Hard, ..DeformOptions::default() });
        let problem = deformer.problem(&scene.rotations, &scene.targets).unwrap();
        let solution = by_penalty(&deformer, &problem, Penalty::Quadratic);
        // The triangles between held vertices move with them; if those contradict the cones it must be said.
        let x = places(&scene, &deformer, &solution.x);
        match solution.status {
            QpStatus::Solved => assert!(determinants(&deformer, &x).0 > 0.0),
            QpStatus::Infeasible(_) => {}
            other => panic!("{other:?} {:?}", solution.kkt),
        }
        let dimension = deformer.rest().dimension();
        for (vertex, target) in scene.handles.iter().zip(&scene.targets) {
            assert_eq!(x[vertex.index() * dimension..][..dimension], target[..dimension]);
        }
    }
}

#[test]
fn neighbours_turned_against_each_other_are_never_solved() {
    let mut scene = scenes::quad(6);
    scene.targets = scene.handles.iter().map(|vertex| scene.complex.points()[vertex.index()]).collect();
    let count = scene.complex.simplex_count();
    scene.rotations = vec![scenes::turn(0.0); count];
    let culprit = count / 2 + 1;
    scene.rotations[culprit] = scenes::turn(std::f64::consts::PI);
    let deformer = scene.deformer(DeformOptions::default());
    let problem = deformer.problem(&scene.rotations, &scene.targets).unwrap();
    for solution in [by_penalty(&deformer, &problem, Penalty::Quadratic), by_interior_point(&deformer, &problem)] {
        assert_ne!(solution.status, QpStatus::Solved);
        if let QpStatus::Infeasible(certificate) = solution.status {
            assert!(certificate.constraints.contains(&culprit), "{:?}", certificate.constraints);
        }
    }
}

#[test]
fn a_missing_handle_is_refused_where_an_island_floats() {
    let mut scene = scenes::quad(4);
    let mut points = scene.complex.points().to_vec();
    let first = points.len() as u32;
    points.extend([[3.0, 0.0, 0.0], [4.0, 0.0, 0.0], [3.0, 1.0, 0.0]]);
    let mut simplices = scene.complex.simplices().to_vec();
    simplices.extend([first, first + 1, first + 2]);
    scene.complex = morsmooth::mesh::SimplicialComplex::new(2, points, simplices).unwrap();
    let found = Deformer::new(&scene.complex, &scene.handles, DeformOptions::default()).map(|_| ());
    assert_eq!(found, Err(DeformError::NoHandle { vertex: (first as usize).into() }));
}
