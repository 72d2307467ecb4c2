//! Unusual input that has an answer.

use morsmooth::io::{ArrayData, DataArray, DataSet};

use super::fields::{cells, doubles, hills, hilly, image, lattice, noise, squares, stretched, surface};
use super::{Bench, wanted_points};

fn notes(report: &serde_json::Value) -> String {
    report["notes"].to_string()
}

fn small(dims: [usize; 3], value: impl Fn(usize) -> f64) -> DataSet {
    let values: Vec<f64> = (0..dims.iter().product()).map(value).collect();
    image(dims, vec![doubles("h", &values)])
}

#[test]
fn some_nan_are_holes() {
    let mut data = hills(24, 18);
    for point in [0, 60, 61, 84, 85, 200, 431] {
        data[point] = f64::NAN;
    }
    let bench = Bench::with(&image([24, 18, 1], vec![doubles("h", &data)]));
    let report = bench.smooths("in.vti", &["--persistence", "20%"]);
    assert_eq!((&report["points"], &report["vertices"]), (&432.into(), &425.into()));
    let written = bench.read("out.vti").point_array("h_smooth").unwrap().to_f64(0);
    assert!((0..432).all(|point| written[point].is_nan() == data[point].is_nan()));
}

#[test]
fn an_infinite_value_may_be_masked() {
    let mut data = hills(24, 18);
    data[77] = f64::INFINITY;
    let shown: Vec<f64> = (0..432).map(|point| f64::from(u8::from(point != 77))).collect();
    let bench = Bench::with(&image([24, 18, 1], vec![doubles("h", &data), doubles("m", &shown)]));
    bench.smooths("in.vti", &["--array", "h", "--mask", "m", "--persistence", "20%"]);
    assert_eq!(bench.read("out.vti").point_array("h_smooth").unwrap().to_f64(0)[77], f64::INFINITY);
}

#[test]
fn a_constant_part_beside_varying_ones_is_left_out() {
    let wall: Vec<f64> = (0..432).map(|i| f64::from(u8::from(i % 24 != 12))).collect();
    let data: Vec<f64> = hills(24, 18).iter().enumerate().map(|(i, &value)| if i % 24 > 12 { 7.0 } else { value }).collect();
    let bench = Bench::with(&image([24, 18, 1], vec![doubles("h", &data), doubles("m", &wall)]));
    let report = bench.smooths("in.vti", &["--array", "h", "--mask", "m", "--persistence", "20%"]);
    let note = "the field is constant (value 7.0) on a part of 198 points, first point 13; left out, they keep their value";
    assert!(notes(&report).contains(note), "{}", notes(&report));
    let written = bench.read("out.vti").point_array("h_smooth").unwrap().to_f64(0);
    assert!((0..432).filter(|i| i % 24 > 12).all(|i| written[i] == 7.0));
    let run = bench.run(&["smooth", "in.vti", "again.vti", "--array", "h", "--mask", "m", "--persistence", "20%"]);
    assert!(run.stderr.contains(&format!("note: {note}")), "{}", run.stderr);
    let check = bench.run(&["check", "out.vti", "--array", "h_smooth", "--mask", "m", "--against", "report.json"]);
    assert_eq!(check.code, 0, "{}{}", check.stdout, check.stderr);
    assert!(check.stderr.contains("note: "));
}

#[test]
fn two_parts_keep_a_minimum_and_a_maximum_each() {
    let wall: Vec<f64> = (0..432).map(|i| f64::from(u8::from(i % 24 != 12))).collect();
    let bench = Bench::with(&image([24, 18, 1], vec![doubles("h", &hills(24, 18)), doubles("m", &wall)]));
    let report = bench.smooths("in.vti", &["--array", "h", "--mask", "m", "--persistence", "100%"]);
    assert_eq!(report["smooth"]["components"], 2);
    for kind in ["minima", "maxima"] {
        let points = wanted_points(&report, kind);
        assert_eq!(points.len(), 2);
        assert_ne!(points[0] % 24 < 12, points[1] % 24 < 12);
    }
    bench.refuses(&["smooth", "in.vti", "x.vti", "-q", "--array", "h", "--mask", "m", "--extrema", "3"], &["3 extrema asked for; expected at least 4"]);
}

