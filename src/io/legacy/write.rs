//! Writes legacy files, binary: version 4.2, which every VTK reads, or 5.1 where 32 bits do not count far enough, or where the
//! points of higher-order cells are in its order.

use std::io::{self, Write};

use crate::io::array::{ArrayData, DataArray, InformationValue};
use crate::io::cells::is_face_run;
use crate::io::bytes::{ByteOrder, Element, pack_bits};
use crate::io::dataset::{Attributes, CellArray, DataSet, Geometry, Role};
use crate::io::write::Objection;

use super::order::{POINTS_MOVED, has_moved_points};
use crate::io::lexer::encoded;

const POLYHEDRON: u8 = 42;

/// Refuses what the format would lose.
pub(in crate::io) fn check(dataset: &DataSet) -> Result<(), Objection> {
    let arrays = dataset.point_data.arrays.iter().chain(&dataset.cell_data.arrays).chain(&dataset.field_data);
    if arrays.into_iter().any(|array| array.name.is_empty()) {
        return Err(("an array without a name, which .vtk files cannot hold".into(), "a name for every array".into()));
    }
    match &dataset.geometry {
        Geometry::ImageData { direction, .. } if *direction != [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0] => {
            Err(("an image with rotated axes, which .vtk files cannot hold".into(), "a name ending in .vti".into()))
        }
        Geometry::UnstructuredGrid { points, types, polyhedra, .. } if types.contains(&POLYHEDRON) => {
            let runs = polyhedra.as_ref().map(|polyhedra| polyhedra.runs()).unwrap_or_default();
            let is_broken = |cell: &usize| types[*cell] == POLYHEDRON && !runs.get(*cell).is_some_and(|run| is_face_run(run, points.tuples()));
            match (0..types.len()).find(is_broken) {
                Some(cell) => Err((format!("cell {cell}, a polyhedron without whole faces"), "faces for every polyhedron in a .vtk file".into())),
                None => Ok(()),
            }
        }
        _ => Ok(()),
    }
}

/// Writes a data set that the checks accept.
pub(in crate::io) fn write(dataset: &DataSet, file: &mut impl Write) -> io::Result<()> {
    let wide = longest_list(&dataset.geometry).saturating_add(dataset.cell_count()) > i32::MAX as usize
        || dataset.point_count() > i32::MAX as usize
        || (has_moved_points(&dataset.geometry) && dataset.version >= Some(POINTS_MOVED));
    write_version(dataset, wide, file)
}

/// Writes version 5.1 if `wide`, else 4.2.
fn write_version(dataset: &DataSet, wide: bool, file: &mut impl Write) -> io::Result<()> {
    let title: String = dataset.title.chars().filter(|character| !character.is_control()).take(250).collect();
    let title = if title.is_empty() { "vtk output" } else { &title };
    writeln!(file, "# vtk DataFile Version {}\n{title}\nBINARY", if wide { "5.1" } else { "4.2" })?;
    writeln!(file, "DATASET {}", legacy_kind(&dataset.geometry))?;
    if !dataset.field_data.is_empty() {
        field(&dataset.field_data.iter().collect::<Vec<_>>(), file)?;
    }
    geometry(&dataset.geometry, wide, file)?;
    attributes("CELL_DATA", &dataset.cell_data, dataset.cell_count(), file)?;
    attributes("POINT_DATA", &dataset.point_data, dataset.point_count(), file)
}

fn legacy_kind(geometry: &Geometry) -> &'static str {
    match geometry {
        Geometry::ImageData { .. } => "STRUCTURED_POINTS",
        Geometry::RectilinearGrid { .. } => "RECTILINEAR_GRID",
        Geometry::StructuredGrid { .. } => "STRUCTURED_GRID",
        Geometry::PolyData { .. } => "POLYDATA",
        Geometry::UnstructuredGrid { .. } => "UNSTRUCTURED_GRID",
    }
}

