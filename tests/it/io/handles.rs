//! Handles, poses and outlines from files.

use crate::mesh::shapes::grid;
use crate::support::shared;
use morsmooth::field::VertexId;
use morsmooth::io::{
    ArrayData, DataArray, DataSet, Geometry, outline_dataset, read_handles, read_keys, read_mesh_or_outline, read_outline, read_pose,
    region_handles,
};
use morsmooth::mesh::{Handle, HandleSet, HandleShape, HandleTransform, OutlineOptions, Rotation};
use std::path::PathBuf;
use tempfile::TempDir;

/// A folder with one file.
struct File {
    _folder: TempDir,
    path: PathBuf,
}

fn file(name: &str, text: impl AsRef<[u8]>) -> File {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    File { _folder: folder, path }
}

/// What is said of a file after its name.
fn words<T: std::fmt::Debug>(file: &File, result: Result<T, morsmooth::io::IoError>) -> String {
    let text = result.unwrap_err().to_string();
    text.strip_prefix(&file.path.display().to_string()).unwrap_or_else(|| panic!("{text}")).to_owned()
}

#[test]
fn json_handles() {
    let text = r#"{"handles": [
        {"name": "head", "point": [1, 2]}, {"name": "arm", "bone": [[0, 0, 0], [1, 1, 1]]}, {"name": "base", "region": [4, 5]},
        {"name": "foot", "point": [1, 2, 3]}], "cage": [["head", "foot"]]}"#;
    let set = read_handles(&file("h.json", text).path).unwrap();
    assert_eq!(set.names(), ["head", "arm", "base", "foot"]);
    assert_eq!(set.handles[0].shape, HandleShape::Point([1.0, 2.0, 0.0]));
    assert_eq!(set.handles[1].shape, HandleShape::Bone([[0.0; 3], [1.0; 3]]));
    assert_eq!(set.handles[2].shape, HandleShape::Region(vec![VertexId(4), VertexId(5)]));
    assert_eq!(set.cage_edges, [[0, 3]]);
    for (text, expected) in [
        ("{\"handles\": [\n{\"name\": \"a\", \"point\": [1]}]}", ", line 2: found 1 coordinates; expected 2 or 3"),
        ("{\"handles\": [{\"name\": \"a\"}]}", ": found none of them at handle \"a\"; expected one of \"point\", \"bone\", \"region\""),
        (
            "{\"handles\": [{\"name\": \"a\", \"point\": [0, 0], \"region\": [1]}]}",
            ": found several of them at handle \"a\"; expected one of \"point\", \"bone\", \"region\"",
        ),
        (
            "{\"handles\": [{\"name\": \"a\", \"point\": [0, 0]}], \"cage\": [[\"a\", \"b\"]]}",
            ": found a cage edge to \"b\"; expected the name of a handle of this file",
        ),
        ("{\"handles\": [{\"name\": \"a\", \"pint\": [0, 0]}]}", ", line 1: found unknown field `pint`; expected one of `name`, `point`, `bone`, `region`"),
        ("{\"handles\": ", ", line 1: found EOF while parsing a value; expected JSON as documented"),
    ] {
        let file = file("h.json", text);
        assert_eq!(words(&file, read_handles(&file.path)), expected);
    }
    let other = file("h.txt", "");
    assert_eq!(words(&other, read_handles(&other.path)), ": a file .txt cannot be read here; expected handles in a .json or .tgf file");
    assert!(read_handles("no/such.json").unwrap_err().to_string().starts_with("cannot read no/such.json: "));
}

#[test]
fn tgf_handles() {
    let text = "1 0 0 0 7 nan\n 2 1 0 0\n3 1 1 0\n4 5 5 0\n5 6 5 0\n#\n1 2\n2 3 1 0 0\n4 5 0 0 1\n1 3 0 1 0\n#\nanything\n";
    let set = read_handles(&file("h.tgf", text).path).unwrap();
    assert_eq!(set.names(), ["point_4", "point_5", "bone_1", "bone_2"]);
    assert_eq!(set.handles[0].shape, HandleShape::Point([5.0, 5.0, 0.0]));
    assert_eq!(set.handles[3].shape, HandleShape::Bone([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]));
    assert_eq!(set.cage_edges, [[0, 1]]);
    for (text, expected) in [
        ("", ": found no point; expected lines 'number x y z', a line '#', lines 'from to'"),
        ("1 0 0 0\n3 0 0 0\n", ", line 2: found \"3\"; expected '2 x y z'"),
        ("1 0 0\n", ", line 1: found 3 words; expected '1 x y z'"),
        ("1 0 zero 0\n", ", line 1: found \"zero\"; expected '1 x y z'"),
        ("1 0 0 0\n#\n1 2\n", ", line 3: found \"2\"; expected a point from 1 to 1"),
        ("1 0 0 0\n2 1 1 1\n#\n1 2 2\n", ", line 4: found \"2\"; expected 0 or 1"),
        ("1 0 0 0\n2 1 1 1\n#\n1\n", ", line 4: found 1 word; expected 'from to' or 'from to is_bone is_pseudo is_cage'"),
    ] {
        let file = file("h.tgf", text);
        assert_eq!(words(&file, read_handles(&file.path)), expected);
    }
}