#[test]
fn one_edge_one_triangle_one_tetrahedron() {
    for dims in [[2, 1, 1], [1, 2, 1], [1, 1, 2], [2, 2, 1], [2, 2, 2]] {
        let bench = Bench::with(&small(dims, |i| [3.0, -1.0, 4.0, 1.5, -5.0, 9.0, 2.0, 6.0][i]));
        for arguments in [&["--persistence", "0"][..], &["--extrema", "2", "--order", "4"], &["--extrema", "2", "--values", "free"]] {
            let report = bench.smooths("in.vti", arguments);
            assert!(!wanted_points(&report, "minima").is_empty(), "{dims:?}");
        }
    }
    let bench = Bench::with(&surface(&lattice(2, 2), cells(3, &[0, 1, 2]), &[1.0, 2.0, 3.0, 8.0]));
    let report = bench.smooths("in.vtp", &["--persistence", "0"]);
    assert!(notes(&report).contains("1 points belong to no cell, first point 3"));
    assert_eq!(bench.read("out.vtp").point_array("h_smooth").unwrap().to_f64(0)[3], 8.0);
}

#[test]
fn degenerate_grids() {
    for dims in [[2, 40, 1], [40, 2, 1], [1, 40, 1], [40, 1, 1], [12, 1, 9], [1, 12, 9], [2, 2, 30], [3, 2, 2]] {
        let bench = Bench::with(&small(dims, noise));
        for persistence in ["0", "30%", "100%"] {
            bench.smooths("in.vti", &["--persistence", persistence]);
        }
        bench.smooths("in.vti", &["--persistence", "30%", "--select", "smooth", "--order", "3"]);
    }
}

#[test]
fn all_extrema_kept_and_only_the_global_ones() {
    let bench = Bench::with(&hilly(24, 18));
    let data = hills(24, 18);
    let all = bench.smooths("in.vti", &["--persistence", "0"]);
    let (minima, maxima) = super::fields::plain_extrema(&bench.read("in.vti"), &data, None, None);
    assert_eq!((wanted_points(&all, "minima"), wanted_points(&all, "maxima")), (minima, maxima));
    let few = bench.smooths("in.vti", &["--persistence", "100%"]);
    let end = |greatest: bool| {
        let sign = if greatest { 1.0 } else { -1.0 };
        (0..432).max_by(|&a, &b| (sign * data[a]).total_cmp(&(sign * data[b]))).unwrap()
    };
    assert_eq!((wanted_points(&few, "minima"), wanted_points(&few, "maxima")), (vec![end(false)], vec![end(true)]));
    assert_eq!(bench.smooths("in.vti", &["--persistence-abs", "1e300"])["wanted"], few["wanted"]);
}

#[test]
fn few_distinct_values() {
    // A checkerboard, wide stripes, and steps: nearly every vertex ties with a neighbour.
    let bench = |value: fn(usize, usize) -> f64| Bench::with(&small([20, 16, 1], |i| value(i % 20, i / 20)));
    for bench in [
        bench(|x, y| ((x + y) % 2) as f64),
        bench(|x, y| ((x / 4 + y / 4) % 2) as f64),
        bench(|x, _| (x / 10) as f64),
        bench(|x, y| if (x, y) == (7, 7) { 1.0 } else { 0.0 }),
    ] {
        for arguments in [&["--persistence", "0"][..], &["--persistence", "50%"], &["--persistence", "10%", "--select", "smooth"]] {
            bench.smooths("in.vti", arguments);
        }
    }
}

#[test]
fn integers_with_plateaus() {
    let values: Vec<i16> = hills(30, 24).iter().map(|value| (4.0 * value).round() as i16).collect();
    let bench = Bench::with(&image([30, 24, 1], vec![DataArray::new("h", 1, ArrayData::I16(values))]));
    for persistence in ["0", "10%", "40%"] {
        bench.smooths("in.vti", &["--persistence", persistence]);
    }
}

#[test]
fn huge_and_tiny_values() {
    let persistences = |scale: f64| {
        let values: Vec<f64> = hills(24, 18).iter().map(|value| value * scale).collect();
        let bench = Bench::with(&image([24, 18, 1], vec![doubles("h", &values)]));
        let report = bench.smooths("in.vti", &["--persistence", "20%"]);
        let energy = &report["smooth"]["energy"];
        assert!(energy["above_bound"].as_f64().unwrap() >= 0.0 && energy["above_unconstrained"].as_f64().unwrap() >= 0.0, "{scale}");
        let run = bench.run(&["extrema", "in.vti"]);
        assert!(run.stdout.lines().all(|line| line.len() < 120), "{}", run.stdout);
        (report["wanted"]["minima"].as_array().unwrap().len(), energy["above_bound"].as_f64().unwrap())
    };
    let (count, excess) = persistences(1.0);
    for scale in [1e-300, 1e-30, 1e30, 1e300] {
        let (scaled_count, scaled_excess) = persistences(scale);
        assert_eq!(scaled_count, count);
        assert!((scaled_excess - excess).abs() < 1e-4 * excess, "{scale}: {scaled_excess} {excess}");
    }
}

