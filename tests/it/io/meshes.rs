//! Mesh files of other programs, read, written and damaged.

use morsmooth::io::{
    ArrayData, CellArray, DataArray, DataSet, Geometry, GeometryKind, MaskSources, domain, losses, mask, read, reshape, write,
};

use super::damage::Random;
use super::read_text;
use crate::support::shared;

const TETRAHEDRON: u8 = 10;

fn text(folder: &tempfile::TempDir, name: &str, text: &str) -> Result<DataSet, String> {
    read_text(folder, name, text.as_bytes()).map_err(|error| {
        let message = error.to_string();
        message[message.find(name).unwrap()..].to_owned()
    })
}

fn polygons(dataset: &DataSet) -> Vec<Vec<i64>> {
    let Geometry::PolyData { polys, .. } = &dataset.geometry else { panic!("no poly data") };
    polys.iter().map(<[i64]>::to_vec).collect()
}

/// Two tetrahedra on five points with arrays of several types.
fn pair() -> DataSet {
    let points = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.1 + 0.2, 1.0, 1e-7, -1.0, 1.0 / 3.0];
    let mut cells = CellArray::default();
    cells.push([0, 1, 2, 3]);
    cells.push([1, 0, 4, 3]);
    let points = DataArray::new("Points", 3, ArrayData::F64(points));
    let geometry = Geometry::UnstructuredGrid { points, cells, types: vec![TETRAHEDRON; 2], polyhedra: None };
    let mut dataset = DataSet::new(geometry);
    dataset.set_point_array(DataArray::new("height", 1, ArrayData::F64(vec![0.0, -0.5, 1.0 / 3.0, 4e300, 5.0])));
    dataset.cell_data.set(DataArray::new("medit:ref", 1, ArrayData::I32(vec![7, -2])));
    dataset
}

/// A quad, a triangle and a hexagon of single-precision points, coloured.
fn patch() -> DataSet {
    let points: Vec<f32> = (0..9).flat_map(|point| [point as f32 * 0.1, (point * point) as f32, -1.0 / (point + 1) as f32]).collect();
    let mut polys = CellArray::default();
    polys.push([0, 1, 2, 3]);
    polys.push([2, 1, 4]);
    polys.push([3, 4, 5, 6, 7, 8]);
    let geometry = Geometry::PolyData {
        points: DataArray::new("Points", 3, ArrayData::F32(points)),
        verts: CellArray::default(),
        lines: CellArray::default(),
        polys,
        strips: CellArray::default(),
    };
    let mut dataset = DataSet::new(geometry);
    dataset.set_point_array(DataArray::new("RGB", 3, ArrayData::U8((0..27).collect())));
    dataset.set_point_array(DataArray::new("Normals", 3, ArrayData::F32(vec![0.5; 27])));
    dataset.set_point_array(DataArray::new("height", 1, ArrayData::F64((0..9).map(|x| f64::from(x).sqrt()).collect())));
    dataset.cell_data.set(DataArray::new("part", 1, ArrayData::I16(vec![3, -1, 9])));
    dataset
}

#[test]
fn an_obj_file_gives_points_in_their_order_whoever_uses_them() {
    let folder = tempfile::tempdir().unwrap();
    let source = "# head\nv 0 0 0\nv 1 0 0 1.0\nvt 0 0\nv 1 1 0\nv 9 9 9\nv 0 1 0\nvn 0 0 1\ng part\nf 1/1 2/1/1 3//1 -1\nf 1 2 \\\n 3\nl 1 4\np 2\n";
    let dataset = text(&folder, "a.obj", source).unwrap();
    assert_eq!(dataset.points_f64(), [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [9.0; 3], [0.0, 1.0, 0.0]]);
    assert_eq!(polygons(&dataset), [vec![0, 1, 2, 4], vec![0, 1, 2]]);
    let Geometry::PolyData { verts, lines, .. } = &dataset.geometry else { panic!() };
    assert_eq!((verts.connectivity.as_slice(), lines.connectivity.as_slice()), (&[1][..], &[0, 3][..]));
}

