//! Bad input: the message says what was found, where, and what was expected.

use morsmooth::io::{ArrayData, DataArray, DataSet, Extent, Geometry, read, write};

use super::{file, read_text};

/// An image file with two points, and one array or anything else among its point data.
fn image(array: &str) -> String {
    format!(
        "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
         <ImageData WholeExtent=\"0 1 0 0 0 0\">\n<Piece Extent=\"0 1 0 0 0 0\">\n<PointData>\n{array}\n\
         </PointData>\n</Piece>\n</ImageData>\n</VTKFile>\n"
    )
}

/// The message for a file with this content, without its path.
fn message(bytes: impl AsRef<[u8]>) -> String {
    let folder = tempfile::tempdir().unwrap();
    let error = read_text(&folder, "bad", bytes.as_ref()).expect_err("the file was read").to_string();
    error.replace(folder.path().join("bad").to_str().unwrap(), "bad")
}

#[test]
fn files_that_are_no_vtk_files() {
    let known = "a serial VTK XML file, a legacy .vtk file, a mesh (.obj .off .ply .stl .mesh .msh), a table (.csv .tsv), an image (.png), or an array (.npy)";
    assert_eq!(message(""), format!("bad: found an empty file; expected {known}"));
    assert_eq!(message("x,y\n1,2\n"), format!("bad: a file of unknown format cannot be read here; expected {known}"));
    #[cfg(not(feature = "vtkhdf"))]
    assert_eq!(message(b"\x89HDF\r\n\x1a\n"), format!("bad: an HDF5 file cannot be read here; expected {known}"));
    assert_eq!(message(b"\x1f\x8b\x08"), format!("bad: a gzip file cannot be read here; expected {known}"));
    assert_eq!(message("<svg/>"), "bad, line 1: an XML file of <svg> cannot be read here; expected <VTKFile>");
    let missing = read("no/such/file.vti").unwrap_err().to_string();
    assert_eq!(missing, "cannot read no/such/file.vti: No such file or directory (os error 2)");
}

#[test]
fn kinds_of_xml_files_that_are_not_read() {
    let kinds = "ImageData, RectilinearGrid, StructuredGrid, PolyData or UnstructuredGrid in one file";
    assert_eq!(
        message("<VTKFile type=\"HyperTreeGrid\"><HyperTreeGrid/></VTKFile>"),
        format!("bad, line 1: type=\"HyperTreeGrid\" cannot be read here; expected {kinds}")
    );
    assert_eq!(
        message("<VTKFile type=\"ImageData\" compressor=\"vtkZStd\"/>"),
        "bad, line 1: compressor=\"vtkZStd\" cannot be read here; expected vtkZLib-, vtkLZ4- or vtkLZMADataCompressor"
    );
    assert_eq!(
        message("<VTKFile type=\"ImageData\" header_type=\"UInt16\"/>"),
        "bad, line 1: header_type=\"UInt16\" cannot be read here; expected UInt32 or UInt64"
    );
    assert_eq!(
        message("<VTKFile type=\"ImageData\" byte_order=\"Middle\"/>"),
        "bad, line 1: byte_order=\"Middle\" cannot be read here; expected LittleEndian or BigEndian"
    );
    assert_eq!(
        message("<VTKFile type=\"ImageData\" version=\"9.0\"/>"),
        "bad, line 1: version=\"9.0\" cannot be read here; expected version 0.1 to 2.x"
    );
    assert_eq!(message("<VTKFile type=\"ImageData\"/>"), "bad, line 1: found no <ImageData>; expected one, as the type says");
}

#[test]
fn broken_xml() {
    assert_eq!(
        message("<VTKFile type=\"ImageData\">\n<ImageData>\n</VTKFile>"),
        "bad, line 3: found broken XML (expected 'ImageData' tag, not 'VTKFile' at 3:1); expected well-formed XML"
    );
    assert_eq!(
        message(b"<VTKFile type=\"\xff\"/>"),
        "bad, byte 15: found a byte that is not UTF-8; expected text in UTF-8 before the appended data"
    );
    assert_eq!(
        message(image("<DataArray type=\"Int8\" Name=\"a<b\">1 2</DataArray>")).split(';').next().unwrap().split('(').next().unwrap(),
        "bad, line 5: found broken XML "
    );
}

