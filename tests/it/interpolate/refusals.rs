//! What is refused, and in which words.

use super::{comb, of_handles};
use crate::mesh::shapes::{grid, mapped};
use morsmooth::field::VertexId;
use morsmooth::interpolate::{
    BoundaryValues, InterpolateError, InterpolateOptions, Interpolator, Method, Partition, WeightOptions, skinning_weights,
};
use morsmooth::mesh::{Fold, SimplicialComplex, folds};
use morsmooth::operators::{lumped_mass, mixed_voronoi_mass};
use morsmooth::qp::{Engine, Objective, QpError, Term};

fn error(complex: &SimplicialComplex, method: Method, values: &[(u32, f64)], options: &InterpolateOptions) -> InterpolateError {
    let given: BoundaryValues = values.iter().map(|&(vertex, value)| (VertexId(vertex), value)).collect::<Vec<_>>().into();
    Interpolator::new(complex, 2).unwrap().solve(method, &given, options).unwrap_err()
}

#[test]
fn every_refusal_names_the_place() {
    let square = grid([4, 4, 1]);
    let options = InterpolateOptions::default();
    let says = |error: InterpolateError, words: &str| assert!(error.to_string().contains(words), "{error}");
    says(Interpolator::new(&square, 5).err().unwrap(), "order 5; expected 1, 2, 3 or 4");
    says(error(&square, Method::Monotone, &[(0, 0.0), (16, 1.0)], &options), "vertex 16; expected less than 16");
    says(error(&square, Method::Harmonic, &[(0, f64::NAN)], &options), "given at vertex 0 is NaN; expected a finite number");
    says(error(&square, Method::Harmonic, &[(3, 1.0), (3, 0.5)], &options), "vertex 3 is given the values 0.5 and 1.0");
    let bounds = InterpolateOptions { bounds: Some((0.0, 1.0)), ..options };
    says(error(&square, Method::Bounded, &[(0, 0.0), (5, 2.0)], &bounds), "value 2.0 given at vertex 5 is outside the bounds 0.0 to 1.0");
    says(error(&square, Method::Monotone, &[], &options), "part of 16 vertices around vertex 0 has no value");

    let apart = SimplicialComplex::new(1, vec![[0.0; 3], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [4.0, 0.0, 0.0]], vec![0, 1, 2, 3]).unwrap();
    says(error(&apart, Method::Monotone, &[(0, 0.0), (1, 1.0)], &options), "part of 2 vertices around vertex 2 has no value");
    let loose = SimplicialComplex::new(1, vec![[0.0; 3], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0]], vec![0, 1]).unwrap();
    says(Interpolator::new(&loose, 2).err().unwrap(), "vertex 2 belongs to no simplex");

}

#[test]
fn a_part_that_hangs_on_one_free_vertex_is_refused() {
    // Two triangles that share a vertex; both values stand in the first.
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.0, 2.0, 0.0], [1.0, 2.0, 0.0]];
    let bow = SimplicialComplex::new(2, points, vec![0, 1, 2, 2, 4, 3]).unwrap();
    let found = error(&bow, Method::Monotone, &[(0, 0.0), (1, 1.0)], &InterpolateOptions::default());
    assert_eq!(found, InterpolateError::Pinched { vertex: VertexId(3), vertices: 2 });
}

#[test]
fn coupled_weights_need_values_that_sum_to_one() {
    let complex = comb();
    let mut given = of_handles(&[vec![VertexId(0)], vec![VertexId(40)], vec![VertexId(80)]]);
    given[0].values[0].1 = 0.5;
    let mut interpolator = Interpolator::new(&complex, 2).unwrap();
    let options = WeightOptions { partition: Partition::Coupled, ..WeightOptions::default() };
    let found = skinning_weights(&mut interpolator, &given, &options).unwrap_err();
    assert_eq!(found, InterpolateError::NoPartition { vertex: VertexId(0), sum: 0.5 });
}

