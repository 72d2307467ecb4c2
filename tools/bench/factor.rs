//! The sparse Cholesky factorisation beside faer's own supernodal driver, on polyharmonic matrices of jittered grids.
//!
//! ```text
//! cargo run --release --example factor -- [sides 123,241,500] [orders 2,3] [repeats 5]
//! ```
//!
//! Wall and processor seconds (all threads), the least of several runs. Sides above 700 want several GiB.
#![allow(clippy::print_stdout, clippy::unwrap_used, dead_code)]

#[path = "clock.rs"]
mod clock;
#[path = "problems.rs"]
mod problems;

use clock::processor_seconds;
use std::time::Instant;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{simplicial, supernodal};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par};
use morsmooth::linalg::{Cholesky, CsrMatrix, SymbolicCholesky, fill_reducing_order};
use problems::{Random, jittered_grid, laplacian};

/// The least wall and processor seconds of several runs.
fn best(repeats: usize, mut work: impl FnMut()) -> (f64, f64) {
    let mut least = (f64::INFINITY, f64::INFINITY);
    for _ in 0..repeats {
        let (wall, spent) = (Instant::now(), processor_seconds());
        work();
        least.0 = least.0.min(wall.elapsed().as_secs_f64());
        least.1 = least.1.min(processor_seconds() - spent);
    }
    least
}

/// `L (M^-1 L)^(k-1) + omega M` of a jittered grid, smoothing length 2 % of the side.
fn polyharmonic(side: usize, order: usize) -> (CsrMatrix, Vec<[f64; 3]>) {
    let (points, triangles) = jittered_grid(side, 0.2, &mut Random(7));
    let (stiffness, mass) = laplacian(&points, &triangles, None);
    let weights: Vec<f64> = mass.iter().map(|m| 1.0 / m).collect();
    let mut product = stiffness.clone();
    for _ in 1..order {
        product = stiffness.weighted_product(&weights, &product);
    }
    let omega = (0.02 * side as f64).powi(-2 * order as i32);
    let mut triplets = Vec::with_capacity(product.entries());
    for (row, mass) in mass.iter().enumerate() {
        let (columns, values) = product.row(row);
        triplets.extend(columns.iter().zip(values).map(|(&column, &value)| {
            (row as u32, column, value + if column as usize == row { omega * mass } else { 0.0 })
        }));
    }
    (CsrMatrix::from_triplets(product.rows(), product.rows(), &triplets).unwrap(), points)
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let list = |index: usize, default: &str| -> Vec<usize> {
        arguments.get(index).map_or(default, |text| text).split(',').map(|text| text.parse().unwrap()).collect()
    };
    let repeats = list(2, "5")[0];
    // Alive to the end, since the seconds of threads that have ended are lost.
    let pools = [1, 2].map(|threads| (threads, rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()));
    println!("| n | k | order s | analysis s | nnz(L) | stored | GF | who | threads | factor wall s (processor) | GF/s | solve s | 8 solves s |");
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for side in list(0, "123,241,500") {
        for order in list(1, "2,3") {
            let (matrix, places) = polyharmonic(side, order);
            run(&matrix, &places, (order, repeats), &pools);
        }
    }
}

fn run(matrix: &CsrMatrix, places: &[[f64; 3]], (order, repeats): (usize, usize), pools: &[(usize, rayon::ThreadPool)]) {
    let n = matrix.rows();
    let mut permutation = None;
    let ordering = best(1, || permutation = Some(fill_reducing_order(matrix, Some(places)).unwrap()));
    let permutation = permutation.unwrap();
    let mut symbolic = None;
    let analysis = best(1, || symbolic = Some(SymbolicCholesky::new(matrix, permutation.clone()).unwrap()));
    let symbolic = symbolic.unwrap();
    let mut values = vec![0.0; symbolic.entries()];
    for row in 0..n {
        let (columns, entries) = matrix.row(row);
        for (&column, &entry) in columns.iter().zip(entries) {
            if symbolic.is_stored(row, column as usize) {
                values[symbolic.slot(row, column as usize).unwrap() as usize] = entry;
            }
        }
    }
    let gigaflops = symbolic.factor_flops() * 1e-9;
    let head = format!(
        "| {n} | {order} | {:.2} | {:.2} | {:.3e} | {:.3e} | {gigaflops:.2} |",
        ordering.1,
        analysis.1,
        symbolic.factor_entries() as f64,
        symbolic.stored_entries() as f64
    );
    let known: Vec<f64> = (0..8 * n).map(|i| (i as f64 * 0.37).sin()).collect();
    let mut answers: Vec<Vec<f64>> = Vec::new();
    for (threads, pool) in pools {
        pool.install(|| {
            let mut factor = Cholesky::new(&symbolic, 8);
            let factored = best(repeats + 1, || factor.factor(&symbolic, &values).unwrap());
            let mut one = known[..n].to_vec();
            let solved = best(repeats, || {
                one.copy_from_slice(&known[..n]);
                factor.solve_in_place(&symbolic, &mut one);
            });
            let mut many = known.clone();
            let several = best(repeats, || {
                many.copy_from_slice(&known);
                factor.solve_in_place(&symbolic, &mut many);
            });
            println!(
                "{head} own | {threads} | {:.4} ({:.4}) | {:.1} | {:.4} ({:.4}) | {:.4} ({:.4}) |",
                factored.0, factored.1, gigaflops / factored.1, solved.0, solved.1, several.0, several.1
            );
            one.extend(many);
            answers.push(one);
        });
    }
    assert!(answers[0] == answers[1], "the bits depend on the threads");
    drop(symbolic);
    faers(matrix, permutation.order(), &head, repeats);
}

