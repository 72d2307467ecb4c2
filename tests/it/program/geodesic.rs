//! `morsmooth geodesic`.

use morsmooth::io::{ArrayData, CellArray, DataArray, DataSet, Geometry};

use super::{Bench, wanted_points};

/// A hilly sheet of triangles in an .off file; `also` gives more faces.
fn sheet(bench: &Bench, also: &str, faces: usize, points: &str, more: usize) {
    let n = 24;
    let mut text = String::new();
    let mut corners = String::new();
    for j in 0..n {
        for i in 0..n {
            let (x, y) = (i as f64, j as f64);
            text += &format!("{x} {y} {}\n", 3.0 * (0.6 * x).sin() * (0.5 * y).cos());
            if i + 1 < n && j + 1 < n {
                let a = j * n + i;
                corners += &format!("3 {a} {} {}\n3 {a} {} {}\n", a + 1, a + n + 1, a + n + 1, a + n);
            }
        }
    }
    let count = 2 * (n - 1) * (n - 1) + faces;
    bench.text("in.off", format!("OFF\n{} {count} 0\n{text}{points}{corners}{also}", n * n + more));
}

fn values(dataset: &DataSet, name: &str) -> Vec<f64> {
    dataset.point_array(name).unwrap().to_f64(0)
}

#[test]
fn distances_are_written_and_smoothed_with_the_same_maxima() {
    let bench = Bench::new();
    sheet(&bench, "", 0, "", 0);
    let call = ["geodesic", "in.off", "out.vtp", "--source", "30,500", "--smooth", "--report", "r.json", "--plots", "plots", "-q"];
    let run = bench.run(&call);
    assert_eq!((run.code, run.stdout.as_str(), run.stderr.as_str()), (0, "", ""));
    let (out, report) = (bench.read("out.vtp"), bench.json("r.json"));
    let (distance, smooth) = (values(&out, "geodesic_distance"), values(&out, "geodesic_distance_smooth"));
    assert_eq!((distance[30], distance[500]), (0.0, 0.0));
    assert!(distance.iter().zip(&smooth).any(|(a, b)| a != b));
    let neighbours = |vertex: usize| {
        let (i, j) = ((vertex % 24) as i64, (vertex / 24) as i64);
        let around = [(1, 0), (0, 1), (1, 1), (-1, 0), (0, -1), (-1, -1)].map(|(a, b)| (i + a, j + b));
        around.into_iter().filter(|(i, j)| (0..24).contains(i) && (0..24).contains(j)).map(|(i, j)| (j * 24 + i) as usize)
    };
    let maxima = |field: &[f64]| -> Vec<usize> { (0..576).filter(|&v| neighbours(v).all(|w| field[w] < field[v])).collect() };
    let minima = |field: &[f64]| -> Vec<usize> { (0..576).filter(|&v| neighbours(v).all(|w| field[w] > field[v])).collect() };
    assert_eq!(maxima(&smooth), maxima(&distance));
    assert_eq!(minima(&smooth), [30, 500]);
    assert_eq!(wanted_points(&report, "maxima"), maxima(&distance));
    maxima(&distance).iter().for_each(|&vertex| assert_eq!(smooth[vertex], distance[vertex]));
    assert!(bench.path("plots/before_after.png").exists());

    // Without --smooth the same distances, and heat is near.
    let run = bench.run(&["geodesic", "in.off", "plain.vtu", "--source", "30", "--source", "500", "--plots", "plots"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stdout.starts_with("geodesic_distance: exact from 2 sources, farthest "), "{}", run.stdout);
    assert_eq!(values(&bench.read("plain.vtu"), "geodesic_distance"), distance);
    assert!(bench.path("plots/distance.png").exists());
    assert_eq!(bench.run(&["geodesic", "in.off", "heat.vtp", "--source", "30,500", "--method", "heat", "-q"]).code, 0);
    let heat = values(&bench.read("heat.vtp"), "geodesic_distance");
    let farthest = distance.iter().fold(0.0f64, |most, &d| most.max(d));
    assert!(heat.iter().zip(&distance).all(|(a, b)| (a - b).abs() < 0.3 * farthest));
}

#[test]
fn places_and_curves_are_sources() {
    let bench = Bench::new();
    let points = DataArray::new("Points", 3, ArrayData::F64(vec![0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 4.0, 3.0, 0.0, 0.0, 3.0, 0.0]));
    let mut polygons = CellArray::default();
    polygons.push([0, 1, 2]);
    polygons.push([0, 2, 3]);
    let mut dataset = DataSet::new(Geometry::PolyData { points, verts: CellArray::default(), lines: CellArray::default(), polys: polygons, strips: CellArray::default() });
    dataset.set_point_array(DataArray::new("kept", 1, ArrayData::I32(vec![4, 3, 2, 1])));
    bench.put("in.vtp", &dataset);
    let run = bench.run(&["geodesic", "in.vtp", "out.vtp", "--source-point", "3,1,0.01"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("note: --source-point 3,1,0.01 is in the face of the points 0, 1, 2"), "{}", run.stderr);
    let out = bench.read("out.vtp");
    for (found, expected) in values(&out, "geodesic_distance").iter().zip([10f64.sqrt(), 2f64.sqrt(), 5f64.sqrt(), 13f64.sqrt()]) {
        assert!((found - expected).abs() < 1e-12);
    }
    assert_eq!(out.point_array("kept"), dataset.point_array("kept"));
    bench.text("curve.txt", "# a side\n0 0 0\n4, 0, 0\n");
    assert_eq!(bench.run(&["geodesic", "in.vtp", "out.vtp", "--source-curve", "curve.txt"]).code, 0);
    assert_eq!(values(&bench.read("out.vtp"), "geodesic_distance")[..2], [0.0, 0.0]);
    bench.refuses(&["geodesic", "in.vtp", "no.vtp", "--source-point", "3,1,5"], &["--source-point 3,1,5 lies 5e0 off the surface; expected at most"]);
    bench.refuses(&["geodesic", "in.vtp", "no.vtp", "--source-point", "3,1"], &["found '3,1'; expected three finite numbers x,y,z"]);
    bench.text("off.txt", "0 3 0\n4 0 0\n");
    bench.refuses(&["geodesic", "in.vtp", "no.vtp", "--source-curve", "off.txt"], &["off.txt", "the points 0 and 1 of the curve lie in no common triangle"]);
    bench.text("bad.txt", "0 0 0\n1 x 0\n");
    bench.refuses(&["geodesic", "in.vtp", "no.vtp", "--source-curve", "bad.txt"], &["bad.txt: line 2: found '1,x,0'; expected three finite numbers"]);
}

#[test]
fn each_source_has_distances_of_its_own() {
    let bench = Bench::new();
    sheet(&bench, "", 0, "", 0);
    bench.text("curve.txt", format!("0 0 0\n1 0 {}\n", 3.0 * 0.6f64.sin()));
    let sources = ["--source", "30,500", "--source-point", "11.2,7.9,-1", "--source-tolerance", "20%", "--source-curve", "curve.txt"];
    for method in ["exact", "heat"] {
        let call = [&["geodesic", "in.off", "each.vtp", "--each", "--method", method, "--report", "r.json", "--plots", "plots"][..], &sources].concat();
        let run = bench.run(&call);
        assert_eq!(run.code, 0, "{}", run.stderr);
        for (number, from) in ["point 30", "point 500", "place 11.2,7.9,-1", "curve curve.txt"].iter().enumerate() {
            assert!(run.stdout.contains(&format!("geodesic_distance_{number}: {method} from {from}, farthest ")), "{}", run.stdout);
            assert!(bench.path(&format!("plots/geodesic_distance_{number}.png")).exists());
            assert_eq!(bench.json("r.json")["arrays"][number]["source"], *from);
        }
        let each = bench.read("each.vtp");
        assert!(each.point_array("geodesic_distance").is_none());
        let columns: Vec<Vec<f64>> = (0..4).map(|number| values(&each, &format!("geodesic_distance_{number}"))).collect();
        assert_eq!((columns[0][30], columns[1][500]), (0.0, 0.0));
        // The same bits as alone.
        for (number, alone) in [(0, &sources[..1]), (1, &sources[..1])] {
            let source = ["30", "500"][number];
            assert_eq!(bench.run(&[&["geodesic", "in.off", "one.vtp", "--method", method, "-q"], alone, &[source]].concat()).code, 0);
            assert!(values(&bench.read("one.vtp"), "geodesic_distance") == columns[number]);
        }
        // From all together: the least of them, which heat only comes near.
        assert_eq!(bench.run(&[&["geodesic", "in.off", "all.vtp", "--method", method, "-q"][..], &sources].concat()).code, 0);
        let all = values(&bench.read("all.vtp"), "geodesic_distance");
        if method == "exact" {
            for (vertex, &distance) in all.iter().enumerate() {
                let least = columns.iter().map(|column| column[vertex]).fold(f64::INFINITY, f64::min);
                assert!((least - distance).abs() < 1e-9 * (1.0 + distance), "{vertex}: {least} {distance}");
            }
        }
    }
    bench.refuses(&[&["geodesic", "in.off", "no.vtp", "--each", "--smooth"][..], &sources].concat(), &["--each", "--smooth"]);
    bench.refuses(&[&["geodesic", "in.off", "no.off", "--each"][..], &sources].concat(), &["no room for the array geodesic_distance_0"]);
    // Another part is out of reach for one source even where the other one lies in it.
    sheet(&bench, "3 576 577 578\n", 1, "0 0 90\n1 0 90\n0 1 90\n", 3);
    let call = ["geodesic", "in.off", "two.vtp", "--source", "0,577", "--each"];
    bench.refuses(&call, &["no path leads from point 0 to 3 of 579 points, first point 576; expected one part", "--allow-unreached"]);
    assert_eq!(bench.run(&[&call[..], &["--allow-unreached", "-q"]].concat()).code, 0);
    let second = values(&bench.read("two.vtp"), "geodesic_distance_1");
    assert!(second[..576].iter().all(|value| value.is_nan()) && second[576..] == [1.0, 0.0, 2f64.sqrt()]);
}

#[test]
fn what_cannot_be_done_is_refused() {
    let bench = Bench::new();
    sheet(&bench, "", 0, "", 0);
    bench.refuses(&["geodesic", "in.off", "no.vtp"], &["found no source; expected --source, --source-point or --source-curve"]);
    bench.refuses(&["geodesic", "in.off", "no.vtp", "--source", "576"], &["found --source 576; the file has points 0 to 575"]);
    bench.refuses(&["geodesic", "in.off", "no.off", "--source", "0"], &["no.off", "no room for the array geodesic_distance"]);
    bench.refuses(&["geodesic", "in.off", "no.vtp", "--source", "0", "--method", "heat", "--heat-time", "-1"], &["time of the heat flow is -1"]);
    // One more triangle at an edge, with a point of its own.
    sheet(&bench, "3 0 1 576\n", 1, "0 0 9\n", 1);
    let run = bench.run(&["geodesic", "in.off", "two.vtp", "--source", "0", "-q"]);
    assert_eq!(run.code, 0, "an edge of the rim has room for one more: {}", run.stderr);
    sheet(&bench, "3 0 25 576\n", 1, "0 0 9\n", 1);
    let three = "the edge between the points 0 and 25 has 3 triangles";
    bench.refuses(&["geodesic", "in.off", "no.vtp", "--source", "0"], &[three, "expected at most 2", "--method heat"]);
    // A part of its own.
    sheet(&bench, "3 576 577 578\n", 1, "0 0 90\n1 0 90\n0 1 90\n", 3);
    let parted = ["no path leads from the sources to 3 of 579 points, first point 576; expected a source in every part", "--allow-unreached"];
    bench.refuses(&["geodesic", "in.off", "no.vtp", "--source", "0"], &parted);
    let run = bench.run(&["geodesic", "in.off", "part.vtp", "--source", "0", "--allow-unreached", "--smooth"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stdout.contains("3 points are not reached: NaN"), "{}", run.stdout);
    let smooth = values(&bench.read("part.vtp"), "geodesic_distance_smooth");
    assert!(smooth[576..].iter().all(|value| value.is_nan()) && smooth[..576].iter().all(|value| value.is_finite()));
    // No area, and a solid.
    bench.text("flat.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n");
    bench.refuses(&["geodesic", "flat.off", "no.vtp", "--source", "0"], &["flat.off"]);
    bench.text("solid.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\nTetrahedra 1\n1 2 3 4 0\nEnd\n");
    bench.refuses(&["geodesic", "solid.mesh", "no.vtu", "--source", "0"], &["a complex of dimension 3; expected triangles", "--method heat"]);
    assert_eq!(bench.run(&["geodesic", "solid.mesh", "solid.vtu", "--source", "0", "--method", "heat", "-q"]).code, 0);
}
