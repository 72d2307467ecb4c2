//! One named array of a data set, with values in the type in which the file stores them.

/// The values of a [`DataArray`], flat, tuple after tuple.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ArrayData {
    /// 8-bit signed (`signed char`).
    I8(Vec<i8>),
    /// 8-bit unsigned.
    U8(Vec<u8>),
    /// 16-bit signed.
    I16(Vec<i16>),
    /// 16-bit unsigned.
    U16(Vec<u16>),
    /// 32-bit signed.
    I32(Vec<i32>),
    /// 32-bit unsigned.
    U32(Vec<u32>),
    /// 64-bit signed.
    I64(Vec<i64>),
    /// 64-bit unsigned.
    U64(Vec<u64>),
    /// Single precision.
    F32(Vec<f32>),
    /// Double precision.
    F64(Vec<f64>),
    /// One bit a value; packed in files.
    Bit(Vec<bool>),
    /// Texts, as bytes, because VTK promises no encoding.
    String(Vec<Vec<u8>>),
}

/// Runs one expression for whichever vector an [`ArrayData`] holds.
macro_rules! with_values {
    ($data:expr, $values:ident => $body:expr) => {
        match $data {
            ArrayData::I8($values) => $body,
            ArrayData::U8($values) => $body,
            ArrayData::I16($values) => $body,
            ArrayData::U16($values) => $body,
            ArrayData::I32($values) => $body,
            ArrayData::U32($values) => $body,
            ArrayData::I64($values) => $body,
            ArrayData::U64($values) => $body,
            ArrayData::F32($values) => $body,
            ArrayData::F64($values) => $body,
            ArrayData::Bit($values) => $body,
            ArrayData::String($values) => $body,
        }
    };
}
pub(super) use with_values;

impl ArrayData {
    /// Numbers in the type asked for; what the type cannot hold becomes the nearest that it can, bits and texts double precision.
    pub(super) fn of_numbers(value_type: ValueType, numbers: &[f64]) -> Self {
        macro_rules! cast {
            ($kind:ident, $number:ty) => {
                Self::$kind(numbers.iter().map(|&number| number as $number).collect())
            };
        }
        match value_type {
            ValueType::I8 => cast!(I8, i8),
            ValueType::U8 => cast!(U8, u8),
            ValueType::I16 => cast!(I16, i16),
            ValueType::U16 => cast!(U16, u16),
            ValueType::I32 => cast!(I32, i32),
            ValueType::U32 => cast!(U32, u32),
            ValueType::I64 => cast!(I64, i64),
            ValueType::U64 => cast!(U64, u64),
            ValueType::F32 => cast!(F32, f32),
            ValueType::F64 | ValueType::Bit | ValueType::String => Self::F64(numbers.to_vec()),
        }
    }

    /// Number of values (not of tuples).
    pub fn len(&self) -> usize {
        with_values!(self, values => values.len())
    }

    /// Whether there is no value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The type of the values.
    pub fn value_type(&self) -> ValueType {
        match self {
            Self::I8(_) => ValueType::I8,
            Self::U8(_) => ValueType::U8,
            Self::I16(_) => ValueType::I16,
            Self::U16(_) => ValueType::U16,
            Self::I32(_) => ValueType::I32,
            Self::U32(_) => ValueType::U32,
            Self::I64(_) => ValueType::I64,
            Self::U64(_) => ValueType::U64,
            Self::F32(_) => ValueType::F32,
            Self::F64(_) => ValueType::F64,
            Self::Bit(_) => ValueType::Bit,
            Self::String(_) => ValueType::String,
        }
    }

    /// One value as a number; `None` for a text or past the end. 64-bit integers are rounded to the nearest `f64`.
    pub fn number(&self, index: usize) -> Option<f64> {
        match self {
            Self::I8(values) => values.get(index).map(|&value| value.into()),
            Self::U8(values) => values.get(index).map(|&value| value.into()),
            Self::I16(values) => values.get(index).map(|&value| value.into()),
            Self::U16(values) => values.get(index).map(|&value| value.into()),
            Self::I32(values) => values.get(index).map(|&value| value.into()),
            Self::U32(values) => values.get(index).map(|&value| value.into()),
            Self::I64(values) => values.get(index).map(|&value| value as f64),
            Self::U64(values) => values.get(index).map(|&value| value as f64),
            Self::F32(values) => values.get(index).map(|&value| value.into()),
            Self::F64(values) => values.get(index).copied(),
            Self::Bit(values) => values.get(index).map(|&value| f64::from(u8::from(value))),
            Self::String(_) => None,
        }
    }

