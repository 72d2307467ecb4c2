//! The driver: certificates, both methods, refinement, warm starts, contradictions and what is done about them.

use super::scenes::{self, Load, Scene};
use morsmooth::deform::{
    Begin, Comparison, DeformError, DeformOptions, DeformSolver, DeformStatus, Deformed, FactorChoice, HeldVertices, Hold, OnContradiction, RestShape,
    SolveMethod, SolveOptions, Substitute,
};
use morsmooth::mesh::SimplicialComplex;
use morsmooth::qp::{Penalty, Settings};

fn solver(scene: &Scene, options: DeformOptions) -> DeformSolver {
    DeformSolver::new(&scene.complex, HeldVertices::unnamed(scene.handles.clone()), options).unwrap()
}

fn solve(scene: &Scene, options: &SolveOptions) -> Deformed {
    solver(scene, DeformOptions::default()).solve(&scene.rotations, &scene.targets, options, &mut |_| {}).unwrap()
}

const HARD: DeformOptions = DeformOptions { hold: Hold::Hard, incompressibility: 0.0, margin: 2.0 };

fn keep_best() -> SolveOptions {
    SolveOptions { on_contradiction: OnContradiction::KeepBest, ..SolveOptions::default() }
}

#[test]
fn both_methods_end_certified_at_the_same_energy_with_consistent_evidence() {
    let scenes = [
        scenes::quad(10),
        scenes::swirl(12, 180.0),
        scenes::ball(6),
        scenes::bar(10, 2, 170.0),
        scenes::rod(10, 2, Load::Twist(200.0)),
        scenes::rod(10, 2, Load::Stretch(2.5)),
    ];
    for scene in scenes {
        let exact = solve(&scene, &SolveOptions::default());
        for penalty in [Penalty::Quadratic, Penalty::Cubic, Penalty::Spline] {
            let method = SolveMethod::Penalty(penalty);
            let other = solve(&scene, &SolveOptions { method, ..SolveOptions::default() });
            assert!(other.is_inversion_free() && other.is_certified(), "{:?} {:?}", other.status, other.certificate);
            assert!((other.energy.total() / exact.energy.total() - 1.0).abs() <= 1e-5);
        }
        assert!(exact.is_certified(), "{:?}", exact.status);
        assert!(exact.certificate.duality_gap <= 1e-6);
        assert!(exact.smallest_determinants().iter().all(|&least| least > 0.0));
        let least = exact.elements.determinants.iter().copied().fold(f64::INFINITY, f64::min);
        assert!((least / exact.smallest_determinants()[0] - 1.0).abs() < 1e-6, "the audit and the driver see the same shape");
        // A cone that holds an element back has no slack; an element with slack is not held back.
        let parts = exact.elements.active.iter().zip(&exact.elements.smallest_eigenvalues);
        assert!(parts.clone().all(|(&active, &least)| !active || least < 2e-3));
        for place in &exact.handles {
            assert!(place.distance < 0.05, "soft handles stay near: {place:?}");
        }
    }
}

/// A pinched ball whose elements shrink towards the ring that holds it, to a ten-thousandth of the largest volume.
fn graded() -> Scene {
    let scene = scenes::ball(8);
    let squeezed = |value: f64| 0.5 + (value - 0.5) * (0.05 + 3.8 * (value - 0.5).powi(2));
    let points = scene.complex.points().iter().map(|p| [p[0], p[1], squeezed(p[2])]).collect();
    let complex = SimplicialComplex::new(3, points, scene.complex.simplices().to_vec()).unwrap();
    let targets = scene.targets.iter().map(|p| [p[0], p[1], squeezed(p[2])]).collect();
    Scene { complex, targets, ..scene }
}

