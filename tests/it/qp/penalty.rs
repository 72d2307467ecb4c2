//! Penalty continuation: its functions, the optimum of both methods, previews, endings.

use super::problems::{Case, instance};
use super::{distance, order, path_laplacian, solved};
use morsmooth::linalg::CsrMatrix;
use morsmooth::linalg::small::{from_scaled, symmetric_eigen, to_scaled};
use morsmooth::qp::{
    Cone, Constraints, Engine, Method, Penalty, PenaltyOptions, Problem, QpError, QpStatus, Settings, Solution, Term,
    Until, solve_with,
};

const KINDS: [Penalty; 3] = [Penalty::Quadratic, Penalty::Cubic, Penalty::Spline];

/// SplitMix64, even in -1 to 1.
struct Random(u64);

impl Random {
    fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

fn by_penalty(problem: &Problem, penalty: Penalty) -> Solution {
    solve_with(problem, &Method::Penalty(PenaltyOptions::with(penalty)), None, &Settings::default()).unwrap()
}

/// A chain of unknowns drawn to random targets that must rise.
fn rising(unknowns: usize, seed: u64) -> Problem {
    let mut random = Random(seed);
    let target: Vec<f64> = (0..unknowns).map(|_| random.even()).collect();
    let mut objective = distance(&target, &vec![1.0; unknowns]);
    objective.terms.push(Term::Matrix(path_laplacian(unknowns)));
    let arcs: Vec<(u32, u32, f64)> = (1..unknowns as u32).map(|i| (i - 1, i, 1e-3)).collect();
    let mut fixed = vec![None; unknowns];
    fixed[0] = Some(-0.5);
    fixed[unknowns - 1] = Some(0.7);
    Problem { objective, fixed, constraints: order(unknowns, &arcs) }
}

/// The nearest matrices to random ones, chained by springs, all positive semi-definite with a margin.
fn matrices(size: usize, count: usize, seed: u64) -> Problem {
    let rows = size * (size + 1) / 2;
    let n = rows * count;
    let mut random = Random(seed);
    let target: Vec<f64> = (0..n).map(|_| random.even()).collect();
    let mut objective = distance(&target, &vec![1.0; n]);
    let springs: Vec<(u32, u32, f64)> = (rows..n)
        .flat_map(|i| {
            let (i, j) = (i as u32, (i - rows) as u32);
            [(i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)]
        })
        .collect();
    objective.terms.push(Term::Matrix(CsrMatrix::from_triplets(n, n, &springs).unwrap()));
    let identity: Vec<(u32, u32, f64)> = (0..n as u32).map(|i| (i, i, 1.0)).collect();
    let diagonal = if size == 2 { vec![0, 2] } else { vec![0, 2, 5] };
    let offset = (0..n).map(|i| if diagonal.contains(&(i % rows)) { -0.05 } else { 0.0 }).collect();
    let cones = vec![if size == 2 { Cone::Psd2(count) } else { Cone::Psd3(count) }];
    let constraints = Constraints { matrix: CsrMatrix::from_triplets(n, n, &identity).unwrap(), offset, cones };
    Problem { objective, fixed: vec![None; n], constraints }
}

#[test]
fn slopes_and_curvatures_are_derivatives() {
    for penalty in KINDS {
        for tau in [1.0, 30.0, 1e4] {
            for step in -40..40 {
                // In the natural unit of the spline, and off its joints.
                let y = (f64::from(step) * 0.1 + 0.03) / tau;
                let h = 1e-5 / tau;
                if penalty == Penalty::Spline && y * tau <= -0.99 && y * tau > -0.5 {
                    assert!(penalty.value(tau, y).is_finite());
                }
                let slope = (penalty.value(tau, y + h) - penalty.value(tau, y - h)) / (2.0 * h);
                let curvature = (penalty.slope(tau, y + h) - penalty.slope(tau, y - h)) / (2.0 * h);
                let (found, bent) = (penalty.slope(tau, y), penalty.curvature(tau, y));
                assert!((found - slope).abs() <= 1e-7 * (1.0 + found.abs()), "{penalty:?} {tau} {y}: {found} {slope}");
                assert!((bent - curvature).abs() <= 1e-5 * (tau + bent), "{penalty:?} {tau} {y}: {bent} {curvature}");
                assert!(found <= 0.0 && bent >= 0.0);
                let other = y + 0.3 / tau;
                let secant = penalty.secant(tau, y, other);
                assert!((secant - penalty.secant(tau, other, y)).abs() <= 1e-12 * secant.abs());
                assert!(secant >= 0.0);
            }
        }
    }
}

#[test]
fn joints_are_as_smooth_as_promised() {
    let (below, above) = (-0.5 - 1e-12, -0.5 + 1e-12);
    let spline = Penalty::Spline;
    assert!((spline.value(1.0, below) - spline.value(1.0, above)).abs() < 1e-10);
    assert!((spline.slope(1.0, below) - spline.slope(1.0, above)).abs() < 1e-10);
    assert!((spline.curvature(1.0, below) - spline.curvature(1.0, above)).abs() < 1e-10);
    assert_eq!(Penalty::Quadratic.curvature(1.0, -1e-300), 2.0);
    assert_eq!(Penalty::Quadratic.curvature(1.0, 1e-300), 0.0);
    assert!(Penalty::Cubic.curvature(1.0, -1e-12) < 1e-11);
    // Where eigenvalues meet, the secant is the curvature.
    for penalty in KINDS {
        let (y, tau) = (-0.3, 2.0);
        assert!((penalty.secant(tau, y, y) - penalty.curvature(tau, y)).abs() < 1e-12);
        assert!((penalty.secant(tau, y, y * (1.0 + 1e-7)) - penalty.curvature(tau, y)).abs() < 1e-5);
    }
}

#[test]
fn the_derivatives_of_a_matrix_are_those_of_its_eigenvalues() {
    check_matrix::<2>(1);
    check_matrix::<3>(2);
}

fn check_matrix<const D: usize>(seed: u64) {
    let rows = D * (D + 1) / 2;
    let mut random = Random(seed);
    for penalty in KINDS {
        for trial in 0..30 {
            let tau = [0.5, 2.0, 7.0][trial % 3];
            let mut s: Vec<f64> = (0..rows).map(|_| random.even()).collect();
            if trial % 5 == 0 {
                // Equal eigenvalues, where eigenvectors are not differentiable but the penalty is.
                s.iter_mut().for_each(|entry| *entry = 0.0);
                (0..D).for_each(|i| s[i * (i + 3) / 2] = -0.4);
            }
            let found = penalty.of_matrix::<D>(tau, &s);
            let value = |s: &[f64]| -> f64 {
                symmetric_eigen(&from_scaled::<D>(s)).0.iter().map(|&value| penalty.value(tau, value)).sum()
            };
            assert!((found.value - value(&s)).abs() < 1e-12 * (1.0 + found.value.abs()));
            let mut square = vec![0.0; rows];
            to_scaled(&from_scaled::<D>(&s), &mut square);
            assert!(square.iter().zip(&s).all(|(a, b)| (a - b).abs() < 1e-14));
            for _ in 0..4 {
                let d: Vec<f64> = (0..rows).map(|_| random.even()).collect();
                let at = |t: f64| -> Vec<f64> { s.iter().zip(&d).map(|(s, d)| s + t * d).collect() };
                let along = |gradient: &[f64]| gradient.iter().zip(&d).map(|(g, d)| g * d).sum::<f64>();
                let h = 1e-5;
                let slope = (value(&at(h)) - value(&at(-h))) / (2.0 * h);
                assert!((along(&found.gradient) - slope).abs() < 1e-6 * (1.0 + slope.abs()), "{penalty:?} {s:?}");
                let bent: f64 = (0..rows).map(|i| d[i] * along(&found.hessian[i * rows..(i + 1) * rows])).sum();
                assert!(bent >= -1e-12);
                let gradient = |t: f64| along(&penalty.of_matrix::<D>(tau, &at(t)).gradient);
                let curvature = (gradient(h) - gradient(-h)) / (2.0 * h);
                // The quadratic penalty jumps in its curvature where an eigenvalue changes its sign.
                let near_joint = symmetric_eigen(&from_scaled::<D>(&s)).0.iter().any(|value| value.abs() < 1e-4);
                assert!(near_joint || (bent - curvature).abs() < 1e-4 * (1.0 + bent), "{penalty:?} {bent} {curvature}");
            }
        }
    }
}

#[test]
fn both_methods_end_at_the_same_optimum_of_order_rows() {
    for seed in 0..4 {
        let problem = rising(60, seed);
        let exact = solved(&problem);
        for penalty in KINDS {
            let solution = by_penalty(&problem, penalty);
            assert_eq!(solution.status, QpStatus::Solved, "{penalty:?} {:?}", solution.kkt);
            let off = (solution.objective - exact.objective).abs() / exact.objective;
            assert!(off < 1e-6, "{penalty:?}: {off}");
            let apart = solution.x.iter().zip(&exact.x).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-4, "{penalty:?}: {apart}");
        }
    }
}