#[test]
fn an_off_file_may_have_comments_and_colours() {
    let folder = tempfile::tempdir().unwrap();
    let source = "COFF # coloured\n# more\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0.5 0.5 0.5\n0 1 0 1 2 3\n3 0 1 2 255 0 0\n";
    let dataset = text(&folder, "a.off", source).unwrap();
    assert_eq!((dataset.point_count(), polygons(&dataset)), (3, vec![vec![0, 1, 2]]));
}

#[test]
fn a_medit_file_keeps_its_labels_and_skips_what_is_no_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let source = "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\nRidges\n1\n1\n\
                  Normals\n1\n0.5 0.5 1e-3\nTriangles 1\n1 2 3 5\nTetrahedra\n1\n1 2 3 4 6\nEnd\n";
    let dataset = text(&folder, "a.mesh", source).unwrap();
    assert_eq!(dataset.cell_array("medit:ref").unwrap().data, ArrayData::I32(vec![5, 6]));
    assert_eq!(dataset.point_array("medit:ref").unwrap().data, ArrayData::I32(vec![1, 0, 0, 0]));
    let Geometry::UnstructuredGrid { types, cells, .. } = &dataset.geometry else { panic!() };
    assert_eq!((types.as_slice(), cells.cell(1)), (&[5, TETRAHEDRON][..], &[0, 1, 2, 3][..]));
    let flat = "MeshVersionFormatted 1\nDimension\n2\nVertices\n3\n0 0 0\n1 0 0\n0 1 0\nTriangles\n1\n1 2 3 0\n";
    assert_eq!(text(&folder, "b.mesh", flat).unwrap().points_f64()[2], [0.0, 1.0, 0.0]);
}

#[test]
fn gmsh_files_of_both_versions_give_the_same_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let old = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n$EndNodes\n\
               $Elements\n2\n7 2 2 3 1 10 20 30\n9 4 2 4 2 10 20 30 40\n$EndElements\n\
               $NodeData\n1\n\"t\"\n1\n0.0\n3\n0\n1\n2\n10 1.5\n40 2.5\n$EndNodeData\n";
    let new = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Comments\nanything\n$EndComments\n\
               $Entities\n0 0 1 1\n1 0 0 0 1 1 0 1 3 0\n2 0 0 0 1 1 1 1 4 1 1\n$EndEntities\n\
               $Nodes\n2 4 10 40\n2 1 0 3\n10\n20\n30\n0 0 0\n1 0 0\n0 1 0\n3 2 0 1\n40\n0 0 1\n$EndNodes\n\
               $Elements\n2 2 7 9\n2 1 2 1\n7 10 20 30\n3 2 4 1\n9 10 20 30 40\n$EndElements\n\
               $NodeData\n1\n\"t\"\n1\n0.0\n3\n0\n1\n2\n10 1.5\n40 2.5\n$EndNodeData\n";
    let (old, new) = (text(&folder, "a.msh", old).unwrap(), text(&folder, "b.msh", new).unwrap());
    // NaN is where a node has no value.
    assert_eq!(format!("{old:?}"), format!("{new:?}"));
    assert_eq!(old.cell_array("gmsh:physical").unwrap().data, ArrayData::I32(vec![3, 4]));
    let values = old.point_array("t").unwrap().to_f64(0);
    assert_eq!((values[0], values[3]), (1.5, 2.5));
    assert!(values[1].is_nan() && values[2].is_nan());
}

