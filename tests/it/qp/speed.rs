//! What makes solves fast must not change their answers: starts, restarts, forks, threads.

use morsmooth::linalg::CsrMatrix;
use morsmooth::qp::{Constraints, Engine, Objective, Problem, Progress, QpStatus, Settings, Solution, Term};
use rayon::prelude::*;

use super::problems::{Case, Instance, Random, instance};
use super::{distance, order, solved};

fn engine(made: &Instance) -> Engine {
    Engine::new(&made.problem.objective, None, Some(&made.coordinates)).unwrap()
}

fn from(engine: &mut Engine, problem: &Problem, start: Option<&[f64]>, settings: &Settings) -> Solution {
    let solution = engine.solve(problem, start, settings, &mut |_| {}).unwrap();
    assert_eq!(solution.status, QpStatus::Solved, "{:?}", solution.kkt);
    solution
}

fn same_bits(one: &Solution, two: &Solution) -> bool {
    let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
    same(&one.x, &two.x) && same(&one.dual, &two.dual) && one.iterations == two.iterations
}

#[test]
fn every_start_ends_at_the_same_optimum() {
    let tight = Settings { relative_gap: 1e-10, ..Settings::default() };
    for case in [Case::Data, Case::NoData, Case::Smooth] {
        let made = instance(45, 2, case, 5);
        let mut engine = engine(&made);
        let known = from(&mut engine, &made.problem, Some(&made.start), &tight);
        for start in [Some(&made.pinned[..]), None, Some(&known.x[..])] {
            let other = from(&mut engine, &made.problem, start, &tight);
            assert!((other.objective / known.objective - 1.0).abs() < 1e-9, "{case:?}");
            assert!(other.x.iter().zip(&known.x).all(|(a, b)| (a - b).abs() < 1e-5));
        }
    }
}

#[test]
fn a_start_at_the_minimiser_takes_no_more_iterations_than_one_inside() {
    for case in [Case::Data, Case::NoData, Case::Smooth] {
        let made = instance(71, 2, case, 7);
        let mut engine = engine(&made);
        let inside = from(&mut engine, &made.problem, Some(&made.start), &Settings::default());
        let outside = from(&mut engine, &made.problem, Some(&made.pinned), &Settings::default());
        assert!(outside.iterations <= inside.iterations + 1, "{case:?}: {} against {}", outside.iterations, inside.iterations);
    }
}

#[test]
fn a_blocked_first_step_begins_again_with_more_room() {
    let made = instance(101, 4, Case::Data, 7);
    let mut seen = Vec::new();
    let mut progress = |at: Progress| seen.push((at.gap, at.step));
    let settings = Settings { splitting: false, ..Settings::default() };
    let solution = engine(&made).solve(&made.problem, Some(&made.pinned), &settings, &mut progress).unwrap();
    assert_eq!(solution.status, QpStatus::Solved, "{:?}", solution.kkt);
    // The first step ends near the boundary; the next point is the start again, farther inside.
    assert!(seen[1].1 < 0.12 && seen[1].0 > seen[0].0 && seen[2].1 > 0.3, "{seen:?}");
    // 13; from the first start on 16.
    assert!(solution.iterations <= 14, "{}", solution.iterations);
}

#[test]
fn decided_rows_end_at_the_optimum_of_the_interior_point_with_fewer_factorisations() {
    let alone = Settings { splitting: false, ..Settings::default() };
    for (side, case, order, most) in [
        (101, Case::Data, 2, 6),
        (101, Case::NoData, 2, 6),
        (101, Case::Smooth, 2, 5),
        (101, Case::Data, 3, 6),
        (101, Case::NoData, 3, 8),
        (45, Case::Data, 4, 5),
        (25, Case::Data, 2, 5),
        (19, Case::NoData, 1, 5),
    ] {
        let made = instance(side, order, case, 7);
        let mut engine = engine(&made);
        let interior = from(&mut engine, &made.problem, Some(&made.pinned), &alone);
        let decided = from(&mut engine, &made.problem, Some(&made.pinned), &Settings::default());
        assert!((decided.objective / interior.objective - 1.0).abs() < 2e-8, "{case:?}");
        let furthest = decided.x.iter().zip(&interior.x).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(furthest < 1e-5, "{case:?}, order {order}: {furthest:e}");
        // Every row is active or not: a dual or a slack, never both, and no active row is violated by more than rounding leaves.
        assert!(decided.slack.iter().zip(&decided.dual).all(|(s, z)| *s >= 0.0 && *z >= 0.0 && s * z == 0.0));
        assert!(decided.kkt.primal <= 1e-10 && decided.kkt.stationarity <= 1e-8, "{:?}", decided.kkt);
        let (few, many) = (decided.factorizations, interior.factorizations);
        assert!(few <= most && few < many, "{side}, {case:?}, order {order}: {few} against {many}");
        assert!(decided.solves < interior.solves);
    }
}

