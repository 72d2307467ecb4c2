//! One `<DataArray>` element, decoded.

use rayon::prelude::*;
use roxmltree::Node;

use crate::io::array::{ArrayData, DataArray, InformationKey, InformationValue, ValueType};
use crate::io::bytes::{ByteOrder, Element, unpack_bits, values_of_bytes};
use crate::io::error::{Fault, Place, quoted};

use super::base64::Decoder;
use super::blocks::{Blocks, Payload, Stream, Unpacker};
use super::document::{Context, Source};

/// Reads an array.
///
/// # Arguments
/// * `tuples`: how many the file declares elsewhere, or `None` for as many as there are.
pub(super) fn read_array(context: &Context<'_>, node: Node<'_, '_>, tuples: Option<usize>) -> Result<DataArray, Fault> {
    let name = node.attribute("Name").unwrap_or_default();
    read_named(context, node, tuples, name)
        .map_err(|mut fault| {
            fault.found = format!("{} in array {}", fault.found, quoted(name));
            fault.or_at(context.place(node))
        })
}

fn read_named(context: &Context<'_>, node: Node<'_, '_>, tuples: Option<usize>, name: &str) -> Result<DataArray, Fault> {
    let value_type = value_type(node)?;
    let components = context.number::<usize>(node, "NumberOfComponents")?.unwrap_or(1);
    if !(1..=1 << 20).contains(&components) {
        return Err(Fault::new(context.place(node), format!("{components} components"), "1 to 1048576"));
    }
    let tuples = match tuples {
        Some(tuples) => Some(tuples),
        None => context.number::<usize>(node, "NumberOfTuples")?,
    };
    let expected = match tuples.map(|tuples| tuples.checked_mul(components)) {
        None => None,
        Some(Some(values)) => Some(values),
        Some(None) => return Err(Fault::new(context.place(node), "more values than can be counted", "fewer")),
    };
    let data = match node.attribute("format") {
        Some("ascii") | None => ascii_values(context, node, value_type)?,
        Some("binary") => {
            let (text, start) = text_of(node);
            binary_values(context, Stream::Base64(Decoder::new(text.as_bytes(), start)), value_type, expected)
                .map_err(|fault| place_by_line(context, fault))?
        }
        Some("appended") => binary_values(context, appended(context, node)?, value_type, expected)?,
        Some(other) => {
            return Err(Fault::unsupported(context.place(node), format!("format={}", quoted(other)), "ascii, binary or appended"));
        }
    };
    if let Some(expected) = expected.filter(|&expected| expected != data.len()) {
        return Err(Fault::new(context.place(node), format!("{} values", data.len()), format!("{expected}")));
    }
    if data.len() % components != 0 {
        return Err(Fault::new(
            context.place(node),
            format!("{} values", data.len()),
            format!("a multiple of {components} components"),
        ));
    }
    let mut component_names: Vec<String> = (0..components.min(node.attributes().len()))
        .map(|component| node.attribute(format!("ComponentName{component}").as_str()).unwrap_or_default().to_owned())
        .collect();
    if component_names.iter().all(String::is_empty) {
        component_names.clear();
    } else {
        component_names.resize(components, String::new());
    }
    Ok(DataArray {
        name: name.to_owned(),
        components,
        component_names,
        data,
        id_type: node.attribute("IdType") == Some("1"),
        information: node.children().filter(|child| child.has_tag_name("InformationKey")).map(information).collect(),
    })
}

fn value_type(node: Node<'_, '_>) -> Result<ValueType, Fault> {
    let text = node.attribute("type").unwrap_or_default();
    ValueType::of_xml_name(text)
        .ok_or_else(|| Fault::unsupported(Place::File, format!("type={}", quoted(text)), "Int8 to UInt64, Float32, Float64, Bit or String"))
}

fn information(node: Node<'_, '_>) -> InformationKey {
    let texts = || node.children().filter(|child| child.has_tag_name("Value"));
    let value = match node.attribute("length") {
        Some(_) => InformationValue::List(texts().map(content).collect()),
        None => InformationValue::Single(content(node)),
    };
    InformationKey {
        name: node.attribute("name").unwrap_or_default().to_owned(),
        location: node.attribute("location").unwrap_or_default().to_owned(),
        value,
    }
}

/// The text of an element without the blanks and line ends around it; those that stand there as character references belong to it.
fn content(node: Node<'_, '_>) -> String {
    let Some(child) = node.first_child().filter(Node::is_text) else { return String::new() };
    let text = child.text().unwrap_or_default();
    // A parser makes one line end of two bytes.
    let raw = node.document().input_text()[child.range()].replace("\r\n", "\n");
    let is_blank = u8::is_ascii_whitespace;
    let before = raw.bytes().take_while(is_blank).count();
    let behind = raw.bytes().rev().take_while(is_blank).count();
    let text = &text[text.bytes().take(before).take_while(is_blank).count()..];
    text[..text.len() - text.bytes().rev().take(behind).take_while(is_blank).count()].to_owned()
}

