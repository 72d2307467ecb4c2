//! `weights`: what it writes, what it promises, what it refuses.

use morsmooth::audit::audit_plateaus;
use morsmooth::field::VertexId;
use morsmooth::io::{ArrayData, DataSet, domain};
use morsmooth::mesh::Mask;

use super::Bench;
use super::fields::{cells, lattice, squares, surface};

const HANDLES: &str = r#"{"handles": [{"name": "low", "point": [0, 0, 0]}, {"name": "bar", "bone": [[6, 4, 0], [9, 4, 0]]},
    {"name": "patch", "region": [138, 139, 151, 152]}]}"#;

/// A lattice of 13 x 12 points, some of them moved.
fn bench() -> Bench {
    let mut points = lattice(13, 12);
    for (index, point) in points.iter_mut().enumerate() {
        if index % 3 == 1 && index > 60 && index % 13 != 0 && index % 13 != 12 && index < 143 {
            point[0] += 0.2;
        }
    }
    let values: Vec<f64> = (0..points.len()).map(|index| index as f64).collect();
    let bench = Bench::with(&surface(&points, cells(4, &squares(13, 12)), &values));
    bench.text("handles.json", HANDLES);
    bench
}

fn column(dataset: &DataSet, name: &str) -> Vec<f64> {
    dataset.point_array(name).unwrap_or_else(|| panic!("no array {name}")).to_f64(0)
}

#[test]
fn weights_are_written_audited_and_told() {
    let bench = bench();
    for order in ["1", "2", "3"] {
        let run = bench.run(&["weights", "in.vtp", "out.vtp", "--handles", "handles.json", "--order", order, "--report", "report.json"]);
        assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
        assert!(run.stdout.contains("audit           passed: no extremum but at the handles"), "{}", run.stdout);
        let (before, after, report) = (bench.read("in.vtp"), bench.read("out.vtp"), bench.json("report.json"));
        for array in &before.point_data.arrays {
            assert_eq!(after.point_array(&array.name), Some(array), "an array of the input was changed");
        }
        let names = after.field_data.iter().find(|array| array.name == "handle_names").unwrap().to_texts();
        assert_eq!(names, ["low", "bar", "patch"]);
        let complex = domain(&after, &Mask::none()).unwrap().complex;
        let patch = column(&after, "patch");
        for point in [138, 139, 151, 152] {
            assert_eq!(patch[point], 1.0);
        }
        let given: Vec<(VertexId, f64)> = (0..patch.len())
            .filter(|&point| ["low", "bar", "patch"].iter().any(|name| column(&after, name)[point] == 1.0))
            .map(|point| (VertexId::from(point), patch[point]))
            .collect();
        let verdict = audit_plateaus(&complex, &patch, &given).unwrap();
        assert!(verdict.passed, "{verdict:?}");
        assert_eq!(report["passed"], true);
        assert_eq!(report["handles"][2]["audit"]["maxima"], 1);
        assert!(report["off_unity"].as_f64().unwrap() < 1e-2);
    }
}

#[test]
fn the_other_methods_promise_nothing_and_are_counted() {
    let bench = bench();
    for method in ["harmonic", "polyharmonic", "bounded"] {
        let run = bench.run(&["weights", "in.vtp", "out.vtp", "--handles", "handles.json", "--method", method, "--quiet"]);
        assert_eq!(run.code, 0, "{method}: {}", run.stderr);
        let after = bench.read("out.vtp");
        let sums: Vec<f64> = (0..156).map(|point| ["low", "bar", "patch"].iter().map(|name| column(&after, name)[point]).sum()).collect();
        assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-9), "{method}");
    }
}