#[test]
fn a_binary_gmsh_file_of_either_byte_order_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let make = |bytes4: fn(i32) -> [u8; 4], bytes8: fn(u64) -> [u8; 8], real: fn(f64) -> [u8; 8]| {
        let mut file = b"$MeshFormat\n4.1 1 8\n".to_vec();
        file.extend(bytes4(1));
        file.extend(b"\n$EndMeshFormat\n$Nodes\n");
        file.extend([1, 3, 1, 3].into_iter().flat_map(bytes8));
        file.extend([2, 1, 0].into_iter().flat_map(bytes4));
        file.extend([3, 1, 2, 3].into_iter().flat_map(bytes8));
        file.extend([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0].into_iter().flat_map(real));
        file.extend(b"\n$EndNodes\n$Elements\n");
        file.extend([1, 1, 1, 1].into_iter().flat_map(bytes8));
        file.extend([2, 1, 2].into_iter().flat_map(bytes4));
        file.extend([1, 5, 3, 1, 2].into_iter().flat_map(bytes8));
        file.extend(b"\n$EndElements\n");
        file
    };
    let little = make(i32::to_le_bytes, u64::to_le_bytes, f64::to_le_bytes);
    let big = make(i32::to_be_bytes, u64::to_be_bytes, f64::to_be_bytes);
    let read = |bytes: &[u8]| read_text(&folder, "a.msh", bytes).unwrap();
    assert_eq!(read(&little), read(&big));
    assert_eq!(read(&little).points_f64()[2], [0.0, 2.0, 0.0]);
    let Geometry::UnstructuredGrid { cells, .. } = read(&little).geometry else { panic!() };
    assert_eq!(cells.cell(0), [2, 0, 1]);
}

#[test]
fn ply_files_keep_types_and_groups() {
    let folder = tempfile::tempdir().unwrap();
    let source = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  property uchar red\nproperty uchar green\nproperty uchar blue\nproperty double quality\nelement face 2\n\
                  property list uchar int vertex_indices\nproperty int part\nelement edge 1\nproperty int vertex1\nproperty int vertex2\n\
                  property int part\nend_header\n0 0 0 1 2 3 0.1\n1 0 0 4 5 6 0.2\n1 1 0 7 8 9 0.3\n0 1 0 10 11 12 0.4\n\
                  3 0 1 2 5\n3 0 2 3 6\n1 3 7\n";
    let dataset = text(&folder, "a.ply", source).unwrap();
    assert_eq!(dataset.point_array("RGB").unwrap().data, ArrayData::U8((1..=12).collect()));
    assert_eq!(dataset.point_array("quality").unwrap().data, ArrayData::F64(vec![0.1, 0.2, 0.3, 0.4]));
    assert_eq!(polygons(&dataset), [[0, 1, 2], [0, 2, 3]]);
    // Lines come before polygons in VTK, and so do their numbers.
    assert_eq!(dataset.cell_array("part").unwrap().to_f64(0), [7.0, 5.0, 6.0]);
    let Geometry::PolyData { points, .. } = &dataset.geometry else { panic!() };
    assert!(matches!(points.data, ArrayData::F32(_)));
}

#[test]
fn texture_coordinates_of_a_ply_file_are_one_array_whatever_their_names() {
    let folder = tempfile::tempdir().unwrap();
    for (first, second) in [("u", "v"), ("s", "t"), ("texture_u", "texture_v")] {
        let source = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float {first}\n\
             property float {second}\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
             0 0 0 0.5 1\n1 0 0 0.25 0\n0 1 0 1 0\n3 0 1 2\n"
        );
        let dataset = text(&folder, "a.ply", &source).unwrap();
        let array = dataset.point_array("TCoords").unwrap();
        assert_eq!((array.components, &array.data), (2, &ArrayData::F32(vec![0.5, 1.0, 0.25, 0.0, 1.0, 0.0])));
        write(folder.path().join("b.ply"), &dataset).unwrap();
        assert_eq!(read(folder.path().join("b.ply")).unwrap().point_data, dataset.point_data);
    }
}

