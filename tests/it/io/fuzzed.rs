//! What the fuzz targets under tools/fuzz found, each as small as it became.

use morsmooth::io::{ArrayData, DataArray, DataSet, Extent, Geometry, InformationKey, InformationValue, read, write};

use super::read_text;

/// Three points in a row.
fn row() -> DataSet {
    let direction = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    DataSet::new(Geometry::ImageData { extent: Extent([0, 2, 0, 0, 0, 0]), origin: [0.0; 3], spacing: [1.0; 3], direction })
}

fn named(name: &str) -> DataArray {
    DataArray::new(name, 1, ArrayData::I16(vec![7, 8, 9]))
}

/// A table is the same after it was written and read again.
fn comes_back(folder: &tempfile::TempDir, extension: &str, source: &str) {
    let dataset = read_text(folder, &format!("a.{extension}"), source.as_bytes()).unwrap();
    let to = folder.path().join(format!("b.{extension}"));
    write(&to, &dataset).unwrap();
    let again = read(&to).unwrap();
    assert_eq!((again.point_count(), again.geometry, again.point_data), (dataset.point_count(), dataset.geometry, dataset.point_data), "{source:?}");
}

/// XML may leave a name empty; the words of a legacy file would slip.
#[test]
fn an_array_without_a_name_is_not_written_as_legacy() {
    let folder = tempfile::tempdir().unwrap();
    let text = "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 2 0 0 0 0\"><Piece Extent=\"0 2 0 0 0 0\"><PointData>\
                <DataArray type=\"Int16\" Name=\"\">7 8 9</DataArray></PointData></Piece></ImageData></VTKFile>";
    let dataset = read_text(&folder, "a.vti", text.as_bytes()).unwrap();
    write(folder.path().join("b.vti"), &dataset).unwrap();
    assert_eq!(read(folder.path().join("b.vti")).unwrap().point_data, dataset.point_data);
    let error = write(folder.path().join("b.vtk"), &dataset).unwrap_err().to_string();
    assert!(error.ends_with("found an array without a name, which .vtk files cannot hold; expected a name for every array"), "{error}");
    assert!(!folder.path().join("b.vtk").exists());
}

#[test]
fn names_that_are_words_of_the_legacy_format_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut dataset = row();
    for name in ["METADATA", "metadata", "NULL_ARRAY", "FIELD", "LOOKUP_TABLE", "100%"] {
        dataset.set_point_array(named(name));
    }
    write(folder.path().join("a.vtk"), &dataset).unwrap();
    assert_eq!(read(folder.path().join("a.vtk")).unwrap().point_data, dataset.point_data);
}

/// A legacy file may code any byte in what is said about an array; XML can hold only some.
#[test]
fn control_characters_in_information_keys_are_not_written_as_xml() {
    let folder = tempfile::tempdir().unwrap();
    let key = |name: &str, location: &str, value: InformationValue| {
        let mut dataset = row();
        let keys = vec![InformationKey { name: name.into(), location: location.into(), value }];
        dataset.set_point_array(DataArray { information: keys, ..named("h") });
        write(folder.path().join("a.vti"), &dataset).map_err(|error| error.to_string())
    };
    let single = |text: &str| InformationValue::Single(text.into());
    assert!(key("k", "l", single("v")).is_ok());
    for refused in [
        key("k\u{1e}", "l", single("v")),
        key("k", "\u{1}", single("v")),
        key("k", "l", single("\u{b}")),
        key("k", "l", InformationValue::List(vec!["v".into(), "\u{ffff}".into()])),
    ] {
        let error = refused.unwrap_err();
        assert!(error.contains("found a control character in the name") && error.ends_with("expected a name that XML can hold"), "{error}");
    }
}

