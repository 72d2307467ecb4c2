//! Tables of text with a separator: `.csv` and `.tsv`; and the dates that stand in them.
//!
//! The separator is found in the first row: a tab, else a semicolon, else a comma. Lines that begin with `#` are comments. A
//! first row with any word that is neither a number nor a date is the header.

use std::borrow::Cow;
use std::io::Write;

use csv::{ByteRecord, QuoteStyle, ReaderBuilder, WriterBuilder};
use jiff::civil::{Date, DateTime};
use jiff::{SignedDuration, Timestamp};

use crate::io::error::{Fault, Place, quoted};
use crate::io::legacy::LEGACY_MARK;

use super::table::{Row, Table, Value};

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The same text with tabs in the place of blanks, if no row has another separator.
///
/// Lists of numbers are often separated by blanks; titles and names have blanks within.
pub(super) fn without_blanks(bytes: &[u8]) -> Cow<'_, [u8]> {
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let lines = || bytes.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let is_row = |line: &&[u8]| !line.starts_with(b"#");
    let has_separator = |line: &[u8]| line.iter().any(|byte| matches!(byte, b',' | b';' | b'\t'));
    if lines().filter(is_row).any(has_separator) {
        return Cow::Borrowed(bytes);
    }
    let separated = |line: &[u8]| match is_row(&line) {
        true => line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).collect::<Vec<_>>().join(&b'\t'),
        false => line.to_vec(),
    };
    Cow::Owned(lines().map(separated).collect::<Vec<_>>().join(&b'\n'))
}

/// Reads a table; every row has as many cells as the first one.
pub(super) fn read(bytes: &[u8]) -> Result<Table, Fault> {
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let delimiter = delimiter(bytes);
    let mut reader =
        ReaderBuilder::new().has_headers(false).flexible(true).delimiter(delimiter).comment(Some(b'#')).from_reader(bytes);
    let mut scan = Scan { bytes, place: 0, line: 1 };
    let mut table = Table { delimiter, ..Table::default() };
    let mut record = ByteRecord::new();
    let mut header_line = None;
    loop {
        let start = reader.position().byte() as usize;
        let more = reader.read_byte_record(&mut record).map_err(|error| {
            let line = error.position().map_or(Place::File, |position| Place::Line(position.line() as usize));
            Fault::new(line, error.to_string(), "rows of cells")
        })?;
        let (line, comments) = scan.row_after(start);
        let above = table.rows.len();
        table.comments.extend(comments.into_iter().map(|comment| (above, comment)));
        if !more {
            break;
        }
        let cells = cells(&record, line)?;
        if cells.len() == 1 && cells[0].is_empty() && table.width() > 1 {
            continue;
        }
        if let Some(first) = header_line.or(table.rows.first().map(|row| row.line)) {
            if cells.len() != table.width() {
                let expected = format!("{} as in line {first}", table.width());
                return Err(Fault::new(Place::Line(line), format!("{} cells", cells.len()), expected));
            }
        } else if cells.iter().any(|cell| Value::of(cell, delimiter) == Value::Text) {
            header_line = Some(line);
            table.names = names(cells);
            table.has_header = true;
            // Comments so far stand above the header.
            table.comments.iter_mut().for_each(|comment| comment.0 = Table::ABOVE_HEADER);
            continue;
        } else {
            table.names = (1..=cells.len()).map(|number| format!("column_{number}")).collect();
        }
        table.rows.push(Row { line, cells });
    }
    if table.names.is_empty() {
        return Err(Fault::new(Place::File, "no row", "a table with at least one"));
    }
    Ok(table)
}

/// The separator: the first of tab, semicolon and comma that stands outside quotes in the first row.
fn delimiter(bytes: &[u8]) -> u8 {
    let is_row = |line: &&[u8]| !line.trim_ascii().is_empty() && !line.starts_with(b"#");
    let first = bytes.split(|&byte| byte == b'\n').find(is_row).unwrap_or_default();
    let mut is_quoted = false;
    let mut found = [false; 3];
    for &byte in first {
        match byte {
            b'"' => is_quoted = !is_quoted,
            b'\t' if !is_quoted => found[0] = true,
            b';' if !is_quoted => found[1] = true,
            _ => {}
        }
    }
    match found {
        [true, ..] => b'\t',
        [_, true, _] => b';',
        _ => b',',
    }
}

/// Finds the line of each row, and the comments between rows, which the crate skips.
struct Scan<'a> {
    bytes: &'a [u8],
    place: usize,
    line: usize,
}

impl Scan<'_> {
    /// Goes on to a row that starts, after blank lines and comments, at byte `start`: its line, and these comments.
    fn row_after(&mut self, start: usize) -> (usize, Vec<String>) {
        self.line += self.bytes[self.place..start].iter().filter(|&&byte| byte == b'\n').count();
        self.place = start;
        let mut comments = Vec::new();
        loop {
            match self.bytes.get(self.place) {
                Some(b'\n') => self.line += 1,
                Some(b'\r') => {}
                Some(b'#') => {
                    let rest = &self.bytes[self.place..];
                    let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
                    comments.push(String::from_utf8_lossy(&rest[..length]).trim_end().to_owned());
                    self.place += length;
                    continue;
                }
                _ => return (self.line, comments),
            }
            self.place += 1;
        }
    }
}

