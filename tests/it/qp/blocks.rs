//! Positive semi-definite blocks: conditions of optimality recomputed here, a second solver, scales, threads, counts.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SecondOrderConeT, SupportedConeT, ZeroConeT,
};
use morsmooth::linalg::CsrMatrix;
use morsmooth::linalg::small::{from_scaled, symmetric_eigen};
use morsmooth::qp::{Cone, Constraints, Engine, Objective, Problem, QpStatus, Settings, Solution, Term, solve};

use super::problems::Random;
use super::scenes::{Scene, bent, disc, quad, swirl};

/// Smallest eigenvalue of every constraint of a vector of rows.
pub fn eigenvalues(constraints: &Constraints, rows: &[f64]) -> Vec<f64> {
    let least = |(first, order): (usize, usize)| match order {
        1 => rows[first],
        2 => symmetric_eigen(&from_scaled::<2>(&rows[first..])).0[0],
        _ => symmetric_eigen(&from_scaled::<3>(&rows[first..])).0[0],
    };
    constraints.member_rows().map(least).collect()
}

fn plain_gradient(problem: &Problem, x: &[f64], z: &[f64]) -> Vec<f64> {
    let mut gradient = vec![0.0; x.len()];
    problem.objective.gradient_into(x, &mut gradient);
    let force = problem.constraints.matrix.transpose().multiply(z);
    gradient.iter().zip(&force).map(|(g, f)| g - f).collect()
}

/// The conditions of optimality, by plain products.
fn assert_optimal(problem: &Problem, solution: &Solution) {
    assert_eq!(solution.status, QpStatus::Solved, "{:?}", solution.kkt);
    let Solution { x, dual, .. } = solution;
    let gradient = plain_gradient(problem, x, dual);
    let force = problem.constraints.matrix.transpose().multiply(dual);
    let most = force.iter().chain(&problem.objective.linear).fold(0.0f64, |most, f| most.max(f.abs()));
    for (i, g) in gradient.iter().enumerate() {
        assert!(problem.fixed[i].is_some() || g.abs() <= 1e-7 * most, "gradient {g:e} of {most:e} at {i}");
        assert!(problem.fixed[i].is_none_or(|value| value == x[i]));
    }
    let mut values = problem.constraints.matrix.multiply(x);
    values.iter_mut().zip(&problem.constraints.offset).for_each(|(value, b)| *value += b);
    let scale = values.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    assert!(eigenvalues(&problem.constraints, &values).iter().all(|&least| least > -1e-9 * scale));
    let largest = dual.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    assert!(eigenvalues(&problem.constraints, dual).iter().all(|&least| least >= -1e-12 * largest));
    let gap: f64 = values.iter().zip(dual).map(|(s, z)| s * z).sum();
    assert!(gap.abs() <= 2e-8 * solution.objective.abs(), "gap {gap:e} of {:e}", solution.objective);
}

fn solve_scene(scene: &Scene, settings: &Settings) -> Solution {
    let coupling = scene.problem.constraints.coupling();
    let mut engine = Engine::new(&scene.problem.objective, Some(&coupling), Some(&scene.coordinates)).unwrap();
    engine.solve(&scene.problem, None, settings, &mut |_| {}).unwrap()
}

#[test]
fn deformations_need_few_factorizations() {
    let least = |name: &str, scene: Scene, most: usize| {
        let solution = solve_scene(&scene, &Settings::default());
        assert_optimal(&scene.problem, &solution);
        assert!(solution.factorizations <= most, "{name}: {} factorizations", solution.factorizations);
    };
    least("quad 20", quad(20), 13);
    least("quad 40", quad(40), 14);
    least("swirl 90", swirl(40, 90.0), 15);
    least("swirl 180", swirl(40, 180.0), 16);
    least("swirl 270", swirl(40, 270.0), 23);
    least("swirl 360", swirl(40, 360.0), 26);
    least("bar 120", bent(12, 4, 120.0), 17);
    least("bar 180", bent(12, 4, 180.0), 18);
    least("bar 720", bent(12, 4, 720.0), 25);
}