#[test]
fn options_do_what_they_say() {
    let bench = bench();
    let base = ["weights", "in.vtp", "out.vtp", "--handles", "handles.json", "--quiet"];
    let run = |more: &[&str]| bench.run(&[&base[..], more].concat());
    assert_eq!(run(&["--precision", "32", "--prefix", "w_"]).code, 0);
    assert!(matches!(bench.read("out.vtp").point_array("w_bar").unwrap().data, ArrayData::F32(_)));
    assert_eq!(run(&["--partition", "coupled"]).code, 0);
    let after = bench.read("out.vtp");
    let sum = |point: usize| ["low", "bar", "patch"].iter().map(|name| column(&after, name)[point]).sum::<f64>();
    assert!((0..156).all(|point| (sum(point) - 1.0).abs() < 1e-9));
    let pruned = run(&["--strongest", "2", "--keep-unaudited", "--plots", "pictures"]);
    assert!(pruned.code <= 1, "{}", pruned.stderr);
    let after = bench.read("out.vtp");
    assert!((0..156).all(|point| ["low", "bar", "patch"].iter().filter(|name| column(&after, name)[point] > 0.0).count() <= 2));
    assert!(bench.path("pictures/bar.png").exists());

    // Locked points keep what the file says.
    let mut dataset = bench.read("in.vtp");
    let mut locked = vec![0.0; 156];
    let mut bar = vec![0.0; 156];
    (locked[80], bar[80]) = (1.0, 0.25);
    dataset.set_point_array(super::fields::doubles("locked", &locked));
    dataset.set_point_array(super::fields::doubles("bar", &bar));
    bench.put("locked.vtp", &dataset);
    let call = ["weights", "locked.vtp", "out.vtp", "--handles", "handles.json", "--quiet", "--locked", "locked", "--partition", "free"];
    let found = bench.run(&call);
    assert_eq!(found.code, 0, "{}", found.stderr);
    let after = bench.read("out.vtp");
    assert_eq!((column(&after, "bar")[80], column(&after, "low")[80]), (0.25, 0.0));
}

#[test]
fn bad_input_is_refused_by_name() {
    let bench = bench();
    let refuses = |mesh: &str, handles: &str, words: &[&str]| {
        bench.text("bad.json", handles);
        bench.refuses(&["weights", mesh, "out.vtp", "--handles", "bad.json"], words);
    };
    refuses("in.vtp", r#"{"handles": [{"name": "far", "point": [50, 0, 0]}]}"#, &["far", "outside the mesh"]);
    refuses("in.vtp", r#"{"handles": [{"name": "none", "region": []}]}"#, &["none", "no vertex"]);
    let two = r#"{"handles": [{"name": "a", "point": [1, 1, 0]}, {"name": "b", "point": [1.1, 1, 0]}]}"#;
    refuses("in.vtp", two, &["\"a\" and \"b\"", "vertex 14"]);
    refuses("in.vtp", r#"{"handles": [{"name": "a", "region": [999]}]}"#, &["999"]);
    bench.refuses(&["weights", "in.vtp", "in.vtp", "--handles", "handles.json"], &["the output is the input file"]);
    bench.refuses(
        &["weights", "in.vtp", "out.vtp", "--handles", "handles.json", "--method", "bounded", "--partition", "coupled"],
        &["expected --method monotone"],
    );

    let mut points = lattice(13, 12);
    points[30] = [11.6, 10.7, 0.0];
    let values = vec![0.0; 156];
    bench.put("folded.vtp", &surface(&points, cells(4, &squares(13, 12)), &values));
    refuses("folded.vtp", HANDLES, &["folded.vtp", "cells", "one of them is inverted"]);

    let mut points = lattice(13, 12);
    points.push([20.0, 0.0, 0.0]);
    bench.put("loose.vtp", &surface(&points, cells(4, &squares(13, 12)), &[0.0; 157]));
    refuses("loose.vtp", HANDLES, &["1 points belong to no cell, first point 156"]);

    // Two squares apart, handles on one of them.
    let apart = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [6.0, 1.0, 0.0], [5.0, 1.0, 0.0]];
    bench.put("apart.vtp", &surface(&apart, cells(4, &[0, 1, 2, 3, 4, 5, 6, 7]), &[0.0; 8]));
    let one = r#"{"handles": [{"name": "a", "point": [0, 0, 0]}, {"name": "b", "point": [1, 1, 0]}]}"#;
    refuses("apart.vtp", one, &["part of 4 vertices", "no handle"]);

    let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
    bench.put("flat.vtp", &surface(&flat, cells(3, &[0, 1, 2, 0, 1, 3]), &[0.0; 4]));
    refuses("flat.vtp", one, &["zero measure", "[0, 1, 2]"]);
}
