//! Parallel files of real VTK (and one with ghost cells, its pieces written by real VTK) become one data set without seams.

use std::path::{Path, PathBuf};

use morsmooth::io::{Geometry, IoError, MaskSources, domain, mask, read};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/io/files/parallel").join(name)
}

/// Vertices, triangles and Euler characteristic of the domain of a file.
fn counts(name: &str) -> (usize, usize, i64) {
    let dataset = read(file(name)).unwrap();
    let domain = domain(&dataset, &mask(&dataset, &MaskSources::default()).unwrap()).unwrap();
    let complex = &domain.complex;
    let mut edges: Vec<[u32; 2]> = complex
        .simplices()
        .chunks(3)
        .flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[0], t[2]]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let (vertices, triangles) = (complex.vertex_count(), complex.simplex_count());
    (vertices, triangles, vertices as i64 - edges.len() as i64 + triangles as i64)
}

#[test]
fn ghost_cells_are_left_out_and_seams_are_closed() {
    // 7 x 3 squares, cut in two, with one column of ghosts.
    assert_eq!(counts("ghosts.pvtu"), (32, 42, 1));
    let dataset = read(file("ghosts.pvtu")).unwrap();
    let field = dataset.point_array("f").unwrap().to_f64(0);
    for (place, value) in dataset.points_f64().iter().zip(field) {
        assert_eq!(value, (place[0] * 0.7).sin() + place[1] * place[1], "{place:?}");
    }
    assert!(dataset.cell_array("vtkGhostType").unwrap().to_f64(0).iter().all(|&mark| mark == 0.0));
}

#[test]
fn shared_points_that_differ_by_rounding_are_one() {
    // VTK's sphere in two pieces: both compute the meridian between them, and not to the same bits.
    assert_eq!(counts("sphere.pvtp"), (20, 36, 2));
}

#[test]
fn pieces_of_an_image_are_put_where_their_extents_say() {
    let dataset = read(file("wavelet.pvti")).unwrap();
    let Geometry::ImageData { extent, origin, spacing, .. } = &dataset.geometry else { panic!("{}", dataset.geometry.name()) };
    assert_eq!((extent.0, *origin, *spacing), ([-3, 4, 0, 5, 0, 0], [0.0; 3], [1.0; 3]));
    let values = dataset.point_array("RTData").unwrap().to_f64(0);
    // The wavelet's formula: 255 exp(-d²/2) at the centre, and sines and a cosine beside it.
    let middle = values[3];
    assert!(values.iter().all(|&value| value <= middle + 10.0) && values.len() == 48);
}

fn refusal(folder: &tempfile::TempDir, name: &str, text: &str) -> String {
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    let error = read(&path).unwrap_err();
    assert!(matches!(error, IoError::Malformed { .. } | IoError::Unsupported { .. } | IoError::Read { .. }));
    error.to_string().replace(&format!("{}/", folder.path().display()), "")
}

fn parallel(pieces: &str) -> String {
    format!("<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\">\n<PUnstructuredGrid>\n{pieces}\n</PUnstructuredGrid>\n</VTKFile>\n")
}

#[test]
fn broken_indices_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |pieces: &str| refusal(&folder, "a.pvtu", &parallel(pieces));
    assert_eq!(refused(""), "a.pvtu, line 2: found <PUnstructuredGrid> that names no file; expected <Piece Source=\"name of a file\">");
    assert_eq!(refused("<Piece/>"), "a.pvtu, line 3: found <Piece> without Source; expected Source=\"name of a file\"");
    assert!(refused("<Piece Source=\"none.vtu\"/>").starts_with("cannot read none.vtu: "));
    // A file cannot lead to itself.
    let own = refused("<Piece Source=\"a.pvtu\"/>");
    assert!(own.contains("type=\"PUnstructuredGrid\" cannot be read here"), "{own}");
    std::fs::copy(file("wavelet_0.vti"), folder.path().join("w.vti")).unwrap();
    assert_eq!(refused("<Piece Source=\"w.vti\"/>"), "a.pvtu, line 3: found ImageData in \"w.vti\"; expected UnstructuredGrid");
}

