//! `morsmooth pose`: what moves, what is kept, what is said and refused.

use super::Bench;
use morsmooth::audit::orientations;
use morsmooth::field::Precision;
use morsmooth::io::{ArrayData, DataArray, DataSet, Geometry, domain};
use morsmooth::mesh::Mask;

/// A flat bar of 9 x 3 points; the left two columns belong to "left", the right two to "right", linear between.
fn bar() -> DataSet {
    let mut text = String::from("OFF\n27 32 0\n");
    for y in 0..3 {
        (0..9).for_each(|x| text.push_str(&format!("{x} {y} 0\n")));
    }
    for y in 0..2 {
        for x in 0..8 {
            let [a, b, c, d] = [9 * y + x, 9 * y + x + 1, 9 * y + x + 10, 9 * y + x + 9];
            text.push_str(&format!("3 {a} {b} {c}\n3 {a} {c} {d}\n"));
        }
    }
    let bench = Bench::new();
    bench.text("bar.off", text);
    let mut dataset = bench.read("bar.off");
    let right: Vec<f64> = (0..27).map(|point| ((f64::from(point % 9) - 1.0) / 6.0).clamp(0.0, 1.0)).collect();
    dataset.set_point_array(DataArray::new("left", 1, ArrayData::F64(right.iter().map(|weight| 1.0 - weight).collect())));
    dataset.set_point_array(DataArray::new("right", 1, ArrayData::F64(right)));
    dataset.set_point_array(DataArray::new("kept", 1, ArrayData::I32((0..27).collect())));
    dataset.field_data.push(DataArray::new("handle_names", 1, ArrayData::String(vec!["left".into(), "right".into()])));
    dataset
}

const SHIFT: &str = r#"{"handles": {"right": {"translation": [3, 0, 0]}}}"#;

#[test]
fn a_shift_stretches_what_lies_between() {
    let bench = Bench::with(&bar());
    bench.text("pose.json", SHIFT);
    for method in ["lbs", "dqs"] {
        let run = bench.run(&["pose", "in.vtp", "in.vtp", "pose.json", "out.vtp", "--method", method, "--report", "r.json", "--plots", "p"]);
        assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
        assert!(run.stdout.contains("inverted        none of 32 elements; smallest det F 1.000000"), "{}", run.stdout);
        let (before, after) = (bench.read("in.vtp"), bench.read("out.vtp"));
        let weights = before.point_array("right").unwrap().to_f64(0);
        for (point, (old, new)) in before.points_f64().iter().zip(after.points_f64()).enumerate() {
            assert!((new[0] - old[0] - 3.0 * weights[point]).abs() < 1e-13 && new[1] == old[1] && new[2] == 0.0);
            let step = after.point_array("displacement").unwrap().to_f64(0)[point];
            assert!((step - 3.0 * weights[point]).abs() < 1e-13);
        }
        assert_eq!(before.point_array("kept"), after.point_array("kept"));
        assert_eq!(before.field_data, after.field_data);
        let report = bench.json("r.json");
        assert_eq!((report["inversions"]["count"].as_u64(), report["method"].as_str()), (Some(0), Some(method)));
        assert!(std::fs::read(bench.path("p/before_after.png")).unwrap().starts_with(b"\x89PNG"));
    }
}

