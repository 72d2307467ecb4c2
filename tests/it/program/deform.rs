//! `morsmooth deform`: every method, what is written, what is refused.

use morsmooth::audit::orientations;
use morsmooth::field::Precision;
use morsmooth::io::{ArrayData, CellArray, DataArray, DataSet, Geometry, MaskSources, domain, mask};
use morsmooth::mesh::Domain;
use morsmooth::plot::Photograph;

use super::Bench;
use crate::deform::scenes;

/// A complex as a file, in single or double precision, with an array that must survive.
pub fn mesh(complex: &morsmooth::mesh::SimplicialComplex, is_single: bool) -> DataSet {
    let corners = complex.dimension() + 1;
    let mut cells = CellArray::default();
    complex.simplices().chunks(corners).for_each(|simplex| cells.push(simplex.iter().map(|&vertex| i64::from(vertex))));
    let places = complex.points().as_flattened();
    let places = if is_single { ArrayData::F32(places.iter().map(|&x| x as f32).collect()) } else { ArrayData::F64(places.to_vec()) };
    let types = vec![if corners == 3 { 5 } else { 10 }; cells.len()];
    let points = DataArray::new("Points", 3, places);
    let mut dataset = DataSet::new(Geometry::UnstructuredGrid { points, cells, types, polyhedra: None });
    let numbers = ArrayData::I32((0..complex.vertex_count() as i32).collect());
    dataset.set_point_array(DataArray::new("number", 1, numbers));
    dataset
}

/// The unit square with four handles: three corners that stay and a middle that is moved and turned so far that elements must invert without
/// constraints.
pub fn square(cells: usize, degrees: f64, is_single: bool) -> Bench {
    let bench = Bench::new();
    bench.put("in.vtu", &mesh(&scenes::square(cells), is_single));
    bench.text(
        "h.json",
        r#"{"handles": [{"name": "west", "point": [0, 0]}, {"name": "east", "point": [1, 0]}, {"name": "north", "point": [1, 1]},
            {"name": "middle", "bone": [[0.4, 0.5], [0.6, 0.5]]}]}"#,
    );
    bench.text("p.json", pose(degrees));
    bench
}

fn pose(degrees: f64) -> String {
    format!(
        r#"{{"handles": {{"middle": {{"rotation_degrees": {degrees}, "translation": [0.25, 0.1], "pivot": [0.5, 0.5]}}, "west": {{"translation": [0.3, 0.3]}}}}}}"#
    )
}

const RIG: [&str; 4] = ["--handles", "h.json", "--pose", "p.json"];

fn elements(dataset: &DataSet) -> Domain {
    domain(dataset, &mask(dataset, &MaskSources::default()).unwrap()).unwrap()
}

/// Inverted elements of a file against those of another, in both precisions.
pub fn inverted(rest: &DataSet, deformed: &DataSet) -> [usize; 2] {
    let (rest, deformed) = (elements(rest), elements(deformed));
    assert_eq!(rest.complex.simplices(), deformed.complex.simplices());
    [Precision::F64, Precision::F32].map(|precision| {
        let report = orientations(&rest.complex, &[], deformed.complex.points(), precision).unwrap();
        report.inverted.len() + report.degenerate.len()
    })
}

