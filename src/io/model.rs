//! The data sets of the crate `vtkio`, both ways: for Rust programs that hold one.
//!
//! Files are not read through it: see the README. What its model has no room for is told, never dropped in silence.

use vtkio::model::{
    Attribute, Attributes as TheirAttributes, ByteOrder, CellType, Cells, Coordinates, DataArray as TheirArray, DataSet as Theirs, ElementType,
    Extent as TheirExtent, FieldArray, IOBuffer, ImageDataPiece, Piece, PolyDataPiece, RectilinearGridPiece, StructuredGridPiece,
    UnstructuredGridPiece, Version, VertexNumbers, Vtk,
};

use super::array::{ArrayData, DataArray};
use super::bytes::{pack_bits, unpack_bits};
use super::dataset::{Attributes, CellArray, DataSet, Extent, Geometry, Role};
use super::error::Fault;
use super::write::{Objection, check};
use super::xml::merge;

/// Why a data set has no counterpart in the other model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("found {found}; expected {expected}")]
pub struct VtkioError {
    /// What the data set has.
    pub found: String,
    /// What the other model can hold.
    pub expected: String,
}

impl From<Objection> for VtkioError {
    fn from((found, expected): Objection) -> Self {
        Self { found, expected }
    }
}

impl From<Fault> for VtkioError {
    fn from(fault: Fault) -> Self {
        Self { found: fault.found, expected: fault.expected }
    }
}

fn error<T>(found: impl Into<String>, expected: impl Into<String>) -> Result<T, VtkioError> {
    Err(VtkioError { found: found.into(), expected: expected.into() })
}

/// A data set as `vtkio` holds it.
///
/// # Returns
/// The data set, and in words what its model has no room for: field data, texts, names of components, rotated axes, and digits of an
/// image's origin and spacing, which it keeps in single precision.
///
/// # Errors
/// [`VtkioError`] for polyhedra, unknown cell types, and data sets that contradict themselves.
///
/// # Cost
/// A copy of every array.
///
/// # Example
/// ```
/// use morsmooth::io::{ArrayData, DataArray, DataSet, Extent, Geometry, from_vtkio, to_vtkio};
/// let direction = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
/// let extent = Extent([0, 2, 0, 1, 0, 0]);
/// let mut dataset = DataSet::new(Geometry::ImageData { extent, origin: [0.0; 3], spacing: [0.5; 3], direction });
/// dataset.set_point_array(DataArray::new("h", 1, ArrayData::F64((0..6).map(f64::from).collect())));
/// let (vtk, lost) = to_vtkio(&dataset)?;
/// assert!(lost.is_empty());
/// assert_eq!(from_vtkio(&vtk)?, dataset);
/// # Ok::<(), morsmooth::io::VtkioError>(())
/// ```
pub fn to_vtkio(dataset: &DataSet) -> Result<(Vtk, Vec<String>), VtkioError> {
    check(dataset)?;
    let mut lost = Vec::new();
    let data = TheirAttributes {
        point: their_attributes(&dataset.point_data, "point", &mut lost)?,
        cell: their_attributes(&dataset.cell_data, "cell", &mut lost)?,
    };
    lost.extend(dataset.field_data.iter().map(|array| format!("field array \"{}\"", array.name.escape_debug())));
    let data = match &dataset.geometry {
        Geometry::ImageData { extent, origin, spacing, direction } => {
            let single = |numbers: &[f64; 3]| numbers.map(|number| number as f32);
            if [origin, spacing].iter().any(|numbers| single(numbers).map(f64::from) != **numbers) {
                lost.push("digits of origin and spacing beyond single precision".to_owned());
            }
            if *direction != [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0] {
                lost.push("rotated axes".to_owned());
            }
            let extent = their_extent(extent);
            let pieces = vec![Piece::Inline(Box::new(ImageDataPiece { extent: extent.clone(), data }))];
            Theirs::ImageData { extent, origin: single(origin), spacing: single(spacing), meta: None, pieces }
        }
        Geometry::RectilinearGrid { extent, coordinates } => {
            let [x, y, z] = &**coordinates;
            let coords = Coordinates { x: their_numbers(x)?, y: their_numbers(y)?, z: their_numbers(z)? };
            RectilinearGridPiece { extent: their_extent(extent), coords, data }.into()
        }
        Geometry::StructuredGrid { extent, points } => {
            StructuredGridPiece { extent: their_extent(extent), points: their_numbers(points)?, data }.into()
        }
        Geometry::PolyData { points, verts, lines, polys, strips } => {
            let list = |cells: &CellArray| (!cells.is_empty()).then(|| their_cells(cells));
            let (verts, lines, polys, strips) = (list(verts), list(lines), list(polys), list(strips));
            PolyDataPiece { points: their_numbers(points)?, verts, lines, polys, strips, data }.into()
        }
        Geometry::UnstructuredGrid { points, cells, types, polyhedra } => {
            if polyhedra.is_some() {
                return error("polyhedra", "cells that their points describe");
            }
            let types = types.iter().map(|&number| match cell_type(number) {
                Some(known) => Ok(known),
                None => error(format!("cells of type {number}"), "types that vtkio knows"),
            });
            let cells = Cells { cell_verts: their_cells(cells), types: types.collect::<Result<_, _>>()? };
            UnstructuredGridPiece { points: their_numbers(points)?, cells, data }.into()
        }
    };
    let byte_order = ByteOrder::BigEndian;
    Ok((Vtk { version: Version::Auto, title: dataset.title.clone(), byte_order, data, file_path: None }, lost))
}