    /// All values as `i64`, or the first place whose value is no such number.
    pub(super) fn to_i64(&self) -> Result<Vec<i64>, usize> {
        fn widen<T: Copy + Into<i64>>(values: &[T]) -> Result<Vec<i64>, usize> {
            Ok(values.iter().map(|&value| value.into()).collect())
        }
        match self {
            Self::I8(values) => widen(values),
            Self::U8(values) => widen(values),
            Self::I16(values) => widen(values),
            Self::U16(values) => widen(values),
            Self::I32(values) => widen(values),
            Self::U32(values) => widen(values),
            Self::I64(values) => Ok(values.clone()),
            Self::U64(values) => values
                .iter()
                .enumerate()
                .map(|(index, &value)| i64::try_from(value).map_err(|_| index))
                .collect(),
            Self::Bit(values) => widen(values),
            Self::F32(_) | Self::F64(_) | Self::String(_) => Err(0),
        }
    }
}

/// The type of the values of an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
#[non_exhaustive]
pub enum ValueType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
    Bit,
    String,
}

impl ValueType {
    /// Every type with its name in VTK XML.
    const XML_NAMES: [(Self, &'static str); 12] = [
        (Self::I8, "Int8"),
        (Self::U8, "UInt8"),
        (Self::I16, "Int16"),
        (Self::U16, "UInt16"),
        (Self::I32, "Int32"),
        (Self::U32, "UInt32"),
        (Self::I64, "Int64"),
        (Self::U64, "UInt64"),
        (Self::F32, "Float32"),
        (Self::F64, "Float64"),
        (Self::Bit, "Bit"),
        (Self::String, "String"),
    ];

    /// The name in VTK XML files: `Int8`, `Float64`, `String` ...
    pub fn xml_name(self) -> &'static str {
        Self::XML_NAMES[self as usize].1
    }

    pub(super) fn of_xml_name(name: &str) -> Option<Self> {
        Self::XML_NAMES.iter().find(|entry| entry.1 == name).map(|entry| entry.0)
    }

    /// Whether values are floating-point numbers.
    pub fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// An array of this type without values.
    pub(super) fn empty(self) -> ArrayData {
        match self {
            Self::I8 => ArrayData::I8(Vec::new()),
            Self::U8 => ArrayData::U8(Vec::new()),
            Self::I16 => ArrayData::I16(Vec::new()),
            Self::U16 => ArrayData::U16(Vec::new()),
            Self::I32 => ArrayData::I32(Vec::new()),
            Self::U32 => ArrayData::U32(Vec::new()),
            Self::I64 => ArrayData::I64(Vec::new()),
            Self::U64 => ArrayData::U64(Vec::new()),
            Self::F32 => ArrayData::F32(Vec::new()),
            Self::F64 => ArrayData::F64(Vec::new()),
            Self::Bit => ArrayData::Bit(Vec::new()),
            Self::String => ArrayData::String(Vec::new()),
        }
    }
}

/// A key with its values that VTK hangs on an array, such as `UNITS_LABEL`. Carried, not interpreted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InformationKey {
    /// Name of the key.
    pub name: String,
    /// The VTK class that owns the key.
    pub location: String,
    /// The value or values, as text.
    pub value: InformationValue,
}

/// The value of an [`InformationKey`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum InformationValue {
    /// A key with one value.
    Single(String),
    /// A key with a list of values, which may hold any number of them.
    List(Vec<String>),
}