#[test]
fn matrix_blocks_end_at_points_with_a_proof() {
    for (size, seed) in [(2, 5), (2, 6), (3, 7), (3, 8)] {
        let problem = matrices(size, 12, seed);
        let mut energies = Vec::new();
        for penalty in KINDS {
            let solution = by_penalty(&problem, penalty);
            assert_eq!(solution.status, QpStatus::Solved, "{penalty:?} {:?}", solution.kkt);
            // By hand: x in the cone, z in the cone, balance, gap.
            let rows = size * (size + 1) / 2;
            let mut s = problem.constraints.matrix.multiply(&solution.x);
            s.iter_mut().zip(&problem.constraints.offset).for_each(|(s, b)| *s += b);
            let least = |v: &[f64]| {
                v.chunks(rows)
                    .map(|block| match size {
                        2 => symmetric_eigen(&from_scaled::<2>(block)).0[0],
                        _ => symmetric_eigen(&from_scaled::<3>(block)).0[0],
                    })
                    .fold(f64::INFINITY, f64::min)
            };
            assert!(least(&s) > -1e-7 && least(&solution.slack) > -1e-12 && least(&solution.dual) > -1e-12);
            let mut gradient = vec![0.0; s.len()];
            problem.objective.gradient_into(&solution.x, &mut gradient);
            // A is the identity here.
            let off = gradient.iter().zip(&solution.dual).map(|(g, z)| (g - z).abs()).fold(0.0, f64::max);
            assert!(off < 1e-7, "{off}");
            let gap: f64 = s.iter().zip(&solution.dual).map(|(s, z)| s * z).sum();
            assert!(gap.abs() <= 1e-8 * solution.objective * 1.001, "{gap}");
            energies.push(solution.objective);
        }
        assert!(energies.iter().all(|energy| (energy - energies[0]).abs() < 1e-6 * energies[0]), "{energies:?}");
    }
}

