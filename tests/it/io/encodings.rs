//! Every encoding gives the same data.

use morsmooth::io::{ArrayData, DataArray, DataSet, Extent, Geometry, Polyhedra, Role, read};

use super::{content, file, files};

/// Without the caches of ranges that VTK adds in some forms and with other digits in others.
fn without_caches(mut dataset: DataSet) -> DataSet {
    let strip = |array: &mut DataArray| array.information.clear();
    dataset.point_data.arrays.iter_mut().for_each(strip);
    dataset.cell_data.arrays.iter_mut().for_each(strip);
    match &mut dataset.geometry {
        Geometry::StructuredGrid { points, .. }
        | Geometry::PolyData { points, .. }
        | Geometry::UnstructuredGrid { points, .. } => strip(points),
        Geometry::RectilinearGrid { coordinates, .. } => coordinates.iter_mut().for_each(strip),
        Geometry::ImageData { .. } => {}
    }
    dataset
}

#[test]
fn every_xml_encoding_of_an_image_gives_the_same_data() {
    let reference = without_caches(read(file("image_ascii.vti")).unwrap());
    let images = files().into_iter().filter(|path| path.extension().unwrap() == "vti");
    let mut compared = 0;
    for path in images.filter(|path| path.file_name().unwrap().to_str().unwrap().starts_with("image")) {
        let image = without_caches(read(&path).unwrap());
        assert_eq!(content(&image), content(&reference), "{}", path.display());
        compared += 1;
    }
    assert_eq!(compared, 27);
}

#[test]
fn an_image_is_read_with_all_its_parts() {
    let image = read(file("image_raw_zlib_32.vti")).unwrap();
    let Geometry::ImageData { extent, origin, spacing, direction } = &image.geometry else { panic!("no image") };
    assert_eq!(*extent, Extent([-1, 1, 2, 4, 0, 0]));
    assert_eq!((*origin, *spacing), ([0.1, -0.7, 1e-9], [0.3, 0.1, 0.7]));
    assert_eq!(*direction, [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    assert_eq!((image.point_count(), image.cell_count()), (9, 4));
    let values = |name: &str| image.point_array(name).unwrap().data.clone();
    assert_eq!(values("speed"), ArrayData::F64(vec![-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0]));
    assert_eq!(values("single ρ"), ArrayData::F32(vec![0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0]));
    assert_eq!(values("int8"), ArrayData::I8(vec![127, 1, 2, 3, 4, 5, 6, 7, 8]));
    assert_eq!(values("uint64"), ArrayData::U64(vec![u64::MAX, 1, 2, 3, 4, 5, 6, 7, 8]));
    assert_eq!(values("bits"), ArrayData::Bit([1, 0, 0, 1, 0, 0, 1, 0, 0].map(|bit| bit == 1).to_vec()));
    assert_eq!(image.point_array("labels").unwrap().to_texts()[..3], ["", "point 1", "point 2"]);
    let ids = image.point_array("ids").unwrap();
    assert!(ids.id_type);
    assert_eq!(ids.to_f64(0), [0.0, 7.0, 14.0, 21.0, 28.0, 35.0, 42.0, 49.0, 56.0]);
    let velocity = image.point_array("velocity").unwrap();
    assert_eq!(velocity.component_names, ["u", "v", "w"]);
    assert_eq!(velocity.to_f64(1), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0]);
    assert_eq!(image.point_data.active(Role::Scalars), Some("speed"));
    assert_eq!(image.point_data.active(Role::Vectors), Some("velocity"));
    assert_eq!(image.cell_array("material").unwrap().data, ArrayData::I32(vec![0, 1, 2, 3]));
    assert_eq!(image.field_data[0].data, ArrayData::F64(vec![1.25]));
    assert_eq!(image.field_data[1].to_texts(), ["a b <&> c", "second"]);
    let last = image.points_f64()[8];
    assert_eq!(last, [0.1 + 0.3, -0.7 + 4.0 * 0.1, 1e-9]);
}

#[test]
fn the_axes_of_an_image_may_be_turned() {
    let image = read(file("turned_raw_none_64.vti")).unwrap();
    let Geometry::ImageData { direction, .. } = &image.geometry else { panic!("no image") };
    assert_eq!(*direction, [0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0]);
    // Index (-1, 2, 0): its steps along x and y change places.
    assert_eq!(image.points_f64()[0], [0.1 + 2.0 * 0.1, -0.7 - 0.3, 1e-9]);
}

#[test]
fn legacy_files_hold_the_same_arrays_as_xml_files() {
    for (kind, extension) in
        [("image", "vti"), ("rectilinear", "vtr"), ("structured", "vts"), ("poly", "vtp"), ("unstructured", "vtu")]
    {
        let xml = without_caches(read(file(&format!("{kind}_ascii.{extension}"))).unwrap());
        for form in ["42_ascii", "42_binary", "51_ascii", "51_binary"] {
            let legacy = without_caches(read(file(&format!("{kind}_{form}.vtk"))).unwrap());
            for array in &xml.point_data.arrays {
                assert_eq!(legacy.point_array(&array.name), Some(array), "{kind} {form}");
            }
            assert_eq!(legacy.cell_data, xml.cell_data, "{kind} {form}");
            assert_eq!(legacy.field_data, xml.field_data, "{kind} {form}");
            assert_eq!(legacy.point_data.active(Role::Scalars), Some("speed"));
            assert_eq!(legacy.point_data.arrays.len(), xml.point_data.arrays.len());
            if !["image", "rectilinear"].contains(&kind) {
                assert_eq!(legacy.geometry, xml.geometry, "{kind} {form}");
            }
        }
    }
}

#[test]
fn polyhedra_keep_their_faces() {
    let mut seen = Vec::new();
    for name in ["polyhedron_ascii.vtu", "polyhedron_raw_zlib_64.vtu", "polyhedron_42_binary.vtk", "polyhedron_51_ascii.vtk"] {
        let dataset = read(file(name)).unwrap();
        let Geometry::UnstructuredGrid { cells, types, polyhedra, .. } = dataset.geometry else { panic!("no cells") };
        assert_eq!(types, [11, 14, 10, 3, 42]);
        assert_eq!(cells.cell(4), [0, 1, 2, 3]);
        let Some(Polyhedra::Lists { faces, cells }) = polyhedra else { panic!("no faces in {name}") };
        seen.push((faces.iter().map(<[i64]>::to_vec).collect::<Vec<_>>(), cells.cell(4).to_vec()));
    }
    assert!(seen.iter().all(|one| *one == seen[0]));
    assert_eq!(seen[0].0, [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]]);
}