#[test]
fn pieces_of_different_states_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let triangle = |name: &str, corner: f64, value: f64| {
        let text = format!(
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\"><UnstructuredGrid><Piece NumberOfPoints=\"3\" NumberOfCells=\"1\">\
             <PointData><DataArray type=\"Float64\" Name=\"p\" format=\"ascii\">{value} 2 3</DataArray></PointData>\
             <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 {corner} 1 0</DataArray></Points>\
             <Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>\
             <DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">3</DataArray>\
             <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>"
        );
        std::fs::write(folder.path().join(name), text).unwrap();
    };
    triangle("one.vtu", 0.0, 1.0);
    triangle("two.vtu", 5.0, 1.5);
    let pieces = parallel("<Piece Source=\"one.vtu\"/>\n<Piece Source=\"two.vtu\"/>");
    assert_eq!(
        refusal(&folder, "a.pvtu", &pieces),
        "a.pvtu: found 1.0 and 1.5 in array \"p\" for the point at [0.0, 0.0, 0.0] that two pieces share; expected the same values: pieces of one state"
    );
}

/// ParaView computes the normals of a contour in each piece from the triangles that it has.
#[test]
fn normals_may_differ_at_a_seam() {
    let folder = tempfile::tempdir().unwrap();
    for (name, corner, normal) in [("one.vtp", 0.0, "0 0 1"), ("two.vtp", 5.0, "0 0.6 0.8")] {
        let normals = [normal; 3].join(" ");
        let text = format!(
            "<VTKFile type=\"PolyData\" version=\"1.0\"><PolyData><Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\">\
             <PointData Normals=\"Normals\"><DataArray type=\"Float32\" Name=\"Normals\" NumberOfComponents=\"3\">{normals}</DataArray></PointData>\
             <Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">0 0 0 1 0 0 {corner} 1 0</DataArray></Points>\
             <Polys><DataArray type=\"Int64\" Name=\"connectivity\">0 1 2</DataArray>\
             <DataArray type=\"Int64\" Name=\"offsets\">3</DataArray></Polys></Piece></PolyData></VTKFile>"
        );
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let index = "<VTKFile type=\"PPolyData\" version=\"1.0\"><PPolyData><Piece Source=\"one.vtp\"/><Piece Source=\"two.vtp\"/></PPolyData></VTKFile>";
    std::fs::write(folder.path().join("a.pvtp"), index).unwrap();
    let dataset = read(folder.path().join("a.pvtp")).unwrap();
    assert_eq!((dataset.point_count(), dataset.cell_count()), (4, 2));
    let normals = dataset.point_array("Normals").unwrap();
    assert_eq!((normals.to_f64(1)[..2].to_vec(), normals.to_f64(2)[3]), (vec![0.0; 2], f64::from(0.8f32)));
}

/// Two pieces of one row of five points that overlap by a cell, each marking the other's as a copy.
#[test]
fn nothing_of_a_joined_grid_is_a_copy() {
    let folder = tempfile::tempdir().unwrap();
    for (name, extent, marks) in [("one.vti", "0 3 0 0 0 0", "0 0 1"), ("two.vti", "2 4 0 0 0 0", "1 0")] {
        let text = format!(
            "<VTKFile type=\"ImageData\" version=\"1.0\"><ImageData WholeExtent=\"{extent}\"><Piece Extent=\"{extent}\"><CellData>\
             <DataArray type=\"UInt8\" Name=\"vtkGhostType\">{marks}</DataArray></CellData></Piece></ImageData></VTKFile>"
        );
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let index = "<VTKFile type=\"PImageData\" version=\"1.0\"><PImageData WholeExtent=\"0 4 0 0 0 0\" GhostLevel=\"1\">\
                 <Piece Extent=\"0 3 0 0 0 0\" Source=\"one.vti\"/><Piece Extent=\"2 4 0 0 0 0\" Source=\"two.vti\"/></PImageData></VTKFile>";
    std::fs::write(folder.path().join("a.pvti"), index).unwrap();
    let dataset = read(folder.path().join("a.pvti")).unwrap();
    assert_eq!((dataset.point_count(), dataset.cell_array("vtkGhostType").unwrap().to_f64(0)), (5, vec![0.0; 4]));
}

#[test]
fn a_collection_of_several_is_no_data_set() {
    let folder = tempfile::tempdir().unwrap();
    let collection = |entries: &str| format!("<VTKFile type=\"Collection\" version=\"0.1\"><Collection>{entries}</Collection></VTKFile>");
    std::fs::copy(file("wavelet_0.vti"), folder.path().join("w.vti")).unwrap();
    let one = "<DataSet timestep=\"0\" file=\"w.vti\"/>";
    std::fs::write(folder.path().join("one.pvd"), collection(one)).unwrap();
    assert_eq!(read(folder.path().join("one.pvd")).unwrap(), read(file("wavelet_0.vti")).unwrap());
    assert_eq!(
        refusal(&folder, "two.pvd", &collection(&one.repeat(2))),
        "two.pvd: a collection of 2 time steps as one data set cannot be read here; expected one of them, such as two.pvd/0 (there are 0, 1)"
    );
}
