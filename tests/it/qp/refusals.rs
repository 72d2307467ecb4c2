//! Every kind of malformed problem, refused with its place.

use morsmooth::linalg::CsrMatrix;
use morsmooth::qp::{Cone, Constraints, Engine, Objective, Problem, QpError, Settings, Term, solve};

use super::{distance, order, path_laplacian};

fn good() -> Problem {
    Problem {
        objective: distance(&[1.0, 2.0, 3.0], &[1.0; 3]),
        fixed: vec![None; 3],
        constraints: order(3, &[(0, 1, 0.0), (1, 2, 0.0)]),
    }
}

fn refusal(problem: &Problem) -> QpError {
    solve(problem, None, None, &Settings::default()).unwrap_err()
}

fn chain(stiffness: CsrMatrix, weights: Vec<f64>, order: usize) -> Objective {
    let n = stiffness.rows();
    Objective { terms: vec![Term::Chain { scale: 1.0, stiffness, weights, order }], linear: vec![0.0; n], constant: 0.0 }
}

#[test]
fn lengths_and_shapes() {
    let mut problem = good();
    problem.fixed.pop();
    assert_eq!(refusal(&problem), QpError::Length { array: "fixed", expected: 3, found: 2 });
    let mut problem = good();
    problem.constraints.cones = vec![Cone::NonNegative(1)];
    assert_eq!(refusal(&problem), QpError::Length { array: "cones", expected: 2, found: 1 });
    let mut problem = good();
    problem.constraints = Constraints::none(4);
    assert_eq!(refusal(&problem), QpError::Shape { rows: 0, columns: 3, found_rows: 0, found_columns: 4 });
    let mut problem = good();
    problem.objective.terms.push(Term::Diagonal(vec![1.0]));
    assert_eq!(refusal(&problem), QpError::Length { array: "diagonal", expected: 3, found: 1 });
    let start = solve(&good(), Some(&[0.0]), None, &Settings::default());
    assert_eq!(start.unwrap_err(), QpError::Length { array: "start", expected: 3, found: 1 });
}

#[test]
fn numbers() {
    let mut problem = good();
    problem.objective.linear[1] = f64::INFINITY;
    assert_eq!(refusal(&problem), QpError::NotFinite { array: "linear", index: 1, value: f64::INFINITY });
    let mut problem = good();
    problem.constraints.offset[0] = f64::NEG_INFINITY;
    assert_eq!(refusal(&problem), QpError::NotFinite { array: "offset", index: 0, value: f64::NEG_INFINITY });
    let mut problem = good();
    problem.fixed[2] = Some(f64::INFINITY);
    assert_eq!(refusal(&problem), QpError::NotFinite { array: "fixed", index: 2, value: f64::INFINITY });
    let mut problem = good();
    problem.objective.terms = vec![Term::Diagonal(vec![1.0, -2.0, 1.0])];
    assert_eq!(refusal(&problem), QpError::Negative { array: "diagonal", index: 1, value: -2.0 });
}

#[test]
fn chains() {
    let no_factor = chain(path_laplacian(3), vec![1.0; 3], 0);
    assert_eq!(Engine::new(&no_factor, None, None).err(), Some(QpError::ChainOrder { term: 0 }));
    let shifted = CsrMatrix::from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0), (0, 1, -1.0), (1, 0, -0.5)]).unwrap();
    let found = Engine::new(&chain(shifted, vec![1.0; 2], 2), None, None).err();
    assert_eq!(found, Some(QpError::RowSum { row: 1, sum: 0.5, size: 1.5 }));
}

#[test]
fn patterns() {
    let problem = good();
    let mut engine = Engine::new(&problem.objective, None, None).unwrap();
    let settings = Settings::default();
    let outside = engine.solve(&problem, None, &settings, &mut |_| {}).unwrap_err();
    assert_eq!(outside, QpError::RowOutsidePattern { row: 0, first: 0, second: 1 });
    let wider = chain(path_laplacian(3), vec![1.0; 3], 1);
    let outside = engine.minimise(&wider, &[None; 3]).unwrap_err();
    assert!(matches!(outside, QpError::TermOutsidePattern { term: 0, .. }));
    let longer = distance(&[0.0; 4], &[1.0; 4]);
    assert_eq!(engine.minimise(&longer, &[None; 4]).unwrap_err(), QpError::Length { array: "linear", expected: 3, found: 4 });
}

#[test]
fn forms_that_are_not_convex() {
    let saddle = CsrMatrix::from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, -1.0)]).unwrap();
    let objective = Objective { terms: vec![Term::Matrix(saddle)], linear: vec![0.0; 2], constant: 0.0 };
    let found = Engine::new(&objective, None, None).unwrap().minimise(&objective, &[None; 2]).unwrap_err();
    assert!(matches!(found, QpError::NotConvex { unknown: 1, .. }));
}
