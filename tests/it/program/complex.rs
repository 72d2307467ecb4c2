//! `complex`: files in TTK's layout.

use std::collections::BTreeSet;

use morsmooth::io::{ArrayData, DataArray, DataSet, Geometry, Role, ValueType};

use super::Bench;
use super::fields::{cells, doubles, hilly, hills, image, lattice, noise, plain_extrema, surface, unstructured};

/// The table of TTK's arrays: name and type.
const CRITICAL: [(&str, ValueType); 5] = [
    ("CellDimension", ValueType::I8),
    ("CellId", ValueType::I32),
    ("IsOnBoundary", ValueType::I8),
    ("ttkVertexScalarField", ValueType::I32),
    ("ManifoldSize", ValueType::I32),
];
const LINE_POINTS: [(&str, ValueType); 3] =
    [("ttkMaskScalarField", ValueType::I8), ("CellDimension", ValueType::I8), ("CellId", ValueType::I32)];
const LINE_CELLS: [(&str, ValueType); 8] = [
    ("SourceId", ValueType::I32),
    ("DestinationId", ValueType::I32),
    ("SeparatrixId", ValueType::I32),
    ("SeparatrixType", ValueType::I8),
    ("SeparatrixFunctionMaximum", ValueType::F64),
    ("SeparatrixFunctionMinimum", ValueType::F64),
    ("SeparatrixFunctionDifference", ValueType::F64),
    ("NumberOfCriticalPointsOnBoundary", ValueType::I8),
];
const SEGMENTS: [&str; 3] = ["AscendingManifold", "DescendingManifold", "MorseSmaleManifold"];

fn numbers(array: Option<&DataArray>) -> Vec<i64> {
    array.unwrap().to_f64(0).iter().map(|&value| value as i64).collect()
}

fn has_types(arrays: &[DataArray], table: &[(&str, ValueType)]) {
    for (name, wanted) in table {
        let array = arrays.iter().find(|array| array.name == *name).unwrap_or_else(|| panic!("no array {name}"));
        assert_eq!((array.components, array.data.value_type(), array.id_type), (1, *wanted, false), "{name}");
    }
}

struct Files {
    critical: DataSet,
    lines: DataSet,
    segmentation: DataSet,
}

