//! The factorisation over the tree: every shape of tree, the same bits for every number of threads.

use morsmooth::linalg::{
    Cholesky, CsrMatrix, Factor, FactorError, Permutation, SymbolicCholesky, Value, fill_reducing_order, minimum_degree,
    nested_dissection,
};
use proptest::prelude::*;

use super::{grid, squared, values_of};

fn solutions(symbolic: &SymbolicCholesky, matrix: &CsrMatrix, sides: &[f64], columns: usize) -> Vec<f64> {
    let mut factor = Cholesky::new(symbolic, columns);
    factor.factor(symbolic, &values_of(symbolic, matrix)).unwrap();
    let mut x = sides.to_vec();
    factor.solve_in_place(symbolic, &mut x);
    x
}

/// Largest residual of all sides, relative to the row sums of |A| |x|.
fn residual(matrix: &CsrMatrix, x: &[f64], sides: &[f64]) -> f64 {
    let n = matrix.rows();
    let mut most: f64 = 0.0;
    for (x, side) in x.chunks(n).zip(sides.chunks(n)) {
        let size: Vec<f64> = x.iter().map(|x| x.abs()).collect();
        let mut scale = vec![0.0; n];
        matrix.multiply_absolute_into(&size, &mut scale);
        for ((y, b), scale) in matrix.multiply(x).iter().zip(side).zip(&scale) {
            most = most.max((y - b).abs() / (scale + b.abs()));
        }
    }
    most
}

fn sides(n: usize, count: usize) -> Vec<f64> {
    (0..n * count).map(|i| (i as f64 * 0.37).sin()).collect()
}

fn in_pool<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// Backward stable solves leave a few ulps times the length of the sums.
const SMALL: f64 = 1e-13;

#[test]
fn large_plane_surface_and_volume_solve_with_the_same_bits_on_one_two_and_three_threads() {
    // Large enough for several tasks and for fronts cut into tiles.
    let plane = grid(150, 2);
    let volume = grid(24, 3);
    // A sphere of latitude circles, folded in space.
    let mut sphere = grid(140, 2);
    for place in &mut sphere.1 {
        let (u, v) = (place[0] / 139.0 * 3.0, place[1] / 139.0 * 6.2);
        *place = [u.sin() * v.cos(), u.sin() * v.sin(), u.cos()];
    }
    for (matrix, places) in [plane, volume, sphere] {
        let matrix = squared(&matrix);
        let n = matrix.rows();
        for order in [minimum_degree(&matrix).unwrap(), nested_dissection(&matrix, &places).unwrap()] {
            let symbolic = SymbolicCholesky::new(&matrix, order).unwrap();
            let sides = sides(n, 3);
            let of_threads = |threads| {
                in_pool(threads, || (solutions(&symbolic, &matrix, &sides, 4), solutions(&symbolic, &matrix, &sides[..n], 1)))
            };
            let one = of_threads(1);
            assert!(residual(&matrix, &one.0, &sides) < SMALL);
            assert!(residual(&matrix, &one.1, &sides[..n]) < SMALL);
            for threads in [2, 3] {
                assert!(of_threads(threads) == one, "{threads} threads");
            }
        }
    }
}

#[test]
fn a_factor_can_be_filled_again_and_again() {
    let (matrix, places) = grid(90, 2);
    let matrix = squared(&matrix);
    let symbolic = SymbolicCholesky::new(&matrix, nested_dissection(&matrix, &places).unwrap()).unwrap();
    let values = values_of(&symbolic, &matrix);
    let mut factor = Cholesky::new(&symbolic, 8);
    let wanted = sides(matrix.rows(), 8);
    let mut first: Option<Vec<f64>> = None;
    for round in 0..3 {
        if round == 1 {
            // A failure in between must leave no trace.
            let spoilt: Vec<f64> = values.iter().map(|value| -value).collect();
            assert!(matches!(factor.factor(&symbolic, &spoilt), Err(FactorError::NonPositivePivot { .. })));
        }
        factor.factor(&symbolic, &values).unwrap();
        let mut x = wanted.clone();
        factor.solve_in_place(&symbolic, &mut x);
        assert!(residual(&matrix, &x, &wanted) < SMALL);
        assert!(first.get_or_insert_with(|| x.clone()) == &x);
    }
}

#[test]
fn the_first_bad_pivot_is_named_on_every_number_of_threads() {
    let (matrix, places) = grid(120, 2);
    let matrix = squared(&matrix);
    let symbolic = SymbolicCholesky::new(&matrix, nested_dissection(&matrix, &places).unwrap()).unwrap();
    let mut values = values_of(&symbolic, &matrix);
    let inverse = symbolic.order().inverse();
    // Diagonal entries so negative that nothing can mend them; one bad unknown must be named first, whichever runs first.
    let bad = [100usize, 7_000, 14_000];
    for &unknown in &bad {
        values[symbolic.slot(unknown, unknown).unwrap() as usize] = -1e9;
    }
    let first = bad.into_iter().min_by_key(|&unknown| inverse[unknown]).unwrap();
    for threads in [1, 2, 3] {
        let failed = in_pool(threads, || Cholesky::new(&symbolic, 1).factor(&symbolic, &values));
        assert_eq!(failed, Err(FactorError::NonPositivePivot { unknown: first }));
    }
    let slot = symbolic.slot(first, first).unwrap() as usize;
    values[slot] = f64::NAN;
    let failed = Cholesky::new(&symbolic, 1).factor(&symbolic, &values);
    assert_eq!(failed, Err(FactorError::NonPositivePivot { unknown: first }));
}

