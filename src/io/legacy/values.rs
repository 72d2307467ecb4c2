//! The values of one array of a legacy file.

use crate::io::array::ArrayData;
use crate::io::bytes::{ByteOrder, Element, parse_f32, parse_f64, unpack_bits, values_of_bytes};
use crate::io::error::{Fault, quoted};

use crate::io::lexer::{Lexer, decoded_bytes};

/// What a type name of the format stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LegacyType {
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
    /// VTK's own index type: 32 bits in the file, 64 in memory.
    Id,
}

impl LegacyType {
    /// Reads a type name.
    pub fn read(lexer: &mut Lexer<'_>) -> Result<Self, Fault> {
        const EXPECTED: &str = "a type such as float, double, int or unsigned_char";
        let place = lexer.place();
        let word = lexer.text(EXPECTED)?;
        Self::of_name(&word.to_ascii_lowercase()).ok_or_else(|| Fault::new(place, quoted(word), EXPECTED))
    }

    fn of_name(name: &str) -> Option<Self> {
        Some(match name {
            "bit" => Self::Bit,
            "char" | "signed_char" | "vtktypeint8" => Self::I8,
            "unsigned_char" | "vtktypeuint8" => Self::U8,
            "short" | "vtktypeint16" => Self::I16,
            "unsigned_short" | "vtktypeuint16" => Self::U16,
            "int" | "vtktypeint32" => Self::I32,
            "unsigned_int" | "vtktypeuint32" => Self::U32,
            "long" | "long_long" | "vtktypeint64" | "__int64" => Self::I64,
            "unsigned_long" | "unsigned_long_long" | "vtktypeuint64" | "unsigned___int64" => Self::U64,
            "vtkidtype" => Self::Id,
            "float" => Self::F32,
            "double" => Self::F64,
            "string" | "utf8_string" => Self::String,
            _ => return None,
        })
    }
}

/// Reads `count` values; the lexer stands at the end of the line before them.
pub(super) fn values(lexer: &mut Lexer<'_>, value_type: LegacyType, count: usize) -> Result<ArrayData, Fault> {
    // A value takes at least a byte, or a bit: checked before memory is taken.
    if count / 8 > lexer.remaining() {
        return Err(lexer.fault(format!("{} bytes before the end", lexer.remaining()), format!("{count} values")));
    }
    if value_type == LegacyType::String {
        return strings(lexer, count);
    }
    if lexer.binary {
        lexer.line();
        return binary(lexer, value_type, count);
    }
    Ok(match value_type {
        LegacyType::I8 => ArrayData::I8(words(lexer, count, "an 8-bit integer", |word| word.parse().ok())?),
        LegacyType::U8 => ArrayData::U8(words(lexer, count, "an unsigned 8-bit integer", |word| word.parse().ok())?),
        LegacyType::I16 => ArrayData::I16(words(lexer, count, "a 16-bit integer", |word| word.parse().ok())?),
        LegacyType::U16 => ArrayData::U16(words(lexer, count, "an unsigned 16-bit integer", |word| word.parse().ok())?),
        LegacyType::I32 => ArrayData::I32(words(lexer, count, "a 32-bit integer", |word| word.parse().ok())?),
        LegacyType::U32 => ArrayData::U32(words(lexer, count, "an unsigned 32-bit integer", |word| word.parse().ok())?),
        LegacyType::I64 | LegacyType::Id => ArrayData::I64(words(lexer, count, "an integer", |word| word.parse().ok())?),
        LegacyType::U64 => ArrayData::U64(words(lexer, count, "an unsigned integer", |word| word.parse().ok())?),
        LegacyType::F32 => ArrayData::F32(words(lexer, count, "a number", parse_f32)?),
        LegacyType::F64 => ArrayData::F64(words(lexer, count, "a number", parse_f64)?),
        LegacyType::Bit => ArrayData::Bit(words(lexer, count, "0 or 1", |word| match word {
            "0" => Some(false),
            "1" => Some(true),
            _ => None,
        })?),
        LegacyType::String => ArrayData::String(Vec::new()),
    })
}