#[test]
fn nothing_is_inverted_and_nothing_is_lost() {
    for is_single in [false, true] {
        let bench = square(16, 100.0, is_single);
        let run = bench.run(&[&["deform", "in.vtu", "out.vtu", "--report", "r.json", "--plots", "pictures"][..], &RIG].concat());
        assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
        let (before, after) = (bench.read("in.vtu"), bench.read("out.vtu"));
        assert_eq!(inverted(&before, &after), [0, 0]);
        assert_eq!(before.point_data, after.point_data);
        let (Geometry::UnstructuredGrid { points: old, cells, .. }, Geometry::UnstructuredGrid { points: new, cells: same, .. }) =
            (&before.geometry, &after.geometry)
        else {
            panic!("an unstructured grid")
        };
        assert_eq!((old.data.value_type(), cells), (new.data.value_type(), same));
        // The arrays say of each element what its points say.
        let (rest, shape) = (elements(&before).complex, elements(&after).complex);
        let area = |complex: &morsmooth::mesh::SimplicialComplex, element: usize| complex.measure(element);
        let det = after.cell_array("det_F").unwrap().to_f64(0);
        let worst = det.iter().enumerate().map(|(i, det)| (det - area(&shape, i) / area(&rest, i)).abs()).fold(0.0, f64::max);
        assert!(worst < 2e-5, "{worst}");
        let eigenvalue = after.cell_array("smallest_eigenvalue").unwrap().to_f64(0);
        // det(S + A) >= det S >= lambda², and lambda is above its margin.
        assert!(eigenvalue.iter().zip(&det).all(|(lambda, det)| *lambda > 0.0 && det - lambda * lambda > -1e-9));
        let active = after.cell_array("active_constraint").unwrap().to_f64(0);
        let report = bench.json("r.json");
        assert_eq!(report["result"]["active_constraints"], active.iter().sum::<f64>() as usize);
        assert!(active.contains(&1.0), "a pose that needs no constraint tests nothing");
        let energy = after.cell_array("energy_density").unwrap().to_f64(0);
        let total: f64 = energy.iter().enumerate().map(|(i, density)| density * area(&rest, i)).sum();
        let told = report["result"]["energy"]["elastic"].as_f64().unwrap();
        assert!((total - told).abs() < 1e-9 * told, "{total} {told}");
        let result = &report["result"];
        assert_eq!((&result["status"], &result["audit"]["passed"]), (&"certified".into(), &true.into()));
        assert!(result["certificate"]["duality_gap"].as_f64().unwrap() <= 1e-6);
        assert_eq!(result["handles"].as_array().unwrap().len(), 4);
        assert!(std::fs::read(bench.path("pictures/before_after.png")).unwrap().starts_with(b"\x89PNG"));
        for line in ["mesh", "handles", "method", "status", "energy", "certificate", "audit", "output"] {
            assert!(run.stdout.lines().any(|found| found.starts_with(line)), "no {line} in {}", run.stdout);
        }
    }
}

