//! What is read, written and read again is the same, bit for bit.

use morsmooth::io::{
    ArrayData, Compression, DataArray, DataSet, Extent, Geometry, InformationKey, InformationValue, Role, read, write,
    write_temporary_with,
};

use super::{content, file, files};

#[test]
fn every_file_survives_xml() {
    let folder = tempfile::tempdir().unwrap();
    for path in files() {
        let dataset = read(&path).unwrap();
        for compression in [Compression::None, Compression::Zlib] {
            let copy = folder.path().join("copy").with_extension(dataset.geometry.extension());
            write_temporary_with(&copy, &dataset, compression).unwrap().commit().unwrap();
            assert_eq!(content(&read(&copy).unwrap()), content(&dataset), "{}", path.display());
        }
    }
}

#[test]
fn every_file_survives_legacy_but_for_the_order_of_arrays() {
    let folder = tempfile::tempdir().unwrap();
    for path in files() {
        let dataset = read(&path).unwrap();
        let copy = folder.path().join("copy.vtk");
        match write(&copy, &dataset) {
            Ok(()) => {}
            Err(error) => {
                assert!(error.to_string().contains("found an image with rotated axes"), "{error}");
                continue;
            }
        }
        let again = read(&copy).unwrap();
        for array in &dataset.point_data.arrays {
            assert_eq!(again.point_array(&array.name), Some(array), "{}", path.display());
        }
        assert_eq!(again.cell_data, dataset.cell_data, "{}", path.display());
        assert_eq!(again.field_data, dataset.field_data, "{}", path.display());
        assert_eq!(again.points_f64(), dataset.points_f64(), "{}", path.display());
        assert_eq!(again.point_data.active, dataset.point_data.active);
    }
}

/// An image with `n` points in a row.
fn row(n: i32) -> DataSet {
    DataSet::new(Geometry::ImageData {
        extent: Extent([0, n - 1, 0, 0, 0, 0]),
        origin: [0.1 + 0.2, 1e300, -0.0],
        spacing: [1.0 / 3.0, f64::MIN_POSITIVE, 5e-324],
        direction: [0.6, 0.8, 0.0, -0.8, 0.6, 0.0, 0.0, 0.0, 1.0],
    })
}

#[test]
fn names_that_xml_would_break_on_are_escaped() {
    let mut dataset = row(2);
    let name = "a<b> & \"c\" 'd'\n\té ρ %20";
    let mut array = DataArray::new(name, 2, ArrayData::F64(vec![1.0, f64::NAN, f64::NEG_INFINITY, -0.0]));
    array.component_names = vec!["<re>".into(), String::new()];
    array.information = vec![
        InformationKey { name: "UNITS_LABEL".into(), location: "vtkDataArray".into(), value: InformationValue::Single("m<s".into()) },
        InformationKey {
            name: "LIST".into(),
            location: "mine".into(),
            value: InformationValue::List(vec!["1".into(), "a&b".into()]),
        },
    ];
    dataset.set_point_array(array);
    dataset.point_data.active.push((Role::Scalars, name.into()));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("names.vti");
    write(&path, &dataset).unwrap();
    assert_eq!(content(&read(&path).unwrap()), content(&dataset));
}

#[test]
fn a_name_with_blanks_survives_legacy() {
    let mut dataset = row(2);
    if let Geometry::ImageData { direction, .. } = &mut dataset.geometry {
        *direction = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    }
    dataset.set_point_array(DataArray::new("a b % \"ρ\"", 1, ArrayData::F64(vec![1.0, f64::NAN])));
    let texts = vec![b"".to_vec(), vec![b'x'; 70]];
    dataset.set_point_array(DataArray::new("texts", 1, ArrayData::String(texts)));
    let long = ArrayData::String(vec![vec![b'y'; 20_000]]);
    dataset.field_data.push(DataArray::new("long text", 1, long));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("names.vtk");
    write(&path, &dataset).unwrap();
    assert_eq!(content(&read(&path).unwrap()), content(&dataset));
}