#[test]
fn tiny_coordinates_and_large_offsets() {
    let wanted = |spacing: f64, origin: f64| {
        let dataset = stretched([spacing; 3], [origin, -origin, 0.0], [24, 18, 1], vec![doubles("h", &hills(24, 18))]);
        let report = Bench::with(&dataset).smooths("in.vti", &["--persistence", "20%", "--order", "4"]);
        (report["wanted"]["minima"].as_array().unwrap().len(), report["smooth"]["length"]["of_diagonal"].as_f64().unwrap())
    };
    let (count, length) = wanted(1.0, 0.0);
    for (spacing, origin) in [(1e-12, 0.0), (1e12, 0.0), (1.0, 1e6), (1e-3, 1e6)] {
        let (other_count, other_length) = wanted(spacing, origin);
        assert_eq!(other_count, count);
        assert!((other_length / length - 1.0).abs() < 1e-3, "{spacing} {origin}: {other_length} {length}");
    }
}

#[test]
fn isolated_pixels_are_left_alone() {
    let shown: Vec<f64> = (0..432).map(|i| if i % 24 < 14 || i == 20 || i == 213 { 1.0 } else { 0.0 }).collect();
    let data = hills(24, 18);
    let bench = Bench::with(&image([24, 18, 1], vec![doubles("h", &data), doubles("m", &shown)]));
    let report = bench.smooths("in.vti", &["--array", "h", "--mask", "m", "--persistence", "20%"]);
    assert!(notes(&report).contains("2 unmasked points have no simplex left around them, first point 20"), "{}", notes(&report));
    let written = bench.read("out.vti").point_array("h_smooth").unwrap().to_f64(0);
    assert_eq!((written[20], written[213]), (data[20], data[213]));
}

#[test]
fn duplicate_points_and_repeated_cells() {
    // Two squares side by side that do not share their common points: two parts.
    let mut points = lattice(12, 9);
    points.extend(lattice(12, 9).iter().map(|[x, y, z]| [x + 11.0, *y, *z]));
    let left = squares(12, 9);
    let mut corners = left.clone();
    corners.extend(left.iter().map(|point| point + 108));
    corners.extend_from_slice(&left[..8]);
    let bench = Bench::with(&surface(&points, cells(4, &corners), &(0..216).map(noise).collect::<Vec<_>>()));
    let report = bench.smooths("in.vtp", &["--persistence", "30%"]);
    assert_eq!(report["smooth"]["components"], 2);
    assert!(notes(&report).contains("2 cells repeat simplices of earlier cells, first cell 176 those of cell 0"), "{}", notes(&report));
    let info = bench.run(&["info", "in.vtp"]);
    assert!(info.stdout.contains("9 points lie exactly on an earlier point, first point 108 on point 11"), "{}", info.stdout);
}

#[test]
fn non_manifold_edges_and_repeated_vertices() {
    // Three sheets along one edge line, and a collapsed quad.
    let mut points = lattice(9, 7);
    let mut corners = squares(9, 7);
    for (sheet, lift) in [(0, 1.0), (1, -1.0)] {
        let first = points.len() as i64;
        points.extend((0..9).map(|x| [f64::from(x), 3.0 + 0.2 * lift, lift]));
        for x in 0..8 {
            corners.extend([27 + x, 28 + x, first + x + 1, first + x]);
        }
        assert_eq!(first, 63 + 9 * sheet);
    }
    corners.extend([0, 0, 1, 10]);
    let bench = Bench::with(&surface(&points, cells(4, &corners), &(0..81).map(noise).collect::<Vec<_>>()));
    let report = bench.smooths("in.vtp", &["--persistence", "30%"]);
    assert!(notes(&report).contains("cells are collapsed (a point named twice, or too few points)"), "{}", notes(&report));
    let info = bench.run(&["info", "in.vtp"]);
    assert!(info.stdout.contains("has 4 triangles; kept"), "{}", info.stdout);
}