#[test]
fn previews_come_at_every_step_with_rising_parameters_and_falling_violations() {
    let problem = matrices(3, 10, 3);
    for penalty in KINDS {
        let options = PenaltyOptions::with(penalty);
        let mut engine = Engine::new(&problem.objective, Some(&problem.constraints.coupling()), None).unwrap();
        let (mut seen, mut levels) = (Vec::new(), Vec::new());
        let solution = engine
            .solve_penalty(&problem, None, &Settings::default(), &options, &mut |preview| {
                assert_eq!(preview.x.len(), problem.fixed.len());
                seen.push((preview.iteration, preview.tau));
                match levels.last_mut() {
                    Some((tau, violation)) if *tau == preview.tau => *violation = preview.violation,
                    _ => levels.push((preview.tau, preview.violation)),
                }
            })
            .unwrap();
        assert_eq!(seen[0], (0, 0.0));
        assert!(seen.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[0].1 <= pair[1].1), "{seen:?}");
        assert!(levels.windows(2).all(|pair| pair[1].1 >= pair[0].1 - 1e-9), "{penalty:?} {levels:?}");
        assert!(solution.factorizations > solution.iterations, "the start counts too");
    }
}

#[test]
fn the_published_schedule_runs_to_its_end() {
    let problem = rising(40, 9);
    let exact = solved(&problem);
    let options = PenaltyOptions { until: Until::Limit, ..PenaltyOptions::default() };
    let mut engine = Engine::new(&problem.objective, Some(&problem.constraints.coupling()), None).unwrap();
    let mut last = 0.0;
    let solution = engine
        .solve_penalty(&problem, None, &Settings::default(), &options, &mut |preview| last = preview.tau)
        .unwrap();
    assert!((last / 1e13 - 1.0).abs() < 1e-9, "{last}");
    assert_eq!(solution.status, QpStatus::Solved);
    assert!((solution.objective - exact.objective).abs() < 1e-7 * exact.objective);
}

