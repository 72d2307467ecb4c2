//! `morsmooth smooth` of several data sets: the steps of a series, the blocks of a data set; going on after an interruption.

use std::time::SystemTime;

use morsmooth::io::{ArrayData, DataArray, DataSet};
use serde_json::Value;

use super::Bench;
use super::fields::{doubles, hilly, hills, image, noise};

const SIZE: usize = 14;
const WISH: [&str; 4] = ["--persistence", "30%", "--length", "8%"];

/// Hills that change with time, and the time where the file shall tell it.
fn step(number: usize, time: Option<f64>) -> DataSet {
    let values: Vec<f64> =
        hills(SIZE, SIZE).iter().enumerate().map(|(i, h)| h + 0.1 * number as f64 * noise(i + 1000 * number)).collect();
    let mut dataset = image([SIZE, SIZE, 1], vec![doubles("h", &values)]);
    dataset.field_data = time.map(|time| DataArray::new("TimeValue", 1, ArrayData::F64(vec![time]))).into_iter().collect();
    dataset
}

/// Four steps and their list, in which times are written in several ways.
fn series() -> Bench {
    let bench = Bench::new();
    let times = ["0", "2.50e-1", "0.5", " 1 "];
    let mut list = String::new();
    for (number, time) in times.iter().enumerate() {
        bench.put(&format!("s{number}.vti"), &step(number, None));
        list.push_str(&format!("<DataSet timestep=\"{time}\" group=\"g\" part=\"0\" file='s{number}.vti'/><!-- {number} -->\n"));
    }
    bench.text("in.pvd", format!("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\"><Collection>\n{list}</Collection></VTKFile>\n"));
    bench
}

fn smooth(bench: &Bench, more: &[&str]) -> (i32, Value) {
    let run = bench.run(&[&["smooth", "in.pvd", "out.pvd", "-q", "--report", "r.json"][..], &WISH, more].concat());
    (run.code, bench.json("r.json"))
}

fn statuses(report: &Value, list: &str) -> Vec<String> {
    report[list].as_array().unwrap().iter().map(|step| step["status"].as_str().unwrap().to_owned()).collect()
}

fn outputs(bench: &Bench) -> Vec<(Vec<u8>, SystemTime)> {
    let path = |number| bench.path(&format!("out_{number:04}.vti"));
    (0..4).map(|number| (std::fs::read(path(number)).unwrap(), std::fs::metadata(path(number)).unwrap().modified().unwrap())).collect()
}

