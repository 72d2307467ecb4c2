//! `morsmooth animate`: frames in time, each free of inversions, with the same bits for any number of threads.

use super::deform::{inverted, square};

const KEYS: &str = r#"{"keys": [
    {"time": 0, "handles": {}},
    {"time": 1, "handles": {"middle": {"rotation_degrees": 90, "pivot": [0.5, 0.5], "translation": [0.2, 0]}}},
    {"time": 3, "handles": {"middle": {"rotation_degrees": -60, "pivot": [0.5, 0.5]}}}]}"#;
const ANIMATE: [&str; 6] = ["--handles", "h.json", "--keys", "keys.json", "--frames", "7"];

#[test]
fn frames_pass_through_the_keys_without_inversions() {
    let bench = square(10, 0.0, false);
    bench.text("keys.json", KEYS);
    let run = bench.run(&[&["animate", "in.vtu", "film.pvd", "--report", "r.json"][..], &ANIMATE].concat());
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    assert!(run.stdout.contains("passed in all 7 frames"), "{}", run.stdout);
    let collection = std::fs::read_to_string(bench.path("film.pvd")).unwrap();
    let rest = bench.read("in.vtu");
    for frame in 0..7 {
        let name = format!("film_{frame:04}.vtu");
        assert!(collection.contains(&format!("timestep=\"{}\"", 0.5 * frame as f64)) && collection.contains(&name), "{collection}");
        assert_eq!(inverted(&rest, &bench.read(&name)), [0, 0]);
    }
    assert_eq!(bench.json("r.json")["frames"].as_array().unwrap().len(), 7);
    // At rest nothing moves; at a key the frame is the pose of that key, bit by bit.
    let still = bench.read("film_0000.vtu").points_f64();
    let off = still.iter().flatten().zip(rest.points_f64().iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-7, "{off}");
    bench.text("p.json", r#"{"handles": {"middle": {"rotation_degrees": 90, "pivot": [0.5, 0.5], "translation": [0.2, 0]}}}"#);
    let run = bench.run(&["deform", "in.vtu", "out.vtu", "-q", "--handles", "h.json", "--pose", "p.json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(bench.read("out.vtu").points_f64(), bench.read("film_0002.vtu").points_f64());
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let bench = square(8, 0.0, true);
    bench.text("keys.json", KEYS);
    for threads in ["1", "3"] {
        let output = format!("t{threads}.pvd");
        let run = bench.run(&[&["animate", "in.vtu", &output, "-q", "--threads", threads][..], &ANIMATE].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
    }
    for frame in 0..7 {
        let bytes = |threads: &str| std::fs::read(bench.path(&format!("t{threads}_{frame:04}.vtu"))).unwrap();
        assert!(bytes("1") == bytes("3"), "frame {frame}");
    }
}

#[test]
fn one_bad_frame_keeps_all_from_being_written() {
    let bench = square(8, 0.0, false);
    // The middle is pushed through the corner in the east.
    bench.text("keys.json", KEYS.replace("[0.2, 0]", "[0.9, -0.5]"));
    let run = bench.run(&[&["animate", "in.vtu", "film.pvd", "--method", "ex-rotated"][..], &ANIMATE].concat());
    let left: Vec<_> = std::fs::read_dir(bench.path(".")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(run.code, 1, "{}{}", run.stdout, run.stderr);
    assert!(run.stdout.contains("was not written"), "{}", run.stdout);
    assert_eq!(left.len(), 4, "{left:?}");
}

#[test]
fn refusals_name_what_is_wrong() {
    let bench = square(4, 0.0, false);
    bench.text("keys.json", KEYS);
    let rig = &["--handles", "h.json", "--keys", "keys.json"];
    bench.refuses(&[&["animate", "in.vtu", "film.vtu"][..], rig].concat(), &["found another ending than .pvd"]);
    bench.refuses(&[&["animate", "in.vtu", "film.pvd", "--frames", "0"][..], rig].concat(), &["--frames"]);
    bench.text("keys.json", r#"{"keys": [{"time": 1, "handles": {}}]}"#);
    bench.refuses(&[&["animate", "in.vtu", "film.pvd"][..], rig].concat(), &["keys.json", "1 keys", "at least two"]);
    bench.text("keys.json", r#"{"keys": [{"time": 1, "handles": {}}, {"time": 1, "handles": {}}]}"#);
    bench.refuses(&[&["animate", "in.vtu", "film.pvd"][..], rig].concat(), &["time 1 after time 1", "times that rise"]);
}