#[test]
fn arrays_in_text() {
    let array = |body: &str| message(image(&format!("<DataArray type=\"Int8\" Name=\"a\">{body}</DataArray>")));
    assert_eq!(array("1 2 3"), "bad, line 5: found 3 values in array \"a\"; expected 2");
    assert_eq!(array("1"), "bad, line 5: found 1 values in array \"a\"; expected 2");
    assert_eq!(array("1\n300"), "bad, line 6: found \"300\" in array \"a\"; expected a number of the array's type");
    assert_eq!(array("1 x"), "bad, line 5: found \"x\" in array \"a\"; expected a number of the array's type");
    assert_eq!(
        message(image("<DataArray type=\"Float16\" Name=\"a\"/>")),
        "bad, line 5: type=\"Float16\" in array \"a\" cannot be read here; expected Int8 to UInt64, Float32, Float64, Bit or String"
    );
    assert_eq!(
        message(image("<DataArray type=\"Int8\" Name=\"a\" format=\"hex\"/>")),
        "bad, line 5: format=\"hex\" in array \"a\" cannot be read here; expected ascii, binary or appended"
    );
    assert_eq!(
        message(image("<DataArray type=\"Int8\" Name=\"a\" NumberOfComponents=\"0\"/>")),
        "bad, line 5: found 0 components in array \"a\"; expected 1 to 1048576"
    );
    assert_eq!(
        message(image("<DataArray type=\"Int8\" Name=\"a\" NumberOfComponents=\"two\"/>")),
        "bad, line 5: found NumberOfComponents=\"two\" in array \"a\"; expected a number within range as NumberOfComponents"
    );
}

#[test]
fn arrays_in_base64() {
    let array = |body: &str| message(image(&format!("<DataArray type=\"Int8\" Name=\"a\" format=\"binary\">{body}</DataArray>")));
    assert_eq!(array("AgAAAAAAAAAB"), "bad, line 5: found an array of 2 bytes in array \"a\"; expected at most the 1 that follow");
    assert_eq!(array("AgAAAAAAAAA!Ag=="), "bad, line 5: found byte 0x21 in base64 data in array \"a\"; expected a base64 digit");
    assert_eq!(array(""), "bad, line 5: found 0 bytes of base64 data in array \"a\"; expected 8");
}

#[test]
fn appended_arrays() {
    let file = |offset: &str, data: &[u8]| {
        let text = image(&format!("<DataArray type=\"Int8\" Name=\"a\" format=\"appended\" {offset}/>"));
        let mut bytes = text.replace("</VTKFile>\n", "<AppendedData encoding=\"raw\">\n_").into_bytes();
        let start = bytes.len();
        bytes.extend_from_slice(data);
        bytes.extend_from_slice(b"</AppendedData></VTKFile>");
        message(bytes).replace(&format!("byte {start}"), "byte START")
    };
    assert_eq!(file("", b""), "bad, line 5: found an appended array without offset in array \"a\"; expected an offset");
    assert_eq!(
        file("offset=\"99\"", b""),
        "bad, line 5: found offset 99 in array \"a\"; expected at most the 25 bytes of appended data"
    );
    assert_eq!(
        file("offset=\"0\"", b"\xff\xff\xff\xff\xff\xff\xff\x7f12"),
        "bad, byte START: found an array of 9223372036854775807 bytes in array \"a\"; expected at most the 27 that follow"
    );
    assert_eq!(
        file("offset=\"0\"", b"\x03\0\0\0\0\0\0\x00123"),
        "bad, byte START: found 3 bytes in array \"a\"; expected 2 values of 1 bytes"
    );
    assert_eq!(
        message(image("<DataArray type=\"Int8\" Name=\"a\" format=\"appended\" offset=\"0\"/>")),
        "bad, line 5: found an appended array in array \"a\"; expected <AppendedData> at the end of the file"
    );
}

