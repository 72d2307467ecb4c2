//! Rotations for which there is no shape are refused with their elements, in the plane and in space.

use super::scenes;
use morsmooth::deform::{DeformOptions, DeformSolver, DeformStatus, HeldVertices, OnContradiction, SolveOptions, Substitute};
use morsmooth::mesh::{Rotation, SimplicialComplex};

fn solver(complex: &SimplicialComplex) -> DeformSolver {
    let ends = [0, complex.vertex_count() - 1].map(Into::into).to_vec();
    DeformSolver::new(complex, HeldVertices::unnamed(ends), DeformOptions::default()).unwrap()
}

fn targets(solver: &DeformSolver, complex: &SimplicialComplex) -> Vec<[f64; 3]> {
    solver.held().vertices.iter().map(|vertex| complex.point(*vertex)).collect()
}

#[test]
fn one_element_turned_half_a_turn_is_named() {
    for (name, complex) in [("square", scenes::square(6)), ("solid", scenes::solid([4, 3, 3], 0.25, |_| true))] {
        let mut solver = solver(&complex);
        let places = targets(&solver, &complex);
        let axis = if complex.dimension() == 2 { [0.0, 0.0, 1.0] } else { [0.3, -1.0, 0.7] };
        for culprit in [0, complex.simplex_count() / 2, complex.simplex_count() - 1] {
            let mut rotations = vec![scenes::turn(0.0); complex.simplex_count()];
            rotations[culprit] = Rotation::about(axis, std::f64::consts::PI).unwrap().matrix();
            let found = solver.solve(&rotations, &places, &SolveOptions::default(), &mut |_| {}).unwrap();
            let DeformStatus::Contradiction(blame) = &found.status else { panic!("{name} {culprit}: {:?}", found.status) };
            assert!(blame.elements.contains(&culprit), "{name}: {culprit} is not among {:?}", blame.elements);
            let best = SolveOptions { on_contradiction: OnContradiction::KeepBest, ..SolveOptions::default() };
            let found = solver.solve(&rotations, &places, &best, &mut |_| {}).unwrap();
            assert!(found.is_inversion_free() && !found.is_certified(), "{name} {culprit}");
            assert!(matches!(found.substitute, Some(Substitute::RotationsReread { .. } | Substitute::RotationsBlended { .. })));
        }
    }
}
