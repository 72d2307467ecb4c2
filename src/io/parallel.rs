//! Data sets in several files: the pieces of a parallel file become one.

use std::path::{Path, PathBuf};

use super::collection::{Collection, CollectionKind, addresses};
use super::dataset::{DataSet, Geometry};
use super::error::{Fault, IoError, Place, quoted};
use super::weld::{owned, weld};
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
            let whole = merged(parts).map_err(|fault| fault.in_file(path))?;
            Ok(DataSet { field_data, version, ..whole })
        }
        Index::Collection(listing) => only(path, &Collection::of_listing(path, listing), serial),
    }
}

/// Pieces as one data set without seams.
fn merged(parts: Vec<DataSet>) -> Result<DataSet, Fault> {
    let counts: Vec<usize> = parts.iter().map(DataSet::point_count).collect();
    let whole = merge(parts)?;
    match whole.geometry {
        Geometry::PolyData { .. } | Geometry::UnstructuredGrid { .. } => weld(whole, &counts),
        _ => Ok(DataSet { point_data: owned(whole.point_data), cell_data: owned(whole.cell_data), ..whole }),
    }
}

/// Parts of one file as one data set; a part that is alone has no seams.
#[cfg(feature = "vtkhdf")]
pub(super) fn joined(mut parts: Vec<DataSet>) -> Result<DataSet, Fault> {
    match parts.len() {
        1 => Ok(parts.swap_remove(0)),
        _ => merged(parts),
    }
}

pub(super) fn beside(path: &Path, reference: &Reference) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).join(&reference.file)
}

/// The one file of a collection; several are not one data set, and which of them is meant is the user's to say.
fn only(path: &Path, collection: &Collection, serial: impl Fn(&Path) -> Result<DataSet, IoError>) -> Result<DataSet, IoError> {
    let what = match collection.kind {
        CollectionKind::Blocks => "blocks",
        CollectionKind::Steps => "time steps",
    };
    match collection.entries.as_slice() {
        [only] if collection.empty.is_empty() => serial(&only.path),
        entries => {
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            let address = &entries[0].address;
            let found = format!("a collection of {} {what} as one data set", entries.len() + collection.empty.len());
            let expected = format!("one of them, such as {name}/{address} (there are {})", addresses(collection));
            Err(Fault::unsupported(Place::File, found, expected).in_file(path))
        }
    }
}