#[test]
fn chains_stars_and_forests() {
    let with = |n: usize, edges: &dyn Fn(usize) -> Vec<usize>| {
        let mut triplets: Vec<(u32, u32, f64)> = (0..n as u32).map(|i| (i, i, 1.0)).collect();
        for i in 0..n {
            for j in edges(i).into_iter().filter(|&j| j < n && j != i) {
                let (a, b) = (i as u32, j as u32);
                triplets.extend([(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)]);
            }
        }
        CsrMatrix::from_triplets(n, n, &triplets).unwrap()
    };
    let shapes = [
        ("a chain", with(5_000, &|i| vec![i + 1])),
        ("a band", with(3_000, &|i| (1..20).map(|step| i + step).collect())),
        ("a star", with(3_000, &|i| if i > 0 { vec![0] } else { vec![] })),
        ("points", with(2_000, &|_| vec![])),
        ("islands", with(6_000, &|i| if i % 40 < 39 { vec![i + 1, i + 2, i + 3] } else { vec![] })),
    ];
    for (name, matrix) in shapes {
        let n = matrix.rows();
        let orders = [
            Permutation::identity(n),
            Permutation::new((0..n as u32).rev().collect()).unwrap(),
            minimum_degree(&matrix).unwrap(),
        ];
        for (place, order) in orders.into_iter().enumerate() {
            if name == "a star" && place == 0 {
                // The hub first fills everything.
                continue;
            }
            let symbolic = SymbolicCholesky::new(&matrix, order).unwrap();
            let sides = sides(n, 1);
            let x = solutions(&symbolic, &matrix, &sides, 1);
            assert!(residual(&matrix, &x, &sides) < SMALL, "{name}, order {place}");
        }
    }
}

#[test]
fn many_equal_islands_are_shared_among_tasks() {
    let (one, _) = grid(40, 2);
    let one = squared(&one);
    let (size, count) = (one.rows(), 60);
    let mut triplets = Vec::new();
    for island in 0..count {
        for row in 0..size {
            let (columns, values) = one.row(row);
            let shift = (island * size) as u32;
            triplets.extend(columns.iter().zip(values).map(|(&column, &value)| (row as u32 + shift, column + shift, value)));
        }
    }
    let matrix = CsrMatrix::from_triplets(size * count, size * count, &triplets).unwrap();
    let symbolic = SymbolicCholesky::new(&matrix, fill_reducing_order(&matrix, None).unwrap()).unwrap();
    let sides = sides(matrix.rows(), 1);
    let one = in_pool(1, || solutions(&symbolic, &matrix, &sides, 1));
    assert!(residual(&matrix, &one, &sides) < SMALL);
    assert!(in_pool(2, || solutions(&symbolic, &matrix, &sides, 1)) == one);
}

#[test]
fn single_precision_preconditions() {
    let (matrix, places) = grid(60, 2);
    let symbolic = SymbolicCholesky::new(&matrix, nested_dissection(&matrix, &places).unwrap()).unwrap();
    let mut factor = Factor::<f32>::new(&symbolic, 1);
    factor.factor(&symbolic, &values_of(&symbolic, &matrix)).unwrap();
    let side = sides(matrix.rows(), 1);
    let mut x = vec![0.0; side.len()];
    let mut remaining = side.clone();
    let mut sizes = Vec::new();
    for _ in 0..4 {
        factor.solve_in_place(&symbolic, &mut remaining);
        x.iter_mut().zip(&remaining).for_each(|(x, step)| *x += step);
        remaining = matrix.multiply(&x).iter().zip(&side).map(|(y, b)| b - y).collect();
        sizes.push(remaining.iter().fold(0.0, |most: f64, r| most.max(r.abs())));
    }
    // Condition at most 9, so each round gains about six digits until double precision is reached.
    assert!(sizes[0] > 1e-9 && sizes[1] < 1e-9 && sizes[3] < 1e-14, "{sizes:?}");
    assert_eq!((1.5f32.get(), f64::of(1.5)), (1.5, 1.5));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Random patterns with a dominant diagonal: any tree, any widths of supernodes.
    #[test]
    fn random_matrices_solve(n in 1usize..120, pairs in proptest::collection::vec((0usize..120, 0usize..120, -1.0f64..1.0), 0..400), count in 1usize..10) {
        let mut triplets: Vec<(u32, u32, f64)> = (0..n as u32).map(|i| (i, i, 0.5)).collect();
        for (i, j, value) in pairs {
            let (a, b) = ((i % n) as u32, (j % n) as u32);
            if a != b {
                triplets.extend([(a, b, value), (b, a, value), (a, a, value.abs()), (b, b, value.abs())]);
            }
        }
        let matrix = CsrMatrix::from_triplets(n, n, &triplets).unwrap();
        let symbolic = SymbolicCholesky::new(&matrix, minimum_degree(&matrix).unwrap()).unwrap();
        let sides = sides(n, count);
        let x = solutions(&symbolic, &matrix, &sides, 8);
        prop_assert!(residual(&matrix, &x, &sides) < SMALL);
        // Sides do not influence one another.
        let alone = solutions(&symbolic, &matrix, &sides[..n], 1);
        prop_assert!(x[..n].iter().zip(&alone).all(|(a, b)| (a - b).abs() < 1e-12 * (1.0 + b.abs())));
    }
}
