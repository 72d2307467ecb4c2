//! A deformation problem in the Conic Benchmark Format, as a linear objective over cones.

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;

use morsmooth::deform::{DeformOptions, Hold};
use morsmooth::qp::{Cone, Problem};

use super::scenes::Scene;

/// Writes `minimise t subject to (t, 1, G x - h) in the rotated cone (2 t >= |G x - h|²), S_i(x) positive semi-definite`.
///
/// G and h are the square roots of the energy: `√v_i (F_i - R_i)` for every element, `√(2 alpha) x` for every handle, over
/// displacements x from targets and rest positions; t is the energy, constant included. Variables are t, then x. Matrices are written unscaled, lower triangles.
pub fn write(path: &Path, scene: &Scene, options: DeformOptions, problem: &Problem) -> Result<(), Box<dyn Error>> {
    let Hold::Soft { alpha } = options.hold else { return Err("hard handles have no place in this export".into()) };
    let deformer = scene.deformer(options);
    let rest = deformer.rest();
    let reference = deformer.reference(&scene.targets)?;
    let gradients = rest.deformation_gradients(&reference)?;
    let dimension = rest.dimension();
    let (mut entries, mut sides) = (Vec::new(), Vec::new());
    for (element, (stretch, turn)) in gradients.iter().zip(&scene.rotations).enumerate() {
        let root = rest.measures()[element].sqrt();
        for (axis, (stretch, turn)) in stretch.iter().zip(turn).enumerate().take(dimension) {
            for column in 0..dimension {
                for (&vertex, gradient) in rest.corners(element).iter().zip(rest.gradients(element)) {
                    entries.push((sides.len() + 2, vertex as usize * dimension + axis + 1, root * gradient[column]));
                }
                sides.push(root * (stretch[column] - turn[column]));
            }
        }
    }
    for vertex in &scene.handles {
        for axis in 0..dimension {
            entries.push((sides.len() + 2, vertex.index() * dimension + axis + 1, (2.0 * alpha).sqrt()));
            sides.push(0.0);
        }
    }
    let constraints = &problem.constraints;
    let size = match constraints.cones.as_slice() {
        [Cone::Psd2(_)] => 2,
        [Cone::Psd3(_)] => 3,
        _ => return Err("one cone of matrices was expected".into()),
    };
    let triangle: Vec<(usize, usize)> = (0..size).flat_map(|a| (0..=a).map(move |b| (a, b))).collect();
    let place = |row: usize| (row / triangle.len(), triangle[row % triangle.len()]);
    let scale = |(a, b): (usize, usize)| if a == b { 1.0 } else { std::f64::consts::FRAC_1_SQRT_2 };
    let blocks = constraints.offset.len() / triangle.len();

    let mut text = String::from("# Inversion-free deformation: the energy is the first variable.\nVER\n1\n\nOBJSENSE\nMIN\n\n");
    let n = problem.fixed.len() + 1;
    write!(text, "VAR\n{n} 1\nF {n}\n\nPSDCON\n{blocks}\n")?;
    (0..blocks).try_for_each(|_| writeln!(text, "{size}"))?;
    write!(text, "\nCON\n{0} 1\nQR {0}\n\nOBJACOORD\n1\n0 1\n\nACOORD\n{1}\n0 0 1\n", sides.len() + 2, entries.len() + 1)?;
    entries.iter().try_for_each(|(row, column, value)| writeln!(text, "{row} {column} {value:e}"))?;
    let filled: Vec<_> = sides.iter().enumerate().filter(|(_, side)| **side != 0.0).collect();
    write!(text, "\nBCOORD\n{}\n1 1\n", filled.len() + 1)?;
    filled.iter().try_for_each(|(row, side)| writeln!(text, "{} {side:e}", row + 2))?;
    write!(text, "\nHCOORD\n{}\n", constraints.matrix.entries())?;
    for row in 0..constraints.offset.len() {
        let (block, (a, b)) = place(row);
        let (columns, values) = constraints.matrix.row(row);
        for (column, value) in columns.iter().zip(values) {
            writeln!(text, "{block} {} {a} {b} {:e}", column + 1, value * scale((a, b)))?;
        }
    }
    let filled: Vec<_> = constraints.offset.iter().enumerate().filter(|(_, side)| **side != 0.0).collect();
    write!(text, "\nDCOORD\n{}\n", filled.len())?;
    for (row, side) in filled {
        let (block, (a, b)) = place(row);
        writeln!(text, "{block} {a} {b} {:e}", side * scale((a, b)))?;
    }
    std::fs::write(path, text)?;
    Ok(())
}
