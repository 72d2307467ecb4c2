//! The elastic problem: every constraint may give way at a price. It always has a solution, and its multipliers tell what is wrong.

use crate::linalg::CsrMatrix;
use crate::linalg::small::{from_scaled, scaled_length, symmetric_eigen};

use super::certificate::Certificate;
use super::interior::Interior;
use super::problem::{Cone, Constraints, Objective, Problem, Term};
use super::product::largest;
use super::start::Start;
use super::{Engine, QpError, QpStatus, Settings};

/// Share of the original objective, times the violations at the start over the objective there: it keeps the minimiser unique and the multipliers near rays.
const SHARE: f64 = 1e-6;

/// How many times dearer than the present point any feasible one must be, once the problem counts as infeasible.
const DEAR: f64 = 1e4;

/// Relative gap to which the elastic problem is solved; at a rough one the multipliers have more room inside the cone to be projected.
const GAP: f64 = 1e-3;

/// Stationarity of the elastic problem, relative to the largest force: with so small a share of the objective it cannot be had better.
const RESIDUAL: f64 = 1e-6;

/// Most iterations; seven to fifteen are the rule.
const LIMIT: usize = 60;

/// Relaxations below this share of the largest one are not named.
const NAMED: f64 = 1e-1;

/// What the elastic problem found.
pub(super) enum Verdict {
    /// A proof that no point satisfies the constraints.
    Infeasible(Certificate),
    /// A point at which the constraints are violated as little as could be found.
    Near(Vec<f64>),
}

impl Interior<'_> {
    /// Solves `minimise sum of t_j + a little of the objective` subject to `s_j + t_j >= 0` on rows, `S_j + t_j I` in the cone on blocks and
    /// `t_j >= 0`, from the present point, until its multipliers prove that the constraints contradict each other or the
    /// relaxations vanish.
    ///
    /// # Cost
    /// An analysis and 10 to 20 factorisations of a matrix with one more unknown a constraint, each of which is eliminated without fill.
    pub(super) fn elastic(&mut self) -> Result<Verdict, QpError> {
        let n = self.point.x.len();
        let constraints = &self.problem.constraints;
        let (start, total) = relaxed(constraints, &self.point.x);
        let value = self.problem.objective.value(&self.point.x).abs().max(f64::MIN_POSITIVE);
        if total == 0.0 {
            return Ok(Verdict::Near(self.point.x.clone()));
        }
        let share = SHARE * total / value;
        let problem = elastic_problem(self.problem, share)?;
        let mut engine = Engine::new(&problem.objective, Some(&problem.constraints.coupling()), None)?;
        // Duals in the middle of their range, 0 to 1 in trace.
        let mut dual = vec![0.0; problem.constraints.offset.len()];
        for (first, order) in problem.constraints.member_rows() {
            for place in diagonal(order) {
                dual[first + place] = 0.5 / order as f64;
            }
        }
        let settings = Settings { relative_gap: GAP, residual: RESIDUAL, max_iterations: LIMIT, ..*self.settings };
        let solution = engine.run(&problem, (Start::Relaxed { x: &start, dual: &dual }, None), &settings, &mut |_, _| {})?;
        self.solves += solution.solves;
        self.elsewhere += solution.factorizations;
        let mut x = solution.x;
        let relaxations = x.split_off(n);
        for (row, &original) in self.rows.original.iter().enumerate() {
            self.point.s[row] = solution.slack[original as usize];
            self.point.z[row] = solution.dual[original as usize];
        }
        self.point.x.copy_from_slice(&x);
        // Every feasible point is one of the elastic problem without relaxations: its share of the objective is at least the elastic optimum.
        let least = solution.objective * (1.0 - solution.kkt.duality_gap) / share;
        if solution.status != QpStatus::Solved || least < DEAR * value {
            return Ok(Verdict::Near(x));
        }
        let mut found = match self.projected_certificate()? {
            Some(exact) => exact,
            None => {
                let mut found = self.certificate_of_duals();
                found.least_objective = Some(least);
                found
            }
        };
        let most = largest(&relaxations);
        found.relaxations = relaxations.into_iter().enumerate().filter(|&(_, t)| t > NAMED * most).collect();
        Ok(Verdict::Infeasible(found))
    }
}