#[test]
fn what_a_format_holds_survives_it_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let back = |dataset: &DataSet, name: &str| {
        let path = folder.path().join(name);
        write(&path, dataset).unwrap();
        read(&path).unwrap()
    };
    let (tets, faces) = (pair(), patch());
    let medit = back(&tets, "a.mesh");
    assert_eq!((&medit.geometry, medit.cell_array("medit:ref")), (&tets.geometry, tets.cell_array("medit:ref")));
    let gmsh = back(&tets, "a.msh");
    assert_eq!((&gmsh.geometry, gmsh.point_array("height")), (&tets.geometry, tets.point_array("height")));
    assert_eq!(gmsh.cell_array("medit:ref").unwrap().to_f64(0), [7.0, -2.0]);
    let ply = back(&faces, "a.ply");
    assert_eq!((ply.geometry, ply.point_data.arrays, ply.cell_data.arrays), (faces.geometry.clone(), faces.point_data.arrays.clone(), faces.cell_data.arrays.clone()));
    for name in ["a.obj", "a.off"] {
        let text = back(&faces, name);
        assert_eq!((polygons(&text), text.point_count()), (polygons(&faces), 9), "{name}");
        let same = text.points_f64().iter().zip(faces.points_f64()).all(|(a, b)| (0..3).all(|i| a[i] as f32 == b[i] as f32));
        assert!(same, "{name}");
    }
    let losses = |name: &str, dataset: &DataSet| losses(folder.path().join(name), dataset).unwrap();
    assert!(losses("a.ply", &faces).is_empty() && losses("a.vtp", &faces).is_empty());
    assert_eq!(losses("a.off", &faces).len(), 4);
    assert_eq!(losses("a.mesh", &tets), ["point array \"height\""]);
}

#[test]
fn an_stl_file_joins_equal_corners() {
    let folder = tempfile::tempdir().unwrap();
    let source = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n\
                  facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
    let dataset = text(&folder, "a.stl", source).unwrap();
    assert_eq!((dataset.point_count(), polygons(&dataset)), (4, vec![vec![0, 1, 2], vec![1, 3, 2]]));
    let path = folder.path().join("b.stl");
    write(&path, &dataset).unwrap();
    assert_eq!(read(&path).unwrap(), dataset);
    assert_eq!(std::fs::metadata(&path).unwrap().len(), 84 + 2 * 50);
    let error = write(folder.path().join("c.stl"), &patch()).unwrap_err().to_string();
    assert!(error.ends_with("found cell 0 of VTK type 9 with 4 points; expected triangles"), "{error}");
    assert!(!folder.path().join("c.stl").exists());
}

#[test]
fn bad_mesh_files_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("a.obj", "f 1 2 3\n", "a.obj, line 1: found point 1; expected points from 1 to 0"),
        ("a.obj", "v 0 0 0\nv 1 x 0\n", "a.obj, line 2: found \"x\"; expected a coordinate"),
        ("a.obj", "v 0 0\n", "a.obj, line 1: found 2 coordinates; expected three"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "a.obj, line 3: found \"f\" with 2 points; expected at least 3"),
        ("a.obj", "v 0 0 0\nf 1 1 2\n", "a.obj, line 2: found point 2; expected points from 1 to 1"),
        ("a.obj", "hello\n", "a.obj: found no line that begins with \"v\"; expected the points of a Wavefront .obj file"),
        ("a.off", "OFFF\n", "a.off, line 1: found \"OFFF\"; expected OFF, COFF, NOFF, CNOFF or STOFF"),
        ("a.off", "OFF\n1000000000000 1 0\n", "a.off, line 2: found 1000000000000 points and 1 faces in 1 bytes; expected as many as there are"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a.off, line 6: found point 3; expected points from 0, less than 3"),
        ("a.mesh", "Vertices\n1\n", "a.mesh, line 1: found \"Vertices\"; expected MeshVersionFormatted"),
        ("a.mesh", "MeshVersionFormatted 1\nVertices\n1\n0 0 0 0\nTriangles\n1\n1 1 0 0\n", "a.mesh, line 7: found point 9223372036854775807; expected points from 1 to 1"),
        ("a.msh", "$MeshFormat\n3 0 8\n$EndMeshFormat\n", "a.msh, line 2: version 3 of .msh cannot be read here; expected 2.2 or 4.1"),
        ("a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n", "a.msh, line 7: found the end of the file; expected $EndNodes"),
        ("a.ply", "ply\nformat ascii 1.0\nelement vertex 9999999999\nproperty float x\nend_header\n", "a.ply: found 9999999999 elements \"vertex\" in 75 bytes; expected as many as there are"),
    ];
    for (name, source, expected) in cases {
        assert_eq!(text(&folder, name, source).unwrap_err(), expected, "{source}");
    }
}