/// A data set that `vtkio` holds. Its pieces are joined; an array of fields becomes arrays.
///
/// # Errors
/// [`VtkioError`] for pieces that are still in other files (`vtkio` loads them on request), for a bare field, and for data sets that contradict themselves.
///
/// # Cost
/// A copy of every array.
pub fn from_vtkio(vtk: &Vtk) -> Result<DataSet, VtkioError> {
    let mut whole = of_theirs(&vtk.data)?;
    whole.title.clone_from(&vtk.title);
    check(&whole)?;
    Ok(whole)
}

fn of_theirs(data: &Theirs) -> Result<DataSet, VtkioError> {
    match data {
        Theirs::ImageData { origin, spacing, pieces, .. } => joined(pieces, &|piece: &ImageDataPiece| {
            let geometry = Geometry::ImageData {
                extent: extent(&piece.extent)?,
                origin: origin.map(f64::from),
                spacing: spacing.map(f64::from),
                direction: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            };
            with_attributes(geometry, &piece.data)
        }),
        Theirs::RectilinearGrid { pieces, .. } => joined(pieces, &|piece: &RectilinearGridPiece| {
            let axis = |name: &str, buffer: &IOBuffer| DataArray::new(name, 1, numbers(buffer, None));
            let coordinates = Box::new([axis("x", &piece.coords.x), axis("y", &piece.coords.y), axis("z", &piece.coords.z)]);
            with_attributes(Geometry::RectilinearGrid { extent: extent(&piece.extent)?, coordinates }, &piece.data)
        }),
        Theirs::StructuredGrid { pieces, .. } => joined(pieces, &|piece: &StructuredGridPiece| {
            with_attributes(Geometry::StructuredGrid { extent: extent(&piece.extent)?, points: points(&piece.points) }, &piece.data)
        }),
        Theirs::PolyData { pieces, .. } => joined(pieces, &|piece: &PolyDataPiece| {
            let list = |cells: &Option<VertexNumbers>| cells.as_ref().map_or_else(|| Ok(CellArray::default()), cell_array);
            let geometry = Geometry::PolyData {
                points: points(&piece.points),
                verts: list(&piece.verts)?,
                lines: list(&piece.lines)?,
                polys: list(&piece.polys)?,
                strips: list(&piece.strips)?,
            };
            with_attributes(geometry, &piece.data)
        }),
        Theirs::UnstructuredGrid { pieces, .. } => joined(pieces, &|piece: &UnstructuredGridPiece| {
            let types: Vec<u8> = piece.cells.types.iter().map(|&known| known as u8).collect();
            if types.contains(&(CellType::Polyhedron as u8)) {
                return error("polyhedra, whose faces vtkio does not keep", "cells that their points describe");
            }
            let cells = cell_array(&piece.cells.cell_verts)?;
            with_attributes(Geometry::UnstructuredGrid { points: points(&piece.points), cells, types, polyhedra: None }, &piece.data)
        }),
        Theirs::Field { name, .. } => error(format!("the bare field {name:?}"), "a data set with points"),
    }
}

fn joined<P>(pieces: &[Piece<P>], own: &dyn Fn(&P) -> Result<DataSet, VtkioError>) -> Result<DataSet, VtkioError> {
    let one = |piece: &Piece<P>| match piece {
        Piece::Inline(piece) => own(piece),
        Piece::Loaded(data) => of_theirs(data),
        Piece::Source(file, _) => error(format!("a piece in the file {file:?}"), "loaded pieces: call load_all_pieces first"),
    };
    let parts = pieces.iter().map(one).collect::<Result<Vec<DataSet>, _>>()?;
    // Before they are joined, each must be sound.
    for part in &parts {
        check(part)?;
    }
    match parts.is_empty() {
        true => error("no piece", "at least one"),
        false => Ok(merge(parts)?),
    }
}

