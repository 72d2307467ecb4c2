//! ParaView collections (`.pvd`): files in time.

use std::io::Write;
use std::path::Path;

use super::error::IoError;
use super::pending::PendingFile;

/// Writes a collection beside `path`, to be put in its place by [`PendingFile::commit`].
///
/// # Arguments
/// * `entries`: time and file name of each, names relative to the folder of the collection.
///
/// # Errors
/// [`IoError::Write`] if the file cannot be created.
pub fn write_collection(path: impl AsRef<Path>, entries: &[(f64, String)]) -> Result<PendingFile, IoError> {
    PendingFile::create(path.as_ref(), |file| {
        writeln!(file, "<?xml version=\"1.0\"?>")?;
        writeln!(file, "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  <Collection>")?;
        for (time, name) in entries {
            writeln!(file, "    <DataSet timestep=\"{time}\" group=\"\" part=\"0\" file=\"{}\"/>", escaped(name))?;
        }
        writeln!(file, "  </Collection>\n</VTKFile>")
    })
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
