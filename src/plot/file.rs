//! Files that are there whole or not at all.

use super::error::PlotError;
use std::io::Write;
use std::path::Path;

/// Writes a file through a temporary neighbour that is renamed, so that no reader sees half of it.
///
/// # Errors
/// [`PlotError::Write`] with the path asked for; the temporary file is removed.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), PlotError> {
    let refused = |source| PlotError::Write { path: path.to_path_buf(), source };
    let Some(name) = path.file_name() else {
        return Err(refused(std::io::Error::new(std::io::ErrorKind::InvalidInput, "the path names no file")));
    };
    let mut temporary_name = std::ffi::OsString::from(".");
    temporary_name.push(name);
    // Two processes that write the same picture must not share a temporary file.
    temporary_name.push(format!(".{}.part", std::process::id()));
    let temporary = path.with_file_name(temporary_name);
    let written = std::fs::File::create(&temporary)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| std::fs::rename(&temporary, path));
    written.map_err(|source| {
        // The first failure is the one to report; a leftover that cannot be removed changes nothing about it.
        let _ = std::fs::remove_file(&temporary);
        refused(source)
    })
}
