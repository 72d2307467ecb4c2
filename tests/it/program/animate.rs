//! `morsmooth animate`: frames in time, each free of inversions, with the same bits for any number of threads.

use morsmooth::plot::Photograph;

use super::Bench;
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

/// A photograph of 48 x 32 pixels, red rising to the right and green upwards, with keys that bend its middle.
fn photograph() -> Bench {
    let bench = Bench::new();
    let pixels = (0..48 * 32).map(|at| [(at % 48 * 5) as u8, (155 - at / 48 * 5) as u8, 90, 255]).collect();
    Photograph::new(48, 32, pixels).unwrap().write_png(&bench.path("in.png")).unwrap();
    bench.text(
        "h.json",
        r#"{"handles": [{"name": "a", "point": [0, 0]}, {"name": "b", "point": [48, 0]}, {"name": "c", "point": [0, 32]},
            {"name": "middle", "bone": [[20, 16], [28, 16]]}]}"#,
    );
    bench.text("keys.json", r#"{"keys": [{"time": 0, "handles": {}}, {"time": 1, "handles": {"middle": {"translation": [6, 4], "rotation_degrees": 40, "pivot": [24, 16]}}}]}"#);
    bench
}

#[test]
fn frames_of_a_photograph_have_pictures() {
    let bench = photograph();
    let animate = ["--handles", "h.json", "--keys", "keys.json", "--frames", "4", "--triangles", "300"];
    for threads in ["1", "3"] {
        let output = format!("t{threads}.pvd");
        let run = bench.run(&[&["animate", "in.png", &output, "--threads", threads, "--report", "r.json"][..], &animate].concat());
        assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
        assert!(run.stdout.contains("4 from 2 keys, each with a picture"), "{}", run.stdout);
    }
    let bytes = |name: String| std::fs::read(bench.path(&name)).unwrap();
    for frame in 0..4 {
        for ending in ["vtu", "png"] {
            assert!(bytes(format!("t1_000{frame}.{ending}")) == bytes(format!("t3_000{frame}.{ending}")), "frame {frame}");
        }
        assert!(bench.json("r.json")["frames"][frame]["picture"].as_str().unwrap().ends_with(&format!("t3_000{frame}.png")));
    }
    let picture = |name: &str| Photograph::read_png(&bench.path(name)).unwrap();
    // The picture of a key is that of 'deform'.
    bench.text("p.json", r#"{"handles": {"middle": {"translation": [6, 4], "rotation_degrees": 40, "pivot": [24, 16]}}}"#);
    let run = bench.run(&["deform", "in.png", "out.png", "-q", "--handles", "h.json", "--pose", "p.json", "--triangles", "300"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(picture("out.png") == picture("t1_0003.png"));
    // What was in the middle moves to the right and up by the same share in every frame.
    let red = |name: &str, x: usize, y: usize| f64::from(picture(name).pixels()[y * 48 + x][0]);
    for frame in 0..4 {
        let shift = 6.0 * frame as f64 / 3.0;
        let (x, y) = (24 + shift as usize, 16 - (4.0 * frame as f64 / 3.0).round() as usize);
        let found = red(&format!("t1_000{frame}.png"), x, y) / 5.0;
        assert!((found - 24.0).abs() < 1.5, "frame {frame}: {found}");
    }
}

#[test]
fn a_photograph_besides_a_mesh_is_warped_with_it() {
    let bench = photograph();
    let animate = ["--handles", "h.json", "--keys", "keys.json", "--frames", "3"];
    let run = bench.run(&[&["animate", "in.png", "own.pvd", "--triangles", "300", "-q"][..], &animate].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    // The mesh of the first frame is the one at rest.
    let run = bench.run(&[&["animate", "own_0000.vtu", "film.pvd", "--image", "in.png", "-q"][..], &animate].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    for frame in 0..3 {
        let read = |name: &str| Photograph::read_png(&bench.path(&format!("{name}_000{frame}.png"))).unwrap();
        let (own, film) = (read("own"), read("film"));
        let off = own.pixels().iter().zip(film.pixels()).map(|(a, b)| (0..4).map(|c| a[c].abs_diff(b[c])).max().unwrap()).max().unwrap();
        assert!(off <= 3, "frame {frame}: {off}");
    }
    bench.text("keys_0001.png", b"what is here stays");
    bench.refuses(
        &[&["animate", "own_0000.vtu", "keys.pvd", "--image", "keys_0001.png"][..], &animate].concat(),
        &["keys_0001.png"],
    );
    std::fs::copy(bench.path("in.png"), bench.path("film2_0001.png")).unwrap();
    bench.refuses(
        &[&["animate", "own_0000.vtu", "film2.pvd", "--image", "film2_0001.png"][..], &animate].concat(),
        &["film2_0001.png: the frame would overwrite film2_0001.png; expected another output"],
    );
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
