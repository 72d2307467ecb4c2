//! Every refusal, with the elements or vertices to blame.

use super::scenes;
use morsmooth::deform::{DeformError, DeformOptions, Deformer, Hold, RestShape};
use morsmooth::mesh::SimplicialComplex;

fn refused(complex: &SimplicialComplex) -> DeformError {
    RestShape::new(complex).unwrap_err()
}

#[test]
fn curves_and_surfaces_in_space_are_refused() {
    let curve = SimplicialComplex::new(1, vec![[0.0; 3], [1.0, 0.0, 0.0]], vec![0, 1]).unwrap();
    assert_eq!(refused(&curve), DeformError::Dimension { found: 1 });
    let mut points = scenes::square(2).points().to_vec();
    points[4][2] = 0.5;
    let bent = SimplicialComplex::new(2, points, scenes::square(2).simplices().to_vec()).unwrap();
    assert_eq!(refused(&bent), DeformError::NotPlanar { vertex: 4.into(), found: 0.5, expected: 0.0 });
}

#[test]
fn flat_elements_are_named() {
    let square = scenes::square(3);
    let mut points = square.points().to_vec();
    // The centre of the first cell onto its lower edge: triangle 0 has no area left.
    points[16][1] = 0.0;
    let flat = SimplicialComplex::new(2, points, square.simplices().to_vec()).unwrap();
    assert!(matches!(refused(&flat), DeformError::ZeroMeasure { elements, ratio } if elements == [0] && ratio == 0.0));
}

#[test]
fn folded_elements_are_named() {
    let square = scenes::square(3);
    let mut points = square.points().to_vec();
    // The centre of the first cell below its lower edge: triangle 0 is turned over.
    points[16][1] = -0.05;
    let folded = SimplicialComplex::new(2, points, square.simplices().to_vec()).unwrap();
    assert_eq!(refused(&folded), DeformError::Inverted { elements: vec![0] });

    let solid = scenes::solid([3; 3], 1.0, |_| true);
    let centre = solid.points().iter().position(|p| *p == [1.0, 1.0, 1.0]).unwrap();
    let mut points = solid.points().to_vec();
    points[centre] = [2.2, 1.1, 1.05];
    let complex = SimplicialComplex::new(3, points, solid.simplices().to_vec()).unwrap();
    let DeformError::Inverted { elements } = refused(&complex) else { panic!("an inverted element expected") };
    // All tetrahedra of the grid had one orientation in pairs; those whose volume changed its sign are the inverted ones.
    let signed = |complex: &SimplicialComplex, element: usize| {
        let at = |corner: usize| complex.points()[complex.simplex(element)[corner] as usize];
        let side = |corner: usize| std::array::from_fn::<f64, 3, _>(|axis| at(corner)[axis] - at(0)[axis]);
        morsmooth::deform::determinant(&[side(1), side(2), side(3)])
    };
    let expected: Vec<usize> =
        (0..solid.simplex_count()).filter(|&element| signed(&solid, element) * signed(&complex, element) < 0.0).collect();
    assert_eq!(elements, expected);
}

#[test]
fn handles_must_hold_every_part_once() {
    let square = scenes::square(2);
    let options = DeformOptions::default();
    let handle = |handles: &[u32]| {
        let handles: Vec<_> = handles.iter().map(|&vertex| morsmooth::field::VertexId(vertex)).collect();
        Deformer::new(&square, &handles, options).map(|_| ())
    };
    assert_eq!(handle(&[]), Err(DeformError::NoHandle { vertex: 0.into() }));
    assert!(matches!(handle(&[3, 99]), Err(DeformError::Handle { handle: 1, .. })));
    assert!(matches!(handle(&[3, 5, 3]), Err(DeformError::Handle { handle: 2, .. })));
    assert_eq!(handle(&[3]), Ok(()));
    let mut points = square.points().to_vec();
    points.push([9.0, 9.0, 0.0]);
    let lonely = SimplicialComplex::new(2, points, square.simplices().to_vec()).unwrap();
    let vertex = (lonely.vertex_count() - 1).into();
    assert_eq!(Deformer::new(&lonely, &[0.into()], options).map(|_| ()), Err(DeformError::NoHandle { vertex }));
}

#[test]
fn options_and_lists_are_checked() {
    let square = scenes::square(2);
    let new = |options| Deformer::new(&square, &[0.into()], options).map(|_| ());
    let good = DeformOptions::default();
    for alpha in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(new(DeformOptions { hold: Hold::Soft { alpha }, ..good }), Err(DeformError::Number { .. })));
    }
    assert!(matches!(new(DeformOptions { incompressibility: -0.1, ..good }), Err(DeformError::Number { .. })));
    assert!(matches!(new(DeformOptions { margin: f64::NAN, ..good }), Err(DeformError::Number { .. })));

    let deformer = Deformer::new(&square, &[0.into()], good).unwrap();
    let rotations = vec![scenes::turn(0.0); square.simplex_count()];
    let origin = [[0.0; 3]];
    assert!(matches!(deformer.problem(&rotations[1..], &origin), Err(DeformError::Length { what: "rotations", .. })));
    assert!(matches!(deformer.problem(&rotations, &[]), Err(DeformError::Length { what: "targets", .. })));
    let lost = [[0.0, f64::NAN, 0.0]];
    assert!(matches!(deformer.problem(&rotations, &lost), Err(DeformError::Number { what: "target", index: 0, .. })));
    let mut wrong = rotations.clone();
    wrong[5][0][0] = 1.1;
    assert!(matches!(deformer.problem(&wrong, &origin), Err(DeformError::NotARotation { element: 5, .. })));
    wrong[5] = [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(deformer.problem(&wrong, &origin), Err(DeformError::NotARotation { element: 5, deviation: 2.0 }));
    wrong[5][0][0] = f64::NAN;
    assert!(matches!(deformer.problem(&wrong, &origin), Err(DeformError::NotARotation { element: 5, .. })));
    let rest = deformer.rest();
    assert!(matches!(rest.determinants(&[0.0]), Err(DeformError::Length { what: "coordinates", .. })));
    let mut x = rest.positions();
    x[3] = f64::INFINITY;
    assert!(matches!(rest.deformation_gradients(&x), Err(DeformError::Number { what: "coordinate", index: 3, .. })));
}
