//! Every kind of data set, and every file that ships.

use morsmooth::io::{ArrayData, CellArray, DataArray, DataSet, Extent, Geometry};

use super::Bench;
use super::fields::{cells, doubles, hills, hilly, lattice, noise, positions, squares, stretched, surface, unstructured};
use crate::support::dataset;

/// The result in the new file, by way of another extension.
fn smooths_as(bench: &Bench, extension: &str) {
    let dataset = bench.read(&format!("in.{extension}"));
    let report = bench.smooths(&format!("in.{extension}"), &["--persistence", "15%", "--array", "h"]);
    assert_eq!(report["points"], dataset.point_count());
}

fn with_extras(mut dataset: DataSet) -> DataSet {
    let points = dataset.point_count();
    let texts = (0..points).map(|point| format!("point {point} <&>").into_bytes()).collect();
    dataset.set_point_array(DataArray::new("texts", 1, ArrayData::String(texts)));
    dataset.set_point_array(DataArray::new("ids", 2, ArrayData::I64((0..2 * points as i64).map(|id| -id).collect())));
    let odd: Vec<f32> = (0..points).map(|point| if point % 3 == 0 { f32::NAN } else { -0.0 }).collect();
    dataset.set_point_array(DataArray::new("odd", 1, ArrayData::F32(odd)));
    let cells = dataset.cell_count();
    dataset.cell_data.set(DataArray::new("region", 1, ArrayData::U16((0..cells).map(|cell| cell as u16).collect())));
    dataset.field_data.push(DataArray::new("TimeValue", 1, ArrayData::F64(vec![0.1])));
    dataset
}

fn cubes(width: i64, height: i64, depth: i64) -> (Vec<[f64; 3]>, Vec<i64>) {
    let mut points = Vec::new();
    for k in 0..depth {
        for j in 0..height {
            points.extend((0..width).map(|i| [i as f64, j as f64, 1.5 * k as f64]));
        }
    }
    let mut corners = Vec::new();
    for k in 0..depth - 1 {
        for j in 0..height - 1 {
            for i in 0..width - 1 {
                let at = |x: i64, y: i64, z: i64| i + x + width * (j + y + height * (k + z));
                corners.extend([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)].map(|(x, y, z)| at(x, y, z)));
            }
        }
    }
    (points, corners)
}

#[test]
fn images() {
    smooths_as(&Bench::with(&with_extras(hilly(24, 18))), "vti");
    // In 3-D.
    let values: Vec<f64> = (0..7 * 6 * 5).map(noise).collect();
    smooths_as(&Bench::with(&with_extras(super::fields::image([7, 6, 5], vec![doubles("h", &values)]))), "vti");
}

#[test]
fn rectilinear_and_structured_grids() {
    let axis = |count: usize| doubles("", &(0..count).map(|i| (i as f64).powf(1.2)).collect::<Vec<_>>());
    let extent = Extent([0, 19, 0, 14, 0, 0]);
    let coordinates = Box::new([axis(20), axis(15), doubles("", &[2.5])]);
    let mut grid = DataSet::new(Geometry::RectilinearGrid { extent, coordinates });
    grid.set_point_array(doubles("h", &hills(20, 15)));
    smooths_as(&Bench::with(&with_extras(grid)), "vtr");

    let bent: Vec<[f64; 3]> = (0..300)
        .map(|i| {
            let (radius, angle) = (2.0 + (i % 20) as f64 / 10.0, (i / 20) as f64 / 5.0);
            [radius * angle.cos(), radius * angle.sin(), 0.3 * angle]
        })
        .collect();
    let mut grid = DataSet::new(Geometry::StructuredGrid { extent, points: positions(&bent) });
    grid.set_point_array(doubles("h", &hills(20, 15)));
    smooths_as(&Bench::with(&with_extras(grid)), "vts");
}

#[test]
fn surfaces_of_quads_triangles_polygons_and_strips() {
    let (points, values) = (lattice(20, 15), hills(20, 15));
    smooths_as(&Bench::with(&with_extras(surface(&points, cells(4, &squares(20, 15)), &values))), "vtp");

    // Rows of squares as strips, one row as hexagons made of two squares each.
    let mut strips = CellArray::default();
    for row in 1..14 {
        strips.push((0..20).flat_map(|x| [row * 20 + x, (row + 1) * 20 + x]));
    }
    let mut polys = CellArray::default();
    for x in (0..18).step_by(2) {
        polys.push([x, x + 1, x + 2, x + 22, x + 21, x + 20]);
    }
    let (verts, lines) = (CellArray::default(), CellArray::default());
    let mut mixed = DataSet::new(Geometry::PolyData { points: positions(&points), verts, lines, polys, strips });
    mixed.set_point_array(doubles("h", &values));
    smooths_as(&Bench::with(&with_extras(mixed)), "vtp");
}

