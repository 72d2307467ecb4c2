//! `info`, `extrema` and `check`.

use super::fields::{doubles, hilly, image, lattice, plain_extrema, surface, unstructured};
use super::{Bench, fields};

#[test]
fn info_shows_what_a_file_holds() {
    let bench = Bench::with(&hilly(24, 18));
    let run = bench.run(&["info", "in.vti", "--report", "r.json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    for words in ["ImageData, 432 points, 391 cells", "Float64 h (", "dimension 2, 432 vertices", "1 component(s), Euler characteristic 1"] {
        assert!(run.stdout.contains(words), "no {words:?} in {}", run.stdout);
    }
    let report = bench.json("r.json");
    assert_eq!((&report["kind"], &report["points"], &report["cells"]), (&"ImageData".into(), &432.into(), &391.into()));
    assert_eq!((&report["domain"]["vertices"], &report["domain"]["components"]), (&432.into(), &1.into()));
    assert_eq!((&report["point_arrays"][0]["name"], &report["point_arrays"][0]["type"]), (&"h".into(), &"Float64".into()));
}

#[test]
fn info_names_the_faults_of_a_mesh() {
    // Three triangles at one edge, one of them twice, a spare point, and a triangle without area.
    let mut points = lattice(3, 2);
    points.extend([[0.5, 0.5, 1.0], [9.0, 9.0, 9.0], [2.0, 0.0, 0.0]]);
    let triangles = fields::cells(3, &[0, 1, 3, 1, 3, 4, 1, 3, 6, 0, 1, 3, 0, 1, 2]);
    let bench = Bench::with(&surface(&points, triangles, &(0..9).map(f64::from).collect::<Vec<_>>()));
    let run = bench.run(&["info", "in.vtp", "--report", "r.json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    for words in [
        "edge between points 1 and 3 has 3 triangles",
        "1 cells repeat simplices of earlier cells, first cell 3 those of cell 0",
        "points belong to no cell, first point 5",
        "refused      cell 4 holds a simplex of zero measure on points [0, 1, 2]",
    ] {
        assert!(run.stdout.contains(words), "no {words:?} in {}", run.stdout);
    }
    let faults = bench.json("r.json")["faults"].as_array().unwrap().len();
    assert!(faults >= 4, "{faults}");
}

#[test]
fn extrema_are_counted_and_listed() {
    let bench = Bench::with(&hilly(24, 18));
    let run = bench.run(&["extrema", "in.vti", "--report", "r.json", "--plots", "a/b"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let dataset = bench.read("in.vti");
    let (minima, maxima) = plain_extrema(&dataset, &dataset.point_array("h").unwrap().to_f64(0), None, None);
    assert!(run.stdout.contains(", boundary included"), "{}", run.stdout);
    let report = bench.json("r.json");
    assert_eq!((&report["minima"], &report["maxima"]), (&minima.len().into(), &maxima.len().into()));
    let essential = report["minima_pairs"].as_array().unwrap().iter().filter(|pair| pair[1].is_null()).count();
    assert_eq!(essential, 1);
    for name in ["field.png", "persistence_curve.svg", "persistence_diagram.svg"] {
        assert!(bench.path("a/b").join(name).exists(), "{name}");
    }
    // What the table says of a threshold is what smoothing keeps.
    let line = run.stdout.lines().find(|line| line.contains("> 20 %")).unwrap();
    let counts: Vec<usize> = line.split_whitespace().rev().take(2).map(|word| word.parse().unwrap()).collect();
    let smooth = bench.smooths("in.vti", &["--persistence", "20%"]);
    assert_eq!((&smooth["audit"]["maxima"], &smooth["audit"]["minima"]), (&counts[0].into(), &counts[1].into()));
}

#[test]
fn check_counts_and_judges() {
    let bench = Bench::with(&image([4, 3, 1], vec![doubles("h", &[0.0, 1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 4.0, 2.0, 3.0, 4.0, 5.0])]));
    let plain = bench.run(&["check", "in.vti", "--report", "r.json"]);
    assert_eq!(plain.code, 0, "{}", plain.stderr);
    assert!(plain.stdout.contains("1 minimum, 1 maximum by (value, point); 1 and 1 under a plain <; 0 points on plateaus"), "{}", plain.stdout);
    assert_eq!((&bench.json("r.json")["minima"], &bench.json("r.json")["maxima"]), (&vec![0].into(), &vec![11].into()));
    bench.text("low.txt", "0");
    bench.text("high.txt", "11");
    assert_eq!(bench.run(&["check", "in.vti", "--minima", "low.txt", "--maxima", "high.txt"]).code, 0);
    let swapped = bench.run(&["check", "in.vti", "--minima", "high.txt", "--maxima", "low.txt"]);
    assert_eq!(swapped.code, 1);
    assert!(swapped.stdout.contains("FAILED: 2 wanted extrema missing, 2 extrema that nobody wanted"), "{}", swapped.stdout);
    assert_eq!(bench.run(&["check", "in.vti", "--minima", "low.txt"]).code, 0, "maxima are not judged");
    assert_eq!(bench.run(&["check", "in.vti", "--maxima", "low.txt"]).code, 1);

    let flat = Bench::with(&image([4, 3, 1], vec![doubles("h", &[0.0, 0.0, 2.0, 3.0, 1.0, 2.0, 3.0, 4.0, 2.0, 3.0, 4.0, 5.0])]));
    flat.text("low.txt", "0");
    flat.text("high.txt", "11");
    let run = flat.run(&["check", "in.vti", "--minima", "low.txt", "--maxima", "high.txt"]);
    assert_eq!(run.code, 1);
    assert!(run.stdout.contains("2 points on plateaus"), "{}", run.stdout);
}

#[test]
fn one_changed_bit_in_a_smoothed_file_is_found() {
    let bench = Bench::with(&hilly(24, 18));
    let report = bench.smooths("in.vti", &["--persistence", "20%"]);
    let mut spoiled = bench.read("out.vti");
    let mut values = spoiled.point_array("h_smooth").unwrap().to_f64(0);
    let maximum = super::wanted_points(&report, "maxima")[0];
    let (x, y) = (maximum % 24, maximum / 24);
    let beside = if x > 0 { maximum - 1 } else { y * 24 + 1 };
    values[beside] = values[maximum].next_up();
    spoiled.set_point_array(doubles("h_smooth", &values));
    bench.put("spoiled.vti", &spoiled);
    let judge = |file: &str| bench.run(&["check", file, "--array", "h_smooth", "--against", "report.json", "--report", "c.json"]).code;
    assert_eq!(judge("out.vti"), 0);
    assert_eq!(judge("spoiled.vti"), 1);
    let verdict = bench.json("c.json");
    assert_eq!((&verdict["audit"]["passed"], &verdict["audit"]["spurious_first"][0]["point"]), (&false.into(), &beside.into()));
}

#[test]
fn check_against_a_report_judges_values_mask_and_ties() {
    let bench = Bench::with(&hilly(24, 18));
    let report = bench.smooths("in.vti", &["--persistence", "20%"]);
    assert_eq!((&report["raw"], &report["wanted"]["maxima"][0]["value_kept"]), (&false.into(), &true.into()));
    let judge = || bench.run(&["check", "out.vti", "--array", "h_smooth", "--against", "report.json"]);
    assert_eq!(judge().code, 0);
    let mut output = bench.read("out.vti");
    let values = output.point_array("h_smooth").unwrap().to_f64(0);
    output.set_point_array(doubles("h_smooth", &values.iter().map(|value| 2.0 * value + 1.0).collect::<Vec<_>>()));
    bench.put("out.vti", &output);
    let moved = judge();
    assert!(moved.code == 1 && moved.stdout.contains("wanted values not kept"), "{}", moved.stdout);
    for arguments in [&["--values", "free"][..], &["--values", "5%"], &["--raw"]] {
        let fixed = ["smooth", "in.vti", "out.vti", "--persistence", "20%", "--report", "report.json", "-q"];
        assert_eq!(bench.run(&[&fixed, arguments].concat()).code, 0, "{arguments:?}");
        let run = judge();
        assert_eq!(run.code, 0, "{arguments:?}: {}", run.stdout);
    }
}

#[test]
fn check_takes_the_mask_of_the_report() {
    let mut dataset = hilly(24, 18);
    dataset.set_point_array(doubles("m", &(0..24 * 18).map(|point| f64::from(u8::from(point % 24 < 15))).collect::<Vec<_>>()));
    let bench = Bench::with(&dataset);
    bench.smooths("in.vti", &["--array", "h", "--mask", "m", "--persistence", "20%"]);
    let run = bench.run(&["check", "out.vti", "--array", "h_smooth", "--against", "report.json"]);
    assert_eq!(run.code, 0, "{}", run.stdout);
    assert!(run.stderr.contains("note: --mask m, as in the report"), "{}", run.stderr);
}

#[test]
fn check_takes_each_kind_from_a_persistence_diagram() {
    let bench = Bench::with(&image([4, 3, 1], vec![doubles("h", &[0.0, 1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 4.0, 2.0, 3.0, 4.0, 5.0])]));
    let mut diagram = unstructured(&[[0.0; 3], [5.0, 5.0, 0.0]], fields::cells(2, &[0, 1]), 2, &[0.0, 5.0]);
    diagram.set_point_array(doubles("ttkVertexScalarField", &[0.0, 11.0]));
    diagram.set_point_array(doubles("CriticalType", &[0.0, 3.0]));
    bench.put("dia.vtu", &diagram);
    let run = bench.run(&["check", "in.vti", "--minima", "dia.vtu", "--maxima", "dia.vtu"]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
}

#[test]
fn quiet_commands_say_nothing() {
    let bench = Bench::with(&hilly(24, 18));
    for arguments in [&["info", "in.vti", "-q"][..], &["extrema", "in.vti", "--quiet"], &["check", "in.vti", "-q"]] {
        let run = bench.run(arguments);
        assert_eq!((run.code, run.stdout.as_str(), run.stderr.as_str()), (0, "", ""), "{arguments:?}");
    }
}

#[test]
fn info_of_a_file_without_a_domain_says_so() {
    let points = lattice(3, 1);
    let bench = Bench::with(&unstructured(&points, fields::cells(1, &[0, 1, 2]), 1, &[1.0, 2.0, 3.0]));
    let run = bench.run(&["info", "in.vtu"]);
    assert_eq!(run.code, 2);
    assert!(run.stdout.contains("domain       none") && run.stderr.contains("error: in.vtu: the domain is empty"), "{}{}", run.stdout, run.stderr);
}
