//! VTKHDF files, in and out of every command that takes other files.

use super::Bench;
use super::fields::hilly;

const WISH: [&str; 5] = ["-q", "--persistence", "30%", "--length", "8%"];

/// A file of several steps that VTK wrote.
fn steps() -> Bench {
    let bench = Bench::new();
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/io/files/hdf/steps_image.vtkhdf");
    std::fs::copy(file, bench.path("in.vtkhdf")).unwrap();
    bench
}

#[test]
fn a_field_is_smoothed_from_one_file_into_another() {
    let bench = Bench::with(&hilly(14, 14));
    assert_eq!(bench.run(&["convert", "in.vti", "in.vtkhdf", "-q"]).code, 0);
    for (input, output) in [("in.vti", "out.vti"), ("in.vtkhdf", "out.vtkhdf")] {
        let run = bench.run(&[&["smooth", input, output][..], &WISH].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
    }
    let (from_xml, from_hdf) = (bench.read("out.vti"), bench.read("out.vtkhdf"));
    assert_eq!((&from_xml.geometry, &from_xml.point_data), (&from_hdf.geometry, &from_hdf.point_data));
    bench.refuses(&[&["smooth", "in.vtkhdf", "in.vtkhdf"][..], &WISH].concat(), &["the output is the input file"]);
}

#[test]
fn steps_within_a_file_are_a_series() {
    let bench = steps();
    let info = bench.run(&["info", "in.vtkhdf"]);
    assert_eq!(info.code, 0, "{}", info.stderr);
    for words in ["in.vtkhdf: 3 steps", "step 1 (time 0.5, in.vtkhdf/1)", "Float64 speed"] {
        assert!(info.stdout.contains(words), "no {words} in {}", info.stdout);
    }
    assert_eq!(bench.run(&["convert", "in.vtkhdf", "out.pvd", "-q"]).code, 0);
    for step in ["0", "1", "2"] {
        let (own, listed) = (bench.read(&format!("in.vtkhdf/{step}")), bench.read(&format!("out.pvd/{step}")));
        assert_eq!((own.geometry, own.point_data, own.field_data), (listed.geometry, listed.point_data, listed.field_data));
    }
    let list = std::fs::read_to_string(bench.path("out.pvd")).unwrap();
    assert!(list.contains("timestep=\"0.5\"") && list.contains("file=\"out_0001.vti\""), "{list}");
    assert_eq!(bench.run(&["convert", "in.vtkhdf/1", "one.vtkhdf", "-q"]).code, 0);
    assert_eq!(bench.read("one.vtkhdf").point_data, bench.read("in.vtkhdf/1").point_data);
    bench.refuses(&["convert", "in.vtkhdf", "out.vti"], &["in.vtkhdf holds 3 time steps; expected a name ending in .pvd", "in.vtkhdf/0 is one of them"]);
    bench.refuses(&["convert", "in.vtkhdf/3", "out.vti"], &["in.vtkhdf: found no step \"3\"; expected one of 0 to 2"]);
    bench.refuses(&["convert", "in.vtkhdf/1", "in.vtkhdf"], &["the output is the input; expected another file"]);
}

#[test]
fn what_vtk_would_not_find_again_is_told() {
    let bench = Bench::new();
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/io/files/poly_ascii.vtp");
    std::fs::copy(file, bench.path("in.vtp")).unwrap();
    let run = bench.run(&["convert", "in.vtp", "out.vtkhdf"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let warning = "warning: .vtkhdf has no room for the texts of point array \"labels\"";
    assert!(run.stderr.contains(warning) || run.stdout.contains(warning), "{} {}", run.stdout, run.stderr);
}
