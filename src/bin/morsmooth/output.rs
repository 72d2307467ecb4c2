//! Targets that can be written, checked before any work is done.

use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// Refuses a target whose directory does not exist or that is a directory itself.
pub fn check_target(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(Failure::file(path, "the output is a directory; expected a file name"));
    }
    let parent = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    if parent.is_dir() {
        Ok(())
    } else {
        Err(Failure::file(path, format!("the directory {} does not exist; expected one that can be written", parent.display())))
    }
}

/// Writes bytes beside the target and renames, so that no half-written file is left.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let mut name = path.file_name().map(std::ffi::OsStr::to_owned).unwrap_or_default();
    name.push(format!(".{}.tmp", std::process::id()));
    let temporary = path.with_file_name(name);
    let written = std::fs::write(&temporary, bytes).and_then(|()| std::fs::rename(&temporary, path));
    written.map_err(|error| {
        let _ = std::fs::remove_file(&temporary);
        Failure::file(path, format!("cannot be written: {error}"))
    })
}
