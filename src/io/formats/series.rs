//! A table as a data set, a polyline along one of its columns, and any data set as a table.

use std::io::{BufWriter, Write};

use crate::io::array::{ArrayData, DataArray};
use crate::io::dataset::{CellArray, DataSet, Geometry};
use crate::io::error::Fault;
use crate::io::write::Objection;

use super::csv;
use super::table::{Row, Table, TableAxis};

/// Field array with the names of all columns, in the order of the file.
const COLUMNS: &str = "table_columns";
/// Field array with the name of the column that the points lie along; absent for row numbers.
const ALONG: &str = "table_along";
const AXES: [&str; 3] = ["x", "y", "z"];

/// Reads a table as a polyline along the column that [`axis_column`] finds, else along the numbers of the rows.
pub(super) fn read(bytes: &[u8]) -> Result<DataSet, Fault> {
    let table = csv::read(bytes)?;
    let along = axis_column(&table);
    Ok(dataset(&table, along.as_ref()))
}

/// A table as a polyline: a point a row, in the order of the rows, and lines between neighbours along x.
///
/// All columns of numbers but x become point arrays with NaN where a value is missing; texts, and dates as they stand in the file,
/// become string arrays.
pub(super) fn dataset(table: &Table, along: Option<&(usize, TableAxis)>) -> DataSet {
    let x = along.map_or_else(|| (0..table.len()).map(|row| row as f64).collect(), |(_, axis)| axis.values.clone());
    let mut dataset = polyline(&x, &rising(&x));
    let is_numeric_axis = |column: usize| along.is_some_and(|(own, axis)| *own == column && !axis.is_dates);
    for column in (0..table.width()).filter(|&column| !is_numeric_axis(column)) {
        let is_axis = along.is_some_and(|(own, _)| *own == column);
        let data = match table.numbers_or_fault(column) {
            Ok(values) if !is_axis => ArrayData::F64(values),
            _ => ArrayData::String((0..table.len()).map(|row| table.cell(row, column).as_bytes().to_vec()).collect()),
        };
        dataset.set_point_array(DataArray::new(table.names[column].clone(), 1, data));
    }
    let texts = |names: &[String]| ArrayData::String(names.iter().map(|name| name.as_bytes().to_vec()).collect());
    dataset.field_data.push(DataArray::new(COLUMNS, 1, texts(&table.names)));
    if let Some((column, _)) = along {
        dataset.field_data.push(DataArray::new(ALONG, 1, texts(&table.names[*column..=*column])));
    }
    dataset
}

/// The column that a series lies along: the first of dates, if no day is there twice; else the first of numbers that rise or fall strictly
/// from row to row.
pub(super) fn axis_column(table: &Table) -> Option<(usize, TableAxis)> {
    let axes = || (0..table.width()).filter_map(|column| Some((column, table.axis_or_fault(column).ok()?)));
    let is_strict = |values: &[f64]| {
        values.windows(2).all(|pair| pair[0] < pair[1]) || values.windows(2).all(|pair| pair[0] > pair[1])
    };
    let is_date = |axis: &TableAxis| axis.is_dates && rising(&axis.values).windows(2).all(|pair| axis.values[pair[0]] < axis.values[pair[1]]);
    axes().find(|(_, axis)| is_date(axis)).or_else(|| axes().find(|(_, axis)| !axis.is_dates && is_strict(&axis.values)))
}

/// The rows by rising x.
pub(super) fn rising(x: &[f64]) -> Vec<usize> {
    let mut rows: Vec<usize> = (0..x.len()).collect();
    rows.sort_by(|&a, &b| x[a].total_cmp(&x[b]).then(a.cmp(&b)));
    rows
}

/// Points along the x axis with lines between the neighbours in a sequence of points.
///
/// # Arguments
/// * `x`: a coordinate a point.
/// * `sequence`: points to be joined, in this order; the others are in no line.
///
/// # Example
/// ```
/// let series = morsmooth::io::polyline(&[0.0, 2.0, 1.0], &[0, 2, 1]);
/// assert_eq!((series.point_count(), series.cell_count()), (3, 2));
/// ```
pub fn polyline(x: &[f64], sequence: &[usize]) -> DataSet {
    let mut lines = CellArray::default();
    for pair in sequence.windows(2) {
        lines.push(pair.iter().map(|&point| point as i64));
    }
    DataSet::new(Geometry::PolyData {
        points: DataArray::new("Points", 3, ArrayData::F64(x.iter().flat_map(|&x| [x, 0.0, 0.0]).collect())),
        verts: CellArray::default(),
        lines,
        polys: CellArray::default(),
        strips: CellArray::default(),
    })
}

