//! Errors as a user reads them: what was found and what was expected, then hints; in Python an exception.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

/// The exceptions of `morsmooth._errors`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Input or options.
    Input,
    /// Finished, but the guarantee is not met.
    Guarantee,
    /// Handles that contradict each other.
    Contradiction,
    /// A mistake of ours.
    Internal,
}

/// Why a call has no result.
#[derive(Debug)]
pub struct Failure {
    kind: Kind,
    message: String,
    hints: Vec<String>,
}

impl Failure {
    /// Something about what was given.
    pub fn input(message: impl std::fmt::Display) -> Self {
        Self { kind: Kind::Input, message: message.to_string(), hints: Vec::new() }
    }

    /// A result without what is promised.
    pub fn guarantee(message: impl std::fmt::Display) -> Self {
        Self { kind: Kind::Guarantee, ..Self::input(message) }
    }

    /// Handles that no shape without inversions has.
    pub fn contradiction(message: impl std::fmt::Display) -> Self {
        Self { kind: Kind::Contradiction, ..Self::input(message) }
    }

    /// A mistake of ours.
    pub fn internal(message: impl std::fmt::Display) -> Self {
        Self { kind: Kind::Internal, ..Self::input(message) }
    }

    /// Adds what to do about it.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hints.push(hint.into());
        self
    }

    /// The exception.
    pub fn raise(self, py: Python<'_>) -> PyErr {
        static CLASSES: [PyOnceLock<Py<PyType>>; 4] = [const { PyOnceLock::new() }; 4];
        let (place, name) = match self.kind {
            Kind::Input => (0, "InputError"),
            Kind::Guarantee => (1, "GuaranteeError"),
            Kind::Contradiction => (2, "ContradictionError"),
            Kind::Internal => (3, "InternalError"),
        };
        match CLASSES[place].import(py, "morsmooth._errors", name) {
            Ok(class) => PyErr::from_type(class.clone(), (self.message, self.hints)),
            Err(error) => error,
        }
    }
}