/// Blocks on random unknowns, some fixed, with rows between, feasible at `inside`.
fn random_problem(seed: u64, (pairs, triples, rows): (usize, usize, usize)) -> Problem {
    let mut random = Random(seed);
    let n = 24;
    let inside: Vec<f64> = (0..n).map(|_| random.normal()).collect();
    let mut dense = vec![0.0; n * n];
    let factor: Vec<f64> = (0..n * n).map(|_| random.normal()).collect();
    for i in 0..n {
        for j in 0..n {
            let product = (0..n).map(|k| factor[i * n + k] * factor[j * n + k]).sum::<f64>() / n as f64;
            // Well conditioned, so that equal energies mean equal points.
            dense[i * n + j] = product + f64::from(u8::from(i == j));
        }
    }
    let form: Vec<(u32, u32, f64)> =
        (0..n * n).map(|at| ((at / n) as u32, (at % n) as u32, dense[at])).collect();
    let (mut triplets, mut offset) = (Vec::new(), Vec::new());
    let mut push = |order: usize, random: &mut Random| {
        let chosen: Vec<u32> = (0..4).map(|_| (random.normal().abs() * 1000.0) as u32 % n as u32).collect();
        for i in 0..order {
            for j in 0..=i {
                let row = offset.len() as u32;
                let mut value = 0.0;
                for &column in &chosen {
                    let a = random.normal();
                    triplets.push((row, column, a));
                    value += a * inside[column as usize];
                }
                // S(inside) is a random, well conditioned, definite matrix.
                offset.push(if i == j { 1.0 + random.normal().abs() } else { 0.3 * random.normal() } - value);
            }
        }
    };
    (0..pairs).for_each(|_| push(2, &mut random));
    (0..triples).for_each(|_| push(3, &mut random));
    (0..rows).for_each(|_| push(1, &mut random));
    let matrix = CsrMatrix::from_triplets(offset.len(), n, &triplets).unwrap();
    let fixed = (0..n).map(|i| (i % 7 == 3).then_some(inside[i])).collect();
    let linear: Vec<f64> = (0..n).map(|_| 3.0 * random.normal()).collect();
    Problem {
        objective: Objective { terms: vec![Term::Matrix(CsrMatrix::from_triplets(n, n, &form).unwrap())], linear, constant: 60.0 },
        fixed,
        constraints: Constraints { matrix, offset, cones: vec![Cone::Psd2(pairs), Cone::Psd3(triples), Cone::NonNegative(rows)] },
    }
}

/// Blocks of order two as second-order cones: |(s11 - s22, 2 s21)| <= s11 + s22.
fn second_order(problem: &Problem) -> (f64, Vec<f64>) {
    let n = problem.fixed.len();
    let mut rows: Vec<(Vec<(usize, f64)>, f64)> = Vec::new();
    let mut cones: Vec<SupportedConeT<f64>> = Vec::new();
    for (i, value) in problem.fixed.iter().enumerate() {
        if let Some(value) = value {
            rows.push((vec![(i, 1.0)], *value));
        }
    }
    cones.push(ZeroConeT(rows.len()));
    let constraints = &problem.constraints;
    let combined = |parts: &[(usize, f64)]| {
        let mut entries = Vec::new();
        let mut right = 0.0;
        for &(row, factor) in parts {
            let (columns, values) = constraints.matrix.row(row);
            entries.extend(columns.iter().zip(values).map(|(&c, v)| (c as usize, -factor * v)));
            right += factor * constraints.offset[row];
        }
        (entries, right)
    };
    for (first, order) in constraints.member_rows() {
        match order {
            1 => {
                rows.push(combined(&[(first, 1.0)]));
                cones.push(NonnegativeConeT(1));
            }
            2 => {
                rows.push(combined(&[(first, 1.0), (first + 2, 1.0)]));
                rows.push(combined(&[(first, 1.0), (first + 2, -1.0)]));
                rows.push(combined(&[(first + 1, 2f64.sqrt())]));
                cones.push(SecondOrderConeT(3));
            }
            _ => unreachable!("only blocks of order two"),
        }
    }
    let mut dense = vec![vec![0.0; n]; rows.len()];
    for (row, (entries, _)) in rows.iter().enumerate() {
        entries.iter().for_each(|&(column, value)| dense[row][column] += value);
    }
    let Term::Matrix(form) = &problem.objective.terms[0] else { unreachable!("one matrix") };
    let upper: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| if j >= i { form.get(i, j) } else { 0.0 }).collect()).collect();
    let right: Vec<f64> = rows.iter().map(|row| row.1).collect();
    let settings = DefaultSettingsBuilder::default().verbose(false).tol_gap_rel(1e-11).tol_gap_abs(1e-11).tol_feas(1e-11).build().unwrap();
    let (p, a) = (CscMatrix::from(&upper), CscMatrix::from(&dense));
    let mut solver = DefaultSolver::new(&p, &problem.objective.linear, &a, &right, &cones, settings).unwrap();
    solver.solve();
    (problem.objective.value(&solver.solution.x), solver.solution.x)
}

