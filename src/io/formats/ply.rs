//! Stanford `.ply`, ascii and binary, through the crate `ply-rs-bw`: points, edges, polygons and the numbers on them.

use std::io::{BufWriter, Write};

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    Addable, ElementDef, Encoding, Ply, Property, PropertyAccess, PropertyAccessResult, PropertyDef, PropertyType, ScalarType,
};

use crate::io::array::{ArrayData, DataArray};
use crate::io::dataset::{CellArray, DataSet};
use crate::io::error::{Fault, Place, quoted};

use super::parts::{kind, poly_data};
use super::shapes::Shapes;

/// Properties that make one array of several components, and its name in VTK.
const GROUPS: [(&str, &[&str]); 7] = [
    ("Points", &["x", "y", "z"]),
    ("Normals", &["nx", "ny", "nz"]),
    ("TCoords", &["u", "v"]),
    ("TCoords", &["s", "t"]),
    ("TCoords", &["texture_u", "texture_v"]),
    ("RGBA", &["red", "green", "blue", "alpha"]),
    ("RGB", &["red", "green", "blue"]),
];

/// The properties of an array that makes several, if it is one of those.
pub(super) fn group(array: &DataArray) -> Option<&'static [&'static str]> {
    GROUPS[1..].iter().find(|group| group.0 == array.name && group.1.len() == array.components).map(|group| group.1)
}

/// One element of a file: its properties in the order of the head.
struct Row(Vec<Property>);

impl PropertyAccess for Row {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, _: &str, property: Property) -> PropertyAccessResult {
        self.0.push(property);
        PropertyAccessResult::Set
    }
}

/// Reads points with all their numbers, then edges and faces with theirs.
pub(super) fn read(bytes: &[u8]) -> Result<DataSet, Fault> {
    let parser = Parser::<Row>::new();
    let mut reader = Reader::new(bytes);
    let told = |error: ply_rs_bw::parser::ParseError| {
        let place = error.line().map_or(Place::File, |line| Place::Line(line + 1));
        let message = error.to_string();
        Fault::new(place, message.lines().next().unwrap_or_default(), "a .ply file that follows its head")
    };
    let header = parser.read_header(&mut reader).map_err(told)?;
    let mut points = None;
    let mut point_arrays = Vec::new();
    let (mut cells, mut types, mut cell_arrays) = (CellArray::default(), Vec::new(), Vec::<DataArray>::new());
    for (_, element) in &header.elements {
        if element.count > bytes.len() || (element.properties.is_empty() && element.count > 0) {
            let found = format!("{} elements {} in {} bytes", element.count, quoted(&element.name), bytes.len());
            return Err(Fault::new(Place::File, found, "as many as there are"));
        }
        let rows = parser.read_payload_for_element(&mut reader, element, &header).map_err(told)?;
        match element.name.as_str() {
            "vertex" => {
                let mut arrays = arrays(element, &rows)?;
                let place = arrays.iter().position(|array| array.name == "Points");
                points = place.map(|place| arrays.remove(place));
                point_arrays = arrays;
            }
            "face" | "edge" => {
                let before = types.len();
                corners(element, &rows, &mut cells, &mut types)?;
                let found = arrays(element, &rows)?;
                append(&mut cell_arrays, found, before, types.len());
            }
            "tristrips" => return Err(Fault::unsupported(Place::File, "triangle strips", "faces and edges")),
            _ => {}
        }
    }
    let points = points.ok_or_else(|| Fault::new(Place::File, "no element \"vertex\" with x, y and z", "points"))?;
    super::super::cells::check_points(&cells, points.tuples())?;
    Ok(poly_data(points, &cells, &types, point_arrays, cell_arrays))
}

/// The numbers on the elements, those that belong together as one array.
fn arrays(element: &ElementDef, rows: &[Row]) -> Result<Vec<DataArray>, Fault> {
    let names: Vec<&str> = element.properties.iter().map(|(_, property)| property.name.as_str()).collect();
    let is_scalar: Vec<bool> =
        element.properties.iter().map(|(_, property)| matches!(property.data_type, PropertyType::Scalar(_))).collect();
    let mut taken = vec![false; names.len()];
    let mut arrays = Vec::new();
    let is_edge = element.name == "edge";
    for place in 0..names.len() {
        if taken[place] || !is_scalar[place] || (is_edge && ["vertex1", "vertex2"].contains(&names[place])) {
            continue;
        }
        let group = GROUPS.iter().find_map(|(name, parts)| {
            let places: Option<Vec<usize>> = parts.iter().map(|part| names.iter().position(|name| name == part)).collect();
            places.filter(|places| places.contains(&place)).map(|places| (*name, places))
        });
        let (name, places) = group.unwrap_or((names[place], vec![place]));
        for &place in &places {
            taken[place] = true;
        }
        arrays.push(DataArray::new(name, places.len(), columns(rows, &places)?));
    }
    Ok(arrays)
}