#[test]
fn a_graded_mesh_is_certified_from_whatever_start_it_takes() {
    let scene = graded();
    let measures = RestShape::new(&scene.complex).unwrap().measures().to_vec();
    let [least, most] = [f64::min, f64::max].map(|choose| measures.iter().copied().reduce(choose).unwrap());
    assert!(most > 10.0 * least, "{least} {most}");
    let exact = solve(&scene, &SolveOptions::default());
    assert!(exact.is_certified() && exact.is_inversion_free(), "{:?} {:?}", exact.status, exact.certificate);
    assert!(exact.effort.factorizations <= 30, "{:?}", exact.effort);
    // The same shape, all turned: the way out of a blockade is the rest shape turned likewise.
    let turn = scenes::turn(2.0);
    let turned = Scene {
        targets: scene.targets.iter().map(|&target| scenes::rotated(&turn, target)).collect(),
        rotations: vec![turn; scene.rotations.len()],
        ..graded()
    };
    let other = solve(&turned, &SolveOptions::default());
    assert!(other.is_certified(), "{:?} {:?}", other.status, other.certificate);
    assert!((other.energy.total() / exact.energy.total() - 1.0).abs() <= 2e-6);
}

#[test]
fn single_precision_ends_at_the_same_shape() {
    for scene in [scenes::quad(16), scenes::ball(6), scenes::bar(10, 2, 170.0)] {
        let double = solve(&scene, &SolveOptions::default());
        let mut solver = solver(&scene, DeformOptions::default());
        let (flops, [whole, half]) = solver.factor_cost();
        assert!(flops > 0.0 && whole.abs_diff(2 * half) <= 2);
        solver.choose_factor(FactorChoice::Automatic, whole - 1);
        assert_eq!(solver.precision(), morsmooth::qp::FactorPrecision::Single, "what does not fit is factored in single precision");
        let single = solver.solve(&scene.rotations, &scene.targets, &SolveOptions::default(), &mut |_| {}).unwrap();
        assert!(single.is_certified(), "{:?} {:?}", single.status, single.certificate);
        assert!((single.energy.total() / double.energy.total() - 1.0).abs() < 2e-6);
        solver.choose_factor(FactorChoice::Automatic, usize::MAX);
        assert_eq!(solver.precision(), morsmooth::qp::FactorPrecision::Double);
    }
}

#[test]
fn the_gap_is_proven_where_single_precision_leaves_a_residual() {
    for scene in [scenes::quad(16), scenes::ball(6), scenes::bar(10, 2, 170.0)] {
        let default = SolveOptions::default();
        // A residual that no factor in single precision reaches.
        let strict = SolveOptions { settings: Settings { residual: 1e-16, ..default.settings }, ..default };
        let mut solver = solver(&scene, DeformOptions::default());
        solver.choose_factor(FactorChoice::Single, 0);
        let proven = solver.solve(&scene.rotations, &scene.targets, &strict, &mut |_| {}).unwrap();
        let kkt = proven.certificate;
        assert!(proven.is_certified(), "{:?} {kkt:?}", proven.status);
        assert!(kkt.stationarity > kkt.rounding.max(1e-16) && kkt.duality_gap <= 1e-6, "{kkt:?}");
        let near = SolveOptions { settings: Settings { relative_gap: 1e-10, ..default.settings }, ..default };
        let least = solve(&scene, &near).energy.total();
        let bound = proven.energy.total() * (1.0 - kkt.duality_gap);
        assert!(bound <= least * (1.0 + 1e-10) && least <= proven.energy.total() * (1.0 + 1e-10), "{bound} {least}");
    }
}

#[test]
fn previews_end_at_the_result() {
    let scene = scenes::quad(8);
    for method in [SolveMethod::InteriorPoint, SolveMethod::Penalty(Penalty::Quadratic)] {
        let mut solver = solver(&scene, DeformOptions::default());
        let (mut count, mut last) = (0, Vec::new());
        let options = SolveOptions { method, ..SolveOptions::default() };
        let mut preview = |at: morsmooth::deform::DeformPreview<'_>| {
            assert_eq!(at.tau.is_some(), method != SolveMethod::InteriorPoint);
            count += 1;
            last = at.positions.to_vec();
        };
        let deformed = solver.solve(&scene.rotations, &scene.targets, &options, &mut preview).unwrap();
        assert!(count > 5, "{count}");
        let off = last.iter().zip(&deformed.positions).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-3, "{off}");
    }
}