#[test]
fn the_older_layout_of_polyhedra_survives() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>
      <Piece NumberOfPoints="4" NumberOfCells="1"><Points><DataArray type="Float64" NumberOfComponents="3">
        0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells>
      <DataArray type="Int32" Name="connectivity">0 1 2 3</DataArray><DataArray type="Int32" Name="offsets">4</DataArray>
      <DataArray type="UInt8" Name="types">42</DataArray>
      <DataArray type="Int32" Name="faces">4 3 0 1 2 3 0 1 3 3 1 2 3 3 0 2 3</DataArray>
      <DataArray type="Int32" Name="faceoffsets">17</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>"#;
    let dataset = super::read_text(&folder, "old.vtu", text.as_bytes()).unwrap();
    let Geometry::UnstructuredGrid { polyhedra: Some(Polyhedra::Stream { faces, offsets, .. }), .. } = &dataset.geometry else {
        panic!("no stream of faces")
    };
    assert_eq!((faces.len(), &offsets[..]), (17, &[17][..]));
    let copy = folder.path().join("copy.vtu");
    morsmooth::io::write(&copy, &dataset).unwrap();
    assert_eq!(content(&read(copy).unwrap()), content(&dataset));
}

#[test]
fn pieces_become_one_data_set() {
    let whole = read(file("poly_two_pieces.vtp")).unwrap();
    let one = read(file("poly_raw_zlib_64.vtp")).unwrap();
    // VTK writes the whole mesh into both pieces.
    assert_eq!(whole.point_count(), 2 * one.point_count());
    let Geometry::PolyData { verts, lines, polys, strips, .. } = &whole.geometry else { panic!("no poly data") };
    assert_eq!([verts, lines, polys, strips].map(|cells| cells.len()), [4, 4, 4, 2]);
    assert_eq!(polys.cell(3), [12, 13, 14, 15]);
    // All verts of both pieces come first, then all lines, polygons, strips.
    let material = whole.cell_array("material").unwrap();
    assert_eq!(material.data, ArrayData::I32(vec![0, 1, 0, 1, 2, 3, 2, 3, 4, 5, 4, 5, 6, 6]));
}

