//! Objective, rows and margins of the assembled problem.

use super::scene::Random;
use super::{both, kinds, scenes};
use morsmooth::deform::{DeformOptions, Deformer, determinant};
use morsmooth::qp::{Cone, Engine};

fn close(found: f64, expected: f64, unit: f64) {
    assert!((found - expected).abs() <= 1e-12 * unit, "{found} instead of {expected}, unit {unit}");
}

#[test]
fn the_objective_is_the_sum_of_the_energies() {
    let mut random = Random(1);
    for scene in both() {
        for options in kinds() {
            let deformer = scene.deformer(options);
            let problem = deformer.problem(&scene.rotations, &scene.targets).unwrap();
            problem.check().unwrap();
            let mut moved = random.positions(&vec![0.0; problem.fixed.len()], 0.3);
            // Hard handles have no energy away from their targets; the two sides agree where the targets are met.
            for (slot, fixed) in moved.iter_mut().zip(&problem.fixed) {
                *slot = fixed.unwrap_or(*slot);
            }
            let x = deformer.positions(&scene.targets, &moved).unwrap();
            let energy = deformer.energy(&scene.rotations, &scene.targets, &x).unwrap();
            close(problem.objective.value(&moved), energy.total(), energy.total() + problem.objective.constant);
            let densities = deformer.energy_densities(&scene.rotations, &x).unwrap();
            let sum: f64 = densities.iter().zip(deformer.rest().measures()).map(|(density, v)| density * v).sum();
            close(sum, energy.elastic + energy.volume, sum);
        }
    }
}

#[test]
fn the_gradient_is_the_derivative_of_the_energy() {
    let mut random = Random(2);
    for scene in both() {
        for options in kinds() {
            let deformer = scene.deformer(options);
            let problem = deformer.problem(&scene.rotations, &scene.targets).unwrap();
            let moved = random.positions(&vec![0.0; problem.fixed.len()], 0.3);
            let x = deformer.positions(&scene.targets, &moved).unwrap();
            let mut gradient = vec![0.0; x.len()];
            problem.objective.gradient_into(&moved, &mut gradient);
            let direction: Vec<f64> = (0..x.len()).map(|_| random.even()).collect();
            let slope: f64 = gradient.iter().zip(&direction).map(|(g, d)| g * d).sum();
            let along = |step: f64| {
                let moved: Vec<f64> = x.iter().zip(&direction).map(|(x, d)| x + step * d).collect();
                deformer.energy(&scene.rotations, &scene.targets, &moved).unwrap().total()
            };
            // Central differences of a quadratic function are exact up to rounding.
            let difference = (along(0.25) - along(-0.25)) / 0.5;
            assert!((slope - difference).abs() <= 1e-11 * (along(0.25) + along(-0.25)), "{slope} {difference}");
        }
    }
}

#[test]
fn rows_are_the_scaled_triangle_of_the_symmetric_part() {
    let mut random = Random(3);
    for scene in both() {
        let deformer = scene.deformer(DeformOptions::default());
        let rest = deformer.rest();
        let dimension = rest.dimension();
        let rotations: Vec<_> = (0..rest.element_count()).map(|_| random.rotation(dimension)).collect();
        let problem = deformer.problem(&rotations, &scene.targets).unwrap();
        let moved = random.positions(&vec![0.0; problem.fixed.len()], 0.3);
        let x = deformer.positions(&scene.targets, &moved).unwrap();
        let mut rows = problem.constraints.matrix.multiply(&moved);
        rows.iter_mut().zip(&problem.constraints.offset).for_each(|(row, b)| *row += b);
        let block = dimension * (dimension + 1) / 2;
        let expected_cone = if dimension == 2 { Cone::Psd2(rest.element_count()) } else { Cone::Psd3(rest.element_count()) };
        assert_eq!(problem.constraints.cones, [expected_cone]);
        let gradients = rest.deformation_gradients(&x).unwrap();
        let margins = deformer.margins(&scene.targets);
        for element in 0..rest.element_count() {
            let (r, f) = (&rotations[element], &gradients[element]);
            let product = |a: usize, b: usize| (0..dimension).map(|k| r[k][a] * f[k][b]).sum::<f64>();
            let mut place = element * block;
            for a in 0..dimension {
                for b in 0..=a {
                    let entry = 0.5 * (product(a, b) + product(b, a));
                    let expected = if a == b { entry - margins[element] } else { 2f64.sqrt() * entry };
                    assert!((rows[place] - expected).abs() < 1e-12, "{} {expected}", rows[place]);
                    place += 1;
                }
            }
        }
    }
}