#[test]
fn rotations_read_anew_lower_the_energy_and_keep_the_shape_feasible() {
    for scene in [scenes::swirl(12, 150.0), scenes::ball(6)] {
        let mut before = f64::INFINITY;
        for rounds in 0..4 {
            let deformed = solve(&scene, &SolveOptions { rounds, ..SolveOptions::default() });
            assert!(deformed.is_certified(), "{rounds} {:?}", deformed.status);
            assert_eq!(deformed.effort.problems, rounds + 1);
            let energy = deformed.energy.total();
            assert!(energy <= before * (1.0 + 1e-6), "{rounds}: {energy} {before}");
            before = energy;
        }
    }
}

#[test]
fn a_warm_start_ends_at_the_same_energy_in_fewer_factorizations() {
    let scene = scenes::quad(16);
    let mut solver = solver(&scene, DeformOptions::default());
    solver.solve(&scene.rotations, &scene.targets, &SolveOptions::default(), &mut |_| {}).unwrap();
    let rest = scene.complex.points();
    let moved: Vec<[f64; 3]> = scene
        .targets
        .iter()
        .zip(&scene.handles)
        .map(|(&[x, y, z], vertex)| if [x, y, z] == rest[vertex.index()] { [x, y, z] } else { [x + 0.001, y, z] })
        .collect();
    let options = SolveOptions { begin: Begin::Warm, ..SolveOptions::default() };
    let cold = solver.fork().solve(&scene.rotations, &moved, &options, &mut |_| {}).unwrap();
    let warm = solver.solve(&scene.rotations, &moved, &options, &mut |_| {}).unwrap();
    assert!(warm.is_certified() && cold.is_certified());
    assert!((warm.energy.total() / cold.energy.total() - 1.0).abs() < 2e-6);
    assert!(warm.effort.factorizations < cold.effort.factorizations, "{} {}", warm.effort.factorizations, cold.effort.factorizations);
}

#[test]
fn a_shape_that_only_moves_as_a_whole_is_certified_without_energy() {
    let soft = DeformOptions::default();
    for (scene, options) in [(scenes::quad(12), soft), (scenes::quad(12), HARD), (scenes::ball(5), soft), (scenes::bar(8, 2, 90.0), HARD)] {
        let turned = |angle: f64, shift: f64| {
            let matrix = scenes::turn(angle);
            let move_point = move |point: [f64; 3]| scenes::rotated(&matrix, point).map(|x| x + shift);
            (matrix, move_point)
        };
        for (angle, shift) in [(0.0, 0.0), (0.7, 3.0), (-2.0, 0.001)] {
            let (matrix, place) = turned(angle, shift);
            let rotations = vec![matrix; scene.rotations.len()];
            let targets: Vec<[f64; 3]> = scene.handles.iter().map(|&vertex| place(scene.complex.point(vertex))).collect();
            for begin in [Begin::Cold, Begin::Warm] {
                let mut solver = solver(&scene, options);
                let posed = solver.solve(&scene.rotations, &scene.targets, &SolveOptions::default(), &mut |_| {}).unwrap();
                assert!(posed.is_certified() && !posed.is_without_energy(), "{:?} {:?}", posed.status, posed.energy);
                let found = solver.solve(&rotations, &targets, &SolveOptions { begin, ..SolveOptions::default() }, &mut |_| {}).unwrap();
                assert!(found.is_certified() && found.is_without_energy(), "{angle} {begin:?} {:?} {:?}", found.status, found.energy);
                assert!((found.rest_measure - (0..rotations.len()).map(|e| scene.complex.measure(e)).sum::<f64>()).abs() < 1e-12);
                // In the plane the height stays that of the rest shape.
                let parts = scene.complex.dimension();
                let off = |(point, &rest): (&[f64; 3], &[f64; 3])| (0..parts).map(|axis| (point[axis] - place(rest)[axis]).abs()).fold(0.0, f64::max);
                let most = found.points.iter().zip(scene.complex.points()).map(off).fold(0.0, f64::max);
                assert!(most < if begin == Begin::Cold { 1e-12 } else { 1e-5 }, "{angle} {begin:?} {most}");
            }
        }
    }
}

