//! Bad handles and bad meshes under handles: each named with its place; and the whole way from an outline to a posed shape.

use super::Bench;
use crate::support::dataset;
use morsmooth::io::Geometry;

/// A square of 5 x 5 points, unit spacing, with more points, and more triangles after its 32.
fn square(points: &str, triangles: &str) -> String {
    let mut text = format!("OFF\n{} {} 0\n", 25 + points.lines().count(), 32 + triangles.lines().count());
    (0..25).for_each(|point| text.push_str(&format!("{} {} 0\n", point % 5, point / 5)));
    text.push_str(points);
    for y in 0..4 {
        for x in 0..4 {
            let [a, b, c, d] = [5 * y + x, 5 * y + x + 1, 5 * y + x + 6, 5 * y + x + 5];
            text.push_str(&format!("3 {a} {b} {c}\n3 {a} {c} {d}\n"));
        }
    }
    text + triangles
}

const CORNERS: &str = r#"{"handles": [{"name": "a", "point": [0, 0]}, {"name": "b", "point": [4, 4]}]}"#;

#[test]
fn bad_handles_are_named_with_their_places() {
    let bench = Bench::new();
    bench.text("m.off", square("", ""));
    for (name, text, words) in [
        (
            "far.json",
            r#"{"handles": [{"name": "a", "point": [0, 0]}, {"name": "hand", "point": [9, 2]}]}"#,
            "handle \"hand\" is outside the mesh: [9.0, 2.0, 0.0] is 5.000e0 from the nearest vertex 14",
        ),
        (
            "same.json",
            r#"{"handles": [{"name": "a", "point": [1, 1]}, {"name": "b", "point": [1.1, 1]}]}"#,
            "handles \"a\" and \"b\" are both at vertex 6 at [1.0, 1.0, 0.0]; expected a vertex each",
        ),
        ("none.json", r#"{"handles": []}"#, "no handle; expected at least one"),
        ("empty.json", r#"{"handles": [{"name": "r", "region": []}]}"#, "handle \"r\" has no vertex: its list of vertices is empty"),
        ("out.json", r#"{"handles": [{"name": "r", "region": [25]}]}"#, "region \"r\" names vertex 25; expected less than 25"),
        (
            "bone.json",
            r#"{"handles": [{"name": "a", "point": [0, 0]}, {"name": "arm", "bone": [[2, 2], [2, 9]]}]}"#,
            "handle \"arm\" is outside the mesh: [2.0, ",
        ),
        ("broken.json", "{\"handles\":\n [{\"name\": \"a\" \"point\": [0, 0]}]}", "broken.json, line 2: found "),
        ("broken.tgf", "1 0 0 0\n2 4 4\n", "broken.tgf, line 2: found 3 words; expected '2 x y z'"),
    ] {
        bench.text(name, text);
        bench.refuses(&["weights", "m.off", "o.vtp", "--handles", name], &["error: ", words]);
    }
}

#[test]
fn bad_meshes_under_handles_are_named_with_their_places() {
    let bench = Bench::new();
    bench.text("h.json", CORNERS);
    // Two parts, of which the second has no handle.
    bench.text("parts.off", square("9 9 0\n10 9 0\n9 10 0\n", "3 25 26 27\n"));
    bench.refuses(
        &["weights", "parts.off", "o.vtp", "--handles", "h.json"],
        &["the part of 3 vertices around vertex 25 at [9.0, 9.0, 0.0] has no handle (2 connected parts in all); expected a handle on every part"],
    );
    // A triangle without area.
    bench.text("flat.off", square("", "3 0 1 2\n"));
    bench.refuses(&["weights", "flat.off", "o.vtp", "--handles", "h.json"], &["error: flat.off: ", "32"]);
    // A point of no cell.
    bench.text("lonely.off", square("9 9 0\n", ""));
    bench.refuses(&["weights", "lonely.off", "o.vtp", "--handles", "h.json"], &["error: lonely.off: 1 points belong to no cell, first point 25"]);
}

#[test]
fn from_an_outline_to_a_posed_shape() {
    let bench = Bench::new();
    for name in ["cactus.csv", "cactus_handles.json", "cactus_pose.json"] {
        std::fs::copy(dataset(name), bench.path(name)).unwrap();
    }
    let run = bench.run(&["weights", "cactus.csv", "w.vtp", "--handles", "cactus_handles.json", "--method", "harmonic", "--max-edge", "5%", "-q"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let weighed = bench.read("w.vtp");
    let Geometry::PolyData { polys, .. } = &weighed.geometry else { panic!("{}", weighed.geometry.name()) };
    assert!(polys.len() > 300, "{}", polys.len());
    for method in ["lbs", "dqs"] {
        let run = bench.run(&["pose", "w.vtp", "w.vtp", "cactus_pose.json", "posed.vtp", "--method", method]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        // With or without the file of handles the bones turn about their roots.
        let again = bench.run(&["pose", "w.vtp", "w.vtp", "cactus_pose.json", "again.vtp", "--method", method, "--handles", "cactus_handles.json"]);
        assert_eq!(again.code, 0, "{}", again.stderr);
        assert_eq!(bench.read("posed.vtp").points_f64(), bench.read("again.vtp").points_f64());
    }
}
