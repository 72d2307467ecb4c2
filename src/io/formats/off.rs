//! Geomview `.off`, ascii: points, polygons, and colours or normals of points, which are skipped.

use std::io::{BufWriter, Write};

use crate::io::dataset::DataSet;
use crate::io::error::{Fault, quoted};
use crate::io::lexer::Lexer;

use super::parts::{Parts, kind};
use super::shapes::Shapes;

/// Reads the points and the polygons of a file with a head such as `OFF`, `COFF`, `NOFF` or `STCNOFF`.
pub(super) fn read(bytes: &[u8]) -> Result<DataSet, Fault> {
    let mut lexer = Lexer::with_comments(bytes, b'#');
    let expected = "OFF, COFF, NOFF, CNOFF or STOFF";
    let head = lexer.text(expected)?;
    let Some(mut prefix) = head.strip_suffix("OFF") else { return Err(lexer.fault(quoted(head), expected)) };
    let mut skipped = 0;
    for (letters, numbers) in [("ST", 2), ("C", 4), ("N", 3)] {
        if let Some(rest) = prefix.strip_prefix(letters) {
            (prefix, skipped) = (rest, skipped + numbers);
        }
    }
    if !prefix.is_empty() {
        return Err(Fault::unsupported(lexer.place(), quoted(head), expected));
    }
    if lexer.peek() == Some(b"BINARY") {
        return Err(Fault::unsupported(lexer.place(), "a binary .off file", "an ascii one"));
    }
    let points: usize = lexer.number("a number of points")?;
    let faces: usize = lexer.number("a number of faces")?;
    let _edges: usize = lexer.number("a number of edges")?;
    // A coordinate takes two bytes at least, and so does the number of a point.
    if points.saturating_mul(6).saturating_add(faces.saturating_mul(2)) > lexer.remaining() {
        return Err(lexer.fault(format!("{points} points and {faces} faces in {} bytes", lexer.remaining()), "as many as there are"));
    }
    let mut parts = Parts::default();
    parts.points.reserve(3 * points);
    for _ in 0..points {
        for _ in 0..3 {
            parts.points.push(lexer.number("a coordinate")?);
        }
        // Colours of points may have three or four numbers, of any kind: they end with the line.
        if skipped > 0 {
            lexer.line();
        }
    }
    for _ in 0..faces {
        let corners: usize = lexer.number("a number of corners")?;
        if corners > points.max(3) {
            return Err(lexer.fault(format!("a face of {corners} corners"), format!("at most {points}")));
        }
        for _ in 0..corners {
            let corner: i64 = lexer.number("the number of a point")?;
            if !(0..points as i64).contains(&corner) {
                return Err(lexer.fault(format!("point {corner}"), format!("points from 0, less than {points}")));
            }
            parts.cells.connectivity.push(corner);
        }
        parts.cells.offsets.push(parts.cells.connectivity.len() as i64);
        parts.types.push(match corners {
            0 => return Err(lexer.fault("a face without corners", "at least one")),
            1 => kind::VERTEX,
            2 => kind::LINE,
            3 => kind::TRIANGLE,
            4 => kind::QUAD,
            _ => kind::POLYGON,
        });
        // The colour of the face, if there is one.
        lexer.line();
    }
    Ok(parts.into_poly_data())
}

/// Writes the points and every cell as a face.
pub(super) fn write<W: Write>(shapes: &Shapes<'_>, out: &mut BufWriter<W>) -> std::io::Result<()> {
    writeln!(out, "OFF\n{} {} 0", shapes.point_count(), shapes.cells().count())?;
    shapes.write_points(out, "", "")?;
    for (_, corners) in shapes.cells() {
        write!(out, "{}", corners.len())?;
        for corner in corners {
            write!(out, " {corner}")?;
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}
