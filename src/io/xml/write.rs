//! Writes VTK XML: appended raw data with 64-bit headers, which ParaView itself writes by default.

use std::fmt::Write as _;
use std::io::{self, Write};

use rayon::prelude::*;

use crate::io::array::{ArrayData, DataArray, InformationValue};
use crate::io::bytes::{ByteOrder, Element, pack_bits};
use crate::io::dataset::{Attributes, CellArray, DataSet, Geometry, IndexWidth, Polyhedra};
use crate::io::write::Compression;

/// Bytes in a packed block; VTK's default.
const BLOCK: usize = 1 << 15;

/// Writes a data set that [`DataSet`]'s checks accept.
pub(in crate::io) fn write(dataset: &DataSet, compression: Compression, file: &mut impl Write) -> io::Result<()> {
    let mut writer = Writer { text: String::new(), payloads: Vec::new(), offset: 0, compression };
    writer.document(dataset);
    file.write_all(writer.text.as_bytes())?;
    for payload in &writer.payloads {
        match payload {
            Stored::Plain(values) => {
                file.write_all(&(values.byte_length() as u64).to_le_bytes())?;
                values.write(file)?;
            }
            Stored::Packed(bytes) => file.write_all(bytes)?,
        }
    }
    file.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
}

/// Numbers of one array, in whatever form the data set holds them.
enum Values<'a> {
    Data(&'a ArrayData),
    Integers(&'a [i64], IndexWidth),
    Bytes(&'a [u8]),
}

enum Stored<'a> {
    Plain(Values<'a>),
    Packed(Vec<u8>),
}

/// Bytes handed over at a time: as many as the file's own buffer, which they pass by then, and few enough to stay in the cache.
const HANDFUL: usize = 1 << 18;

/// Writes numbers through a buffer that stays in the cache.
fn write_numbers<T: Copy, N: Element>(values: &[T], convert: impl Fn(T) -> N, file: &mut impl Write) -> io::Result<()> {
    let mut buffer = Vec::with_capacity(HANDFUL.min(values.len() * N::WIDTH));
    for chunk in values.chunks(HANDFUL / N::WIDTH) {
        buffer.clear();
        for &value in chunk {
            convert(value).push_bytes(ByteOrder::Little, &mut buffer);
        }
        file.write_all(&buffer)?;
    }
    Ok(())
}

impl Values<'_> {
    fn byte_length(&self) -> usize {
        match self {
            Self::Bytes(bytes) => bytes.len(),
            Self::Integers(values, IndexWidth::Bits32) => values.len() * 4,
            Self::Integers(values, IndexWidth::Bits64) => values.len() * 8,
            Self::Data(data) => match data {
                ArrayData::I8(_) | ArrayData::U8(_) => data.len(),
                ArrayData::I16(_) | ArrayData::U16(_) => data.len() * 2,
                ArrayData::I32(_) | ArrayData::U32(_) | ArrayData::F32(_) => data.len() * 4,
                ArrayData::I64(_) | ArrayData::U64(_) | ArrayData::F64(_) => data.len() * 8,
                ArrayData::Bit(bits) => bits.len().div_ceil(8),
                ArrayData::String(texts) => texts.iter().map(|text| text.len() + 1).sum(),
            },
        }
    }

    fn write(&self, file: &mut impl Write) -> io::Result<()> {
        match self {
            Self::Bytes(bytes) => file.write_all(bytes),
            // The checks before writing make sure that narrow numbers fit.
            Self::Integers(values, IndexWidth::Bits32) => write_numbers(values, |value| value as i32, file),
            Self::Integers(values, IndexWidth::Bits64) => write_numbers(values, |value| value, file),
            Self::Data(data) => match data {
                ArrayData::I8(values) => write_numbers(values, |value| value, file),
                ArrayData::U8(values) => file.write_all(values),
                ArrayData::I16(values) => write_numbers(values, |value| value, file),
                ArrayData::U16(values) => write_numbers(values, |value| value, file),
                ArrayData::I32(values) => write_numbers(values, |value| value, file),
                ArrayData::U32(values) => write_numbers(values, |value| value, file),
                ArrayData::I64(values) => write_numbers(values, |value| value, file),
                ArrayData::U64(values) => write_numbers(values, |value| value, file),
                ArrayData::F32(values) => write_numbers(values, |value| value, file),
                ArrayData::F64(values) => write_numbers(values, |value| value, file),
                ArrayData::Bit(bits) => file.write_all(&pack_bits(bits)),
                ArrayData::String(texts) => {
                    for text in texts {
                        file.write_all(text)?;
                        file.write_all(&[0])?;
                    }
                    Ok(())
                }
            },
        }
    }

    /// Header and packed blocks. Blocks are packed apart, so the bytes do not depend on the number of threads.
    fn pack(&self) -> io::Result<Vec<u8>> {
        let mut plain = Vec::with_capacity(self.byte_length());
        self.write(&mut plain)?;
        let blocks: Vec<Vec<u8>> = plain
            .par_chunks(BLOCK)
            .map(|block| {
                let mut packer = flate2::write::ZlibEncoder::new(Vec::with_capacity(BLOCK), flate2::Compression::fast());
                packer.write_all(block)?;
                packer.finish()
            })
            .collect::<io::Result<_>>()?;
        // In VTK's table a last block of 0 bytes means a full one.
        let header = [blocks.len(), BLOCK, plain.len() % BLOCK];
        let lengths = blocks.iter().map(Vec::len);
        let mut packed: Vec<u8> = header.into_iter().chain(lengths).flat_map(|number| (number as u64).to_le_bytes()).collect();
        packed.extend(blocks.into_iter().flatten());
        Ok(packed)
    }
}

struct Writer<'a> {
    text: String,
    payloads: Vec<Stored<'a>>,
    offset: usize,
    compression: Compression,
}

