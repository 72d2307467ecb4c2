//! `morsmooth persistence`: the diagram in TTK's layout, the curve, and thresholds that do what they say.

use morsmooth::io::{ArrayData, DataSet, Geometry, ValueType};

use super::Bench;
use super::fields::{doubles, hills, hilly, image, lattice, noise, plain_extrema};
use crate::support::dataset;

/// Name, type, components of every array, in order.
fn table(arrays: &[morsmooth::io::DataArray]) -> Vec<(&str, ValueType, usize)> {
    arrays.iter().map(|array| (array.name.as_str(), array.data.value_type(), array.components)).collect()
}

fn integers(array: &ArrayData) -> &[i32] {
    let ArrayData::I32(values) = array else { panic!("Int32") };
    values
}

fn points(dataset: &DataSet) -> (&[f32], usize) {
    let Geometry::UnstructuredGrid { points, cells, types, polyhedra: None } = &dataset.geometry else { panic!("an unstructured grid") };
    let ArrayData::F32(places) = &points.data else { panic!("Float32 points") };
    assert!(types.iter().all(|&kind| kind == 3), "lines only");
    (places, cells.len())
}

#[test]
fn the_diagram_has_ttk_s_arrays() {
    let values = hills(30, 24);
    let bench = Bench::with(&hilly(30, 24));
    let run = bench.run(&["persistence", "in.vti", "d.vtu", "--report", "r.json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let diagram = bench.read("d.vtu");
    let scalar = ValueType::F64;
    assert_eq!(
        table(&diagram.point_data.arrays),
        [("ttkVertexScalarField", ValueType::I32, 1), ("CriticalType", ValueType::I32, 1), ("Coordinates", ValueType::F32, 3)]
    );
    assert_eq!(
        table(&diagram.cell_data.arrays),
        [
            ("PairIdentifier", ValueType::I32, 1), ("PairType", ValueType::I32, 1), ("Persistence", scalar, 1),
            ("Birth", scalar, 1), ("IsFinite", ValueType::U8, 1),
        ]
    );
    let (places, cells) = points(&diagram);
    let pairs = cells - 1;
    assert_eq!(places.len(), 6 * pairs);
    let ids = integers(&diagram.point_array("ttkVertexScalarField").unwrap().data);
    let kinds = integers(&diagram.point_array("CriticalType").unwrap().data);
    let identifiers = integers(&diagram.cell_array("PairIdentifier").unwrap().data);
    let types = integers(&diagram.cell_array("PairType").unwrap().data);
    let ArrayData::U8(finite) = &diagram.cell_array("IsFinite").unwrap().data else { panic!("UInt8") };
    let (persistence, birth) = (diagram.cell_array("Persistence").unwrap().to_f64(0), diagram.cell_array("Birth").unwrap().to_f64(0));
    assert_eq!((identifiers[0], types[0], finite[0], kinds[0], kinds[1]), (0, 0, 0, 0, 3), "the global pair");
    assert_eq!((identifiers[pairs], types[pairs], finite[pairs], birth[pairs]), (-1, -1, 0, 0.0), "the diagonal");
    assert_eq!(persistence[pairs], 2.0 * persistence[0]);
    for pair in 0..pairs {
        let (low, high) = (ids[2 * pair] as usize, ids[2 * pair + 1] as usize);
        assert_eq!((birth[pair], persistence[pair]), (values[low], values[high] - values[low]));
        assert_eq!(places[6 * pair..6 * pair + 6], [values[low], values[low], 0.0, values[low], values[high], 0.0].map(|x| x as f32));
        let expected = match (types[pair], finite[pair]) {
            (0, 1) => [0, 1],
            (1, 1) => [2, 3],
            _ => [0, 3],
        };
        assert_eq!(kinds[2 * pair..2 * pair + 2], expected);
        assert!(pair == 0 || (birth[pair], ids[2 * pair]) >= (birth[pair - 1], 0), "pairs by birth");
    }
    let Geometry::UnstructuredGrid { cells, .. } = &diagram.geometry else { panic!("an unstructured grid") };
    assert_eq!(cells.cell(pairs), [0, 2 * (pairs as i64 - 1)]);
    // Every minimum is born once; the maxima that die are those off the boundary.
    let (minima, maxima) = plain_extrema(&bench.read("in.vti"), &values, None, None);
    assert_eq!(types[..pairs].iter().filter(|&&kind| kind == 0).count(), minima.len());
    let is_inner = |&point: &usize| point % 30 > 0 && point % 30 < 29 && point / 30 > 0 && point / 30 < 23;
    let inner = maxima.iter().filter(|point| is_inner(point)).count();
    assert_eq!(types[..pairs].iter().filter(|&&kind| kind == 1).count(), inner);
    let report = bench.json("r.json");
    assert_eq!((&report["minima"], &report["maxima"]), (&minima.len().into(), &maxima.len().into()));
    assert_eq!(report["sublevel_diagram"]["pairs"][1], inner);
}

#[test]
fn embedded_points_lie_in_the_domain() {
    let bench = Bench::with(&hilly(20, 15));
    assert_eq!(bench.run(&["persistence", "in.vti", "d.vtu", "--embed", "-q"]).code, 0);
    let diagram = bench.read("d.vtu");
    assert!(diagram.point_array("Coordinates").is_none());
    let (places, cells) = points(&diagram);
    let ids = integers(&diagram.point_array("ttkVertexScalarField").unwrap().data);
    assert_eq!(ids.len(), 2 * cells, "no diagonal");
    let domain = lattice(20, 15);
    for (id, place) in ids.iter().zip(places.chunks(3)) {
        assert_eq!(place, domain[*id as usize].map(|x| x as f32));
    }
}

#[test]
fn the_scalars_keep_their_type() {
    let bytes: Vec<u8> = hills(20, 15).iter().map(|value| (90.0 * (value + 1.4)) as u8).collect();
    let signed: Vec<i8> = hills(20, 15).iter().map(|value| (95.0 * value) as i8).collect();
    let singles: Vec<f32> = hills(20, 15).iter().map(|&value| value as f32).collect();
    for (data, expected) in [
        (ArrayData::U8(bytes), ValueType::U8),
        // From -123 to 124 is more than a signed byte holds.
        (ArrayData::I8(signed), ValueType::F64),
        (ArrayData::F32(singles), ValueType::F32),
    ] {
        let bench = Bench::with(&image([20, 15, 1], vec![morsmooth::io::DataArray::new("h", 1, data)]));
        assert_eq!(bench.run(&["persistence", "in.vti", "d.vtu", "-q"]).code, 0);
        for name in ["Persistence", "Birth"] {
            assert_eq!(bench.read("d.vtu").cell_array(name).unwrap().data.value_type(), expected);
        }
    }
}

#[test]
fn curves_and_volumes() {
    // A curve: deaths are maxima, type 0 only. A volume: types 0, 1, 2.
    let bench = Bench::new();
    std::fs::copy(dataset("co2.vtp"), bench.path("in.vtp")).unwrap();
    assert_eq!(bench.run(&["persistence", "in.vtp", "d.vtu", "--array", "co2", "-q"]).code, 0);
    let diagram = bench.read("d.vtu");
    let kinds = integers(&diagram.point_array("CriticalType").unwrap().data);
    assert!(kinds.chunks(2).all(|pair| pair == [0, 3]));
    let values: Vec<f64> = (0..9 * 8 * 7).map(noise).collect();
    let bench = Bench::with(&image([9, 8, 7], vec![doubles("h", &values)]));
    assert_eq!(bench.run(&["persistence", "in.vti", "d.vtu", "-q"]).code, 0);
    let diagram = bench.read("d.vtu");
    let types = integers(&diagram.cell_array("PairType").unwrap().data);
    let kinds = integers(&diagram.point_array("CriticalType").unwrap().data);
    for kind in 0..3 {
        assert!(types.contains(&kind));
        let of_kind = (1..types.len() - 1).filter(|&pair| types[pair] == kind);
        of_kind.for_each(|pair| assert_eq!(kinds[2 * pair..2 * pair + 2], [kind, kind + 1]));
    }
}

#[test]
fn suggested_thresholds_leave_what_they_say() {
    let bench = Bench::with(&hilly(40, 30));
    for select in ["data", "smooth"] {
        let more = ["--select", select, "--plot", "curve.svg", "--plots", "p", "--csv", "c.csv"];
        let run = bench.run(&[&["persistence", "in.vti"][..], &more].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        let suggested: Vec<(String, usize, usize)> = run
            .stdout
            .lines()
            .filter_map(|line| line.trim().strip_prefix("--persistence "))
            .map(|line| {
                let words: Vec<&str> = line.split_whitespace().collect();
                (words[0].to_owned(), words[2].parse().unwrap(), words[4].parse().unwrap())
            })
            .collect();
        assert!(suggested.len() >= 4, "{}", run.stdout);
        for (threshold, minima, maxima) in &suggested {
            let command = if select == "data" { "simplify" } else { "smooth" };
            let select = if select == "data" { &[][..] } else { &["--select", "smooth"] };
            let run = bench.run(&[&[command, "in.vti", "out.vti", "-q", "--report", "r.json", "--persistence", threshold], select].concat());
            assert_eq!(run.code, 0, "{}", run.stderr);
            let report = bench.json("r.json");
            assert_eq!((&report["audit"]["minima"], &report["audit"]["maxima"]), (&(*minima).into(), &(*maxima).into()), "{threshold}");
        }
        for name in ["curve.svg", "p/persistence_curve.svg", "p/persistence_diagram.svg"] {
            assert!(std::fs::read_to_string(bench.path(name)).unwrap().trim_end().ends_with("</svg>"), "{name}");
        }
        assert!(std::fs::read_to_string(bench.path("curve.svg")).unwrap().contains("plateau: "));
        assert!(bench.path("p/field.png").exists());
        let table = std::fs::read_to_string(bench.path("c.csv")).unwrap();
        let mut lines = table.lines();
        assert!(lines.next().unwrap().starts_with("\"Persistence (all pairs)\",\"Number Of Pairs (all pairs)\","));
        let rows: Vec<Vec<f64>> = lines.map(|line| line.split(',').map(|word| word.parse().unwrap()).collect()).collect();
        assert!(rows.windows(2).all(|pair| pair[0][0] < pair[1][0] && pair[0][1] > pair[1][1]));
        assert!(rows.iter().all(|row| row[1] == row[2] + row[3] + row[4]));
        assert_eq!(rows.last().unwrap()[1], 1.0, "the global pair");
    }
}

#[test]
fn refusals() {
    let bench = Bench::with(&hilly(20, 15));
    bench.refuses(&["persistence", "in.vti", "d.vtp", "-q"], &["for UnstructuredGrid; expected .vtu or .vtk"]);
    bench.refuses(&["persistence", "in.vti", "in.vti", "-q"], &["the output is the input file"]);
    bench.refuses(&["persistence", "in.vti", "--embed", "-q"], &["required arguments were not provided"]);
    bench.refuses(&["persistence", "in.vti", "d.vtu", "--csv", "d.vtu", "-q"], &["d.vtu: would overwrite d.vtu; expected another name"]);
    bench.refuses(&["persistence", "in.vti", "none/d.vtu", "-q"], &["the directory none does not exist"]);
    bench.refuses(&["persistence", "in.vti", "--select", "smooth", "--length", "0", "-q"], &["smoothing length is 0.0"]);
    bench.refuses(&["persistence", "in.vti", "--order", "5", "-q"], &["5 is not in 1..=4"]);
}