#[test]
fn where_no_cone_holds_the_shape_back_one_linear_system_is_the_optimum() {
    let scene = scenes::swirl(12, 4.0);
    let found = solve(&scene, &SolveOptions::default());
    assert!(found.is_certified() && !found.is_without_energy());
    assert_eq!((found.effort.iterations, found.effort.factorizations), (0, 1));
    assert!(found.elements.active.iter().all(|active| !active));
    let deformer = scene.deformer(DeformOptions::default());
    let linear = Comparison::new(&deformer, &scene.rotations, &scene.targets).unwrap().ex_rotated().unwrap();
    let off = linear.positions.iter().zip(&found.positions).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-12, "{off}");
    // A stronger turn needs the cones.
    assert!(solve(&scenes::swirl(12, 180.0), &SolveOptions::default()).effort.iterations > 0);
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let scene = scenes::ball(6);
    let bits = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&scene, &SolveOptions::default()).positions.iter().map(|x| x.to_bits()).collect::<Vec<_>>())
    };
    assert_eq!(bits(1), bits(3));
}

#[test]
fn hard_handles_that_contradict_each_other_are_named_and_let_go_on_request() {
    // Two discs that swap places along a line, held hard on a coarse mesh: what lies between them must fold.
    let mut scene = scenes::quad(8);
    let points = scene.complex.points().to_vec();
    let near = |vertex: usize, x: f64| (points[vertex][0] - x).hypot(points[vertex][1] - 0.5) < 0.14;
    let (mut held, mut owners, mut targets) = (Vec::new(), Vec::new(), Vec::new());
    for (vertex, &[x, y, z]) in points.iter().enumerate() {
        for (owner, (at, to)) in [(0.25, 0.75), (0.75, 0.25)].into_iter().enumerate() {
            if near(vertex, at) {
                held.push(vertex.into());
                owners.push(owner);
                targets.push([x + to - at, y, z]);
            }
        }
    }
    scene.rotations.fill(scenes::turn(0.0));
    let held = HeldVertices { vertices: held, owners, names: vec!["left".into(), "right".into()] };
    let mut solver = DeformSolver::new(&scene.complex, held, HARD).unwrap();
    let refused = solver.solve(&scene.rotations, &targets, &SolveOptions::default(), &mut |_| {}).unwrap();
    let DeformStatus::Contradiction(blame) = &refused.status else { panic!("{:?} {:?}", refused.status, refused.certificate) };
    let mut names = blame.names.clone();
    names.sort();
    assert_eq!(names, ["left", "right"]);
    assert!(blame.is_of_handles && !blame.elements.is_empty());
    assert!(blame.to_string().contains("\"left\"") && blame.to_string().contains(&blame.elements[0].to_string()), "{blame}");
    let kept = solver.solve(&scene.rotations, &targets, &keep_best(), &mut |_| {}).unwrap();
    assert!(matches!(kept.status, DeformStatus::Contradiction(_)) && !kept.is_certified());
    assert_eq!(kept.substitute, Some(Substitute::SoftHandles));
    assert!(kept.is_inversion_free());
    assert!(kept.farthest_handle().unwrap().distance > 1e-3, "soft handles gave way");
}

#[test]
fn rotations_against_their_neighbours_are_blamed_and_read_anew_on_request() {
    let scene = scenes::lone(6, 180.0);
    let culprit = scene.complex.simplex_count() / 2 + 1;
    let refused = solve(&scene, &SolveOptions::default());
    let DeformStatus::Contradiction(blame) = &refused.status else { panic!("{:?}", refused.status) };
    assert!(blame.elements.contains(&culprit), "{blame}");
    assert!(!blame.is_of_handles);
    let kept = solve(&scene, &keep_best());
    assert!(matches!(kept.status, DeformStatus::Contradiction(_)));
    assert!(matches!(kept.substitute, Some(Substitute::RotationsReread { .. })), "{:?}", kept.substitute);
    assert!(kept.is_inversion_free());
    assert!(kept.energy.total() < 0.5 * refused.energy.total(), "{} {}", kept.energy.total(), refused.energy.total());
}