/// A named array: `tuples x components` values.
#[derive(Debug, Clone, PartialEq)]
pub struct DataArray {
    /// Name, as the user sees it; may be empty.
    pub name: String,
    /// Values in a tuple; at least 1.
    pub components: usize,
    /// Names of the components; none, or one a component, where an empty text is "no name".
    pub component_names: Vec<String>,
    /// The values, tuple after tuple.
    pub data: ArrayData,
    /// Whether the integers are VTK's `vtkIdType`, which VTK keeps apart from other 64-bit integers.
    pub id_type: bool,
    /// What VTK hangs on the array.
    pub information: Vec<InformationKey>,
}

impl DataArray {
    /// An array without component names or information keys.
    pub fn new(name: impl Into<String>, components: usize, data: ArrayData) -> Self {
        Self {
            name: name.into(),
            components,
            component_names: Vec::new(),
            data,
            id_type: false,
            information: Vec::new(),
        }
    }

    /// Number of tuples.
    pub fn tuples(&self) -> usize {
        self.data.len() / self.components.max(1)
    }

    /// The tuples of the given numbers, in that order.
    pub(super) fn gathered(self, tuples: &[usize]) -> Self {
        fn pick<T: Clone>(values: &[T], tuples: &[usize], stride: usize) -> Vec<T> {
            tuples.iter().flat_map(|&tuple| values[tuple * stride..(tuple + 1) * stride].iter().cloned()).collect()
        }
        let stride = self.components;
        let data = match &self.data {
            ArrayData::I8(values) => ArrayData::I8(pick(values, tuples, stride)),
            ArrayData::U8(values) => ArrayData::U8(pick(values, tuples, stride)),
            ArrayData::I16(values) => ArrayData::I16(pick(values, tuples, stride)),
            ArrayData::U16(values) => ArrayData::U16(pick(values, tuples, stride)),
            ArrayData::I32(values) => ArrayData::I32(pick(values, tuples, stride)),
            ArrayData::U32(values) => ArrayData::U32(pick(values, tuples, stride)),
            ArrayData::I64(values) => ArrayData::I64(pick(values, tuples, stride)),
            ArrayData::U64(values) => ArrayData::U64(pick(values, tuples, stride)),
            ArrayData::F32(values) => ArrayData::F32(pick(values, tuples, stride)),
            ArrayData::F64(values) => ArrayData::F64(pick(values, tuples, stride)),
            ArrayData::Bit(values) => ArrayData::Bit(pick(values, tuples, stride)),
            ArrayData::String(values) => ArrayData::String(pick(values, tuples, stride)),
        };
        Self { data, ..self }
    }

    /// One component of every tuple as `f64`; empty for texts or a component that does not exist.
    ///
    /// 64-bit integers are rounded to the nearest `f64`.
    pub fn to_f64(&self, component: usize) -> Vec<f64> {
        fn pick<T: Copy>(values: &[T], component: usize, stride: usize, convert: impl Fn(T) -> f64) -> Vec<f64> {
            values.iter().skip(component).step_by(stride).map(|&value| convert(value)).collect()
        }
        if component >= self.components {
            return Vec::new();
        }
        let stride = self.components;
        match &self.data {
            ArrayData::I8(values) => pick(values, component, stride, f64::from),
            ArrayData::U8(values) => pick(values, component, stride, f64::from),
            ArrayData::I16(values) => pick(values, component, stride, f64::from),
            ArrayData::U16(values) => pick(values, component, stride, f64::from),
            ArrayData::I32(values) => pick(values, component, stride, f64::from),
            ArrayData::U32(values) => pick(values, component, stride, f64::from),
            ArrayData::I64(values) => pick(values, component, stride, |value| value as f64),
            ArrayData::U64(values) => pick(values, component, stride, |value| value as f64),
            ArrayData::F32(values) => pick(values, component, stride, f64::from),
            ArrayData::F64(values) => pick(values, component, stride, |value| value),
            ArrayData::Bit(values) => pick(values, component, stride, |value| f64::from(u8::from(value))),
            ArrayData::String(_) => Vec::new(),
        }
    }

    /// The texts of a string array, invalid UTF-8 replaced; empty for numbers.
    pub fn to_texts(&self) -> Vec<String> {
        match &self.data {
            ArrayData::String(texts) => texts.iter().map(|text| String::from_utf8_lossy(text).into_owned()).collect(),
            _ => Vec::new(),
        }
    }
}