/// The name of its first column made a table look like XML when it was read back.
#[test]
fn a_table_may_begin_with_a_bracket() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = read_text(&folder, "a.csv", b"# text\n<a,b\n1,2\n2,5\n").unwrap();
    write(folder.path().join("b.csv"), &dataset).unwrap();
    let again = read(folder.path().join("b.csv")).unwrap();
    assert_eq!(again.point_data, dataset.point_data);
    // Files of VTK are still told by their content, whatever they are called.
    write(folder.path().join("c.vtp"), &dataset).unwrap();
    std::fs::rename(folder.path().join("c.vtp"), folder.path().join("c.csv")).unwrap();
    assert_eq!(read(folder.path().join("c.csv")).unwrap().geometry, dataset.geometry);
}

/// Without its quotes, a row that begins with # was a comment when the table was read again, and so no longer a row.
#[test]
fn a_cell_that_begins_as_a_comment_stays_a_cell() {
    let folder = tempfile::tempdir().unwrap();
    for source in ["\"#", "\"#\"\n1\n", "name,h\n\"#1\",5\na,6\n\"#2\",7\n", "\"#a\"\tb\n1\t2\n"] {
        comes_back(&folder, "csv", source);
    }
}

#[test]
fn a_byte_order_mark_is_no_name() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = read_text(&folder, "a.csv", "# above\n\u{feff}\n".as_bytes()).unwrap();
    write(folder.path().join("b.csv"), &dataset).unwrap();
    assert!(read(folder.path().join("b.csv")).is_ok());
    let dataset = read_text(&folder, "a.csv", "# above\n\u{feff}t,h\n0,1\n1,2\n".as_bytes()).unwrap();
    assert!(dataset.point_array("h").is_some() && dataset.field_data.iter().any(|array| array.to_texts()[0] == "t"));
}

/// A head that declares 34,604,034 x 2 pixels and an inch of data.
#[test]
fn an_image_larger_than_its_file_can_hold_is_refused_before_memory_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let head = [0, 0, 0, 13, b'I', b'H', b'D', b'R', 2, 16, 4, 2, 0, 0, 0, 2, 16, 4, 0, 0, 0];
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    bytes.extend(head);
    bytes.extend(checksum(&head[4..]).to_be_bytes());
    bytes.extend([0, 0, 0, 3, b'I', b'D', b'A', b'T', 120, 156, 99]);
    bytes.extend(checksum(b"IDAT\x78\x9c\x63").to_be_bytes());
    bytes.extend([0, 0, 0, 0, b'I', b'E', b'N', b'D', 0xae, 0x42, 0x60, 0x82]);
    let error = read_text(&folder, "a.png", &bytes).unwrap_err().to_string();
    let expected = format!("found an image of 34604034 x 2 pixels in {} bytes; expected no more than the compressor can pack", bytes.len());
    assert!(error.ends_with(&expected), "{error}");
}

/// CRC-32, as PNG has it.
fn checksum(bytes: &[u8]) -> u32 {
    let step = |state: u32, &byte: &u8| {
        (0..8).fold(state ^ u32::from(byte), |state, _| (state >> 1) ^ if state & 1 == 1 { 0xedb8_8320 } else { 0 })
    };
    !bytes.iter().fold(!0, step)
}

/// A polyhedron may stand in a file without its faces; a legacy file of it would not be read again.
#[test]
fn a_polyhedron_without_whole_faces_is_not_written_as_legacy() {
    let folder = tempfile::tempdir().unwrap();
    let text = "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\
                <Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>\
                <Cells><DataArray type=\"Int32\" Name=\"connectivity\">0 1 2 3</DataArray>\
                <DataArray type=\"Int32\" Name=\"offsets\">4</DataArray><DataArray type=\"UInt8\" Name=\"types\">42</DataArray>FACES\
                </Cells></Piece></UnstructuredGrid></VTKFile>";
    let read_with = |faces: &str| read_text(&folder, "a.vtu", text.replace("FACES", faces).as_bytes()).unwrap();
    let faces = |faces: &str, offset: i32| {
        format!("<DataArray type=\"Int32\" Name=\"faces\">{faces}</DataArray><DataArray type=\"Int32\" Name=\"faceoffsets\">{offset}</DataArray>")
    };
    let to = folder.path().join("b.vtk");
    write(&to, &read_with(&faces("4 3 0 1 2 3 0 1 3 3 0 2 3 3 1 2 3", 17))).unwrap();
    assert_eq!(read(&to).unwrap().cell_count(), 1);
    std::fs::remove_file(&to).unwrap();
    for broken in [String::new(), faces("4 3 0 1 2", -1)] {
        let error = write(&to, &read_with(&broken)).unwrap_err().to_string();
        assert!(error.ends_with("found cell 0, a polyhedron without whole faces; expected faces for every polyhedron in a .vtk file"), "{error}");
        assert!(!to.exists());
    }
}