#[test]
fn rows_that_are_decided_too_soon_are_decided_again() {
    // Without data at order 4 thousands of rows change together, and the interior point has to come near first.
    let made = instance(71, 4, Case::NoData, 7);
    let alone = Settings { splitting: false, ..Settings::default() };
    let known = from(&mut engine(&made), &made.problem, Some(&made.pinned), &alone);
    let decided = from(&mut engine(&made), &made.problem, Some(&made.pinned), &Settings::default());
    assert!((decided.objective / known.objective - 1.0).abs() < 2e-8);
    assert!(decided.factorizations > decided.iterations, "no decision was taken back");
    assert!(decided.factorizations <= known.factorizations + 2, "{} against {}", decided.factorizations, known.factorizations);
}

#[test]
fn rows_that_contradict_each_other_end_with_a_certificate_after_splitting() {
    let mut made = instance(71, 2, Case::Data, 7);
    let rows = &mut made.problem.constraints;
    let (columns, _) = rows.matrix.row(3000);
    let (a, b) = (columns[0], columns[1]);
    // Sums of two neighbours: at least 2 and at most 1, which no order of the vertices tells.
    let mut triplets = Vec::new();
    for row in 0..rows.offset.len() {
        let (columns, values) = rows.matrix.row(row);
        triplets.extend(columns.iter().zip(values).map(|(&column, &value)| (row as u32, column, value)));
    }
    let m = rows.offset.len() as u32;
    triplets.extend([(m, a, 1.0), (m, b, 1.0), (m + 1, a, -1.0), (m + 1, b, -1.0)]);
    let matrix = CsrMatrix::from_triplets(m as usize + 2, made.problem.fixed.len(), &triplets).unwrap();
    let offset = [&rows.offset[..], &[-2.0, 1.0]].concat();
    made.problem.constraints = Constraints::nonnegative(matrix, offset);
    let solve = |splitting: bool| {
        let settings = Settings { splitting, ..Settings::default() };
        engine(&made).solve(&made.problem, None, &settings, &mut |_| {}).unwrap()
    };
    let (alone, split) = (solve(false), solve(true));
    for solution in [&alone, &split] {
        let QpStatus::Infeasible(certificate) = &solution.status else { panic!("{:?}", solution.status) };
        assert!([m, m + 1].iter().all(|&row| certificate.constraints.contains(&(row as usize))), "{:?}", certificate.constraints);
    }
    assert!(split.factorizations <= 2 * alone.factorizations, "{} against {}", split.factorizations, alone.factorizations);
}

#[test]
fn an_iteration_limit_ends_splitting_too() {
    let made = instance(101, 2, Case::Data, 7);
    let few = Settings { max_iterations: 2, ..Settings::default() };
    let ended = engine(&made).solve(&made.problem, Some(&made.pinned), &few, &mut |_| {}).unwrap();
    assert_eq!((&ended.status, ended.iterations), (&QpStatus::IterationLimit, 2));
    // Two rounds already tell most of the rows: the objective is known to a part in a hundred.
    let known = from(&mut engine(&made), &made.problem, Some(&made.pinned), &Settings::default());
    assert!((ended.objective / known.objective - 1.0).abs() < 1e-2, "{} against {}", ended.objective, known.objective);
}

#[test]
fn the_factor_of_the_minimiser_is_used_again() {
    let made = instance(45, 2, Case::Smooth, 5);
    let mut engine = engine(&made);
    let pinned = engine.minimise(&made.problem.objective, &made.problem.fixed).unwrap();
    let known = from(&mut engine, &made.problem, Some(&pinned.x), &Settings::default());
    assert_eq!(known.factorizations, known.iterations);
    // Now the factor is another one, and must not be taken for that of the form.
    let again = from(&mut engine, &made.problem, Some(&pinned.x), &Settings::default());
    assert_eq!(again.factorizations, again.iterations + 1);
    assert!(same_bits(&known, &again));
}

#[test]
fn restarts_need_fewer_iterations() {
    let made = instance(71, 2, Case::Data, 11);
    let mut engine = engine(&made);
    let first = from(&mut engine, &made.problem, Some(&made.pinned), &Settings::default());
    let rough = first.restart.unwrap();
    assert!(rough.gap <= 1e-3);
    assert_eq!((rough.x.len(), rough.dual.len()), (first.x.len(), first.dual.len()));
    // The data change by a little noise, as from one time step to the next; one kept value moves.
    let mut problem = made.problem.clone();
    let mut random = Random(99);
    problem.objective.linear.iter_mut().for_each(|q| *q *= 1.0 + 0.01 * random.normal());
    *problem.fixed.iter_mut().flatten().next().unwrap() *= 1.01;
    let cold = from(&mut engine, &problem, None, &Settings::default());
    let warm =
        engine.solve_warm(&problem, (&rough.x, &rough.dual), &Settings::default(), &mut |_| {}).unwrap();
    assert_eq!(warm.status, QpStatus::Solved);
    assert!(warm.iterations <= 2 && warm.iterations < cold.iterations, "{} against {}", warm.iterations, cold.iterations);
    assert!((warm.objective / cold.objective - 1.0).abs() < 3e-8);
}