#[test]
fn random_blocks_agree_with_clarabel() {
    let settings = Settings { relative_gap: 1e-11, ..Settings::default() };
    for seed in 1..40 {
        let problem = random_problem(seed, (8, 0, 5 * (seed as usize % 2)));
        let solution = solve(&problem, None, None, &settings).unwrap();
        assert!(solution.kkt.duality_gap < 1e-9, "{:?}", solution.status);
        let (energy, x) = second_order(&problem);
        assert!((solution.objective - energy).abs() < 1e-6 * energy.abs(), "{seed}: {} {energy}", solution.objective);
        let far = x.iter().zip(&solution.x).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(far < 1e-5, "{seed}: {far:e}");
    }
}

#[test]
fn random_blocks_of_all_orders_are_optimal() {
    for seed in 1..40 {
        let problem = random_problem(100 + seed, (3, 5, 4 * (seed as usize % 3)));
        assert_optimal(&problem, &solve(&problem, None, None, &Settings::default()).unwrap());
    }
}

#[test]
fn scales_do_not_matter() {
    let scene = quad(12);
    let solution = solve_scene(&scene, &Settings::default());
    for (length, force) in [(1e-8, 1.0), (1e8, 1.0), (1.0, 1e-8), (1.0, 1e8), (1e8, 1e8)] {
        let mut problem = scene.problem.clone();
        let Objective { terms, linear, constant } = &mut problem.objective;
        let Term::Matrix(form) = &terms[0] else { unreachable!("one matrix") };
        let scaled = |factor: f64, matrix: &CsrMatrix| {
            let entries: Vec<(u32, u32, f64)> = (0..matrix.rows())
                .flat_map(|row| {
                    let (columns, values) = matrix.row(row);
                    columns.iter().zip(values).map(move |(&column, value)| (row as u32, column, factor * value))
                })
                .collect();
            CsrMatrix::from_triplets(matrix.rows(), matrix.columns(), &entries).unwrap()
        };
        // Unknowns in other units of length, objective in other units of force: f(x) -> force f(x / length).
        terms[0] = Term::Matrix(scaled(force, form));
        linear.iter_mut().for_each(|q| *q *= force * length);
        *constant *= force * length * length;
        problem.constraints.offset.iter_mut().for_each(|b| *b *= length);
        let other = solve_scene(&Scene { problem, ..quad(12) }, &Settings::default());
        assert_eq!(other.status, QpStatus::Solved, "{length:e} {force:e} {:?}", other.kkt);
        let expected = solution.objective * force * length * length;
        assert!((other.objective - expected).abs() < 2e-8 * expected, "{length:e} {force:e}");
        for (x, y) in other.x.iter().zip(&solution.x) {
            assert!((x / length - y).abs() < 1e-5, "{x} {y}");
        }
    }
}

#[test]
fn the_same_bits_on_one_two_and_three_threads() {
    let scenes = [quad(40), bent(14, 6, 150.0)];
    for scene in &scenes {
        let solve_with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| solve_scene(scene, &Settings::default()))
        };
        let one = solve_with(1);
        for threads in [2, 3] {
            let other = solve_with(threads);
            assert_eq!(one.iterations, other.iterations);
            let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
            assert!(same(&one.x, &other.x) && same(&one.dual, &other.dual) && same(&one.slack, &other.slack));
        }
    }
}

