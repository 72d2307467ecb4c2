//! What the versions of VTK's formats change about cells.

use morsmooth::io::{CellArray, DataSet, Geometry, Polyhedra, read, write};

use super::read_text;

/// One cell of a legacy file, version 5.1: its points, its list in the file, and its type.
fn legacy(version: &str, points: usize, list: &[i64], kind: u8) -> String {
    let positions: String = (0..points).map(|point| format!("{point} {} {}\n", point * point % 5, point % 3)).collect();
    let words: Vec<String> = list.iter().map(i64::to_string).collect();
    let (count, words) = (list.len(), words.join(" "));
    let cells = match version {
        "5.1" => format!("CELLS 2 {count}\nOFFSETS vtktypeint64\n0 {count}\nCONNECTIVITY vtktypeint64\n{words}"),
        _ => format!("CELLS 1 {}\n{count} {words}", count + 1),
    };
    format!("# vtk DataFile Version {version}\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {points} float\n{positions}{cells}\nCELL_TYPES 1\n{kind}\n")
}

fn cells(dataset: &DataSet) -> (&CellArray, &Option<Polyhedra>) {
    let Geometry::UnstructuredGrid { cells, polyhedra, .. } = &dataset.geometry else { panic!("{}", dataset.geometry.name()) };
    (cells, polyhedra)
}

#[test]
fn the_points_of_a_legacy_polyhedron_stand_by_number() {
    let folder = tempfile::tempdir().unwrap();
    // A tetrahedron whose first face names its points in another order, as PyVista saves it.
    let faces = [4, 3, 0, 2, 1, 3, 0, 1, 3, 3, 0, 3, 2, 3, 1, 2, 3];
    for version in ["4.2", "5.1"] {
        let dataset = read_text(&folder, "a.vtk", legacy(version, 4, &faces, 42).as_bytes()).unwrap();
        let (cells, polyhedra) = cells(&dataset);
        assert_eq!(cells.cell(0), [0, 1, 2, 3], "{version}");
        let Some(Polyhedra::Lists { faces, .. }) = polyhedra else { panic!("no faces") };
        assert_eq!(faces.cell(0), [0, 2, 1], "{version}");
    }
}

/// VTK exchanges the points of two edges of these cells when it reads files older than 2.1, or than 5.1 of the legacy format: what
/// was read must be written in a version that means the same.
#[test]
fn higher_order_hexahedra_are_written_in_the_version_that_their_points_are_in() {
    let folder = tempfile::tempdir().unwrap();
    let list: Vec<i64> = (0..27).collect();
    let head = |name: &str, dataset: &DataSet| {
        let path = folder.path().join(name);
        write(&path, dataset).unwrap();
        let again = read(&path).unwrap();
        assert_eq!(cells(&again).0.cell(0), list);
        assert_eq!(again.version >= Some([2, 1]), dataset.version >= Some([2, 1]));
        let bytes = std::fs::read(path).unwrap();
        let says = |line: &&[u8]| line.starts_with(b"# vtk") || line.starts_with(b"<VTKFile");
        String::from_utf8_lossy(bytes.split(|&byte| byte == b'\n').find(says).unwrap()).into_owned()
    };
    for kind in [72, 79] {
        let late = read_text(&folder, "late.vtk", legacy("5.1", 27, &list, kind).as_bytes()).unwrap();
        assert!(head("a.vtu", &late).contains("version=\"2.1\""));
        assert_eq!(head("a.vtk", &late), "# vtk DataFile Version 5.1");
        // The road back through XML.
        let again = read(folder.path().join("a.vtu")).unwrap();
        assert_eq!(head("b.vtk", &again), "# vtk DataFile Version 5.1");
        let early = read_text(&folder, "early.vtk", legacy("4.2", 27, &list, kind).as_bytes()).unwrap();
        assert!(head("c.vtu", &early).contains("version=\"1.0\""));
        assert_eq!(head("c.vtk", &early), "# vtk DataFile Version 4.2");
    }
    // Where the order is always the same, the oldest version does.
    let wedge = read_text(&folder, "wedge.vtk", legacy("5.1", 18, &list[..18], 73).as_bytes()).unwrap();
    assert_eq!(wedge.version, None);
}