#[test]
fn a_rigid_motion_with_its_own_rotation_costs_nothing() {
    let mut random = Random(4);
    for scene in both() {
        for options in kinds() {
            let deformer = scene.deformer(options);
            let rest = deformer.rest();
            let dimension = rest.dimension();
            let rotation = random.rotation(dimension);
            let shift = [random.even(), random.even(), random.even()];
            let moved: Vec<[f64; 3]> = rest
                .points()
                .iter()
                .map(|&point| {
                    let turned = scenes::rotated(&rotation, point);
                    std::array::from_fn(|axis| turned[axis] + shift[axis])
                })
                .collect();
            let targets: Vec<_> = deformer.handles().iter().map(|vertex| moved[vertex.index()]).collect();
            let rotations = vec![rotation; rest.element_count()];
            let x: Vec<f64> = moved.iter().flat_map(|point| point[..dimension].to_vec()).collect();
            assert!(deformer.energy(&rotations, &targets, &x).unwrap().total() < 1e-24);
            for value in rest.determinants(&x).unwrap().into_iter().chain(rest.smallest_eigenvalues(&rotations, &x).unwrap()) {
                assert!((value - 1.0).abs() < 1e-12, "{value}");
            }
            // So it is the minimiser.
            let problem = deformer.problem(&rotations, &targets).unwrap();
            let coordinates = deformer.coordinates();
            let mut engine =
                Engine::new(&problem.objective, Some(&problem.constraints.coupling()), Some(&coordinates)).unwrap();
            let minimum = engine.minimise(&problem.objective, &problem.fixed).unwrap();
            let found = deformer.positions(&targets, &minimum.x).unwrap();
            let off = found.iter().zip(&x).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9, "{off}");
        }
    }
}

#[test]
fn the_determinant_is_at_least_that_of_the_symmetric_part() {
    // det(S + A) >= det(S) for semidefinite S and antisymmetric A; so det F is at least the smallest eigenvalue to the power of d.
    let mut random = Random(5);
    let mut used = 0;
    for scene in both() {
        let deformer = scene.deformer(DeformOptions::default());
        let rest = deformer.rest();
        let dimension = rest.dimension();
        for amount in [0.01, 0.03, 0.06, 0.1] {
            let x = random.positions(&rest.positions(), amount);
            let angle = 0.5 * random.even();
            let rotations = vec![scenes::turn(angle); rest.element_count()];
            let smallest = rest.smallest_eigenvalues(&rotations, &x).unwrap();
            let determinants = rest.determinants(&x).unwrap();
            let gradients = rest.deformation_gradients(&x).unwrap();
            for ((least, det), gradient) in smallest.iter().zip(&determinants).zip(&gradients) {
                assert_eq!(determinant(gradient), *det);
                if *least >= 0.0 {
                    used += 1;
                    assert!(*det >= least.powi(dimension as i32) - 1e-12, "{det} {least}");
                }
            }
        }
    }
    assert!(used > 200, "{used}");
}

#[test]
fn an_eigenvalue_is_zero_where_the_matrix_loses_its_rank() {
    // F = R diag(s, 1[, 1]) with s = 0 flattens every element: S has the eigenvalues s, 1, 1 and det F = s.
    for scene in both() {
        let deformer = scene.deformer(DeformOptions::default());
        let rest = deformer.rest();
        let dimension = rest.dimension();
        for squash in [0.0, -0.5, 0.3] {
            let rotation = scenes::turn(0.7);
            let x: Vec<f64> = rest
                .points()
                .iter()
                .flat_map(|p| scenes::rotated(&rotation, [squash * p[0], p[1], p[2]])[..dimension].to_vec())
                .collect();
            let rotations = vec![rotation; rest.element_count()];
            let smallest = rest.smallest_eigenvalues(&rotations, &x).unwrap();
            let determinants = rest.determinants(&x).unwrap();
            assert!(smallest.iter().chain(&determinants).all(|value| (value - squash).abs() < 1e-12));
        }
    }
}

#[test]
fn margins_outweigh_rounding_to_single_precision() {
    let mut random = Random(6);
    for scene in both() {
        let deformer = scene.deformer(DeformOptions::default());
        let rest = deformer.rest();
        let dimension = rest.dimension();
        for _ in 0..20 {
            let x = random.positions(&rest.positions(), 0.05);
            let rounded: Vec<f64> = x.iter().map(|&x| f64::from(x as f32)).collect();
            let extent = x.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            let before = rest.deformation_gradients(&x).unwrap();
            let after = rest.deformation_gradients(&rounded).unwrap();
            for element in 0..rest.element_count() {
                let moved: f64 = (0..dimension * dimension)
                    .map(|place| {
                        let (a, b) = (place / dimension, place % dimension);
                        (before[element][a][b] - after[element][a][b]).powi(2)
                    })
                    .sum();
                assert!(moved.sqrt() <= rest.rounding(element, extent) * (1.0 + 1e-9));
            }
        }
        let margins = deformer.margins(&scene.targets);
        let extent = 1.0f64.max(scene.targets.iter().flatten().fold(0.0, |most, x| most.max(x.abs())));
        for (element, margin) in margins.iter().enumerate() {
            close(*margin, 2.0 * rest.rounding(element, extent), *margin);
        }
    }
}

#[test]
fn the_order_of_corners_in_the_file_does_not_matter() {
    use morsmooth::mesh::SimplicialComplex;
    for scene in both() {
        let stride = scene.complex.dimension() + 1;
        let mut simplices = scene.complex.simplices().to_vec();
        for (element, corners) in simplices.chunks_mut(stride).enumerate() {
            corners.rotate_left(element % stride);
            if element % 3 == 0 {
                corners.swap(0, 1);
            }
        }
        let shuffled = SimplicialComplex::new(stride - 1, scene.complex.points().to_vec(), simplices).unwrap();
        let deformer = scene.deformer(DeformOptions::default());
        let other = Deformer::new(&shuffled, &scene.handles, DeformOptions::default()).unwrap();
        let x = Random(7).positions(&deformer.rest().positions(), 0.1);
        let (one, two) = (deformer.rest().determinants(&x).unwrap(), other.rest().determinants(&x).unwrap());
        assert!(one.iter().zip(&two).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