/// An empty list of texts stands on no line at all; the reader once waited for its first one for ever.
#[test]
fn an_empty_list_in_the_metadata_of_a_legacy_file_ends() {
    let folder = tempfile::tempdir().unwrap();
    let text = "# vtk DataFile Version 4.2\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 float\n1 2 3\nMETADATA\nINFORMATION 2\n\
                NAME A LOCATION b\nDATA 0\nNAME C LOCATION d\nDATA 1 2.5\n\nCELLS 0 0\nCELL_TYPES 0\n";
    let dataset = read_text(&folder, "a.vtk", text.as_bytes()).unwrap();
    let strange = text.replace("DATA 0\nNAME C LOCATION d\n", "DATA 0\nN@ME C LOCATION d\n");
    assert_eq!(read_text(&folder, "b.vtk", strange.as_bytes()).unwrap().points_f64(), dataset.points_f64());
}

/// A name with a tab or a semicolon, in a table that commas separate, is read back whole.
#[test]
fn separators_within_names_of_columns_stay_within() {
    let folder = tempfile::tempdir().unwrap();
    for source in ["x\ta;b\n1\t2\n3\t5\n", "\"p\tq\";\"c,d\"\n1;2\n3;5\n", "\"x;y\",\"a\tb\"\n1,2\n3,5\n"] {
        comes_back(&folder, "csv", source);
    }
    // The only column of a table shows no separator.
    for name in ["b,", "b;c", "b\tc"] {
        comes_back(&folder, "tsv", &format!("\"{name}\"\n1\n2\n"));
    }
}

/// A table that begins with what another format begins with was read as a table because something stood before it; it is written so that it
/// stays one.
#[test]
fn tables_that_begin_like_another_format_stay_tables() {
    let folder = tempfile::tempdir().unwrap();
    for source in ["# a\n<VTKFile 2001,b\n1,2\n", "# a\n<?xml;b\n1;2\n", "\n# vtk DataFile Version 4.2\na,b\n1,2\n", "# a\n\u{feff}<VTKFile,b\n1,2\n"] {
        comes_back(&folder, "csv", source);
    }
}

/// Blanks at the ends of an information key's value come back from XML as they were, and the line ends that VTK puts around a value do not.
#[test]
fn blanks_at_the_ends_of_information_stay() {
    let folder = tempfile::tempdir().unwrap();
    let text = "# vtk DataFile Version 4.2\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n1 2 3\nMETADATA\nINFORMATION 3\n\
                NAME A LOCATION b\nDATA %20a%20b%20%20\nNAME C LOCATION d\nDATA 2 %20 x%0A\nNAME E LOCATION f\nDATA q\n\n";
    let dataset = read_text(&folder, "a.vtk", text.as_bytes()).unwrap();
    let information = |dataset: &DataSet| match &dataset.geometry {
        Geometry::PolyData { points, .. } => format!("{:?}", points.information),
        _ => unreachable!("poly data"),
    };
    assert!(information(&dataset).contains("\" a b  \""), "{}", information(&dataset));
    let to = folder.path().join("b.vtp");
    write(&to, &dataset).unwrap();
    assert_eq!(information(&read(&to).unwrap()), information(&dataset));
    let written = std::fs::read(&to).unwrap();
    let from = written.windows(2).position(|bytes| bytes == b">q").unwrap();
    let padded = [&written[..=from], b"\r\n    q\r\n  ", &written[from + 2..]].concat();
    assert_eq!(information(&read_text(&folder, "c.vtp", &padded).unwrap()), information(&dataset));
}
