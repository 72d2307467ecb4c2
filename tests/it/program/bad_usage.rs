//! Command lines that ask for what cannot be.

use morsmooth::io::{ArrayData, DataArray};

use super::Bench;
use super::fields::{cells, doubles, hills, hilly, image, plain_extrema, unstructured};

fn refuses(bench: &Bench, more: &[&str], words: &[&str]) {
    bench.refuses(&[&["smooth", "in.vti", "out.vti", "-q"], more].concat(), words);
}

#[test]
fn thresholds() {
    let bench = Bench::with(&hilly(24, 18));
    let part = "expected a finite part not below 0";
    refuses(&bench, &["--persistence", "-1"], &["found '-1'", part]);
    refuses(&bench, &["--persistence", "-5%"], &["found '-5%'", part]);
    refuses(&bench, &["--persistence", "NaN"], &["found 'NaN'", part]);
    refuses(&bench, &["--persistence", "inf"], &["found 'inf'", part]);
    refuses(&bench, &["--persistence", "ten"], &["found 'ten'; expected a part such as 10% or 0.1"]);
    refuses(&bench, &["--persistence", ""], &["found ''; expected a part such as 10% or 0.1"]);
    let threshold = "expected a finite number that is at least 0";
    refuses(&bench, &["--persistence-abs", "-1"], &["in.vti: persistence threshold -1", threshold]);
    refuses(&bench, &["--persistence-abs", "nan"], &["in.vti: persistence threshold NaN", threshold]);
    refuses(&bench, &["--persistence-abs", "inf"], &["in.vti: persistence threshold inf", threshold]);
}

#[test]
fn selections() {
    let bench = Bench::with(&hilly(24, 18));
    refuses(&bench, &[], &["found no wanted extrema; expected one of --persistence, --persistence-abs, --extrema, --keep", "hint: "]);
    refuses(&bench, &["--extrema", "2", "--persistence", "1%"], &["'--extrema <N>' cannot be used with '--persistence <FRACTION>'"]);
    refuses(&bench, &["--keep", "k", "--persistence-abs", "1"], &["cannot be used with"]);
    refuses(&bench, &["--extrema", "0"], &["in.vti: 0 extrema asked for; expected at least 2"]);
    refuses(&bench, &["--extrema", "1"], &["in.vti: 1 extrema asked for; expected at least 2"]);
    refuses(&bench, &["--extrema", "-3"], &["-3"]);
    let (minima, maxima) = plain_extrema(&bench.read("in.vti"), &hills(24, 18), None, None);
    let all = minima.len() + maxima.len();
    refuses(&bench, &["--extrema", &(all + 1).to_string()], &[&format!("{} extrema asked for; expected at most {all}", all + 1)]);
}

#[test]
fn kept_sets() {
    let bench = Bench::with(&hilly(24, 18));
    let (minima, maxima) = plain_extrema(&bench.read("in.vti"), &hills(24, 18), None, None);
    let ordinary = (0..432).find(|point| !minima.contains(point) && !maxima.contains(point)).unwrap();
    let keep = |text: &str, words: &[&str]| {
        bench.text("keep.txt", text);
        refuses(&bench, &["--keep", "keep.txt"], words);
    };
    let pair = format!("{} {}", minima[0], maxima[0]);
    keep(&format!("{pair} {ordinary}"), &[&format!("in.vti: vertex {ordinary} is no minimum or maximum of the field")]);
    keep(&format!("{pair} 432"), &["keep.txt: found point 432; in.vti has points 0 to 431"]);
    keep(&format!("{pair} 99999999999999999999"), &["keep.txt: line 1: found '99999999999999999999'; expected a point number"]);
    keep(&format!("{pair}\n# fine\n-1"), &["keep.txt: line 3: found '-1'; expected a point number"]);
    keep(&format!("{pair}\n1.5"), &["keep.txt: line 2: found '1.5'; expected a point number"]);
    keep("some words", &["keep.txt: line 1: found 'some'; expected a point number"]);
    keep("", &["keep.txt: found no point number; expected at least one"]);
    keep("# nothing\n", &["keep.txt: found no point number; expected at least one"]);
    keep(&minima[0].to_string(), &["in.vti: the component of vertex 0 keeps no maximum; expected one at least"]);
    keep(&maxima[0].to_string(), &["in.vti: the component of vertex 0 keeps no minimum; expected one at least"]);
    refuses(&bench, &["--keep", "no.txt"], &["no.txt: cannot be read"]);
    refuses(&bench, &["--keep", "."], &[".: cannot be read"]);
    bench.text("bytes.txt", [0xff, 0xfe, 0x00]);
    refuses(&bench, &["--keep", "bytes.txt"], &["bytes.txt: cannot be read"]);
    bench.text("broken.vtu", "<VTKFile");
    refuses(&bench, &["--keep", "broken.vtu"], &["broken.vtu, line 1: found broken XML"]);
    bench.put("plain.vtu", &unstructured(&[[0.0; 3], [1.0; 3]], cells(2, &[0, 1]), 3, &[0.0, 1.0]));
    refuses(&bench, &["--keep", "plain.vtu"], &["plain.vtu: found no point array 'ttkVertexScalarField'"]);
    let mut diagram = bench.read("plain.vtu");
    diagram.set_point_array(doubles("ttkVertexScalarField", &[0.5, -1.0]));
    bench.put("odd.vtu", &diagram);
    refuses(&bench, &["--keep", "odd.vtu"], &["odd.vtu: found vertex 0.5 in ttkVertexScalarField; expected a point number"]);
    let texts = |name: &str| DataArray::new(name, 1, ArrayData::String(vec![b"a".to_vec(), b"b".to_vec()]));
    diagram.set_point_array(doubles("ttkVertexScalarField", &[0.0, 1.0]));
    diagram.set_point_array(texts("CriticalType"));
    bench.put("texts.vtu", &diagram);
    refuses(&bench, &["--keep", "texts.vtu"], &["texts.vtu: found no point number"]);
    diagram.set_point_array(texts("ttkVertexScalarField"));
    bench.put("texts.vtu", &diagram);
    refuses(&bench, &["--keep", "texts.vtu"], &["texts.vtu: found no point number"]);
}

