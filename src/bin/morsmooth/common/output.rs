//! Targets that can be written, checked before any work is done.

use std::path::{Path, PathBuf};

use morsmooth::io::{is_same_file, resolve};

use crate::failure::Failure;

/// Refuses a target whose directory does not exist or that is a directory itself.
pub fn check_target(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(Failure::file(path, "the output is a directory; expected a file name"));
    }
    let parent = parent(path);
    if parent.is_dir() {
        Ok(())
    } else {
        Err(Failure::file(path, format!("the directory {} does not exist; expected one that can be written", parent.display())))
    }
}

/// Refuses an output in the place of the input, and outputs and reports that cannot be written or would overwrite another file.
pub fn check_output(input: &Path, output: &Path, report: Option<&Path>, others: &[&Path]) -> Result<(), Failure> {
    // One block of a list is a file of its own.
    let own = resolve(input).unwrap_or_else(|_| input.to_owned());
    if is_same_file(&own, output) {
        return Err(Failure::file(output, "the output is the input file; expected another name")
            .hint("the input is never changed; write to another file and rename it yourself"));
    }
    check_target(output)?;
    check_report(report, &[&[input, output], others].concat())
}

/// Refuses a report that cannot be written, or that would overwrite one of the other files of the run.
pub fn check_report(report: Option<&Path>, others: &[&Path]) -> Result<(), Failure> {
    let Some(report) = report else { return Ok(()) };
    check_target(report)?;
    match others.iter().find(|other| is_same_place(report, other)) {
        Some(other) => Err(Failure::file(report, format!("the report would overwrite {}; expected another name", other.display()))),
        None => Ok(()),
    }
}

/// Refuses a directory of pictures that cannot be made.
pub fn check_directory(directory: Option<&Path>) -> Result<(), Failure> {
    let Some(directory) = directory else { return Ok(()) };
    match directory.ancestors().find(|ancestor| ancestor.exists()) {
        Some(file) if !file.is_dir() => {
            Err(Failure::file(directory, format!("{} is a file; expected a directory, or a name for a new one", file.display())))
        }
        _ => Ok(()),
    }
}

/// Whether two paths name the same file, which need not exist yet.
pub fn is_same_place(a: &Path, b: &Path) -> bool {
    is_same_file(a, b) || (a.file_name() == b.file_name() && is_same_file(&parent(a), &parent(b)))
}

fn parent(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}
