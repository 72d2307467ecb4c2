//! The same problem in the crate `clarabel`, with the product formed.

use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SupportedConeT, ZeroConeT};
use morsmooth::qp::Problem;

use super::conic::{Rows, columns_of, quadratic};

/// Iterations, seconds and the energy of the point found, by the engine's product form.
pub fn clarabel(problem: &Problem) -> (u32, f64, f64) {
    let quadratic = columns_of(&quadratic(problem), true);
    let mut rows = Rows::of_fixed(problem);
    (0..problem.constraints.offset.len()).for_each(|row| rows.push(problem, &[(row, 1.0)]));
    let matrix = columns_of(&rows.matrix(problem.fixed.len()), false);
    let cones: [SupportedConeT<f64>; 2] = [ZeroConeT(rows.equalities), NonnegativeConeT(rows.right.len() - rows.equalities)];
    let settings = DefaultSettingsBuilder::default().verbose(false).tol_gap_abs(1e-14).max_threads(1u32).build().unwrap();
    let clock = std::time::Instant::now();
    let mut solver = DefaultSolver::new(&quadratic, &problem.objective.linear, &matrix, &rows.right, &cones, settings).unwrap();
    solver.solve();
    let seconds = clock.elapsed().as_secs_f64();
    (solver.solution.iterations, seconds, problem.objective.value(&solver.solution.x))
}