#[test]
fn numbers_out_of_range() {
    let bench = Bench::with(&hilly(24, 18));
    let with = |more: &[&str], words: &[&str]| refuses(&bench, &[&["--extrema", "2"], more].concat(), words);
    with(&["--order", "0"], &["invalid value '0' for '--order <K>'", "1..=4"]);
    with(&["--order", "5"], &["invalid value '5' for '--order <K>'", "1..=4"]);
    with(&["--length", "0"], &["smoothing length is 0.0; expected a finite number above 0"]);
    with(&["--length", "-1"], &["found '-1'; expected a finite part not below 0"]);
    with(&["--length", "2%", "--length-abs", "1"], &["cannot be used with"]);
    with(&["--length-abs", "0"], &["smoothing length is 0.0; expected a finite number above 0"]);
    with(&["--length-abs", "-1"], &["smoothing length is -1.0; expected a finite number above 0"]);
    with(&["--length-abs", "nan"], &["smoothing length is NaN; expected a finite number above 0"]);
    with(&["--length-abs", "1e300"], &["a smoothing length of 1e300", "to the power of 4 is no number", "rescale"]);
    with(&["--length-abs", "1e-300"], &["a smoothing length of 1e-300", "to the power of 4 is no number"]);
    with(&["--gap", "0"], &["relative gap is 0.0; expected a number in (0, 0.1]"]);
    with(&["--gap", "-1"], &["relative gap is -1.0; expected a number in (0, 0.1]"]);
    with(&["--gap", "0.5"], &["relative gap is 0.5; expected a number in (0, 0.1]"]);
    with(&["--gap", "nan"], &["relative gap is NaN; expected a number in (0, 0.1]"]);
    with(&["--values", "-5%"], &["found '-5%'; expected keep, free or a part such as 5%"]);
    with(&["--values", "10"], &["found '10', which is 1000 %; expected at most 100 %; did you mean 10%?"]);
    with(&["--length", "2"], &["did you mean 2%?"]);
    with(&["--values", "held"], &["found 'held'; expected keep, free or a part such as 5%"]);
    with(&["--threads", "0"], &["found --threads 0; expected at least 1"]);
    with(&["--refine", "-1"], &["-1"]);
    with(&["--representative", "best"], &["invalid value 'best'", "smooth-then-simplify, flood, separatrix, harmonic"]);
    with(&["--edges", "some"], &["invalid value 'some'", "minimal, all"]);
    with(&["--select", "nothing"], &["invalid value 'nothing'", "data, smooth"]);
    with(&["--unknown"], &["unexpected argument '--unknown'"]);
}

