//! VTKHDF files: those that VTK 9.7 wrote (`tools/vtk/generate.py`), our own, and damaged ones.

use std::path::PathBuf;

use morsmooth::io::{
    ArrayData, CellArray, Collection, CollectionKind, Compression, DataArray, DataSet, Extent, Geometry, IndexWidth, InformationKey,
    InformationValue, Polyhedra, Role, fingerprint, losses, read, resolve, write, write_temporary_with,
};

use super::damage::Random;
use super::{content, file};

/// A VTKHDF file written by real VTK.
fn vtkhdf(name: &str) -> PathBuf {
    file("hdf").join(format!("{name}.vtkhdf"))
}

/// The message for a name that cannot be read, without its folder.
fn message(path: &std::path::Path, address: &str) -> String {
    let full = if address.is_empty() { path.to_owned() } else { path.join(address) };
    let error = read(full).expect_err("the file was read").to_string();
    error.replace(&format!("{}/", path.parent().unwrap().display()), "")
}

/// What VTK keeps of a data set in a VTKHDF file: neither texts and bits at points, nor names of components, nor which integers are ids.
fn kept(mut dataset: DataSet) -> DataSet {
    (dataset.title, dataset.version) = (String::new(), None);
    let is_kept = |array: &DataArray| !matches!(array.data, ArrayData::String(_) | ArrayData::Bit(_));
    for data in [&mut dataset.point_data, &mut dataset.cell_data] {
        data.arrays.retain(is_kept);
        data.arrays.sort_by(|a, b| a.name.cmp(&b.name));
        data.active.sort_by(|a, b| a.1.cmp(&b.1));
    }
    dataset.field_data.sort_by(|a, b| a.name.cmp(&b.name));
    let arrays = dataset.point_data.arrays.iter_mut().chain(&mut dataset.cell_data.arrays).chain(&mut dataset.field_data);
    for array in arrays {
        array.information.clear();
        array.component_names.clear();
        array.id_type = false;
    }
    forget_places(&mut dataset.geometry);
    dataset
}

/// Clears what the format does not keep of the arrays of places: information keys, and the names of axes.
fn forget_places(geometry: &mut Geometry) {
    match geometry {
        Geometry::PolyData { points, .. } | Geometry::UnstructuredGrid { points, .. } | Geometry::StructuredGrid { points, .. } => {
            points.information.clear();
        }
        Geometry::RectilinearGrid { coordinates, .. } => {
            for (array, axis) in coordinates.iter_mut().zip(["X", "Y", "Z"]) {
                array.information.clear();
                array.name = format!("{axis}Coordinates");
            }
        }
        Geometry::ImageData { .. } => {}
    }
}

#[test]
fn files_written_by_vtk_hold_what_its_other_files_hold() {
    for (name, twin) in [
        ("image", "image_raw_zlib_64.vti"),
        ("turned", "turned_raw_none_64.vti"),
        ("rectilinear", "rectilinear_raw_zlib_64.vtr"),
        ("structured", "structured_raw_zlib_64.vts"),
        ("poly", "poly_raw_zlib_64.vtp"),
        ("unstructured", "unstructured_raw_zlib_64.vtu"),
        ("polyhedron", "polyhedron_raw_zlib_64.vtu"),
    ] {
        let (mut found, mut expected) = (kept(read(vtkhdf(name)).unwrap()), kept(read(file(twin)).unwrap()));
        if found.field_data.is_empty() {
            // VTK writes the field data of lists only.
            assert!(!matches!(found.geometry, Geometry::PolyData { .. } | Geometry::UnstructuredGrid { .. }), "{name}");
            expected.field_data.clear();
        }
        assert_eq!(content(&found), content(&expected), "{name}");
        assert_eq!(found.point_data.active(Role::Scalars), Some("speed"));
        found.point_data.arrays.clear();
        assert_ne!(content(&found), content(&expected));
    }
}

