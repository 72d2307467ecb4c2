//! The frame of a legacy file and its geometry.

use crate::io::array::{ArrayData, DataArray, ValueType};
use crate::io::cells::{check_offsets, check_points, faces_of_run, is_face_run};
use crate::io::dataset::{Attributes, CellArray, DataSet, Extent, Geometry, IndexWidth, Polyhedra};
use crate::io::error::{Fault, Place, quoted};

use super::attributes::{array, attribute, field};
use super::order::{POINTS_MOVED, has_moved_points};
use crate::io::lexer::Lexer;
use super::values::{LegacyType, integers};

/// How every legacy file begins.
pub(in crate::io) const LEGACY_MARK: &[u8] = b"# vtk DataFile";

/// VTK's number for a polyhedron, whose legacy cell is a run of faces.
const POLYHEDRON: u8 = 42;

/// What the keywords of the geometry said so far.
#[derive(Default)]
struct Parts {
    extent: Option<Extent>,
    origin: Option<[f64; 3]>,
    spacing: Option<[f64; 3]>,
    points: Option<DataArray>,
    coordinates: [Option<DataArray>; 3],
    /// `VERTICES`, `LINES`, `POLYGONS`, `TRIANGLE_STRIPS`.
    poly_cells: [CellArray; 4],
    cells: CellArray,
    types: Vec<u8>,
    field_data: Vec<DataArray>,
    point_data: Option<(usize, Attributes)>,
    cell_data: Option<(usize, Attributes)>,
}

/// Where arrays go.
#[derive(Clone, Copy, PartialEq)]
enum Section {
    Geometry,
    Points,
    Cells,
}

/// Reads a legacy file.
pub(in crate::io) fn read(bytes: &[u8]) -> Result<DataSet, Fault> {
    let mut lexer = Lexer::new(bytes);
    let version = lexer.line();
    let version = version.strip_prefix(b"# vtk DataFile Version ").unwrap_or_default().trim_ascii();
    lexer.major = version.first().map_or(1, |digit| u32::from(digit.wrapping_sub(b'0')));
    let is_late = lexer.major > 5 || (lexer.major == 5 && version != b"5.0");
    let title = String::from_utf8_lossy(lexer.line()).into_owned();
    match lexer.text("ASCII or BINARY")?.to_ascii_uppercase().as_str() {
        "ASCII" => {}
        "BINARY" => lexer.binary = true,
        other => return Err(lexer.fault(quoted(other), "ASCII or BINARY")),
    }
    let keyword = lexer.text("DATASET")?;
    if !keyword.eq_ignore_ascii_case("DATASET") {
        return Err(Fault::unsupported(lexer.place(), quoted(keyword), "DATASET"));
    }
    let kind = lexer.text("a kind of data set")?.to_ascii_uppercase();
    let is_known = ["STRUCTURED_POINTS", "STRUCTURED_GRID", "RECTILINEAR_GRID", "POLYDATA", "UNSTRUCTURED_GRID"];
    if !is_known.contains(&kind.as_str()) {
        return Err(Fault::unsupported(lexer.place(), format!("DATASET {}", quoted(&kind)), is_known.join(", ")));
    }
    let mut parts = Parts::default();
    let mut section = Section::Geometry;
    while let Some(word) = lexer.word() {
        let keyword = String::from_utf8_lossy(word).to_ascii_uppercase();
        if !parts.keyword(&mut lexer, &keyword, &mut section)? {
            return Err(lexer.fault(quoted(&keyword), "a keyword of a legacy VTK file"));
        }
    }
    let mut dataset = parts.dataset(&kind).map_err(|fault| fault.or_at(lexer.place()))?;
    dataset.title = title;
    if is_late && has_moved_points(&dataset.geometry) {
        dataset.version = Some(POINTS_MOVED);
    }
    Ok(dataset)
}

impl Parts {
    /// Reads what a keyword announces. `false`: unknown keyword.
    fn keyword(&mut self, lexer: &mut Lexer<'_>, keyword: &str, section: &mut Section) -> Result<bool, Fault> {
        match keyword {
            "POINT_DATA" => {
                // A second section of the same kind goes on with the first.
                let count = lexer.number("the number of points")?;
                self.point_data.get_or_insert_with(Default::default).0 = count;
                *section = Section::Points;
                return Ok(true);
            }
            "CELL_DATA" => {
                let count = lexer.number("the number of cells")?;
                self.cell_data.get_or_insert_with(Default::default).0 = count;
                *section = Section::Cells;
                return Ok(true);
            }
            // Of an array that holds none, so that it was not read with one.
            "METADATA" => {
                while !lexer.is_at_end() && !lexer.line().trim_ascii().is_empty() {}
                return Ok(true);
            }
            _ => {}
        }
        match (section, &mut self.point_data, &mut self.cell_data) {
            (Section::Points, Some((tuples, attributes)), _) | (Section::Cells, _, Some((tuples, attributes))) => {
                attribute(lexer, keyword, *tuples, attributes)
            }
            _ => self.geometry(lexer, keyword),
        }
    }