/// Reads the files back and asserts types and meanings; counts of critical points of each dimension.
fn check(bench: &Bench, input: &str, array: &str) -> (Files, [usize; 4]) {
    let (stem, extension) = input.split_once('.').unwrap();
    let files = Files {
        critical: bench.read(&format!("out/{stem}CriticalPoints.vtp")),
        lines: bench.read(&format!("out/{stem}1Separatrices.vtp")),
        segmentation: bench.read(&format!("out/{stem}Segmentation.{extension}")),
    };
    let original = bench.read(input);
    let values = original.point_array(array).unwrap().to_f64(0);
    let Files { critical, lines, segmentation } = &files;

    // Critical points.
    has_types(&critical.point_data.arrays, &CRITICAL);
    let names: Vec<&str> = critical.point_data.arrays.iter().map(|array| array.name.as_str()).collect();
    assert_eq!(names, ["CellDimension", "CellId", array, "IsOnBoundary", "ttkVertexScalarField", "ManifoldSize"]);
    assert_eq!(critical.point_data.active(Role::Scalars), Some("CellDimension"));
    let own = critical.point_array(array).unwrap();
    assert_eq!(own.data.value_type(), original.point_array(array).unwrap().data.value_type(), "the field keeps its type");
    let Geometry::PolyData { points, verts, lines: no_lines, polys, strips } = &critical.geometry else { panic!("no poly data") };
    assert_eq!(points.data.value_type(), ValueType::F32);
    assert_eq!((verts.len(), no_lines.len() + polys.len() + strips.len()), (critical.point_count(), 0));
    let [dimensions, ids, vertices, sizes] =
        ["CellDimension", "CellId", "ttkVertexScalarField", "ManifoldSize"].map(|name| numbers(critical.point_array(name)));
    assert!(dimensions.is_sorted());
    let value_at = own.to_f64(0);
    assert!(vertices.iter().zip(&value_at).all(|(&vertex, &value)| values[vertex as usize] == value));
    let top = *dimensions.last().unwrap();
    let counts = [0i64, 1, 2, 3].map(|k| dimensions.iter().filter(|&&d| d == k).count());
    let named: BTreeSet<(i64, i64)> = dimensions.iter().copied().zip(ids.iter().copied()).collect();
    assert_eq!(named.len(), ids.len());
    let positions = points.to_f64(0);
    assert!(positions.iter().all(|x| x.is_finite()));
    // Minima lie on their points, and their cell is the point.
    let at = original.points_f64();
    for place in (0..ids.len()).filter(|&place| dimensions[place] == 0) {
        assert_eq!(ids[place], vertices[place]);
        assert_eq!(positions[place], f64::from(at[ids[place] as usize][0] as f32));
    }

    // Separatrices.
    has_types(&lines.point_data.arrays, &LINE_POINTS);
    has_types(&lines.cell_data.arrays, &LINE_CELLS);
    assert_eq!((lines.point_data.arrays.len(), lines.cell_data.arrays.len()), (3, 8));
    assert_eq!(lines.cell_data.active(Role::Scalars), Some("SeparatrixType"));
    let Geometry::PolyData { points, lines: segments, verts, .. } = &lines.geometry else { panic!("no poly data") };
    assert_eq!((points.data.value_type(), verts.len()), (ValueType::F32, 0));
    let mask = numbers(lines.point_array("ttkMaskScalarField"));
    let on_line = numbers(lines.point_array("CellDimension")).into_iter().zip(numbers(lines.point_array("CellId")));
    let on_line: Vec<(i64, i64)> = on_line.collect();
    let cell = |name: &str| numbers(lines.cell_array(name));
    let [source, destination, number, kind] =
        ["SourceId", "DestinationId", "SeparatrixId", "SeparatrixType"].map(cell);
    let [high, low, difference] = ["Maximum", "Minimum", "Difference"]
        .map(|name| lines.cell_array(&format!("SeparatrixFunction{name}")).unwrap().to_f64(0));
    let mut used = 0;
    for (step, ends) in segments.iter().enumerate() {
        assert_eq!(ends.len(), 2);
        let [begin, end] = [ends[0] as usize, ends[1] as usize];
        assert_eq!(end, begin + 1);
        let is_first = step == 0 || number[step - 1] != number[step];
        let is_last = step + 1 == number.len() || number[step + 1] != number[step];
        assert_eq!((mask[begin] == 0, mask[end] == 0), (is_first, is_last));
        assert_eq!(begin, if is_first { used } else { used - 1 }, "points are shared within a separatrix only");
        used = end + 1;
        if is_first {
            assert_eq!(on_line[begin].1, source[step]);
            assert!(named.contains(&on_line[begin]));
        }
        if is_last {
            assert_eq!(on_line[end].1, destination[step]);
            assert!(named.contains(&on_line[end]));
            let expected = match on_line[end].0 {
                0 => 0,
                k if k == top => top - 1,
                _ => 1,
            };
            assert_eq!(kind[step], expected);
        }
        assert!(low[step] <= high[step] && difference[step] == high[step] - low[step]);
    }
    assert_eq!(used, lines.point_count());

    // Segmentation.
    assert_eq!(segmentation.geometry, original.geometry);
    assert_eq!(segmentation.point_data.arrays.len(), original.point_data.arrays.len() + 3);
    has_types(&segmentation.point_data.arrays, &SEGMENTS.map(|name| (name, ValueType::I32)));
    let [up, down, both] = SEGMENTS.map(|name| numbers(segmentation.point_array(name)));
    let first = ids.len() - counts[top as usize];
    for (labels, first) in [(&down, 0), (&up, first)] {
        let mut found = vec![0; counts[if first == 0 { 0 } else { top as usize }]];
        labels.iter().filter(|&&label| label >= 0).for_each(|&label| found[label as usize] += 1);
        assert_eq!(found, sizes[first..first + found.len()]);
        for (place, _) in found.iter().enumerate().filter(|(_, size)| **size > 0) {
            assert_eq!(labels[vertices[first + place] as usize], place as i64, "an extremum is in its own region");
        }
    }
    assert!(up.iter().zip(&down).zip(&both).all(|((&up, &down), &both)| (both < 0) == (up < 0 || down < 0)));
    (files, counts)
}