#[test]
fn every_bit_pattern_of_a_float_survives() {
    let patterns: Vec<u64> = (0..4096u64).map(|step| step.wrapping_mul(0x9E37_79B9_7F4A_7C15)).collect();
    let mut dataset = row(4096);
    dataset.set_point_array(DataArray::new("f64", 1, ArrayData::F64(patterns.iter().map(|&bits| f64::from_bits(bits)).collect())));
    dataset.set_point_array(DataArray::new("f32", 1, ArrayData::F32(patterns.iter().map(|&bits| f32::from_bits(bits as u32)).collect())));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bits.vti");
    for compression in [Compression::None, Compression::Zlib] {
        write_temporary_with(&path, &dataset, compression).unwrap().commit().unwrap();
        let again = read(&path).unwrap();
        let ArrayData::F64(values) = &again.point_array("f64").unwrap().data else { panic!("no f64") };
        assert!(values.iter().zip(&patterns).all(|(value, &bits)| value.to_bits() == bits));
        let ArrayData::F32(values) = &again.point_array("f32").unwrap().data else { panic!("no f32") };
        assert!(values.iter().zip(&patterns).all(|(value, &bits)| value.to_bits() == bits as u32));
    }
}

#[test]
fn packed_bytes_do_not_depend_on_the_number_of_threads() {
    let mut dataset = row(100_000);
    let values = (0..100_000).map(|step| f64::from(step).sin()).collect();
    dataset.set_point_array(DataArray::new("wave", 1, ArrayData::F64(values)));
    let folder = tempfile::tempdir().unwrap();
    let bytes = |threads: usize| {
        let path = folder.path().join(format!("{threads}.vti"));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| write_temporary_with(&path, &dataset, Compression::Zlib).unwrap().commit().unwrap());
        std::fs::read(path).unwrap()
    };
    assert_eq!(bytes(1), bytes(4));
    assert_eq!(content(&read(folder.path().join("1.vti")).unwrap()), content(&dataset));
}

#[test]
fn setting_an_array_keeps_its_place() {
    let mut dataset = read(file("image_ascii.vti")).unwrap();
    let names = |dataset: &DataSet| dataset.point_data.arrays.iter().map(|array| array.name.clone()).collect::<Vec<_>>();
    let before = names(&dataset);
    dataset.set_point_array(DataArray::new("speed", 1, ArrayData::F32(vec![0.0; 9])));
    assert_eq!(names(&dataset), before);
    dataset.set_point_array(DataArray::new("speed_smooth", 1, ArrayData::F32(vec![0.0; 9])));
    assert_eq!(names(&dataset).last().unwrap(), "speed_smooth");
    assert_eq!(names(&dataset).len(), before.len() + 1);
}

#[test]
fn large_files_are_read_from_disk_array_by_array() {
    let n = 300_000;
    let mut dataset = row(n);
    dataset.set_point_array(DataArray::new("wave", 1, ArrayData::F64((0..n).map(|step| f64::from(step).sin()).collect())));
    dataset.set_point_array(DataArray::new("pair", 2, ArrayData::U16((0..2 * n).map(|step| step as u16).collect())));
    dataset.set_point_array(DataArray::new("odd", 1, ArrayData::Bit((0..n).map(|step| step % 2 == 1).collect())));
    dataset.set_point_array(DataArray::new("names", 1, ArrayData::String((0..n).map(|step| format!("{step}").into_bytes()).collect())));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.vti");
    for compression in [Compression::None, Compression::Zlib] {
        write_temporary_with(&path, &dataset, compression).unwrap().commit().unwrap();
        // Not compared as text, which would take seconds; there is no NaN.
        let again = DataSet { version: None, ..read(&path).unwrap() };
        assert!(again == dataset, "{compression:?}");
    }
    write(&path, &dataset).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() - 1_000_000]).unwrap();
    let error = read(&path).unwrap_err().to_string();
    assert!(error.contains("in array \"names\"; expected at most the "), "{error}");
}