/// The same matrix under the same order with faer's supernodal driver, one thread.
fn faers(matrix: &CsrMatrix, order: &[u32], head: &str, repeats: usize) {
    let n = matrix.rows();
    let mut inverse = vec![0u32; n];
    order.iter().enumerate().for_each(|(new, &old)| inverse[old as usize] = new as u32);
    let mut triplets = Vec::with_capacity(matrix.entries());
    for row in 0..n {
        let (columns, values) = matrix.row(row);
        triplets.extend(columns.iter().zip(values).map(|(&column, &value)| (inverse[row], inverse[column as usize], value)));
    }
    // By columns, as the matrix is symmetric; the lower triangle of the permuted matrix is the upper one by columns.
    let upper = |keep: fn(u32, u32) -> bool| {
        let kept: Vec<(u32, u32, f64)> = triplets.iter().copied().filter(|&(row, column, _)| keep(row, column)).collect();
        let matrix = CsrMatrix::from_triplets(n, n, &kept).unwrap();
        let (mut starts, mut indices, mut values) = (vec![0u32], Vec::new(), Vec::new());
        for row in 0..n {
            indices.extend_from_slice(matrix.row(row).0);
            values.extend_from_slice(matrix.row(row).1);
            starts.push(indices.len() as u32);
        }
        (starts, indices, values)
    };
    let (starts, indices, _) = upper(|row, column| column <= row);
    let above = SymbolicSparseColMatRef::<u32>::new_checked(n, n, &starts, None, &indices);
    let (mut tree, mut counts) = (vec![0i32; n], vec![0u32; n]);
    let scratch = simplicial::prefactorize_symbolic_cholesky_scratch::<u32>(n, indices.len())
        .or(supernodal::factorize_supernodal_symbolic_cholesky_scratch::<u32>(n));
    let mut memory = MemBuffer::new(scratch);
    let tree = simplicial::prefactorize_symbolic_cholesky(&mut tree, &mut counts, above, MemStack::new(&mut memory));
    let structure =
        supernodal::factorize_supernodal_symbolic_cholesky(above, tree, &counts, MemStack::new(&mut memory), Default::default())
            .unwrap();
    let (starts, indices, entries) = upper(|row, column| column >= row);
    let below = SparseColMatRef::new(SymbolicSparseColMatRef::<u32>::new_checked(n, n, &starts, None, &indices), &entries);
    let mut values = vec![0.0; structure.len_val()];
    let scratch = supernodal::factorize_supernodal_numeric_llt_scratch::<u32, f64>(&structure, Par::Seq, Default::default())
        .or(structure.solve_in_place_scratch::<f64>(8, Par::Seq));
    let mut memory = MemBuffer::new(scratch);
    let flops: f64 = counts.iter().map(|&count| f64::from(count).powi(2)).sum();
    let factored = best(repeats + 1, || {
        supernodal::factorize_supernodal_numeric_llt(
            &mut values,
            below,
            Default::default(),
            &structure,
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        )
        .unwrap();
    });
    let mut sides = vec![1.0; 8 * n];
    let factor = supernodal::SupernodalLltRef::new(&structure, &values);
    let mut solve = |columns: usize| {
        best(repeats, || {
            let view = MatMut::from_column_major_slice_mut(&mut sides[..columns * n], n, columns);
            factor.solve_in_place_with_conj(Conj::No, view, Par::Seq, MemStack::new(&mut memory));
        })
    };
    let (solved, several) = (solve(1), solve(8));
    println!(
        "{head} faer | 1 | {:.4} ({:.4}) | {:.1} | {:.4} ({:.4}) | {:.4} ({:.4}) |",
        factored.0, factored.1, flops * 1e-9 / factored.1, solved.0, solved.1, several.0, several.1
    );
}
