//! The frame of an XML file: where its text ends, its byte order, header width, compressor and appended bytes.

use std::borrow::Cow;
use std::fs::File;

use roxmltree::{Document, Node, ParsingOptions};

use crate::io::bytes::ByteOrder;
use crate::io::error::{Fault, Place, quoted};

/// How blocks are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Compressor {
    None,
    Zlib,
    Lz4,
    Lzma,
}

/// The file, in memory or still on disk.
#[derive(Debug, Clone, Copy)]
pub(in crate::io) enum Source<'a> {
    Memory(&'a [u8]),
    /// A large file, from which each array is read when it is its turn, so that nothing is in memory twice.
    File {
        file: &'a File,
        length: usize,
    },
}

impl<'a> Source<'a> {
    pub fn length(&self) -> usize {
        match self {
            Self::Memory(bytes) => bytes.len(),
            Self::File { length, .. } => *length,
        }
    }

    /// The bytes of a range.
    pub fn bytes(&self, start: usize, count: usize) -> Result<Cow<'a, [u8]>, Fault> {
        let available = self.length().saturating_sub(start);
        if count > available {
            return Err(Fault::new(Place::Byte(start), format!("{available} bytes before the end"), format!("{count}")));
        }
        match self {
            Self::Memory(bytes) => Ok(Cow::Borrowed(&bytes[start..start + count])),
            Self::File { .. } => {
                let mut bytes = vec![0; count];
                self.read_at(start, &mut bytes)?;
                Ok(Cow::Owned(bytes))
            }
        }
    }

    /// Fills a buffer with the bytes from a place on. Threads may read at the same time.
    pub fn read_at(&self, start: usize, buffer: &mut [u8]) -> Result<(), Fault> {
        match self {
            Self::Memory(bytes) => match bytes.get(start..).and_then(|bytes| bytes.get(..buffer.len())) {
                Some(bytes) => {
                    buffer.copy_from_slice(bytes);
                    Ok(())
                }
                None => Err(Fault::new(Place::Byte(start), "the end of the file", format!("{} bytes", buffer.len()))),
            },
            Self::File { file, .. } => {
                let failed = |error| Fault::new(Place::Byte(start), format!("an error of the disk ({error})"), "bytes");
                read_exact_at(file, start as u64, buffer).map_err(failed)
            }
        }
    }
}

#[cfg(unix)]
fn read_exact_at(file: &File, start: u64, buffer: &mut [u8]) -> std::io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, buffer, start)
}

/// Where a file has one place for all threads, each takes a turn.
#[cfg(not(unix))]
fn read_exact_at(mut file: &File, start: u64, buffer: &mut [u8]) -> std::io::Result<()> {
    use std::io::{Read, Seek, SeekFrom};
    static TURN: std::sync::Mutex<()> = std::sync::Mutex::new(());
    let _turn = TURN.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    file.seek(SeekFrom::Start(start))?;
    file.read_exact(buffer)
}

/// What follows the `_` of `<AppendedData>`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Appended<'a> {
    pub source: Source<'a>,
    /// Its place in the file.
    pub start: usize,
    pub base64: bool,
}

const APPENDED: &[u8] = b"<AppendedData";

/// Whether `head` reaches into appended raw data, so that the rest of the file need not be in memory.
pub(in crate::io) fn reaches_raw_data(head: &[u8]) -> bool {
    find(head, APPENDED).is_some_and(|tag| {
        let opening = &head[tag..];
        let end = opening.iter().position(|&byte| byte == b'>').unwrap_or(0);
        find(&opening[..end], b"raw").is_some() && opening[end..].contains(&b'_')
    })
}

/// A file cut into XML text and appended bytes.
pub(super) struct Parts<'a> {
    pub text: Cow<'a, str>,
    pub appended: Option<Appended<'a>>,
}

impl<'a> Parts<'a> {
    /// Cuts at `<AppendedData`, because raw bytes behind it are no XML, and closes the document.
    ///
    /// # Arguments
    /// * `head`: the whole file, or as much as [`reaches_raw_data`].
    /// * `source`: the whole file.
    pub fn cut(head: &'a [u8], source: Source<'a>) -> Result<Self, Fault> {
        let Some(tag) = find(head, APPENDED) else {
            return Ok(Self { text: Cow::Borrowed(utf8(head)?), appended: None });
        };
        let opening = &head[tag..];
        let fault = |found: &str, expected: &str| Fault::new(Place::Byte(tag), found, expected);
        let end = opening
            .iter()
            .position(|&byte| byte == b'>')
            .ok_or_else(|| fault("an <AppendedData that is not closed", "a >"))?;
        let attributes = utf8(&opening[APPENDED.len()..end])?;
        let base64 = if attributes.contains("\"raw\"") || attributes.contains("'raw'") {
            false
        } else if attributes.contains("base64") || !attributes.contains("encoding") {
            true
        } else {
            return Err(fault(&format!("appended data with{attributes}"), "encoding=\"raw\" or \"base64\""));
        };
        let mark = opening[end..]
            .iter()
            .position(|&byte| byte == b'_')
            .ok_or_else(|| fault("appended data without the mark _", "a _ before the data"))?;
        let start = tag + end + mark + 1;
        let text = format!("{}</VTKFile>", utf8(&head[..tag])?);
        Ok(Self { text: Cow::Owned(text), appended: Some(Appended { source, start, base64 }) })
    }

