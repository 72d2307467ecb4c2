//! An HDF5 file as a tree of groups with attributes and arrays, each reading within a bound.

use std::cell::Cell;
use std::collections::HashMap;
use std::fs::File;
use std::ops::Range;
use std::rc::Rc;

use hdf5_pure::{AttrValue, DType, Dataset, Error, Group, ReadSeekSource, VlenStringReadOptions};

use crate::io::array::{ArrayData, ValueType};
use crate::io::error::{Fault, Place, quoted};

/// What arrays of the file may unfold to: deflate packs at most 1,032 to 1.
const EXPANSION: u64 = 1_040;
/// What a chunk may hold beside, whatever the length of the file.
const LEAST: u64 = 1 << 16;

/// Bytes that the file may still fill; every array that is read takes its part.
#[derive(Debug, Clone)]
struct Budget {
    /// Length of the file.
    length: u64,
    whole: u64,
    left: Rc<Cell<u64>>,
}

/// A group with what is in it.
pub(super) struct Node {
    group: Group,
    budget: Budget,
    /// From the root of the file, for messages.
    pub path: String,
    attributes: HashMap<String, AttrValue>,
    arrays: Vec<(String, Dataset)>,
    groups: Vec<String>,
}

/// An array in the file.
pub(super) struct Stored {
    dataset: Dataset,
    budget: Budget,
    /// From the root of the file, for messages.
    pub path: String,
    /// Lengths of the axes, the slowest first; at least one.
    pub shape: Vec<u64>,
    value_type: ValueType,
}

/// A message of the reader of HDF5, with its place.
fn broken(path: &str, error: &Error) -> Fault {
    const LONGEST: usize = 200;
    let text: String = error.to_string().chars().take(LONGEST).collect();
    Fault::new(Place::File, format!("{path} that cannot be read ({text})"), "a whole HDF5 file")
}

impl Node {
    /// The group `VTKHDF` of a file.
    pub fn root(file: File, length: u64) -> Result<Self, Fault> {
        let whole = length.saturating_mul(EXPANSION).saturating_add(LEAST);
        let budget = Budget { length, whole, left: Rc::new(Cell::new(whole)) };
        let fault = |error: Error| broken("a file", &error);
        let source = ReadSeekSource::new(file).map_err(|error| fault(error.into()))?;
        let root = hdf5_pure::File::from_source(source).map_err(fault)?.root();
        if !root.groups().map_err(fault)?.iter().any(|name| name == "VTKHDF") {
            return Err(Fault::unsupported(Place::File, "an HDF5 file without the group VTKHDF", "one as VTK writes it (.vtkhdf)"));
        }
        Self::open(root.group("VTKHDF").map_err(fault)?, budget, "/VTKHDF".to_owned())
    }

    fn open(group: Group, budget: Budget, path: String) -> Result<Self, Fault> {
        let fault = |error: Error| broken(&path, &error);
        let attributes = group.attrs().map_err(fault)?;
        let arrays = group.iter_datasets().map_err(fault)?.collect();
        let groups = group.groups().map_err(fault)?;
        Ok(Self { group, budget, path, attributes, arrays, groups })
    }

    /// Names of the groups in this one.
    pub fn groups(&self) -> &[String] {
        &self.groups
    }

    /// The group of a name, if there is one.
    pub fn child(&self, name: &str) -> Result<Option<Self>, Fault> {
        if !self.groups.iter().any(|own| own == name) {
            return Ok(None);
        }
        let path = format!("{}/{name}", self.path);
        let group = self.group.group(name).map_err(|error| broken(&path, &error))?;
        Self::open(group, self.budget.clone(), path).map(Some)
    }

