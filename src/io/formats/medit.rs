//! Medit `.mesh`, ascii (Frey 2001): points, edges, triangles, quads, tetrahedra and hexahedra with their labels.

use std::io::{BufWriter, Write};

use crate::io::array::{ArrayData, DataArray};
use crate::io::dataset::DataSet;
use crate::io::error::{Fault, Place, quoted};
use crate::io::lexer::Lexer;

use super::parts::{Parts, kind};
use super::shapes::Shapes;

/// Name of the arrays of labels, as the program meshio has it.
pub(super) const LABEL: &str = "medit:ref";

/// Keyword, kind and number of corners of each list of cells; the first keyword of a kind is the one written.
const LISTS: [(&str, u8, usize); 9] = [
    ("Edges", kind::LINE, 2),
    ("Triangles", kind::TRIANGLE, 3),
    ("Quadrilaterals", kind::QUAD, 4),
    ("Tetrahedra", kind::TETRAHEDRON, 4),
    ("Hexahedra", kind::HEXAHEDRON, 8),
    ("Hexaedra", kind::HEXAHEDRON, 8),
    ("Prisms", kind::WEDGE, 6),
    ("Pentahedra", kind::WEDGE, 6),
    ("Pyramids", kind::PYRAMID, 5),
];

/// Reads points and cells. Lists of other things (corners, ridges, normals) are skipped.
pub(super) fn read(bytes: &[u8]) -> Result<DataSet, Fault> {
    if matches!(bytes, [1, 0, 0, 0, ..] | [0, 0, 0, 1, ..]) {
        return Err(Fault::unsupported(Place::File, "a binary Medit file", "an ascii .mesh file"));
    }
    let mut lexer = Lexer::with_comments(bytes, b'#');
    let head = lexer.text("MeshVersionFormatted")?;
    if head != "MeshVersionFormatted" {
        return Err(lexer.fault(quoted(head), "MeshVersionFormatted"));
    }
    let _version: u32 = lexer.number("a version")?;
    let (mut parts, mut dimension) = (Parts::default(), 3usize);
    let (mut point_labels, mut cell_labels) = (Vec::new(), Vec::new());
    while let Some(word) = lexer.word() {
        match std::str::from_utf8(word).unwrap_or_default() {
            "Dimension" => {
                dimension = lexer.number("2 or 3")?;
                if !(2..=3).contains(&dimension) {
                    return Err(lexer.fault(format!("dimension {dimension}"), "2 or 3"));
                }
            }
            "Vertices" => {
                let count = count(&mut lexer, dimension + 1)?;
                parts.points.reserve(3 * count);
                for _ in 0..count {
                    for axis in 0..3 {
                        parts.points.push(if axis < dimension { lexer.number("a coordinate")? } else { 0.0 });
                    }
                    point_labels.push(label(&mut lexer)?);
                }
            }
            "End" => break,
            keyword => {
                if let Some(&(_, kind, corners)) = LISTS.iter().find(|list| list.0 == keyword) {
                    for _ in 0..count(&mut lexer, corners + 1)? {
                        for _ in 0..corners {
                            let number: i64 = lexer.number("the number of a point")?;
                            let number = if number < 1 { i64::MAX } else { number };
                            let point = parts.resolve(number, || lexer.place())?;
                            parts.cells.connectivity.push(point);
                        }
                        parts.cells.offsets.push(parts.cells.connectivity.len() as i64);
                        parts.types.push(kind);
                        cell_labels.push(label(&mut lexer)?);
                    }
                } else if keyword.starts_with(|character: char| character.is_ascii_alphabetic()) {
                    // The numbers of an unknown list are passed over one by one, up to the next keyword.
                } else if keyword.parse::<f64>().is_err() {
                    return Err(lexer.fault(quoted(&String::from_utf8_lossy(word)), "a keyword such as Vertices or Tetrahedra"));
                }
            }
        }
    }
    if parts.point_count() == 0 {
        return Err(Fault::new(Place::File, "no Vertices", "the points of a Medit .mesh file"));
    }
    let labels = |labels: Vec<i32>| {
        let is_told = labels.iter().any(|&label| label != 0);
        is_told.then(|| DataArray::new(LABEL, 1, ArrayData::I32(labels)))
    };
    parts.point_arrays.extend(labels(point_labels));
    parts.cell_arrays.extend(labels(cell_labels));
    Ok(parts.into_unstructured())
}

/// The length of a list whose entries have `words` words.
fn count(lexer: &mut Lexer<'_>, words: usize) -> Result<usize, Fault> {
    let count: usize = lexer.number("a number of entries")?;
    if count.saturating_mul(2 * words) > lexer.remaining().saturating_add(2) {
        return Err(lexer.fault(format!("{count} entries in {} bytes", lexer.remaining()), "as many as there are"));
    }
    Ok(count)
}

/// A label; some programs write it as a floating-point number.
fn label(lexer: &mut Lexer<'_>) -> Result<i32, Fault> {
    let value: f64 = lexer.number("a label")?;
    if value.fract() == 0.0 && value.abs() <= f64::from(i32::MAX) {
        return Ok(value as i32);
    }
    Err(lexer.fault(format!("label {value}"), "a whole number of 32 bits"))
}

/// Writes points and cells, labels from arrays of the name `medit:ref`.
pub(super) fn write<W: Write>(shapes: &Shapes<'_>, dataset: &DataSet, out: &mut BufWriter<W>) -> std::io::Result<()> {
    let labels = |array: Option<&DataArray>, index: usize| {
        array.filter(|array| array.components == 1).and_then(|array| array.data.number(index)).unwrap_or(0.0) as i32
    };
    let (of_points, of_cells) = (dataset.point_array(LABEL), dataset.cell_array(LABEL));
    writeln!(out, "MeshVersionFormatted 2\nDimension 3\n\nVertices\n{}", shapes.point_count())?;
    for point in 0..shapes.point_count() {
        let [x, y, z] = shapes.point(point);
        writeln!(out, "{x:?} {y:?} {z:?} {}", labels(of_points, point))?;
    }
    for (keyword, kind, _) in LISTS {
        let cells: Vec<(usize, &[i64])> =
            shapes.cells().enumerate().filter(|(_, cell)| cell.0 == kind).map(|(index, cell)| (index, cell.1)).collect();
        if cells.is_empty() || LISTS.iter().find(|list| list.1 == kind).is_some_and(|list| list.0 != keyword) {
            continue;
        }
        writeln!(out, "\n{keyword}\n{}", cells.len())?;
        for (index, corners) in cells {
            for corner in corners {
                write!(out, "{} ", corner + 1)?;
            }
            writeln!(out, "{}", labels(of_cells, index))?;
        }
    }
    out.write_all(b"\nEnd\n")
}
