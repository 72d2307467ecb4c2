//! The bytes of one array: a count and the bytes, or a table of packed blocks.

use std::borrow::Cow;
use std::io::Read;

use crate::io::error::{Fault, Place};

use super::base64::Decoder;
use super::document::{Compressor, Context, Source};

/// Where the encoded bytes of an array come from.
pub(super) enum Stream<'a> {
    Raw { source: Source<'a>, start: usize },
    Base64(Decoder<'a>),
}

impl<'a> Stream<'a> {
    pub fn place(&self) -> Place {
        match self {
            Self::Raw { start, .. } => Place::Byte(*start),
            Self::Base64(decoder) => decoder.place(),
        }
    }

    fn available(&self) -> usize {
        match self {
            Self::Raw { source, start } => source.length().saturating_sub(*start),
            Self::Base64(decoder) => decoder.available(),
        }
    }

    fn take(&mut self, count: usize) -> Result<Cow<'a, [u8]>, Fault> {
        match self {
            Self::Raw { source, start } => {
                let taken = source.bytes(*start, count)?;
                *start += count;
                Ok(taken)
            }
            Self::Base64(decoder) => decoder.take(count).map(Cow::Owned),
        }
    }

    fn header_number(&mut self, context: &Context<'_>) -> Result<u64, Fault> {
        Ok(context.header_number(&self.take(context.header_width)?))
    }
}

/// The bytes of an array, still packed if they were.
pub(super) enum Payload<'a> {
    Plain(Cow<'a, [u8]>),
    /// Plain bytes that are still on disk.
    Range { source: Source<'a>, start: usize, count: usize },
    Blocks(Blocks<'a>),
}

/// Packed blocks of `block` bytes each, but for the last.
pub(super) struct Blocks<'a> {
    pub packed: Cow<'a, [u8]>,
    /// Ends of the blocks in `packed`.
    pub ends: Vec<usize>,
    pub block: usize,
    pub total: usize,
    pub compressor: Compressor,
    /// Place of `packed` in the file.
    pub place: Place,
}

impl<'a> Payload<'a> {
    pub fn read(context: &Context<'_>, stream: &mut Stream<'a>) -> Result<Self, Fault> {
        match context.compressor {
            Compressor::None => {
                let place = stream.place();
                let bytes = stream.header_number(context)?;
                let bytes = usize::try_from(bytes).ok().filter(|&bytes| bytes <= stream.available()).ok_or_else(|| {
                    Fault::new(place, format!("an array of {bytes} bytes"), format!("at most the {} that follow", stream.available()))
                })?;
                match stream {
                    Stream::Raw { source: source @ Source::File { .. }, start } => {
                        Ok(Self::Range { source: *source, start: *start, count: bytes })
                    }
                    stream => Ok(Self::Plain(stream.take(bytes)?)),
                }
            }
            compressor => Blocks::read(context, stream, compressor).map(Self::Blocks),
        }
    }

    /// Number of bytes when unpacked.
    pub fn len(&self) -> usize {
        match self {
            Self::Plain(bytes) => bytes.len(),
            Self::Range { count, .. } => *count,
            Self::Blocks(blocks) => blocks.total,
        }
    }

    /// All bytes, unpacked one block after the other.
    pub fn unpack(self) -> Result<Cow<'a, [u8]>, Fault> {
        match self {
            Self::Plain(bytes) => Ok(bytes),
            Self::Range { source, start, count } => source.bytes(start, count),
            Self::Blocks(blocks) => {
                let mut bytes = vec![0; blocks.total];
                let mut unpacker = Unpacker::new(blocks.compressor);
                for (number, target) in bytes.chunks_mut(blocks.block.max(1)).enumerate() {
                    blocks.unpack_block(&mut unpacker, number, target)?;
                }
                Ok(Cow::Owned(bytes))
            }
        }
    }
}