fn longest_list(geometry: &Geometry) -> usize {
    match geometry {
        Geometry::PolyData { verts, lines, polys, strips, .. } => {
            [verts, lines, polys, strips].into_iter().map(|cells| cells.connectivity.len()).max().unwrap_or(0)
        }
        Geometry::UnstructuredGrid { cells, .. } => cells.connectivity.len(),
        _ => 0,
    }
}

fn geometry(geometry: &Geometry, wide: bool, file: &mut impl Write) -> io::Result<()> {
    match geometry {
        Geometry::ImageData { extent, origin, spacing, .. } => {
            dimensions(extent.dimensions(), file)?;
            // The format counts from 0, so the first point becomes the origin.
            let first = [0, 1, 2].map(|axis| match extent.0[2 * axis] {
                // Not even the sign of a zero changes.
                0 => origin[axis],
                index => origin[axis] + f64::from(index) * spacing[axis],
            });
            writeln!(file, "SPACING {:?} {:?} {:?}", spacing[0], spacing[1], spacing[2])?;
            writeln!(file, "ORIGIN {:?} {:?} {:?}", first[0], first[1], first[2])
        }
        Geometry::RectilinearGrid { extent, coordinates } => {
            dimensions(extent.dimensions(), file)?;
            for (axis, array) in ["X", "Y", "Z"].into_iter().zip(coordinates.iter()) {
                writeln!(file, "{axis}_COORDINATES {} {}", array.tuples(), type_name(array))?;
                values(array, file)?;
            }
            Ok(())
        }
        Geometry::StructuredGrid { extent, points: array } => {
            dimensions(extent.dimensions(), file)?;
            points(array, file)
        }
        Geometry::PolyData { points: array, verts, lines, polys, strips } => {
            points(array, file)?;
            // Empty lists are left out: some readers stop at "VERTICES 0 0".
            let lists = [("VERTICES", verts), ("LINES", lines), ("POLYGONS", polys), ("TRIANGLE_STRIPS", strips)];
            lists.into_iter().filter(|(_, cells)| !cells.is_empty()).try_for_each(|(name, cells)| list(name, cells, wide, file))
        }
        Geometry::UnstructuredGrid { points: array, cells, types, polyhedra } => {
            points(array, file)?;
            if cells.is_empty() {
                return Ok(());
            }
            let runs = polyhedra.as_ref().map(|polyhedra| polyhedra.runs()).unwrap_or_default();
            if runs.is_empty() {
                list("CELLS", cells, wide, file)?;
            } else {
                let mut with_runs = CellArray::default();
                for (number, cell) in cells.iter().enumerate() {
                    match runs.get(number).filter(|run| !run.is_empty() && types.get(number) == Some(&POLYHEDRON)) {
                        Some(run) => with_runs.push(run.iter().copied()),
                        None => with_runs.push(cell.iter().copied()),
                    }
                }
                list("CELLS", &with_runs, wide, file)?;
            }
            writeln!(file, "CELL_TYPES {}", types.len())?;
            numbers(types, i32::from, file)?;
            writeln!(file)
        }
    }
}

fn dimensions([x, y, z]: [usize; 3], file: &mut impl Write) -> io::Result<()> {
    writeln!(file, "DIMENSIONS {x} {y} {z}")
}

fn points(array: &DataArray, file: &mut impl Write) -> io::Result<()> {
    writeln!(file, "POINTS {} {}", array.tuples(), type_name(array))?;
    values(array, file)
}

fn list(name: &str, cells: &CellArray, wide: bool, file: &mut impl Write) -> io::Result<()> {
    if wide {
        writeln!(file, "{name} {} {}\nOFFSETS vtktypeint64", cells.offsets.len(), cells.connectivity.len())?;
        numbers(&cells.offsets, |number| number, file)?;
        writeln!(file, "\nCONNECTIVITY vtktypeint64")?;
        numbers(&cells.connectivity, |number| number, file)?;
        return writeln!(file);
    }
    let size = cells.len() + cells.connectivity.len();
    writeln!(file, "{name} {} {size}", cells.len())?;
    let mut flat = Vec::with_capacity(size);
    for cell in cells.iter() {
        flat.push(cell.len() as i64);
        flat.extend_from_slice(cell);
    }
    // `wide` holds where a number needs more than 32 bits.
    numbers(&flat, |number| number as i32, file)?;
    writeln!(file)
}

