//! The command of the README, looked at from all sides.

use std::process::{Command, Stdio};

use morsmooth::audit::{Plateaus, Wanted, audit, strict_extrema};
use morsmooth::field::VertexId;
use morsmooth::io::{MaskSources, domain, mask};

use super::fields::hilly;
use super::{Bench, check_output, wanted_points};
use crate::support::dataset;

const SMOOTH: [&str; 8] = ["--array", "vorticity_magnitude", "--mask", "valid", "--select", "smooth", "--persistence", "10%"];

fn jet() -> String {
    dataset("jet.vti").to_str().unwrap().to_owned()
}

#[test]
fn the_readme_command_keeps_its_promises() {
    let bench = Bench::new();
    let original = std::fs::read(jet()).unwrap();
    let more = ["--report", "r.json", "--plots", "pictures"];
    let run = bench.run(&[&["smooth", &jet(), "out.vti"][..], &SMOOTH, &more].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(std::fs::read(jet()).unwrap() == original);
    let report = bench.json("r.json");
    let (before, after) = (morsmooth::io::read(jet()).unwrap(), bench.read("out.vti"));
    check_output(&before, &after, &report);

    // By the library's judge, of the file as it is.
    let sources = MaskSources { array: Some("valid".into()), ..MaskSources::default() };
    let domain = domain(&after, &mask(&after, &sources).unwrap()).unwrap();
    let values = domain.restrict(&after.point_array("vorticity_magnitude_smooth").unwrap().to_f64(0));
    let vertices = |kind: &str| -> Vec<(VertexId, _)> {
        wanted_points(&report, kind).iter().map(|&point| (domain.vertex_of_point()[point].unwrap(), None)).collect()
    };
    let (minima, maxima) = (vertices("minima"), vertices("maxima"));
    let wanted = Wanted { minima: &minima, maxima: &maxima, plateaus: Plateaus::Refused };
    let verdict = audit(&domain.complex, &values, &wanted).unwrap();
    assert!(verdict.passed, "{verdict:?}");
    assert_eq!(strict_extrema(&domain.complex, &values).unwrap().plateaus, []);
    for kind in ["minima", "maxima"] {
        for entry in report["wanted"][kind].as_array().unwrap() {
            let vertex = domain.vertex_of_point()[entry["point"].as_u64().unwrap() as usize].unwrap();
            let (found, written) = (values[vertex.index()], entry["value"].as_f64().unwrap());
            assert!((found - written).abs() <= f64::EPSILON * found.abs(), "{entry}: {found}");
            let position: Vec<f64> = entry["position"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
            let place = domain.complex.point(vertex);
            assert!((0..3).all(|axis| (position[axis] - place[axis]).abs() <= f64::EPSILON * place[axis].abs()));
        }
    }
    // Outside the mask nothing changed.
    let (old, new) = (before.point_array("vorticity_magnitude").unwrap(), after.point_array("vorticity_magnitude_smooth").unwrap());
    let (old, new) = (old.to_f64(0), new.to_f64(0));
    let outside: Vec<usize> = (0..old.len()).filter(|&point| domain.vertex_of_point()[point].is_none()).collect();
    assert_eq!(outside.len(), 16384 - 15399);
    assert!(outside.iter().all(|&point| old[point].to_bits() == new[point].to_bits()));

    for (key, value) in [("array", "vorticity_magnitude"), ("mask", "valid"), ("output", "out.vti"), ("program", "morsmooth")] {
        assert_eq!(report[key], value);
    }
    assert_eq!((&report["vertices"], &report["points"], &report["written"]), (&15399.into(), &16384.into(), &true.into()));
    let smooth = &report["smooth"];
    for key in [
        "before", "select_on", "selection_range", "threshold", "wanted", "order", "length", "representative", "energy", "solver",
        "repair", "precision", "change", "timing", "data_range",
    ] {
        assert!(!smooth[key].is_null(), "no smooth.{key}");
    }
    assert_eq!((&smooth["select_on"], &smooth["precision"], &smooth["solver"]["status"]), (&"smooth".into(), &"f32".into(), &"solved".into()));
    let energy = |key: &str| smooth["energy"][key].as_f64().unwrap();
    assert!(energy("unconstrained") <= energy("bound") && energy("bound") <= energy("result"));
    assert!((energy("smoothness") + energy("data") - energy("result")).abs() <= 1e-9 * energy("result"));
    assert!(smooth["length"]["automatic"].as_bool().unwrap() && smooth["length"]["noise"].as_f64().unwrap() > 0.0);

    for line in ["field", "extrema before", "extrema wanted", "smoothing", "representative", "energy", "solver", "change", "time", "audit"] {
        assert!(run.stdout.lines().any(|found| found.starts_with(line)), "no {line} in {}", run.stdout);
    }
    assert!(run.stdout.contains("passed") && run.stdout.contains("out.vti, array vorticity_magnitude_smooth"));
    let stages = ["reading", "extrema", "operators", "smoothing length", "quadratic problem", "repair", "writing", "audit", "pictures"];
    for stage in stages {
        assert!(run.stderr.contains(stage), "no {stage} in {}", run.stderr);
    }
    assert!(!run.stderr.contains('\u{1b}'), "control characters where nobody watches");
    let png = std::fs::read(bench.path("pictures/before_after.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n") && png.len() > 10_000);
    for name in ["persistence_curve.svg", "persistence_diagram.svg"] {
        let svg = std::fs::read_to_string(bench.path("pictures").join(name)).unwrap();
        assert!(svg.contains("<svg") && svg.trim_end().ends_with("</svg>"), "{name}");
    }

    // The audit alone agrees, and any other field fails it.
    let check = |array: &str| bench.run(&["check", "out.vti", "--array", array, "--mask", "valid", "--against", "r.json"]);
    let good = check("vorticity_magnitude_smooth");
    assert_eq!(good.code, 0, "{}", good.stderr);
    assert!(good.stdout.contains("audit passed"));
    let bad = check("vorticity_magnitude");
    assert_eq!(bad.code, 1, "{}", bad.stderr);
    assert!(bad.stdout.contains("FAILED"));
}

#[test]
fn the_bits_do_not_depend_on_threads() {
    let bench = Bench::new();
    for threads in ["1", "2"] {
        let output = format!("out{threads}.vti");
        let run = bench.run(&[&["smooth", &jet(), &output, "-q", "--threads", threads][..], &SMOOTH].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
    }
    assert!(std::fs::read(bench.path("out1.vti")).unwrap() == std::fs::read(bench.path("out2.vti")).unwrap());
}

#[test]
fn a_closed_pipe_is_no_error() {
    let bench = Bench::with(&hilly(24, 18));
    for arguments in [
        &["smooth", "in.vti", "out.vti", "--persistence", "20%"][..],
        &["extrema", "in.vti"],
        &["info", "in.vti"],
        &["check", "in.vti"],
        &["--help"],
    ] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_morsmooth"))
            .args(arguments)
            .current_dir(bench.path("."))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        drop(child.stderr.take());
        assert_eq!(child.wait().unwrap().code(), Some(0), "{arguments:?}");
    }
    assert_eq!(bench.read("out.vti").point_data.arrays.len(), 2);
}

#[test]
fn colour_is_never_written_to_files_and_no_color_is_accepted() {
    let bench = Bench::with(&hilly(24, 18));
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_morsmooth"));
    command.current_dir(bench.path(".")).env("NO_COLOR", "1").args(["smooth", "in.vti", "out.vti", "--persistence", "20%"]);
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(!output.stdout.contains(&0x1b) && !output.stderr.contains(&0x1b));
}

#[test]
fn help_and_version_are_data() {
    let bench = Bench::new();
    for (arguments, word) in [
        (&["--help"][..], "smooth"),
        (&["smooth", "--help"], "--persistence"),
        (&["extrema", "--help"], "--plots"),
        (&["check", "--help"], "--against"),
        (&["info", "--help"], "--mask"),
        (&["--version"], env!("CARGO_PKG_VERSION")),
    ] {
        let run = bench.run(arguments);
        assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{arguments:?}");
        assert!(run.stdout.contains(word), "{arguments:?}");
    }
}