#[test]
fn nothing_violated_is_solved_at_once() {
    let problem = Problem {
        objective: distance(&[0.0, 1.0], &[1.0, 1.0]),
        fixed: vec![None; 2],
        constraints: order(2, &[(0, 1, 0.5)]),
    };
    let solution = by_penalty(&problem, Penalty::Quadratic);
    assert_eq!((solution.status, solution.iterations), (QpStatus::Solved, 0));
    assert_eq!(solution.dual, [0.0]);
}

#[test]
fn contradictions_are_never_solved() {
    // x_1 >= x_0 + 1 and x_0 >= x_1 + 1.
    let cycle = Problem {
        objective: distance(&[0.0, 0.0], &[1.0, 1.0]),
        fixed: vec![None; 2],
        constraints: order(2, &[(0, 1, 1.0), (1, 0, 1.0)]),
    };
    // A matrix with the fixed diagonal (1, 1) and off-diagonal 2 has the eigenvalue -1; the third block is harmless.
    let mut indefinite = matrices(2, 3, 4);
    for (row, value) in [1.0, 2.0 * 2f64.sqrt(), 1.0].into_iter().enumerate() {
        indefinite.fixed[row] = Some(value);
    }
    // [[x, 1], [1, -x]] has the determinant -x² - 1 for every x.
    let matrix = CsrMatrix::from_triplets(3, 1, &[(0, 0, 1.0), (2, 0, -1.0)]).unwrap();
    let opposed = Problem {
        objective: distance(&[0.3], &[1.0]),
        fixed: vec![None],
        constraints: Constraints { matrix, offset: vec![0.0, 2f64.sqrt(), 0.0], cones: vec![Cone::Psd2(1)] },
    };
    for problem in [cycle, indefinite, opposed] {
        for penalty in KINDS {
            let solution = by_penalty(&problem, penalty);
            let QpStatus::Infeasible(certificate) = &solution.status else { panic!("{penalty:?} {:?}", solution.status) };
            assert!(certificate.conflict < 0.0 && certificate.residual < 1e-5, "{certificate:?}");
            assert!(!certificate.constraints.is_empty() && certificate.ray.len() == problem.constraints.offset.len());
        }
    }
}

#[test]
fn too_few_steps_are_said() {
    let problem = rising(60, 1);
    let settings = Settings { max_iterations: 3, ..Settings::default() };
    let solution = solve_with(&problem, &Method::Penalty(PenaltyOptions::default()), None, &settings).unwrap();
    assert_eq!((solution.status, solution.iterations), (QpStatus::IterationLimit, 3));
    let short = PenaltyOptions { limit: 10.0, ..PenaltyOptions::default() };
    let solution = solve_with(&problem, &Method::Penalty(short), None, &Settings::default()).unwrap();
    assert_eq!(solution.status, QpStatus::Stalled);
    assert!(solution.kkt.primal > 1e-8);
}