fn attributes(section: &str, attributes: &Attributes, count: usize, file: &mut impl Write) -> io::Result<()> {
    if attributes.arrays.is_empty() {
        return Ok(());
    }
    writeln!(file, "{section} {count}")?;
    let mut plain: Vec<&DataArray> = attributes.arrays.iter().collect();
    for (role, name) in &attributes.active {
        let Some(place) = plain.iter().position(|array| array.name == *name) else { continue };
        if let Some(keyword) = role_keyword(*role, plain[place]) {
            let array = plain.remove(place);
            writeln!(file, "{keyword}")?;
            values(array, file)?;
        }
    }
    if plain.is_empty() { Ok(()) } else { field(&plain, file) }
}

/// The line that announces an array in a role; `None` if the format has no such line for it.
fn role_keyword(role: Role, array: &DataArray) -> Option<String> {
    let (name, type_name, components) = (encoded(array.name.as_bytes()), type_name(array), array.components);
    if name.is_empty() || matches!(array.data, ArrayData::String(_)) {
        return None;
    }
    let line = |keyword: &str, wanted: usize| (components == wanted).then(|| format!("{keyword} {name} {type_name}"));
    match role {
        Role::Scalars if components <= 4 => Some(format!("SCALARS {name} {type_name} {components}\nLOOKUP_TABLE default")),
        Role::TCoords if components <= 3 => Some(format!("TEXTURE_COORDINATES {name} {components} {type_name}")),
        Role::Vectors => line("VECTORS", 3),
        Role::Normals => line("NORMALS", 3),
        Role::Tensors => line("TENSORS", 9),
        Role::GlobalIds => line("GLOBAL_IDS", 1),
        Role::PedigreeIds => line("PEDIGREE_IDS", 1),
        _ => None,
    }
}

fn field(arrays: &[&DataArray], file: &mut impl Write) -> io::Result<()> {
    writeln!(file, "FIELD FieldData {}", arrays.len())?;
    for array in arrays {
        let name = field_name(&array.name);
        writeln!(file, "{name} {} {} {}", array.components, array.tuples(), type_name(array))?;
        values(array, file)?;
    }
    Ok(())
}

/// A name within `FIELD`, where some words are not names; their first character is written as its number.
fn field_name(name: &str) -> String {
    let word = encoded(name.as_bytes());
    let is_taken = ["METADATA", "NULL_ARRAY"].iter().any(|taken| word.eq_ignore_ascii_case(taken));
    if is_taken { format!("%{:02X}{}", word.as_bytes()[0], &word[1..]) } else { word }
}

/// VTK's names. Indices that need more than the 32 bits that the format gives them are written as other integers.
fn type_name(array: &DataArray) -> &'static str {
    match &array.data {
        ArrayData::I64(_) if is_narrow_id(array) => "vtkIdType",
        ArrayData::I8(_) => "signed_char",
        ArrayData::U8(_) => "unsigned_char",
        ArrayData::I16(_) => "short",
        ArrayData::U16(_) => "unsigned_short",
        ArrayData::I32(_) => "int",
        ArrayData::U32(_) => "unsigned_int",
        ArrayData::I64(_) => "vtktypeint64",
        ArrayData::U64(_) => "vtktypeuint64",
        ArrayData::F32(_) => "float",
        ArrayData::F64(_) => "double",
        ArrayData::Bit(_) => "bit",
        ArrayData::String(_) => "string",
    }
}

fn is_narrow_id(array: &DataArray) -> bool {
    match &array.data {
        ArrayData::I64(values) => array.id_type && values.iter().all(|&value| i32::try_from(value).is_ok()),
        _ => false,
    }
}

