//! Data sets in several files: the pieces of a parallel file become one.

use std::path::{Path, PathBuf};

use super::dataset::{DataSet, Geometry};
use super::error::{Fault, IoError, Place, quoted};
use super::weld::weld;
use super::xml::{Index, Reference, merge};

/// Reads the files that an index file names.
///
/// # Arguments
/// * `path`: the index file, whose folder the names are relative to.
/// * `serial`: reads one file that holds its data itself.
pub(super) fn read_indexed(
    path: &Path,
    index: Index,
    serial: impl Fn(&Path) -> Result<DataSet, IoError>,
) -> Result<DataSet, IoError> {
    match index {
        Index::Parallel { kind, pieces } => {
            let mut parts = Vec::with_capacity(pieces.len());
            for reference in &pieces {
                let place = beside(path, reference);
                let part = serial(&place)?;
                if part.geometry.name() != kind {
                    let found = format!("{} in {}", part.geometry.name(), quoted(&reference.file));
                    return Err(Fault::new(reference.place, found, kind).in_file(path));
                }
                parts.push(part);
            }
            let field_data = parts[0].field_data.clone();
            let version = parts[0].version;
            let counts: Vec<usize> = parts.iter().map(DataSet::point_count).collect();
            let fault = |fault: Fault| fault.in_file(path);
            let whole = merge(parts).map_err(fault)?;
            let whole = match whole.geometry {
                Geometry::PolyData { .. } | Geometry::UnstructuredGrid { .. } => weld(whole, &counts).map_err(fault)?,
                _ => whole,
            };
            Ok(DataSet { field_data, version, ..whole })
        }
        Index::Blocks(references) => only(path, &references, "blocks", serial),
        Index::Steps(references) => only(path, &references, "time steps", serial),
    }
}

fn beside(path: &Path, reference: &Reference) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).join(&reference.file)
}

/// The one file of a collection; several are not one data set, and which of them is meant is the user's to say.
fn only(
    path: &Path,
    references: &[Reference],
    what: &str,
    serial: impl Fn(&Path) -> Result<DataSet, IoError>,
) -> Result<DataSet, IoError> {
    const LISTED: usize = 6;
    if let [reference] = references {
        return serial(&beside(path, reference));
    }
    let mut names: Vec<&str> = references.iter().take(LISTED).map(|reference| reference.file.as_str()).collect();
    if references.len() > LISTED {
        names.push("...");
    }
    let expected = format!("one data set, such as one of {}", names.join(", "));
    Err(Fault::unsupported(Place::File, format!("a collection of {} {what}", references.len()), expected).in_file(path))
}
