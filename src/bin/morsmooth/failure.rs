//! Errors as a user reads them: `error: what was found; what was expected`, then `hint: …`.

use std::io::Write;
use std::path::Path;

/// Why the run ended with exit code 2.
#[derive(Debug)]
pub struct Failure {
    message: String,
    hints: Vec<String>,
}

impl Failure {
    /// Something about the command line.
    pub fn usage(message: impl Into<String>) -> Self {
        Self { message: message.into(), hints: Vec::new() }
    }

    /// Something about a file.
    pub fn file(path: &Path, message: impl std::fmt::Display) -> Self {
        Self::usage(format!("{}: {message}", path.display()))
    }

    /// Adds what to do about it.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hints.push(hint.into());
        self
    }

    /// In a line.
    pub fn text(&self) -> String {
        let hints: Vec<String> = self.hints.iter().map(|hint| format!(" (hint: {hint})")).collect();
        format!("{}{}", self.message, hints.concat())
    }

    /// Prints to standard error; a closed pipe is not an error.
    pub fn print(&self) {
        let mut stderr = std::io::stderr().lock();
        let _ = writeln!(stderr, "error: {}", self.message);
        for hint in &self.hints {
            let _ = writeln!(stderr, "hint: {hint}");
        }
    }
}
