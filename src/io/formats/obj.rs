//! Wavefront `.obj`: points, lines and polygons. Normals, texture coordinates, groups and materials are no part of a mesh's shape.

use std::io::{BufWriter, Write};

use crate::io::dataset::DataSet;
use crate::io::error::{Fault, Place, quoted};

use super::parts::{Parts, kind};
use super::shapes::Shapes;

/// Reads `v`, `p`, `l` and `f` statements; points keep their numbers, whether a face uses them or not.
pub(super) fn read(bytes: &[u8]) -> Result<DataSet, Fault> {
    let mut parts = Parts::default();
    let mut statement = Vec::new();
    for (index, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        let place = || Place::Line(index + 1);
        let line = line.split(|&byte| byte == b'#').next().unwrap_or(line).trim_ascii();
        // A backslash at the end of a line continues the statement on the next one.
        if let Some(head) = line.strip_suffix(b"\\") {
            statement.extend_from_slice(head);
            statement.push(b' ');
            continue;
        }
        statement.extend_from_slice(line);
        let text = std::str::from_utf8(&statement).unwrap_or_default();
        let mut words = text.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let before = parts.points.len();
                for word in words.by_ref().take(3) {
                    parts.points.push(number(word, place)?);
                }
                if parts.points.len() != before + 3 {
                    return Err(Fault::new(place(), format!("{} coordinates", parts.points.len() - before), "three"));
                }
            }
            Some(keyword @ ("f" | "l" | "p")) => {
                let corners = words.map(|word| corner(&parts, word, place)).collect::<Result<Vec<i64>, Fault>>()?;
                let (shape, least) = match (keyword, corners.len()) {
                    ("p", 1) => (kind::VERTEX, 1),
                    ("p", _) => (2, 1),
                    ("l", 2) => (kind::LINE, 2),
                    ("l", _) => (kind::POLYLINE, 2),
                    (_, 3) => (kind::TRIANGLE, 3),
                    (_, 4) => (kind::QUAD, 3),
                    _ => (kind::POLYGON, 3),
                };
                if corners.len() < least {
                    let found = format!("\"{keyword}\" with {} points", corners.len());
                    return Err(Fault::new(place(), found, format!("at least {least}")));
                }
                parts.push(shape, corners);
            }
            _ => {}
        }
        statement.clear();
    }
    if parts.point_count() == 0 {
        return Err(Fault::new(Place::File, "no line that begins with \"v\"", "the points of a Wavefront .obj file"));
    }
    Ok(parts.into_poly_data())
}

fn number(word: &str, place: impl Fn() -> Place) -> Result<f64, Fault> {
    word.parse().map_err(|_| Fault::new(place(), quoted(word), "a coordinate"))
}

/// The point of a corner such as `7`, `7/2`, `7//5` or `-1`.
fn corner(parts: &Parts, word: &str, place: impl Fn() -> Place + Copy) -> Result<i64, Fault> {
    let number = word.split('/').next().and_then(|point| point.parse().ok());
    let number = number.ok_or_else(|| Fault::new(place(), quoted(word), "the number of a point"))?;
    parts.resolve(number, place)
}

/// Writes points, and every cell as `p`, `l` or `f`.
pub(super) fn write<W: Write>(shapes: &Shapes<'_>, out: &mut BufWriter<W>) -> std::io::Result<()> {
    shapes.write_points(out, "v ", "")?;
    for (kind, corners) in shapes.cells() {
        out.write_all(match kind {
            1 | 2 => b"p",
            kind::LINE | kind::POLYLINE => b"l",
            _ => b"f",
        })?;
        for corner in corners {
            write!(out, " {}", corner + 1)?;
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}