#[test]
fn packed_files_hold_the_same_and_empty_ones_are_empty() {
    assert_eq!(content(&read(vtkhdf("poly_packed")).unwrap()), content(&read(vtkhdf("poly")).unwrap()));
    let empty = read(vtkhdf("empty")).unwrap();
    assert_eq!((empty.geometry.name(), empty.point_count(), empty.cell_count()), ("PolyData", 0, 0));
}

#[test]
fn parts_become_one_data_set_without_seams() {
    let one = read(vtkhdf("polyhedron")).unwrap();
    let both = read(vtkhdf("parts")).unwrap();
    // Two copies of the same grid: every point of the second stands in the first.
    assert_eq!(both.point_count(), one.point_count());
    assert_eq!(both.cell_count(), 2 * one.cell_count());
    let Geometry::UnstructuredGrid { cells, types, polyhedra: Some(polyhedra), .. } = &both.geometry else { panic!("no polyhedra") };
    assert_eq!(cells.cell(0), cells.cell(5));
    assert_eq!(types[..5], types[5..]);
    let Polyhedra::Lists { faces, cells } = polyhedra else { panic!("no lists") };
    assert_eq!((faces.len(), cells.cell(4), cells.cell(9)), (8, &[0, 1, 2, 3][..], &[4, 5, 6, 7][..]));
    assert_eq!(faces.cell(0), faces.cell(4));
}

#[test]
fn steps_are_listed_and_read_one_by_one() {
    for name in ["steps", "steps_image"] {
        let path = vtkhdf(name);
        let listed = Collection::read(&path).unwrap().unwrap();
        assert_eq!(listed.kind, CollectionKind::Steps);
        assert_eq!(listed.entries.iter().map(|entry| entry.time.unwrap()).collect::<Vec<_>>(), [0.0, 0.5, 2.0]);
        let mut prints = Vec::new();
        for (step, entry) in listed.entries.iter().enumerate() {
            assert_eq!(entry.path, path.join(step.to_string()));
            assert_eq!(resolve(&entry.path).unwrap(), path);
            prints.push(fingerprint(&entry.path).unwrap());
            let dataset = read(&entry.path).unwrap();
            let speed: Vec<f64> = (0..dataset.point_count()).map(|point| point as f64 * 0.25 + step as f64).collect();
            assert_eq!(dataset.point_array("speed").unwrap().data, ArrayData::F64(speed));
            let material = (0..dataset.cell_count()).map(|cell| (cell + 100 * step) as i32).collect();
            assert_eq!(dataset.cell_array("material").unwrap().data, ArrayData::I32(material));
            let time = dataset.field_data.iter().find(|array| array.name == "Time").unwrap();
            assert_eq!(time.data, ArrayData::F64(vec![[0.0, 0.5, 2.0][step]]));
            if let Geometry::UnstructuredGrid { points, types, .. } = &dataset.geometry {
                assert_eq!(points.data.number(0), Some(step as f64), "the grid moves along x");
                assert_eq!(types, &[11, 14, 10, 3, 42]);
            }
        }
        prints.dedup();
        assert_eq!(prints.len(), 3);
    }
    let known = "steps.vtkhdf: a collection of 3 time steps as one data set cannot be read here; expected one of them, such as steps.vtkhdf/0 (there are 0 to 2)";
    assert_eq!(message(&vtkhdf("steps"), ""), known);
    assert_eq!(message(&vtkhdf("steps"), "3"), "steps.vtkhdf: found no step \"3\"; expected one of 0 to 2");
    assert_eq!(message(&vtkhdf("poly"), "0"), "poly.vtkhdf: found one data set, where its step \"0\" was asked for; expected a data set with steps");
}

#[test]
fn blocks_are_read_one_by_one() {
    let path = vtkhdf("blocks");
    assert!(Collection::read(&path).unwrap().is_none());
    for (block, kind) in [("Block_1", "PolyData"), ("Block_2", "UnstructuredGrid")] {
        assert_eq!(read(path.join(block)).unwrap().geometry.name(), kind);
    }
    let text = message(&path, "");
    let start = "blocks.vtkhdf: a collection of 2 blocks as one data set cannot be read here; expected one of them, such as blocks.vtkhdf/Block_";
    assert!(text.starts_with(start), "{text}");
    let text = message(&path, "inlet");
    assert!(text.starts_with("blocks.vtkhdf: found no block \"inlet\"; expected one of Block_"), "{text}");
}

