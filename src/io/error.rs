//! What can be wrong with a file, told with its place.

use std::path::{Path, PathBuf};

/// Where in a file something was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line, counted from 1.
    Line(usize),
    /// A byte, counted from 0.
    Byte(usize),
    /// A cell of a table.
    Cell {
        /// Its line in the file, counted from 1.
        line: usize,
        /// Its column, counted from 1.
        column: usize,
    },
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, ", line {line}"),
            Self::Byte(byte) => write!(f, ", byte {byte}"),
            Self::Cell { line, column } => write!(f, ", line {line}, column {column}"),
        }
    }
}

/// Why a file could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// The operating system refused to hand the file out.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The answer of the operating system.
        source: std::io::Error,
    },
    /// The operating system refused to take the file.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The answer of the operating system.
        source: std::io::Error,
    },
    /// The file breaks the rules of its format, or is damaged.
    #[error("{}{place}: found {found}; expected {expected}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Where in the file.
        place: Place,
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: String,
    },
    /// The file follows its format, but this crate does not read that part of it.
    #[error("{}{place}: {found} cannot be read here; expected {expected}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// Where in the file.
        place: Place,
        /// What stands there.
        found: String,
        /// What could be read.
        expected: String,
    },
    /// The file to be written has a name that does not fit what is to be written.
    #[error("cannot write {}: found {found}; expected {expected}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What does not fit.
        found: String,
        /// What would.
        expected: String,
    },
}

/// An [`IoError`] in the making: the reader of a part does not know the name of the file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    pub place: Place,
    pub found: String,
    pub expected: String,
    pub unsupported: bool,
}

impl Fault {
    pub fn new(place: Place, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { place, found: found.into(), expected: expected.into(), unsupported: false }
    }

    pub fn unsupported(place: Place, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { unsupported: true, ..Self::new(place, found, expected) }
    }

    /// Fills in the place, where the part that found the fault did not know it.
    pub fn or_at(mut self, place: Place) -> Self {
        if self.place == Place::File {
            self.place = place;
        }
        self
    }

    pub fn in_file(self, path: &Path) -> IoError {
        let Self { place, found, expected, unsupported } = self;
        let path = path.to_owned();
        if unsupported {
            IoError::Unsupported { path, place, found, expected }
        } else {
            IoError::Malformed { path, place, found, expected }
        }
    }
}

/// How a name or token from a file is shown in a message: quoted, and cut when it is long.
pub(super) fn quoted(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((cut, _)) => format!("\"{}...\"", text[..cut].escape_debug()),
        None => format!("\"{}\"", text.escape_debug()),
    }
}