/// The first text inside an element that is not blank, and its place. Information keys may stand before or after it.
fn text_of<'a>(node: Node<'a, '_>) -> (&'a str, usize) {
    node.children()
        .filter(Node::is_text)
        .map(|child| (child.text().unwrap_or_default(), child.range().start))
        .find(|(text, _)| !text.trim_ascii().is_empty())
        .unwrap_or(("", node.range().start))
}

/// Inline data has lines, which help a reader more than bytes.
fn place_by_line(context: &Context<'_>, mut fault: Fault) -> Fault {
    if let Place::Byte(byte) = fault.place {
        fault.place = context.line(byte);
    }
    fault
}

fn appended<'a>(context: &Context<'a>, node: Node<'_, '_>) -> Result<Stream<'a>, Fault> {
    let place = context.place(node);
    let Some(appended) = context.appended else {
        return Err(Fault::new(place, "an appended array", "<AppendedData> at the end of the file"));
    };
    let Some(offset) = context.number::<usize>(node, "offset")? else {
        return Err(Fault::new(place, "an appended array without offset", "an offset"));
    };
    let size = appended.source.length().saturating_sub(appended.start);
    if offset > size {
        return Err(Fault::new(place, format!("offset {offset}"), format!("at most the {size} bytes of appended data")));
    }
    let start = appended.start + offset;
    match (appended.base64, appended.source) {
        (true, Source::Memory(bytes)) => Ok(Stream::Base64(Decoder::new(&bytes[start..], start))),
        (true, source @ Source::File { .. }) => {
            Err(Fault::new(place, format!("{} bytes of base64 on disk", source.length()), "them in memory"))
        }
        (false, source) => Ok(Stream::Raw { source, start }),
    }
}

fn ascii_values(context: &Context<'_>, node: Node<'_, '_>, value_type: ValueType) -> Result<ArrayData, Fault> {
    let (text, start) = text_of(node);
    fn parse<T>(text: &str, one: impl Fn(&str) -> Option<T>, context: &Context<'_>, start: usize) -> Result<Vec<T>, Fault> {
        text.split_ascii_whitespace()
            .map(|token| {
                one(token).ok_or_else(|| {
                    let within = token.as_ptr() as usize - text.as_ptr() as usize;
                    Fault::new(context.line(start + within), quoted(token), "a number of the array's type")
                })
            })
            .collect()
    }
    macro_rules! numbers {
        ($variant:ident, $one:expr) => {
            parse(text, $one, context, start).map(ArrayData::$variant)
        };
    }
    match value_type {
        ValueType::I8 => numbers!(I8, |token| token.parse().ok()),
        ValueType::U8 => numbers!(U8, |token| token.parse().ok()),
        ValueType::I16 => numbers!(I16, |token| token.parse().ok()),
        ValueType::U16 => numbers!(U16, |token| token.parse().ok()),
        ValueType::I32 => numbers!(I32, |token| token.parse().ok()),
        ValueType::U32 => numbers!(U32, |token| token.parse().ok()),
        ValueType::I64 => numbers!(I64, |token| token.parse().ok()),
        ValueType::U64 => numbers!(U64, |token| token.parse().ok()),
        ValueType::F32 => numbers!(F32, crate::io::bytes::parse_f32),
        ValueType::F64 => numbers!(F64, crate::io::bytes::parse_f64),
        ValueType::Bit => numbers!(Bit, |token| token.parse::<u8>().ok().filter(|&bit| bit < 2).map(|bit| bit == 1)),
        ValueType::String => {
            let codes: Vec<u8> = parse(text, |token| token.parse().ok(), context, start)?;
            strings(&codes)
        }
    }
}

/// Texts that each end in a zero byte.
fn strings(bytes: &[u8]) -> Result<ArrayData, Fault> {
    match bytes.split_last() {
        None => Ok(ArrayData::String(Vec::new())),
        Some((0, texts)) => Ok(ArrayData::String(texts.split(|&byte| byte == 0).map(<[u8]>::to_vec).collect())),
        Some((last, _)) => Err(Fault::new(Place::File, format!("texts that end in byte {last:#04x}"), "a zero byte after each text")),
    }
}