/// Every kind of geometry with every type of array, as other files of VTK hold them.
fn all_kinds() -> Vec<DataSet> {
    ["image_raw_zlib_64.vti", "turned_raw_none_64.vti", "rectilinear_raw_zlib_64.vtr", "structured_raw_zlib_64.vts", "poly_raw_zlib_64.vtp",
        "unstructured_raw_zlib_64.vtu", "polyhedron_raw_zlib_64.vtu", "empty.vtp"]
        .map(|name| read(file(name)).unwrap())
        .to_vec()
}

/// Without what [`losses`] names.
fn without_losses(mut dataset: DataSet) -> DataSet {
    (dataset.title, dataset.version) = (String::new(), None);
    for data in [&mut dataset.point_data, &mut dataset.cell_data] {
        data.arrays.retain(|array| !matches!(array.data, ArrayData::String(_)));
    }
    let arrays = dataset.point_data.arrays.iter_mut().chain(&mut dataset.cell_data.arrays).chain(&mut dataset.field_data);
    arrays.for_each(|array| array.information.clear());
    forget_places(&mut dataset.geometry);
    dataset
}

#[test]
fn everything_comes_back_plain_and_packed() {
    let folder = tempfile::tempdir().unwrap();
    for (number, dataset) in all_kinds().into_iter().enumerate() {
        for compression in [Compression::None, Compression::Zlib] {
            let path = folder.path().join(format!("{number}.vtkhdf"));
            write_temporary_with(&path, &dataset, compression).unwrap().commit().unwrap();
            let again = read(&path).unwrap();
            // Names of components, ids and bits too, which VTK itself does not write.
            assert_eq!(content(&without_losses(again)), content(&without_losses(dataset.clone())), "{number} {compression:?}");
        }
    }
}

#[test]
fn the_same_data_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = read(file("poly_raw_zlib_64.vtp")).unwrap();
    let bytes = ["a.vtkhdf", "b.vtkhdf"].map(|name| {
        write(folder.path().join(name), &dataset).unwrap();
        std::fs::read(folder.path().join(name)).unwrap()
    });
    assert!(bytes[0] == bytes[1]);
}

fn line(count: usize) -> DataSet {
    let points = DataArray::new("Points", 3, ArrayData::F64((0..3 * count).map(|i| i as f64).collect()));
    let mut cells = CellArray { width: IndexWidth::Bits64, ..CellArray::default() };
    (1..count as i64).for_each(|point| cells.push([point - 1, point]));
    DataSet::new(Geometry::UnstructuredGrid { points, types: vec![3; cells.len()], cells, polyhedra: None })
}

#[test]
fn what_is_lost_is_named_and_names_that_meet_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vtkhdf");
    let mut dataset = line(2);
    let mut array = DataArray::new("m/s", 1, ArrayData::F64(vec![1.0, 2.0]));
    let value = InformationValue::Single("m".into());
    array.information.push(InformationKey { name: "UNITS_LABEL".into(), location: "vtkDataArray".into(), value });
    dataset.set_point_array(array);
    let text = DataArray::new("text", 1, ArrayData::String(vec![vec![0xff], b"b".to_vec()]));
    dataset.set_point_array(text.clone());
    dataset.field_data.push(text);
    let lost = [
        "the name \"m/s\" of a point array (it becomes \"m_s\")",
        "the information keys of point array \"m/s\"",
        "the texts of point array \"text\"",
        "bytes that are no UTF-8 in the texts of field array \"text\"",
    ];
    assert_eq!(losses(&path, &dataset).unwrap(), lost);
    write(&path, &dataset).unwrap();
    assert_eq!(read(&path).unwrap().point_array("m_s").unwrap().data, ArrayData::F64(vec![1.0, 2.0]));
    dataset.set_point_array(DataArray::new("m_s", 1, ArrayData::F64(vec![1.0, 2.0])));
    let error = write(&path, &dataset).unwrap_err().to_string();
    assert!(error.ends_with("found a second point array \"m_s\"; expected names that differ in more than \"/\", \".\" and \"_\""), "{error}");
    let mut nameless = line(2);
    nameless.set_point_array(DataArray::new("", 1, ArrayData::F64(vec![1.0, 2.0])));
    let error = write(&path, &nameless).unwrap_err().to_string();
    assert!(error.ends_with("found a point array called \"\"; expected a name without zero bytes"), "{error}");
    let grid = Geometry::RectilinearGrid {
        extent: Extent([1, 1, 0, 0, 0, 0]),
        coordinates: Box::new(["x", "y", "z"].map(|name| DataArray::new(name, 1, ArrayData::F64(vec![0.5])))),
    };
    assert_eq!(losses(&path, &DataSet::new(grid)).unwrap(), ["the first index of the extent"]);
}