#[test]
fn units_do_not_matter() {
    let problem = rising(50, 2);
    let reference = by_penalty(&problem, Penalty::Quadratic);
    for scale in [1e-8, 1e8] {
        let mut scaled = problem.clone();
        scaled.objective.linear.iter_mut().for_each(|q| *q *= scale);
        scaled.objective.constant *= scale * scale;
        scaled.fixed.iter_mut().flatten().for_each(|value| *value *= scale);
        scaled.constraints.offset.iter_mut().for_each(|b| *b *= scale);
        let solution = by_penalty(&scaled, Penalty::Quadratic);
        assert_eq!((&solution.status, solution.iterations), (&QpStatus::Solved, reference.iterations));
        let apart = solution.x.iter().zip(&reference.x).map(|(a, b)| (a / scale - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-9, "{apart}");
    }
    // An objective in other units moves nothing either.
    for scale in [1e-8, 1e8] {
        let mut scaled = problem.clone();
        for term in &mut scaled.objective.terms {
            match term {
                Term::Matrix(matrix) => {
                    let ones = vec![scale; matrix.rows()];
                    let identity: Vec<(u32, u32, f64)> = (0..matrix.rows() as u32).map(|i| (i, i, 1.0)).collect();
                    let identity = CsrMatrix::from_triplets(matrix.rows(), matrix.rows(), &identity).unwrap();
                    *matrix = identity.weighted_product(&ones, matrix);
                }
                Term::Diagonal(diagonal) => diagonal.iter_mut().for_each(|d| *d *= scale),
                Term::Chain { scale: factor, .. } => *factor *= scale,
            }
        }
        scaled.objective.linear.iter_mut().for_each(|q| *q *= scale);
        scaled.objective.constant *= scale;
        let solution = by_penalty(&scaled, Penalty::Quadratic);
        assert_eq!((&solution.status, solution.iterations), (&QpStatus::Solved, reference.iterations));
    }
}

#[test]
fn options_out_of_range_are_refused() {
    let problem = rising(10, 1);
    let good = PenaltyOptions::default();
    let bad = [
        PenaltyOptions { start: 0.0, ..good.clone() },
        PenaltyOptions { growth: 1.0, ..good.clone() },
        PenaltyOptions { limit: 0.1, ..good.clone() },
        PenaltyOptions { tolerance: f64::NAN, ..good.clone() },
        PenaltyOptions { weights: Some(vec![0.0; 9]), ..good.clone() },
    ];
    for options in bad {
        let refused = solve_with(&problem, &Method::Penalty(options), None, &Settings::default());
        assert!(matches!(refused, Err(QpError::Option { .. })), "{refused:?}");
    }
    let short = PenaltyOptions { weights: Some(vec![1.0; 3]), ..good };
    let refused = solve_with(&problem, &Method::Penalty(short), None, &Settings::default());
    assert!(matches!(refused, Err(QpError::Length { array: "penalty weights", expected: 9, found: 3 })));
}

#[test]
fn fields_have_the_same_optimum_by_both_methods() {
    for (order, case) in [(1, Case::Data), (2, Case::Data), (2, Case::NoData), (2, Case::Smooth), (3, Case::Smooth)] {
        let made = instance(25, order, case, 11);
        let mut engine = Engine::new(&made.problem.objective, None, Some(&made.coordinates)).unwrap();
        let settings = Settings::default();
        let exact = engine.solve(&made.problem, Some(&made.start), &settings, &mut |_| {}).unwrap();
        let options = PenaltyOptions::default();
        let solution = engine.solve_penalty(&made.problem, None, &settings, &options, &mut |_| {}).unwrap();
        assert_eq!(solution.status, QpStatus::Solved, "{order} {case:?} {:?}", solution.kkt);
        let off = (solution.objective - exact.objective).abs() / exact.objective;
        assert!(off < 1e-6, "{order} {case:?}: {off}");
    }
}

#[test]
fn a_given_start_changes_the_way_but_not_the_end() {
    let problem = rising(60, 5);
    let settings = Settings::default();
    let mut engine = Engine::new(&problem.objective, Some(&problem.constraints.coupling()), None).unwrap();
    let mut random = Random(8);
    let start: Vec<f64> = (0..60).map(|_| random.even()).collect();
    let options = PenaltyOptions::default();
    let far = engine.solve_penalty(&problem, Some(&start), &settings, &options, &mut |_| {}).unwrap();
    let near = engine.solve_penalty(&problem, None, &settings, &options, &mut |_| {}).unwrap();
    assert_eq!((&far.status, &near.status), (&QpStatus::Solved, &QpStatus::Solved));
    assert!((far.objective - near.objective).abs() < 1e-7 * near.objective);
    let again = engine.solve_penalty(&problem, Some(&near.x), &settings, &options, &mut |_| {}).unwrap();
    assert_eq!(again.status, QpStatus::Solved);
    let short = engine.solve_penalty(&problem, Some(&start[1..]), &settings, &options, &mut |_| {});
    assert!(matches!(short, Err(QpError::Length { array: "start", .. })));
}
