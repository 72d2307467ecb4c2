//! NumPy's arrays: `.npy`, one to three axes, as image data whose x axis is the last one of the array; four axes hold tuples.
//!
//! The format is a header of three entries before the plain numbers. It is read here, because the crate for it (`npyz` 0.9) multiplies the
//! axes of a damaged header without looking at the overflow, and parses brackets to any depth.
//!
//! Source: NumPy Enhancement Proposal 1, format versions 1.0 to 3.0.

use std::io::{BufWriter, Write};

use crate::io::array::{ArrayData, DataArray};
use crate::io::bytes::{ByteOrder, Element, values_of_bytes};
use crate::io::dataset::{DataSet, Extent, Geometry, Role};
use crate::io::error::{Fault, Place, quoted};
use crate::io::write::Objection;

const MAGIC: &[u8] = b"\x93NUMPY";
/// Types of numbers that are read, for messages.
const TYPES: &str = "integers i1, i2, i4, i8, u1, u2, u4, u8, floats f4, f8, or truth values b1";
/// The format has no name for its array.
const NAME: &str = "values";

/// What stands before the numbers.
struct Header {
    kind: char,
    width: usize,
    order: ByteOrder,
    is_fortran: bool,
    shape: Vec<usize>,
    /// Where the numbers begin.
    start: usize,
}

/// Reads an array.
pub(super) fn read(bytes: &[u8]) -> Result<DataSet, Fault> {
    let header = Header::read(bytes)?;
    let (axes, components): (&[usize], usize) = match header.shape.as_slice() {
        [axes @ .., components] if axes.len() == 3 => (axes, *components),
        axes if (1..=3).contains(&axes.len()) => (axes, 1),
        axes => return Err(Fault::unsupported(Place::File, format!("an array of {} axes", axes.len()), "1 to 3, or 4 with the components last")),
    };
    let mut dimensions = [1i32; 3];
    for (dimension, &count) in dimensions.iter_mut().zip(axes.iter().rev()) {
        *dimension = i32::try_from(count).map_err(|_| Fault::new(Place::File, format!("an axis of {count} numbers"), "fewer than 2^31"))?;
    }
    let count = header.shape.iter().try_fold(1usize, |product, &axis| product.checked_mul(axis));
    let length = bytes.len() - header.start;
    let Some(count) = count.filter(|count| count.checked_mul(header.width) == Some(length)) else {
        let found = format!("{length} bytes of numbers");
        return Err(Fault::new(Place::Byte(header.start), found, format!("{} bytes for each number of an array {:?}", header.width, header.shape)));
    };
    if count == 0 || components == 0 {
        return Err(Fault::new(Place::File, format!("an array {:?}", header.shape), "at least one number"));
    }
    let data = header.values(&bytes[header.start..])?;
    let mut dataset = DataSet::new(Geometry::ImageData {
        extent: Extent::of_dimensions(dimensions),
        origin: [0.0; 3],
        spacing: [1.0; 3],
        direction: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
    });
    dataset.set_point_array(DataArray::new(NAME, components, data));
    Ok(dataset)
}

