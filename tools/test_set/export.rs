//! Problems in files that any solver can read; README.md beside this file documents every field.

use std::error::Error;
use std::io::{BufWriter, Write};
use std::path::Path;

use morsmooth::linalg::CsrMatrix;
use morsmooth::qp::{Cone, Problem, Solution, Term};
use serde_json::{Value, json};

/// Whether P is written as one matrix, besides its factors.
#[derive(Clone, Copy, PartialEq)]
pub enum Formed {
    Yes,
    No,
}

/// Writes `problem.json` and the matrices of a problem into a folder that exists.
///
/// # Arguments
/// * `more`: entries added to the JSON object.
pub fn write(folder: &Path, problem: &Problem, formed: Formed, more: &[(&str, Value)]) -> Result<(), Box<dyn Error>> {
    let n = problem.fixed.len();
    let (mut chain, mut diagonal, mut rest) = (None, vec![0.0; n], Vec::new());
    for term in &problem.objective.terms {
        match term {
            Term::Chain { scale, stiffness, weights, order } if chain.is_none() => chain = Some((*scale, stiffness, weights, *order)),
            Term::Diagonal(values) => diagonal.iter_mut().zip(values).for_each(|(slot, value)| *slot += value),
            Term::Matrix(matrix) => push(&mut rest, matrix, 1.0),
            Term::Chain { .. } => return Err("an objective with two chains has no place in this format".into()),
        }
    }
    let empty = CsrMatrix::from_triplets(n, n, &[])?;
    let nothing = vec![0.0; n];
    let (scale, stiffness, weights, order) = chain.unwrap_or((0.0, &empty, &nothing, 1));
    if formed == Formed::Yes {
        let mut product = stiffness.clone();
        for _ in 1..order {
            product = stiffness.weighted_product(weights, &product);
        }
        let mut triplets = rest.clone();
        push(&mut triplets, &product, scale);
        triplets.extend(diagonal.iter().enumerate().map(|(i, &value)| (i as u32, i as u32, value)));
        matrix_market(&folder.join("P.mtx"), &symmetric(n, &triplets)?, Triangle::Lower)?;
    }
    matrix_market(&folder.join("L.mtx"), stiffness, Triangle::Lower)?;
    if !rest.is_empty() {
        matrix_market(&folder.join("Q.mtx"), &symmetric(n, &rest)?, Triangle::Lower)?;
    }
    matrix_market(&folder.join("A.mtx"), &problem.constraints.matrix, Triangle::Both)?;
    let mut object = json!({
        "linear": problem.objective.linear, "constant": problem.objective.constant, "fixed": problem.fixed,
        "offset": problem.constraints.offset, "scale": scale, "weights": weights, "order": order, "diagonal": diagonal,
        "cones": problem.constraints.cones.iter().map(cone).collect::<Vec<_>>(),
    });
    for (name, value) in more {
        object[*name] = value.clone();
    }
    serde_json::to_writer(BufWriter::new(std::fs::File::create(folder.join("problem.json"))?), &object)?;
    Ok(())
}

/// A solution as it stands in the JSON.
pub fn solution(solution: &Solution) -> Value {
    json!({
        "x": solution.x, "dual": solution.dual, "objective": solution.objective, "status": solution.status,
        "kkt": solution.kkt, "iterations": solution.iterations, "factorizations": solution.factorizations,
        "solves": solution.solves, "seconds": solution.timings.total,
    })
}

fn cone(cone: &Cone) -> Value {
    match cone {
        Cone::NonNegative(rows) => json!({"cone": "nonnegative", "count": rows}),
        Cone::Psd2(blocks) => json!({"cone": "psd2", "count": blocks}),
        Cone::Psd3(blocks) => json!({"cone": "psd3", "count": blocks}),
        _ => Value::Null,
    }
}

fn push(triplets: &mut Vec<(u32, u32, f64)>, matrix: &CsrMatrix, scale: f64) {
    for row in 0..matrix.rows() {
        let (columns, values) = matrix.row(row);
        triplets.extend(columns.iter().zip(values).map(|(&column, &value)| (row as u32, column, scale * value)));
    }
}

/// A product is symmetric up to rounding; the mean of both triangles is exactly so.
fn symmetric(n: usize, triplets: &[(u32, u32, f64)]) -> Result<CsrMatrix, Box<dyn Error>> {
    let mirrored: Vec<_> = triplets.iter().flat_map(|&(i, j, value)| [(i, j, 0.5 * value), (j, i, 0.5 * value)]).collect();
    Ok(CsrMatrix::from_triplets(n, n, &mirrored)?)
}

#[derive(Clone, Copy, PartialEq)]
enum Triangle {
    Both,
    Lower,
}

fn matrix_market(path: &Path, matrix: &CsrMatrix, triangle: Triangle) -> Result<(), Box<dyn Error>> {
    let is_written = |row: usize, column: u32| triangle == Triangle::Both || column as usize <= row;
    let kind = if triangle == Triangle::Both { "general" } else { "symmetric" };
    let count: usize = (0..matrix.rows()).map(|row| matrix.row(row).0.iter().filter(|&&j| is_written(row, j)).count()).sum();
    let mut file = BufWriter::new(std::fs::File::create(path)?);
    writeln!(file, "%%MatrixMarket matrix coordinate real {kind}\n{} {} {count}", matrix.rows(), matrix.columns())?;
    for row in 0..matrix.rows() {
        let (columns, values) = matrix.row(row);
        for (&column, value) in columns.iter().zip(values) {
            if is_written(row, column) {
                writeln!(file, "{} {} {value:e}", row + 1, column + 1)?;
            }
        }
    }
    Ok(file.flush()?)
}
