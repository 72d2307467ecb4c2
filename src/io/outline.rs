//! Outlines from `.csv` files, and the meshes that fill them.

use std::path::Path;

use crate::mesh::{OutlineOptions, triangulate};

use super::array::{ArrayData, DataArray};
use super::dataset::{CellArray, DataSet};
use super::error::{Fault, IoError, Place, quoted};
use super::formats::{Table, kind, poly_data};
use super::read::read;

/// The rings of an outline, places in the order of the file.
type Rings = Vec<Vec<[f64; 2]>>;

/// Reads the rings of an outline.
///
/// The file is a [`Table`], or a list whose numbers are separated by blanks. Its first two columns are x and y; a head may name the columns:
/// then `x` and `y` are looked for by name, in any order and among others, and a column `ring` may say to which ring a place belongs.
/// Without that column, an empty line ends a ring. The last place of a ring may repeat the first.
///
/// # Errors
/// As [`Table::read`]; [`IoError::Malformed`] with the line of what is no coordinate.
///
/// # Cost
/// Linear in the size of the file.
pub fn read_outline(path: impl AsRef<Path>) -> Result<Vec<Vec<[f64; 2]>>, IoError> {
    let path = path.as_ref();
    rings(&Table::read_list(path)?).map_err(|fault| fault.in_file(path))
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

/// The rings that a table lists.
fn rings(table: &Table) -> Result<Rings, Fault> {
    let find = |name: &str| table.names().iter().position(|own| own.eq_ignore_ascii_case(name));
    let columns = match table.has_header() {
        true => (find("x"), find("y"), find("ring")),
        false => (Some(0), (table.width() > 1).then_some(1), None),
    };
    let (Some(x), Some(y), ring) = columns else {
        let found = format!("the columns {}", quoted(&table.names().join(", ")));
        return Err(Fault::new(Place::File, found, "two columns of numbers, or a head with columns \"x\" and \"y\""));
    };
    if table.is_empty() {
        return Err(Fault::new(Place::File, "no place", "lines with x and y"));
    }
    let (across, up) = (coordinates(table, x)?, coordinates(table, y)?);
    let places = |rows: &mut dyn Iterator<Item = usize>| rows.map(|row| [across[row], up[row]]).collect();
    let Some(ring) = ring else {
        return Ok(table.parts().into_iter().map(|mut rows| places(&mut rows)).collect());
    };
    let mut labels: Vec<&str> = Vec::new();
    for row in 0..table.len() {
        if !labels.contains(&table.cell(row, ring)) {
            labels.push(table.cell(row, ring));
        }
    }
    let of = |label: &str| places(&mut (0..table.len()).filter(|&row| table.cell(row, ring) == label));
    Ok(labels.into_iter().map(of).collect())
}

/// A column without gaps.
fn coordinates(table: &Table, column: usize) -> Result<Vec<f64>, Fault> {
    let values = table.numbers_or_fault(column)?;
    match values.iter().position(|value| value.is_nan()) {
        Some(row) => {
            let place = Place::Cell { line: table.line(row), column: column + 1 };
            Err(Fault::new(place, quoted(table.cell(row, column)), "a coordinate"))
        }
        None => Ok(values),
    }
}