fn their_attributes(attributes: &Attributes, kind: &str, lost: &mut Vec<String>) -> Result<Vec<Attribute>, VtkioError> {
    let mut found = Vec::new();
    for array in &attributes.arrays {
        let name = array.name.escape_debug();
        if matches!(array.data, ArrayData::String(_)) {
            lost.push(format!("{kind} array \"{name}\" of texts"));
            continue;
        }
        if !array.component_names.is_empty() {
            lost.push(format!("names of the components of {kind} array \"{name}\""));
        }
        if !array.information.is_empty() {
            lost.push(format!("information keys of {kind} array \"{name}\""));
        }
        let Ok(components) = u32::try_from(array.components) else {
            return error(format!("{} components in {kind} array \"{name}\"", array.components), "fewer than 2^32");
        };
        let role = attributes.active.iter().find(|entry| entry.1 == array.name).map(|entry| entry.0);
        let elem = match (role, components) {
            (Some(Role::Scalars), num_comp) => ElementType::Scalars { num_comp, lookup_table: None },
            (Some(Role::Vectors), 3) => ElementType::Vectors,
            (Some(Role::Normals), 3) => ElementType::Normals,
            (Some(Role::Tensors), 9) => ElementType::Tensors,
            (Some(Role::TCoords), number) => ElementType::TCoords(number),
            (_, number) => ElementType::Generic(number),
        };
        found.push(Attribute::DataArray(TheirArray { name: array.name.clone(), elem, data: their_numbers(array)? }));
    }
    Ok(found)
}

fn with_attributes(geometry: Geometry, data: &TheirAttributes) -> Result<DataSet, VtkioError> {
    let mut dataset = DataSet::new(geometry);
    let (points, cells) = (dataset.point_count(), dataset.cell_count());
    for (attributes, count, own) in [(&data.point, points, &mut dataset.point_data), (&data.cell, cells, &mut dataset.cell_data)] {
        for attribute in attributes {
            match attribute {
                Attribute::Field { data_array, .. } => data_array.iter().for_each(|array| own.set(field_array(array, count))),
                Attribute::DataArray(array) => {
                    let role = match array.elem {
                        ElementType::Scalars { .. } => Some(Role::Scalars),
                        ElementType::Vectors => Some(Role::Vectors),
                        ElementType::Normals => Some(Role::Normals),
                        ElementType::TCoords(_) => Some(Role::TCoords),
                        ElementType::Tensors => Some(Role::Tensors),
                        ElementType::ColorScalars(_) | ElementType::LookupTable | ElementType::Generic(_) => None,
                    };
                    if let ElementType::LookupTable = array.elem {
                        // As long as it is, not as the points are.
                        dataset.field_data.push(DataArray::new(array.name.clone(), 4, numbers(&array.data, None)));
                        continue;
                    }
                    let components = array.elem.num_comp() as usize;
                    own.set(DataArray::new(array.name.clone(), components, numbers(&array.data, count.checked_mul(components))));
                    own.active.extend(role.filter(|&role| own.active(role).is_none()).map(|role| (role, array.name.clone())));
                }
            }
        }
    }
    Ok(dataset)
}

fn field_array(array: &FieldArray, count: usize) -> DataArray {
    let components = array.elem as usize;
    DataArray::new(array.name.clone(), components, numbers(&array.data, count.checked_mul(components)))
}

fn points(buffer: &IOBuffer) -> DataArray {
    DataArray::new("Points", 3, numbers(buffer, None))
}

/// The numbers; of bits as many as `count` says, or else all that their bytes hold.
fn numbers(buffer: &IOBuffer, count: Option<usize>) -> ArrayData {
    match buffer {
        IOBuffer::Bit(bytes) => ArrayData::Bit(unpack_bits(bytes, count.unwrap_or(8 * bytes.len()))),
        IOBuffer::U8(values) => ArrayData::U8(values.clone()),
        IOBuffer::I8(values) => ArrayData::I8(values.clone()),
        IOBuffer::U16(values) => ArrayData::U16(values.clone()),
        IOBuffer::I16(values) => ArrayData::I16(values.clone()),
        IOBuffer::U32(values) => ArrayData::U32(values.clone()),
        IOBuffer::I32(values) => ArrayData::I32(values.clone()),
        IOBuffer::U64(values) => ArrayData::U64(values.clone()),
        IOBuffer::I64(values) => ArrayData::I64(values.clone()),
        IOBuffer::F32(values) => ArrayData::F32(values.clone()),
        IOBuffer::F64(values) => ArrayData::F64(values.clone()),
    }
}