/// The values of some properties, tuple after tuple, in their own type if they share one.
fn columns(rows: &[Row], places: &[usize]) -> Result<ArrayData, Fault> {
    macro_rules! gathered {
        ($variant:ident, $array:ident) => {{
            let of = |property: &Property| if let Property::$variant(value) = property { Some(*value) } else { None };
            let values = rows.iter().flat_map(|row| places.iter().map(move |&place| of(&row.0[place])));
            if let Some(values) = values.collect::<Option<Vec<_>>>() {
                return Ok(ArrayData::$array(values));
            }
        }};
    }
    gathered!(Float, F32);
    gathered!(Double, F64);
    gathered!(UChar, U8);
    gathered!(Int, I32);
    gathered!(UInt, U32);
    gathered!(Char, I8);
    gathered!(Short, I16);
    gathered!(UShort, U16);
    let wide = |property: &Property| match property {
        Property::Float(value) => Some(f64::from(*value)),
        Property::Double(value) => Some(*value),
        other => integer(other).map(|value| value as f64),
    };
    let values = rows.iter().flat_map(|row| places.iter().map(move |&place| wide(&row.0[place])));
    values.collect::<Option<Vec<f64>>>().map(ArrayData::F64).ok_or_else(|| Fault::new(Place::File, "a list", "numbers"))
}

fn integer(property: &Property) -> Option<i64> {
    match property {
        Property::Char(value) => Some((*value).into()),
        Property::UChar(value) => Some((*value).into()),
        Property::Short(value) => Some((*value).into()),
        Property::UShort(value) => Some((*value).into()),
        Property::Int(value) => Some((*value).into()),
        Property::UInt(value) => Some((*value).into()),
        _ => None,
    }
}

fn integers(property: &Property) -> Option<Vec<i64>> {
    fn wide<T: Copy + Into<i64>>(values: &[T]) -> Option<Vec<i64>> {
        Some(values.iter().map(|&value| value.into()).collect())
    }
    match property {
        Property::ListChar(values) => wide(values),
        Property::ListUChar(values) => wide(values),
        Property::ListShort(values) => wide(values),
        Property::ListUShort(values) => wide(values),
        Property::ListInt(values) => wide(values),
        Property::ListUInt(values) => wide(values),
        _ => None,
    }
}

/// Appends the points of faces or edges.
fn corners(element: &ElementDef, rows: &[Row], cells: &mut CellArray, types: &mut Vec<u8>) -> Result<(), Fault> {
    let place = |name: &str| element.properties.iter().position(|(_, property)| property.name == name);
    let missing = |expected: &str| Fault::new(Place::File, format!("element {} without it", quoted(&element.name)), expected);
    if element.name == "edge" {
        let ends = [place("vertex1"), place("vertex2")];
        let [Some(first), Some(second)] = ends else { return Err(missing("integers vertex1 and vertex2")) };
        for row in rows {
            let (Some(a), Some(b)) = (integer(&row.0[first]), integer(&row.0[second])) else {
                return Err(missing("integers vertex1 and vertex2"));
            };
            cells.push([a, b]);
            types.push(kind::LINE);
        }
        return Ok(());
    }
    let expected = "a list of integers vertex_indices";
    let list = place("vertex_indices").or_else(|| place("vertex_index")).ok_or_else(|| missing(expected))?;
    for row in rows {
        let corners = integers(&row.0[list]).ok_or_else(|| missing(expected))?;
        types.push(match corners.len() {
            0 => return Err(Fault::new(Place::File, format!("face {} without points", types.len()), "at least one point")),
            1 => kind::VERTEX,
            2 => kind::LINE,
            3 => kind::TRIANGLE,
            4 => kind::QUAD,
            _ => kind::POLYGON,
        });
        cells.push(corners);
    }
    Ok(())
}

/// Joins the arrays of one kind of cell to those of another; what has no number is NaN.
fn append(arrays: &mut Vec<DataArray>, found: Vec<DataArray>, before: usize, after: usize) {
    if before == 0 {
        *arrays = found;
        return;
    }
    let wide = |array: &DataArray, count: usize| -> Vec<f64> {
        (0..count * array.components).map(|index| array.data.number(index).unwrap_or(f64::NAN)).collect()
    };
    let mut joined = Vec::new();
    for array in arrays.drain(..) {
        let mut values = wide(&array, before);
        match found.iter().find(|other| other.name == array.name && other.components == array.components) {
            Some(other) => values.extend(wide(other, after - before)),
            None => values.extend(std::iter::repeat_n(f64::NAN, (after - before) * array.components)),
        }
        joined.push(DataArray::new(array.name, array.components, ArrayData::F64(values)));
    }
    for array in found {
        if !joined.iter().any(|other| other.name == array.name) {
            let mut values = vec![f64::NAN; before * array.components];
            values.extend(wide(&array, after - before));
            joined.push(DataArray::new(array.name, array.components, ArrayData::F64(values)));
        }
    }
    *arrays = joined;
}