#[test]
fn packed_arrays_that_lie() {
    let packed = |numbers: &[u64], data: &[u8]| {
        let text = image("<DataArray type=\"Int8\" Name=\"a\" format=\"appended\" offset=\"0\"/>")
            .replace("header_type", "compressor=\"vtkZLibDataCompressor\" header_type");
        let mut bytes = text.replace("</VTKFile>\n", "<AppendedData encoding=\"raw\">\n_").into_bytes();
        let start = bytes.len();
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        let blocks = bytes.len();
        bytes.extend_from_slice(data);
        message(bytes).replace(&format!("byte {start}"), "byte START").replace(&format!("byte {blocks}"), "byte BLOCKS")
    };
    assert_eq!(
        packed(&[1 << 60, 32768, 0], b""),
        "bad, byte START: found a table of 1152921504606846976 packed blocks in array \"a\"; \
         expected no more blocks than bytes follow"
    );
    assert_eq!(
        packed(&[1, 10, 20, 3], b"abc"),
        "bad, byte START: found a last block of 20 bytes after blocks of 10 in array \"a\"; expected a last block that is no longer"
    );
    assert_eq!(
        packed(&[1, 2, 2, 99], b"abc"),
        "bad, byte START: found packed blocks of 99 bytes or more in array \"a\"; expected at most the 3 that follow"
    );
    assert_eq!(
        packed(&[1, 1 << 40, 0, 3], b"abc"),
        "bad, byte START: found 1 blocks of 1099511627776 bytes packed into 3 in array \"a\"; \
         expected no more than the compressor can pack"
    );
    assert_eq!(
        packed(&[1, 2, 2, 3], b"abc"),
        "bad, byte BLOCKS: found packed block 0 of 1 that does not unpack in array \"a\"; expected 2 bytes in it"
    );
}

#[test]
fn cells_that_point_nowhere() {
    let cells = |connectivity: &str, offsets: &str, types: &str| {
        message(format!(
            "<VTKFile type=\"UnstructuredGrid\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"3\" NumberOfCells=\"2\">\n\
             <Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0</DataArray></Points>\n<Cells>\n\
             <DataArray type=\"Int32\" Name=\"connectivity\">{connectivity}</DataArray>\n\
             <DataArray type=\"Int32\" Name=\"offsets\">{offsets}</DataArray>\n\
             <DataArray type=\"UInt8\" Name=\"types\">{types}</DataArray>\n</Cells>\n</Piece>\n</UnstructuredGrid></VTKFile>"
        ))
    };
    assert_eq!(cells("0 1 1 3", "2 4", "3 3"), "bad, line 5: found number 3 in cell 1; expected numbers from 0, less than 3");
    assert_eq!(cells("0 1 1 -1", "2 4", "3 3"), "bad, line 5: found number -1 in cell 1; expected numbers from 0, less than 3");
    assert_eq!(cells("0 1 1 2", "4 2", "3 3"), "bad, line 5: found cell 1 from 4 to 2; expected offsets that do not fall");
    assert_eq!(cells("0 1 1", "2 4", "3 3"), "bad, line 6: found 3 values in array \"connectivity\"; expected 4");
    assert_eq!(cells("0 1 1 2", "2 4", "3"), "bad, line 8: found 1 values in array \"types\"; expected 2");
}

#[test]
fn pieces_that_do_not_fit() {
    let pieces = |second: &str| {
        message(format!(
            "<VTKFile type=\"ImageData\">\n<ImageData WholeExtent=\"0 3 0 0 0 0\">\n<Piece Extent=\"0 1 0 0 0 0\"><PointData>\
             <DataArray type=\"Int8\" Name=\"a\">1 2</DataArray></PointData></Piece>\n{second}\n</ImageData></VTKFile>"
        ))
    };
    assert_eq!(
        pieces("<Piece Extent=\"3 3 0 0 0 0\"><PointData><DataArray type=\"Int8\" Name=\"a\">4</DataArray></PointData></Piece>"),
        "bad, line 2: found pieces that cover 3 of 4 points; expected pieces without gaps between them"
    );
    assert_eq!(
        pieces("<Piece Extent=\"1 2 0 0 0 0\"/>"),
        "bad, line 2: found no array \"a\" of that type in piece 1; expected the arrays of the first piece in every piece"
    );
}