fn cells(record: &ByteRecord, line: usize) -> Result<Vec<String>, Fault> {
    let cell = |(number, bytes): (usize, &[u8])| match std::str::from_utf8(bytes) {
        // A byte order mark within a text stands for nothing, and would be lost at the start of a file.
        Ok(text) => Ok(text.trim_matches(|letter: char| letter.is_whitespace() || letter == '\u{feff}').to_owned()),
        Err(_) => {
            let found = quoted(&String::from_utf8_lossy(bytes));
            Err(Fault::new(Place::Cell { line, column: number + 1 }, found, "text in UTF-8"))
        }
    };
    record.iter().enumerate().map(cell).collect()
}

/// Names of columns, none empty and none twice.
fn names(cells: Vec<String>) -> Vec<String> {
    let mut names: Vec<String> = Vec::with_capacity(cells.len());
    for (number, cell) in cells.into_iter().enumerate() {
        let name = if cell.is_empty() { format!("column_{}", number + 1) } else { cell };
        let is_taken = names.contains(&name);
        names.push(if is_taken { format!("{name}_{}", number + 1) } else { name });
    }
    names
}

/// Writes a table with its own separator; the cells as they were read, quoted where they must be.
pub(super) fn write(table: &Table, mut out: impl Write) -> std::io::Result<()> {
    let mut comments = table.comments.iter().peekable();
    let mut put_comments = |out: &mut dyn Write, row: usize| -> std::io::Result<()> {
        while let Some((_, comment)) = comments.next_if(|comment| comment.0 == row) {
            writeln!(out, "{comment}")?;
        }
        Ok(())
    };
    let line = |cells: &[String], is_first: bool| -> std::io::Result<Vec<u8>> {
        // Unquoted, a separator that is looked for before the table's own would be taken for it.
        let is_mistaken = |letter: char| match table.delimiter {
            // A single column shows no separator of its own.
            _ if cells.len() == 1 => matches!(letter, ',' | ';' | '\t'),
            b',' => matches!(letter, ';' | '\t'),
            b';' => letter == '\t',
            _ => false,
        };
        // At the beginning of a file these tell of another format, and of the encoding.
        let is_mark = is_first && cells.first().is_some_and(|cell| cell.trim_start().starts_with(['<', '\u{feff}']));
        let must_quote = is_mark || cells.iter().any(|cell| cell.contains(is_mistaken));
        let style = if must_quote { QuoteStyle::Always } else { QuoteStyle::Necessary };
        // Quotes keep a cell that begins as a comment does from becoming one.
        let mut writer = WriterBuilder::new()
            .delimiter(table.delimiter)
            .quote_style(style)
            .comment(Some(b'#'))
            .from_writer(Vec::new());
        writer.write_record(cells)?;
        writer.into_inner().map_err(|error| std::io::Error::other(error.to_string()))
    };
    if table.comments.first().is_some_and(|(_, comment)| comment.as_bytes().starts_with(LEGACY_MARK)) {
        // An empty line keeps the comment from making the table a legacy file.
        writeln!(out)?;
    }
    put_comments(&mut out, Table::ABOVE_HEADER)?;
    if table.has_header {
        out.write_all(&line(&table.names, true)?)?;
    }
    for (number, row) in table.rows.iter().enumerate() {
        put_comments(&mut out, number)?;
        out.write_all(&line(&row.cells, number == 0 && !table.has_header)?)?;
    }
    put_comments(&mut out, table.rows.len())
}

/// Seconds of a day.
const DAY: f64 = 86_400.0;

/// The day of a date, in days since 1970-01-01, the part of the day as fraction; `None` if the text is no date.
///
/// ISO 8601: `2001-01-05`, `20010105`, `2001-01-05T12:30`, with or without offset, `2001-01`, and the quarters `2001-Q3` of
/// statistical offices. Without offset, times are taken as they stand.
pub(super) fn day(text: &str) -> Option<f64> {
    let epoch = Date::constant(1970, 1, 1).at(0, 0, 0, 0);
    let days = |date: DateTime| {
        let since: SignedDuration = date.duration_since(epoch);
        since.as_secs_f64() / DAY
    };
    if let Some((year, rest)) = text.split_at_checked(4) {
        let rest = rest.strip_prefix('-').unwrap_or(rest);
        let month = match rest.strip_prefix('Q') {
            Some(quarter) => quarter.parse::<i8>().ok().filter(|quarter| (1..=4).contains(quarter)).map(|quarter| 3 * quarter - 2),
            None if rest.len() == 2 && text.len() == 7 => rest.parse().ok(),
            None => None,
        };
        if let (Ok(year), Some(month)) = (year.parse(), month) {
            return Date::new(year, month, 1).ok().map(|date| days(date.at(0, 0, 0, 0)));
        }
    }
    if let Ok(time) = text.parse::<Timestamp>() {
        return Some(time.as_duration().as_secs_f64() / DAY);
    }
    // Shorter texts, such as a year alone, are numbers.
    let is_long = text.len() >= "20010105".len() && text.starts_with(|first: char| first.is_ascii_digit());
    text.parse::<DateTime>().ok().filter(|_| is_long).map(days)
}
