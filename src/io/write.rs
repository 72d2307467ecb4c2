//! Writing a data set under a name whose extension chooses the format.

use std::path::Path;

use super::array::{ArrayData, DataArray, InformationValue};
use super::dataset::{Attributes, CellArray, DataSet, Geometry, IndexWidth, Polyhedra};
use super::error::{IoError, quoted};
use super::formats::MeshFormat;
#[cfg(feature = "vtkhdf")]
use super::hdf;
use super::pending::PendingFile;
use super::{legacy, xml};

/// The extension that VTK gives its HDF5 files.
#[cfg(feature = "vtkhdf")]
const HDF: &str = "vtkhdf";

/// Whether arrays of an XML file are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Compression {
    /// Raw bytes, as ParaView writes by default: fastest to write and read, and measured values hardly pack.
    #[default]
    None,
    /// zlib in blocks of 32 KiB, which every VTK reads.
    Zlib,
}

/// Writes a data set beside `path`, to be put in its place by [`PendingFile::commit`].
///
/// The extension chooses the format: `.vti .vtr .vts .vtp .vtu` write XML with appended raw data and 64-bit headers,
/// readable by VTK 6 and later; `.vtk` writes binary legacy, version 4.2, or 5.1 where 4.2 cannot count so far; `.vtkhdf` writes HDF5 as
/// VTK 9.7 reads it (feature `vtkhdf`). The mesh formats `.obj .off .ply .stl .mesh .msh` hold poly data and unstructured
/// grids. The last two leave out what [`losses`] names.
///
/// # Errors
/// [`IoError::Unwritable`] if the extension does not fit the data set, the data set contradicts itself, or the format
/// cannot hold it without loss; [`IoError::Write`] if the file cannot be created.
pub fn write_temporary(path: impl AsRef<Path>, dataset: &DataSet) -> Result<PendingFile, IoError> {
    write_temporary_with(path, dataset, Compression::default())
}

/// As [`write_temporary`], with a choice of compression, which `.vtk` files ignore.
///
/// # Errors
/// As [`write_temporary`].
pub fn write_temporary_with(
    path: impl AsRef<Path>,
    dataset: &DataSet,
    compression: Compression,
) -> Result<PendingFile, IoError> {
    let path = path.as_ref();
    let unwritable = |(found, expected): (String, String)| IoError::Unwritable { path: path.to_owned(), found, expected };
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_ascii_lowercase();
    let own = dataset.geometry.extension();
    if let Some(format) = MeshFormat::of_extension(&extension) {
        check(dataset).map_err(unwritable)?;
        format.losses(dataset).map_err(unwritable)?;
        return PendingFile::create(path, |file| format.write(dataset, file));
    }
    #[cfg(feature = "vtkhdf")]
    if extension == HDF {
        check(dataset).and_then(|()| hdf::check(dataset)).map_err(unwritable)?;
        return PendingFile::create(path, |file| hdf::write(dataset, compression, file));
    }
    if extension != own && extension != "vtk" {
        let found = format!("a name ending in {} for {}", quoted(&extension), dataset.geometry.name());
        return Err(unwritable((found, format!(".{own} or .vtk"))));
    }
    check(dataset).map_err(unwritable)?;
    if extension == "vtk" {
        legacy::check(dataset).map_err(unwritable)?;
        return PendingFile::create(path, |file| legacy::write(dataset, file));
    }
    check_names(dataset).map_err(unwritable)?;
    PendingFile::create(path, |file| xml::write(dataset, compression, file))
}

/// Writes a data set and puts it in its place.
///
/// # Errors
/// As [`write_temporary`] and [`PendingFile::commit`].
pub fn write(path: impl AsRef<Path>, dataset: &DataSet) -> Result<(), IoError> {
    write_temporary(path, dataset)?.commit()
}

/// What of a data set the format of a file name cannot hold, in words; empty for VTK's XML and legacy formats.
///
/// # Errors
/// [`IoError::Unwritable`] if the format has no room for the cells.
pub fn losses(path: impl AsRef<Path>, dataset: &DataSet) -> Result<Vec<String>, IoError> {
    let path = path.as_ref();
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    #[cfg(feature = "vtkhdf")]
    if extension.eq_ignore_ascii_case(HDF) {
        return Ok(hdf::losses(dataset));
    }
    let Some(format) = MeshFormat::of_extension(extension) else { return Ok(Vec::new()) };
    let unwritable = |(found, expected)| IoError::Unwritable { path: path.to_owned(), found, expected };
    format.losses(dataset).map_err(unwritable)
}

/// What was found and what was expected.
pub(super) type Objection = (String, String);

