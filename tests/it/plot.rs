//! Pictures and charts: what is on them, and that the same input gives the same bytes.

use morsmooth::field::{FieldError, VertexId};
use morsmooth::mesh::SimplicialComplex;
use morsmooth::plot::*;
use std::collections::BTreeMap;

const BLUE: [u8; 3] = [24, 84, 214];
const RED: [u8; 3] = [214, 30, 38];
const GREY: [u8; 3] = [232, 232, 234];

/// `nx x ny` points of unit distance in the plane of `frame`, cells of `hole` left out.
fn grid(nx: u32, ny: u32, frame: [[f64; 3]; 2], hole: impl Fn(u32, u32) -> bool) -> SimplicialComplex {
    let point = |i: u32, j: u32| [0, 1, 2].map(|k| f64::from(i) * frame[0][k] + f64::from(j) * frame[1][k]);
    let points = (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))).map(|(i, j)| point(i, j)).collect();
    let mut triangles = Vec::new();
    for j in 0..ny - 1 {
        for i in 0..nx - 1 {
            if !hole(i, j) {
                let at = |i: u32, j: u32| j * nx + i;
                triangles.extend([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.extend([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    SimplicialComplex::new(2, points, triangles).unwrap()
}

const FLAT: [[f64; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

fn view<'a>(values: &'a [f64], minima: &'a [VertexId], maxima: &'a [VertexId]) -> FieldView<'a> {
    FieldView { title: "title", values, minima, maxima }
}

fn narrow() -> PictureOptions {
    PictureOptions { width: 600, ..Default::default() }
}

fn pixels(picture: &Picture) -> impl Iterator<Item = ([u32; 2], [u8; 3])> {
    let places = (0..picture.height()).flat_map(|y| (0..picture.width()).map(move |x| [x, y]));
    places.map(|[x, y]| ([x, y], picture.pixel(x, y).unwrap()))
}

/// Middle of the pixels of one colour above the legend, and their number.
fn centre(picture: &Picture, colour: [u8; 3]) -> ([f64; 2], usize) {
    let legend = picture.height() - 60;
    let found: Vec<[u32; 2]> = pixels(picture).filter(|&(p, c)| c == colour && p[1] < legend).map(|(p, _)| p).collect();
    let mean = |axis: usize| found.iter().map(|p| f64::from(p[axis])).sum::<f64>() / found.len() as f64;
    ([mean(0), mean(1)], found.len())
}

#[test]
fn colour_maps_run_from_dark_to_light_or_about_grey() {
    let light = |[r, g, b]: [u8; 3]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b);
    let viridis: Vec<f64> = (0..=50).map(|k| light(ColourMap::Viridis.colour(f64::from(k) / 50.0))).collect();
    assert!(viridis.windows(2).all(|pair| pair[0] < pair[1]), "lightness rises everywhere: {viridis:?}");
    let [r, g, b] = ColourMap::Diverging.colour(0.5).map(i32::from);
    assert!(r > 225 && (r - g).abs() < 6 && (g - b).abs() < 6);
    for t in [0.1, 0.3, 0.45] {
        let sides = [t, 1.0 - t].map(|t| light(ColourMap::Diverging.colour(t)));
        assert!((sides[0] - sides[1]).abs() < 25.0, "equally light at equal distance from zero: {t} {sides:?}");
    }
    assert_eq!(ColourMap::Viridis.colour(-3.0), ColourMap::Viridis.colour(0.0));
    assert_eq!(ColourMap::Viridis.colour(7.0), ColourMap::Viridis.colour(1.0));
}

#[test]
fn a_ramp_has_the_colours_of_its_values_and_marks_at_its_ends() {
    let complex = grid(21, 21, FLAT, |_, _| false);
    let values: Vec<f64> = (0..441).map(|v| f64::from(v % 21)).collect();
    let (minima, maxima) = ([VertexId(210)], [VertexId(230)]);
    let picture = field_picture(&complex, &view(&values, &minima, &maxima), &narrow()).unwrap();
    assert_eq!(picture.width(), 600);
    let ([left, row], blue) = centre(&picture, BLUE);
    let ([right, other_row], red) = centre(&picture, RED);
    assert!(blue > 50 && red > 50, "discs of some 60 pixels: {blue}, {red}");
    assert!(left < right && (row - other_row).abs() < 1.0);
    // Off the row of marks and between two isolines, which lie on multiples of 2.
    for (value, tolerance) in [(3.0, 6), (9.0, 6), (17.0, 6)] {
        let x = left + (right - left) * value / 20.0;
        let found = picture.pixel(x.round() as u32, row as u32 + 40).unwrap();
        let wanted = ColourMap::Viridis.colour(value / 20.0);
        let off = (0..3).map(|c| (i32::from(found[c]) - i32::from(wanted[c])).abs()).max().unwrap();
        assert!(off <= tolerance, "value {value}: {found:?}, expected {wanted:?}");
    }
    // An isoline is darker than what is beside it.
    let sum = |x: f64| picture.pixel(x.round() as u32, row as u32 + 40).unwrap().map(u32::from).iter().sum::<u32>();
    let line = left + (right - left) * 10.0 / 20.0;
    let least = (-2..=2).map(|dx| sum(line + f64::from(dx))).min().unwrap();
    assert!(least + 40 < sum(line + 6.0), "{least} {}", sum(line + 6.0));
}

#[test]
fn what_is_masked_out_is_grey() {
    let values: Vec<f64> = (0..441).map(f64::from).collect();
    let shown = |hole: fn(u32, u32) -> bool| {
        let picture = field_picture(&grid(21, 21, FLAT, hole), &view(&values, &[], &[]), &narrow()).unwrap();
        pixels(&picture).filter(|&(_, colour)| colour == GREY).count()
    };
    assert_eq!(shown(|_, _| false), 0, "nor is there a word about it in the legend");
    let area = shown(|i, j| (5..10).contains(&i) && (5..10).contains(&j));
    let whole = 25.0 / 400.0 * (600.0f64 - 48.0 - 124.0 - 16.0).powi(2);
    assert!((area as f64 - whole).abs() < 0.1 * whole, "{area} of about {whole}");
}

#[test]
fn a_plane_is_seen_undistorted_from_any_side() {
    // 3 : 1 in the plane x + y + z = 0 and in each plane of two axes.
    let tilted = [[0.5f64.sqrt(), -(0.5f64.sqrt()), 0.0], [1.0, 1.0, -2.0].map(|c| c / 6.0f64.sqrt())];
    let frames = [FLAT, [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], tilted];
    for frame in frames {
        let complex = grid(31, 11, frame, |_, _| false);
        let values = vec![1.0; 341];
        let corners = [VertexId(0), VertexId(30), VertexId(310), VertexId(340)];
        let picture = field_picture(&complex, &view(&values, &[], &corners), &narrow()).unwrap();
        let legend = picture.height() - 60;
        let red: Vec<[u32; 2]> =
            pixels(&picture).filter(|&(p, c)| c == RED && p[1] < legend).map(|(p, _)| p).collect();
        let extent = |axis: usize| {
            let ends = red.iter().map(|p| p[axis]);
            f64::from(ends.clone().max().unwrap() - ends.min().unwrap()) - 10.0
        };
        assert!((extent(0) / extent(1) - 3.0).abs() < 0.1, "{frame:?}: {} x {}", extent(0), extent(1));
    }
}

/// Vertices, triangles of an octahedron.
fn octahedron() -> (Vec<[f64; 3]>, Vec<u32>) {
    let points = vec![
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 0.9],
        [0.0, 0.0, -0.9],
    ];
    (points, vec![0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5])
}

#[test]
fn a_surface_hides_what_is_behind_it() {
    let (points, triangles) = octahedron();
    let surface = SimplicialComplex::new(2, points.clone(), triangles.clone()).unwrap();
    let values = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
    let (front, back) = ([VertexId(4)], [VertexId(5)]);
    let picture = field_picture(&surface, &view(&values, &back, &front), &narrow()).unwrap();
    assert!(centre(&picture, RED).1 > 50, "the apex towards the eye is marked");
    assert_eq!(centre(&picture, BLUE).1, 0, "the apex behind is not");
    // Four tetrahedra about the axis have the same hull and give the same picture.
    let solid = [0, 2, 4, 5, 2, 1, 4, 5, 1, 3, 4, 5, 3, 0, 4, 5];
    let solid = SimplicialComplex::new(3, points, solid.to_vec()).unwrap();
    let hull = field_picture(&solid, &view(&values, &back, &front), &narrow()).unwrap();
    let differing = pixels(&picture).zip(pixels(&hull)).filter(|(a, b)| a != b).count();
    assert!(differing < 200, "{differing} pixels differ"); // rounding along shared edges
}

#[test]
fn a_series_is_a_chart_of_value_over_place() {
    let points = (0..50).map(|k| [f64::from(k), 0.0, 0.0]).collect();
    let line = SimplicialComplex::new(1, points, (0..49).flat_map(|k| [k, k + 1]).collect()).unwrap();
    let values: Vec<f64> = (0..50).map(|k| (f64::from(k) * 0.2).sin()).collect();
    let (minima, maxima) = ([VertexId(24)], [VertexId(8)]);
    let field = view(&values, &minima, &maxima);
    let one = field_picture(&line, &field, &narrow()).unwrap();
    let (low, high) = (centre(&one, BLUE).0, centre(&one, RED).0);
    assert!(high[0] < low[0] && high[1] < low[1], "the maximum comes first and lies higher");
    let two = before_after(&line, &field, &field, &narrow()).unwrap();
    assert!(two.height() > one.height() + 200, "one above the other");
}

#[test]
fn a_closed_curve_is_unrolled_by_length() {
    let points = (0..40).map(|k| (f64::from(k) * std::f64::consts::TAU / 40.0).sin_cos()).map(|(s, c)| [c, s, 0.0]);
    let ring = SimplicialComplex::new(1, points.collect(), (0..40).flat_map(|k| [k, (k + 1) % 40]).collect()).unwrap();
    let values: Vec<f64> = (0..40).map(f64::from).collect();
    assert!(field_picture(&ring, &view(&values, &[VertexId(0)], &[VertexId(39)]), &narrow()).is_ok());
}

#[test]
fn two_panels_share_one_scale() {
    let complex = grid(21, 21, FLAT, |_, _| false);
    let ramp: Vec<f64> = (0..441).map(|v| f64::from(v % 21)).collect();
    let half: Vec<f64> = ramp.iter().map(|v| 0.5 * v).collect();
    let options = PictureOptions { width: 1200, label: "height [m]".into(), ..Default::default() };
    let (a, b) = (view(&ramp, &[], &[VertexId(230)]), view(&half, &[VertexId(210)], &[]));
    let picture = before_after(&complex, &a, &b, &options).unwrap();
    // Half of the highest value at the right end of the second panel has the colour of the middle.
    let ([right, row], _) = centre(&picture, RED);
    let ([left, _], _) = centre(&picture, BLUE);
    let middle = ColourMap::Viridis.colour(0.5);
    let end = (left + (right - 32.0)).round() as u32 - 6;
    let found = picture.pixel(end, row as u32 + 40).unwrap();
    let off = (0..3).map(|c| (i32::from(found[c]) - i32::from(middle[c])).abs()).max().unwrap();
    assert!(off < 16, "{found:?}, expected about {middle:?}");
}

#[test]
fn pictures_do_not_depend_on_threads_and_are_png() {
    let complex = grid(60, 40, FLAT, |i, j| i * j == 300);
    let values: Vec<f64> = (0..2400).map(|v| (f64::from(v) * 0.37).sin() * 1e6 + 1e9).collect();
    let field = view(&values, &[VertexId(7)], &[VertexId(9)]);
    let draw = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| before_after(&complex, &field, &field, &PictureOptions::default()).unwrap())
    };
    let (one, four) = (draw(1), draw(4));
    assert_eq!(one, four);
    let png = one.to_png().unwrap();
    assert_eq!(png, four.to_png().unwrap());
    let read = image::load_from_memory(&png).unwrap().to_rgb8();
    assert_eq!((read.width(), read.height()), (one.width(), one.height()));
    assert_eq!(read.get_pixel(800, 300).0, one.pixel(800, 300).unwrap());
}

#[test]
fn odd_fields_are_drawn_all_the_same() {
    let complex = grid(5, 4, FLAT, |_, _| false);
    for value in [0.0, -7.5, 1e300, 1e-300, f64::MAX, -f64::MAX] {
        let constant = vec![value; 20];
        field_picture(&complex, &view(&constant, &[], &[]), &narrow()).unwrap();
    }
    let mut spread = vec![f64::MAX; 20];
    spread[3] = -f64::MAX;
    field_picture(&complex, &view(&spread, &[], &[]), &narrow()).unwrap();
    let folded = vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    let flat = SimplicialComplex::new(2, folded, vec![0, 1, 2]).unwrap();
    field_picture(&flat, &view(&[0.0, 1.0, 2.0], &[VertexId(0)], &[]), &narrow()).unwrap();
    let point = SimplicialComplex::new(1, vec![[3.0; 3]; 2], vec![0, 1]).unwrap();
    field_picture(&point, &view(&[0.0, 1.0], &[], &[]), &narrow()).unwrap();
    // Title and label longer than the sheet, and letters that the font lacks.
    let options = PictureOptions { width: 480, label: "m".repeat(500), ..Default::default() };
    let long = FieldView { title: &"\u{03c9} w".repeat(300), ..view(&[0.0; 20], &[], &[]) };
    field_picture(&complex, &long, &options).unwrap();
}

#[test]
fn pictures_refuse_what_they_cannot_show() {
    let complex = grid(3, 3, FLAT, |_, _| false);
    let values = vec![0.5; 9];
    let good = view(&values, &[], &[]);
    let refused = |field: &FieldView<'_>, options: &PictureOptions| field_picture(&complex, field, options).unwrap_err();
    let short = refused(&view(&values[1..], &[], &[]), &narrow());
    assert!(matches!(short, PlotError::Field(FieldError::LengthMismatch { expected: 9, found: 8 })), "{short}");
    let mut holed = values.clone();
    holed[4] = f64::NAN;
    let nan = refused(&view(&holed, &[], &[]), &narrow());
    assert!(matches!(nan, PlotError::Field(FieldError::NonFinite { vertex: VertexId(4), .. })), "{nan}");
    let unknown = refused(&view(&values, &[], &[VertexId(9)]), &narrow());
    assert_eq!(unknown.to_string(), "extremum at vertex 9; expected less than 9");
    for width in [0, 479, 8193] {
        let error = refused(&good, &PictureOptions { width, ..Default::default() });
        assert_eq!(error.to_string(), format!("picture of {width} pixels in width; expected 480 to 8192"));
    }
    let endless = PictureOptions { range: Some([0.0, f64::INFINITY]), ..narrow() };
    assert_eq!(refused(&good, &endless).to_string(), "an end of the colour range is inf; expected a finite number");
    let empty = SimplicialComplex::new(2, vec![[0.0; 3]; 9], vec![]).unwrap();
    let error = field_picture(&empty, &good, &narrow()).unwrap_err();
    assert_eq!(error.to_string(), "the complex has no simplex to draw");
}

fn texts(svg: &str) -> BTreeMap<String, usize> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let mut texts = BTreeMap::new();
    for node in document.descendants().filter(|node| node.has_tag_name("text")) {
        *texts.entry(node.text().unwrap_or("").trim().to_owned()).or_default() += 1;
    }
    texts
}

fn elements(svg: &str, name: &str) -> usize {
    roxmltree::Document::parse(svg).unwrap().descendants().filter(|node| node.has_tag_name(name)).count()
}

#[test]
fn the_persistence_curve_says_what_is_kept() {
    let minima = [0.1, 0.2, 0.2, 3.0, 10.0];
    let maxima = [0.01, 5.0];
    let svg = persistence_curve(&minima, &maxima, Some(0.2), [2, 1], "p & <q> [Pa]").unwrap();
    let texts = texts(&svg);
    for wanted in ["minima: 2 of 5 kept", "maxima: 1 of 2 kept", "threshold 0.2", "persistence: p & <q> [Pa]"] {
        assert!(texts.contains_key(wanted), "no {wanted:?} in {texts:?}");
    }
    let shuffled = [10.0, 0.2, 3.0, 0.1, 0.2];
    assert_eq!(svg, persistence_curve(&shuffled, &maxima, Some(0.2), [2, 1], "p & <q> [Pa]").unwrap());
}

#[test]
fn the_persistence_diagram_shows_every_point_once() {
    let point = |birth, death, kept| DiagramPoint { birth, death, kept };
    let minima = [point(0.0, None, true), point(1.0, Some(1.5), false), point(2.0, Some(8.0), true)];
    let maxima = [point(10.0, None, true), point(3.0, Some(2.5), false)];
    let svg = persistence_diagram(&minima, &maxima, Some(1.0), "").unwrap();
    let texts = texts(&svg);
    for wanted in ["minima kept: 2", "minima removed: 1", "maxima kept: 1", "maxima removed: 1", "triangle: never dies"] {
        assert!(texts.contains_key(wanted), "no {wanted:?} in {texts:?}");
    }
    assert_eq!(elements(&svg, "circle"), 3 + 4, "three pairs, four entries of the legend");
    assert_eq!(svg, persistence_diagram(&minima, &maxima, Some(1.0), "").unwrap());
}

#[test]
fn charts_of_odd_numbers_are_drawn_all_the_same() {
    let cases: [(&[f64], &[f64], f64); 7] = [
        (&[], &[], 0.0),
        (&[0.0, 0.0], &[0.0], 0.0),
        (&[1.0], &[], 0.0),
        (&[1.0, 1.0], &[1.0], 5.0),
        (&[1e-300, 1e300], &[1.0], 1e-12),
        (&[f64::MAX], &[f64::MIN_POSITIVE], 1.0),
        (&[3.0], &[2.0], f64::MAX),
    ];
    for (minima, maxima, threshold) in cases {
        texts(&persistence_curve(minima, maxima, Some(threshold), [0, 0], "").unwrap());
        let points = |values: &[f64]| -> Vec<DiagramPoint> {
            values.iter().map(|&birth| DiagramPoint { birth, death: None, kept: birth > threshold }).collect()
        };
        texts(&persistence_diagram(&points(minima), &points(maxima), Some(threshold), "").unwrap());
    }
}

#[test]
fn charts_refuse_numbers_that_are_none() {
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(persistence_curve(&[bad], &[], None, [0, 0], ""), Err(PlotError::Number { .. })));
        assert!(matches!(persistence_curve(&[], &[], Some(bad), [0, 0], ""), Err(PlotError::Number { .. })));
        assert!(matches!(persistence_diagram(&[], &[], Some(bad), ""), Err(PlotError::Number { .. })));
    }
    let lost = DiagramPoint { birth: 0.0, death: Some(f64::NAN), kept: false };
    let error = persistence_diagram(&[lost], &[], None, "").unwrap_err();
    assert!(error.to_string().starts_with("a death is NaN; expected a finite number"), "{error}");
}

#[test]
fn files_are_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chart.svg");
    write_atomically(&path, b"first, a longer text").unwrap();
    write_atomically(&path, b"second").unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"second");
    let missing = folder.path().join("no such folder").join("chart.svg");
    let error = write_atomically(&missing, b"x").unwrap_err();
    assert!(error.to_string().contains("no such folder"), "{error}");
    // A folder is in the way: nothing may be left beside it.
    let taken = folder.path().join("taken");
    std::fs::create_dir(&taken).unwrap();
    std::fs::write(taken.join("inside"), b"x").unwrap();
    assert!(matches!(write_atomically(&taken, b"x"), Err(PlotError::Write { .. })));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}
