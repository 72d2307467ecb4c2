//! `damage [COUNT] [FORMAT]`: reads COUNT damaged files of every format, 10,000 by default, and tells what became of them.
//!
//! Whole files that real VTK wrote (tests/it/io/files) and small ones that are made here are cut, have bits flipped, numbers
//! replaced by huge ones, or parts exchanged and repeated; packed blocks are replaced by bombs that unfold to a thousand times their size.
//! Every one must be refused with a message, or read; none may panic, and none may ask for more memory than
//! `LEAST + FACTOR x length`, packed bytes counted as what their compressor can unfold at most. Exit code 1 otherwise.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use morsmooth::io::{self, CellArray, Collection, DataSet, Geometry, MaskSources};
use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// What any reader may need whatever the file: tables of the parsers and compressors (lzma alone up to 100 MiB of dictionary).
const LEAST: u64 = 1 << 20;
const LZMA_LEAST: u64 = 110 << 20;
/// Bytes of memory a byte of a file that is not packed. Text of many one-digit numbers becomes 8 bytes for two, and the
/// tree of an XML file up to 30 bytes a byte of its shortest elements.
const FACTOR: u64 = 32;

struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % bound.max(1) as u64) as usize
    }
}

/// Whole files of one format.
struct Format {
    name: &'static str,
    extension: &'static str,
    /// Bytes that a packed byte can stand for.
    expansion: u64,
    least: u64,
    wholes: Vec<Vec<u8>>,
}

#[derive(Default)]
struct Tally {
    read: usize,
    refused: usize,
    panics: usize,
    over: usize,
    worst: f64,
    peak: u64,
    slowest: f64,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let count = arguments.first().map_or(10_000, |count| count.parse().expect("usage: damage [COUNT] [FORMAT]"));
    let folder = tempfile::tempdir().unwrap();
    // The files that lists name are whole: damaged is what leads to them.
    for piece in ["sphere_0.vtp", "sphere_1.vtp", "ghosts_0.vtu", "ghosts_1.vtu"] {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/io/files/parallel").join(piece);
        std::fs::copy(from, folder.path().join(piece)).unwrap();
    }
    std::panic::set_hook(Box::new(|_| {}));
    let (mut bad, mut kinds) = (false, BTreeMap::<String, usize>::new());
    println!("{:<22} {:>7} {:>8} {:>7} {:>11} {:>11} {:>9} {:>9}", "format", "read", "refused", "panics", "over bound", "peak MB", "of bound", "slowest s");
    for format in formats().iter().filter(|format| arguments.get(1).is_none_or(|wanted| wanted == format.name)) {
        let mut random = Random(0x9e37_79b9_7f4a_7c15);
        let mut tally = Tally::default();
        for number in 0..count {
            let whole = &format.wholes[number % format.wholes.len()];
            let damaged = damage(whole, number / format.wholes.len(), &mut random);
            let path = folder.path().join(format!("damaged.{}", format.extension));
            std::fs::write(&path, &damaged).unwrap();
            attempt(&path, damaged.len() as u64, format, &mut tally, &mut kinds);
        }
        bad |= tally.panics + tally.over > 0;
        let megabytes = tally.peak as f64 / 1e6;
        println!(
            "{:<22} {:>7} {:>8} {:>7} {:>11} {megabytes:>11.2} {:>8.0}% {:>9.3}",
            format.name, tally.read, tally.refused, tally.panics, tally.over, 100.0 * tally.worst, tally.slowest
        );
    }
    for (kind, count) in kinds {
        println!("{count} x {kind}");
    }
    std::process::exit(i32::from(bad));
}

fn attempt(path: &Path, length: u64, format: &Format, tally: &mut Tally, kinds: &mut BTreeMap<String, usize>) {
    let bound = format.least + FACTOR * length * format.expansion;
    MEMORY.reset_peak_usage();
    let before = MEMORY.current_usage() as u64;
    let begin = Instant::now();
    let result = catch_unwind(AssertUnwindSafe(|| match io::read(path) {
        // Of several data sets in one file, the second.
        Err(error) if format.extension == "vtkhdf" && error.to_string().contains("a collection of") => {
            let _ = Collection::read(path);
            let block = error.to_string().split("damaged.vtkhdf/").nth(1).and_then(|rest| rest.split(' ').next()).map(str::to_owned);
            io::read(path.join(block.filter(|block| block != "0").unwrap_or("1".to_owned())))
        }
        other => other,
    }));
    let peak = (MEMORY.peak_usage() as u64).saturating_sub(before);
    tally.slowest = tally.slowest.max(begin.elapsed().as_secs_f64());
    tally.peak = tally.peak.max(peak);
    tally.worst = tally.worst.max(peak as f64 / bound as f64);
    let mut keep = |kind: String| {
        let copy = std::env::temp_dir().join(format!("damage_{}_{}.{}", format.name.replace([' ', '.'], "_"), kinds.len(), format.extension));
        let _ = std::fs::copy(path, &copy);
        *kinds.entry(format!("{kind} ({})", copy.display())).or_default() += 1;
    };
    if peak > bound {
        tally.over += 1;
        keep(format!("{peak} bytes of memory for {length}"));
    }
    let judged = match result {
        Err(cause) => Err(cause),
        Ok(Err(error)) => {
            assert!(error.to_string().contains("expected") || error.to_string().contains("cannot read"), "{error}");
            tally.refused += 1;
            Ok(())
        }
        Ok(Ok(dataset)) => {
            tally.read += 1;
            catch_unwind(AssertUnwindSafe(|| use_it(&dataset)))
        }
    };
    if let Err(cause) = judged {
        tally.panics += 1;
        let text = cause.downcast_ref::<String>().cloned().or_else(|| cause.downcast_ref::<&str>().map(|text| (*text).to_owned()));
        keep(format!("panic: {}", text.unwrap_or_default()));
    }
}

