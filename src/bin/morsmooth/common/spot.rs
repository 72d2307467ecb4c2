//! Places on a mesh as lists of files name them: point numbers or positions.

use std::path::Path;

use morsmooth::field::VertexId;
use morsmooth::io::Table;

use super::input::FieldInput;
use super::shape_input::Locator;
use crate::failure::Failure;

/// Where something on a mesh is to be.
#[derive(Debug, Clone, Copy)]
pub enum Spot {
    /// A point number.
    Point(u64),
    /// A position on the mesh.
    Position([f64; 3]),
}

impl Spot {
    /// The vertex meant, and where it is meant to be.
    ///
    /// # Arguments
    /// * `path`, `place`: where the spot was read, for messages.
    pub fn vertex(
        self,
        (path, place): (&Path, &str),
        input: &FieldInput,
        locator: &Locator<'_>,
    ) -> Result<(VertexId, [f64; 3]), Failure> {
        match self {
            Self::Point(point) => {
                let vertex = input.vertex_of_point(path, point)?;
                Ok((vertex, input.domain.complex.point(vertex)))
            }
            Self::Position(position) => {
                let vertex = locator.nearest(position).map_err(|far| beside((path, place), input, position, far))?;
                Ok((vertex, position))
            }
        }
    }
}

/// The failure of a position that is not on the mesh.
pub fn beside((path, place): (&Path, &str), input: &FieldInput, position: [f64; 3], far: f64) -> Failure {
    let mesh = input.path.display();
    let text = format!("{place}: the position {position:?} is {far:.3e} from the nearest vertex of {mesh}, farther than its longest edge");
    Failure::file(path, format!("{text}; expected a position on the mesh"))
}

/// The column with one of some names, whatever their case.
pub fn column(table: &Table, names: &[&str]) -> Option<usize> {
    (0..table.width()).find(|&column| names.iter().any(|name| table.names()[column].eq_ignore_ascii_case(name)))
}

/// The columns that spots stand in: a point number, or one to three coordinates.
pub struct SpotColumns {
    point: Option<usize>,
    position: Vec<usize>,
    /// The numbers of each coordinate, NaN where one is missing.
    coordinates: Vec<Vec<f64>>,
}

impl SpotColumns {
    /// The columns by their names: x, y and z, and those that point numbers may stand in.
    pub fn named(table: &Table, points: &[&str]) -> Result<Self, Failure> {
        let position = ["x", "y", "z"].iter().filter_map(|name| column(table, &[name])).collect();
        Self::new(table, column(table, points), position)
    }

    /// Columns by their numbers; a point number counts before a position.
    pub fn new(table: &Table, point: Option<usize>, position: Vec<usize>) -> Result<Self, Failure> {
        let numbers = |&column: &usize| table.numbers(column).map_err(|error| Failure::usage(error.to_string()));
        let coordinates = if point.is_none() { position.iter().map(numbers).collect::<Result<_, _>>()? } else { Vec::new() };
        Ok(Self { point, position, coordinates })
    }

    /// Whether there are point numbers, or at least so many coordinates.
    pub fn are_enough(&self, coordinates: usize) -> bool {
        self.point.is_some() || self.position.len() >= coordinates
    }

    /// The spot of a row.
    pub fn spot(&self, path: &Path, table: &Table, row: usize) -> Result<Spot, Failure> {
        let fault = |column: usize, expected: &str| cell_fault(path, table, (row, column), expected);
        if let Some(column) = self.point {
            let number = table.cell(row, column).parse();
            return number.map(Spot::Point).map_err(|_| fault(column, "a point number (0, 1, 2, ...)"));
        }
        let mut at = [0.0; 3];
        for (axis, numbers) in self.coordinates.iter().enumerate() {
            at[axis] = numbers[row];
            if numbers[row].is_nan() {
                return Err(fault(self.position[axis], "a coordinate"));
            }
        }
        Ok(Spot::Position(at))
    }
}

/// The failure of a cell.
pub fn cell_fault(path: &Path, table: &Table, (row, column): (usize, usize), expected: &str) -> Failure {
    Failure::file(path, format!("line {}: found '{}'; expected {expected}", table.line(row), table.cell(row, column)))
}