/// Four points and two triangles.
fn square() -> DataSet {
    let mesh = file("m.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n");
    morsmooth::io::read(&mesh.path).unwrap()
}

#[test]
fn numbers_of_points_and_cells_are_regions() {
    let mut dataset = square();
    let regions = |dataset: &DataSet, name: &str| -> Result<Vec<(String, Vec<u32>)>, String> {
        let list = |handle: Handle| match handle.shape {
            HandleShape::Region(vertices) => (handle.name, vertices.iter().map(|vertex| vertex.0).collect()),
            other => panic!("{other:?}"),
        };
        region_handles(dataset, name).map(|set| set.handles.into_iter().map(list).collect())
    };
    dataset.set_point_array(DataArray::new("part", 1, ArrayData::I32(vec![0, 2, 1, 2])));
    assert_eq!(regions(&dataset, "part").unwrap(), [("part_1".to_owned(), vec![2]), ("part_2".to_owned(), vec![1, 3])]);
    // libigl marks points of no handle by -1.
    dataset.set_point_array(DataArray::new("part", 1, ArrayData::F64(vec![-1.0, 0.0, 1.0, -1.0])));
    assert_eq!(regions(&dataset, "part").unwrap(), [("part_0".to_owned(), vec![1]), ("part_1".to_owned(), vec![2])]);
    dataset.cell_data.arrays.push(DataArray::new("block", 1, ArrayData::U8(vec![0, 9])));
    assert_eq!(regions(&dataset, "block").unwrap(), [("block_9".to_owned(), vec![0, 2, 3])]);
    dataset.set_point_array(DataArray::new("part", 1, ArrayData::F64(vec![0.5, 0.0, 1.0, 1.0])));
    assert_eq!(regions(&dataset, "part").unwrap_err(), "found 0.5 at place 0 of array \"part\"; expected one whole number each");
    dataset.set_point_array(DataArray::new("part", 1, ArrayData::U8(vec![0; 4])));
    assert_eq!(regions(&dataset, "part").unwrap_err(), "array \"part\" has no number above 0 or above its lowest; expected one for each handle");
    assert_eq!(regions(&dataset, "x").unwrap_err(), "found no point or cell array \"x\"; expected one of: part, block");
}

fn two_bones() -> HandleSet {
    let bone = |name: &str, root, tip| Handle { name: name.into(), shape: HandleShape::Bone([root, tip]) };
    let elbow = [2.0, 0.0, 0.0];
    // The child first: parents are found by places, not by their order.
    let handles = vec![bone("lower", elbow, [4.0, 0.0, 0.0]), bone("upper", [0.0; 3], elbow), Handle { name: "p".into(), shape: HandleShape::Point([9.0; 3]) }];
    HandleSet { handles, cage_edges: Vec::new() }
}