#[test]
fn legacy_files() {
    let start = "# vtk DataFile Version 3.0\ntitle\nASCII\n";
    let legacy = |rest: &str| message(format!("{start}{rest}"));
    assert_eq!(
        legacy("DATASET TABLE\n"),
        "bad, line 4: DATASET \"TABLE\" cannot be read here; expected STRUCTURED_POINTS, STRUCTURED_GRID, RECTILINEAR_GRID, \
         POLYDATA, UNSTRUCTURED_GRID"
    );
    assert_eq!(message("# vtk DataFile Version 3.0\nt\nTEXT\n"), "bad, line 3: found \"TEXT\"; expected ASCII or BINARY");
    assert_eq!(legacy(""), "bad, line 4: found the end of the file; expected DATASET");
    assert_eq!(
        legacy("DATASET POLYDATA\nPOINTS 2 float\n0 0 0 1 x 0\n"),
        "bad, line 6: found \"x\" in array \"Points\"; expected a number"
    );
    assert_eq!(
        legacy("DATASET POLYDATA\nPOINTS 2 float\n0 0 0 1\n"),
        "bad, line 7: found the end of the file after 4 values in array \"Points\"; expected 6"
    );
    assert_eq!(
        legacy("DATASET POLYDATA\nPOINTS 1 float\n0 0 0\nLINES 1 3\n2 0 1\n"),
        "bad, line 9: found number 1 in cell 0; expected numbers from 0, less than 1"
    );
    assert_eq!(
        legacy("DATASET POLYDATA\nPOINTS 1 float\n0 0 0\nLINES 2 3\n2 0 0\n"),
        "bad, line 7: found 1 cells in a list of 3 numbers; expected 2"
    );
    assert_eq!(
        legacy("DATASET STRUCTURED_POINTS\nDIMENSIONS 2 1 1\nPOINT_DATA 3\nSCALARS a int\nLOOKUP_TABLE default\n1 2 3\n"),
        "bad, line 10: found 3 tuples in POINT_DATA; expected 2"
    );
    assert_eq!(
        legacy("DATASET STRUCTURED_POINTS\nDIMENSIONS 2 1 1\nPOINT_DATA 2\nSCALARS a quad\n"),
        "bad, line 7: found \"quad\"; expected a type such as float, double, int or unsigned_char"
    );
    assert_eq!(
        legacy("DATASET STRUCTURED_POINTS\nDIMENSIONS 2 1 1\nSHAPE 3\n"),
        "bad, line 6: found \"SHAPE\"; expected a keyword of a legacy VTK file"
    );
    assert_eq!(
        legacy("DATASET STRUCTURED_POINTS\nSPACING 1 1 1\n"),
        "bad, line 6: found STRUCTURED_POINTS without DIMENSIONS; expected DIMENSIONS"
    );
    assert_eq!(
        legacy("DATASET POLYDATA\nPOINTS 99999999999 float\n0 0 0\n"),
        "bad, line 5: found 7 bytes before the end in array \"Points\"; expected 299999999997 values"
    );
}

#[test]
fn data_sets_that_no_file_should_hold() {
    let folder = tempfile::tempdir().unwrap();
    let refusal = |name: &str, dataset: &DataSet| {
        let path = folder.path().join(name);
        let message = write(&path, dataset).unwrap_err().to_string();
        assert!(!path.exists());
        message.replace(folder.path().to_str().unwrap(), "F")
    };
    let image = read(file("image_ascii.vti")).unwrap();
    assert_eq!(
        refusal("out.vtu", &image),
        "cannot write F/out.vtu: found a name ending in \"vtu\" for ImageData; expected .vti or .vtk"
    );
    assert_eq!(refusal("out", &image), "cannot write F/out: found a name ending in \"\" for ImageData; expected .vti or .vtk");
    assert_eq!(
        refusal("out.vtk", &read(file("turned_raw_none_64.vti")).unwrap()),
        "cannot write F/out.vtk: found an image with rotated axes, which .vtk files cannot hold; expected a name ending in .vti"
    );
    let with = |array: DataArray| {
        let mut dataset = image.clone();
        dataset.set_point_array(array);
        dataset
    };
    assert_eq!(
        refusal("out.vti", &with(DataArray::new("new", 1, ArrayData::F64(vec![0.0; 8])))),
        "cannot write F/out.vti: found 8 values in point array \"new\"; expected 9 x 1"
    );
    assert_eq!(
        refusal("out.vti", &with(DataArray::new("a\u{1}b", 1, ArrayData::F64(vec![0.0; 9])))),
        "cannot write F/out.vti: found a control character in the name \"a\\u{1}b\"; expected a name that XML can hold"
    );
    assert_eq!(
        refusal("out.vti", &with(DataArray::new("t", 1, ArrayData::String(vec![vec![0]; 9])))),
        "cannot write F/out.vti: found a zero byte within a text of array \"t\"; expected texts without"
    );
    let empty_rectilinear = DataSet::new(Geometry::RectilinearGrid {
        extent: Extent([0, 1, 0, 0, 0, 0]),
        coordinates: Box::new([1, 1, 1].map(|count| DataArray::new("", 1, ArrayData::F64(vec![0.0; count])))),
    });
    assert_eq!(
        refusal("out.vtr", &empty_rectilinear),
        "cannot write F/out.vtr: found [1, 1, 1] coordinates; expected [2, 1, 1]"
    );
}