/// What a table of the points and their arrays leaves out, in words.
pub(super) fn losses(dataset: &DataSet) -> Vec<String> {
    let mut lost = Vec::new();
    let points = dataset.points_f64();
    let along_x = |cell: &[i64]| matches!(cell, [a, b] if points[*a as usize][0] < points[*b as usize][0]);
    let is_series = match &dataset.geometry {
        Geometry::PolyData { verts, lines, polys, strips, .. } => {
            along(dataset).is_some() && verts.is_empty() && polys.is_empty() && strips.is_empty() && lines.iter().all(along_x)
        }
        _ => false,
    };
    if !is_series && dataset.cell_count() > 0 {
        lost.push(format!("{} cells (points and their arrays stay)", dataset.cell_count()));
    }
    lost.extend(dataset.cell_data.arrays.iter().map(|array| format!("cell array \"{}\"", array.name.escape_debug())));
    let others = dataset.field_data.iter().filter(|array| array.name != COLUMNS && array.name != ALONG);
    lost.extend(others.map(|array| format!("field array \"{}\"", array.name.escape_debug())));
    lost
}

fn along(dataset: &DataSet) -> Option<String> {
    dataset.field_data.iter().find(|array| array.name == ALONG)?.to_texts().into_iter().next()
}

/// Refuses arrays that would have the same column.
pub(super) fn check(dataset: &DataSet) -> Result<(), Objection> {
    let mut names: Vec<String> = columns(dataset).into_iter().map(|(name, _)| name).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err((format!("two columns of the name {:?}", pair[0]), "a name for each".to_owned())),
        None => Ok(()),
    }
}

/// Writes a row a point: the columns of the table it came from in their order, then the arrays that are new. Data sets of other
/// origin begin with the columns x, y, z.
pub(super) fn write<W: Write>(dataset: &DataSet, delimiter: u8, out: &mut BufWriter<W>) -> std::io::Result<()> {
    let columns = columns(dataset);
    let row = |row: usize| Row { line: 0, cells: columns.iter().map(|(_, cells)| cells[row].clone()).collect() };
    let table = Table {
        delimiter,
        has_header: true,
        names: columns.iter().map(|(name, _)| name.clone()).collect(),
        rows: (0..dataset.point_count()).map(row).collect(),
        ..Table::default()
    };
    csv::write(&table, out)
}

/// Name and texts of every column to be written.
fn columns(dataset: &DataSet) -> Vec<(String, Vec<String>)> {
    let mut found: Vec<(String, Vec<String>)> = dataset.point_data.arrays.iter().flat_map(array_columns).collect();
    let points: Vec<(String, Vec<String>)> = match &dataset.geometry {
        Geometry::StructuredGrid { points, .. } | Geometry::PolyData { points, .. } | Geometry::UnstructuredGrid { points, .. } => {
            (0..3).map(|axis| (AXES[axis].to_owned(), texts(&points.data, points.components, axis))).collect()
        }
        Geometry::ImageData { .. } | Geometry::RectilinearGrid { .. } => {
            let data = ArrayData::F64(dataset.points_f64().concat());
            (0..3).map(|axis| (AXES[axis].to_owned(), texts(&data, 3, axis))).collect()
        }
    };
    let along = along(dataset);
    let order: Vec<String> =
        dataset.field_data.iter().find(|array| array.name == COLUMNS).map(DataArray::to_texts).unwrap_or_default();
    match along {
        Some(name) if !found.iter().any(|column| column.0 == name) => {
            found.extend(points.into_iter().next().map(|(_, cells)| (name, cells)));
        }
        None if order.is_empty() => found = points.into_iter().chain(found).collect(),
        _ => {}
    }
    let place = |name: &String| order.iter().position(|own| own == name).unwrap_or(order.len());
    found.sort_by_key(|(name, _)| place(name));
    found
}

fn array_columns(array: &DataArray) -> Vec<(String, Vec<String>)> {
    let name = |component: usize| match array.component_names.get(component).filter(|name| !name.is_empty()) {
        _ if array.components == 1 => array.name.clone(),
        Some(name) => format!("{}_{name}", array.name),
        None => format!("{}_{component}", array.name),
    };
    (0..array.components).map(|component| (name(component), texts(&array.data, array.components, component))).collect()
}

/// One component as texts: the shortest that give the numbers back, nothing for NaN.
fn texts(data: &ArrayData, components: usize, component: usize) -> Vec<String> {
    let places = (component..data.len()).step_by(components.max(1));
    match data {
        ArrayData::String(texts) => places.map(|place| String::from_utf8_lossy(&texts[place]).into_owned()).collect(),
        ArrayData::F32(values) => places.map(|place| if values[place].is_nan() { String::new() } else { format!("{:?}", values[place]) }).collect(),
        ArrayData::F64(values) => places.map(|place| if values[place].is_nan() { String::new() } else { format!("{:?}", values[place]) }).collect(),
        ArrayData::I64(values) => places.map(|place| values[place].to_string()).collect(),
        ArrayData::U64(values) => places.map(|place| values[place].to_string()).collect(),
        // Narrower integers and bits are whole numbers in double precision.
        other => places.map(|place| format!("{}", other.number(place).unwrap_or(f64::NAN))).collect(),
    }
}