/// Text with everything escaped that an XML attribute or element cannot hold.
struct Escaped<'a>(&'a str);

impl std::fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for character in self.0.chars() {
            match character {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '"' => f.write_str("&quot;")?,
                // A parser turns plain line ends and tabs in attributes into blanks.
                '\n' | '\r' | '\t' => write!(f, "&#{};", character as u32)?,
                other => f.write_char(other)?,
            }
        }
        Ok(())
    }
}

/// The text of an element; blanks at its ends are part of it, which readers would drop if they stood as they are.
struct Content<'a>(&'a str);

impl std::fmt::Display for Content<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let behind = self.0.trim_start_matches(' ');
        let middle = behind.trim_end_matches(' ');
        let blanks = |count: usize| "&#32;".repeat(count);
        write!(f, "{}{}{}", blanks(self.0.len() - behind.len()), Escaped(middle), blanks(behind.len() - middle.len()))
    }
}

/// Numbers with blanks between them, in the shortest form that reads back to the same bits.
fn list<T: std::fmt::Debug>(numbers: &[T]) -> String {
    numbers.iter().map(|number| format!("{number:?}")).collect::<Vec<_>>().join(" ")
}

impl<'a> Writer<'a> {
    fn document(&mut self, dataset: &'a DataSet) {
        let kind = dataset.geometry.name();
        let [major, minor] = self.version(dataset);
        let compressor = match self.compression {
            Compression::None => "",
            Compression::Zlib => " compressor=\"vtkZLibDataCompressor\"",
        };
        self.push(&format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"{major}.{minor}\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\"{compressor}>\n"
        ));
        let piece = match &dataset.geometry {
            Geometry::ImageData { extent, origin, spacing, direction } => {
                let extent = list(&extent.0);
                self.push(&format!(
                    "  <{kind} WholeExtent=\"{extent}\" Origin=\"{}\" Spacing=\"{}\" Direction=\"{}\">\n",
                    list(origin),
                    list(spacing),
                    list(direction)
                ));
                format!("Extent=\"{extent}\"")
            }
            Geometry::RectilinearGrid { extent, .. } | Geometry::StructuredGrid { extent, .. } => {
                let extent = list(&extent.0);
                self.push(&format!("  <{kind} WholeExtent=\"{extent}\">\n"));
                format!("Extent=\"{extent}\"")
            }
            Geometry::PolyData { verts, lines, polys, strips, .. } => {
                self.push(&format!("  <{kind}>\n"));
                format!(
                    "NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"{}\" NumberOfPolys=\"{}\"",
                    dataset.point_count(),
                    verts.len(),
                    lines.len(),
                    strips.len(),
                    polys.len()
                )
            }
            Geometry::UnstructuredGrid { cells, .. } => {
                self.push(&format!("  <{kind}>\n"));
                format!("NumberOfPoints=\"{}\" NumberOfCells=\"{}\"", dataset.point_count(), cells.len())
            }
        };
        if !dataset.field_data.is_empty() {
            self.push("    <FieldData>\n");
            for array in &dataset.field_data {
                self.array(array, true);
            }
            self.push("    </FieldData>\n");
        }
        self.push(&format!("    <Piece {piece}>\n"));
        self.attributes("PointData", &dataset.point_data);
        self.attributes("CellData", &dataset.cell_data);
        self.geometry(&dataset.geometry);
        self.push(&format!("    </Piece>\n  </{kind}>\n  <AppendedData encoding=\"raw\">\n   _"));
    }

    /// The version of the input where the order of points in higher-order cells hangs on it, 2.3 for its polyhedra,
    /// else 1.0: the oldest that knows 64-bit headers.
    fn version(&self, dataset: &DataSet) -> [u32; 2] {
        match &dataset.geometry {
            Geometry::UnstructuredGrid { polyhedra: Some(Polyhedra::Lists { .. }), .. } => [2, 3],
            Geometry::UnstructuredGrid { .. } => dataset.version.map_or([1, 0], |version| version.max([1, 0])),
            _ => [1, 0],
        }
    }

    fn geometry(&mut self, geometry: &'a Geometry) {
        match geometry {
            Geometry::ImageData { .. } => {}
            Geometry::RectilinearGrid { coordinates, .. } => {
                self.push("      <Coordinates>\n");
                for array in coordinates.iter() {
                    self.array(array, false);
                }
                self.push("      </Coordinates>\n");
            }
            Geometry::StructuredGrid { points, .. } => self.points(points),
            Geometry::PolyData { points, verts, lines, polys, strips } => {
                self.points(points);
                for (name, cells) in [("Verts", verts), ("Lines", lines), ("Strips", strips), ("Polys", polys)] {
                    self.push(&format!("      <{name}>\n"));
                    self.lists(["connectivity", "offsets"], cells);
                    self.push(&format!("      </{name}>\n"));
                }
            }
            Geometry::UnstructuredGrid { points, cells, types, polyhedra } => {
                self.points(points);
                self.push("      <Cells>\n");
                self.lists(["connectivity", "offsets"], cells);
                self.plain("UInt8", "types", Values::Bytes(types));
                match polyhedra {
                    None => {}
                    Some(Polyhedra::Stream { faces, offsets, width }) => {
                        self.integers("faces", faces, *width);
                        self.integers("faceoffsets", offsets, *width);
                    }
                    Some(Polyhedra::Lists { faces, cells }) => {
                        self.lists(["face_connectivity", "face_offsets"], faces);
                        self.lists(["polyhedron_to_faces", "polyhedron_offsets"], cells);
                    }
                }
                self.push("      </Cells>\n");
            }
        }
    }

    fn points(&mut self, points: &'a DataArray) {
        self.push("      <Points>\n");
        self.array(points, false);
        self.push("      </Points>\n");
    }

    fn lists(&mut self, [members, ends]: [&str; 2], lists: &'a CellArray) {
        self.integers(members, &lists.connectivity, lists.width);
        self.integers(ends, lists.offsets.get(1..).unwrap_or_default(), lists.width);
    }

    fn integers(&mut self, name: &str, values: &'a [i64], width: IndexWidth) {
        let type_name = match width {
            IndexWidth::Bits32 => "Int32",
            IndexWidth::Bits64 => "Int64",
        };
        self.plain(type_name, name, Values::Integers(values, width));
    }

    fn attributes(&mut self, element: &str, attributes: &'a Attributes) {
        self.push(&format!("      <{element}"));
        for (role, name) in &attributes.active {
            self.push(&format!(" {}=\"{}\"", role.name(), Escaped(name)));
        }
        self.push(">\n");
        for array in &attributes.arrays {
            self.array(array, false);
        }
        self.push(&format!("      </{element}>\n"));
    }

    fn plain(&mut self, type_name: &str, name: &str, values: Values<'a>) {
        let offset = self.offset;
        self.push(&format!("        <DataArray type=\"{type_name}\" Name=\"{name}\" format=\"appended\" offset=\"{offset}\"/>\n"));
        self.store(values);
    }

    fn array(&mut self, array: &'a DataArray, counted: bool) {
        let type_name = array.data.value_type().xml_name();
        let element = if matches!(array.data, ArrayData::String(_)) { "Array" } else { "DataArray" };
        self.push(&format!("        <{element} type=\"{type_name}\""));
        if array.id_type {
            self.push(" IdType=\"1\"");
        }
        self.push(&format!(" Name=\"{}\" NumberOfComponents=\"{}\"", Escaped(&array.name), array.components));
        for (component, name) in array.component_names.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
            self.push(&format!(" ComponentName{component}=\"{}\"", Escaped(name)));
        }
        if counted {
            self.push(&format!(" NumberOfTuples=\"{}\"", array.tuples()));
        }
        self.push(&format!(" format=\"appended\" offset=\"{}\"", self.offset));
        self.store(Values::Data(&array.data));
        if array.information.is_empty() {
            self.push("/>\n");
            return;
        }
        self.push(">\n");
        for key in &array.information {
            self.push(&format!(
                "          <InformationKey name=\"{}\" location=\"{}\"",
                Escaped(&key.name),
                Escaped(&key.location)
            ));
            match &key.value {
                InformationValue::Single(value) => self.push(&format!(">{}</InformationKey>\n", Content(value))),
                InformationValue::List(values) => {
                    self.push(&format!(" length=\"{}\">\n", values.len()));
                    for (index, value) in values.iter().enumerate() {
                        self.push(&format!("            <Value index=\"{index}\">{}</Value>\n", Content(value)));
                    }
                    self.push("          </InformationKey>\n");
                }
            }
        }
        self.push(&format!("        </{element}>\n"));
    }

    fn store(&mut self, values: Values<'a>) {
        let packed = match self.compression {
            Compression::None => None,
            Compression::Zlib => values.pack().ok(),
        };
        let stored = packed.map_or(Stored::Plain(values), Stored::Packed);
        self.offset += match &stored {
            Stored::Plain(values) => 8 + values.byte_length(),
            Stored::Packed(bytes) => bytes.len(),
        };
        self.payloads.push(stored);
    }

    fn push(&mut self, text: &str) {
        self.text.push_str(text);
    }
}