    fn geometry(&mut self, lexer: &mut Lexer<'_>, keyword: &str) -> Result<bool, Fault> {
        match keyword {
            "FIELD" => self.field_data.extend(field(lexer, None)?),
            "DIMENSIONS" => self.extent = Some(Extent::of_dimensions(three(lexer)?)),
            "EXTENT" => {
                let [x0, x1, y0] = three(lexer)?;
                let [y1, z0, z1] = three(lexer)?;
                self.extent = Some(Extent([x0, x1, y0, y1, z0, z1]));
            }
            "ORIGIN" => self.origin = Some(three(lexer)?),
            "SPACING" | "ASPECT_RATIO" => self.spacing = Some(three(lexer)?),
            "POINTS" => {
                let count = lexer.number("the number of points")?;
                let value_type = LegacyType::read(lexer)?;
                self.points = Some(array(lexer, "Points".into(), value_type, count, 3)?);
            }
            "X_COORDINATES" => self.coordinates[0] = Some(coordinates(lexer, "x_coordinates")?),
            "Y_COORDINATES" => self.coordinates[1] = Some(coordinates(lexer, "y_coordinates")?),
            "Z_COORDINATES" => self.coordinates[2] = Some(coordinates(lexer, "z_coordinates")?),
            "VERTICES" => self.poly_cells[0] = cells(lexer)?,
            "LINES" => self.poly_cells[1] = cells(lexer)?,
            "POLYGONS" => self.poly_cells[2] = cells(lexer)?,
            "TRIANGLE_STRIPS" => self.poly_cells[3] = cells(lexer)?,
            "CELLS" => self.cells = cells(lexer)?,
            "CELL_TYPES" => {
                let count = lexer.number("the number of cells")?;
                let numbers = integers(lexer, LegacyType::I32, count)?;
                self.types = numbers
                    .iter()
                    .map(|&number| u8::try_from(number).map_err(|_| lexer.fault(format!("cell type {number}"), "0 to 255")))
                    .collect::<Result<_, _>>()?;
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn dataset(self, kind: &str) -> Result<DataSet, Fault> {
        let missing = |what: &str| Fault::new(Place::File, format!("{kind} without {what}"), what);
        let extent = || self.extent.ok_or_else(|| missing("DIMENSIONS"));
        let no_points = DataArray::new("Points", 3, ArrayData::F32(Vec::new()));
        let points = self.points.unwrap_or(no_points);
        if points.data.value_type() == ValueType::String {
            return Err(missing("numbers as POINTS"));
        }
        let geometry = match kind {
            "STRUCTURED_POINTS" => Geometry::ImageData {
                extent: extent()?,
                origin: self.origin.unwrap_or([0.0; 3]),
                spacing: self.spacing.unwrap_or([1.0; 3]),
                direction: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            },
            "STRUCTURED_GRID" => {
                let extent = extent()?;
                expect("points", points.tuples(), extent.point_count())?;
                Geometry::StructuredGrid { extent, points }
            }
            "RECTILINEAR_GRID" => {
                let extent = extent()?;
                let [Some(x), Some(y), Some(z)] = self.coordinates else {
                    return Err(missing("X_, Y_ and Z_COORDINATES"));
                };
                for (list, length) in [&x, &y, &z].into_iter().zip(extent.dimensions()) {
                    expect("coordinates", list.tuples(), length)?;
                }
                Geometry::RectilinearGrid { extent, coordinates: Box::new([x, y, z]) }
            }
            "POLYDATA" => {
                for cells in &self.poly_cells {
                    check_points(cells, points.tuples())?;
                }
                let [verts, lines, polys, strips] = self.poly_cells;
                Geometry::PolyData { points, verts, lines, polys, strips }
            }
            _ => {
                expect("cell types", self.types.len(), self.cells.len())?;
                unstructured(points, self.cells, self.types)?
            }
        };
        let mut dataset = DataSet::new(geometry);
        dataset.field_data = self.field_data;
        if let Some((count, attributes)) = self.point_data {
            if !attributes.arrays.is_empty() {
                expect("tuples in POINT_DATA", count, dataset.point_count())?;
            }
            dataset.point_data = attributes;
        }
        if let Some((count, attributes)) = self.cell_data {
            if !attributes.arrays.is_empty() {
                expect("tuples in CELL_DATA", count, dataset.cell_count())?;
            }
            dataset.cell_data = attributes;
        }
        Ok(dataset)
    }
}

fn expect(what: &str, found: usize, expected: usize) -> Result<(), Fault> {
    if found == expected {
        return Ok(());
    }
    Err(Fault::new(Place::File, format!("{found} {what}"), format!("{expected}")))
}

fn three<T: std::str::FromStr>(lexer: &mut Lexer<'_>) -> Result<[T; 3], Fault> {
    Ok([lexer.number("three numbers")?, lexer.number("three numbers")?, lexer.number("three numbers")?])
}

fn coordinates(lexer: &mut Lexer<'_>, name: &str) -> Result<DataArray, Fault> {
    let count = lexer.number("the number of coordinates")?;
    let value_type = LegacyType::read(lexer)?;
    if value_type == LegacyType::String {
        return Err(lexer.fault("texts as coordinates", "numbers"));
    }
    array(lexer, name.into(), value_type, count, 1)
}

/// A list of cells: `count, points ...` each, or from version 5 offsets and connectivity.
fn cells(lexer: &mut Lexer<'_>) -> Result<CellArray, Fault> {
    let first: usize = lexer.number("the number of cells")?;
    let second: usize = lexer.number("the size of the list of cells")?;
    if lexer.major >= 5 {
        return cells_of_offsets(lexer, first, second);
    }
    let place = lexer.place();
    let list = integers(lexer, LegacyType::I32, second)?;
    let mut cells = CellArray { offsets: Vec::with_capacity(list.len() + 1), ..CellArray::default() };
    cells.offsets.push(0);
    cells.connectivity.reserve(list.len());
    let mut rest = &list[..];
    while let Some((&length, tail)) = rest.split_first() {
        let split = usize::try_from(length).ok().and_then(|length| tail.split_at_checked(length));
        let Some((points, tail)) = split else {
            let found = format!("cell {} of {length} points", cells.len());
            return Err(Fault::new(place, found, format!("at most the {} that follow", tail.len())));
        };
        cells.push(points.iter().copied());
        rest = tail;
    }
    if cells.len() != first {
        return Err(Fault::new(place, format!("{} cells in a list of {second} numbers", cells.len()), format!("{first}")));
    }
    Ok(cells)
}

fn cells_of_offsets(lexer: &mut Lexer<'_>, offsets: usize, connectivity: usize) -> Result<CellArray, Fault> {
    let mut part = |keyword: &str, count: usize| {
        if !lexer.accepts(keyword) {
            if count == 0 {
                return Ok((Vec::new(), LegacyType::I64));
            }
            return Err(lexer.fault("cells without it", keyword));
        }
        let value_type = LegacyType::read(lexer)?;
        Ok((integers(lexer, value_type, count)?, value_type))
    };
    let (mut offsets, value_type) = part("OFFSETS", offsets)?;
    let (connectivity, _) = part("CONNECTIVITY", connectivity)?;
    if offsets.is_empty() {
        offsets.push(0);
    }
    check_offsets(&offsets, Some(connectivity.len())).map_err(|fault| fault.or_at(lexer.place()))?;
    let width = if value_type == LegacyType::I32 { IndexWidth::Bits32 } else { IndexWidth::Bits64 };
    Ok(CellArray { offsets, connectivity, width })
}

/// Takes the runs of faces out of the cells, which in memory list each point once.
fn unstructured(points: DataArray, cells: CellArray, types: Vec<u8>) -> Result<Geometry, Fault> {
    if !types.contains(&POLYHEDRON) {
        check_points(&cells, points.tuples())?;
        return Ok(Geometry::UnstructuredGrid { points, cells, types, polyhedra: None });
    }
    let width = cells.width;
    let mut plain = CellArray { width, ..CellArray::default() };
    let mut faces = CellArray { width, ..CellArray::default() };
    let mut polyhedra = CellArray { width, ..CellArray::default() };
    for (number, (cell, &cell_type)) in cells.iter().zip(&types).enumerate() {
        if cell_type != POLYHEDRON {
            plain.push(cell.iter().copied());
            polyhedra.push([]);
            continue;
        }
        if !is_face_run(cell, points.tuples()) {
            return Err(Fault::new(Place::File, format!("broken faces of polyhedron {number}"), "counts and point numbers"));
        }
        let first = faces.len() as i64;
        let mut corners = Vec::new();
        for face in faces_of_run(cell) {
            faces.push(face.iter().copied());
            corners.extend_from_slice(face);
        }
        // By number, as VTK lists them.
        corners.sort_unstable();
        corners.dedup();
        plain.push(corners);
        polyhedra.push(first..faces.len() as i64);
    }
    check_points(&plain, points.tuples())?;
    Ok(Geometry::UnstructuredGrid { points, cells: plain, types, polyhedra: Some(Polyhedra::Lists { faces, cells: polyhedra }) })
}