#[test]
fn forks_answer_like_single_engines() {
    let made = instance(60, 2, Case::Smooth, 9);
    let engine = engine(&made);
    let problems: Vec<Problem> = (0..5)
        .map(|seed| {
            let mut problem = made.problem.clone();
            let mut random = Random(seed);
            problem.objective.linear.iter_mut().for_each(|q| *q *= 1.0 + 0.02 * random.normal());
            problem
        })
        .collect();
    let alone: Vec<Solution> =
        problems.iter().map(|problem| from(&mut self::engine(&made), problem, None, &Settings::default())).collect();
    for threads in 1..=3 {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let together: Vec<Solution> = pool.install(|| {
            problems.par_iter().map(|problem| from(&mut engine.fork(), problem, None, &Settings::default())).collect()
        });
        assert!(alone.iter().zip(&together).all(|(one, two)| same_bits(one, two)), "{threads} threads");
    }
}

#[test]
fn the_same_bits_on_one_two_and_three_threads() {
    // Long enough for every vector loop to be shared.
    let made = instance(260, 2, Case::Smooth, 3);
    let few = Settings { max_iterations: 3, ..Settings::default() };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| engine(&made).solve(&made.problem, None, &few, &mut |_| {}).unwrap())
    };
    let one = on(1);
    assert!((2..=3).all(|threads| same_bits(&one, &on(threads))));
}

/// Optima with rows that are doubled, implied by others, or active without a force, from starts on both sides.
#[test]
fn degenerate_rows_do_no_harm() {
    let target = [3.0, 1.0, 2.0, 0.0, 5.0];
    let weights = [1.0; 5];
    // A chain of ties 0 <= 1 <= 2 <= 3, each row twice, and every row that the chain implies.
    let mut arcs = Vec::new();
    for a in 0..3 {
        for b in a + 1..4 {
            arcs.extend([(a, b, 0.0), (a, b, 0.0)]);
        }
    }
    // Active without a force: 3 -> 4 asks for exactly what the optimum has.
    arcs.push((3, 4, 3.5));
    let constraints = order(5, &arcs);
    let problem = Problem { objective: distance(&target, &weights), fixed: vec![None; 5], constraints };
    let known = [1.5, 1.5, 1.5, 1.5, 5.0];
    let energy = problem.objective.value(&known);
    let mut engine = Engine::new(&problem.objective, Some(&problem.constraints.coupling()), None).unwrap();
    for start in [None, Some(&target[..]), Some(&known[..]), Some(&[-2.0, -1.0, 0.0, 1.0, 9.0][..])] {
        let solution = from(&mut engine, &problem, start, &Settings::default());
        assert!((solution.objective / energy - 1.0).abs() < 1e-7);
        assert!(solution.x.iter().zip(&known).all(|(x, k)| (x - k).abs() < 1e-3), "{:?}", solution.x);
    }
}

#[test]
fn starts_at_the_optimum_or_with_every_row_tight_are_starts() {
    // All rows tight and nothing to gain: the start is the answer.
    let rows = order(3, &[(0, 1, 0.0), (1, 2, 0.0)]);
    let flat = Problem { objective: distance(&[2.0; 3], &[1.0; 3]), fixed: vec![None; 3], constraints: rows.clone() };
    assert!(solved(&flat).x.iter().all(|x| (x - 2.0).abs() < 1e-3));
    // The minimiser fulfils every row with room to spare.
    let free = Problem { objective: distance(&[1.0, 2.0, 4.0], &[1.0; 3]), fixed: vec![None; 3], constraints: rows };
    assert!(solved(&free).objective < 1e-7);
    // A form that is zero on one side of a row.
    let half = Objective { terms: vec![Term::Diagonal(vec![1.0, 1e-12])], linear: vec![-1.0, 0.0], constant: 0.5 };
    let problem = Problem { objective: half, fixed: vec![None; 2], constraints: order(2, &[(0, 1, 0.0)]) };
    assert!((solved(&problem).x[0] - 1.0).abs() < 1e-3);
    let none = Problem { constraints: Constraints::none(3), ..free };
    assert_eq!(solved(&none).x, [1.0, 2.0, 4.0]);
}
