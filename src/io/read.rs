//! Reading a file of any format that this module knows.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::collection::{may_list_files, resolve};
use super::dataset::DataSet;
use super::error::{Fault, IoError, Place};
use super::formats::MeshFormat;
#[cfg(feature = "vtkhdf")]
use super::hdf;
use super::parallel::read_indexed;
use super::xml::Index;
use super::{legacy, xml};

/// Reads a data set from a VTK XML file (`.vti .vtr .vts .vtp .vtu`), a parallel one (`.pvti .pvtr .pvts .pvtp .pvtu`), a legacy
/// `.vtk` file, a VTKHDF file (`.vtkhdf`, with the feature of this name), a mesh file (`.obj .off .ply .stl .mesh .msh`), a table (`.csv .tsv`), an image (`.png`), or an array (`.npy`).
///
/// Pieces of a parallel file become one data set without seams: ghost cells are left out, and points that stand in several pieces are one.
/// A collection (`.vtm .pvd`) is read if it names one file; of several, `case.vtm/inlet` or `steps.pvd/3` is one of them, as
/// [`resolve`](super::resolve) finds it; so are the steps and blocks within a VTKHDF file, `run.vtkhdf/3`. The content tells VTK's files, whatever they are called; mesh files are told by their extension. Several pieces in one
/// file become one data set. Surfaces become poly data, Medit and Gmsh meshes unstructured grids; points keep their
/// numbers (but for `.stl`, which has none). A table becomes a polyline: a point a row, along its dates or its first rising or falling
/// column.
///
/// # Errors
/// [`IoError::Read`] if there is no such file, [`IoError::Unsupported`] for other formats, [`IoError::Malformed`] with
/// line or byte for files that break their format. Damaged files are never a panic.
///
/// # Cost
/// Time and memory linear in the size of the file and of the data that it declares. Declared sizes are checked against
/// the bytes that are there before memory is taken; packed data may unfold at most as far as its compressor can pack
/// (1,040-fold for zlib, 256-fold for lz4, 65,536-fold for lzma). Of a VTKHDF file, all arrays together are at most 1,040 times as long
/// as the file, and 64 KiB.
pub fn read(path: impl AsRef<Path>) -> Result<DataSet, IoError> {
    let path = path.as_ref();
    #[cfg(feature = "vtkhdf")]
    if let Some((file, address)) = hdf::inside(path) {
        return hdf::read(&file, &address);
    }
    match resolve(path)? {
        same if same == path => read_file(path, LEVELS),
        block => read_file(&block, LEVELS),
    }
}

/// A collection may list parallel files, and these pieces.
const LEVELS: usize = 2;

/// Reads a file; names of other files in it are followed for a number of levels, so that no file can lead to itself.
fn read_file(path: &Path, levels: usize) -> Result<DataSet, IoError> {
    let failed = |source| IoError::Read { path: path.to_owned(), source };
    let file = File::open(path).map_err(failed)?;
    let metadata = file.metadata().map_err(failed)?;
    // What is no file, such as a pipe, has no length and cannot be read from the middle.
    let length = usize::try_from(metadata.len()).ok().filter(|_| metadata.is_file()).unwrap_or(0);
    let mut bytes = Vec::new();
    #[cfg(feature = "vtkhdf")]
    {
        (&file).take(hdf::SIGNATURE.len() as u64).read_to_end(&mut bytes).map_err(failed)?;
        if bytes == hdf::SIGNATURE && metadata.is_file() {
            return hdf::read(path, "");
        }
    }
    let mut step = HEAD;
    while length > LARGE && bytes.len() < length {
        (&file).take(step).read_to_end(&mut bytes).map_err(failed)?;
        if !is_xml(&bytes) || bytes.len() < HEAD as usize {
            break;
        }
        if xml::reaches_raw_data(&bytes) {
            let source = xml::Source::File { file: &file, length };
            return xml::read(&bytes, source).map_err(|fault| fault.in_file(path));
        }
        step = bytes.len() as u64;
    }
    (&file).read_to_end(&mut bytes).map_err(failed)?;
    if levels > 0
        && may_list_files(&bytes)
        && let Some(index) = xml::index(&bytes).map_err(|fault| fault.in_file(path))?
    {
        let below = if matches!(index, Index::Parallel { .. }) { 0 } else { levels - 1 };
        return read_indexed(path, index, |part| read_file(part, below));
    }
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    read_bytes(&bytes, MeshFormat::of_extension(extension)).map_err(|fault| fault.in_file(path))
}

/// Larger files are read array by array where their format allows.
const LARGE: usize = 1 << 22;
/// Where the head of a large file is searched first; it doubles until it is found.
const HEAD: u64 = 1 << 16;

fn is_xml(bytes: &[u8]) -> bool {
    text(bytes).starts_with(b"<")
}

/// Whether bytes begin as XML does, and nothing else that is read here.
pub(super) fn is_certainly_xml(bytes: &[u8]) -> bool {
    [&b"<?xml"[..], b"<!--", b"<VTKFile"].iter().any(|mark| text(bytes).starts_with(mark))
}

/// The bytes without what may stand before a text.
fn text(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start()
}

fn read_bytes(bytes: &[u8], format: Option<MeshFormat>) -> Result<DataSet, Fault> {
    const KNOWN: &str = "a serial VTK XML file, a legacy .vtk file, a mesh (.obj .off .ply .stl .mesh .msh), a table (.csv .tsv), an image (.png), or an array (.npy)";
    if bytes.starts_with(legacy::LEGACY_MARK) {
        return legacy::read(bytes);
    }
    // The head of a table may begin with a bracket, too.
    if is_xml(bytes) && (format.is_none() || is_certainly_xml(bytes)) {
        return xml::read(bytes, xml::Source::Memory(bytes));
    }
    let fault = |found: &str| Err(Fault::unsupported(Place::File, found, KNOWN));
    if bytes.is_empty() {
        return Err(Fault::new(Place::File, "an empty file", KNOWN));
    }
    if bytes.starts_with(b"\x89HDF") {
        return fault("an HDF5 file");
    }
    if bytes.starts_with(b"\x1f\x8b") {
        return fault("a gzip file");
    }
    if let Some(format) = format {
        return format.read(bytes);
    }
    fault("a file of unknown format")
}