    /// Parses the text.
    pub fn parse(&self) -> Result<Document<'_>, Fault> {
        // The limit keeps a file of tiny elements from growing a hundredfold in memory.
        let options = ParsingOptions { nodes_limit: 4_000_000, ..ParsingOptions::default() };
        Document::parse_with_options(&self.text, options)
            .map_err(|error| Fault::new(Place::Line(error.pos().row as usize), format!("broken XML ({error})"), "well-formed XML"))
    }
}

/// First place of `needle` in `bytes`.
fn find(bytes: &[u8], needle: &[u8]) -> Option<usize> {
    let mut from = 0;
    while let Some(step) = bytes[from..].iter().position(|&byte| byte == needle[0]) {
        from += step;
        if bytes[from..].starts_with(needle) {
            return Some(from);
        }
        from += 1;
    }
    None
}

fn utf8(bytes: &[u8]) -> Result<&str, Fault> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        Fault::new(Place::Byte(error.valid_up_to()), "a byte that is not UTF-8", "text in UTF-8 before the appended data")
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// What every array of the file needs to be decoded.
pub(super) struct Context<'a> {
    pub text: &'a str,
    pub appended: Option<Appended<'a>>,
    pub order: ByteOrder,
    /// 4 or 8 bytes.
    pub header_width: usize,
    pub compressor: Compressor,
    pub version: [u32; 2],
}

impl<'a> Context<'a> {
    pub fn new(parts: &'a Parts<'a>, root: Node<'_, '_>) -> Result<Self, Fault> {
        let mut context = Self {
            text: &parts.text,
            appended: parts.appended,
            order: ByteOrder::Little,
            header_width: 4,
            compressor: Compressor::None,
            version: [0, 1],
        };
        let unsupported = |name: &str, found: &str, expected: &str| {
            Fault::unsupported(context.place(root), format!("{name}={}", quoted(found)), expected)
        };
        let order = match root.attribute("byte_order") {
            None | Some("LittleEndian") => ByteOrder::Little,
            Some("BigEndian") => ByteOrder::Big,
            Some(other) => return Err(unsupported("byte_order", other, "LittleEndian or BigEndian")),
        };
        let header_width = match root.attribute("header_type") {
            None | Some("UInt32") => 4,
            Some("UInt64") => 8,
            Some(other) => return Err(unsupported("header_type", other, "UInt32 or UInt64")),
        };
        let compressor = match root.attribute("compressor") {
            None | Some("") => Compressor::None,
            Some("vtkZLibDataCompressor") => Compressor::Zlib,
            Some("vtkLZ4DataCompressor") => Compressor::Lz4,
            Some("vtkLZMADataCompressor") => Compressor::Lzma,
            Some(other) => {
                return Err(unsupported("compressor", other, "vtkZLib-, vtkLZ4- or vtkLZMADataCompressor"));
            }
        };
        let version = match root.attribute("version") {
            None => [0, 1],
            Some(text) => version(text).ok_or_else(|| unsupported("version", text, "a version such as 1.0"))?,
        };
        if version[0] > 2 {
            return Err(unsupported("version", root.attribute("version").unwrap_or_default(), "version 0.1 to 2.x"));
        }
        (context.order, context.header_width) = (order, header_width);
        (context.compressor, context.version) = (compressor, version);
        Ok(context)
    }

    /// The line of an element.
    pub fn place(&self, node: Node<'_, '_>) -> Place {
        self.line(node.range().start)
    }

    /// The line of a byte of the text.
    pub fn line(&self, position: usize) -> Place {
        let before = &self.text.as_bytes()[..position.min(self.text.len())];
        Place::Line(before.iter().filter(|&&byte| byte == b'\n').count() + 1)
    }

    /// A header number.
    pub fn header_number(&self, bytes: &[u8]) -> u64 {
        let fold = |sum: u64, &byte: &u8| sum << 8 | u64::from(byte);
        match self.order {
            ByteOrder::Little => bytes.iter().rev().fold(0, fold),
            ByteOrder::Big => bytes.iter().fold(0, fold),
        }
    }

    /// An attribute as a number.
    pub fn number<T: std::str::FromStr>(&self, node: Node<'_, '_>, name: &str) -> Result<Option<T>, Fault> {
        node.attribute(name)
            .map(|text| {
                text.trim().parse().map_err(|_| {
                    Fault::new(self.place(node), format!("{name}={}", quoted(text)), format!("a number within range as {name}"))
                })
            })
            .transpose()
    }

    /// An attribute as `N` numbers.
    pub fn numbers<T: std::str::FromStr, const N: usize>(
        &self,
        node: Node<'_, '_>,
        name: &str,
    ) -> Result<Option<[T; N]>, Fault> {
        let Some(text) = node.attribute(name) else { return Ok(None) };
        let parsed: Result<Vec<T>, _> = text.split_ascii_whitespace().map(str::parse).collect();
        match parsed.ok().and_then(|numbers| numbers.try_into().ok()) {
            Some(numbers) => Ok(Some(numbers)),
            None => Err(Fault::new(self.place(node), format!("{name}={}", quoted(text)), format!("{N} numbers as {name}"))),
        }
    }
}

fn version(text: &str) -> Option<[u32; 2]> {
    let (major, minor) = text.trim().split_once('.').unwrap_or((text.trim(), "0"));
    Some([major.parse().ok()?, minor.parse().ok()?])
}