#[test]
fn damaged_mesh_files_are_never_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(20);
    for name in ["a.obj", "a.off", "a.ply", "a.stl", "a.mesh", "a.msh"] {
        let dataset = match name {
            "a.mesh" | "a.msh" => pair(),
            "a.stl" => text(&folder, "seed.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 2 4 3\n").unwrap(),
            _ => patch(),
        };
        let path = folder.path().join(name);
        write(&path, &dataset).unwrap();
        let whole = std::fs::read(&path).unwrap();
        for trial in 0..400 {
            let mut bytes = whole.clone();
            if trial % 2 == 0 {
                bytes.truncate(random.below(whole.len()));
            } else {
                for _ in 0..=random.below(4) {
                    let place = random.below(bytes.len());
                    bytes[place] = random.below(256) as u8;
                }
            }
            match read_text(&folder, &format!("damaged{name}"), &bytes) {
                Ok(read) => drop(mask(&read, &MaskSources::default()).map(|mask| domain(&read, &mask))),
                Err(error) => assert!(error.to_string().contains("expected"), "{error}"),
            }
        }
    }
}

#[test]
fn grids_become_meshes_with_the_cells_of_vtk() {
    let image = |dimensions: [i32; 3]| {
        let [x, y, z] = dimensions;
        let extent = morsmooth::io::Extent([2, x + 1, 0, y - 1, 0, z - 1]);
        let direction = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        DataSet::new(Geometry::ImageData { extent, origin: [1.0, 0.0, 0.0], spacing: [0.5, 1.0, 2.0], direction })
    };
    for (dimensions, kind, curved) in [([3, 1, 1], 3, 3), ([3, 2, 1], 8, 9), ([3, 2, 2], 11, 12), ([1, 1, 1], 1, 1)] {
        let grid = image(dimensions);
        let cells_of = |dataset: DataSet| match reshape(dataset, GeometryKind::UnstructuredGrid).unwrap().geometry {
            Geometry::UnstructuredGrid { cells, types, points, .. } => (cells, types, points.to_f64(0)),
            _ => panic!(),
        };
        let (cells, types, x) = cells_of(grid.clone());
        assert!(types.iter().all(|&found| found == kind) && cells.len() == grid.cell_count());
        assert_eq!(x, grid.points_f64().iter().map(|point| point[0]).collect::<Vec<f64>>());
        let (around, types, _) = cells_of(reshape(grid.clone(), GeometryKind::StructuredGrid).unwrap());
        assert!(types.iter().all(|&found| found == curved));
        if kind == 8 {
            assert_eq!((cells.cell(1), around.cell(1)), (&[1, 2, 4, 5][..], &[1, 2, 5, 4][..]));
        }
        let rectilinear = reshape(grid.clone(), GeometryKind::RectilinearGrid).unwrap();
        assert_eq!(rectilinear.points_f64(), grid.points_f64());
    }
    let error = reshape(pair(), GeometryKind::PolyData).unwrap_err().to_string();
    assert_eq!(error, "found cell 0 of VTK type 10; expected vertices, lines and polygons (types 1 to 7 and 9)");
    assert!(reshape(patch(), GeometryKind::ImageData).is_err());
}

#[test]
fn real_meshes_are_read_and_make_domains() {
    for (name, points, simplices) in [
        ("surfaces/beetle.off", 19887, 38656),
        ("surfaces/spot.obj", 11533, 23062),
        ("planar/woody.obj", 694, 1267),
        ("planar/snake.msh", 3321, 6156),
        ("tets/hand.mesh", 7234, 29998),
        ("tets/bunny.mesh", 5433, 34055),
        ("tets/sphere5K.msh", 7034, 27792),
    ] {
        let Some(path) = shared(name) else { continue };
        let dataset = read(&path).unwrap();
        let built = domain(&dataset, &mask(&dataset, &MaskSources::default()).unwrap()).unwrap();
        assert_eq!((dataset.point_count(), built.complex.simplex_count()), (points, simplices), "{name}");
    }
}
