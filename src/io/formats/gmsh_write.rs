//! Writing Gmsh `.msh`, version 4.1, ascii.

use std::io::{BufWriter, Write};

use crate::io::array::{ArrayData, DataArray};
use crate::io::dataset::DataSet;

use super::gmsh::ELEMENTS;
use super::shapes::Shapes;

/// Writes nodes, elements and every numeric array, as double precision.
pub(super) fn write<W: Write>(shapes: &Shapes<'_>, dataset: &DataSet, out: &mut BufWriter<W>) -> std::io::Result<()> {
    let points = shapes.point_count();
    writeln!(out, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 {points} 1 {points}")?;
    let dimension = |kind: u8| match kind {
        1 => 0,
        3 => 1,
        5 | 9 => 2,
        _ => 3,
    };
    let top = shapes.cells().map(|(kind, _)| dimension(kind)).max().unwrap_or(0);
    writeln!(out, "{top} 1 0 {points}")?;
    for point in 1..=points {
        writeln!(out, "{point}")?;
    }
    shapes.write_points(out, "", "")?;
    // Runs of one kind are blocks, so that elements keep their order.
    let cells: Vec<(u8, &[i64])> = shapes.cells().collect();
    let runs: Vec<&[(u8, &[i64])]> = cells.chunk_by(|a, b| a.0 == b.0).collect();
    writeln!(out, "$EndNodes\n$Elements\n{} {} 1 {}", runs.len(), cells.len(), cells.len())?;
    let mut element = 0;
    for run in runs {
        let kind = run[0].0;
        let number = ELEMENTS.iter().find(|known| known.1 == kind).map_or(0, |known| known.0);
        writeln!(out, "{} 1 {number} {}", dimension(kind), run.len())?;
        for (_, corners) in run {
            element += 1;
            write!(out, "{element}")?;
            for corner in *corners {
                write!(out, " {}", corner + 1)?;
            }
            out.write_all(b"\n")?;
        }
    }
    out.write_all(b"$EndElements\n")?;
    for array in &dataset.point_data.arrays {
        write_data(out, "NodeData", array)?;
    }
    for array in &dataset.cell_data.arrays {
        write_data(out, "ElementData", array)?;
    }
    Ok(())
}

fn write_data<W: Write>(out: &mut BufWriter<W>, section: &str, array: &DataArray) -> std::io::Result<()> {
    if matches!(array.data, ArrayData::String(_)) {
        return Ok(());
    }
    let name = array.name.replace(['"', '\n', '\r'], "_");
    writeln!(out, "${section}\n1\n\"{name}\"\n1\n0\n3\n0\n{}\n{}", array.components, array.tuples())?;
    for tuple in 0..array.tuples() {
        write!(out, "{}", tuple + 1)?;
        for component in 0..array.components {
            write!(out, " {:?}", array.data.number(tuple * array.components + component).unwrap_or(f64::NAN))?;
        }
        out.write_all(b"\n")?;
    }
    writeln!(out, "$End{section}")
}