    /// Names of the arrays, in the order of the file.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.arrays.iter().map(|(name, _)| name.as_str())
    }

    /// The array of a name, if there is one.
    pub fn array(&self, name: &str) -> Result<Option<Stored>, Fault> {
        let Some((_, dataset)) = self.arrays.iter().find(|(own, _)| own == name) else { return Ok(None) };
        Stored::open(dataset.clone(), self.budget.clone(), format!("{}/{name}", self.path)).map(Some)
    }

    /// The array of a name, which must be there.
    pub fn needed(&self, name: &str) -> Result<Stored, Fault> {
        self.array(name)?.ok_or_else(|| Fault::new(Place::File, format!("no array {name} in {}", self.path), "one"))
    }

    /// An attribute that is a text.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.attributes.get(name).and_then(text)
    }

    /// An attribute that is a list of integers, of a certain length if it is there.
    pub fn integers<const N: usize>(&self, name: &str) -> Result<Option<[i64; N]>, Fault> {
        let value = self.attributes.get(name);
        let list = value.and_then(|value| value.to_i64s().or_else(|| value.as_i64().map(|one| vec![one])));
        self.fixed(name, value.is_some(), list)
    }

    /// An attribute that is a list of numbers, of a certain length if it is there.
    pub fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, Fault> {
        let value = self.attributes.get(name);
        self.fixed(name, value.is_some(), value.and_then(AttrValue::to_f64s))
    }

    fn fixed<T, const N: usize>(&self, name: &str, is_there: bool, list: Option<Vec<T>>) -> Result<Option<[T; N]>, Fault> {
        if !is_there {
            return Ok(None);
        }
        let found = list.as_ref().map_or("no number".to_owned(), |list| format!("{} numbers", list.len()));
        match list.and_then(|list| <[T; N]>::try_from(list).ok()) {
            Some(numbers) => Ok(Some(numbers)),
            None => Err(Fault::new(Place::File, format!("{found} in attribute {name} of {}", self.path), format!("{N}"))),
        }
    }
}

fn text(value: &AttrValue) -> Option<&str> {
    value.as_str().or_else(|| value.as_strings().and_then(|list| list.first()).map(String::as_str)).map(|text| text.trim_end_matches('\0'))
}

impl Stored {
    fn open(dataset: Dataset, budget: Budget, path: String) -> Result<Self, Fault> {
        let fault = |error: Error| broken(&path, &error);
        let mut shape = dataset.shape().map_err(fault)?;
        if shape.is_empty() {
            shape.push(1);
        }
        let value_type = match dataset.dtype().map_err(fault)? {
            DType::I8 => ValueType::I8,
            DType::U8 => ValueType::U8,
            DType::I16 => ValueType::I16,
            DType::U16 => ValueType::U16,
            DType::I32 => ValueType::I32,
            DType::U32 => ValueType::U32,
            DType::I64 => ValueType::I64,
            DType::U64 => ValueType::U64,
            DType::F32 => ValueType::F32,
            DType::F64 => ValueType::F64,
            DType::String | DType::VariableLengthString => ValueType::String,
            other => {
                let name = quoted(&other.to_string());
                let found = format!("values of type {name} in {path}");
                return Err(Fault::unsupported(Place::File, found, "integers of 8 to 64 bits, floats of 32 or 64 bits, or texts"));
            }
        };
        Ok(Self { dataset, budget, path, shape, value_type })
    }

    /// Lengths of all axes but the first, multiplied.
    pub fn row(&self) -> u64 {
        self.shape[1..].iter().fold(1, |product, &length| product.saturating_mul(length))
    }

    /// What VTK takes the array for.
    pub fn attribute(&self, name: &str) -> Option<String> {
        let attributes = self.dataset.attrs().ok()?;
        attributes.get(name).and_then(text).map(str::to_owned)
    }

    /// An attribute that is a list of texts.
    pub fn texts(&self, name: &str) -> Vec<String> {
        let attributes = self.dataset.attrs().unwrap_or_default();
        attributes.get(name).and_then(AttrValue::as_strings).map(<[String]>::to_vec).unwrap_or_default()
    }

    /// Values of some steps along the first axis.
    pub fn rows(&self, range: Range<u64>) -> Result<ArrayData, Fault> {
        let count = range.end.saturating_sub(range.start);
        if range.end > self.shape[0] {
            let found = format!("{} rows in {}", self.shape[0], self.path);
            return Err(Fault::new(Place::File, found, format!("at least {}", range.end)));
        }
        let values = count.saturating_mul(self.row());
        if values == 0 {
            return Ok(self.value_type.empty());
        }
        self.charge(values)?;
        let fault = |error: Error| broken(&self.path, &error);
        let is_whole = count == self.shape[0];
        let whole = &self.dataset;
        macro_rules! numbers {
            ($variant:ident, $all:ident, $part:ident) => {
                ArrayData::$variant(if is_whole { whole.$all() } else { whole.$part(range.start, count) }.map_err(fault)?)
            };
        }
        let data = match self.value_type {
            ValueType::I8 => numbers!(I8, read_i8, read_i8_rows),
            ValueType::U8 => numbers!(U8, read_u8, read_u8_rows),
            ValueType::I16 => numbers!(I16, read_i16, read_i16_rows),
            ValueType::U16 => numbers!(U16, read_u16, read_u16_rows),
            ValueType::I32 => numbers!(I32, read_i32, read_i32_rows),
            ValueType::U32 => numbers!(U32, read_u32, read_u32_rows),
            ValueType::I64 => numbers!(I64, read_i64, read_i64_rows),
            ValueType::U64 => numbers!(U64, read_u64, read_u64_rows),
            ValueType::F32 => numbers!(F32, read_f32, read_f32_rows),
            ValueType::F64 => numbers!(F64, read_f64, read_f64_rows),
            ValueType::Bit | ValueType::String => ArrayData::String(self.strings(range, values)?),
        };
        if data.len() as u64 != values {
            let found = format!("{} values in {}", data.len(), self.path);
            return Err(Fault::new(Place::File, found, format!("{values}")));
        }
        Ok(data)
    }

