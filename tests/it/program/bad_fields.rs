//! Fields and meshes that admit no answer: refused with the place, in the numbers of the file.

use morsmooth::io::{ArrayData, DataArray, MaskSources, domain, mask};

use super::Bench;
use super::fields::{cells, doubles, hills, hilly, image, lattice, stretched, surface, unstructured};

fn refuses(bench: &Bench, input: &str, more: &[&str], words: &[&str]) {
    let output = input.replace("in", "out");
    bench.refuses(&[&["smooth", input, &output, "-q"], more].concat(), words);
}

const TWO: [&str; 2] = ["--extrema", "2"];

#[test]
fn a_constant_field() {
    let bench = Bench::with(&image([8, 6, 1], vec![doubles("h", &[2.5; 48])]));
    refuses(&bench, "in.vti", &TWO, &["in.vti: the field is constant (value 2.5) on the component of vertex 0 (48 vertices)", "expected at least two"]);
    let two_parts = surface(
        &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [5.0, 1.0, 0.0]],
        cells(3, &[0, 1, 2, 3, 4, 5]),
        &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0],
    );
    refuses(&Bench::with(&two_parts), "in.vtp", &["--persistence", "1%"], &["in.vtp: the field is constant (value 1.0) on the component of vertex 0"]);
}

#[test]
fn holes_everywhere() {
    let bench = Bench::with(&image([8, 6, 1], vec![doubles("h", &[f64::NAN; 48])]));
    refuses(&bench, "in.vti", &TWO, &["in.vti: the domain is empty: 48 points, 35 cells, of which the mask removes 48 points"]);
    let bench = Bench::with(&image([8, 6, 1], vec![doubles("h", &hills(8, 6)), doubles("m", &[0.0; 48])]));
    refuses(&bench, "in.vti", &["--extrema", "2", "--mask", "m"], &["in.vti: the domain is empty", "removes 48 points and 0 cells"]);
    // Nothing but isolated pixels.
    let lonely: Vec<f64> = (0..48).map(|i| f64::from(u8::from((i % 8) % 2 == 0 && (i / 8) % 2 == 0))).collect();
    let bench = Bench::with(&image([8, 6, 1], vec![doubles("h", &hills(8, 6)), doubles("m", &lonely)]));
    refuses(&bench, "in.vti", &["--extrema", "2", "--mask", "m"], &["in.vti: the domain is empty"]);
}

#[test]
fn an_infinite_value() {
    for value in [f64::INFINITY, f64::NEG_INFINITY] {
        let mut data = hills(24, 18);
        data[77] = value;
        let bench = Bench::with(&image([24, 18, 1], vec![doubles("h", &data)]));
        let found = format!("in.vti: array h is {value} at point 77; expected a finite number");
        refuses(&bench, "in.vti", &TWO, &[&found, "hint: NaN marks a hole"]);
        bench.refuses(&["extrema", "in.vti", "-q"], &[&found]);
        bench.refuses(&["check", "in.vti", "-q"], &[&found]);
    }
}

#[test]
fn one_vertex() {
    let bench = Bench::with(&image([1, 1, 1], vec![doubles("h", &[1.0])]));
    refuses(&bench, "in.vti", &TWO, &["in.vti: the domain is empty: 1 points, 1 cells"]);
    let bench = Bench::with(&unstructured(&[[0.0; 3]], cells(1, &[0]), 1, &[1.0]));
    refuses(&bench, "in.vtu", &TWO, &["in.vtu: the domain is empty: 1 points, 1 cells"]);
}

#[test]
fn a_triangle_without_area() {
    let mut points = lattice(3, 3);
    points.push([1.0, 0.0, 0.0]);
    let triangles = cells(3, &[0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4, 3, 4, 7, 0, 9, 1]);
    let values: Vec<f64> = (0..10).map(|i| f64::from(i * i % 7)).collect();
    let bench = Bench::with(&surface(&points, triangles, &values));
    refuses(&bench, "in.vtp", &TWO, &["in.vtp: cell 5 holds a simplex of zero measure on points [0, 9, 1]", "mask the cell"]);
    // Numbers of the file also behind a point that is in no cell.
    let line = [[9.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    let bench = Bench::with(&unstructured(&line, cells(2, &[1, 2, 2, 3]), 3, &[0.0, 1.0, 2.0, 3.0]));
    refuses(&bench, "in.vtu", &TWO, &["in.vtu: cell 1 holds a simplex of zero measure on points [2, 3]"]);
}

#[test]
fn coordinates_that_are_none_or_leave_the_range() {
    let mut points = lattice(3, 3);
    points[4] = [f64::NAN, 1.0, 0.0];
    let corners = super::fields::squares(3, 3);
    let values: Vec<f64> = (0..9).map(f64::from).collect();
    let bench = Bench::with(&surface(&points, cells(4, &corners), &values));
    refuses(&bench, "in.vtp", &TWO, &["in.vtp: point 4 lies at [NaN, 1.0, 0.0]; expected finite coordinates"]);
    for spacing in [1e100, 1e-100, 1e170, 1e-170, 1e300, 1e-300] {
        let dataset = stretched([spacing; 3], [0.0; 3], [24, 18, 1], vec![doubles("h", &hills(24, 18))]);
        let bench = Bench::with(&dataset);
        refuses(&bench, "in.vti", &TWO, &["in.vti: ", "expected"]);
    }
    let flat = Bench::with(&stretched([1.0, 0.0, 1.0], [0.0; 3], [24, 18, 1], vec![doubles("h", &hills(24, 18))]));
    refuses(&flat, "in.vti", &TWO, &["in.vti: cell 0 holds a simplex of zero measure on points [0, 1, 25]"]);
}

#[test]
fn cells_that_are_not_linear() {
    let points: Vec<[f64; 3]> = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]].map(|[x, y]| [x, y, 0.0]).to_vec();
    let bench = Bench::with(&unstructured(&points, cells(6, &[0, 1, 2, 3, 4, 5]), 22, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]));
    refuses(&bench, "in.vtu", &TWO, &["in.vtu: found cell 0 of VTK type 22 (quadratic triangle)", "expected linear cells", "linearise"]);
}

