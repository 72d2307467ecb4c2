//! The same planar deformation in the crate `clarabel`: a positive semi-definite 2 x 2 matrix is a second-order cone.

use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SecondOrderConeT, SupportedConeT, ZeroConeT};
use morsmooth::qp::{Cone, Problem};
use std::time::Instant;

use crate::clock::processor_seconds;
use super::conic::{Rows, columns_of, quadratic};

/// Tolerances that are tried in turn until the energy is right; the first is the default.
const TOLERANCES: [f64; 3] = [1e-8, 1e-10, 1e-12];

/// What the unknowns are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unknowns {
    /// Displacements from targets and rest positions, as in our engine: no large terms cancel in the objective.
    Displacements,
    /// Positions, as the paper states the problem.
    Positions,
}

/// Clarabel is as accurate as us once its energy is within this share of ours.
const ACCURATE: f64 = 1e-6;

/// Its first run with an energy within [`ACCURATE`] of ours, or the last: iterations, seconds, and how far off the energy is.
pub fn clarabel(problem: &Problem, reference: &[f64], unknowns: Unknowns, energy: f64) -> serde_json::Value {
    let n = problem.fixed.len();
    if problem.constraints.cones.iter().any(|cone| !matches!(cone, Cone::Psd2(_))) {
        return serde_json::json!("only planar scenes: the crate's matrix cones want LAPACK");
    }
    let quadratic = quadratic(problem);
    let mut rows = Rows::of_fixed(problem);
    let blocks = problem.constraints.offset.len() / 3;
    for block in 0..blocks {
        // (s11 + s22, s11 - s22, 2 s21) of the rows (s11, √2 s21, s22).
        for parts in [[(0, 1.0), (2, 1.0)].as_slice(), &[(0, 1.0), (2, -1.0)], &[(1, 2f64.sqrt())]] {
            let parts: Vec<(usize, f64)> = parts.iter().map(|&(part, factor)| (3 * block + part, factor)).collect();
            rows.push(problem, &parts);
        }
    }
    let matrix = rows.matrix(n);
    let mut right = rows.right;
    let mut linear = problem.objective.linear.clone();
    let shift = if unknowns == Unknowns::Positions { reference.to_vec() } else { vec![0.0; n] };
    // d = x - reference in  1/2 dᵀ P d + qᵀ d  and in  -A d + s = b.
    linear.iter_mut().zip(quadratic.multiply(&shift)).for_each(|(slot, part)| *slot -= part);
    right.iter_mut().zip(matrix.multiply(&shift)).for_each(|(slot, part)| *slot += part);
    let mut cones: Vec<SupportedConeT<f64>> = vec![ZeroConeT(rows.equalities)];
    cones.extend((0..blocks).map(|_| SecondOrderConeT(3)));
    let (quadratic, matrix) = (columns_of(&quadratic, true), columns_of(&matrix, false));
    let mut last = serde_json::Value::Null;
    for tolerance in TOLERANCES {
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .tol_gap_abs(tolerance)
            .tol_gap_rel(tolerance)
            .tol_feas(tolerance.max(1e-9))
            .max_threads(1u32)
            .time_limit(60.0)
            .build()
            .unwrap();
        let (clock, wall) = (processor_seconds(), Instant::now());
        let mut solver = DefaultSolver::new(&quadratic, &linear, &matrix, &right, &cones, settings).unwrap();
        solver.solve();
        let found: Vec<f64> = solver.solution.x.iter().zip(&shift).map(|(x, base)| x - base).collect();
        let off = (problem.objective.value(&found) - energy).abs() / energy;
        last = serde_json::json!({
            "tolerance": tolerance,
            "status": format!("{:?}", solver.solution.status),
            "iterations": solver.solution.iterations,
            "processor": processor_seconds() - clock,
            "seconds": wall.elapsed().as_secs_f64(),
            "energy_off": off,
        });
        if off <= ACCURATE || wall.elapsed().as_secs_f64() > 60.0 {
            break;
        }
    }
    last
}
