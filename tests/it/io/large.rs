//! Files of more than 4 MB, whose plain arrays are read from the disk in parallel, against the same bytes read in one go.

use morsmooth::io::{ArrayData, DataSet, read};

/// Points; no multiple of what one thread reads at a time.
const COUNT: usize = 200_001;
/// The file is larger than this, or the other path would be tested.
const LARGE: usize = 1 << 22;

/// Bits without a pattern.
fn bits(place: usize) -> u64 {
    let mut bits = (place as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits ^= bits >> 29;
    bits.wrapping_mul(0xbf58_476d_1ce4_e5b9)
}

/// Arrays of every width, and their bytes.
fn arrays(is_big: bool) -> Vec<(&'static str, ArrayData, Vec<u8>)> {
    let mut arrays = Vec::new();
    macro_rules! array {
        ($kind:ident, $number:ty, $name:literal, $of:expr) => {
            let values: Vec<$number> = (0..COUNT).map(|place| $of(bits(place))).collect();
            let bytes = values.iter().flat_map(|value| if is_big { value.to_be_bytes() } else { value.to_le_bytes() }).collect();
            arrays.push(($name, ArrayData::$kind(values), bytes));
        };
    }
    array!(F64, f64, "Float64", |bits: u64| (bits as i64 >> 11) as f64 * 0.125);
    array!(F32, f32, "Float32", |bits: u64| (bits as i32 >> 8) as f32 * 0.25);
    array!(I64, i64, "Int64", |bits: u64| bits as i64);
    array!(U32, u32, "UInt32", |bits: u64| bits as u32);
    array!(I16, i16, "Int16", |bits: u64| bits as i16);
    array!(U8, u8, "UInt8", |bits: u64| bits as u8);
    arrays
}

/// The text before the arrays, where each array begins with its length, and all bytes of the file.
fn image(is_big: bool) -> (Vec<usize>, Vec<u8>) {
    let last = COUNT - 1;
    let order = if is_big { "BigEndian" } else { "LittleEndian" };
    let mut text = format!(
        "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"{order}\" header_type=\"UInt64\">\n\
         <ImageData WholeExtent=\"0 {last} 0 0 0 0\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\n<Piece Extent=\"0 {last} 0 0 0 0\">\n<PointData>\n"
    );
    let (mut data, mut starts) = (Vec::new(), Vec::new());
    for (name, _, bytes) in arrays(is_big) {
        text += &format!("<DataArray type=\"{name}\" Name=\"{name}\" format=\"appended\" offset=\"{}\"/>\n", data.len());
        starts.push(data.len());
        let length = bytes.len() as u64;
        data.extend(if is_big { length.to_be_bytes() } else { length.to_le_bytes() });
        data.extend(bytes);
    }
    text += "</PointData>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">_";
    starts.iter_mut().for_each(|start| *start += text.len());
    let mut file = text.into_bytes();
    file.extend(data);
    file.extend(b"</AppendedData></VTKFile>");
    assert!(file.len() > LARGE);
    (starts, file)
}

fn check(dataset: &DataSet, is_big: bool) {
    for (name, values, _) in arrays(is_big) {
        let array = dataset.point_array(name).unwrap();
        // Not assert_eq, which would print a hundred thousand numbers.
        assert!(array.data == values, "{name}, big-endian: {is_big}");
    }
    assert_eq!(dataset.point_data.arrays.len(), 6);
}

#[test]
fn large_files_of_both_byte_orders_hold_the_values_that_were_put_in() {
    let folder = tempfile::tempdir().unwrap();
    for is_big in [false, true] {
        let path = folder.path().join("large.vti");
        std::fs::write(&path, image(is_big).1).unwrap();
        check(&read(&path).unwrap(), is_big);
    }
}

#[test]
fn a_large_file_that_is_cut_names_the_array_that_is_not_whole() {
    let folder = tempfile::tempdir().unwrap();
    let (starts, whole) = image(false);
    let end = whole.len() - b"</AppendedData></VTKFile>".len();
    for length in [end - 1, end - 70_000, starts[5] + 8, starts[5] - 1] {
        assert!(length > LARGE);
        let path = folder.path().join("cut.vti");
        std::fs::write(&path, &whole[..length]).unwrap();
        let message = read(&path).unwrap_err().to_string();
        let (array, width) = if length < starts[5] { (4, 2) } else { (5, 1) };
        let name = ["Float64", "Float32", "Int64", "UInt32", "Int16", "UInt8"][array];
        let there = length - starts[array] - 8;
        let expected = format!(
            "{}, byte {}: found an array of {} bytes in array \"{name}\"; expected at most the {there} that follow",
            path.display(),
            starts[array],
            COUNT * width
        );
        assert_eq!(message, expected);
    }
}

/// A pipe has no length and is read from its beginning to its end, whatever its size.
#[cfg(unix)]
fn read_from_pipe(folder: &std::path::Path, bytes: &[u8]) -> Result<DataSet, String> {
    let path = folder.join("pipe.vti");
    let _ = std::fs::remove_file(&path);
    assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
    std::thread::scope(|scope| {
        // The reader may stop before the end.
        scope.spawn(|| std::fs::write(&path, bytes));
        read(&path).map_err(|error| error.to_string().replace(path.to_str().unwrap(), "FILE"))
    })
}

#[test]
#[cfg(unix)]
fn a_file_and_a_pipe_with_the_same_bytes_give_the_same_values_or_the_same_error() {
    let folder = tempfile::tempdir().unwrap();
    for is_big in [false, true] {
        let (starts, whole) = image(is_big);
        check(&read_from_pipe(folder.path(), &whole).unwrap(), is_big);
        let mut lying = whole.clone();
        // A length that no file can have, and one that is no multiple of the width.
        lying[starts[1]..starts[1] + 8].fill(0x7f);
        let mut odd = whole.clone();
        let length = (COUNT * 8 - 3) as u64;
        odd[starts[0]..starts[0] + 8].copy_from_slice(&if is_big { length.to_be_bytes() } else { length.to_le_bytes() });
        let cuts = [whole.len() - 30, starts[5] + 100, starts[5] + 3, LARGE + 1].map(|length| whole[..length].to_vec());
        for bytes in cuts.into_iter().chain([lying, odd]) {
            let path = folder.path().join("file.vti");
            std::fs::write(&path, &bytes).unwrap();
            let from_file = read(&path).unwrap_err().to_string().replace(path.to_str().unwrap(), "FILE");
            assert_eq!(from_file, read_from_pipe(folder.path(), &bytes).unwrap_err());
            assert!(from_file.contains("expected"), "{from_file}");
        }
    }
}