#[test]
fn every_step_has_the_bits_that_it_has_alone() {
    let bench = series();
    let (code, report) = smooth(&bench, &["--threads", "3", "--plots", "p"]);
    assert_eq!((code, &report["meshes_analysed"]), (0, &1.into()), "one mesh, looked at once");
    assert_eq!(statuses(&report, "steps"), ["smoothed"; 4]);
    for number in 0..4 {
        let (input, output) = (format!("s{number}.vti"), format!("out_{number:04}.vti"));
        let run = bench.run(&[&["smooth", &input, "alone.vti", "-q", "--report", "one.json"][..], &WISH].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        assert!(std::fs::read(bench.path("alone.vti")).unwrap() == std::fs::read(bench.path(&output)).unwrap(), "step {number}");
        let (alone, told) = (bench.json("one.json"), &report["steps"][number]["results"][0]);
        assert_eq!((&alone["audit"], &alone["smooth"]["energy"]), (&told["audit"], &told["smooth"]["energy"]));
    }
    assert_eq!(report["steps"][1]["time"], 0.25);
    // The list is as it was but for the files: times, groups, comments.
    let text = |name: &str| std::fs::read_to_string(bench.path(name)).unwrap();
    let expected = (0..4).fold(text("in.pvd"), |list, number| list.replace(&format!("s{number}.vti"), &format!("out_{number:04}.vti")));
    assert_eq!(text("out.pvd"), expected);
    let svg = text("p/extrema_over_time.svg");
    assert_eq!(svg.matches("<circle").count(), 4 * 4 + 4, "four curves of four steps, and the legend");
    assert!(std::fs::read(bench.path("p/extrema_over_time.png")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn the_bits_of_a_series_do_not_depend_on_threads() {
    let bench = series();
    smooth(&bench, &["--threads", "1"]);
    let one = outputs(&bench);
    std::fs::remove_file(bench.path("out.pvd.jsonl")).unwrap();
    let (_, report) = smooth(&bench, &["--threads", "8"]);
    assert_eq!(report["counts"]["smoothed"], 4);
    assert!(one.iter().zip(outputs(&bench)).all(|(one, many)| one.0 == many.0));
}

#[test]
fn finished_steps_are_not_made_again() {
    let bench = series();
    smooth(&bench, &[]);
    let first = outputs(&bench);
    std::thread::sleep(std::time::Duration::from_millis(20));
    let (code, report) = smooth(&bench, &[]);
    assert_eq!((code, statuses(&report, "steps")), (0, vec!["found".to_owned(); 4]));
    assert!(report["steps"][3]["results"][0]["smooth"]["before"]["maxima"].as_u64().unwrap() > 1, "what was measured then is told");
    assert!(first == outputs(&bench), "files were touched");

    // Missing, cut, changed, of another input, and a journal whose last line was cut by the interruption.
    std::fs::remove_file(bench.path("out_0000.vti")).unwrap();
    std::fs::write(bench.path("out_0001.vti"), &first[1].0[..first[1].0.len() - 7]).unwrap();
    let (_, report) = smooth(&bench, &[]);
    assert_eq!(statuses(&report, "steps"), ["smoothed", "smoothed", "found", "found"]);
    let mut changed = first[2].0.clone();
    *changed.last_mut().unwrap() ^= 1;
    std::fs::write(bench.path("out_0002.vti"), changed).unwrap();
    let journal = std::fs::read_to_string(bench.path("out.pvd.jsonl")).unwrap();
    assert_eq!(journal.lines().count(), 4);
    bench.text("out.pvd.jsonl", &journal[..journal.len() - 40]);
    let (_, report) = smooth(&bench, &[]);
    assert_eq!(statuses(&report, "steps"), ["found", "found", "smoothed", "smoothed"]);
    let last = outputs(&bench);
    assert!(first.iter().zip(&last).all(|(a, b)| a.0 == b.0));
    assert!(first[0].1 != last[0].1 && last.len() == 4);
    bench.put("s3.vti", &step(7, None));
    let (_, report) = smooth(&bench, &[]);
    assert_eq!(statuses(&report, "steps"), ["found", "found", "found", "smoothed"]);
}

#[test]
fn other_settings_make_every_step_again() {
    let bench = series();
    smooth(&bench, &[]);
    let before = outputs(&bench);
    let (_, report) = smooth(&bench, &["--order", "1"]);
    assert_eq!(statuses(&report, "steps"), ["smoothed"; 4]);
    assert!(outputs(&bench).iter().zip(&before).all(|(a, b)| a.0 != b.0));
    // What does not decide on the result does not count.
    let (_, report) = smooth(&bench, &["--order", "1", "--threads", "2", "--plots", "p"]);
    assert_eq!(statuses(&report, "steps"), ["found"; 4]);
}

#[test]
fn a_failing_step_is_named_and_the_others_are_finished() {
    let bench = series();
    let whole = std::fs::read(bench.path("s1.vti")).unwrap();
    bench.text("s1.vti", &whole[..whole.len() / 2]);
    let run = bench.run(&[&["smooth", "in.pvd", "out.pvd", "-q", "--report", "r.json"][..], &WISH].concat());
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(run.stderr.starts_with("error: 1 of 4 steps failed; the others are in out.pvd\nstep 1 (time 0.25, s1.vti): s1.vti, byte "), "{}", run.stderr);
    let report = bench.json("r.json");
    assert_eq!(statuses(&report, "steps"), ["smoothed", "failed", "smoothed", "smoothed"]);
    assert!(report["steps"][1]["error"].as_str().unwrap().contains("expected"));
    let list = std::fs::read_to_string(bench.path("out.pvd")).unwrap();
    assert!(!list.contains("0001") && list.matches("<DataSet").count() == 3 && list.contains("timestep=\" 1 \""), "{list}");
    bench.text("s1.vti", whole);
    let (code, report) = smooth(&bench, &[]);
    assert_eq!((code, statuses(&report, "steps")), (0, ["found", "smoothed", "found", "found"].map(str::to_owned).to_vec()));
    assert_eq!(std::fs::read_to_string(bench.path("out.pvd")).unwrap().matches("<DataSet").count(), 4);
}

#[test]
fn a_changed_mesh_is_analysed_anew() {
    let bench = series();
    let mut moved = step(2, None);
    let mut wider = hilly(SIZE + 1, SIZE);
    wider.field_data.clear();
    if let morsmooth::io::Geometry::ImageData { spacing, .. } = &mut moved.geometry {
        spacing[0] = 1.5;
    }
    bench.put("s2.vti", &moved);
    bench.put("s3.vti", &wider);
    let (code, report) = smooth(&bench, &["--threads", "1"]);
    assert_eq!((code, &report["meshes_analysed"]), (0, &3.into()));
    let run = bench.run(&[&["smooth", "s2.vti", "alone.vti", "-q"][..], &WISH].concat());
    assert_eq!(run.code, 0);
    assert!(std::fs::read(bench.path("alone.vti")).unwrap() == std::fs::read(bench.path("out_0002.vti")).unwrap());
}

#[test]
fn files_that_fit_a_pattern_are_a_series() {
    let bench = Bench::new();
    for number in [1usize, 2, 10] {
        bench.put(&format!("s{number}.vti"), &step(number, Some(0.5 * number as f64)));
    }
    let arguments = [&["smooth", "s*.vti", "s.pvd", "-q", "--report", "r.json"][..], &WISH].concat();
    for expected in ["smoothed", "found"] {
        // What the first run wrote fits the pattern as well.
        let run = bench.run(&arguments);
        assert_eq!(run.code, 0, "{}", run.stderr);
        let report = bench.json("r.json");
        assert_eq!(statuses(&report, "steps"), [expected; 3]);
        let told = |key: &str| report["steps"].as_array().unwrap().iter().map(|step| step[key].clone()).collect::<Vec<Value>>();
        assert_eq!(told("input"), ["s1.vti", "s2.vti", "s10.vti"], "2 before 10");
        assert_eq!(told("time"), [0.5, 1.0, 5.0], "the times that the files tell");
    }
    assert!(std::fs::read_to_string(bench.path("s.pvd")).unwrap().contains("timestep=\"5\" group=\"\" part=\"0\" file=\"s_0002.vti\""));
    bench.refuses(&[&["smooth", "x*.vti", "out.pvd"][..], &WISH].concat(), &["x*.vti: found no file that fits the pattern"]);
    bench.refuses(&[&["smooth", "s?.vti", "out.vti"][..], &WISH].concat(), &["found 2 files that fit s?.vti; expected an output ending in .pvd"]);
}

#[test]
fn a_step_that_fails_the_audit_is_told_again() {
    let bench = series();
    // No field is known that fails the audit; a run that met one would have left this record.
    let (code, _) = smooth(&bench, &["--keep-unaudited"]);
    assert_eq!(code, 0);
    let journal = std::fs::read_to_string(bench.path("out.pvd.jsonl")).unwrap();
    bench.text("out.pvd.jsonl", journal.replacen("\"made\":\"smoothed\"", "\"made\":\"not_met\"", 1));
    let (code, report) = smooth(&bench, &["--keep-unaudited"]);
    assert_eq!((code, statuses(&report, "steps")), (1, vec!["found".to_owned(); 4]));
}

/// Blocks within blocks: a grid, a surface, one without a file, and one without the array.
fn blocks() -> Bench {
    let bench = Bench::new();
    bench.put("a.vti", &step(0, None));
    bench.put("b.vti", &step(1, None));
    bench.put("bare.vti", &image([5, 4, 1], vec![doubles("other", &hills(5, 4))]));
    bench.text(
        "in.vtm",
        "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\"><vtkMultiBlockDataSet>\
         <Block index=\"0\" name=\"fluid\"><DataSet index=\"0\" name=\"in &amp; out\" file=\"a.vti\"/><DataSet index=\"4\" name=\"none\"/></Block>\
         <DataSet index=\"1\" file=\"b.vti\"/><DataSet index=\"2\" name=\"bare\" file=\"bare.vti\"/>\
         </vtkMultiBlockDataSet><FieldData><DataArray type=\"Float64\" Name=\"c\" format=\"ascii\">7.5</DataArray></FieldData></VTKFile>",
    );
    bench
}

#[test]
fn every_block_is_smoothed_and_the_tree_kept() {
    let bench = blocks();
    let run = bench.run(&[&["smooth", "in.vtm", "out.vtm", "--array", "h", "-q", "--report", "r.json"][..], &WISH].concat());
    assert_eq!((run.code, run.stdout.as_str()), (0, ""), "{}", run.stderr);
    assert_eq!(run.stderr, "warning: block bare (bare.vti): it has no such array and was written unchanged\n");
    let report = bench.json("r.json");
    assert_eq!(statuses(&report, "blocks"), ["smoothed", "smoothed", "unchanged"]);
    assert_eq!((&report["empty"][0], &report["blocks"][0]["address"]), (&"fluid/none".into(), &"fluid/in & out".into()));
    let text = |name: &str| std::fs::read_to_string(bench.path(name)).unwrap();
    let expected = text("in.vtm").replace("\"a.vti", "\"out_0000.vti").replace("\"b.vti", "\"out_0001.vti").replace("bare.vti", "out_0002.vti");
    assert_eq!(text("out.vtm"), expected);
    assert_eq!(bench.read("out.vtm/bare"), bench.read("bare.vti"));
    for (block, own) in [("out.vtm/fluid/in & out", "a.vti"), ("out.vtm/1", "b.vti")] {
        let run = bench.run(&[&["smooth", own, "alone.vti", "-q"][..], &WISH].concat());
        assert_eq!(run.code, 0);
        assert_eq!(bench.read(block), bench.read("alone.vti"));
    }
    let again = bench.run(&[&["smooth", "in.vtm", "out.vtm", "--array", "h", "-q", "--report", "r.json"][..], &WISH].concat());
    assert_eq!((again.code, statuses(&bench.json("r.json"), "blocks")), (0, vec!["found".to_owned(); 3]));
    bench.refuses(&[&["smooth", "in.vtm", "no.vtm", "--array", "x"][..], &WISH].concat(), &["found no array to work on in any of 3 blocks"]);
}

#[test]
fn one_block_is_a_data_set_by_its_address() {
    let bench = blocks();
    for address in ["in.vtm/fluid/in & out", "in.vtm/0/0", "in.vtm/1"] {
        let run = bench.run(&["extrema", address]);
        assert_eq!(run.code, 0, "{address}: {}", run.stderr);
    }
    let run = bench.run(&[&["smooth", "in.vtm/fluid/0", "one.vti", "-q"][..], &WISH].concat());
    assert_eq!(run.code, 2, "names and numbers are not mixed");
    let there = "(there are fluid/in & out, 1, bare)";
    bench.refuses(&["extrema", "in.vtm"], &["a collection of 4 blocks as one data set cannot be read here", "in.vtm/fluid/in & out", there]);
    bench.refuses(&["extrema", "in.vtm/fluid/out"], &["in.vtm: found no block \"fluid/out\"; expected one of fluid/in & out, 1, bare"]);
    bench.refuses(&["extrema", "a.vti/0"], &["a.vti: found one data set, where its block \"0\" was asked for"]);
    bench.refuses(&[&["smooth", "in.vtm", "out.vti"][..], &WISH].concat(), &["in.vtm holds 3 blocks; expected a name ending in .vtm", "in.vtm/fluid/in & out is one of them"]);
    bench.refuses(&[&["smooth", "a.vti", "out.pvd"][..], &WISH].concat(), &["the input a.vti is one data set", "'step_*.vti'"]);
    bench.refuses(&[&["smooth", "in.vtm/1", "b.vti"][..], &WISH].concat(), &["b.vti: the output is the input file"]);
}

#[test]
fn what_would_overwrite_an_input_is_refused() {
    let bench = series();
    std::fs::rename(bench.path("s2.vti"), bench.path("out_0001.vti")).unwrap();
    let list = std::fs::read_to_string(bench.path("in.pvd")).unwrap().replace("s2.vti", "out_0001.vti");
    bench.text("in.pvd", list);
    bench.refuses(&[&["smooth", "in.pvd", "out.pvd"][..], &WISH].concat(), &["out_0001.vti: the files written beside out.pvd would overwrite it"]);
    bench.refuses(&["convert", "in.pvd", "out.pvd"], &["out_0001.vti"]);
    bench.refuses(&[&["smooth", "in.pvd", "in.pvd"][..], &WISH].concat(), &["the output is the input file"]);
    bench.refuses(&[&["smooth", "in.pvd", "new.pvd", "--report", "new_0002.json"][..], &WISH].concat(), &["one of the files written would overwrite this one"]);
    bench.refuses(&[&["smooth", "in.pvd", "new.pvd", "--report", "new.pvd.jsonl"][..], &WISH].concat(), &["the list of finished steps would overwrite"]);
    bench.refuses(&["smooth", "in.pvd", "new.pvd"], &["found no wanted extrema"]);
}

#[test]
fn lists_are_shown_and_converted_whole() {
    let bench = blocks();
    // A series whose second step is a tree.
    bench.text(
        "in.pvd",
        "<VTKFile type=\"Collection\" version=\"0.1\"><Collection><DataSet timestep=\"0\" file=\"b.vti\"/>\
         <DataSet timestep=\"2\" file=\"in.vtm\"/></Collection></VTKFile>",
    );
    let info = bench.run(&["info", "in.pvd", "--report", "r.json"]);
    assert_eq!(info.code, 0, "{}", info.stderr);
    for words in ["in.pvd: 4 steps", "step 1/fluid/in & out (time 2, a.vti)", "step 1/bare (time 2, bare.vti)", "Float64 other", "block 1/fluid/none (empty"] {
        assert!(info.stdout.contains(words), "no {words} in {}", info.stdout);
    }
    assert_eq!(bench.json("r.json")["steps"][3]["points"], 20);
    assert_eq!(bench.run(&["convert", "in.pvd", "out.pvd", "-q"]).code, 0);
    for (block, own) in [("0", "b.vti"), ("1/fluid/in & out", "a.vti"), ("1/1", "b.vti"), ("1/bare", "bare.vti")] {
        assert_eq!(bench.read(&format!("out.pvd/{block}")), bench.read(own), "{block}");
    }
    assert!(std::fs::read_to_string(bench.path("out_0001.vtm")).unwrap().contains("<FieldData>"));
    let run = bench.run(&[&["smooth", "in.pvd", "s.pvd", "-q", "--array", "h", "--report", "r.json", "--plots", "p"][..], &WISH].concat());
    // A step without the array is no block that may pass by.
    assert_eq!(run.code, 2, "{}", run.stderr);
    assert!(run.stderr.contains("step 1/bare (time 2, bare.vti): bare.vti: found no point array 'h'"), "{}", run.stderr);
    assert_eq!(bench.read("s.pvd/1/1"), bench.read("s.pvd/0"));

    std::fs::write(bench.path("b.vti"), "<VTKFile").unwrap();
    let info = bench.run(&["info", "in.vtm"]);
    assert_eq!(info.code, 2);
    assert!(info.stdout.contains("block bare") && info.stdout.contains("unreadable") && info.stderr.contains("1 of 3 blocks cannot be read"));
}