/// Integers of the given type as `i64`.
pub(super) fn integers(lexer: &mut Lexer<'_>, value_type: LegacyType, count: usize) -> Result<Vec<i64>, Fault> {
    let place = lexer.place();
    let data = values(lexer, value_type, count)?;
    data.to_i64().map_err(|index| Fault::new(place, format!("no integer as number {index}"), "an integer"))
}

/// The next `count` words as numbers.
pub(super) fn words<T>(
    lexer: &mut Lexer<'_>,
    count: usize,
    expected: &str,
    parse: impl Fn(&str) -> Option<T>,
) -> Result<Vec<T>, Fault> {
    let mut values = Vec::with_capacity(count.min(lexer.remaining() / 2 + 1));
    for index in 0..count {
        let word = lexer.word();
        let value = word.and_then(|word| std::str::from_utf8(word).ok()).and_then(&parse);
        match (value, word) {
            (Some(value), _) => values.push(value),
            (None, None) => return Err(lexer.fault(format!("the end of the file after {index} values"), format!("{count}"))),
            (None, Some(word)) => return Err(lexer.fault(quoted(&String::from_utf8_lossy(word)), expected)),
        }
    }
    Ok(values)
}

fn binary(lexer: &mut Lexer<'_>, value_type: LegacyType, count: usize) -> Result<ArrayData, Fault> {
    fn numbers<T: Element>(lexer: &mut Lexer<'_>, count: usize) -> Result<Vec<T>, Fault> {
        let bytes = lexer.take(count.saturating_mul(T::WIDTH))?;
        Ok(values_of_bytes(bytes, ByteOrder::Big))
    }
    Ok(match value_type {
        LegacyType::I8 => ArrayData::I8(numbers(lexer, count)?),
        LegacyType::U8 => ArrayData::U8(numbers(lexer, count)?),
        LegacyType::I16 => ArrayData::I16(numbers(lexer, count)?),
        LegacyType::U16 => ArrayData::U16(numbers(lexer, count)?),
        LegacyType::I32 => ArrayData::I32(numbers(lexer, count)?),
        LegacyType::U32 => ArrayData::U32(numbers(lexer, count)?),
        LegacyType::I64 => ArrayData::I64(numbers(lexer, count)?),
        LegacyType::U64 => ArrayData::U64(numbers(lexer, count)?),
        LegacyType::F32 => ArrayData::F32(numbers(lexer, count)?),
        LegacyType::F64 => ArrayData::F64(numbers(lexer, count)?),
        LegacyType::Id => ArrayData::I64(numbers::<i32>(lexer, count)?.into_iter().map(i64::from).collect()),
        LegacyType::Bit => ArrayData::Bit(unpack_bits(lexer.take(count.div_ceil(8))?, count)),
        LegacyType::String => ArrayData::String(Vec::new()),
    })
}

/// Texts: one a line with percent codes, or, in binary, each after its length.
fn strings(lexer: &mut Lexer<'_>, count: usize) -> Result<ArrayData, Fault> {
    lexer.line();
    let mut texts = Vec::with_capacity(count.min(lexer.remaining()));
    for index in 0..count {
        if lexer.is_at_end() {
            return Err(lexer.fault(format!("the end of the file after {index} texts"), format!("{count}")));
        }
        if lexer.binary {
            let length = text_length(lexer)?;
            texts.push(lexer.take(length)?.to_vec());
        } else {
            texts.push(decoded_bytes(lexer.line()));
        }
    }
    Ok(ArrayData::String(texts))
}

/// A length in 1, 2, 4 or 8 bytes, as the two highest bits of the first say (3, 2, 1, 0).
fn text_length(lexer: &mut Lexer<'_>) -> Result<usize, Fault> {
    let place = lexer.place();
    let first = lexer.take(1)?[0];
    let more = match first >> 6 {
        3 => 0,
        2 => 1,
        1 => 3,
        _ => 7,
    };
    let rest = lexer.take(more)?;
    let length = rest.iter().fold(u64::from(first & 0x3f), |length, &byte| length << 8 | u64::from(byte));
    usize::try_from(length).map_err(|_| Fault::new(place, format!("a text of {length} bytes"), "a length that fits"))
}