    /// All values.
    pub fn all(&self) -> Result<ArrayData, Fault> {
        self.rows(0..self.shape[0])
    }

    /// Values that are integers.
    pub fn integers(&self, range: Range<u64>) -> Result<Vec<i64>, Fault> {
        self.rows(range)?.to_i64().map_err(|_| {
            let found = format!("{} in {}", self.value_type.xml_name(), self.path);
            Fault::new(Place::File, found, "integers within 64 signed bits")
        })
    }

    /// Texts as bytes; those of variable length are counted before they are taken out of their heap.
    fn strings(&self, range: Range<u64>, values: u64) -> Result<Vec<Vec<u8>>, Fault> {
        let fault = |error: Error| broken(&self.path, &error);
        let texts = if matches!(self.dataset.dtype(), Ok(DType::VariableLengthString)) {
            let left = usize::try_from(self.budget.left.get()).unwrap_or(usize::MAX);
            let elements = usize::try_from(self.shape[0].saturating_mul(self.row())).unwrap_or(usize::MAX);
            let options = VlenStringReadOptions::new().with_max_elements(elements).with_max_payload_bytes(left);
            let all = self.dataset.read_vlen_strings(options).map_err(fault)?;
            let first = usize::try_from(range.start.saturating_mul(self.row())).unwrap_or(usize::MAX);
            all.into_iter().skip(first).take(usize::try_from(values).unwrap_or(usize::MAX)).collect()
        } else {
            self.dataset.read_string_rows(range.start, range.end - range.start).map_err(fault)?
        };
        let texts: Vec<Vec<u8>> = texts.into_iter().map(String::into_bytes).collect();
        self.take(texts.iter().map(|text| text.len() as u64).sum())?;
        Ok(texts)
    }

    /// Refuses an array that, with those before it, is larger than the file can be unpacked.
    fn charge(&self, values: u64) -> Result<(), Fault> {
        let fault = |error: Error| broken(&self.path, &error);
        let width = self.dataset.element_size().map_err(fault)?.max(1);
        // One chunk is unpacked whole, however little of it is asked for.
        let chunk = self.dataset.chunk_shape().map_err(fault)?.unwrap_or_default();
        let chunk = chunk.iter().fold(width, |product, &length| product.saturating_mul(length));
        if chunk > self.budget.whole {
            return Err(self.too_large(chunk));
        }
        // The crate makes room for what a chunk is said to take in the file before it looks whether the file is so long.
        if self.dataset.is_chunked() {
            let longest = self.dataset.chunks().map_err(fault)?.iter().map(|chunk| chunk.storage_size).max();
            if let Some(bytes) = longest.filter(|&bytes| bytes > self.budget.length) {
                let found = format!("a chunk of {bytes} bytes in {}", self.path);
                return Err(Fault::new(Place::File, found, format!("at most the {} of the file", self.budget.length)));
            }
        }
        self.take(values.saturating_mul(width))
    }

    fn take(&self, bytes: u64) -> Result<(), Fault> {
        match self.budget.left.get().checked_sub(bytes) {
            Some(left) => {
                self.budget.left.set(left);
                Ok(())
            }
            None => Err(self.too_large(bytes)),
        }
    }

    fn too_large(&self, bytes: u64) -> Fault {
        let found = format!("{bytes} bytes in {}", self.path);
        Fault::new(Place::File, found, format!("at most the {} bytes that a file of this length can be unpacked to", self.budget.whole))
    }
}
