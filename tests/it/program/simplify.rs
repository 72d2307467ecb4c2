//! `morsmooth simplify`, and lists of thresholds and arrays.

use morsmooth::io::{ArrayData, DataArray, DataSet};
use serde_json::Value;

use super::fields::{doubles, hills, hilly, image, noise, plain_extrema};
use super::{Bench, check_output, wanted_points};

/// Simplifies `in.vti` to `out.vti`, quietly; the output must be right in every respect.
fn simplifies(bench: &Bench, arguments: &[&str]) -> Value {
    let run = bench.run(&[&["simplify", "in.vti", "out.vti", "--quiet", "--report", "report.json"], arguments].concat());
    assert_eq!(run.code, 0, "{arguments:?}: {}{}", run.stdout, run.stderr);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""), "--quiet");
    let report = bench.json("report.json");
    check_output(&bench.read("in.vti"), &bench.read("out.vti"), &report);
    report
}

fn singles(values: &[f64]) -> Vec<f32> {
    values.iter().map(|&value| value as f32).collect()
}

#[test]
fn plain_values_have_exactly_the_wanted_extrema() {
    let single = DataArray::new("h", 1, ArrayData::F32(singles(&hills(40, 30))));
    let bytes = DataArray::new("h", 1, ArrayData::U8(hills(40, 30).iter().map(|value| (90.0 * (value + 1.4)) as u8).collect()));
    for array in [doubles("h", &hills(40, 30)), single, bytes] {
        let bench = Bench::with(&image([40, 30, 1], vec![array]));
        for part in ["0", "2%", "10%", "50%"] {
            let report = simplifies(&bench, &["--persistence", part]);
            assert_eq!(report["output_array"], "h_simplified");
            // What simplify keeps is what smooth keeps.
            let smooth = bench.run(&["smooth", "in.vti", "s.vti", "-q", "--report", "s.json", "--persistence", part, "--length", "3%"]);
            assert_eq!(smooth.code, 0, "{}", smooth.stderr);
            let wanted = bench.json("s.json");
            for kind in ["minima", "maxima"] {
                assert_eq!(wanted_points(&report, kind), wanted_points(&wanted, kind));
            }
            let pairs = &report["simplify"]["pairs"];
            assert_eq!(pairs["found"].as_u64().unwrap() as usize, wanted_points(&report, "minima").len() + wanted_points(&report, "maxima").len());
            // The judge alone agrees.
            let check = bench.run(&["check", "out.vti", "--array", "h_simplified", "--against", "report.json"]);
            assert_eq!(check.code, 0, "{}{}", check.stdout, check.stderr);
        }
    }
}

#[test]
fn the_order_array_is_the_one_that_ttk_would_make() {
    let mut values = hills(24, 18);
    values[77] = f64::NAN;
    let bench = Bench::with(&image([24, 18, 1], vec![doubles("h", &values)]));
    simplifies_with_order(&bench);
    let out = bench.read("out.vti");
    let simple = out.point_array("h_simplified").unwrap().to_f64(0);
    let ArrayData::I32(order) = &out.point_array("h_simplified_Order").unwrap().data else { panic!("an Int32 array") };
    let mut expected: Vec<usize> = (0..simple.len()).collect();
    expected.sort_by(|&a, &b| simple[a].is_nan().cmp(&simple[b].is_nan()).then(simple[a].total_cmp(&simple[b])).then(a.cmp(&b)));
    assert!(expected.iter().enumerate().all(|(rank, &point)| order[point] == rank as i32));
    assert_eq!(order[77], 431, "a hole comes last");
}