fn values(array: &DataArray, file: &mut impl Write) -> io::Result<()> {
    match &array.data {
        ArrayData::I64(values) if is_narrow_id(array) => numbers(values, |value| value as i32, file)?,
        ArrayData::I8(values) => numbers(values, |value| value, file)?,
        ArrayData::U8(values) => file.write_all(values)?,
        ArrayData::I16(values) => numbers(values, |value| value, file)?,
        ArrayData::U16(values) => numbers(values, |value| value, file)?,
        ArrayData::I32(values) => numbers(values, |value| value, file)?,
        ArrayData::U32(values) => numbers(values, |value| value, file)?,
        ArrayData::I64(values) => numbers(values, |value| value, file)?,
        ArrayData::U64(values) => numbers(values, |value| value, file)?,
        ArrayData::F32(values) => numbers(values, |value| value, file)?,
        ArrayData::F64(values) => numbers(values, |value| value, file)?,
        ArrayData::Bit(bits) => file.write_all(&pack_bits(bits))?,
        ArrayData::String(texts) => {
            for text in texts {
                text_length(text.len() as u64, file)?;
                file.write_all(text)?;
            }
        }
    }
    writeln!(file)?;
    metadata(array, file)
}

/// A length with its width, 1, 2, 4 or 8 bytes, in the two highest bits (3, 2, 1, 0).
fn text_length(length: u64, file: &mut impl Write) -> io::Result<()> {
    let (mark, bytes) = match length {
        0..0x40 => (3u64, 1),
        0x40..0x4000 => (2, 2),
        0x4000..0x4000_0000 => (1, 4),
        _ => (0, 8),
    };
    let marked = length | mark << (8 * bytes - 2);
    file.write_all(&marked.to_be_bytes()[8 - bytes..])
}

fn metadata(array: &DataArray, file: &mut impl Write) -> io::Result<()> {
    let named = array.component_names.len() == array.components && array.component_names.iter().all(|name| !name.is_empty());
    if !named && array.information.is_empty() {
        return Ok(());
    }
    writeln!(file, "METADATA")?;
    if named {
        writeln!(file, "COMPONENT_NAMES")?;
        for name in &array.component_names {
            writeln!(file, "{}", encoded(name.as_bytes()))?;
        }
    }
    writeln!(file, "INFORMATION {}", array.information.len())?;
    for key in &array.information {
        writeln!(file, "NAME {} LOCATION {}", encoded(key.name.as_bytes()), encoded(key.location.as_bytes()))?;
        match &key.value {
            InformationValue::Single(value) => writeln!(file, "DATA {}", encoded(value.as_bytes()))?,
            InformationValue::List(values) => {
                let words: Vec<String> = values.iter().map(|value| encoded(value.as_bytes())).collect();
                writeln!(file, "DATA {} {}", values.len(), words.join(" "))?;
            }
        }
    }
    writeln!(file)
}

/// Big-endian numbers, through a buffer that stays in the cache.
fn numbers<T: Copy, N: Element>(values: &[T], convert: impl Fn(T) -> N, file: &mut impl Write) -> io::Result<()> {
    let mut buffer = Vec::with_capacity(1 << 15);
    for chunk in values.chunks((1 << 15) / N::WIDTH) {
        buffer.clear();
        for &value in chunk {
            convert(value).push_bytes(ByteOrder::Big, &mut buffer);
        }
        file.write_all(&buffer)?;
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    #[test]
    fn both_versions_read_back_alike() {
        let mut lines = CellArray::default();
        lines.push([0, 1]);
        lines.push([1, 2, 3]);
        let mut dataset = DataSet::new(Geometry::PolyData {
            points: DataArray::new("Points", 3, ArrayData::F32((0..12u8).map(f32::from).collect())),
            verts: CellArray::default(),
            lines,
            polys: CellArray::default(),
            strips: CellArray::default(),
        });
        dataset.title = "long".into();
        dataset.set_point_array(DataArray::new("h", 1, ArrayData::F64(vec![1.0, -0.0, 5e-324, 1e308])));
        for wide in [false, true] {
            let mut bytes = Vec::new();
            write_version(&dataset, wide, &mut bytes).unwrap();
            assert!(bytes.starts_with(if wide { b"# vtk DataFile Version 5.1" } else { b"# vtk DataFile Version 4.2" }));
            assert_eq!(super::super::read(&bytes).unwrap(), dataset);
        }
    }
}
