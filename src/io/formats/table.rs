//! A table of text: named columns, rows of cells as they stand in a file, and the numbers or dates that they mean.

use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::io::dataset::DataSet;
use crate::io::error::{Fault, IoError, Place, quoted};
use crate::io::pending::PendingFile;

use super::{csv, series};

/// A row: its line in the file, counted from 1, and its cells.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Row {
    pub line: usize,
    pub cells: Vec<String>,
}

/// A table of text as it stands in a file: comments, header, rows.
///
/// Cells keep their text, so that what is not touched is written back as it was.
///
/// # Example
/// ```
/// use morsmooth::io::Table;
/// let table = Table::parse("prices.csv", b"# closing\nday;price\n2001-01-05;1,25\n2001-01-08;\n")?;
/// assert_eq!(table.names(), ["day", "price"]);
/// let axis = table.axis(0)?;
/// assert!(axis.is_dates);
/// assert_eq!(axis.values[1] - axis.values[0], 3.0);
/// assert_eq!(table.numbers(1)?[0], 1.25);
/// assert!(table.numbers(1)?[1].is_nan());
/// # Ok::<(), morsmooth::io::IoError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Table {
    pub(super) path: PathBuf,
    pub(super) delimiter: u8,
    pub(super) names: Vec<String>,
    pub(super) has_header: bool,
    pub(super) rows: Vec<Row>,
    /// Comments, each with the row that it stands above.
    pub(super) comments: Vec<(usize, String)>,
}

/// A column of positions along an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct TableAxis {
    /// A value a row: the number, or days since 1970-01-01.
    pub values: Vec<f64>,
    /// Whether the cells are dates.
    pub is_dates: bool,
}

impl TableAxis {
    /// The place that a text names: a number, or, along dates, a date; `None` if it names none.
    pub fn place(&self, text: &str) -> Option<f64> {
        if self.is_dates { csv::day(text) } else { text.parse().ok().filter(|place: &f64| place.is_finite()) }
    }
}

/// What a cell is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Value {
    /// Nothing, or a word that says so.
    Missing,
    /// A finite number.
    Number(f64),
    /// A date, in days since 1970-01-01.
    Date(f64),
    /// Anything else.
    Text,
}

impl Value {
    pub fn of(cell: &str, delimiter: u8) -> Self {
        if is_missing(cell) {
            return Self::Missing;
        }
        match (number(cell, delimiter), csv::day(cell)) {
            (Some(value), _) => Self::Number(value),
            (None, Some(day)) => Self::Date(day),
            (None, None) => Self::Text,
        }
    }
}

/// Whether a cell says that there is no value: empty, or one of the words of FRED, R, pandas and databases.
fn is_missing(cell: &str) -> bool {
    const WORDS: [&str; 7] = ["", ".", "nan", "na", "n/a", "null", "-"];
    WORDS.iter().any(|word| cell.eq_ignore_ascii_case(word))
}

/// A finite number. Where commas do not separate cells, one of them may be the decimal mark.
fn number(cell: &str, delimiter: u8) -> Option<f64> {
    let with_point = match delimiter {
        b',' => cell.parse(),
        _ if cell.contains('.') => cell.parse(),
        _ => cell.replacen(',', ".", 1).parse(),
    };
    with_point.ok().filter(|value: &f64| value.is_finite())
}

impl Table {
    /// Where comments above the header stand.
    pub(super) const ABOVE_HEADER: usize = usize::MAX;