#[test]
fn json_poses() {
    let (set, mesh) = (two_bones(), grid([3, 3, 1]));
    let text = r#"{"handles": {
        "lower": {"rotation_degrees": -450, "translation": [1, 2]},
        "p": {"quaternion": [0, 1, 0, 0], "scale": 2, "pivot": [1, 1, 1]}}}"#;
    let pose = read_pose(&file("p.json", text).path, &set, &mesh).unwrap();
    let Rotation::Angle(angle) = pose.transforms[0].rotation else { panic!("turns are lost") };
    assert!((angle.to_degrees() + 450.0).abs() < 1e-12);
    assert_eq!((pose.transforms[0].translation, pose.transforms[0].pivot), ([1.0, 2.0, 0.0], [2.0, 0.0, 0.0]));
    assert_eq!(pose.transforms[1], HandleTransform::REST);
    assert_eq!((pose.transforms[2].scale, pose.transforms[2].pivot), (2.0, [1.0; 3]));
    // Half a turn about the x axis.
    let moved = pose.transforms[2].apply([1.0, 2.0, 3.0]);
    assert!(moved.iter().zip([1.0, -1.0, -3.0]).all(|(a, b)| (a - b).abs() < 1e-15), "{moved:?}");
    for (text, expected) in [
        ("{\"handles\": {\"leg\": {}}}", ": found a pose for \"leg\"; expected one of the handles \"lower\", \"upper\", \"p\""),
        ("{\"handles\": {\"p\": {},\n\"p\": {}}}", ", line 2: found \"p\" for the second time; expected each name once"),
        ("{\"handles\": {\"p\": {\"scale\": 0}}}", ": found scale 0 at handle \"p\"; expected a positive number"),
        ("{\"handles\": {\"p\": {\"axis\": [0, 0, 1]}}}", ": found an axis without \"rotation_degrees\" at handle \"p\"; expected both"),
        (
            "{\"handles\": {\"p\": {\"axis\": [0, 0, 0], \"rotation_degrees\": 1}}}",
            ": found the axis [0.0, 0.0, 0.0] at handle \"p\"; expected an axis with a direction",
        ),
        ("{\"handles\": {\"p\": {\"quaternion\": [1, 1, 0, 0]}}}", ": found a quaternion of length 1.4142 at handle \"p\"; expected length 1"),
        (
            "{\"handles\": {\"p\": {\"quaternion\": [1, 0, 0, 0], \"rotation_degrees\": 3}}}",
            ": found a quaternion and a rotation at handle \"p\"; expected one of them",
        ),
    ] {
        let file = file("p.json", text);
        assert_eq!(words(&file, read_pose(&file.path, &set, &mesh)), expected);
    }
}

#[test]
fn keys_of_an_animation() {
    let (set, mesh) = (two_bones(), grid([3, 3, 1]));
    let keys = file("k.json", r#"{"keys": [{"time": 0, "handles": {}}, {"time": 2.5, "handles": {"p": {"translation": [1, 0, 0]}}}]}"#);
    let keys = read_keys(&keys.path, &set, &mesh).unwrap();
    assert_eq!((keys.len(), keys[1].0, keys[1].1.transforms[2].translation), (2, 2.5, [1.0, 0.0, 0.0]));
    for (text, expected) in [
        (r#"{"keys": [{"time": 0, "handles": {}}]}"#, ": found 1 keys; expected at least two"),
        (r#"{"keys": [{"time": 1, "handles": {}}, {"time": 1, "handles": {}}]}"#, ": found time 1 after time 1; expected times that rise"),
    ] {
        let file = file("k.json", text);
        assert_eq!(words(&file, read_keys(&file.path, &set, &mesh)), expected);
    }
}

/// The parent turns by 90 degrees about z, the child by another 90 about its own root: the arm comes back on itself.
#[test]
fn dmat_poses_hang_from_their_parents() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let numbers = [0.0, 0.0, half, half, 0.0, 0.0, half, half].map(|number| number.to_string()).join("\n");
    let (set, mesh) = (two_bones(), grid([3, 3, 1]));
    let pose = read_pose(&file("p.dmat", format!("1 8\n{numbers}\n")).path, &set, &mesh).unwrap();
    let near = |found: [f64; 3], expected: [f64; 3]| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12);
    assert!(near(pose.transforms[1].apply([2.0, 0.0, 0.0]), [0.0, 2.0, 0.0]));
    assert!(near(pose.transforms[0].apply([2.0, 0.0, 0.0]), [0.0, 2.0, 0.0]), "the elbow is one place");
    assert!(near(pose.transforms[0].apply([4.0, 0.0, 0.0]), [-2.0, 2.0, 0.0]));
    assert_eq!(pose.transforms[2], HandleTransform::REST);
    for (text, expected) in [
        ("1 7\n0 0 0 1 0 0 0\n", ": found 7 numbers; expected 4 for each of 2 bones"),
        ("1 8\n0 0 0 1 0 0 0 0\n", ": found the quaternion [0, 0, 0, 0] of bone 2; expected one that is not zero"),
        ("1 8\n0 0\n", ", line 3: found 1 x 8 numbers in 5 bytes; expected as many as there are"),
        ("1 8\n0 0 0 1 0 0 0 x\n", ", line 2: found \"x\"; expected a number"),
    ] {
        let file = file("p.dmat", text);
        assert!(words(&file, read_pose(&file.path, &set, &mesh)).ends_with(expected.split_once(": ").unwrap().1), "{expected}");
    }
}

#[test]
fn the_pose_of_the_hand_keeps_its_joints() {
    let (Some(handles), Some(pose)) = (shared("tets/hand.tgf"), shared("tets/hand-pose.dmat")) else { return };
    let set = read_handles(handles).unwrap();
    let pose = read_pose(pose, &set, &grid([2, 2, 2])).unwrap();
    let ends = |place: usize| if let HandleShape::Bone(ends) = set.handles[place].shape { ends } else { panic!() };
    let mut joints = 0;
    for child in 0..set.len() {
        for parent in (0..set.len()).filter(|&parent| ends(parent)[1] == ends(child)[0]) {
            let [a, b] = [child, parent].map(|bone| pose.transforms[bone].apply(ends(child)[0]));
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12));
            joints += 1;
        }
    }
    assert_eq!(joints, 19);
    assert!(pose.transforms.iter().any(|transform| transform.rotation.quaternion()[0] < 0.99));
}

