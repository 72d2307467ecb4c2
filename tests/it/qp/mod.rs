//! The engine: known optima, independent residuals, a second solver, endings, refusals.

mod agreement;
mod blocks;
mod contradictions;
mod endings;
mod invariance;
mod mixed;
mod optima;
mod penalty;
mod pinned;
mod product;
mod refusals;
mod speed;
mod scenes;

#[path = "../../../tools/bench/conic.rs"]
mod conic;
#[path = "../../../tools/bench/peer.rs"]
mod peer;
#[path = "../../../tools/bench/problems.rs"]
mod problems;

use morsmooth::linalg::CsrMatrix;
use morsmooth::qp::{Constraints, Objective, Problem, QpStatus, Settings, Solution, Term};

/// Half the squared distance to `target`, weighted.
pub fn distance(target: &[f64], weights: &[f64]) -> Objective {
    Objective {
        terms: vec![Term::Diagonal(weights.to_vec())],
        linear: target.iter().zip(weights).map(|(t, w)| -t * w).collect(),
        constant: target.iter().zip(weights).map(|(t, w)| 0.5 * w * t * t).sum(),
    }
}

/// `x_b - x_a >= margin` for each (a, b, margin).
pub fn order(unknowns: usize, arcs: &[(u32, u32, f64)]) -> Constraints {
    let triplets: Vec<(u32, u32, f64)> =
        arcs.iter().enumerate().flat_map(|(row, &(a, b, _))| [(row as u32, a, -1.0), (row as u32, b, 1.0)]).collect();
    let matrix = CsrMatrix::from_triplets(arcs.len(), unknowns, &triplets).unwrap();
    Constraints::nonnegative(matrix, arcs.iter().map(|arc| -arc.2).collect())
}

/// Solves from nothing and insists on success.
pub fn solved(problem: &Problem) -> Solution {
    let solution = morsmooth::qp::solve(problem, None, None, &Settings::default()).unwrap();
    assert_eq!(solution.status, QpStatus::Solved, "{:?}", solution.kkt);
    solution
}

/// The Laplacian of a path with unit weights.
pub fn path_laplacian(unknowns: usize) -> CsrMatrix {
    let mut triplets = Vec::new();
    for i in 1..unknowns as u32 {
        triplets.extend([(i - 1, i, -1.0), (i, i - 1, -1.0), (i, i, 1.0), (i - 1, i - 1, 1.0)]);
    }
    CsrMatrix::from_triplets(unknowns, unknowns, &triplets).unwrap()
}
