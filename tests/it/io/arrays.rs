//! NumPy's arrays: files that NumPy wrote, both orders of axes, every width, damage.

use std::path::Path;

use morsmooth::io::{ArrayData, DataArray, DataSet, Extent, Geometry, IoError, losses, read, write};

/// A file as `numpy.save` writes it, version 1.0.
fn npy(descr: &str, fortran: bool, shape: &str, numbers: &[u8]) -> Vec<u8> {
    let fortran = if fortran { "True" } else { "False" };
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes(), numbers].concat()
}

fn read_bytes(bytes: &[u8]) -> Result<DataSet, IoError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npy");
    std::fs::write(&path, bytes).unwrap();
    read(&path)
}

fn extent(dataset: &DataSet) -> [i32; 6] {
    let Geometry::ImageData { extent, .. } = &dataset.geometry else { panic!("{}", dataset.geometry.name()) };
    extent.0
}

#[test]
fn the_last_axis_is_x() {
    let bytes: Vec<u8> = (0..6).flat_map(|number| f64::from(number).to_le_bytes()).collect();
    let rows = read_bytes(&npy("<f8", false, "(2, 3)", &bytes)).unwrap();
    assert_eq!(extent(&rows), [0, 2, 0, 1, 0, 0]);
    assert_eq!(rows.point_array("values").unwrap().data, ArrayData::F64(vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0]));
    // The same array as Fortran lays it out: columns first.
    let columns = read_bytes(&npy("<f8", true, "(2, 3)", &bytes)).unwrap();
    assert_eq!(extent(&columns), extent(&rows));
    assert_eq!(columns.point_array("values").unwrap().data, ArrayData::F64(vec![0.0, 2.0, 4.0, 1.0, 3.0, 5.0]));
    assert_eq!(extent(&read_bytes(&npy("<f8", false, "(6,)", &bytes)).unwrap()), [0, 5, 0, 0, 0, 0]);
    assert_eq!(extent(&read_bytes(&npy("<f8", true, "(1, 2, 3)", &bytes)).unwrap()), [0, 2, 0, 1, 0, 0]);
    let vectors = read_bytes(&npy("<f8", false, "(1, 1, 2, 3)", &bytes)).unwrap();
    assert_eq!((extent(&vectors), vectors.point_data.arrays[0].components), ([0, 1, 0, 0, 0, 0], 3));
}

#[test]
fn every_type_comes_back_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let kinds = [
        ArrayData::I8(vec![-128, 127, 0, 1, 2, 3]),
        ArrayData::U8(vec![255, 0, 1, 2, 3, 4]),
        ArrayData::I16(vec![i16::MIN, 0, 1, 2, 3, 4]),
        ArrayData::U16(vec![u16::MAX, 0, 1, 2, 3, 4]),
        ArrayData::I32(vec![i32::MIN, 0, 1, 2, 3, 4]),
        ArrayData::U32(vec![u32::MAX, 0, 1, 2, 3, 4]),
        ArrayData::I64(vec![i64::MIN, 0, 1, 2, 3, 4]),
        ArrayData::U64(vec![u64::MAX, 0, 1, 2, 3, 4]),
        ArrayData::F32(vec![0.1, -0.0, f32::MIN_POSITIVE, 3.0, f32::INFINITY, 5.0]),
        ArrayData::F64(vec![0.1, -0.0, f64::MIN_POSITIVE, 3.0, f64::NEG_INFINITY, 5.0]),
        ArrayData::Bit(vec![true, false, true, true, false, false]),
    ];
    for data in kinds {
        for (components, dimensions) in [(1, [2, 0, 1, 0, 0, 0]), (1, [0, 5, 0, 0, 0, 0]), (1, [0, 2, 0, 0, 0, 1]), (2, [0, 2, 0, 0, 0, 0])] {
            let dimensions = if dimensions[0] == 2 { [0, 2, 0, 1, 0, 0] } else { dimensions };
            let direction = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
            let geometry = Geometry::ImageData { extent: Extent(dimensions), origin: [0.0; 3], spacing: [1.0; 3], direction };
            let mut dataset = DataSet::new(geometry);
            dataset.set_point_array(DataArray::new("values", components, data.clone()));
            let path = folder.path().join("b.npy");
            assert_eq!(losses(&path, &dataset).unwrap(), Vec::<String>::new());
            write(&path, &dataset).unwrap();
            assert_eq!(read(&path).unwrap(), dataset);
            assert_eq!(std::fs::read(&path).unwrap().iter().position(|&byte| byte == b'\n').unwrap() % 64, 63, "numbers are aligned");
        }
    }
    let big: Vec<u8> = [1.5f32, -2.0].iter().flat_map(|number| number.to_be_bytes()).collect();
    assert_eq!(read_bytes(&npy(">f4", false, "(2,)", &big)).unwrap().point_data.arrays[0].data, ArrayData::F32(vec![1.5, -2.0]));
}