#[test]
fn outlines_in_their_forms() {
    let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let second = [[5.0, 5.0], [6.0, 5.0], [5.0, 6.0]];
    for text in [
        "x,y\n0,0\n1,0\n0,1\n\n5,5\n6,5\n5,6\n",
        "0 0\n1 0\n0 1\n\n\n5 5\n6 5\n5 6\n",
        "# a remark\n\"y\";\"x\"\n0;0\n0;1\n1;0\n\n5;5\n5;6\n6;5\n",
        "ring,x,y\na,0,0\nb,5,5\na,1,0\nb,6,5\na,0,1\n\nb,5,6\r\n",
        "\u{feff}X\tY\n0\t0\n1\t0\n0\t1\n\n5\t5\n6\t5\n5\t6",
        "  # remarks end no ring\n  0   0\n1 0\n# one\n# two\n0 1\n   \n# three\n5 5\n6 5\n5 6\n\n",
        "x;y;name\n0,0;0;\"a b\"\n1,0;0;c\n0;1;d\n\r\n5;5;e\n6;5;f\n5;6;g\n",
    ] {
        assert_eq!(read_outline(&file("o.csv", text).path).unwrap(), [triangle, second], "{text}");
    }
    for (text, expected) in [
        ("", ": found no row; expected a table with at least one"),
        ("x,y\n\n", ": found no place; expected lines with x and y"),
        ("a,b\n1,2\n", ": found the columns \"a, b\"; expected two columns of numbers, or a head with columns \"x\" and \"y\""),
        ("1\n2\n3\n", ": found the columns \"column_1\"; expected two columns of numbers, or a head with columns \"x\" and \"y\""),
        ("x,y\n1,2\n1\n", ", line 3: found 1 cells; expected 2 as in line 1"),
        ("x,y\n1,two\n", ", line 2, column 2: found \"two\" in column \"y\"; expected a finite number, or nothing"),
        ("x,y\n1,inf\n", ", line 2, column 2: found \"inf\" in column \"y\"; expected a finite number, or nothing"),
        ("x,y\n1,2\n\n# two\n1,\n", ", line 5, column 2: found \"\"; expected a coordinate"),
    ] {
        let file = file("o.csv", text);
        assert_eq!(words(&file, read_outline(&file.path)), expected);
    }
    let latin = file("o.csv", b"x,y\n\xff");
    assert_eq!(words(&latin, read_outline(&latin.path)), ", line 2, column 1: found \"\u{fffd}\"; expected text in UTF-8");
}

#[test]
fn an_outline_becomes_a_mesh_with_its_places_first() {
    let outline = file("o.csv", "x,y\n0,0\n2,0\n2,1\n0,1\n");
    let dataset = read_mesh_or_outline(&outline.path, &OutlineOptions::default()).unwrap();
    assert!(matches!(dataset.geometry, Geometry::PolyData { .. }));
    assert_eq!(dataset.points_f64()[..4], [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    assert!(dataset.cell_count() > 100);
    let bow = file("o.csv", "x,y\n0,0\n2,2\n2,0\n0,2\n");
    assert_eq!(
        words(&bow, outline_dataset(&bow.path, &OutlineOptions::default())),
        ": found the segment from point 0 of ring 0 to point 1 crosses the segment from point 2 of ring 0 to point 3 at (1.000000, 1.000000); \
         expected rings that do not cross"
    );
}

#[test]
fn the_outlines_of_countries_are_filled() {
    for name in ["planar/outline_italy.csv", "planar/outline_norway.csv"] {
        let Some(path) = shared(name) else { return };
        let rings = read_outline(&path).unwrap();
        let dataset = outline_dataset(&path, &OutlineOptions::default()).unwrap();
        let given: usize = rings.iter().map(Vec::len).sum();
        assert!(dataset.point_count() > given);
    }
}