fn their_numbers(array: &DataArray) -> Result<IOBuffer, VtkioError> {
    Ok(match &array.data {
        ArrayData::I8(values) => IOBuffer::I8(values.clone()),
        ArrayData::U8(values) => IOBuffer::U8(values.clone()),
        ArrayData::I16(values) => IOBuffer::I16(values.clone()),
        ArrayData::U16(values) => IOBuffer::U16(values.clone()),
        ArrayData::I32(values) => IOBuffer::I32(values.clone()),
        ArrayData::U32(values) => IOBuffer::U32(values.clone()),
        ArrayData::I64(values) => IOBuffer::I64(values.clone()),
        ArrayData::U64(values) => IOBuffer::U64(values.clone()),
        ArrayData::F32(values) => IOBuffer::F32(values.clone()),
        ArrayData::F64(values) => IOBuffer::F64(values.clone()),
        ArrayData::Bit(values) => IOBuffer::Bit(pack_bits(values)),
        ArrayData::String(_) => return error(format!("texts in array \"{}\"", array.name.escape_debug()), "numbers"),
    })
}

fn their_extent(extent: &Extent) -> TheirExtent {
    let [a, b, c, d, e, f] = extent.0;
    TheirExtent::Ranges([a..=b, c..=d, e..=f])
}

fn extent(extent: &TheirExtent) -> Result<Extent, VtkioError> {
    match extent {
        TheirExtent::Dims(counts) => match counts.map(i32::try_from) {
            [Ok(x), Ok(y), Ok(z)] => Ok(Extent::of_dimensions([x, y, z])),
            _ => error(format!("dimensions {counts:?}"), "fewer than 2^31 points an axis"),
        },
        TheirExtent::Ranges([x, y, z]) => Ok(Extent([*x.start(), *x.end(), *y.start(), *y.end(), *z.start(), *z.end()])),
    }
}

fn their_cells(cells: &CellArray) -> VertexNumbers {
    // Checked before: no number is negative.
    let unsigned = |numbers: &[i64]| numbers.iter().map(|&number| number as u64).collect();
    VertexNumbers::XML { connectivity: unsigned(&cells.connectivity), offsets: unsigned(&cells.offsets[1..]) }
}

fn cell_array(cells: &VertexNumbers) -> Result<CellArray, VtkioError> {
    let mut list = CellArray::default();
    match cells {
        VertexNumbers::Legacy { num_cells, vertices } => {
            let mut rest = vertices.as_slice();
            for _ in 0..*num_cells {
                match rest.split_first().and_then(|(&count, after)| after.split_at_checked(count as usize)) {
                    Some((points, after)) => {
                        list.push(points.iter().map(|&point| i64::from(point)));
                        rest = after;
                    }
                    None => return error("a list of cells that is cut", format!("{num_cells} cells")),
                }
            }
        }
        VertexNumbers::XML { connectivity, offsets } => {
            let signed = |numbers: &[u64]| numbers.iter().map(|&number| i64::try_from(number)).collect::<Result<Vec<i64>, _>>();
            let (Ok(connectivity), Ok(ends)) = (signed(connectivity), signed(offsets)) else {
                return error("a point number of 2^63 or more", "numbers of points");
            };
            list.connectivity = connectivity;
            list.offsets.extend(ends);
        }
    }
    Ok(list)
}

fn cell_type(number: u8) -> Option<CellType> {
    use CellType::*;
    const KNOWN: [CellType; 59] = [
        Vertex, PolyVertex, Line, PolyLine, Triangle, TriangleStrip, Polygon, Pixel, Quad, Tetra, Voxel, Hexahedron, Wedge, Pyramid,
        QuadraticEdge, QuadraticTriangle, QuadraticQuad, QuadraticTetra, QuadraticHexahedron, QuadraticWedge, QuadraticPyramid,
        BiquadraticQuad, TriquadraticHexahedron, QuadraticLinearQuad, QuadraticLinearWedge, BiquadraticQuadraticWedge,
        BiquadraticQuadraticHexahedron, BiquadraticTriangle, CubicLine, ConvexPointSet, ParametricCurve, ParametricSurface,
        ParametricTriSurface, ParametricQuadSurface, ParametricTetraRegion, ParametricHexRegion, HigherOrderEdge, HigherOrderTriangle,
        HigherOrderQuad, HigherOrderPolygon, HigherOrderTetrahedron, HigherOrderWedge, HigherOrderPyramid, HigherOrderHexahedron,
        LagrangeCurve, LagrangeTriangle, LagrangeQuadrilateral, LagrangeTetrahedron, LagrangeHexahedron, LagrangeWedge, LagrangePyramid,
        BezierCurve, BezierTriangle, BezierQuadrilateral, BezierTetrahedron, BezierHexahedron, BezierWedge, BezierPyramid, Polyhedron,
    ];
    KNOWN.into_iter().find(|&known| known as u8 == number)
}