#[test]
fn both_solvers_end_at_one_energy_and_comparisons_do_not_lie() {
    let bench = square(12, 100.0, false);
    let runs = |method: &[&str], more: &[&str]| {
        let run = bench.run(&[&["deform", "in.vtu", "out.vtu", "-q", "--report", "r.json"][..], &RIG, method, more].concat());
        let report = bench.json("r.json");
        let total: f64 = ["elastic", "volume", "handles"].iter().map(|part| report["result"]["energy"][part].as_f64().unwrap()).sum();
        (run, report, total)
    };
    let (run, _, best) = runs(&[], &[]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    for method in [
        &["--solver", "penalty"][..],
        &["--solver", "penalty", "--penalty", "spline"],
        &["--method", "spectral"],
        &["--method", "pennon"],
    ] {
        let (run, _, energy) = runs(method, &["--keep-unaudited"]);
        assert!((energy / best - 1.0).abs() < 1e-5, "{method:?}: {energy} {best} {}", run.stderr);
    }
    for method in ["ex-rotated", "lbs", "dqs", "lim", "det-penalty"] {
        let _ = std::fs::remove_file(bench.path("out.vtu"));
        let (run, report, energy) = runs(&["--method", method], &[]);
        let count = report["result"]["audit"]["as_written"]["inverted"].as_u64().unwrap();
        let is_clean = report["result"]["audit"]["passed"] == true;
        // What the file would have held is what is told, and an inverted shape is not written unasked.
        assert_eq!((run.code == 0, bench.path("out.vtu").exists()), (is_clean, is_clean), "{method}: {}", run.stderr);
        assert!(is_clean || count > 0 || report["result"]["audit"]["in_32_bits"]["inverted"].as_u64().unwrap() > 0);
        match method {
            "ex-rotated" => assert!(count > 0 && energy < best, "a pose that inverts nothing compares nothing: {energy} {best}"),
            "lim" => assert_eq!(count, 0, "a barrier lets nothing through"),
            _ => {}
        }
        let (run, _, _) = runs(&["--method", method], &["--keep-unaudited"]);
        assert_eq!(run.code == 0, is_clean);
        assert_eq!(inverted(&bench.read("in.vtu"), &bench.read("out.vtu"))[0] as u64, count, "{method}");
    }
}

#[test]
fn contradictions_name_handles_and_elements() {
    // Two triangles with a common side, one turned by 180 degrees against the other.
    let bench = Bench::new();
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.5, -1.0, 0.0]];
    let complex = morsmooth::mesh::SimplicialComplex::new(2, points, vec![0, 1, 2, 1, 0, 3]).unwrap();
    let mut dataset = mesh(&complex, false);
    let weight = |name: &str, values: [f64; 4]| DataArray::new(name, 1, ArrayData::F64(values.to_vec()));
    // Weights may leave 0 to 1: the rotation is what counts.
    dataset.set_point_array(weight("up", [1.5, 1.5, 0.0, -3.0]));
    dataset.set_point_array(weight("down", [-0.5, -0.5, 1.0, 4.0]));
    bench.put("in.vtu", &dataset);
    bench.text("h.json", r#"{"handles": [{"name": "up", "point": [0.5, 1]}, {"name": "down", "point": [0.5, -1]}]}"#);
    bench.text("p.json", r#"{"handles": {"up": {"rotation_degrees": 180}}}"#);
    let given = [&["deform", "in.vtu", "out.vtu", "--weights", "in.vtu", "-q", "--report", "r.json"][..], &RIG].concat();
    let run = bench.run(&given);
    assert_eq!(run.code, 1, "{}{}", run.stdout, run.stderr);
    assert!(!bench.path("out.vtu").exists());
    assert!(run.stderr.contains("the rotations of the handles \"up\" and \"down\" contradict each other"), "{}", run.stderr);
    assert!(run.stderr.contains("--keep-best would look for the closest shape without inversions"), "{}", run.stderr);
    assert!(!bench.json("r.json")["result"]["blame"]["cells"].as_array().unwrap().is_empty());
    let run = bench.run(&[&given[..], &["--keep-best"]].concat());
    assert_eq!(run.code, 1, "{}{}", run.stdout, run.stderr);
    assert!(run.stderr.contains("the closest shape without inversions"), "{}", run.stderr);
    assert_eq!(inverted(&bench.read("in.vtu"), &bench.read("out.vtu")), [0, 0]);
}

#[test]
fn a_pose_of_pure_rest_is_the_certified_optimum() {
    for is_single in [false, true] {
        let bench = square(10, 0.0, is_single);
        let shifts = ["west", "east", "north", "middle"].map(|name| format!(r#""{name}": {{"translation": [0.5, -2]}}"#));
        for (pose, shift) in [(r#"{"handles": {}}"#.to_owned(), [0.0, 0.0]), (format!("{{\"handles\": {{{}}}}}", shifts.join(", ")), [0.5, -2.0])] {
            bench.text("p.json", pose);
            let run = bench.run(&[&["deform", "in.vtu", "out.vtu", "--report", "r.json"][..], &RIG].concat());
            assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
            assert!(!run.stderr.contains("warning"), "{}", run.stderr);
            assert!(run.stdout.contains("certified optimum") && run.stdout.contains("of the rest measure, and none is below 0"), "{}", run.stdout);
            let result = &bench.json("r.json")["result"];
            assert_eq!(result["status"], "certified");
            assert!((result["rest_measure"].as_f64().unwrap() - 1.0).abs() < 1e-6);
            let (before, after) = (bench.read("in.vtu").points_f64(), bench.read("out.vtu").points_f64());
            let off = |(a, b): (&[f64; 3], &[f64; 3])| (0..2).map(|axis| (a[axis] + shift[axis] - b[axis]).abs()).fold(0.0, f64::max);
            let most = before.iter().zip(&after).map(off).fold(0.0, f64::max);
            assert!(most < if is_single { 5e-7 } else { 1e-12 }, "{most}");
        }
    }
}

#[test]
fn bits_do_not_depend_on_threads() {
    let bench = square(16, 80.0, false);
    for threads in ["1", "2", "5"] {
        let output = format!("out{threads}.vtu");
        let run = bench.run(&[&["deform", "in.vtu", &output, "-q", "--threads", threads][..], &RIG].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        assert!(std::fs::read(bench.path("out1.vtu")).unwrap() == std::fs::read(bench.path(&output)).unwrap());
    }
}

#[test]
fn solids_follow_bones_and_outlines_are_filled() {
    let bench = Bench::new();
    bench.put("in.vtu", &mesh(&scenes::solid([10, 3, 3], 0.1, |_| true), true));
    bench.text(
        "h.json",
        r#"{"handles": [{"name": "left", "bone": [[0, 0.15, 0.15], [0.3, 0.15, 0.15]]}, {"name": "right", "bone": [[0.7, 0.15, 0.15], [1, 0.15, 0.15]]}]}"#,
    );
    bench.text("p.json", r#"{"handles": {"right": {"rotation_degrees": 70, "axis": [0, 1, 1], "translation": [-0.3, 0, 0]}}}"#);
    let run = bench.run(&[&["deform", "in.vtu", "out.vtu", "--incompressible", "0.3", "--rotation-rounds", "1"][..], &RIG].concat());
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    assert_eq!(inverted(&bench.read("in.vtu"), &bench.read("out.vtu")), [0, 0]);

    bench.text("ring.csv", "x,y\n0,0\n4,0\n4,1\n0,1\n");
    bench.text("h.json", r#"{"handles": [{"name": "a", "point": [0, 0]}, {"name": "b", "point": [4, 1]}]}"#);
    bench.text("p.json", r#"{"handles": {"b": {"rotation_degrees": 90, "translation": [-1, 1]}}}"#);
    let run = bench.run(&[&["deform", "ring.csv", "bent.vtp", "--max-edge", "5%"][..], &RIG].concat());
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    assert!(bench.read("bent.vtp").cell_array("det_F").unwrap().to_f64(0).iter().all(|det| *det > 0.0));
}

#[test]
fn a_photograph_that_does_not_move_stays_as_it_is() {
    let bench = Bench::new();
    let pixels: Vec<[u8; 4]> = (0..60 * 40).map(|i| [(i * 7 % 256) as u8, (i / 60 * 6) as u8, (i % 60 * 4) as u8, 255]).collect();
    let photograph = Photograph::new(60, 40, pixels).unwrap();
    photograph.write_png(&bench.path("in.png")).unwrap();
    bench.text("h.json", r#"{"handles": [{"name": "a", "point": [0, 0]}, {"name": "b", "point": [60, 40]}, {"name": "c", "point": [30, 20]}]}"#);
    bench.text("p.json", r#"{"handles": {}}"#);
    let run = |pose: &str, output: &str| {
        bench.text("p.json", pose);
        let run = bench.run(&[&["deform", "in.png", output, "--triangles", "800", "-q"][..], &RIG].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        Photograph::read_png(&bench.path(output)).unwrap()
    };
    let same = run(r#"{"handles": {}}"#, "same.png");
    // Nine samples of a bilinear interpolation soften a little; inside a constant slope they do not.
    let off = |a: &[u8; 4], b: &[u8; 4]| (0..4).map(|c| a[c].abs_diff(b[c])).max().unwrap();
    let at = |photograph: &Photograph, x: usize, y: usize| photograph.pixels()[y * 60 + x];
    assert_eq!(same.size(), [60, 40]);
    assert!((2..58).all(|x| (2..38).all(|y| off(&[0, at(&same, x, y)[1], at(&same, x, y)[2], 255], &[0, at(&photograph, x, y)[1], at(&photograph, x, y)[2], 255]) <= 2)));
    // Up is up: what moves up by 10 pixels is found 10 rows higher, and what it leaves is transparent.
    let moved = run(
        r#"{"handles": {"a": {"translation": [0, 10]}, "b": {"translation": [0, 10]}, "c": {"translation": [0, 10]}}}"#,
        "moved.png",
    );
    assert!((2..28).all(|y| off(&[0, at(&moved, 30, y)[1], 0, 255], &[0, at(&photograph, 30, y + 10)[1], 0, 255]) <= 2));
    assert_eq!(at(&moved, 30, 37)[3], 0);
}

#[test]
fn refusals_name_what_is_wrong() {
    let bench = square(6, 30.0, false);
    let command = |more: &[&'static str]| -> Vec<&'static str> { [&["deform", "in.vtu", "out.vtu"][..], &RIG, more].concat() };
    bench.refuses(&["deform", "in.vtu", "in.vtu", "--handles", "h.json", "--pose", "p.json"], &["the output is the input file"]);
    bench.refuses(&["deform", "in.vtu", "p.json", "--handles", "h.json", "--pose", "p.json"], &["p.json"]);
    bench.refuses(&["deform", "in.vtu", "out.png", "--handles", "h.json", "--pose", "p.json"], &["a photograph comes of a photograph only"]);
    bench.refuses(&["deform", "in.vtu", "out.vtu", "--pose", "p.json"], &["--handles"]);
    bench.refuses(&command(&["--alpha", "-1"]), &["alpha"]);
    bench.refuses(&command(&["--gap", "0"]), &["found --gap 0; expected a number between 0 and 1"]);
    bench.refuses(&command(&["--incompressible", "-0.3"]), &["incompressib"]);
    bench.refuses(&command(&["--out-image", "x.png"]), &["found --out-image without a photograph"]);
    bench.refuses(&command(&["--weights", "in.vtu"]), &["found no point array 'west'; expected the weights of the handle \"west\"", "point arrays: number; --weights-prefix"]);
    bench.refuses(&command(&["--hard", "--method", "lim"]), &["the handles are hard; this method of comparison needs soft ones"]);
    bench.text("far.json", r#"{"handles": [{"name": "lost", "point": [9, 9]}]}"#);
    bench.refuses(&["deform", "in.vtu", "out.vtu", "--handles", "far.json", "--pose", "p.json"], &["far.json", "handle \"lost\" is outside the mesh"]);
    bench.text("far.json", r#"{"handles": [{"name": "none", "region": [999]}]}"#);
    let words = ["far.json: region \"none\" names vertex 999; expected less than 85"];
    bench.refuses(&["deform", "in.vtu", "out.vtu", "--handles", "far.json", "--pose", "p.json"], &words);
    bench.text("other.json", r#"{"handles": {"nose": {"rotation_degrees": 3}}}"#);
    bench.refuses(&["deform", "in.vtu", "out.vtu", "--handles", "h.json", "--pose", "other.json"], &["other.json", "nose"]);
    // A fold in the rest shape is named by its cells.
    let mut folded = scenes::square(3).points().to_vec();
    folded[16][1] = -0.05;
    let complex = morsmooth::mesh::SimplicialComplex::new(2, folded, scenes::square(3).simplices().to_vec()).unwrap();
    bench.put("in.vtu", &mesh(&complex, false));
    bench.refuses(&command(&["--weight-method", "harmonic"]), &["inverted against their neighbours", "cells of the file: 0"]);
}