#[test]
fn pieces_of_an_image_are_placed_by_extent() {
    let folder = tempfile::tempdir().unwrap();
    let piece = |extent: &str, points: &str, cells: &str| {
        format!(
            r#"<Piece Extent="{extent}"><PointData><DataArray type="Float32" Name="f">{points}</DataArray></PointData>
            <CellData><DataArray type="Int8" Name="c">{cells}</DataArray></CellData></Piece>"#
        )
    };
    let text = format!(
        r#"<VTKFile type="ImageData" version="0.1"><ImageData WholeExtent="0 4 0 1 0 0">{}{}{}</ImageData></VTKFile>"#,
        piece("2 4 0 1 0 0", "2 3 4 12 13 14", "2 3"),
        piece("0 -1 0 -1 0 -1", "", ""),
        piece("0 2 0 1 0 0", "0 1 2 10 11 12", "0 1"),
    );
    let image = super::read_text(&folder, "pieces.vti", text.as_bytes()).unwrap();
    assert_eq!(image.point_array("f").unwrap().to_f64(0), [0.0, 1.0, 2.0, 3.0, 4.0, 10.0, 11.0, 12.0, 13.0, 14.0]);
    assert_eq!(image.cell_array("c").unwrap().to_f64(0), [0.0, 1.0, 2.0, 3.0]);
}

#[test]
fn empty_data_sets_are_read() {
    for name in ["empty.vtp", "empty_base64.vtu", "empty_42_ascii.vtk"] {
        let dataset = read(file(name)).unwrap();
        assert_eq!((dataset.point_count(), dataset.cell_count()), (0, 0), "{name}");
    }
}

#[test]
fn nan_and_infinity_are_read_from_ascii() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"<VTKFile type="ImageData" version="0.1"><ImageData WholeExtent="0 5 0 0 0 0"><Piece Extent="0 5 0 0 0 0">
        <PointData><DataArray type="Float64" Name="f" format="ascii">nan -nan(ind) inf -inf -0 1e-310</DataArray></PointData>
        </Piece></ImageData></VTKFile>"#;
    let image = super::read_text(&folder, "nan.vti", text.as_bytes()).unwrap();
    let values = image.point_array("f").unwrap().to_f64(0);
    assert!(values[0].is_nan() && values[1].is_nan());
    assert_eq!(values[2..4], [f64::INFINITY, f64::NEG_INFINITY]);
    assert_eq!(values[4].to_bits(), (-0.0f64).to_bits());
    assert_eq!(values[5], 1e-310);
}

#[test]
fn sections_of_a_legacy_file_may_come_in_parts() {
    let folder = tempfile::tempdir().unwrap();
    let text = "# vtk DataFile Version 2.0\r\nby hand\r\nASCII\r\nDATASET STRUCTURED_POINTS\r\nDIMENSIONS 2 1 1\r\nASPECT_RATIO 1 1 1\r\n\
        ORIGIN 0 0 0\r\nPOINT_DATA 2\r\nSCALARS a float\r\nLOOKUP_TABLE mine\r\n1 2\r\nLOOKUP_TABLE mine 1\r\n0 0.5 1 1\r\n\
        CELL_DATA 1\r\nSCALARS c int 1\r\nLOOKUP_TABLE default\r\n7\r\nPOINT_DATA 2\r\nVECTORS b double\r\n1 2 3 4 5 6\r\n";
    let image = super::read_text(&folder, "parts.vtk", text.as_bytes()).unwrap();
    assert_eq!(image.title, "by hand");
    assert_eq!(image.point_array("a").unwrap().data, ArrayData::F32(vec![1.0, 2.0]));
    assert_eq!(image.point_array("b").unwrap().to_f64(2), [3.0, 6.0]);
    assert_eq!(image.cell_array("c").unwrap().data, ArrayData::I32(vec![7]));
}