fn binary_values(
    context: &Context<'_>,
    mut stream: Stream<'_>,
    value_type: ValueType,
    expected: Option<usize>,
) -> Result<ArrayData, Fault> {
    let place = stream.place();
    // Some writers give an empty array no header at all.
    if expected == Some(0) {
        return Ok(value_type.empty());
    }
    let payload = Payload::read(context, &mut stream)?;
    let bytes = payload.len();
    // Lengths are checked before unpacking, so that a lying header costs no memory.
    let check = |width: usize| match expected {
        Some(values) if values.checked_mul(width) != Some(bytes) => {
            Err(Fault::new(place, format!("{bytes} bytes"), format!("{values} values of {width} bytes")))
        }
        None if bytes % width != 0 => Err(Fault::new(place, format!("{bytes} bytes"), format!("a multiple of {width}"))),
        _ => Ok(()),
    };
    macro_rules! numbers {
        ($variant:ident, $number:ty) => {{
            check(size_of::<$number>())?;
            ArrayData::$variant(elements(context, payload)?)
        }};
    }
    Ok(match value_type {
        ValueType::I8 => numbers!(I8, i8),
        ValueType::U8 => numbers!(U8, u8),
        ValueType::I16 => numbers!(I16, i16),
        ValueType::U16 => numbers!(U16, u16),
        ValueType::I32 => numbers!(I32, i32),
        ValueType::U32 => numbers!(U32, u32),
        ValueType::I64 => numbers!(I64, i64),
        ValueType::U64 => numbers!(U64, u64),
        ValueType::F32 => numbers!(F32, f32),
        ValueType::F64 => numbers!(F64, f64),
        ValueType::Bit => {
            let count = expected.unwrap_or(bytes.saturating_mul(8));
            if bytes != count.div_ceil(8) {
                return Err(Fault::new(place, format!("{bytes} bytes"), format!("{count} bits")));
            }
            ArrayData::Bit(unpack_bits(&payload.unpack()?, count))
        }
        ValueType::String => strings(&payload.unpack()?)?,
    })
}

fn elements<T: Element>(context: &Context<'_>, payload: Payload<'_>) -> Result<Vec<T>, Fault> {
    match payload {
        Payload::Blocks(blocks) if blocks.block > 0 && blocks.block % T::WIDTH == 0 => block_elements(context, &blocks),
        Payload::Range { source, start, count } => range_elements(context, &source, start, count),
        other => Ok(values_of_bytes(&other.unpack()?, context.order)),
    }
}

/// Reads plain numbers from the disk in parallel, each part into its place; no byte is in memory twice but for a buffer a thread.
fn range_elements<T: Element>(context: &Context<'_>, source: &Source<'_>, start: usize, count: usize) -> Result<Vec<T>, Fault> {
    /// A multiple of every width, small enough to stay in the cache on the way.
    const CHUNK: usize = 1 << 18;
    let mut values = vec![T::default(); count / T::WIDTH];
    let fault = values
        .par_chunks_mut(CHUNK / T::WIDTH)
        .enumerate()
        .map_init(Vec::<u8>::new, |buffer, (number, target)| {
            buffer.resize(target.len() * T::WIDTH, 0);
            source.read_at(start + number * CHUNK, buffer)?;
            let pairs = target.iter_mut().zip(buffer.chunks_exact(T::WIDTH));
            match context.order {
                // Two loops, so that each is a plain copy or byte swap.
                ByteOrder::Little => pairs.for_each(|(value, bytes)| *value = T::of_bytes(bytes, ByteOrder::Little)),
                ByteOrder::Big => pairs.for_each(|(value, bytes)| *value = T::of_bytes(bytes, ByteOrder::Big)),
            }
            Ok(())
        })
        .find_map_first(Result::err);
    match fault {
        Some(fault) => Err(fault),
        None => Ok(values),
    }
}

/// Unpacks the blocks in parallel, each into its place.
fn block_elements<T: Element>(context: &Context<'_>, blocks: &Blocks<'_>) -> Result<Vec<T>, Fault> {
    /// Fewer blocks are not worth another thread.
    const LEAST_BLOCKS: usize = 8;
    let mut values = vec![T::default(); blocks.total / T::WIDTH];
    let fault = values
        .par_chunks_mut(blocks.block / T::WIDTH)
        .enumerate()
        .with_min_len(LEAST_BLOCKS)
        .map_init(
            || (Unpacker::new(blocks.compressor), vec![0; blocks.block.min(blocks.total)]),
            |(unpacker, buffer), (number, target)| {
                let bytes = &mut buffer[..target.len() * T::WIDTH];
                blocks.unpack_block(unpacker, number, bytes)?;
                for (value, bytes) in target.iter_mut().zip(bytes.chunks_exact(T::WIDTH)) {
                    *value = T::of_bytes(bytes, context.order);
                }
                Ok(())
            },
        )
        // The first block that fails is named, whichever thread met it.
        .find_map_first(Result::err);
    match fault {
        Some(fault) => Err(fault),
        None => Ok(values),
    }
}