#[test]
fn polylines() {
    let points: Vec<[f64; 3]> = (0..120).map(|i| [i as f64 / 10.0, (i as f64 / 20.0).sin(), 0.0]).collect();
    let values: Vec<f64> = (0..120).map(|i| (i as f64 / 7.0).sin() + 0.2 * noise(i)).collect();
    let mut lines = CellArray::default();
    lines.push(0..70);
    lines.push(69..120);
    let empty = CellArray::default;
    let mut curve = DataSet::new(Geometry::PolyData { points: positions(&points), verts: empty(), lines, polys: empty(), strips: empty() });
    curve.set_point_array(doubles("h", &values));
    smooths_as(&Bench::with(&with_extras(curve)), "vtp");

    // The same as separate segments in an unstructured grid, closed to a ring.
    let segments: Vec<i64> = (0..120).flat_map(|i| [i, (i + 1) % 120]).collect();
    smooths_as(&Bench::with(&with_extras(unstructured(&points, cells(2, &segments), 3, &values))), "vtu");
}

#[test]
fn volumes_of_hexahedra_wedges_and_tetrahedra() {
    let (points, corners) = cubes(6, 5, 4);
    let values: Vec<f64> = (0..points.len()).map(|i| (i as f64 / 9.0).sin() + 0.3 * noise(i)).collect();
    smooths_as(&Bench::with(&with_extras(unstructured(&points, cells(8, &corners), 12, &values))), "vtu");

    let wedges: Vec<i64> = corners
        .chunks(8)
        .flat_map(|c| [[c[0], c[1], c[2], c[4], c[5], c[6]], [c[0], c[2], c[3], c[4], c[6], c[7]]].concat())
        .collect();
    smooths_as(&Bench::with(&with_extras(unstructured(&points, cells(6, &wedges), 13, &values))), "vtu");

    let tetrahedra: Vec<i64> = corners
        .chunks(8)
        .flat_map(|c| {
            [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]].concat().into_iter().map(|i| c[i])
        })
        .collect();
    smooths_as(&Bench::with(&with_extras(unstructured(&points, cells(4, &tetrahedra), 10, &values))), "vtu");
}

#[test]
fn legacy_files() {
    for dataset in [hilly(20, 15), surface(&lattice(20, 15), cells(4, &squares(20, 15)), &hills(20, 15))] {
        let bench = Bench::new();
        bench.put("in.vtk", &dataset);
        bench.smooths("in.vtk", &["--persistence", "15%"]);
        assert!(std::fs::read(bench.path("out.vtk")).unwrap().starts_with(b"# vtk DataFile Version"));
    }
    // Written by hand, in text, integers.
    let bench = Bench::new();
    let values: Vec<String> = (0..48).map(|i| ((9.0 * noise(i)) as i32).to_string()).collect();
    bench.text(
        "in.vtk",
        format!(
            "# vtk DataFile Version 3.0\nby hand\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 8 6 1\nORIGIN 0 0 0\nSPACING 1 1 1\n\
             POINT_DATA 48\nSCALARS h int 1\nLOOKUP_TABLE default\n{}\n",
            values.join(" ")
        ),
    );
    bench.smooths("in.vtk", &["--persistence", "20%"]);
}

#[test]
fn kinds_may_change_between_xml_and_legacy() {
    let bench = Bench::with(&stretched([0.5; 3], [1.0; 3], [20, 15, 1], vec![doubles("h", &hills(20, 15))]));
    let run = bench.run(&["smooth", "in.vti", "out.vtk", "--persistence", "15%", "-q"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(bench.read("out.vtk").point_array("h_smooth").unwrap().tuples(), 300);
}

#[test]
fn shipped_files() {
    for (name, arguments) in [
        ("elevation.vti", &["--persistence", "5%"][..]),
        ("cmb.vtp", &["--array", "temperature", "--mask", "valid", "--select", "smooth", "--persistence", "20%"]),
        ("cmb.vtp", &["--array", "temperature", "--persistence", "20%"]),
        ("co2.vtp", &["--array", "co2", "--select", "smooth", "--persistence", "5%"]),
        ("jet.vti", &["--array", "vorticity_magnitude", "--mask", "valid", "--persistence", "20%"]),
        ("jet.vti", &["--array", "velocity", "--derive", "vorticity", "--mask", "valid", "--select", "smooth", "--extrema", "13"]),
    ] {
        let bench = Bench::new();
        let input = format!("in.{}", name.rsplit('.').next().unwrap());
        std::fs::copy(dataset(name), bench.path(&input)).unwrap();
        bench.smooths(&input, arguments);
    }
}