#[test]
fn folds_are_seen_whatever_the_order_of_the_corners() {
    let flat = grid([4, 4, 1]);
    assert_eq!(folds(&flat), []);
    // Every second triangle numbered the other way round is no fold.
    let mut corners = flat.simplices().to_vec();
    corners.chunks_exact_mut(3).step_by(2).for_each(|corners| corners.swap(0, 1));
    let mixed = SimplicialComplex::new(2, flat.points().to_vec(), corners).unwrap();
    assert_eq!(folds(&mixed), []);
    // A vertex dragged across the whole square turns triangles over.
    let mut points = mixed.points().to_vec();
    points[5] = [2.6, 2.7, 0.0];
    let folded = SimplicialComplex::new(2, points.clone(), mixed.simplices().to_vec()).unwrap();
    let found = folds(&folded);
    assert!(!found.is_empty());
    let touches = |fold: &Fold| [fold.first, fold.second].iter().any(|&simplex| folded.simplex(simplex).contains(&5));
    assert!(found.iter().all(touches));
    // On a curved surface there is no such thing.
    assert_eq!(folds(&mapped(&folded, |p| [p[0], p[1], 0.1 * p[0]])), []);
    let solid = grid([3, 3, 3]);
    assert_eq!(folds(&solid), []);
    let mut points = solid.points().to_vec();
    points[13] = [2.5, 2.6, 2.7];
    assert!(!folds(&SimplicialComplex::new(3, points, solid.simplices().to_vec()).unwrap()).is_empty());
}

#[test]
fn voronoi_areas_sum_to_the_area_and_are_known_on_simple_triangles() {
    let complex = comb();
    let (voronoi, equal) = (mixed_voronoi_mass(&complex).unwrap(), lumped_mass(&complex).unwrap());
    let sum = |mass: &[f64]| mass.iter().sum::<f64>();
    assert!((sum(&voronoi) / sum(&equal) - 1.0).abs() < 1e-12);
    assert!(voronoi.iter().all(|&area| area > 0.0));
    let triangle = |points: [[f64; 3]; 3]| mixed_voronoi_mass(&SimplicialComplex::new(2, points.to_vec(), vec![0, 1, 2]).unwrap()).unwrap();
    let near = |found: Vec<f64>, wanted: [f64; 3]| found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-15);
    let height = 3f64.sqrt() / 2.0;
    assert!(near(triangle([[0.0; 3], [1.0, 0.0, 0.0], [0.5, height, 0.0]]), [height / 6.0; 3]));
    // A right angle has half of the triangle, as has an obtuse one.
    assert!(near(triangle([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), [0.25, 0.125, 0.125]));
    assert!(near(triangle([[0.0; 3], [1.0, 0.0, 0.0], [-1.0, 1.0, 0.0]]), [0.25, 0.125, 0.125]));
    // Isosceles, acute, by hand: the circumcentre of (0,0), (2,0), (1,2) is (1, 0.75).
    assert!(near(triangle([[0.0; 3], [2.0, 0.0, 0.0], [1.0, 2.0, 0.0]]), [0.6875, 0.6875, 0.625]));
}

#[test]
fn one_factor_serves_other_values_at_the_same_places_only() {
    let objective = Objective { terms: vec![Term::Diagonal(vec![1.0, 2.0, 3.0])], linear: vec![-1.0; 3], constant: 0.0 };
    let mut engine = Engine::new(&objective, None, None).unwrap();
    let mut pinned = engine.pin(&objective, &[None, Some(1.0), None]).unwrap();
    assert_eq!(pinned.minimise_at(&[None, Some(4.0), None]).unwrap().x, [1.0, 4.0, 1.0 / 3.0]);
    assert_eq!(pinned.minimise_at(&[None, None, Some(4.0)]), Err(QpError::FixedSet { unknown: 1 }));
}