fn unknown_type(name: &str, place: usize) -> Fault {
    let what = match name.trim_start_matches(['<', '>', '=', '|']).chars().next() {
        Some('O') => "Python objects",
        Some('S' | 'a' | 'U') => "texts",
        Some('V') => "records",
        Some('c') => "complex numbers",
        Some('M' | 'm') => "dates or times",
        _ => "numbers",
    };
    Fault::unsupported(Place::Byte(place), format!("{what} of type {}", quoted(name)), TYPES)
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let fault = |found: &str, expected: &str| Fault::new(Place::File, found, expected);
        if !bytes.starts_with(MAGIC) || bytes.len() < 12 {
            return Err(fault("no header", "an array as numpy.save writes it"));
        }
        let number = |range: std::ops::Range<usize>| bytes[range].iter().rev().fold(0usize, |sum, &byte| sum << 8 | usize::from(byte));
        let (begin, length) = match bytes[6] {
            1 => (10, number(8..10)),
            2 | 3 => (12, number(8..12)),
            version => return Err(Fault::unsupported(Place::Byte(6), format!("format version {version}"), "1, 2 or 3")),
        };
        let start = begin + length;
        let text = bytes.get(begin..start).and_then(|text| std::str::from_utf8(text).ok());
        let text = text.ok_or_else(|| fault("a header that is cut, or no text", "the entries descr, fortran_order and shape"))?;
        let entry = |name: &str| {
            let after = text.split_once(&format!("'{name}':")).map(|(_, after)| after.trim_start());
            after.ok_or_else(|| Fault::new(Place::Byte(begin), format!("a header without '{name}'"), "descr, fortran_order and shape"))
        };
        let type_name = entry("descr")?.strip_prefix('\'').and_then(|rest| rest.split_once('\'')).map(|(name, _)| name);
        let Some(type_name) = type_name else {
            return Err(Fault::unsupported(Place::Byte(begin), "an array of records", "one of plain numbers"));
        };
        let mut letters = type_name.chars();
        let order = match letters.next() {
            Some('<' | '|' | '=') => ByteOrder::Little,
            Some('>') => ByteOrder::Big,
            _ => return Err(unknown_type(type_name, begin)),
        };
        let kind = letters.next().unwrap_or(' ');
        let width = letters.as_str().parse().unwrap_or(0);
        // Before the numbers are counted: what is no number has no width to count by.
        let is_known = matches!((kind, width), ('i' | 'u', 1 | 2 | 4 | 8) | ('f', 4 | 8) | ('b', 1));
        if !is_known {
            return Err(unknown_type(type_name, begin));
        }
        let is_fortran = match entry("fortran_order")? {
            text if text.starts_with("True") => true,
            text if text.starts_with("False") => false,
            _ => return Err(fault("another fortran_order", "True or False")),
        };
        let shape = entry("shape")?.strip_prefix('(').and_then(|rest| rest.split_once(')')).map(|(inside, _)| inside);
        let shape: Option<Vec<usize>> =
            shape.and_then(|shape| shape.split(',').map(str::trim).filter(|axis| !axis.is_empty()).map(|axis| axis.parse().ok()).collect());
        let shape = shape.ok_or_else(|| fault("no list of axes as shape", "numbers such as (20, 30)"))?;
        Ok(Self { kind, width, order, is_fortran, shape, start })
    }

    /// The numbers, the last axis fastest.
    fn values(&self, bytes: &[u8]) -> Result<ArrayData, Fault> {
        macro_rules! numbers {
            ($variant:ident) => {
                ArrayData::$variant(self.in_rows(values_of_bytes(bytes, self.order)))
            };
        }
        Ok(match (self.kind, self.width) {
            ('i', 1) => numbers!(I8),
            ('u', 1) => numbers!(U8),
            ('i', 2) => numbers!(I16),
            ('u', 2) => numbers!(U16),
            ('i', 4) => numbers!(I32),
            ('u', 4) => numbers!(U32),
            ('i', 8) => numbers!(I64),
            ('u', 8) => numbers!(U64),
            ('f', 4) => numbers!(F32),
            ('f', 8) => numbers!(F64),
            ('b', 1) => ArrayData::Bit(self.in_rows(bytes.iter().map(|&byte| byte != 0).collect())),
            (kind, width) => return Err(unknown_type(&format!("{kind}{width}"), self.start)),
        })
    }

    /// From the first axis fastest, as Fortran has it, to the last.
    fn in_rows<T: Copy>(&self, values: Vec<T>) -> Vec<T> {
        if !self.is_fortran || self.shape.len() < 2 {
            return values;
        }
        let mut strides = Vec::with_capacity(self.shape.len());
        let mut stride = 1;
        for &axis in &self.shape {
            strides.push(stride);
            stride *= axis;
        }
        let mut place = vec![0usize; self.shape.len()];
        let mut rows = Vec::with_capacity(values.len());
        for _ in 0..values.len() {
            rows.push(values[place.iter().zip(&strides).map(|(at, stride)| at * stride).sum::<usize>()]);
            for axis in (0..place.len()).rev() {
                place[axis] += 1;
                if place[axis] < self.shape[axis] {
                    break;
                }
                place[axis] = 0;
            }
        }
        rows
    }
}

/// The array that is meant, the active scalars or else the only one of numbers, and its axes, x last.
fn chosen(dataset: &DataSet) -> Option<(&DataArray, Vec<usize>)> {
    let Geometry::ImageData { extent, .. } = &dataset.geometry else { return None };
    let is_number = |array: &&DataArray| !matches!(array.data, ArrayData::String(_));
    let active = dataset.point_data.active(Role::Scalars).and_then(|name| dataset.point_array(name)).filter(is_number);
    let mut all = dataset.point_data.arrays.iter().filter(is_number);
    let array = match (active, all.next(), all.next()) {
        (Some(active), ..) => active,
        (None, Some(only), None) => only,
        _ => return None,
    };
    let mut shape: Vec<usize> = extent.dimensions().into_iter().rev().collect();
    match array.components {
        1 => {
            let flat = shape.iter().take(2).take_while(|&&count| count == 1).count();
            shape.drain(..flat);
        }
        components => shape.push(components),
    }
    Some((array, shape))
}