/// Writes binary little-endian: points with their arrays, then edges, then faces, each with theirs.
pub(super) fn write<W: Write>(shapes: &Shapes<'_>, dataset: &DataSet, out: &mut BufWriter<W>) -> std::io::Result<()> {
    let mut ply = Ply::<ply_rs_bw::ply::DefaultElement>::new();
    ply.header.encoding = Encoding::BinaryLittleEndian;
    let points = DataArray { name: "Points".to_owned(), ..shapes.points().clone() };
    let point_arrays: Vec<&DataArray> = std::iter::once(&points).chain(&dataset.point_data.arrays).collect();
    let every_point: Vec<usize> = (0..shapes.point_count()).collect();
    add_elements(&mut ply, "vertex", &point_arrays, &every_point, |_| Vec::new());
    let cells: Vec<(u8, &[i64])> = shapes.cells().collect();
    let cell_arrays: Vec<&DataArray> = dataset.cell_data.arrays.iter().collect();
    let of_kind = |wanted: bool| -> Vec<usize> {
        (0..cells.len()).filter(|&cell| (cells[cell].0 == kind::LINE) == wanted).collect()
    };
    let edges = of_kind(true);
    if !edges.is_empty() {
        add_elements(&mut ply, "edge", &cell_arrays, &edges, |cell| {
            let corners = cells[cell].1;
            vec![("vertex1", Property::Int(corners[0] as i32)), ("vertex2", Property::Int(corners[1] as i32))]
        });
    }
    add_elements(&mut ply, "face", &cell_arrays, &of_kind(false), |cell| {
        let corners = cells[cell].1.iter().map(|&corner| corner as i32).collect();
        vec![("vertex_indices", Property::ListInt(corners))]
    });
    ply_rs_bw::writer::Writer::new().write_ply(out, &mut ply).map(|_| ())
}

/// Adds elements: what makes them, then the arrays on them.
fn add_elements(
    ply: &mut Ply<ply_rs_bw::ply::DefaultElement>,
    name: &str,
    arrays: &[&DataArray],
    members: &[usize],
    own: impl Fn(usize) -> Vec<(&'static str, Property)>,
) {
    let mut definition = ElementDef::new(name.to_owned());
    match name {
        "edge" => {
            for end in ["vertex1", "vertex2"] {
                definition.properties.add(PropertyDef::new(end.to_owned(), PropertyType::Scalar(ScalarType::Int)));
            }
        }
        "face" => {
            let list = PropertyType::List(ScalarType::UChar, ScalarType::Int);
            definition.properties.add(PropertyDef::new("vertex_indices".to_owned(), list));
        }
        _ => {}
    }
    let mut columns: Vec<(String, &DataArray, usize)> = Vec::new();
    for array in arrays {
        if matches!(array.data, ArrayData::String(_)) {
            continue;
        }
        let parts = if array.name == "Points" && name == "vertex" { Some(GROUPS[0].1) } else { group(array) };
        match parts {
            Some(parts) => columns.extend(parts.iter().enumerate().map(|(place, part)| ((*part).to_owned(), *array, place))),
            None if array.components == 1 => columns.push((word(&array.name), array, 0)),
            None => {}
        }
    }
    for (column, array, _) in &columns {
        definition.properties.add(PropertyDef::new(column.clone(), PropertyType::Scalar(scalar_type(array))));
    }
    ply.header.elements.add(definition);
    let elements = members.iter().map(|&member| {
        let mut element = ply_rs_bw::ply::DefaultElement::new();
        for (name, property) in own(member) {
            element.insert(name.to_owned(), property);
        }
        for (column, array, place) in &columns {
            element.insert(column.clone(), property(array, member * array.components + place));
        }
        element
    });
    ply.payload.insert(name.to_owned(), elements.collect());
}

/// A name without blanks, which would end it in the head of the file.
fn word(name: &str) -> String {
    name.replace(char::is_whitespace, "_")
}

fn scalar_type(array: &DataArray) -> ScalarType {
    match array.data {
        ArrayData::I8(_) => ScalarType::Char,
        ArrayData::U8(_) | ArrayData::Bit(_) => ScalarType::UChar,
        ArrayData::I16(_) => ScalarType::Short,
        ArrayData::U16(_) => ScalarType::UShort,
        ArrayData::I32(_) => ScalarType::Int,
        ArrayData::U32(_) => ScalarType::UInt,
        ArrayData::F32(_) => ScalarType::Float,
        // The format has no wider integers.
        _ => ScalarType::Double,
    }
}

fn property(array: &DataArray, index: usize) -> Property {
    match &array.data {
        ArrayData::I8(values) => Property::Char(values[index]),
        ArrayData::U8(values) => Property::UChar(values[index]),
        ArrayData::Bit(values) => Property::UChar(values[index].into()),
        ArrayData::I16(values) => Property::Short(values[index]),
        ArrayData::U16(values) => Property::UShort(values[index]),
        ArrayData::I32(values) => Property::Int(values[index]),
        ArrayData::U32(values) => Property::UInt(values[index]),
        ArrayData::F32(values) => Property::Float(values[index]),
        other => Property::Double(other.number(index).unwrap_or(f64::NAN)),
    }
}
