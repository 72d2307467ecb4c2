//! What each option of `morsmooth smooth` does.

use morsmooth::io::{ArrayData, DataArray};

use super::fields::{doubles, hills, hilly, image, noise, plain_extrema, stretched};
use super::{Bench, wanted_points};

#[test]
fn every_strategy_order_and_edge_set_gives_exactly_the_wanted_extrema() {
    let bench = Bench::with(&hilly(26, 20));
    for strategy in ["smooth-then-simplify", "flood", "separatrix", "harmonic"] {
        for order in ["1", "2", "3", "4"] {
            for edges in ["minimal", "all"] {
                let report = bench.smooths(
                    "in.vti",
                    &["--persistence", "20%", "--length", "5%", "--representative", strategy, "--order", order, "--edges", edges],
                );
                assert_eq!(report["smooth"]["representative"]["asked"], strategy);
                assert_eq!(report["smooth"]["order"].as_u64().unwrap().to_string(), order);
                assert!((report["smooth"]["length"]["of_diagonal"].as_f64().unwrap() - 0.05).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn refinement_lowers_the_energy() {
    let bench = Bench::with(&hilly(30, 24));
    let report = bench.smooths("in.vti", &["--persistence", "30%", "--representative", "harmonic", "--refine", "4"]);
    let energies: Vec<f64> = report["smooth"]["energy"]["rounds"].as_array().unwrap().iter().map(|e| e.as_f64().unwrap()).collect();
    assert_eq!(energies.len(), 5);
    // A round may end a duality gap above its optimum.
    assert!(energies.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-6)), "{energies:?}");
    assert!(energies[4] < energies[0]);
}

#[test]
fn values_are_kept_freed_or_bounded() {
    let bench = Bench::with(&hilly(30, 24));
    let data = hills(30, 24);
    let (low, high) = (data.iter().copied().fold(f64::MAX, f64::min), data.iter().copied().fold(f64::MIN, f64::max));
    let moves = |values: &str| -> (f64, f64) {
        let report = bench.smooths("in.vti", &["--persistence", "20%", "--values", values]);
        let smooth = bench.read("out.vti").point_array("h_smooth").unwrap().to_f64(0);
        let points = [wanted_points(&report, "minima"), wanted_points(&report, "maxima")].concat();
        let largest = points.iter().map(|&point| (smooth[point] - data[point]).abs()).fold(0.0, f64::max);
        (largest, report["smooth"]["energy"]["result"].as_f64().unwrap())
    };
    let (kept, energy_kept) = moves("keep");
    let (within, energy_within) = moves("5%");
    let (free, energy_free) = moves("free");
    assert_eq!(kept, 0.0);
    assert!(within > 0.0 && within <= 0.05 * (high - low) * (1.0 + 1e-12), "{within}");
    assert!(free > within);
    assert!(energy_free < energy_within && energy_within < energy_kept);
}

#[test]
fn selections_of_every_kind() {
    let bench = Bench::with(&hilly(30, 24));
    let by_fraction = bench.smooths("in.vti", &["--persistence", "0.2"]);
    let threshold = by_fraction["smooth"]["threshold"].as_f64().unwrap();
    let by_percent = bench.smooths("in.vti", &["--persistence", "20%"]);
    let by_value = bench.smooths("in.vti", &["--persistence-abs", &format!("{threshold:?}")]);
    assert_eq!(by_fraction["wanted"], by_percent["wanted"]);
    assert_eq!(by_fraction["wanted"], by_value["wanted"]);
    let count = wanted_points(&by_value, "minima").len() + wanted_points(&by_value, "maxima").len();
    let by_count = bench.smooths("in.vti", &["--extrema", &count.to_string()]);
    assert_eq!(by_count["wanted"], by_value["wanted"]);
    assert!(by_count["smooth"]["threshold"].is_null());
    let least = bench.smooths("in.vti", &["--extrema", "2"]);
    assert_eq!((wanted_points(&least, "minima").len(), wanted_points(&least, "maxima").len()), (1, 1));

    let points = [wanted_points(&by_value, "minima"), wanted_points(&by_value, "maxima")].concat();
    let lines: Vec<String> = points.iter().map(|point| format!("{point}, # a comment")).collect();
    bench.text("keep.txt", lines.join("\n") + "\n\n# end\n");
    assert_eq!(bench.smooths("in.vti", &["--keep", "keep.txt"])["wanted"], by_value["wanted"]);

    // A persistence diagram as TTK writes it: births and deaths as points, saddles among them.
    let ids: Vec<i32> = points.iter().map(|&point| point as i32).chain([0]).collect();
    let minima = wanted_points(&by_value, "minima").len();
    let kinds: Vec<i32> = (0..ids.len()).map(|place| if place < minima { 0 } else if place < points.len() { 3 } else { 1 }).collect();
    let places: Vec<[f64; 3]> = ids.iter().map(|&id| [f64::from(id), 0.0, 0.0]).collect();
    let corners: Vec<i64> = (0..ids.len() as i64 - 1).flat_map(|place| [place, place + 1]).collect();
    let mut diagram = super::fields::unstructured(&places, super::fields::cells(2, &corners), 3, &vec![0.0; ids.len()]);
    diagram.set_point_array(DataArray::new("ttkVertexScalarField", 1, ArrayData::I32(ids)));
    diagram.set_point_array(DataArray::new("CriticalType", 1, ArrayData::I32(kinds)));
    bench.put("diagram.vtu", &diagram);
    assert_eq!(bench.smooths("in.vti", &["--keep", "diagram.vtu"])["wanted"], by_value["wanted"]);
}

#[test]
fn lengths_are_fractions_of_the_diagonal_or_absolute() {
    let bench = Bench::with(&stretched([0.5, 0.25, 1.0], [3.0, -1.0, 0.0], [24, 18, 1], vec![doubles("h", &hills(24, 18))]));
    let diagonal = (11.5f64.powi(2) + 4.25f64.powi(2)).sqrt();
    let relative = bench.smooths("in.vti", &["--persistence", "20%", "--length", "4%"]);
    let first = std::fs::read(bench.path("out.vti")).unwrap();
    let absolute = bench.smooths("in.vti", &["--persistence", "20%", "--length-abs", &format!("{:?}", 0.04 * diagonal)]);
    let length = |report: &serde_json::Value| report["smooth"]["length"]["absolute"].as_f64().unwrap();
    assert!((length(&relative) / (0.04 * diagonal) - 1.0).abs() < 1e-12);
    assert!((length(&absolute) / length(&relative) - 1.0).abs() < 1e-12);
    assert_eq!(first.len(), std::fs::read(bench.path("out.vti")).unwrap().len());
    assert_eq!(relative["smooth"]["length"]["automatic"], false);
}

#[test]
fn longer_lengths_are_smoother() {
    let bench = Bench::with(&hilly(30, 24));
    let roughness = |length: &str| {
        bench.smooths("in.vti", &["--extrema", "2", "--length", length]);
        let values = bench.read("out.vti").point_array("h_smooth").unwrap().to_f64(0);
        (0..values.len() - 2).filter(|i| i % 30 < 28).map(|i| (values[i] - 2.0 * values[i + 1] + values[i + 2]).powi(2)).sum::<f64>()
    };
    let (short, middle, long) = (roughness("1%"), roughness("4%"), roughness("16%"));
    assert!(short > middle && middle > long, "{short} {middle} {long}");
}

#[test]
fn confidence_pulls_and_the_smoothness_mask_lets_go() {
    let data = hills(30, 24);
    let trusted: Vec<f64> = (0..720).map(|i| if i % 30 < 15 { 100.0 } else { 0.01 }).collect();
    let spike: Vec<f64> = (0..720).map(|i| if i == 375 { 0.0 } else { 1.0 }).collect();
    let bench = Bench::with(&image([30, 24, 1], vec![doubles("h", &data), doubles("c", &trusted), doubles("s", &spike)]));
    let distance = |arguments: &[&str]| -> (f64, f64) {
        bench.smooths("in.vti", &[&["--array", "h", "--extrema", "12", "--length", "5%"], arguments].concat());
        let values = bench.read("out.vti").point_array("h_smooth").unwrap().to_f64(0);
        let part = |left: bool| (0..720).filter(|i| (i % 30 < 15) == left).map(|i| (values[i] - data[i]).powi(2)).sum::<f64>();
        (part(true), part(false))
    };
    let (left, right) = distance(&[]);
    let (trusted_left, doubted_right) = distance(&["--confidence", "c"]);
    assert!(trusted_left < left && doubted_right > right);
    let plain = bench.smooths("in.vti", &["--array", "h", "--extrema", "12", "--length", "5%"]);
    let masked = bench.smooths("in.vti", &["--array", "h", "--extrema", "12", "--length", "5%", "--smoothness", "s"]);
    let energy = |report: &serde_json::Value| report["smooth"]["energy"]["unconstrained"].as_f64().unwrap();
    assert!(energy(&masked) < energy(&plain), "less is asked");
}

#[test]
fn the_array_is_named_as_asked() {
    let bench = Bench::with(&hilly(24, 18));
    bench.smooths("in.vti", &["--extrema", "4", "--output-array", "a \"strange\" <name> µ"]);
    assert!(bench.read("out.vti").point_array("a \"strange\" <name> µ").is_some());
    let run = bench.run(&["smooth", "in.vti", "replaced.vti", "--extrema", "4", "--output-array", "h"]);
    assert_eq!(run.code, 0);
    assert!(run.stderr.contains("note: the array h of the input is replaced in the output"), "{}", run.stderr);
    assert_eq!(bench.read("replaced.vti").point_data.arrays.len(), 1);
}

#[test]
fn widths_follow_the_input() {
    let data = hills(24, 18);
    for (array, single) in [
        (ArrayData::F32(data.iter().map(|&value| value as f32).collect()), true),
        (ArrayData::F64(data.clone()), false),
        (ArrayData::I16(data.iter().map(|value| (300.0 * value) as i16).collect()), false),
        (ArrayData::U8(data.iter().map(|value| (60.0 * value + 120.0) as u8).collect()), false),
        (ArrayData::I64(data.iter().map(|value| (1e12 * value) as i64).collect()), false),
    ] {
        let bench = Bench::with(&image([24, 18, 1], vec![DataArray::new("h", 1, array)]));
        let report = bench.smooths("in.vti", &["--persistence", "20%"]);
        assert_eq!(report["smooth"]["precision"], if single { "f32" } else { "f64" });
    }
}

#[test]
fn the_raw_optimum_has_the_wanted_extrema_up_to_ties() {
    let bench = Bench::with(&hilly(30, 24));
    let run = bench.run(&["smooth", "in.vti", "out.vti", "--extrema", "6", "--raw", "--report", "r.json", "--gap", "1e-10"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let report = bench.json("r.json");
    let (audit, energy) = (&report["audit"], &report["smooth"]["energy"]);
    assert_eq!(audit["minima"].as_u64().unwrap() + audit["maxima"].as_u64().unwrap(), 6);
    let strict = bench.smooths("in.vti", &["--extrema", "6"]);
    let (raw, strict) = (energy["result"].as_f64().unwrap(), strict["smooth"]["energy"]["result"].as_f64().unwrap());
    assert!(raw <= strict * (1.0 + 1e-7), "margins cost: {raw} {strict}");
}

#[test]
fn scalars_are_derived_from_a_known_vector_field() {
    // (u, v) = (x^2 - 3 x y, x y + y^2): curl y + 3 x, divergence 2 x - 3 y + x + 2 y = 3 x - y.
    let (width, height, spacing) = (21usize, 17usize, 0.1);
    let place = |i: usize| ((i % width) as f64 * spacing, (i / width) as f64 * spacing);
    let vectors: Vec<f64> = (0..width * height)
        .flat_map(|i| {
            let (x, y) = place(i);
            [x * x - 3.0 * x * y, x * y + y * y, 0.0]
        })
        .collect();
    let velocity = DataArray::new("u", 3, ArrayData::F64(vectors));
    let bench = Bench::with(&stretched([spacing; 3], [0.0; 3], [width, height, 1], vec![velocity]));
    for (kind, name) in [
        ("vorticity", "u_vorticity"),
        ("divergence", "u_divergence"),
        ("magnitude", "u_magnitude"),
        ("q-criterion", "u_q_criterion"),
        ("okubo-weiss", "u_okubo_weiss"),
    ] {
        let report = bench.smooths("in.vti", &["--derive", kind, "--extrema", "2", "--length", "1%"]);
        assert_eq!((&report["array"], &report["output_array"]), (&name.into(), &format!("{name}_smooth").into()));
        let values = bench.read("out.vti").point_array(&format!("{name}_smooth")).unwrap().to_f64(0);
        // With a short length the field is that of the formulas, up to the error of differences on such a grid.
        let exact = |i: usize| {
            let (x, y) = place(i);
            let (ux, uy, vx, vy) = (2.0 * x - 3.0 * y, -3.0 * x, y, x + 2.0 * y);
            match kind {
                "vorticity" => vx - uy,
                "divergence" => ux + vy,
                "magnitude" => (x * x - 3.0 * x * y).hypot(x * y + y * y),
                "q-criterion" => -0.5 * (ux * ux + vy * vy) - uy * vx,
                _ => (ux - vy).powi(2) + (vx + uy).powi(2) - (vx - uy).powi(2),
            }
        };
        let range = (0..values.len()).map(exact).fold(0.0f64, |range, value| range.max(value.abs()));
        let inner = (0..values.len()).filter(|i| (2..width - 2).contains(&(i % width)) && (2..height - 2).contains(&(i / width)));
        let worst = inner.map(|i| (values[i] - exact(i)).abs()).fold(0.0, f64::max);
        assert!(worst < 0.15 * range, "{kind}: {worst} of {range}");
    }
}

#[test]
fn selecting_on_the_smooth_field_ignores_single_outliers() {
    let mut data: Vec<f64> = (0..900).map(|i| ((i % 30) as f64 / 9.0).sin() * ((i / 30) as f64 / 9.0).cos() + 0.02 * noise(i)).collect();
    data[435] += 3.0;
    let bench = Bench::with(&image([30, 30, 1], vec![doubles("h", &data)]));
    let on_data = bench.smooths("in.vti", &["--persistence", "30%", "--length", "5%"]);
    let on_smooth = bench.smooths("in.vti", &["--persistence", "30%", "--length", "5%", "--select", "smooth", "--values", "free"]);
    assert!(wanted_points(&on_data, "maxima").contains(&435));
    assert_eq!(on_smooth["smooth"]["select_on"], "smooth");
    let values = bench.read("out.vti").point_array("h_smooth").unwrap().to_f64(0);
    assert_eq!(plain_extrema(&bench.read("out.vti"), &values, None, None).0, wanted_points(&on_smooth, "minima"));
    assert!(values[435] < 2.0, "the outlier is smoothed away");
}
