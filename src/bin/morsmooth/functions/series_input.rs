//! From a table to the series that are worked on: a polyline along one column, holes bridged or filled.

use std::path::Path;
use std::sync::Arc;

use morsmooth::field::VertexId;
use morsmooth::io::{ArrayData, DataArray, DataSet, Table, TableAxis, polyline};

use crate::args::FieldArgs;
use crate::common::ground::Grounds;
use crate::common::input::FieldInput;
use crate::failure::Failure;
use crate::functions::series::{MissingKind, SeriesArgs};

/// A table with the column that its series lie along.
pub struct SeriesTable {
    /// The table.
    pub table: Table,
    /// The column of places.
    pub along: usize,
    /// Its values.
    pub axis: TableAxis,
    /// All columns as arrays.
    dataset: DataSet,
}

/// One column over the places.
pub struct Series {
    /// The field on the polyline.
    pub input: FieldInput,
    /// Rows of the polyline by rising place.
    pub rows: Vec<usize>,
    /// Of these, rows without a value of their own.
    pub filled: Vec<usize>,
    /// Rows without a value, between others or not.
    pub missing: usize,
}

impl SeriesTable {
    /// Reads the table and finds its places.
    pub fn load(args: &SeriesArgs) -> Result<Self, Failure> {
        let table = Table::read(&args.input).map_err(|error| Failure::usage(error.to_string()))?;
        let along = match &args.x {
            Some(name) => column(&table, &args.input, name)?,
            None => table.series_column().ok_or_else(|| {
                Failure::file(&args.input, "found no column of dates and none of rising numbers; expected --x COLUMN")
                    .hint(format!("columns: {}", table.names().join(", ")))
            })?,
        };
        let dataset = table.series(along).map_err(|error| Failure::usage(error.to_string()))?;
        let axis = table.axis(along).map_err(|error| Failure::usage(error.to_string()))?;
        Ok(Self { table, along, axis, dataset })
    }

    /// The columns that are meant.
    pub fn columns(&self, args: &SeriesArgs) -> Result<Vec<usize>, Failure> {
        if !args.y.is_empty() {
            let columns = args.y.iter().map(|name| column(&self.table, &args.input, name)).collect::<Result<Vec<_>, _>>()?;
            for (place, &own) in columns.iter().enumerate() {
                let name = &self.table.names()[own];
                if own == self.along {
                    return Err(Failure::file(&args.input, format!("column '{name}' is x and cannot be y as well; expected another --y")));
                }
                if columns[..place].contains(&own) {
                    return Err(Failure::usage(format!("the column '{name}' was named twice; expected each once")));
                }
            }
            return Ok(columns);
        }
        let has_numbers = |&column: &usize| {
            let is_mask = args.mask.as_ref() == Some(&self.table.names()[column]);
            let has_value = || self.table.numbers(column).is_ok_and(|values| values.iter().any(|value| !value.is_nan()));
            column != self.along && !is_mask && has_value()
        };
        let found: Vec<usize> = (0..self.table.width()).filter(has_numbers).collect();
        let names = || found.iter().map(|&column| self.table.names()[column].as_str()).collect::<Vec<_>>().join(", ");
        match found.as_slice() {
            [only] => Ok(vec![*only]),
            [] => Err(Failure::file(&args.input, "found no column of numbers besides x; expected one to work on")),
            many => Err(Failure::file(&args.input, format!("found {} columns of numbers; expected --y COLUMN", many.len()))
                .hint(format!("columns: {}", names()))),
        }
    }

    /// The series in a column.
    pub fn series(&self, args: &SeriesArgs, column: usize) -> Result<Series, Failure> {
        let name = &self.table.names()[column];
        let mut values = self.numbers(column)?;
        if let Some(mask) = &args.mask {
            let flags = self.numbers(self::column(&self.table, &args.input, mask)?)?;
            let outside = |flag: f64| flag == 0.0 || flag.is_nan();
            values.iter_mut().zip(flags).filter(|(_, flag)| outside(*flag)).for_each(|(value, _)| *value = f64::NAN);
        }
        let places = &self.axis.values;
        let mut all: Vec<usize> = (0..values.len()).collect();
        all.sort_by(|&a, &b| places[a].total_cmp(&places[b]));
        let present: Vec<usize> = all.iter().copied().filter(|&row| !values[row].is_nan()).collect();
        let (Some(first), Some(last)) = (present.first(), present.last()) else {
            return Err(Failure::file(&args.input, format!("column '{name}' has no value; expected some")));
        };
        if present.len() < 2 {
            return Err(Failure::file(&args.input, format!("column '{name}' has one value only; expected two at least")));
        }
        let missing = values.len() - present.len();
        let within = all.iter().copied().filter(|&row| (places[*first]..=places[*last]).contains(&places[row]));
        let rows: Vec<usize> = match args.missing {
            MissingKind::Bridge => present.clone(),
            MissingKind::Fill => within.collect(),
        };
        let filled: Vec<usize> = rows.iter().copied().filter(|&row| values[row].is_nan()).collect();
        fill(&rows, places, &mut values);
        let mut dataset = DataSet { geometry: polyline(places, &rows).geometry, ..self.dataset.clone() };
        let array = DataArray::new(name.clone(), 1, ArrayData::F64(values));
        dataset.set_point_array(array.clone());
        let field = FieldArgs { input: args.input.clone(), array: Some(name.clone()), mask: None, derive: None };
        let mut input = FieldInput::of_array(&Arc::new(dataset), &array, &field, &Grounds::of_one_file())?;
        // Rows that are bridged are no fault of the mesh.
        input.notes.clear();
        if missing > 0 {
            let done = match args.missing {
                MissingKind::Bridge => "left missing, the line bridges them".to_owned(),
                MissingKind::Fill => format!("{} of them filled, of no weight in the data term", filled.len()),
            };
            input.notes.push(format!("column {name}: {missing} of {} values are missing; {done}", self.table.len()));
        }
        Ok(Series { input, rows, filled, missing })
    }

    fn numbers(&self, column: usize) -> Result<Vec<f64>, Failure> {
        self.table.numbers(column).map_err(|error| Failure::usage(error.to_string()))
    }

    /// How a row is called: the cell of its place.
    pub fn place(&self, row: usize) -> &str {
        self.table.cell(row, self.along)
    }
}

impl Series {
    /// The row of a vertex.
    pub fn row(&self, vertex: VertexId) -> usize {
        self.input.domain.point_of_vertex()[vertex.index()] as usize
    }

    /// The vertex of a row, if the line passes it.
    pub fn vertex(&self, row: usize) -> Option<VertexId> {
        self.input.domain.vertex_of_point()[row]
    }
}

fn column(table: &Table, path: &Path, name: &str) -> Result<usize, Failure> {
    table.column(name).ok_or_else(|| {
        Failure::file(path, format!("found no column '{name}'; expected one of: {}", table.names().join(", ")))
    })
}

/// Puts values on the straight line between neighbours where they are missing.
fn fill(rows: &[usize], places: &[f64], values: &mut [f64]) {
    let mut before = None;
    for (place, &row) in rows.iter().enumerate() {
        if !values[row].is_nan() {
            before = Some(row);
            continue;
        }
        let after = rows[place..].iter().copied().find(|&row| !values[row].is_nan());
        if let (Some(a), Some(b)) = (before, after) {
            let part = (places[row] - places[a]) / (places[b] - places[a]);
            values[row] = values[a] + part * (values[b] - values[a]);
            before = Some(row);
        }
    }
}
