//! The methods of comparison: where they must end, and that they say how they ended.

use super::scenes::{self, Scene};
use morsmooth::deform::{
    AugmentedOptions, Barrier, BarrierOptions, Comparison, DeformError, DeformOptions, Deformer, DetPenaltyOptions, Ending, Hold, Lagrangian,
};
use morsmooth::qp::{Engine, QpStatus, Settings};

fn scenes() -> Vec<(&'static str, Scene)> {
    vec![("quad", scenes::quad(10)), ("swirl 120", scenes::swirl(10, 120.0)), ("ball", scenes::ball(6))]
}

fn options() -> [DeformOptions; 2] {
    [0.0, 0.3].map(|incompressibility| DeformOptions { incompressibility, ..DeformOptions::default() })
}

fn on<'a>(deformer: &'a Deformer, scene: &'a Scene) -> Comparison<'a> {
    Comparison::new(deformer, &scene.rotations, &scene.targets).unwrap()
}

fn engine(deformer: &Deformer, problem: &morsmooth::qp::Problem) -> Engine {
    Engine::new(&problem.objective, Some(&problem.constraints.coupling()), Some(&deformer.coordinates())).unwrap()
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_ex_rotated_shape_is_the_minimiser_without_rows() {
    for (name, scene) in scenes() {
        for hold in [Hold::Soft { alpha: 1e4 }, Hold::Hard] {
            for given in options() {
                let deformer = scene.deformer(DeformOptions { hold, ..given });
                let problem = deformer.problem(&scene.rotations, &scene.targets).unwrap();
                let free = engine(&deformer, &problem).minimise(&problem.objective, &problem.fixed).unwrap();
                let places = deformer.positions(&scene.targets, &free.x).unwrap();
                let found = on(&deformer, &scene).ex_rotated().unwrap();
                assert!(apart(&found.positions, &places) < 1e-9, "{name} {:e}", apart(&found.positions, &places));
                let determinants = deformer.rest().determinants(&found.positions).unwrap();
                assert_eq!(found.inverted, (0..determinants.len()).filter(|&i| determinants[i] <= 0.0).collect::<Vec<_>>());
                assert!(!found.inverted.is_empty(), "{name}: the scene inverts nothing");
                assert_eq!(found.iterations, 1);
            }
        }
    }
}

#[test]
fn augmented_lagrangians_end_at_the_optimum_of_the_interior_point() {
    for (name, scene) in scenes() {
        for given in options() {
            let deformer = scene.deformer(given);
            let problem = deformer.problem(&scene.rotations, &scene.targets).unwrap();
            let exact = engine(&deformer, &problem).solve(&problem, None, &Settings::default(), &mut |_| {}).unwrap();
            assert_eq!(exact.status, QpStatus::Solved);
            for kind in [Lagrangian::Spectral, Lagrangian::Pennon] {
                let mut steps = Vec::new();
                let found = on(&deformer, &scene).augmented(&AugmentedOptions::new(kind), &mut |step, _| steps.push(step)).unwrap();
                assert_eq!(found.ending, Ending::Converged, "{name} {kind:?}");
                let off = (found.energy.total() / exact.objective - 1.0).abs();
                assert!(off < 1e-5, "{name} {kind:?} {off:e}");
                assert_eq!((steps.len(), *steps.last().unwrap()), (found.iterations, found.iterations));
                let smallest = deformer.rest().smallest_eigenvalues(&scene.rotations, &found.positions).unwrap();
                assert!(smallest.iter().all(|value| *value > -1e-6), "{name} {kind:?}");
            }
        }
    }
}

#[test]
fn a_barrier_never_lets_an_element_through() {
    for (name, scene) in scenes() {
        let deformer = scene.deformer(DeformOptions::default());
        for barrier in [Barrier::Logarithm, Barrier::Reciprocal] {
            let options = BarrierOptions { barrier, max_iterations: 150, ..BarrierOptions::default() };
            let mut least = f64::INFINITY;
            let found = on(&deformer, &scene)
                .locally_injective(&options, &mut |_, x| {
                    least = deformer.rest().determinants(x).unwrap().into_iter().fold(least, f64::min);
                })
                .unwrap();
            assert!(least > 0.0 && found.inverted.is_empty(), "{name} {barrier:?} {least}");
            assert!(found.iterations <= 150 && found.rounds <= 10);
        }
    }
}

#[test]
fn a_barrier_of_no_weight_on_an_easy_scene_ends_where_the_energy_does() {
    // Nothing is inverted by this pose, so that all methods but the barrier's bias agree.
    let mut scene = scenes::quad(8);
    let rest: Vec<[f64; 3]> = scene.handles.iter().map(|vertex| scene.complex.points()[vertex.index()]).collect();
    for (target, place) in scene.targets.iter_mut().zip(rest) {
        *target = std::array::from_fn(|axis| place[axis] + 0.05 * (target[axis] - place[axis]));
    }
    scene.rotations.fill(scenes::turn(0.0));
    let deformer = scene.deformer(DeformOptions::default());
    let free = on(&deformer, &scene).ex_rotated().unwrap();
    assert!(free.inverted.is_empty());
    let weak = BarrierOptions { weight: 1e-9, ..BarrierOptions::default() };
    let barrier = on(&deformer, &scene).locally_injective(&weak, &mut |_, _| {}).unwrap();
    let penalty = on(&deformer, &scene).det_penalty(&DetPenaltyOptions::default(), &mut |_, _| {}).unwrap();
    for found in [barrier, penalty] {
        assert_eq!(found.ending, Ending::Converged);
        assert!(apart(&found.positions, &free.positions) < 1e-6, "{:e}", apart(&found.positions, &free.positions));
    }
}

#[test]
fn iteration_limits_are_told() {
    let scene = scenes::swirl(10, 170.0);
    let deformer = scene.deformer(DeformOptions::default());
    let comparison = on(&deformer, &scene);
    let few = 4;
    let ends = [
        comparison.det_penalty(&DetPenaltyOptions { max_iterations: few, ..Default::default() }, &mut |_, _| {}).unwrap(),
        comparison.locally_injective(&BarrierOptions { max_iterations: few, ..Default::default() }, &mut |_, _| {}).unwrap(),
        comparison.augmented(&AugmentedOptions { max_iterations: few, ..AugmentedOptions::new(Lagrangian::Pennon) }, &mut |_, _| {}).unwrap(),
    ];
    for found in ends {
        assert_eq!((found.ending, found.iterations), (Ending::IterationLimit, few));
    }
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let scene = scenes::quad(4);
    let hard = scene.deformer(DeformOptions { hold: Hold::Hard, ..DeformOptions::default() });
    assert_eq!(on(&hard, &scene).locally_injective(&BarrierOptions::default(), &mut |_, _| {}), Err(DeformError::SoftHandles));
    let soft = scene.deformer(DeformOptions::default());
    for wrong in [0.0, -1.0, f64::NAN] {
        let options = BarrierOptions { weight: wrong, ..BarrierOptions::default() };
        assert!(matches!(on(&soft, &scene).locally_injective(&options, &mut |_, _| {}), Err(DeformError::Number { .. })));
        let options = DetPenaltyOptions { start: wrong, ..DetPenaltyOptions::default() };
        assert!(matches!(on(&soft, &scene).det_penalty(&options, &mut |_, _| {}), Err(DeformError::Number { .. })));
        let options = AugmentedOptions { start: wrong, ..AugmentedOptions::new(Lagrangian::Spectral) };
        assert!(matches!(on(&soft, &scene).augmented(&options, &mut |_, _| {}), Err(DeformError::Number { .. })));
    }
    assert!(matches!(Comparison::new(&soft, &scene.rotations[1..], &scene.targets), Err(DeformError::Length { .. })));
}
