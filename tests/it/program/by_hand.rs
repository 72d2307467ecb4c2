//! `morsmooth interpolate`: extrema that someone wants, on every kind of domain, and wishes that contradict each other.

use morsmooth::audit::extrema;
use morsmooth::field::VertexId;
use morsmooth::io::{DataSet, MaskSources, domain, mask};

use super::Bench;
use super::fields::{doubles, image, noise};

/// A grid without data.
fn grid(dims: [usize; 3]) -> DataSet {
    image(dims, Vec::new())
}

/// Minima and maxima of the array that was written, equal neighbours told apart by their numbers, and its values.
fn found(dataset: &DataSet) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
    let domain = domain(dataset, &mask(dataset, &MaskSources::default()).unwrap()).unwrap();
    let values = dataset.point_array("interpolated").unwrap().to_f64(0);
    let real = extrema(&domain.complex, &domain.restrict(&values)).unwrap();
    let points = |vertices: &[VertexId]| domain.points_of(vertices).into_iter().map(|point| point as usize).collect();
    (points(&real.minima), points(&real.maxima), values)
}

#[test]
fn exactly_the_wanted_extrema_in_two_and_three_dimensions_for_every_order() {
    let bench = Bench::new();
    bench.put("flat.vti", &grid([21, 17, 1]));
    bench.put("solid.vti", &grid([9, 8, 7]));
    // Points 22 and 330 in the plane; a free one and an interval besides.
    bench.text("low.csv", "point,value\n22,0\n200,0.1..0.4\n");
    bench.text("high.json", r#"[{"point": 330, "value": 1}, {"position": [16, 3, 0]}, {"point": 110, "value": [0.3, 0.6]}]"#);
    for order in ["1", "2", "3", "4"] {
        let run = bench.run(&["interpolate", "flat.vti", "out.vti", "--minima", "low.csv", "--maxima", "high.json", "--order", order]);
        assert_eq!(run.code, 0, "{order}: {}{}", run.stdout, run.stderr);
        let (minima, maxima, values) = found(&bench.read("out.vti"));
        assert_eq!((minima, maxima), (vec![22, 200], vec![16 + 3 * 21, 110, 330]), "{order}");
        assert!(values[22] == 0.0 && values[330] == 1.0);
        assert!((0.1..=0.4).contains(&values[200]) && (0.3..=0.6).contains(&values[110]), "{} {}", values[200], values[110]);
    }
    bench.text("deep.csv", "2,2,2,-1\n");
    bench.text("tops.csv", "6,5,4,1\n1,6,5,0.5\n");
    let run = bench.run(&["interpolate", "solid.vti", "out.vti", "--minima", "deep.csv", "--maxima", "tops.csv"]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    let (minima, maxima, _) = found(&bench.read("out.vti"));
    assert_eq!((minima, maxima), (vec![2 + 9 * (2 + 8 * 2)], vec![6 + 9 * (5 + 8 * 4), 1 + 9 * (6 + 8 * 5)]));
}

#[test]
fn a_report_gives_the_same_wishes_back() {
    let bench = Bench::new();
    bench.put("in.vti", &grid([13, 10, 1]));
    bench.text("low.txt", "# two pits\n30 0.5\n70 0.25\n");
    bench.text("high.csv", "6,5;5;0,9\n11,5;1;2\n");
    let fixed = ["interpolate", "in.vti", "--minima", "low.txt", "--maxima", "high.csv", "--report", "r.json", "-q"];
    assert_eq!(bench.run(&[&fixed[..1], &["in.vti", "a.vti"], &fixed[2..]].concat()).code, 0);
    let again = ["interpolate", "in.vti", "b.vti", "--minima", "r.json", "--maxima", "r.json", "-q"];
    assert_eq!(bench.run(&again).code, 0);
    assert_eq!(found(&bench.read("a.vti")), found(&bench.read("b.vti")));
    assert_eq!(found(&bench.read("a.vti")).0, [30, 70]);
}

#[test]
fn outlines_and_series_are_domains_as_well() {
    let bench = Bench::new();
    bench.text("square.csv", "x,y\n0,0\n4,0\n4,3\n0,3\n");
    bench.text("low.csv", "0.5,0.5,0\n");
    bench.text("high.csv", "3.5,2.5,1\n");
    let run = bench.run(&["interpolate", "square.csv", "out.vtp", "--minima", "low.csv", "--maxima", "high.csv", "--max-edge", "8%"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let (minima, maxima, _) = found(&bench.read("out.vtp"));
    assert_eq!((minima.len(), maxima.len()), (1, 1));
    let days: String = (1..=28).map(|day| format!("2001-02-{day:02},{day}\n")).collect();
    bench.text("days.csv", format!("day,n\n{days}"));
    bench.text("ends.csv", "point,value\n0,1\n27,2\n");
    bench.text("peak.csv", "point,value\n9,5\n");
    let run = bench.run(&["interpolate", "days.csv", "line.csv", "--minima", "ends.csv", "--maxima", "peak.csv", "--order", "3"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(found(&bench.read("line.csv")).1, [9]);
}

#[test]
fn methods_without_promise_count_what_they_make() {
    let bench = Bench::new();
    bench.put("in.vti", &grid([41, 5, 1]));
    bench.text("low.csv", "82,0\n90,0\n");
    bench.text("high.csv", "86,1\n");
    for method in ["harmonic", "polyharmonic", "bounded"] {
        let run = bench.run(&["interpolate", "in.vti", "out.vti", "--minima", "low.csv", "--maxima", "high.csv", "--method", method, "--order", "3"]);
        assert_eq!(run.code, 0, "{method}: {}", run.stderr);
        let (minima, maxima, _) = found(&bench.read("out.vti"));
        let spurious = minima.iter().filter(|point| ![82, 90].contains(*point)).count() + maxima.iter().filter(|&&point| point != 86).count();
        let missing = 3 + spurious - minima.len() - maxima.len();
        let said = if spurious + missing > 0 { format!("{spurious} spurious, {missing} missing") } else { "passed".to_owned() };
        assert!(run.stdout.contains(&said), "{method}: {}", run.stdout);
        assert!(method != "polyharmonic" || spurious > 0, "the long tail has no oscillation to show");
    }
}

#[test]
fn the_representative_function_may_be_chosen() {
    let bench = Bench::new();
    bench.put("in.vti", &grid([15, 11, 1]));
    bench.text("low.csv", "point,value\n17,0\n");
    bench.text("high.csv", "point,value\n130,1\n70,0.8\n");
    let fixed = ["interpolate", "in.vti", "out.vti", "--minima", "low.csv", "--maxima", "high.csv", "--report", "r.json"];
    let energy = |more: &[&str]| {
        let run = bench.run(&[&fixed[..], more].concat());
        assert_eq!(run.code, 0, "{more:?}: {}{}", run.stdout, run.stderr);
        assert_eq!(found(&bench.read("out.vti")).1, [70, 130], "{more:?}");
        bench.json("r.json")["energy"].as_f64().unwrap()
    };
    let [automatic, smooth, harmonic] = ["automatic", "smooth-then-simplify", "harmonic"].map(|kind| energy(&["--representative", kind]));
    assert_eq!(automatic, energy(&[]));
    assert_eq!(automatic, smooth, "order 2 takes the smooth function");
    assert_ne!(harmonic, smooth);
    bench.refuses(&[&fixed[..], &["--representative", "flood"]].concat(), &["automatic, smooth-then-simplify, harmonic"]);
}

/// A ramp with two bumps under noise, and 'gaps', the same with NaN in a corner.
fn noisy() -> Bench {
    let value = |point: usize| {
        let (x, y) = ((point % 25) as f64, (point / 25) as f64);
        let bump = |a: f64, b: f64| (-((x - a).powi(2) + (y - b).powi(2)) / 14.0).exp();
        0.02 * x + bump(7.0, 8.0) + 0.8 * bump(18.0, 11.0) + 0.05 * noise(point)
    };
    let values: Vec<f64> = (0..25 * 20).map(value).collect();
    let gaps: Vec<f64> = (0..25 * 20).map(|point| if point % 25 > 19 && point / 25 < 5 { f64::NAN } else { values[point] }).collect();
    let bench = Bench::new();
    bench.put("in.vti", &image([25, 20, 1], vec![doubles("h", &values), doubles("gaps", &gaps)]));
    // One of the two bumps alone, with its value free; the lowest place is the corner.
    bench.text("low.csv", "point\n0\n");
    bench.text("high.csv", "point\n207\n");
    bench
}

const WISHES: [&str; 8] = ["interpolate", "in.vti", "out.vti", "--minima", "low.csv", "--maxima", "high.csv", "--report"];

#[test]
fn a_function_made_by_hand_may_stay_close_to_data() {
    let bench = noisy();
    let run = |more: &[&str]| {
        let run = bench.run(&[&WISHES[..], &["r.json"], more].concat());
        assert_eq!(run.code, 0, "{more:?}: {}{}", run.stdout, run.stderr);
        let (minima, maxima, values) = found(&bench.read("out.vti"));
        assert_eq!((minima, maxima), (vec![0], vec![207]), "{more:?}");
        (values, bench.json("r.json"), run)
    };
    let data = bench.read("in.vti").point_array("h").unwrap().to_f64(0);
    let rms = |values: &[f64]| (values.iter().zip(&data).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / 500.0).sqrt();
    let (near, report, told) = run(&["--data", "h", "--length", "2%"]);
    let (smoother, far, _) = run(&["--data", "h", "--length", "20%"]);
    assert!(rms(&near) < rms(&smoother), "{} {}", rms(&near), rms(&smoother));
    assert!(report["energy"].as_f64().unwrap() > far["energy"].as_f64().unwrap());
    assert!((report["data"]["rms_distance"].as_f64().unwrap() - rms(&near)).abs() < 1e-12);
    assert!(told.stdout.lines().any(|line| line.starts_with("data            h, length")), "{}", told.stdout);
    // Chosen from the noise where nothing is said, and a value may be given besides.
    bench.text("high.csv", "point,value\n207,1.5\n");
    let (values, report, _) = run(&["--data", "h"]);
    assert_eq!((values[207], report["data"]["length"]["automatic"].as_bool()), (1.5, Some(true)));
    // Without data there is no pull, but smoothness goes on.
    let (values, report, _) = run(&["--data", "gaps", "--length-abs", "0.5"]);
    assert_eq!(report["data"]["without_value"], 25);
    let inside = |point: &usize| *point % 25 > 19 && *point / 25 < 5;
    let off = |is: bool| (0..500).filter(|point| inside(point) == is).map(|point| (values[point] - data[point]).abs()).fold(0.0, f64::max);
    assert!(values.iter().all(|value| value.is_finite()) && off(true) > 0.02, "{}", off(true));
}

#[test]
fn data_that_cannot_be_followed_are_refused() {
    let bench = noisy();
    let refuses = |more: &[&str], words: &[&str]| bench.refuses(&[&WISHES[..7], more].concat(), words);
    refuses(&["--data", "g"], &["in.vti: found no point array 'g'; expected the data", "point arrays: h, gaps"]);
    refuses(&["--data", "h", "--method", "bounded"], &["found --data with --method bounded; expected --method monotone"]);
    refuses(&["--length", "2%"], &["found a smoothing length without data; expected --data NAME with it"]);
    refuses(&["--data", "h", "--length", "2%", "--length-abs", "3"], &["--length", "cannot be used with"]);
    refuses(&["--data", "h", "--length-abs", "-1"], &["length"]);
    refuses(&[], &["no minimum of the connected part around vertex 0 has a value"]);
    let mut dataset = bench.read("in.vti");
    dataset.set_point_array(doubles("empty", &[f64::NAN; 500]));
    dataset.set_point_array(doubles("endless", &[f64::INFINITY; 500]));
    bench.put("in.vti", &dataset);
    refuses(&["--data", "empty"], &["in.vti: array 'empty' has no value in the domain; expected some"]);
    refuses(&["--data", "endless"], &["in.vti: array 'endless' is inf at point 0; expected a number, or NaN for none"]);
}

#[test]
fn contradictory_and_impossible_wishes_are_refused_with_their_places() {
    let bench = Bench::new();
    bench.put("in.vti", &grid([13, 10, 1]));
    bench.text("low.csv", "point,value\n30,0.5\n");
    bench.text("lower.csv", "point,value\n95,0.2\n");
    bench.text("high.csv", "point,value\n90,1\n");
    let refuses = |low: &str, high: &str, word: &str| {
        bench.refuses(&["interpolate", "in.vti", "out.vti", "--minima", low, "--maxima", high], &[word]);
    };
    refuses("low.csv", "lower.csv", "in.vti: the minimum at point 30 (low.csv, line 2) has the value 0.5 and the maximum at point 95 (lower.csv, line 2) the value 0.2; expected the first below the second");
    bench.text("near.csv", "point,value\n31,2\n90,\n33,1\n32,3\n");
    refuses("low.csv", "near.csv", "in.vti: the maximum at point 31 (near.csv, line 2) and the maximum at point 32 (near.csv, line 5) are neighbours, so that one of them is lower; expected extrema of a kind apart by two edges at least");
    bench.text("same.csv", "point,value\n30,1\n");
    refuses("low.csv", "same.csv", "in.vti: the minimum at point 30 (low.csv, line 2) and the maximum at point 30 (same.csv, line 2) are one vertex; expected each extremum once");
    bench.text("free.csv", "point\n30\n");
    refuses("free.csv", "high.csv", "no minimum of the connected part around vertex 0 has a value; expected a value or an interval for one of them");
    bench.text("far.csv", "x,y,value\n40,2,0\n");
    refuses("far.csv", "high.csv", "far.csv: line 2: the position [40.0, 2.0, 0.0] is 2.800e1 from the nearest vertex of in.vti, farther than its longest edge; expected a position on the mesh");
    bench.text("word.csv", "point,value\n3,high\n");
    refuses("word.csv", "high.csv", "word.csv: line 2: found 'high'; expected a value, an interval such as 0.2..0.5, or nothing");
    bench.text("over.csv", "point,value\n999,1\n");
    refuses("over.csv", "high.csv", "over.csv: found point 999; in.vti has points 0 to 129");
    bench.text("bad.json", "{\"maxima\": 3}");
    refuses("low.csv", "bad.json", "bad.json: found no list; expected [...] or {\"maxima\": [...]}");
    bench.refuses(&["interpolate", "in.vti", "out.vti"], &["found no wanted extrema; expected --minima FILE and --maxima FILE"]);
    bench.refuses(
        &["interpolate", "in.vti", "out.vti", "--minima", "free.csv", "--maxima", "high.csv", "--method", "bounded"],
        &["the minimum at point 30 (free.csv, line 2) has no single value, which the method bounded needs; expected one, or --method monotone"],
    );
}