#[test]
fn inverted_elements_are_counted_and_said() {
    let bench = Bench::with(&bar());
    bench.text("pose.json", r#"{"handles": {"right": {"translation": [-20, 0, 0]}}}"#);
    let run = bench.run(&["pose", "in.vtp", "in.vtp", "pose.json", "out.vtp", "--report", "r.json"]);
    // Six of eight columns lie between the handles, each mirrored: 24 of 32 triangles, det F = 1 - 20 / 6.
    assert_eq!(run.code, 0);
    assert!(run.stdout.contains("inverted        24 of 32 elements (cells 2, 3, 4, 5, 6, ...); smallest det F -2.333333"), "{}", run.stdout);
    assert_eq!(bench.json("r.json")["inversions"]["count"], 24);
}

#[test]
fn what_is_counted_is_what_exact_predicates_say_of_the_file() {
    let bench = Bench::with(&bar());
    let rest = domain(&bench.read("in.vtp"), &Mask::none()).unwrap().complex;
    // About 6 to the left everything between the handles is squeezed into one line.
    for left in ["-6", "-6.000000000000001", "-5.999999999999999"] {
        bench.text("pose.json", format!(r#"{{"handles": {{"right": {{"translation": [{left}, 0, 0]}}}}}}"#));
        let run = bench.run(&["pose", "in.vtp", "in.vtp", "pose.json", "out.vtu", "--method", "lbs", "--report", "r.json"]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        let judged = orientations(&rest, &[], &bench.read("out.vtu").points_f64(), Precision::F64).unwrap();
        let count = judged.inverted.len() + judged.degenerate.len();
        let report = bench.json("r.json");
        assert_eq!(report["inversions"]["count"], count, "{left}");
        assert_eq!(report["inversions"]["smallest_determinant"].as_f64().unwrap(), judged.smallest);
        assert!(left == "-5.999999999999999" || count > 0, "{left}");
    }
}

#[test]
fn single_precision_stays_and_other_files_hold_weights_and_result() {
    let mut dataset = bar();
    let Geometry::PolyData { points, .. } = &mut dataset.geometry else { panic!() };
    points.data = ArrayData::F32(points.to_f64(0).iter().zip(points.to_f64(1)).flat_map(|(x, y)| [*x as f32, y as f32, 0.0]).collect());
    let bench = Bench::with(&dataset);
    let bare = DataSet::new(dataset.geometry.clone());
    bench.put("mesh.vtp", &bare);
    // Half a turn about the middle of the right handle, which is (7.5, 1).
    bench.text("pose.json", r#"{"handles": {"right": {"rotation_degrees": 180}}}"#);
    let run = bench.run(&["pose", "mesh.vtp", "in.vtp", "pose.json", "out.vtu"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let out = bench.read("out.vtu");
    let Geometry::UnstructuredGrid { points, .. } = &out.geometry else { panic!("{}", out.geometry.name()) };
    assert!(matches!(points.data, ArrayData::F32(_)));
    let corner = out.points_f64()[8];
    assert!((corner[0] - 7.0).abs() < 1e-6 && (corner[1] - 2.0).abs() < 1e-6, "{corner:?}");
    let run = bench.run(&["pose", "mesh.vtp", "in.vtp", "pose.json", "out.obj", "-q"]);
    assert_eq!((run.code, run.stdout.as_str()), (0, ""), "{}", run.stderr);
    assert_eq!(bench.read("out.obj").points_f64()[8], corner);
    let run = bench.run(&["pose", "mesh.vtp", "in.vtp", "pose.json", "out.stl"]);
    assert!(run.stdout.contains("inverted        not counted: the format keeps no numbers of points"), "{}{}", run.stdout, run.stderr);
}

#[test]
fn a_pose_out_of_the_plane_is_not_counted() {
    let bench = Bench::with(&bar());
    bench.text("pose.json", r#"{"handles": {"right": {"rotation_degrees": 90, "axis": [1, 0, 0]}}}"#);
    let run = bench.run(&["pose", "in.vtp", "in.vtp", "pose.json", "out.vtp"]);
    assert_eq!(run.code, 0);
    assert!(run.stdout.contains("inverted        not counted: the pose leaves the plane, by up to "), "{}", run.stdout);
}

#[test]
fn the_bytes_do_not_depend_on_the_threads() {
    let bench = Bench::with(&bar());
    bench.text("pose.json", r#"{"handles": {"right": {"rotation_degrees": 77, "translation": [0.3, 0.1, 0]}}}"#);
    for threads in ["1", "2", "5"] {
        assert_eq!(bench.run(&["pose", "in.vtp", "in.vtp", "pose.json", &format!("out{threads}.vtp"), "--threads", threads]).code, 0);
    }
    let bytes = |name: &str| std::fs::read(bench.path(name)).unwrap();
    assert!(bytes("out1.vtp") == bytes("out2.vtp") && bytes("out1.vtp") == bytes("out5.vtp"));
}

#[test]
fn what_cannot_be_posed_is_refused() {
    let bench = Bench::with(&bar());
    bench.text("pose.json", SHIFT);
    bench.text("wrong.json", r#"{"handles": {"middle": {}}}"#);
    bench.text("pose.dmat", "1 4\n0 0 0 1\n");
    bench.text("handles.json", r#"{"handles": [{"name": "left", "point": [0, 0]}, {"name": "centre", "point": [4, 1]}]}"#);
    let mut bare = bar();
    bare.field_data.clear();
    bench.put("bare.vtp", &bare);
    bench.text("small.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    let refuse = |arguments: &[&str], words: &[&str]| bench.refuses(&[&["pose"], arguments].concat(), words);
    refuse(
        &["in.vtp", "bare.vtp", "pose.json", "out.vtp"],
        &["error: bare.vtp: found no field data array 'handle_names'; expected the names of the handles", "hint: "],
    );
    refuse(
        &["in.vtp", "small.off", "pose.json", "out.vtp"],
        &["error: small.off: found weights for 3 points; in.vtp has 27"],
    );
    refuse(
        &["in.vtp", "in.vtp", "wrong.json", "out.vtp"],
        &["error: wrong.json: found a pose for \"middle\"; expected one of the handles \"left\", \"right\""],
    );
    refuse(&["in.vtp", "in.vtp", "pose.dmat", "out.vtp"], &["error: pose.dmat: found 4 numbers; expected 4 for each of 0 bones"]);
    refuse(
        &["in.vtp", "in.vtp", "pose.json", "out.vtp", "--handles", "handles.json"],
        &["error: in.vtp: found no point array 'centre'; expected the weights of the handle \"centre\"", "hint: point arrays: left, right, kept"],
    );
    refuse(&["in.vtp", "in.vtp", "pose.json", "out.vtp", "--prefix", "w_"], &["error: in.vtp: found no point array 'w_left'"]);
    refuse(&["in.vtp", "in.vtp", "pose.json", "in.vtp"], &["error: in.vtp: the output is the input file"]);
    refuse(&["in.vtp", "in.vtp", "pose.json", "pose.json"], &["error: pose.json: the output would overwrite pose.json; expected another name"]);
    refuse(&["in.vtp", "in.vtp", "none.json", "out.vtp"], &["error: cannot read none.json: "]);
    refuse(&["in.vtp", "in.vtp", "pose.json", "out.vti"], &["error: out.vti: "]);
}

#[test]
fn outlines_are_filled_on_the_way() {
    let bench = Bench::new();
    bench.text("o.csv", "x,y\n0,0\n4,0\n4,1\n0,1\n");
    bench.text("bow.csv", "x,y\n0,0\n2,2\n2,0\n0,2\n");
    bench.text("pose.json", SHIFT);
    let run = bench.run(&["convert", "o.csv", "o.vtp", "--outline", "--max-edge", "10%"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let mesh = bench.read("o.vtp");
    assert!(matches!(mesh.geometry, Geometry::PolyData { .. }) && (60..600).contains(&mesh.cell_count()), "{}", mesh.cell_count());
    assert_eq!(mesh.points_f64()[1], [4.0, 0.0, 0.0]);
    bench.refuses(&["convert", "bow.csv", "bow.vtp", "--outline"], &["error: bow.csv: found the segment from point 0 of ring 0 to point 1 crosses"]);
    // An outline has no weights: they must come from a mesh that was made of it.
    bench.refuses(&["pose", "o.csv", "o.csv", "pose.json", "out.vtp"], &["error: o.csv: found no field data array 'handle_names'"]);
    bench.refuses(&["pose", "bow.csv", "bow.csv", "pose.json", "out.vtp"], &["error: bow.csv: found the segment from point 0 of ring 0 to point 1 crosses"]);
    bench.refuses(&["pose", "o.csv", "o.csv", "pose.json", "out.vtp", "--min-angle", "50"], &["found the smallest angle is 50; expected 0 to 33 degrees"]);
}