#[test]
fn a_noisy_image_before_and_after_simplification() {
    let bench = Bench::with(&hilly(24, 18));
    let dataset = bench.read("in.vti");
    let (minima, maxima) = plain_extrema(&dataset, &dataset.point_array("h").unwrap().to_f64(0), None, None);
    let run = bench.run(&["complex", "in.vti", "out", "--report", "r.json", "--plots", "pictures"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let (_, counts) = check(&bench, "in.vti", "h");
    assert_eq!((counts[0], counts[2]), (minima.len(), maxima.len()), "as the extrema that are counted elsewhere");
    assert!(bench.path("pictures/complex.png").exists());
    let report = bench.json("r.json");
    let [minima, saddles, maxima, rim] = ["minima", "saddles", "maxima", "rim"].map(|name| match name {
        "rim" => report["maxima_on_the_boundary_only"].as_i64().unwrap(),
        name => report["critical_points"][name].as_i64().unwrap(),
    });
    assert_eq!(minima - saddles + (maxima - rim), 1, "Euler characteristic of a disc");
    for words in ["critical cells", "kept", "separatrices", "segments", "out/inSegmentation.vti"] {
        assert!(run.stdout.contains(words), "no {words:?} in {}", run.stdout);
    }

    let extrema = bench.run(&["extrema", "in.vti"]);
    let line = extrema.stdout.lines().find(|line| line.contains("> 20 %")).unwrap();
    let kept: Vec<usize> = line.split_whitespace().rev().take(2).map(|word| word.parse().unwrap()).collect();
    assert_eq!(bench.run(&["complex", "in.vti", "out", "--persistence", "20%", "-q"]).code, 0);
    let (_, counts) = check(&bench, "in.vti", "h");
    assert_eq!((counts[2], counts[0]), (kept[0], kept[1]));

    assert_eq!(bench.run(&["complex", "in.vti", "out", "--extrema", "7", "-q"]).code, 0);
    let (_, counts) = check(&bench, "in.vti", "h");
    assert_eq!(counts[0] + counts[2], 7);
}

#[test]
fn masked_points_have_no_label() {
    let mut dataset = hilly(20, 14);
    let mask: Vec<u8> = (0..280).map(|k| u8::from(!(8..12).contains(&(k % 20)))).collect();
    dataset.set_point_array(DataArray::new("m", 1, ArrayData::U8(mask.clone())));
    let bench = Bench::with(&dataset);
    let run = bench.run(&["complex", "in.vti", "out", "--array", "h", "--mask", "m", "--persistence", "10%"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let (files, _) = check(&bench, "in.vti", "h");
    for name in SEGMENTS {
        let labels = numbers(files.segmentation.point_array(name));
        assert!(labels.iter().zip(&mask).all(|(&label, &kept)| (label >= 0) == (kept == 1)), "{name}");
    }
}

#[test]
fn every_kind_of_domain() {
    // A polyline, a surface of squares, an image of 32-bit values, a block of tetrahedra, a volume.
    let line: Vec<i64> = (0..30).flat_map(|k| [k, k + 1]).collect();
    let along: Vec<[f64; 3]> = (0..31).map(|k| [f64::from(k), 0.0, 0.0]).collect();
    let bumps: Vec<f64> = (0..31).map(|k| (k as f64 / 3.0).sin() + 0.2 * noise(k)).collect();
    let squares: Vec<i64> = (0..8).flat_map(|y| (0..11).flat_map(move |x| [0, 1, 13, 12].map(|k| y * 12 + x + k))).collect();
    let volume: Vec<f64> = (0..6 * 5 * 7).map(|k| (k as f64 / 7.0).sin() + noise(k)).collect();
    let floats = DataArray::new("h", 1, ArrayData::F32(volume.iter().map(|&value| value as f32).collect()));
    let tetrahedra: Vec<i64> = vec![0, 1, 2, 4, 1, 2, 4, 5, 2, 4, 5, 6, 1, 2, 3, 5, 2, 3, 5, 7, 2, 5, 6, 7];
    let corners: Vec<[f64; 3]> = (0..8).map(|k| [f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)]).collect();
    for (name, dataset, dimension) in [
        ("line", unstructured(&along, cells(2, &line), 3, &bumps), 1),
        ("surface", surface(&lattice(12, 9), cells(4, &squares), &hills(12, 9)), 2),
        ("volume", image([6, 5, 7], vec![floats]), 3),
        ("tetrahedra", unstructured(&corners, cells(4, &tetrahedra), 10, &volume[..8]), 3),
    ] {
        let bench = Bench::with(&dataset);
        let input = format!("in.{}", dataset.geometry.extension());
        for level in [&[][..], &["--persistence", "5%"], &["--persistence-abs", "0.3"]] {
            let run = bench.run(&[&["complex", &input, "out", "-q", "--report", "r.json"], level].concat());
            assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{name}");
            let (_, counts) = check(&bench, &input, "h");
            assert!(counts[0] > 0 && counts[dimension] > 0 && counts[dimension + 1..].iter().all(|&count| count == 0), "{name}");
        }
    }
}

#[test]
fn top_cells_that_are_cells_of_the_file_keep_their_number() {
    // Triangles listed in an order that is not that of their points.
    let mut triangles: Vec<[i64; 3]> = (0..3)
        .flat_map(|y| (0..4).flat_map(move |x| [[0, 1, 6], [0, 6, 5]].map(|t: [i64; 3]| t.map(|k| y * 5 + x + k))))
        .collect();
    triangles.reverse();
    let values: Vec<f64> = (0..20).map(|k| if k == 7 { 9.0 } else { noise(k) }).collect();
    let bench = Bench::with(&surface(&lattice(5, 4), cells(3, triangles.as_flattened()), &values));
    assert_eq!(bench.run(&["complex", "in.vtp", "out", "-q"]).code, 0);
    let (files, _) = check(&bench, "in.vtp", "h");
    let column = |name: &str| numbers(files.critical.point_array(name));
    let (dimensions, ids, vertices) = (column("CellDimension"), column("CellId"), column("ttkVertexScalarField"));
    let mut seen = 0;
    for place in (0..ids.len()).filter(|&place| dimensions[place] == 2) {
        assert!(triangles[ids[place] as usize].contains(&vertices[place]));
        seen += 1;
    }
    assert!(seen > 0);
}

#[test]
fn plateaus_are_no_trouble() {
    let flat: Vec<f64> = (0..300).map(|k| if (k / 7) % 3 == 0 { 1.0 } else { 0.0 }).collect();
    let bench = Bench::with(&image([20, 15, 1], vec![doubles("h", &flat)]));
    assert_eq!(bench.run(&["complex", "in.vti", "out", "-q"]).code, 0);
    check(&bench, "in.vti", "h");
    assert_eq!(bench.run(&["complex", "in.vti", "out", "--persistence", "0", "-q"]).code, 0);
    let (_, counts) = check(&bench, "in.vti", "h");
    assert!(counts[0] < 60, "{counts:?}");
}

#[test]
fn bad_wishes_are_refused() {
    let bench = Bench::with(&hilly(12, 9));
    bench.text("file", "x");
    bench.refuses(&["complex", "in.vti", "out", "--array", "nothing"], &["no point array 'nothing'"]);
    bench.refuses(&["complex", "in.vti", "file"], &["file is a file; expected a directory"]);
    bench.refuses(&["complex", "in.vti", "out", "--persistence-abs", "-1"], &["threshold -1"]);
    bench.refuses(&["complex", "in.vti", "out", "--extrema", "100000"], &["100000 extrema asked for"]);
    bench.refuses(&["complex", "in.vti", "out", "--threads", "0"], &["expected at least 1"]);
    bench.refuses(&["complex", "in.vti", "out", "--plots", "file"], &["file is a file; expected a directory"]);
    let twice = bench.run(&["complex", "in.vti", "out", "--extrema", "4", "--persistence", "4%"]);
    assert_eq!(twice.code, 2);
    let reported = bench.run(&["complex", "in.vti", "out", "--report", "in.vti"]);
    assert!(reported.code == 2 && reported.stderr.contains("would overwrite"), "{}", reported.stderr);
    // A folder in the place of one file: nothing else is written either.
    std::fs::create_dir_all(bench.path("out/inSegmentation.vti")).unwrap();
    let blocked = bench.run(&["complex", "in.vti", "out"]);
    assert_eq!(blocked.code, 2);
    assert_eq!(std::fs::read_dir(bench.path("out")).unwrap().count(), 1);
}

#[test]
fn the_input_is_never_overwritten() {
    let bench = Bench::new();
    let mut dataset = hilly(12, 9);
    dataset.title = String::new();
    bench.put("xSegmentation.vti", &dataset);
    // Stem and ending give the input's own name only by a link.
    std::os::unix::fs::symlink(bench.path("xSegmentation.vti"), bench.path("x.vti")).unwrap();
    bench.refuses(&["complex", "x.vti", "."], &["would overwrite the input"]);
}

#[test]
fn threads_change_no_bit() {
    let bench = Bench::with(&hilly(40, 30));
    let bytes = |threads: &str| {
        let run = bench.run(&["complex", "in.vti", "out", "--persistence", "5%", "--threads", threads, "-q"]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        ["inCriticalPoints.vtp", "in1Separatrices.vtp", "inSegmentation.vti"]
            .map(|name| std::fs::read(bench.path("out").join(name)).unwrap())
    };
    assert!(bytes("1") == bytes("2"));
}