/// What is read must also be fit for use. A grid without arrays may declare any size; that is what its user asks for.
fn use_it(dataset: &DataSet) {
    if dataset.point_count() < 5000 {
        let _ = io::mask(dataset, &MaskSources::default()).map(|mask| io::domain(dataset, &mask));
    }
}

fn damage(whole: &[u8], round: usize, random: &mut Random) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    match round % 6 {
        0 => bytes.truncate(random.below(whole.len() + 1)),
        1 => {
            for _ in 0..=random.below(4) {
                let place = random.below(bytes.len());
                bytes[place] ^= 1 << random.below(8);
            }
        }
        2 => replace_digits(&mut bytes, random),
        3 => {
            // Headers of binary blocks: all ones, or a huge number in any byte order.
            let place = random.below(bytes.len());
            let end = bytes.len().min(place + [1, 2, 4, 8][random.below(4)]);
            let value = [0xff, 0x7f, 0x00, 0x80][random.below(4)];
            bytes[place..end].fill(value);
        }
        4 => {
            let (from, to) = (random.below(bytes.len()), random.below(bytes.len()));
            let part = bytes[from..bytes.len().min(from + 1 + random.below(64))].to_vec();
            bytes.splice(to..to, part);
        }
        _ => {
            let from = random.below(bytes.len());
            let end = bytes.len().min(from + 1 + random.below(48));
            bytes.drain(from..end);
        }
    }
    bytes
}

fn replace_digits(bytes: &mut Vec<u8>, random: &mut Random) {
    let digits: Vec<usize> = (0..bytes.len()).filter(|&place| bytes[place].is_ascii_digit()).collect();
    if digits.is_empty() {
        return;
    }
    const NUMBERS: [&[u8]; 8] =
        [b"-1", b"0", b"9", b"4294967295", b"2147483647", b"18446744073709551615", b"9223372036854775807", b"1e308"];
    for _ in 0..=random.below(2) {
        let place = digits[random.below(digits.len())].min(bytes.len() - 1);
        bytes.splice(place..=place, NUMBERS[random.below(NUMBERS.len())].iter().copied());
    }
}

fn formats() -> Vec<Format> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/io/files");
    let mut paths: Vec<PathBuf> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_file()).collect();
    paths.sort();
    let with = |extension: &str, part: &str| -> Vec<Vec<u8>> {
        let fits = |path: &&PathBuf| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            name.ends_with(&format!(".{extension}")) && name.contains(part)
        };
        paths.iter().filter(fits).map(|path| std::fs::read(path).unwrap()).collect()
    };
    let plain = |name, extension, wholes| Format { name, extension, expansion: 1, least: LEAST, wholes };
    let packed = |name, extension, expansion, wholes| Format { name, extension, expansion, least: LEAST, wholes };
    // Beside what is damaged, the files of 4 kB that it names.
    let listed = |name, extension, wholes| Format { name, extension, expansion: 1_040, least: LEAST, wholes };
    let mut zlib = with("vti", "zlib");
    zlib.extend([bomb(64, 1 << 20), bomb(1, 1 << 24)]);
    let mut formats = vec![
        plain("vti ascii", "vti", with("vti", "ascii")),
        plain("vti raw", "vti", with("vti", "none")),
        packed("vti zlib", "vti", 1_040, zlib),
        packed("vti lz4", "vti", 256, with("vti", "lz4")),
        Format { name: "vti lzma", extension: "vti", expansion: 1 << 16, least: LZMA_LEAST, wholes: with("vti", "lzma") },
        packed("vtr", "vtr", 1_040, with("vtr", "")),
        packed("vts", "vts", 1_040, with("vts", "")),
        packed("vtp", "vtp", 1_040, with("vtp", "")),
        packed("vtu", "vtu", 1_040, with("vtu", "")),
        plain("vtk ascii", "vtk", with("vtk", "ascii")),
        plain("vtk binary", "vtk", with("vtk", "binary")),
        listed("vtm", "vtm", vec![LIST.replace("NAME", "ghosts_0.vtu").into_bytes()]),
        listed("pvtu", "pvtu", vec![std::fs::read(folder.join("parallel/sphere.pvtp")).unwrap(), std::fs::read(folder.join("parallel/ghosts.pvtu")).unwrap()]),
    ];
    for extension in ["obj", "off", "ply", "stl", "mesh", "msh"] {
        formats.push(plain(extension, extension, vec![mesh(extension)]));
    }
    formats.push(plain("csv", "csv", vec![b"x;y;z\n1;2;3\n2,5;-1;0\n3;4;1e9\n4;;2\n".to_vec(), b"day,a\n2001-01-01,1\n2001-02-01,2\n2001-03-05,1\n".to_vec()]));
    formats.push(plain("npy", "npy", vec![array()]));
    if cfg!(feature = "vtkhdf") {
        let mut paths: Vec<PathBuf> = std::fs::read_dir(folder.join("hdf")).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        let wholes = paths.iter().map(|path| std::fs::read(path).unwrap()).collect();
        formats.push(packed("vtkhdf of VTK", "vtkhdf", 1_040, wholes));
        formats.push(packed("vtkhdf of our own", "vtkhdf", 1_040, own_hdf(&folder)));
    }
    formats.push(packed("png", "png", 1_040, vec![picture()]));
    assert!(Collection::read(folder.join("image_ascii.vti")).unwrap().is_none());
    formats
}