fn simplifies_with_order(bench: &Bench) {
    let run = bench.run(&["simplify", "in.vti", "out.vti", "-q", "--persistence", "10%", "--order-array"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let names: Vec<String> = bench.read("out.vti").point_data.arrays.iter().map(|array| array.name.clone()).collect();
    assert_eq!(names, ["h", "h_simplified", "h_simplified_Order"]);
}

fn names(dataset: &DataSet) -> Vec<&str> {
    dataset.point_data.arrays.iter().map(|array| array.name.as_str()).collect()
}

#[test]
fn several_thresholds_and_arrays_in_one_file() {
    let second: Vec<f64> = (0..720).map(|i| (i as f64 / 40.0).cos() + 0.2 * noise(i)).collect();
    let bench = Bench::with(&image([30, 24, 1], vec![doubles("h", &hills(30, 24)), doubles("k", &second)]));
    for (command, ending) in [("simplify", "simplified"), ("smooth", "smooth")] {
        let run = bench.run(&[command, "in.vti", "out.vti", "--array", "h,k", "--persistence", "5%,12.5%,0.4", "--report", "r.json"]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        assert_eq!(run.stdout.matches("passed: the file has exactly").count(), 6, "{}", run.stdout);
        let out = bench.read("out.vti");
        let expected: Vec<String> = ["h", "k"]
            .iter()
            .flat_map(|name| ["5pct", "12.5pct", "40pct"].map(|threshold| format!("{name}_{ending}_{threshold}")))
            .collect();
        assert_eq!(names(&out)[2..], expected.iter().map(String::as_str).collect::<Vec<_>>());
        let results = bench.json("r.json")["results"].as_array().unwrap().clone();
        assert_eq!(results.len(), 6);
        for (name, result) in expected.iter().zip(&results) {
            assert_eq!((&result["output_array"], &result["audit"]["passed"]), (&name.as_str().into(), &true.into()));
            let (minima, maxima) = plain_extrema(&out, &out.point_array(name).unwrap().to_f64(0), None, None);
            assert_eq!((minima, maxima), (wanted_points(result, "minima"), wanted_points(result, "maxima")));
        }
        // Each is what it is alone, bit for bit.
        let alone = bench.run(&[command, "in.vti", "one.vti", "-q", "--array", "k", "--persistence", "12.5%", "--output-array", "x"]);
        assert_eq!(alone.code, 0, "{}", alone.stderr);
        assert_eq!(bench.read("one.vti").point_array("x").unwrap().data, out.point_array(&format!("k_{ending}_12.5pct")).unwrap().data);
    }
    // By repeating the flag, by a pattern, by number and by value.
    let run = bench.run(&["simplify", "in.vti", "out.vti", "-q", "--array", "k", "--array", "h", "--extrema", "6,9"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(names(&bench.read("out.vti"))[2..], ["k_simplified_6extrema", "k_simplified_9extrema", "h_simplified_6extrema", "h_simplified_9extrema"]);
    let run = bench.run(&["simplify", "in.vti", "out.vti", "-q", "--array-pattern", "?", "--persistence-abs", "0.5"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(names(&bench.read("out.vti"))[2..], ["h_simplified", "k_simplified"]);
}

#[test]
fn what_is_kept_besides_the_extrema_is_told() {
    let bench = Bench::with(&hilly(30, 24));
    let plain = bench.smooths("in.vti", &["--persistence", "20%"]);
    assert!(plain["smooth"]["kept_also"].is_null());
    for what in ["saddles", "separatrices", "both"] {
        let report = bench.smooths("in.vti", &["--persistence", "20%", "--keep-also", what]);
        let kept = &report["smooth"]["kept_also"];
        assert_eq!(kept["what"], what);
        assert!(kept["with"].as_f64().unwrap() > kept["without"].as_f64().unwrap());
    }
    let run = bench.run(&["smooth", "in.vti", "out.vti", "--persistence", "20%", "--keep-also", "both"]);
    assert!(run.stdout.lines().any(|line| line.starts_with("kept besides") && line.contains("saddles and")), "{}", run.stdout);
}

#[test]
fn refusals() {
    let bench = Bench::with(&image([24, 18, 1], vec![doubles("h", &hills(24, 18)), doubles("k", &hills(24, 18))]));
    for command in ["simplify", "smooth"] {
        let refuses = |more: &[&str], words: &[&str]| bench.refuses(&[&[command, "in.vti", "out.vti", "-q"], more].concat(), words);
        refuses(&["--array", "h"], &["found no wanted extrema; expected one of --persistence"]);
        refuses(&["--persistence", "5%"], &["found 2 scalar point arrays; expected --array NAME"]);
        refuses(&["--array", "h", "--persistence", "5%,0.05"], &["found the threshold '5pct' twice; expected each once"]);
        refuses(&["--array", "h,k,h", "--persistence", "5%"], &["the array 'h' was named twice; expected each once"]);
        refuses(&["--array", "h,x", "--persistence", "5%"], &["found no point array 'x'"]);
        refuses(&["--array-pattern", "x*", "--persistence", "5%"], &["found no array that fits the pattern 'x*'; expected one of: h, k"]);
        refuses(&["--array-pattern", "h", "--array", "h", "--persistence", "5%"], &["cannot be used with"]);
        refuses(
            &["--array", "h,k", "--output-array", "z", "--persistence", "5%"],
            &["found --output-array z for 2 arrays; expected it with one array only"],
        );
        refuses(
            &["--array", "h", "--output-array", "k", "--persistence", "5%"],
            &["the result would replace the array 'k' of the input; expected another --output-array"],
        );
        refuses(&["--array", "h", "--output-array", "", "--persistence", "5%"], &["found an empty name for --output-array"]);
        refuses(&["--array", "h", "--persistence", "5%", "--extrema", "4"], &["cannot be used with"]);
        refuses(&["--array", "h", "--extrema", "1"], &["in.vti: "]);
    }
    bench.refuses(&["simplify", "in.vti", "in.vti", "--array", "h", "--persistence", "5%", "-q"], &["the output is the input file"]);
    bench.refuses(&["simplify", "in.vti", "out.vtu", "--array", "h", "--persistence", "5%", "-q"], &["expected .vti or .vtk"]);
    bench.refuses(
        &["simplify", "in.vti", "out.vti", "--array", "h", "--persistence", "5%", "-q", "--report", "out.vti"],
        &["the report would overwrite out.vti; expected another name"],
    );
}
