//! Outlines from `.csv` files, and the meshes that fill them.

use std::path::Path;

use crate::mesh::{OutlineOptions, triangulate};

use super::array::{ArrayData, DataArray};
use super::dataset::{CellArray, DataSet};
use super::error::{Fault, IoError, Place, quoted};
use super::formats::{kind, poly_data};
use super::read::read;

/// The rings of an outline, places in the order of the file.
type Rings = Vec<Vec<[f64; 2]>>;

/// Reads the rings of an outline.
///
/// A line has x and y, separated by a comma, a semicolon, a tab or blanks. A head may name the columns: then `x` and `y` are looked for
/// by name, in any order and among others, and a column `ring` may say to which ring a place belongs. Without that column, an
/// empty line ends a ring. Lines that start with `#` are skipped. The last place of a ring may repeat the first.
///
/// # Errors
/// [`IoError`] with the line.
///
/// # Cost
/// Linear in the size of the file.
pub fn read_outline(path: impl AsRef<Path>) -> Result<Vec<Vec<[f64; 2]>>, IoError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| IoError::Read { path: path.to_owned(), source })?;
    parse(&bytes).map_err(|fault| fault.in_file(path))
}

/// The mesh that fills an outline, as poly data: the places of the file first, in its order.
///
/// # Errors
/// [`IoError::Malformed`] for what [`triangulate`] refuses.
pub fn outline_dataset(path: impl AsRef<Path>, options: &OutlineOptions) -> Result<DataSet, IoError> {
    let path = path.as_ref();
    let rings = read_outline(path)?;
    let complex = triangulate(&rings, options).map_err(|error| {
        let text = error.to_string();
        let (found, expected) = text.split_once("; expected ").unwrap_or((&text, "an outline that can be filled"));
        Fault::new(Place::File, found, expected).in_file(path)
    })?;
    let points = DataArray::new("Points", 3, ArrayData::F64(complex.points().iter().flatten().copied().collect()));
    let mut cells = CellArray::default();
    for triangle in 0..complex.simplex_count() {
        cells.push(complex.simplex(triangle).iter().map(|&corner| i64::from(corner)));
    }
    let kinds = vec![kind::TRIANGLE; cells.len()];
    Ok(poly_data(points, &cells, &kinds, Vec::new(), Vec::new()))
}

/// Reads a mesh file, or fills the outline of a `.csv` file with triangles.
///
/// # Errors
/// As [`read`] and [`outline_dataset`].
pub fn read_mesh_or_outline(path: impl AsRef<Path>, options: &OutlineOptions) -> Result<DataSet, IoError> {
    let path = path.as_ref();
    let is_outline = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"));
    if is_outline { outline_dataset(path, options) } else { read(path) }
}

/// Where the columns are.
struct Columns {
    x: usize,
    y: usize,
    ring: Option<usize>,
}

fn parse(bytes: &[u8]) -> Result<Rings, Fault> {
    let text = std::str::from_utf8(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
        .map_err(|error| Fault::new(Place::Byte(error.valid_up_to()), "bytes that are no text", "a text file with x and y a line"))?;
    let mut columns: Option<Columns> = None;
    let mut rings: Vec<(Option<String>, Vec<[f64; 2]>)> = Vec::new();
    let mut is_new = true;
    for (number, line) in text.lines().enumerate() {
        let (place, line) = (Place::Line(number + 1), line.trim());
        if line.starts_with('#') {
            continue;
        }
        if line.is_empty() {
            is_new = true;
            continue;
        }
        let words = split(line);
        let columns = match &columns {
            Some(columns) => columns,
            None => {
                let is_head = words.iter().any(|word| word.parse::<f64>().is_err());
                let found = columns.insert(if is_head { named(&words, place)? } else { Columns { x: 0, y: 1, ring: None } });
                if is_head {
                    continue;
                }
                found
            }
        };
        let coordinate = |column: usize| -> Result<f64, Fault> {
            let word = words.get(column).ok_or_else(|| Fault::new(place, format!("{} columns", words.len()), format!("at least {}", column + 1)))?;
            word.parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(|| Fault::new(place, quoted(word), "a coordinate"))
        };
        let position = [coordinate(columns.x)?, coordinate(columns.y)?];
        match columns.ring {
            Some(column) => {
                let label = words.get(column).ok_or_else(|| Fault::new(place, format!("{} columns", words.len()), format!("at least {}", column + 1)))?;
                match rings.iter_mut().find(|(other, _)| other.as_deref() == Some(*label)) {
                    Some((_, ring)) => ring.push(position),
                    None => rings.push((Some((*label).to_owned()), vec![position])),
                }
            }
            None => match rings.last_mut().filter(|_| !is_new) {
                Some((_, ring)) => ring.push(position),
                None => rings.push((None, vec![position])),
            },
        }
        is_new = false;
    }
    match rings.is_empty() {
        true => Err(Fault::new(Place::File, "no place", "lines with x and y")),
        false => Ok(rings.into_iter().map(|(_, ring)| ring).collect()),
    }
}

/// The cells of a line, without quotation marks.
fn split(line: &str) -> Vec<&str> {
    let separator = [',', ';', '\t'].into_iter().find(|&separator| line.contains(separator));
    let words: Vec<&str> = match separator {
        Some(separator) => line.split(separator).collect(),
        None => line.split_whitespace().collect(),
    };
    words.into_iter().map(|word| word.trim().trim_matches('"')).collect()
}

fn named(words: &[&str], place: Place) -> Result<Columns, Fault> {
    let find = |name: &str| words.iter().position(|word| word.eq_ignore_ascii_case(name));
    match (find("x"), find("y")) {
        (Some(x), Some(y)) => Ok(Columns { x, y, ring: find("ring") }),
        _ => Err(Fault::new(place, quoted(&words.join(",")), "two numbers, or a head with columns \"x\" and \"y\"")),
    }
}