#[test]
fn other_hdf5_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.vtkhdf");
    let refused = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        message(&path, "")
    };
    write(&path, &line(3)).unwrap();
    let whole = std::fs::read(&path).unwrap();
    let text = refused(&whole[..300]);
    assert!(text.starts_with("bad.vtkhdf: found a file that cannot be read (") && text.ends_with("expected a whole HDF5 file"), "{text}");
    let text = refused(b"\x89HDF\r\n\x1a\n");
    assert!(text.ends_with("expected a whole HDF5 file"), "{text}");
}

/// An array for a file made by hand.
enum Made<'a> {
    Integers(&'a [i64], &'a [u64]),
    Places(&'a [f64]),
}

/// A file of one group with these attributes and arrays; names may lead into other groups.
fn made(kind: &str, version: [i64; 2], arrays: &[(&str, Made)]) -> Vec<u8> {
    let mut builder = hdf5_pure::FileBuilder::new();
    let mut root = builder.create_group("VTKHDF");
    root.set_attr("Type", hdf5_pure::AttrValue::AsciiString(kind.into()));
    root.set_attr("Version", hdf5_pure::AttrValue::I64Array(version.to_vec()));
    root.set_attr("WholeExtent", hdf5_pure::AttrValue::I64Array(vec![0, 1, 0, 1, 0, 0]));
    root.set_attr("Origin", hdf5_pure::AttrValue::F64Array(vec![0.0; 3]));
    root.set_attr("Spacing", hdf5_pure::AttrValue::F64Array(vec![1.0; 3]));
    for (name, values) in arrays {
        let mut group = name.split_once('/').map(|(group, _)| root.create_group(group));
        let own = name.rsplit('/').next().unwrap();
        let dataset = match &mut group {
            Some(group) => group.create_dataset(own),
            None => root.create_dataset(own),
        };
        match values {
            Made::Integers(values, shape) => dataset.with_data(values).with_shape(shape),
            Made::Places(values) => dataset.with_data(values).with_shape(&[values.len() as u64 / 3, 3]),
        };
        if let Some(group) = group {
            root.add_group(group.finish());
        }
    }
    builder.add_group(root.finish());
    builder.finish().unwrap()
}