#[test]
fn feasible_starts_and_warm_starts_reach_the_same_end() {
    let scene = quad(20);
    let problem = &scene.problem;
    let mut engine = Engine::new(&problem.objective, Some(&problem.constraints.coupling()), None).unwrap();
    let cold = engine.solve(problem, None, &Settings::default(), &mut |_| {}).unwrap();
    let rough = Settings { relative_gap: 1e-3, residual: 1e-3, ..Settings::default() };
    let saved = engine.solve(problem, None, &rough, &mut |_| {}).unwrap();
    // The handle turns a little further; the blocks turn with it.
    let moved = disc(20, 0.15, (61.0, [0.2, 0.08])).problem;
    let there = engine.solve(&moved, None, &Settings::default(), &mut |_| {}).unwrap();
    let warm = engine.solve_warm(&moved, (&saved.x, &saved.dual), &Settings::default(), &mut |_| {}).unwrap();
    let given = engine.solve(problem, Some(&saved.x), &Settings::default(), &mut |_| {}).unwrap();
    for (one, other) in [(&cold, &given), (&there, &warm)] {
        assert_eq!(other.status, QpStatus::Solved, "{:?}", other.kkt);
        assert!((one.objective - other.objective).abs() < 2e-8 * one.objective);
    }
    assert!(warm.iterations < there.iterations, "{} {}", warm.iterations, there.iterations);
}

#[test]
fn blocks_of_fixed_unknowns_drop_out_or_contradict() {
    let scene = quad(8);
    let mut problem = scene.problem.clone();
    // The rest position is feasible almost everywhere; fixing it in one corner keeps those blocks as constants.
    for unknown in 0..40 {
        problem.fixed[unknown] = Some(scene.rest[unknown]);
    }
    let solution = solve(&problem, None, None, &Settings::default()).unwrap();
    assert_optimal(&problem, &solution);
    let double = gradient_sizes(&problem, &solution);
    assert!(double < 1e-7);
    // Mirrored in the corner: a block without free unknowns is violated.
    for unknown in 0..40 {
        problem.fixed[unknown] = Some(if unknown % 2 == 0 { -scene.rest[unknown] } else { scene.rest[unknown] });
    }
    for vertex in 0..problem.fixed.len() / 2 {
        let (x, y) = (2 * vertex, 2 * vertex + 1);
        if scene.rest[x] < 0.3 && scene.rest[y] < 0.3 {
            (problem.fixed[x], problem.fixed[y]) = (Some(-scene.rest[x]), Some(scene.rest[y]));
        }
    }
    let solution = solve(&problem, None, None, &Settings::default()).unwrap();
    assert!(matches!(solution.status, QpStatus::Infeasible(_)), "{:?}", solution.status);
    assert_eq!(solution.iterations, 0);
}

/// The largest gradient at a free unknown, through the formed matrix.
fn gradient_sizes(problem: &Problem, solution: &Solution) -> f64 {
    let gradient = plain_gradient(problem, &solution.x, &solution.dual);
    let most = problem.objective.linear.iter().fold(0.0f64, |most, q| most.max(q.abs()));
    let free = gradient.iter().zip(&problem.fixed).filter(|(_, fixed)| fixed.is_none());
    free.fold(0.0f64, |most, (g, _)| most.max(g.abs())) / most
}

#[test]
fn a_block_outside_the_pattern_is_refused() {
    let scene = quad(4);
    let objective = Objective { terms: vec![Term::Diagonal(vec![1.0; scene.problem.fixed.len()])], ..scene.problem.objective.clone() };
    let mut engine = Engine::new(&objective, None, None).unwrap();
    let problem = Problem { objective, ..scene.problem };
    let error = engine.solve(&problem, None, &Settings::default(), &mut |_| {}).unwrap_err();
    assert!(error.to_string().contains("coupling"), "{error}");
}