impl<'a> Blocks<'a> {
    fn read(context: &Context<'_>, stream: &mut Stream<'a>, compressor: Compressor) -> Result<Self, Fault> {
        let place = stream.place();
        let count = stream.header_number(context)?;
        let block = stream.header_number(context)?;
        let last = stream.header_number(context)?;
        let broken = |found: String, expected: &str| Err(Fault::new(place, found, expected));
        let Some(count) = usize::try_from(count).ok().filter(|&count| count <= stream.available() / context.header_width)
        else {
            return broken(format!("a table of {count} packed blocks"), "no more blocks than bytes follow");
        };
        if last > block {
            return broken(format!("a last block of {last} bytes after blocks of {block}"), "a last block that is no longer");
        }
        let table = stream.take(count * context.header_width)?;
        let mut ends = Vec::with_capacity(count);
        let mut end = 0u64;
        for number in table.chunks_exact(context.header_width) {
            end = end.saturating_add(context.header_number(number));
            if end > stream.available() as u64 {
                return broken(
                    format!("packed blocks of {end} bytes or more"),
                    &format!("at most the {} that follow", stream.available()),
                );
            }
            ends.push(end as usize);
        }
        let packed_place = stream.place();
        let packed = stream.take(end as usize)?;
        // A last block of 0 bytes means that the last block is full.
        let missing = if last == 0 { 0 } else { block - last };
        let total = (count as u64).checked_mul(block).map(|total| total.saturating_sub(missing));
        let most = (packed.len() as u64).saturating_mul(most_expansion(compressor)).saturating_add(1024 * count as u64);
        match total {
            Some(total) if total <= most => Ok(Self {
                packed,
                ends,
                block: block as usize,
                total: total as usize,
                compressor,
                place: packed_place,
            }),
            _ => broken(
                format!("{count} blocks of {block} bytes packed into {}", packed.len()),
                "no more than the compressor can pack",
            ),
        }
    }

    /// Unpacks one block, which must fill `target`.
    pub fn unpack_block(&self, unpacker: &mut Unpacker, number: usize, target: &mut [u8]) -> Result<(), Fault> {
        let start = if number == 0 { 0 } else { self.ends[number - 1] };
        let packed = &self.packed[start..self.ends[number]];
        if unpacker.unpack(packed, target) {
            return Ok(());
        }
        // Base64 shifts places, so the block is named by number and by the start of the array's blocks.
        Err(Fault::new(
            self.place,
            format!("packed block {number} of {} that does not unpack", self.ends.len()),
            format!("{} bytes in it", target.len()),
        ))
    }
}

/// How many bytes a packed byte can stand for at the most. No array grows beyond that, however its header lies.
fn most_expansion(compressor: Compressor) -> u64 {
    match compressor {
        Compressor::None => 1,
        Compressor::Zlib => 1_040,
        Compressor::Lz4 => 256,
        Compressor::Lzma => 1 << 16,
    }
}

/// State of a compressor, kept from block to block.
pub(super) enum Unpacker {
    Zlib(flate2::Decompress),
    Lz4,
    Lzma,
}

impl Unpacker {
    pub fn new(compressor: Compressor) -> Self {
        match compressor {
            Compressor::None | Compressor::Lz4 => Self::Lz4,
            Compressor::Zlib => Self::Zlib(flate2::Decompress::new(true)),
            Compressor::Lzma => Self::Lzma,
        }
    }

    /// Whether `packed` is sound and fills `target` exactly.
    fn unpack(&mut self, packed: &[u8], target: &mut [u8]) -> bool {
        match self {
            Self::Zlib(inflate) => {
                inflate.reset(true);
                let status = inflate.decompress(packed, target, flate2::FlushDecompress::Finish);
                matches!(status, Ok(flate2::Status::StreamEnd)) && inflate.total_out() == target.len() as u64
            }
            Self::Lz4 => lz4_flex::block::decompress_into(packed, target).is_ok_and(|length| length == target.len()),
            Self::Lzma => {
                // VTK's presets need up to 65 MiB; a damaged header could ask for 4 GiB.
                const MEMORY_LIMIT_KIB: u32 = 100 << 10;
                let mut reader = lzma_rust2::XzReader::new_mem_limit(packed, false, MEMORY_LIMIT_KIB);
                reader.read_exact(target).is_ok() && matches!(reader.read(&mut [0]), Ok(0))
            }
        }
    }
}