#[test]
fn what_does_not_fit_together_is_refused() {
    use Made::{Integers, Places};
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.vtkhdf");
    let refused = |bytes: Vec<u8>| {
        std::fs::write(&path, bytes).unwrap();
        message(&path, "").strip_prefix("bad.vtkhdf: ").unwrap().to_owned()
    };
    let triangle = |points: i64, cells: i64, corner: i64, has_types: bool| {
        let (points, cells) = ([points], [cells]);
        let corners = [0, 1, corner];
        let mut arrays = vec![
            ("NumberOfPoints", Integers(&points, &[1])),
            ("NumberOfCells", Integers(&cells, &[1])),
            ("NumberOfConnectivityIds", Integers(&[3], &[1])),
            ("Points", Places(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0])),
            ("Connectivity", Integers(&corners, &[3])),
            ("Offsets", Integers(&[0, 3], &[2])),
        ];
        if has_types {
            arrays.push(("Types", Integers(&[5], &[1])));
        }
        made("UnstructuredGrid", [1, 0], &arrays)
    };
    std::fs::write(&path, triangle(3, 1, 2, true)).unwrap();
    assert_eq!((read(&path).unwrap().point_count(), read(&path).unwrap().cell_count()), (3, 1));
    assert_eq!(refused(triangle(5, 1, 2, true)), "found 3 rows in /VTKHDF/Points; expected at least 5");
    assert_eq!(refused(triangle(3, -1, 2, true)), "found -1 in /VTKHDF/NumberOfCells; expected no number below 0");
    assert_eq!(refused(triangle(3, i64::MAX, 2, true)), format!("found 1 rows in /VTKHDF/Types; expected at least {}", i64::MAX));
    assert_eq!(refused(triangle(3, 1, 7, true)), "found number 7 in cell 0 in /VTKHDF/Connectivity; expected numbers from 0, less than 3");
    assert_eq!(refused(triangle(3, 1, 2, false)), "found no array Types in /VTKHDF; expected one");
    let kinds = "ImageData, RectilinearGrid, StructuredGrid, PolyData or UnstructuredGrid";
    for kind in ["OverlappingAMR", "HyperTreeGrid", "or", ""] {
        assert_eq!(refused(made(kind, [2, 0], &[])), format!("Type \"{kind}\" of /VTKHDF cannot be read here; expected {kinds}"));
    }
    assert_eq!(refused(made("ImageData", [3, 1], &[])), "version 3.1 of /VTKHDF cannot be read here; expected 1.0 to 2.x");
    let shape = "expected 4 places, with their components along a last axis";
    let image = |shape: &[u64]| made("ImageData", [2, 0], &[("PointData/f", Integers(&vec![7; shape.iter().product::<u64>() as usize], shape))]);
    std::fs::write(&path, image(&[1, 2, 2, 3])).unwrap();
    assert_eq!(read(&path).unwrap().point_array("f").unwrap().components, 3);
    assert_eq!(refused(image(&[3, 3])), format!("found the axes [3, 3] of /VTKHDF/PointData/f; {shape}"));
    assert_eq!(refused(image(&[3, 2, 2])), format!("found the axes [3, 2, 2] of /VTKHDF/PointData/f; {shape}"));
    let mut other = hdf5_pure::FileBuilder::new();
    other.create_dataset("x").with_data(&[1.0]);
    let expected = "an HDF5 file without the group VTKHDF cannot be read here; expected one as VTK writes it (.vtkhdf)";
    assert_eq!(refused(other.finish().unwrap()), expected);
}

#[test]
fn damaged_files_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.vtkhdf");
    let mut random = Random(0x5151_5678_9abc_def1);
    let (mut good, mut bad) = (0, 0);
    for name in ["image", "polyhedron", "poly_packed", "steps", "blocks"] {
        let whole = std::fs::read(vtkhdf(name)).unwrap();
        let address = match name {
            "steps" => "1",
            "blocks" => "Block_2",
            _ => "",
        };
        for round in 0..120 {
            let mut damaged = whole.clone();
            match round % 3 {
                0 => damaged.truncate(random.below(whole.len())),
                1 => {
                    let place = random.below(whole.len());
                    damaged[place] ^= 1 << random.below(8);
                }
                _ => {
                    let place = random.below(whole.len() - 8);
                    damaged[place..place + 8].fill([0xff, 0x7f, 0x00][random.below(3)]);
                }
            }
            std::fs::write(&path, &damaged).unwrap();
            match read(if address.is_empty() { path.clone() } else { path.join(address) }) {
                Ok(_) => good += 1,
                Err(error) => {
                    assert!(error.to_string().contains("expected") || error.to_string().contains("cannot read"), "{error}");
                    bad += 1;
                }
            }
        }
    }
    assert!(good > 50 && bad > 50, "{good} {bad}");
}