#[test]
fn values_without_room_between_them() {
    // Steps of one unit in the last place: long monotone paths have no numbers left.
    let steps: Vec<f64> = (0..1200).map(|i| ((i % 40) as f64 / 6.0).sin() + ((i / 40) as f64 / 5.0).cos()).map(|v| (2.0 * v).round()).collect();
    let close = |value: f64| 1.0 + value * f64::from(f32::EPSILON);
    let single: Vec<f32> = steps.iter().map(|&value| close(value) as f32).collect();
    let array = DataArray::new("h", 1, ArrayData::F32(single));
    let bench = Bench::with(&image([40, 30, 1], vec![array]));
    refuses(&bench, "in.vti", &TWO, &["in.vti: no strictly monotone field fits into 32-bit numbers at vertex", "convert the array to 64 bits"]);
    // The same values in 64 bits have room.
    let wide: Vec<f64> = steps.iter().map(|&value| close(value)).collect();
    Bench::with(&image([40, 30, 1], vec![doubles("h", &wide)])).smooths("in.vti", &TWO);
    let double: Vec<f64> = steps.iter().map(|&value| 1.0 + value * f64::EPSILON).collect();
    let bench = Bench::with(&image([40, 30, 1], vec![doubles("h", &double)]));
    refuses(&bench, "in.vti", &TWO, &["in.vti: no strictly monotone field fits into 64-bit numbers at vertex", "raise the threshold"]);
    // Values that are free have room again.
    bench.smooths("in.vti", &["--extrema", "2", "--values", "free"]);
}

#[test]
fn values_that_span_more_than_numbers_can() {
    let data: Vec<f64> = hills(24, 18).iter().map(|value| value.signum() * 1.7e308 * value.abs().min(1.0)).collect();
    let bench = Bench::with(&image([24, 18, 1], vec![doubles("h", &data)]));
    refuses(&bench, "in.vti", &TWO, &["in.vti: the values range from -1", "expected a range below", "rescale the values"]);
}

#[test]
fn a_smooth_field_without_anything_left() {
    let bench = Bench::with(&hilly(24, 18));
    let more = ["--extrema", "2", "--select", "smooth", "--length-abs", "3000000", "--order", "3"];
    refuses(&bench, "in.vti", &more, &["in.vti: ", "expected", "smoothing length"]);
}

#[test]
fn a_part_that_hangs_on_one_vertex_needs_an_extremum() {
    let (dataset, corner) = hanging();
    let bench = Bench::with(&dataset);
    // The wanted extrema lie in the large part; the small one hangs on one vertex and has none.
    let values = dataset.point_array("h").unwrap().to_f64(0);
    let sources = MaskSources { array: Some("m".into()), ..MaskSources::default() };
    let domain = domain(&dataset, &mask(&dataset, &sources).unwrap()).unwrap();
    let found = morsmooth::audit::extrema(&domain.complex, &domain.restrict(&values)).unwrap();
    let large = |points: Vec<u32>| -> Vec<u32> { points.into_iter().filter(|&point| !corner(point as usize)).collect() };
    let (minima, maxima) = (large(domain.points_of(&found.minima)), large(domain.points_of(&found.maxima)));
    let keep: Vec<String> = [minima, maxima].concat().iter().map(ToString::to_string).collect();
    bench.text("keep.txt", keep.join("\n"));
    let more = ["--array", "h", "--mask", "m", "--keep", "keep.txt"];
    refuses(&bench, "in.vti", &more, &["in.vti: no field has exactly the wanted extrema", "touch the rest at one vertex", "is point"]);
    // A threshold is completed instead, and the report says so.
    let report = bench.smooths("in.vti", &["--array", "h", "--mask", "m", "--extrema", "2"]);
    assert_eq!(report["smooth"]["unavoidable"], 1);
}

/// A grid of which two parts touch at a corner only, and the test for points of the smaller part without the shared one.
fn hanging() -> (morsmooth::io::DataSet, impl Fn(usize) -> bool) {
    // Across the diagonal of the squares: along it, a triangle on either side would join the parts.
    let (width, height, middle) = (20usize, 16usize, [13usize, 5usize]);
    let upper = move |i: usize| i % width <= middle[0] && i / width >= middle[1];
    let lower = move |i: usize| i % width >= middle[0] && i / width <= middle[1];
    let shown: Vec<f64> = (0..width * height).map(|i| f64::from(u8::from(upper(i) || lower(i)))).collect();
    // The greatest extrema lie in the large part.
    let data: Vec<f64> = hills(width, height).iter().enumerate().map(|(i, value)| if lower(i) { 0.3 * value } else { *value }).collect();
    let dataset = image([width, height, 1], vec![doubles("h", &data), doubles("m", &shown)]);
    (dataset, move |i: usize| lower(i) && !upper(i))
}