const LIST: &str = "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\"><vtkMultiBlockDataSet><Block index=\"0\" name=\"a\">\
    <DataSet index=\"0\" name=\"b\" file=\"NAME\"/></Block></vtkMultiBlockDataSet></VTKFile>";

/// An image whose packed blocks of zeros unfold a thousandfold, with a small image declared.
fn bomb(blocks: usize, block: usize) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(&vec![0; block]).unwrap();
    let packed = encoder.finish().unwrap();
    let mut data: Vec<u8> = [blocks as u64, block as u64, 0].iter().flat_map(|number| number.to_le_bytes()).collect();
    (0..blocks).for_each(|_| data.extend((packed.len() as u64).to_le_bytes()));
    (0..blocks).for_each(|_| data.extend(&packed));
    let mut file = b"<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\
        <ImageData WholeExtent=\"0 9 0 9 0 0\" Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece Extent=\"0 9 0 9 0 0\"><PointData>\
        <DataArray type=\"Float64\" Name=\"h\" format=\"appended\" offset=\"0\"/></PointData></Piece></ImageData>\
        <AppendedData encoding=\"raw\">_"
        .to_vec();
    file.extend(data);
    file.extend(b"</AppendedData></VTKFile>");
    file
}

/// Our own VTKHDF files of every kind of geometry, plain and packed; their tables are summed, those of VTK are not.
fn own_hdf(folder: &Path) -> Vec<Vec<u8>> {
    let target = tempfile::tempdir().unwrap();
    let path = target.path().join("a.vtkhdf");
    let mut wholes = Vec::new();
    for name in ["image_ascii.vti", "rectilinear_ascii.vtr", "structured_ascii.vts", "poly_ascii.vtp", "polyhedron_ascii.vtu"] {
        let dataset = io::read(folder.join(name)).unwrap();
        for compression in [io::Compression::None, io::Compression::Zlib] {
            io::write_temporary_with(&path, &dataset, compression).unwrap().commit().unwrap();
            wholes.push(std::fs::read(&path).unwrap());
        }
    }
    wholes
}

/// A small surface, or two tetrahedra, in a mesh format.
fn mesh(extension: &str) -> Vec<u8> {
    let points: Vec<f64> = (0..12).flat_map(|i| [f64::from(i % 4), f64::from(i / 4), f64::from(i * i % 5) * 0.25]).collect();
    let points = io::DataArray::new("Points", 3, io::ArrayData::F64(points));
    let mut polys = CellArray::default();
    for (x, y) in [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)] {
        let low = x + 4 * y;
        polys.push([low, low + 1, low + 5]);
        polys.push([low, low + 5, low + 4]);
    }
    let empty = CellArray::default;
    let dataset = match extension {
        "mesh" | "msh" => {
            let types = vec![5; polys.len()];
            DataSet::new(Geometry::UnstructuredGrid { points, cells: polys, types, polyhedra: None })
        }
        _ => DataSet::new(Geometry::PolyData { points, verts: empty(), lines: empty(), polys, strips: empty() }),
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("m.{extension}"));
    io::write(&path, &dataset).unwrap();
    std::fs::read(path).unwrap()
}

fn array() -> Vec<u8> {
    let direction = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let extent = io::Extent([0, 4, 0, 3, 0, 0]);
    let mut dataset = DataSet::new(Geometry::ImageData { extent, origin: [0.0; 3], spacing: [1.0; 3], direction });
    dataset.set_point_array(io::DataArray::new("values", 1, io::ArrayData::F32((0..20).map(|i| i as f32).collect())));
    let folder = tempfile::tempdir().unwrap();
    io::write(folder.path().join("a.npy"), &dataset).unwrap();
    std::fs::read(folder.path().join("a.npy")).unwrap()
}

fn picture() -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/pictures/jet_complex.png");
    let whole = image::open(folder).unwrap().crop_imm(0, 0, 24, 20);
    let mut bytes = std::io::Cursor::new(Vec::new());
    whole.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}