#[test]
fn what_an_array_cannot_hold_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let mut dataset = read_bytes(&npy("|u1", false, "(2, 2)", &[1, 2, 3, 4])).unwrap();
    dataset.set_point_array(DataArray::new("h", 1, ArrayData::F64(vec![1.0; 4])));
    let path = folder.path().join("c.npy");
    let error = losses(&path, &dataset).unwrap_err().to_string();
    assert!(error.contains("one point array of numbers, or one that is the active scalars"), "{error}");
    dataset.point_data.active.push((morsmooth::io::Role::Scalars, "h".into()));
    assert_eq!(losses(&path, &dataset).unwrap(), ["point array \"values\"", "the name \"h\""]);
    let surface = read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/io/files/poly_ascii.vtp")).unwrap();
    assert!(write(&path, &surface).is_err());
    assert!(!path.exists());
}

#[test]
fn damaged_headers_are_refused() {
    let whole = npy("<f8", false, "(2, 3)", &[0; 48]);
    for (bytes, words) in [
        (whole[..9].to_vec(), "no header"),
        (whole[..40].to_vec(), "a header that is cut"),
        (whole[..whole.len() - 1].to_vec(), "47 bytes of numbers; expected 8 bytes for each number of an array [2, 3]"),
        (npy("<f8", false, "(4294967296, 4294967296, 16)", &[0; 8]), "an axis of 4294967296 numbers"),
        (npy("<f8", false, "(2147483647, 2147483647, 2147483647)", &[0; 8]), "8 bytes of numbers"),
        (npy("<f8", false, "(0, 3)", &[]), "at least one number"),
        (npy("<f8", false, "()", &[0; 8]), "an array of 0 axes"),
        (npy("<f8", false, "((((((3", &[0; 8]), "shape"),
        (npy("<c16", false, "(1,)", &[0; 16]), "complex numbers of type \"<c16\""),
        (npy("|O8", false, "(1,)", &[0; 8]), "Python objects of type \"|O8\""),
        (npy("<f8", false, "(-2, 3)", &[0; 48]), "no list of axes as shape"),
    ] {
        let error = read_bytes(&bytes).unwrap_err().to_string();
        assert!(error.contains(words), "{error} lacks {words}");
    }
    // As numpy.save writes an array of objects: without a width.
    let error = read_bytes(&npy("|O", false, "(3,)", &[0x80, 4, 0x4b, 1, 0x2e])).unwrap_err().to_string();
    let words = ", byte 10: Python objects of type \"|O\" cannot be read here; \
        expected integers i1, i2, i4, i8, u1, u2, u4, u8, floats f4, f8, or truth values b1";
    assert!(error.ends_with(words), "{error}");
    let mut version = whole.clone();
    version[6] = 9;
    assert!(read_bytes(&version).unwrap_err().to_string().contains("format version 9"));
}