    /// Reads the table in a file.
    ///
    /// The separator (tab, semicolon or comma) is found in the first row. Lines that begin with `#` are comments, blank lines are
    /// skipped, and a first row with any word in it is the header; without one columns are called `column_1`, `column_2` ...
    ///
    /// # Errors
    /// [`IoError::Read`] if there is no such file; [`IoError::Malformed`] for a row with more or fewer cells than the first, for
    /// bytes that are no UTF-8, and for a file without rows.
    ///
    /// # Cost
    /// Linear; the text of all cells is held.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, IoError> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|source| IoError::Read { path: path.to_owned(), source })?;
        Self::parse(path, &bytes)
    }

    /// Reads a table from the bytes of a file; errors name it `path`.
    ///
    /// # Errors
    /// As [`Table::read`].
    pub fn parse(path: impl AsRef<Path>, bytes: &[u8]) -> Result<Self, IoError> {
        let path = path.as_ref();
        csv::read(bytes).map(|table| Self { path: path.to_owned(), ..table }).map_err(|fault| fault.in_file(path))
    }

    /// As [`Table::read`]; where no row has a separator, blanks between numbers and words are it.
    ///
    /// # Errors
    /// As [`Table::read`].
    pub fn read_list(path: impl AsRef<Path>) -> Result<Self, IoError> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|source| IoError::Read { path: path.to_owned(), source })?;
        Self::parse(path, &csv::without_blanks(&bytes))
    }

    /// Whether the first row named the columns.
    pub fn has_header(&self) -> bool {
        self.has_header
    }

    /// The names of the columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Number of columns.
    pub fn width(&self) -> usize {
        self.names.len()
    }

    /// Number of rows, without the header.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there is no row below the header.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The text of a cell, without blanks around it.
    pub fn cell(&self, row: usize, column: usize) -> &str {
        &self.rows[row].cells[column]
    }

    /// The line of a row in the file, counted from 1.
    pub fn line(&self, row: usize) -> usize {
        self.rows[row].line
    }

    /// The rows between empty lines. Comments end no part.
    pub fn parts(&self) -> Vec<Range<usize>> {
        let comments = |row: usize| self.comments.iter().filter(|(above, _)| *above == row).count();
        let lines = |row: &Row| 1 + row.cells.iter().map(|cell| cell.matches('\n').count()).sum::<usize>();
        let is_apart = |&row: &usize| self.rows[row].line > self.rows[row - 1].line + lines(&self.rows[row - 1]) + comments(row);
        let begins: Vec<usize> = (0..self.len().min(1)).chain((1..self.len()).filter(is_apart)).collect();
        let ends = begins.iter().skip(1).copied().chain([self.len()]);
        begins.iter().zip(ends).map(|(&begin, end)| begin..end).collect()
    }

    /// The column of a name.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|own| own == name)
    }

    /// The numbers of a column, NaN where a value is missing: an empty cell, `NaN`, `NA`, `N/A`, `null`, `-`, or the single point of FRED.
    ///
    /// # Errors
    /// [`IoError::Malformed`] with line and column for a cell that is no finite number, and where a column has decimal commas
    /// as well as decimal points.
    pub fn numbers(&self, column: usize) -> Result<Vec<f64>, IoError> {
        self.numbers_or_fault(column).map_err(|fault| fault.in_file(&self.path))
    }

    pub(in crate::io) fn numbers_or_fault(&self, column: usize) -> Result<Vec<f64>, Fault> {
        let mut mark: Option<(char, usize)> = None;
        let mut value = |row: &Row| {
            let cell = row.cells[column].as_str();
            if is_missing(cell) {
                return Ok(f64::NAN);
            }
            let fault = |expected: String| {
                let place = Place::Cell { line: row.line, column: column + 1 };
                Fault::new(place, format!("{} in column {}", quoted(cell), quoted(&self.names[column])), expected)
            };
            let Some(value) = number(cell, self.delimiter) else {
                let hint = if cell.contains(',') && self.delimiter == b',' { " with a decimal point" } else { "" };
                return Err(fault(format!("a finite number{hint}, or nothing")));
            };
            match (cell.chars().find(|&character| matches!(character, '.' | ',')), mark) {
                (Some(own), Some((other, line))) if own != other => {
                    return Err(fault(format!("the decimal mark '{other}' of line {line}")));
                }
                (Some(own), None) => mark = Some((own, row.line)),
                _ => {}
            }
            Ok(value)
        };
        self.rows.iter().map(&mut value).collect()
    }

    /// The positions of a column: numbers, or dates as days since 1970-01-01.
    ///
    /// Dates are ISO 8601: `2001-01-05`, `20010105` (if all cells are such), `2001-01-05T12:30`, with or without offset, `2001-01`;
    /// and quarters, `2001-Q3`.
    ///
    /// # Errors
    /// [`IoError::Malformed`] with line and column for a cell that is missing, or no number and no date.
    pub fn axis(&self, column: usize) -> Result<TableAxis, IoError> {
        self.axis_or_fault(column).map_err(|fault| fault.in_file(&self.path))
    }

    pub(super) fn axis_or_fault(&self, column: usize) -> Result<TableAxis, Fault> {
        let is_compact = |cell: &str| cell.len() == 8 && cell.bytes().all(|byte| byte.is_ascii_digit()) && csv::day(cell).is_some();
        let all_compact = !self.is_empty() && self.rows.iter().all(|row| is_compact(&row.cells[column]));
        let value = |row: &Row| match Value::of(&row.cells[column], self.delimiter) {
            Value::Number(value) if !all_compact => Some((value, false)),
            Value::Number(_) | Value::Date(_) => csv::day(&row.cells[column]).map(|day| (day, true)),
            Value::Missing | Value::Text => None,
        };
        let is_dates = self.rows.first().and_then(value).is_some_and(|(_, is_date)| is_date);
        let checked = |row: &Row| match value(row) {
            Some((value, is_date)) if is_date == is_dates => Ok(value),
            _ => {
                let place = Place::Cell { line: row.line, column: column + 1 };
                let found = format!("{} in column {}", quoted(&row.cells[column]), quoted(&self.names[column]));
                let expected = match (is_dates, row.line == self.rows[0].line) {
                    (_, true) => "a number or a date such as 2001-01-05, 2001-01-05T12:30 or 2001-01",
                    (true, _) => "a date, as in the rows above",
                    (false, _) => "a number, as in the rows above",
                };
                Err(Fault::new(place, found, expected))
            }
        };
        let values: Result<Vec<f64>, Fault> = self.rows.iter().map(checked).collect();
        values.map(|values| TableAxis { values, is_dates })
    }

    /// The column that a series in this table lies along: the first of dates, if no day is there twice; else the first of numbers that
    /// rise or fall strictly from row to row; `None` if there is neither.
    pub fn series_column(&self) -> Option<usize> {
        series::axis_column(self).map(|(column, _)| column)
    }

    /// The table as a polyline along a column: a point a row, in the order of the rows, and lines between neighbours along x, dates as
    /// days since 1970-01-01.
    ///
    /// All other columns of numbers become point arrays with NaN where a value is missing; texts, and dates as they stand in the
    /// file, become string arrays.
    ///
    /// # Errors
    /// As [`Table::axis`]; [`IoError::Malformed`] where two rows have the same x.
    pub fn series(&self, along: usize) -> Result<DataSet, IoError> {
        let axis = self.axis(along)?;
        let rows = series::rising(&axis.values);
        if let Some(pair) = rows.windows(2).find(|pair| axis.values[pair[0]] == axis.values[pair[1]]) {
            let (first, second) = (pair[0].min(pair[1]), pair[0].max(pair[1]));
            let place = Place::Cell { line: self.line(second), column: along + 1 };
            let found = format!("{} in column {}", quoted(self.cell(second, along)), quoted(&self.names[along]));
            let expected = format!("another place than that of line {}", self.line(first));
            return Err(Fault::new(place, found, expected).in_file(&self.path));
        }
        Ok(series::dataset(self, Some(&(along, axis))))
    }

    /// Adds a column of texts on the right, or replaces the cells of the one that has this name.
    /// Rows beyond the texts get an empty cell.
    pub fn set_column(&mut self, name: &str, cells: impl IntoIterator<Item = String>) {
        let place = self.column(name).unwrap_or(self.names.len());
        if place == self.names.len() {
            self.names.push(name.to_owned());
            self.rows.iter_mut().for_each(|row| row.cells.push(String::new()));
        }
        let mut cells = cells.into_iter();
        for row in &mut self.rows {
            row.cells[place] = cells.next().unwrap_or_default();
        }
    }

    /// Adds a column of numbers, or replaces the cells of the one that has this name: in the shortest form that gives the number
    /// back, with the decimal mark of the table; nothing for NaN.
    pub fn set_numbers(&mut self, name: &str, values: &[f64]) {
        let has_commas = self.has_decimal_commas();
        let text = |&value: &f64| match (value.is_nan(), has_commas) {
            (true, _) => String::new(),
            (false, true) => format!("{value:?}").replace('.', ","),
            (false, false) => format!("{value:?}"),
        };
        self.set_column(name, values.iter().map(text).collect::<Vec<_>>());
    }

    fn has_decimal_commas(&self) -> bool {
        let is_such = |cell: &str| cell.contains(',') && matches!(Value::of(cell, self.delimiter), Value::Number(_));
        self.delimiter != b',' && self.rows.iter().any(|row| row.cells.iter().any(|cell| is_such(cell)))
    }

    /// Writes the table beside `path`, to be put in its place by [`PendingFile::commit`].
    ///
    /// # Errors
    /// [`IoError::Write`] if the file cannot be created.
    pub fn write_temporary(&self, path: impl AsRef<Path>) -> Result<PendingFile, IoError> {
        PendingFile::create(path.as_ref(), |file| csv::write(self, file))
    }
}