/// Every array of a data set, but for its cells.
pub(super) fn all_arrays(dataset: &DataSet) -> impl Iterator<Item = &DataArray> {
    let geometry: Vec<&DataArray> = match &dataset.geometry {
        Geometry::ImageData { .. } => Vec::new(),
        Geometry::RectilinearGrid { coordinates, .. } => coordinates.iter().collect(),
        Geometry::StructuredGrid { points, .. }
        | Geometry::PolyData { points, .. }
        | Geometry::UnstructuredGrid { points, .. } => vec![points],
    };
    let attributes = dataset.point_data.arrays.iter().chain(&dataset.cell_data.arrays);
    attributes.chain(&dataset.field_data).chain(geometry)
}

/// A data set built by hand may contradict itself; a file must not.
pub(super) fn check(dataset: &DataSet) -> Result<(), Objection> {
    let counted = |kind: &str, attributes: &Attributes, count: usize| {
        match attributes.arrays.iter().find(|array| array.components.checked_mul(count) != Some(array.data.len())) {
            Some(array) => Err((
                format!("{} values in {kind} array {}", array.data.len(), quoted(&array.name)),
                format!("{count} x {}", array.components),
            )),
            None => Ok(()),
        }
    };
    counted("point", &dataset.point_data, dataset.point_count())?;
    counted("cell", &dataset.cell_data, dataset.cell_count())?;
    if let Some(array) = all_arrays(dataset).find(|array| array.components == 0 || array.data.len() % array.components != 0) {
        let found = format!("{} values of {} components in array {}", array.data.len(), array.components, quoted(&array.name));
        return Err((found, "whole tuples".into()));
    }
    for array in all_arrays(dataset) {
        match &array.data {
            ArrayData::String(texts) if texts.iter().any(|text| text.contains(&0)) => {
                return Err((format!("a zero byte within a text of array {}", quoted(&array.name)), "texts without".into()));
            }
            _ => {}
        }
    }
    check_geometry(dataset)
}

fn check_geometry(dataset: &DataSet) -> Result<(), Objection> {
    let points = dataset.point_count();
    let positions = |array: &DataArray| {
        if array.components == 3 && array.tuples() == points {
            return Ok(());
        }
        Err((format!("{} x {} numbers as points", array.tuples(), array.components), format!("{points} x 3")))
    };
    match &dataset.geometry {
        Geometry::ImageData { .. } => Ok(()),
        Geometry::RectilinearGrid { extent, coordinates } => {
            let found = [0, 1, 2].map(|axis| coordinates[axis].data.len());
            if found == extent.dimensions() {
                return Ok(());
            }
            Err((format!("{found:?} coordinates"), format!("{:?}", extent.dimensions())))
        }
        Geometry::StructuredGrid { points, .. } => positions(points),
        Geometry::PolyData { points: array, verts, lines, polys, strips } => {
            positions(array)?;
            [verts, lines, polys, strips].into_iter().try_for_each(|cells| check_cells(cells, points))
        }
        Geometry::UnstructuredGrid { points: array, cells, types, polyhedra } => {
            positions(array)?;
            check_cells(cells, points)?;
            if types.len() != cells.len() {
                return Err((format!("{} cell types", types.len()), format!("{}", cells.len())));
            }
            match polyhedra {
                None => Ok(()),
                Some(stream @ Polyhedra::Stream { .. }) => {
                    stream.check(points).map_err(|fault| (fault.found, fault.expected))
                }
                Some(Polyhedra::Lists { faces, cells }) => {
                    check_cells(faces, points)?;
                    check_cells(cells, faces.len())
                }
            }
        }
    }
}

fn check_cells(cells: &CellArray, bound: usize) -> Result<(), Objection> {
    let told = |fault: super::error::Fault| (fault.found, fault.expected);
    super::cells::check_offsets(&cells.offsets, Some(cells.connectivity.len())).map_err(told)?;
    super::cells::check_points(cells, bound).map_err(told)?;
    if cells.width == IndexWidth::Bits32 && i32::try_from(cells.connectivity.len().max(bound)).is_err() {
        return Err((format!("{} point numbers in 32 bits", cells.connectivity.len()), "fewer than 2^31".into()));
    }
    Ok(())
}

/// Names of an array, of its components, and all that its information keys say.
fn words(array: &DataArray) -> impl Iterator<Item = &String> {
    let keys = array.information.iter().flat_map(|key| {
        let values = match &key.value {
            InformationValue::Single(value) => std::slice::from_ref(value),
            InformationValue::List(values) => values,
        };
        [&key.name, &key.location].into_iter().chain(values)
    });
    std::iter::once(&array.name).chain(&array.component_names).chain(keys)
}

/// Characters that no XML file can hold, even escaped.
fn check_names(dataset: &DataSet) -> Result<(), Objection> {
    let is_unwritable = |character: char| {
        character < ' ' && !matches!(character, '\t' | '\n' | '\r') || matches!(character, '\u{fffe}' | '\u{ffff}')
    };
    for name in all_arrays(dataset).flat_map(words) {
        if name.contains(is_unwritable) {
            return Err((format!("a control character in the name {}", quoted(name)), "a name that XML can hold".into()));
        }
    }
    Ok(())
}
