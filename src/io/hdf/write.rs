//! Writes VTKHDF files that VTK 9.7 reads: one part, no steps.

use std::collections::BTreeSet;
use std::io::{self, Write};

use hdf5_pure::{AttrValue, CharacterSet, DatasetBuilder, Datatype, FileBuilder, GroupBuilder, H5Element, StringPadding, make_u8_type};

use crate::io::array::{ArrayData, DataArray};
use crate::io::dataset::{Attributes, CellArray, DataSet, Extent, Geometry};
use crate::io::error::quoted;
use crate::io::write::{Compression, Objection};

use super::arrays::{COMPONENT_NAMES, KIND_BIT, KIND_ID, NUMBER_KIND, ROLE};
use super::lists::KINDS;

/// The version that has all that is written here.
const VERSION: [i64; 2] = [2, 7];
/// Values in a packed chunk, about.
const CHUNK: u64 = 1 << 15;
/// As packed as zlib gets without taking its time.
const LEVEL: u32 = 1;

/// The name of an array in the file: HDF5 parts groups by `/`, and VTK takes no `.` either.
fn link(name: &str) -> String {
    name.replace(['/', '.'], "_")
}

/// The arrays of a data set, group by group.
fn groups(dataset: &DataSet) -> [(&'static str, &[DataArray]); 3] {
    [
        ("point", &dataset.point_data.arrays),
        ("cell", &dataset.cell_data.arrays),
        ("field", &dataset.field_data),
    ]
}

/// VTK 9.7 reads no array behind one of texts on points or cells, nor what comes after these: such arrays are left out.
fn is_written(kind: &str, array: &DataArray) -> bool {
    kind == "field" || !matches!(array.data, ArrayData::String(_))
}

/// Refuses names that HDF5 cannot tell apart.
pub(in crate::io) fn check(dataset: &DataSet) -> Result<(), Objection> {
    for (kind, arrays) in groups(dataset) {
        let mut links = BTreeSet::new();
        for array in arrays {
            let link = link(&array.name);
            if link.is_empty() || link.contains('\0') {
                return Err((format!("a {kind} array called {}", quoted(&array.name)), "a name without zero bytes".into()));
            }
            if !links.insert(link) {
                return Err((format!("a second {kind} array {}", quoted(&array.name)), "names that differ in more than \"/\", \".\" and \"_\"".into()));
            }
        }
    }
    Ok(())
}

/// What of a data set has no room in the file, in words.
pub(in crate::io) fn losses(dataset: &DataSet) -> Vec<String> {
    let mut lost = Vec::new();
    for (kind, arrays) in groups(dataset) {
        for array in arrays {
            let name = quoted(&array.name);
            if !is_written(kind, array) {
                lost.push(format!("the texts of {kind} array {name}"));
                continue;
            }
            if link(&array.name) != array.name {
                lost.push(format!("the name {name} of a {kind} array (it becomes {})", quoted(&link(&array.name))));
            }
            if matches!(&array.data, ArrayData::String(texts) if texts.iter().any(|text| std::str::from_utf8(text).is_err())) {
                lost.push(format!("bytes that are no UTF-8 in the texts of {kind} array {name}"));
            }
            if array.information.iter().any(|key| !key.name.ends_with("_RANGE")) {
                lost.push(format!("the information keys of {kind} array {name}"));
            }
        }
    }
    if let Geometry::RectilinearGrid { extent, .. } | Geometry::StructuredGrid { extent, .. } = &dataset.geometry
        && extent.0.iter().step_by(2).any(|&first| first != 0)
    {
        lost.push("the first index of the extent".to_owned());
    }
    lost
}

/// Writes a data set that passed the checks.
pub(in crate::io) fn write(dataset: &DataSet, compression: Compression, out: &mut impl Write) -> io::Result<()> {
    let mut builder = FileBuilder::new();
    let mut root = Group { builder: builder.create_group("VTKHDF"), compression };
    root.builder.set_attr("Version", AttrValue::I64Array(VERSION.to_vec()));
    root.builder.set_attr("Type", AttrValue::AsciiString(dataset.geometry.name().to_owned()));
    let dimensions = |extent: &Extent| extent.dimensions().map(|count| count as u64);
    let (mut point_shape, mut cell_shape) = (vec![dataset.point_count() as u64], vec![dataset.cell_count() as u64]);
    if let Geometry::ImageData { extent, .. } | Geometry::RectilinearGrid { extent, .. } | Geometry::StructuredGrid { extent, .. } = &dataset.geometry {
        point_shape = grid_shape(dimensions(extent), extent);
        cell_shape = grid_shape(extent.cell_dimensions().map(|count| count as u64), extent);
    }
    root.geometry(&dataset.geometry);
    root.attributes("PointData", &dataset.point_data, &point_shape);
    root.attributes("CellData", &dataset.cell_data, &cell_shape);
    let mut fields = root.child("FieldData");
    for array in &dataset.field_data {
        fields.array(array, &[array.tuples() as u64], None);
    }
    root.builder.add_group(fields.builder.finish());
    builder.add_group(root.builder.finish());
    builder.finish_to(out).map_err(|error| match error {
        hdf5_pure::Error::Io(error) => error,
        other => io::Error::other(other.to_string()),
    })
}

/// The axes of the arrays of a grid, the slowest first; VTK leaves out flat ones.
fn grid_shape(counts: [u64; 3], extent: &Extent) -> Vec<u64> {
    let points = extent.dimensions();
    let mut shape: Vec<u64> = (0..3).rev().filter(|&axis| points[axis] != 1).map(|axis| counts[axis]).collect();
    if shape.is_empty() {
        shape.push(1);
    }
    shape
}

/// A group in the making.
struct Group {
    builder: GroupBuilder,
    compression: Compression,
}

impl Group {
    fn child(&mut self, name: &str) -> Self {
        Self { builder: self.builder.create_group(name), compression: self.compression }
    }

    fn geometry(&mut self, geometry: &Geometry) {
        match geometry {
            Geometry::ImageData { extent, origin, spacing, direction } => {
                self.builder.set_attr("WholeExtent", AttrValue::I32Array(extent.0.to_vec()));
                self.builder.set_attr("Origin", AttrValue::F64Array(origin.to_vec()));
                self.builder.set_attr("Spacing", AttrValue::F64Array(spacing.to_vec()));
                self.builder.set_attr("Direction", AttrValue::F64Array(direction.to_vec()));
            }
            Geometry::RectilinearGrid { extent, coordinates } => {
                self.dimensions(extent);
                for (name, array) in ["XCoordinates", "YCoordinates", "ZCoordinates"].into_iter().zip(coordinates.iter()) {
                    self.values(name, &array.data, &[array.data.len() as u64]);
                }
            }
            Geometry::StructuredGrid { extent, points } => {
                self.dimensions(extent);
                let [x, y, z] = extent.dimensions().map(|count| count as u64);
                self.values("Points", &points.data, &[z, y, x, 3]);
            }
            Geometry::PolyData { points, verts, lines, polys, strips } => {
                self.points(points);
                for (name, cells) in KINDS.into_iter().zip([verts, lines, polys, strips]) {
                    let mut group = self.child(name);
                    group.cells(cells);
                    self.builder.add_group(group.builder.finish());
                }
            }
            Geometry::UnstructuredGrid { points, cells, types, polyhedra } => {
                self.points(points);
                self.cells(cells);
                self.plain("Types", types);
                let Some(polyhedra) = polyhedra else { return };
                let (faces, cells) = polyhedra.to_lists();
                self.lists(["FaceOffsets", "FaceConnectivity"], &faces);
                self.lists(["PolyhedronOffsets", "PolyhedronToFaces"], &cells);
                self.plain("NumberOfFaces", &[faces.len() as i64]);
                self.plain("NumberOfFaceConnectivityIds", &[faces.connectivity.len() as i64]);
                self.plain("NumberOfPolyhedronToFaceIds", &[cells.connectivity.len() as i64]);
            }
        }
    }

    fn dimensions(&mut self, extent: &Extent) {
        let dimensions = [0, 1, 2].map(|axis| extent.0[2 * axis + 1].saturating_sub(extent.0[2 * axis]).saturating_add(1).max(0));
        self.builder.set_attr("Dimensions", AttrValue::I32Array(dimensions.to_vec()));
    }

    fn points(&mut self, points: &DataArray) {
        self.plain("NumberOfPoints", &[points.tuples() as i64]);
        self.values("Points", &points.data, &[points.tuples() as u64, 3]);
    }

    fn cells(&mut self, cells: &CellArray) {
        self.plain("NumberOfCells", &[cells.len() as i64]);
        self.plain("NumberOfConnectivityIds", &[cells.connectivity.len() as i64]);
        self.lists(["Offsets", "Connectivity"], cells);
    }

    /// Always 64 bits wide, which is the one width that VTK takes here.
    fn lists(&mut self, [offsets, members]: [&str; 2], lists: &CellArray) {
        self.plain(offsets, &lists.offsets);
        self.plain(members, &lists.connectivity);
    }

    fn plain<T: H5Element>(&mut self, name: &str, values: &[T]) {
        self.numbers(name, values, &[values.len() as u64]);
    }

    fn numbers<T: H5Element>(&mut self, name: &str, values: &[T], shape: &[u64]) -> &mut DatasetBuilder {
        let row: u64 = shape[1..].iter().product();
        let dataset = self.builder.create_dataset(name).with_data(values).with_shape(shape);
        if self.compression == Compression::Zlib && !values.is_empty() {
            let mut chunk = shape.to_vec();
            chunk[0] = (CHUNK / row.max(1)).clamp(1, shape[0]);
            dataset.with_chunks(&chunk).with_deflate(LEVEL);
        }
        dataset
    }

    /// Values of any type; bits as bytes.
    fn values(&mut self, name: &str, data: &ArrayData, shape: &[u64]) -> &mut DatasetBuilder {
        match data {
            ArrayData::I8(values) => self.numbers(name, values, shape),
            ArrayData::U8(values) => self.numbers(name, values, shape),
            ArrayData::I16(values) => self.numbers(name, values, shape),
            ArrayData::U16(values) => self.numbers(name, values, shape),
            ArrayData::I32(values) => self.numbers(name, values, shape),
            ArrayData::U32(values) => self.numbers(name, values, shape),
            ArrayData::I64(values) => self.numbers(name, values, shape),
            ArrayData::U64(values) => self.numbers(name, values, shape),
            ArrayData::F32(values) => self.numbers(name, values, shape),
            ArrayData::F64(values) => self.numbers(name, values, shape),
            ArrayData::Bit(bits) => self.numbers(name, &bits.iter().map(|&bit| u8::from(bit)).collect::<Vec<u8>>(), shape),
            ArrayData::String(texts) => {
                let texts: Vec<String> = texts.iter().map(|text| String::from_utf8_lossy(text).into_owned()).collect();
                let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
                // VTK takes no other character set than ASCII, and reads UTF-8 under that name.
                let ascii = Datatype::VariableLength {
                    is_string: true,
                    padding: Some(StringPadding::NullTerminate),
                    charset: Some(CharacterSet::Ascii),
                    base_type: Box::new(make_u8_type()),
                };
                self.builder.create_dataset(name).with_vlen_strings(&texts).with_dtype(ascii).with_shape(shape)
            }
        }
    }

    fn attributes(&mut self, name: &str, attributes: &Attributes, shape: &[u64]) {
        let mut group = self.child(name);
        for array in attributes.arrays.iter().filter(|array| is_written(name, array)) {
            let role = attributes.active.iter().find(|(_, active)| *active == array.name).map(|(role, _)| role.name());
            group.array(array, shape, role);
        }
        self.builder.add_group(group.builder.finish());
    }

    fn array(&mut self, array: &DataArray, shape: &[u64], role: Option<&str>) {
        let mut shape = shape.to_vec();
        if array.components > 1 {
            shape.push(array.components as u64);
        }
        let dataset = self.values(&link(&array.name), &array.data, &shape);
        if let Some(role) = role {
            dataset.set_attr(ROLE, AttrValue::AsciiString(role.to_owned()));
        }
        match array.data {
            ArrayData::Bit(_) => dataset.set_attr(NUMBER_KIND, AttrValue::AsciiString(KIND_BIT.to_owned())),
            _ if array.id_type => dataset.set_attr(NUMBER_KIND, AttrValue::AsciiString(KIND_ID.to_owned())),
            _ => dataset,
        };
        if !array.component_names.is_empty() {
            dataset.set_attr(COMPONENT_NAMES, AttrValue::StringArray(array.component_names.clone()));
        }
    }
}
