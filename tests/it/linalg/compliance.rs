//! What forces on some rows move them by: the same as by solves, for every kind of factor.

use morsmooth::linalg::{
    Cholesky, Compliance, CsrMatrix, Factor, Lblt, SparseRow, SymbolicCholesky, minimum_degree, nested_dissection, solve_symmetric,
};

use super::{grid, values_of};

/// `B A⁻¹ Bᵀ` by solves.
fn by_solves(rows: &[SparseRow], n: usize, mut solve: impl FnMut(&mut [f64])) -> Vec<Vec<f64>> {
    let dense = |row: &SparseRow| {
        let mut side = vec![0.0; n];
        row.iter().for_each(|&(unknown, value)| side[unknown as usize] += value);
        side
    };
    let solved = rows.iter().map(|row| {
        let mut side = dense(row);
        solve(&mut side);
        side
    });
    let solved: Vec<Vec<f64>> = solved.collect();
    let product = |row: &SparseRow, side: &[f64]| row.iter().map(|&(unknown, value)| value * side[unknown as usize]).sum();
    solved.iter().map(|side| rows.iter().map(|row| product(row, side)).collect()).collect()
}

/// Neighbours, unknowns far apart, single unknowns, an unknown named twice: enough rows for three chunks.
fn sparse_rows(n: usize) -> Vec<SparseRow> {
    let n = n as u32;
    let neighbours = (0..n - 1).step_by(7).map(|i| vec![(i, 1.0), (i + 1, -1.0)]);
    let distant = (0..n / 2).step_by(31).map(|i| vec![(i, 2.0), (n - 1 - i, 0.5), (n / 2, 1.0)]);
    neighbours.chain(distant).chain([vec![(3, 1.0)], vec![(5, 1.0), (5, 1.0)]]).collect()
}

#[test]
fn compliances_are_those_of_solves() {
    let (matrix, places) = grid(30, 2);
    let n = matrix.rows();
    let rows = sparse_rows(n);
    let symbolic = SymbolicCholesky::new(&matrix, nested_dissection(&matrix, &places).unwrap()).unwrap();
    let values = values_of(&symbolic, &matrix);
    let mut double = Cholesky::new(&symbolic, 1);
    double.factor(&symbolic, &values).unwrap();
    let wanted = by_solves(&rows, n, |side| double.solve_in_place(&symbolic, side));
    let mut single = Factor::<f32>::new(&symbolic, 1);
    single.factor(&symbolic, &values).unwrap();
    let mut pivoted = Lblt::new(&symbolic, 1);
    pivoted.factor(&symbolic, &values).unwrap();
    // In parts, each with what was there before.
    for parts in [vec![rows.len()], vec![1, 70, 71, rows.len()]] {
        let mut all = [Compliance::new(), Compliance::new(), Compliance::new()];
        let mut from = 0;
        for to in parts {
            double.comply(&symbolic, &mut all[0], &rows[from..to]);
            single.comply(&symbolic, &mut all[1], &rows[from..to]);
            pivoted.comply(&symbolic, &mut all[2], &rows[from..to]);
            from = to;
        }
        for (compliance, tolerance) in all.iter().zip([1e-13, 1e-5, 1e-13]) {
            assert_eq!(compliance.size(), rows.len());
            for (i, wanted) in wanted.iter().enumerate() {
                assert!((0..rows.len()).all(|j| (compliance.at(i, j) - wanted[j]).abs() < tolerance));
            }
        }
    }
}

#[test]
fn compliances_of_indefinite_matrices_are_those_of_solves() {
    // A saddle: the grid's matrix above, minus the identity below, the unknowns of both coupled one to one.
    let (grid, _) = grid(12, 2);
    let n = grid.rows();
    let mut triplets = Vec::new();
    for row in 0..n {
        let (columns, values) = grid.row(row);
        triplets.extend(columns.iter().zip(values).map(|(&column, &value)| (row as u32, column, value)));
        let (one, other) = (row as u32, (n + row) as u32);
        triplets.extend([(one, other, 3.0), (other, one, 3.0), (other, other, -1.0)]);
    }
    let matrix = CsrMatrix::from_triplets(2 * n, 2 * n, &triplets).unwrap();
    let symbolic = SymbolicCholesky::new(&matrix, minimum_degree(&matrix).unwrap()).unwrap();
    let mut factor = Lblt::new(&symbolic, 1);
    factor.factor(&symbolic, &values_of(&symbolic, &matrix)).unwrap();
    let rows = sparse_rows(2 * n);
    let wanted = by_solves(&rows, 2 * n, |side| factor.solve_in_place(&symbolic, side));
    let mut compliance = Compliance::new();
    factor.comply(&symbolic, &mut compliance, &rows);
    assert!(wanted.iter().enumerate().all(|(i, wanted)| (0..rows.len()).all(|j| (compliance.at(i, j) - wanted[j]).abs() < 1e-12)));
}

#[test]
fn dense_symmetric_systems_are_solved_whatever_their_signs() {
    let n = 90;
    let entry = |i: usize, j: usize| ((i * 31 + j * 31) as f64).sin() + if i == j { if i.is_multiple_of(3) { -7.0 } else { 5.0 } } else { 0.0 };
    let known: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
    let mut side: Vec<f64> = (0..n).map(|i| (0..n).map(|j| entry(i.max(j), i.min(j)) * known[j]).sum()).collect();
    solve_symmetric(entry, &mut side);
    assert!(side.iter().zip(&known).all(|(x, y)| (x - y).abs() < 1e-11));
    solve_symmetric(|_, _| 0.0, &mut []);
}