#[test]
fn arrays_that_do_not_fit() {
    let h = hills(24, 18);
    let vectors = DataArray::new("velocity", 3, ArrayData::F32(vec![0.5; 3 * 432]));
    let texts = DataArray::new("texts", 1, ArrayData::String(vec![b"word".to_vec(); 432]));
    let mut dataset = image([24, 18, 1], vec![doubles("h", &h), doubles("other", &h), vectors, texts]);
    dataset.cell_data.set(doubles("per_cell", &[1.0; 391]));
    let bench = Bench::with(&dataset);
    let with = |more: &[&str], words: &[&str]| refuses(&bench, &[&["--extrema", "2"], more].concat(), words);
    with(&[], &["in.vti: found 2 scalar point arrays; expected --array NAME", "hint: scalar point arrays: h (", ", other ("]);
    with(&["--array", "nothing"], &["in.vti: found no point array 'nothing'", "hint: scalar point arrays: h (", "other ("]);
    with(&["--array", "velocity"], &["array 'velocity' has 3 components; expected 1", "hint: --derive magnitude"]);
    with(&["--array", "h", "--derive", "vorticity"], &["array 'h' has 1 components; expected a vector of 2 or 3", "velocity (3 components)"]);
    with(&["--array", "texts"], &["array 'texts' holds texts; expected numbers"]);
    with(&["--array", "per_cell"], &["found no point array 'per_cell'", "hint: 'per_cell' is a cell array", "Cell Data to Point Data"]);
    with(&["--array", "velocity", "--derive", "speed"], &["invalid value 'speed'", "vorticity, divergence, magnitude, q-criterion, okubo-weiss"]);
    with(&["--derive", "magnitude"], &["in.vti: the field is constant (value 0.866"]);
    with(&["--array", "h", "--mask", "nothing"], &["in.vti: found no point or cell array \"nothing\"; expected one of: h, other, velocity, texts, per_cell"]);
    with(&["--array", "h", "--mask", "velocity"], &["in.vti: found 3 components of type Float32 in mask \"velocity\"; expected one number each"]);
    with(&["--array", "h", "--mask", "texts"], &["in.vti: found 1 components of type String in mask \"texts\""]);
    with(&["--array", "h", "--confidence", "nothing"], &["in.vti: found no point array 'nothing'; expected one of h, other"]);
    with(&["--array", "h", "--confidence", "velocity"], &["array 'velocity' has 3 components; expected one number a point"]);
    with(&["--array", "h", "--confidence", "texts"], &["array 'texts' holds texts; expected one number a point"]);
    with(&["--array", "h", "--output-array", ""], &["found an empty name for --output-array"]);
    with(&["--array", "h", "--output-array", "other"], &["the result would replace the array 'other' of the input"]);
    with(&["--array", "h", "--mask", "other", "--output-array", "other"], &["the result would replace the array 'other' of --mask"]);
    let vectors = DataArray::new("velocity", 3, ArrayData::F32(vec![0.5; 3 * 432]));
    let only_vectors = Bench::with(&image([24, 18, 1], vec![vectors]));
    refuses(&only_vectors, &["--extrema", "2"], &["in.vti: found no scalar point array; expected one to work on", "hint: 'morsmooth info FILE'"]);
}

#[test]
fn weights_out_of_range() {
    let mut negative = vec![1.0; 432];
    negative[100] = -0.5;
    let mut large = vec![0.5; 432];
    large[7] = 1.5;
    let mut hole = vec![1.0; 432];
    hole[3] = f64::NAN;
    let arrays = vec![
        doubles("h", &hills(24, 18)),
        doubles("negative", &negative),
        doubles("large", &large),
        doubles("hole", &hole),
        doubles("zero", &[0.0; 432]),
    ];
    let bench = Bench::with(&image([24, 18, 1], arrays));
    let with = |more: &[&str], words: &[&str]| refuses(&bench, &[&["--array", "h", "--extrema", "2"], more].concat(), words);
    with(&["--confidence", "negative"], &["in.vti: confidence is -0.5 at vertex 100; expected a finite number not below 0"]);
    with(&["--confidence", "hole"], &["in.vti: confidence is NaN at vertex 3"]);
    with(&["--confidence", "zero"], &["in.vti: ", "confidence", "expected"]);
    with(&["--smoothness", "large"], &["in.vti: smoothness mask is 1.5 at vertex 7; expected a number in [0, 1]"]);
    with(&["--smoothness", "negative"], &["in.vti: smoothness mask is -0.5 at vertex 100"]);
    with(&["--smoothness", "hole"], &["in.vti: smoothness mask is NaN at vertex 3"]);
}

#[test]
fn commands_that_are_none() {
    let bench = Bench::with(&hilly(24, 18));
    bench.refuses(&["smoothen", "in.vti", "out.vti"], &["unrecognized subcommand 'smoothen'"]);
    bench.refuses(&["smooth", "in.vti", "--extrema", "2"], &["<OUTPUT>"]);
    bench.refuses(&["smooth"], &["<INPUT>"]);
    bench.text("empty.json", "{}");
    bench.text("broken.json", "{");
    bench.text("odd.json", r#"{"wanted": {"minima": [{"point": "x"}], "maxima": []}}"#);
    bench.text("far.json", r#"{"wanted": {"minima": [{"point": 432}], "maxima": []}}"#);
    let check = |file: &str, words: &[&str]| bench.refuses(&["check", "in.vti", "-q", "--against", file], words);
    check("no.json", &["no.json: cannot be read"]);
    check("empty.json", &["empty.json: found no list wanted.minima; expected a report of 'morsmooth smooth'"]);
    check("broken.json", &["broken.json: is no JSON report"]);
    check("odd.json", &["odd.json: an entry of wanted.minima has no point number"]);
    check("far.json", &["far.json: found point 432; in.vti has points 0 to 431"]);
    bench.refuses(&["check", "in.vti", "--against", "empty.json", "--minima", "x"], &["cannot be used with"]);
}