#[test]
fn nearly_contradicting_rotations_are_solved() {
    for degrees in [170.0, 179.0] {
        let deformed = solve(&scenes::lone(6, degrees), &SolveOptions::default());
        assert!(deformed.is_certified(), "{degrees}: {:?} {:?}", deformed.status, deformed.certificate);
    }
}

#[test]
fn shaken_rotations_always_end_in_a_shape() {
    for (degrees, seed) in [(80.0, 1), (150.0, 2), (180.0, 3), (180.0, 4)] {
        let deformed = solve(&scenes::shaken(5, degrees, seed), &keep_best());
        match &deformed.status {
            DeformStatus::Certified => assert!(deformed.substitute.is_none()),
            DeformStatus::Contradiction(blame) => assert!(!blame.elements.is_empty() && deformed.substitute.is_some()),
            other => panic!("{degrees} {seed}: {other:?} {:?}", deformed.certificate),
        }
        assert!(deformed.is_inversion_free(), "{degrees} {seed} {:?}", deformed.substitute);
    }
}

#[test]
fn folded_rest_shapes_are_untangled() {
    for complex in [scenes::square(4), scenes::solid([3; 3], 0.5, |_| true)] {
        let mut points = complex.points().to_vec();
        // Draws an inner vertex out of its star.
        let inner = if complex.dimension() == 2 { 25 + 5 } else { points.iter().position(|&p| p == [0.5; 3]).unwrap() };
        points[inner][0] += 0.6;
        let tangled = SimplicialComplex::new(complex.dimension(), points, complex.simplices().to_vec()).unwrap();
        let outer: Vec<_> = (0..complex.vertex_count()).filter(|&v| v != inner && on_hull(&complex, v)).map(Into::into).collect();
        let targets: Vec<[f64; 3]> =
            outer.iter().map(|v: &morsmooth::field::VertexId| tangled.points()[v.index()]).collect();
        let held = HeldVertices::unnamed(outer);
        let refused = DeformSolver::new(&tangled, held.clone(), DeformOptions::default()).map(|_| ()).unwrap_err();
        let DeformError::Inverted { elements } = refused else { panic!("{refused}") };
        let rest = RestShape::untangled(&tangled).unwrap();
        assert_eq!(rest.folded(), elements);
        let mut solver = DeformSolver::with_rest(&tangled, rest, held, DeformOptions::default()).unwrap();
        let identity = vec![scenes::turn(0.0); complex.simplex_count()];
        let deformed = solver.solve(&identity, &targets, &keep_best(), &mut |_| {}).unwrap();
        assert!(deformed.is_inversion_free(), "{:?} {:?}", deformed.status, deformed.substitute);
        assert!(deformed.elements.determinants.iter().all(|&det| det > 0.0));
        // With folded elements the rest shape is no way out of a blockade: what cannot be untangled is named, not left open.
        for turned in [40.0, 75.0] {
            let rotations: Vec<_> = (0..complex.simplex_count()).map(|element| scenes::turn(if element % 2 == 0 { turned } else { -turned })).collect();
            let ended = solver.solve(&rotations, &targets, &SolveOptions::default(), &mut |_| {}).unwrap();
            assert!(matches!(ended.status, DeformStatus::Certified | DeformStatus::Contradiction(_)), "{turned}: {:?}", ended.certificate);
        }
    }
}

/// On the boundary of the box around a mesh.
fn on_hull(complex: &SimplicialComplex, vertex: usize) -> bool {
    let points = complex.points();
    (0..complex.dimension()).any(|axis| {
        let here = points[vertex][axis];
        points.iter().all(|p| p[axis] <= here) || points.iter().all(|p| p[axis] >= here)
    })
}

#[test]
fn owners_without_a_name_are_refused() {
    let scene = scenes::quad(4);
    let mut held = HeldVertices::unnamed(scene.handles.clone());
    held.names.pop();
    let last = held.names.len();
    let refused = DeformSolver::new(&scene.complex, held, DeformOptions::default()).map(|_| ()).unwrap_err();
    assert_eq!(refused, DeformError::Owner { place: last, found: last, names: last });
    assert_eq!(refused.to_string(), format!("held vertex {last} belongs to handle {last}; a number below {last} was expected"));
}