/// Places of the diagonal in a scaled vector.
fn diagonal(order: usize) -> impl Iterator<Item = usize> {
    (1..=order).map(|row| scaled_length(row) - 1)
}

/// The point with relaxations that put it well inside every cone, and the sum of its violations.
fn relaxed(constraints: &Constraints, x: &[f64]) -> (Vec<f64>, f64) {
    let mut values = constraints.matrix.multiply(x);
    for (value, offset) in values.iter_mut().zip(&constraints.offset) {
        *value += offset;
    }
    let least = |(first, order): (usize, usize)| {
        let block = &values[first..first + scaled_length(order)];
        match order {
            1 => block[0],
            2 => symmetric_eigen(&from_scaled::<2>(block)).0[0],
            _ => symmetric_eigen(&from_scaled::<3>(block)).0[0],
        }
    };
    let room = 0.1 * values.iter().map(|value| value.abs()).sum::<f64>() / values.len().max(1) as f64;
    let mut start = x.to_vec();
    let mut total = 0.0;
    for member in constraints.member_rows() {
        let violation = (-least(member)).max(0.0);
        total += violation;
        start.push(room + violation);
    }
    (start, total)
}

/// The elastic problem over x and one relaxation a constraint.
fn elastic_problem(problem: &Problem, share: f64) -> Result<Problem, QpError> {
    let Problem { objective, fixed, constraints } = problem;
    let (n, members) = (fixed.len(), constraints.members());
    let size = n + members;
    let terms = objective.terms.iter().map(|term| padded(term, size, share)).collect();
    let mut linear: Vec<f64> = objective.linear.iter().map(|q| share * q).collect();
    linear.resize(size, 1.0);
    let mut fixed = fixed.clone();
    fixed.resize(size, None);
    let rows = constraints.offset.len();
    let mut triplets = Vec::with_capacity(constraints.matrix.entries() + 4 * members);
    for row in 0..rows {
        let (columns, values) = constraints.matrix.row(row);
        triplets.extend(columns.iter().zip(values).map(|(&column, &value)| (row as u32, column, value)));
    }
    for (member, (first, order)) in constraints.member_rows().enumerate() {
        triplets.extend(diagonal(order).map(|place| ((first + place) as u32, (n + member) as u32, 1.0)));
        triplets.push(((rows + member) as u32, (n + member) as u32, 1.0));
    }
    let matrix = CsrMatrix::from_triplets(rows + members, size, &triplets).map_err(|_| QpError::Length {
        array: "rows",
        expected: n,
        found: constraints.matrix.columns(),
    })?;
    let mut offset = constraints.offset.clone();
    offset.resize(rows + members, 0.0);
    let mut cones = constraints.cones.clone();
    cones.push(Cone::NonNegative(members));
    Ok(Problem {
        objective: Objective { terms, linear, constant: share * objective.constant },
        fixed,
        constraints: Constraints { matrix, offset, cones },
    })
}

/// A term over more unknowns, scaled.
fn padded(term: &Term, size: usize, share: f64) -> Term {
    let extended = |list: &[f64], factor: f64| {
        let mut list: Vec<f64> = list.iter().map(|value| factor * value).collect();
        list.resize(size, 0.0);
        list
    };
    match term {
        Term::Matrix(matrix) => Term::Matrix(embedded(matrix, size, share)),
        Term::Diagonal(diagonal) => Term::Diagonal(extended(diagonal, share)),
        Term::Chain { scale, stiffness, weights, order } => Term::Chain {
            scale: share * scale,
            stiffness: embedded(stiffness, size, 1.0),
            weights: extended(weights, 1.0),
            order: *order,
        },
    }
}

/// A square matrix as the leading part of a larger one, scaled.
fn embedded(matrix: &CsrMatrix, size: usize, factor: f64) -> CsrMatrix {
    let mut offsets = Vec::with_capacity(size + 1);
    offsets.push(0);
    let (mut indices, mut values) = (Vec::with_capacity(matrix.entries()), Vec::with_capacity(matrix.entries()));
    for row in 0..size {
        if row < matrix.rows() {
            let (columns, entries) = matrix.row(row);
            indices.extend_from_slice(columns);
            values.extend(entries.iter().map(|value| factor * value));
        }
        offsets.push(indices.len() as u32);
    }
    CsrMatrix::from_parts(size, size, offsets, indices, values)
}
