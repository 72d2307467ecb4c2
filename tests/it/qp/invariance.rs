//! The same problem in other units, and on other numbers of threads.

use morsmooth::qp::{Engine, QpStatus, Settings, Solution, Term};

use super::problems::{Case, Instance, instance};

fn solution(made: &Instance) -> Solution {
    let mut engine = Engine::new(&made.problem.objective, None, Some(&made.coordinates)).unwrap();
    let solution = engine.solve(&made.problem, Some(&made.start), &Settings::default(), &mut |_| {}).unwrap();
    assert_eq!(solution.status, QpStatus::Solved);
    solution
}

#[test]
fn units_of_energy_and_of_values_do_not_matter() {
    let reference = instance(40, 2, Case::Data, 21);
    let known = solution(&reference);
    for (energy, values) in [(1e8, 1.0), (1e-8, 1.0), (1.0, 1e8), (1.0, 1e-8), (1e8, 1e-8)] {
        let mut made = instance(40, 2, Case::Data, 21);
        for term in &mut made.problem.objective.terms {
            match term {
                Term::Chain { scale, .. } => *scale *= energy,
                Term::Diagonal(diagonal) => diagonal.iter_mut().for_each(|d| *d *= energy),
                Term::Matrix(_) => {}
            }
        }
        made.problem.objective.linear.iter_mut().for_each(|q| *q *= energy * values);
        made.problem.objective.constant *= energy * values * values;
        made.problem.fixed.iter_mut().flatten().for_each(|v| *v *= values);
        made.start.iter_mut().for_each(|x| *x *= values);
        let scaled = solution(&made);
        let ratio = scaled.objective / (known.objective * energy * values * values);
        assert!((ratio - 1.0).abs() < 1e-8, "{energy:e} {values:e}: {ratio}");
        assert!(scaled.x.iter().zip(&known.x).all(|(x, k)| (x - values * k).abs() < 1e-5 * values));
        assert_eq!(scaled.iterations, known.iterations);
    }
}

#[test]
fn the_same_bits_on_one_thread_and_on_two() {
    // More than one chunk of every parallel product.
    let made = instance(110, 2, Case::Smooth, 3);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solution(&made))
    };
    let (one, two) = (on(1), on(2));
    assert!(one.x.iter().zip(&two.x).all(|(a, b)| a.to_bits() == b.to_bits()));
    assert!(one.dual.iter().zip(&two.dual).all(|(a, b)| a.to_bits() == b.to_bits()));
    assert_eq!((one.iterations, one.kkt, one.objective.to_bits()), (two.iterations, two.kkt, two.objective.to_bits()));
}