/// What an array leaves out, in words; an objection where the data set is none.
pub(super) fn losses(dataset: &DataSet) -> Result<Vec<String>, Objection> {
    let Some((chosen, _)) = chosen(dataset) else {
        let expected = "image data with one point array of numbers, or one that is the active scalars";
        return Err((dataset.geometry.name().to_owned(), expected.to_owned()));
    };
    let name = |kind: &str, array: &DataArray| format!("{kind} array \"{}\"", array.name.escape_debug());
    let others = dataset.point_data.arrays.iter().filter(|array| array.name != chosen.name);
    let mut lost: Vec<String> = others.map(|array| name("point", array)).collect();
    lost.extend(dataset.cell_data.arrays.iter().map(|array| name("cell", array)));
    lost.extend(dataset.field_data.iter().map(|array| name("field", array)));
    if chosen.name != NAME {
        lost.push(format!("the name \"{}\"", chosen.name.escape_debug()));
    }
    if let Geometry::ImageData { origin, spacing, direction, extent } = &dataset.geometry {
        let is_plain = *origin == [0.0; 3] && *spacing == [1.0; 3] && *direction == [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        if !is_plain || extent.0.iter().step_by(2).any(|&first| first != 0) {
            lost.push("origin, spacing and axes".to_owned());
        }
    }
    Ok(lost)
}

/// Writes the array, version 1.0, the numbers as they are.
pub(super) fn write<W: Write>(dataset: &DataSet, out: &mut BufWriter<W>) -> std::io::Result<()> {
    let Some((array, shape)) = chosen(dataset) else { return Err(std::io::Error::other("the data set is no array")) };
    let type_name = match &array.data {
        ArrayData::I8(_) => "|i1",
        ArrayData::U8(_) => "|u1",
        ArrayData::I16(_) => "<i2",
        ArrayData::U16(_) => "<u2",
        ArrayData::I32(_) => "<i4",
        ArrayData::U32(_) => "<u4",
        ArrayData::I64(_) => "<i8",
        ArrayData::U64(_) => "<u8",
        ArrayData::F32(_) => "<f4",
        ArrayData::F64(_) => "<f8",
        ArrayData::Bit(_) => "|b1",
        ArrayData::String(_) => return Err(std::io::Error::other("texts are no numbers")),
    };
    let axes: Vec<String> = shape.iter().map(usize::to_string).collect();
    let comma = if axes.len() == 1 { "," } else { "" };
    let mut header = format!("{{'descr': '{type_name}', 'fortran_order': False, 'shape': ({}{comma}), }}", axes.join(", "));
    // The numbers begin at a multiple of 64 bytes, after a line end.
    let unfilled = (MAGIC.len() + 4 + header.len() + 1) % 64;
    header.push_str(&" ".repeat((64 - unfilled) % 64));
    header.push('\n');
    out.write_all(MAGIC)?;
    out.write_all(&[1, 0])?;
    out.write_all(&(header.len() as u16).to_le_bytes())?;
    out.write_all(header.as_bytes())?;
    fn put<T: Element, W: Write>(values: &[T], out: &mut BufWriter<W>) -> std::io::Result<()> {
        const PART: usize = 1 << 14;
        let mut bytes = Vec::with_capacity(PART * T::WIDTH);
        for part in values.chunks(PART) {
            bytes.clear();
            part.iter().for_each(|value| value.push_bytes(ByteOrder::Little, &mut bytes));
            out.write_all(&bytes)?;
        }
        Ok(())
    }
    match &array.data {
        ArrayData::I8(values) => put(values, out),
        ArrayData::U8(values) => put(values, out),
        ArrayData::I16(values) => put(values, out),
        ArrayData::U16(values) => put(values, out),
        ArrayData::I32(values) => put(values, out),
        ArrayData::U32(values) => put(values, out),
        ArrayData::I64(values) => put(values, out),
        ArrayData::U64(values) => put(values, out),
        ArrayData::F32(values) => put(values, out),
        ArrayData::F64(values) => put(values, out),
        ArrayData::Bit(values) => put(&values.iter().map(|&bit| u8::from(bit)).collect::<Vec<u8>>(), out),
        ArrayData::String(_) => Ok(()),
    }
}
