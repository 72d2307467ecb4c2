//! `vtk_probe FILES OUT`: reads every file of a folder, tells what it found as JSON, and writes it back in every form.
//! `roundtrip.py` compares the outcome with what real VTK makes of the same files.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::path::Path;
use std::time::Instant;

use morsmooth::io::{self, ArrayData, Attributes, CellArray, Compression, DataArray, DataSet, Extent, Geometry, IndexWidth};
use serde_json::{Map, Value, json};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["--describe", file] => println!("{}", describe(&io::read(file).unwrap())),
        ["--read", file] => time(file, None),
        ["--write", file, copy] => time(file, Some((copy, Compression::None))),
        ["--pack", file, copy] => time(file, Some((copy, Compression::Zlib))),
        [files, out] => probe(Path::new(files), Path::new(out)),
        _ => panic!("usage: vtk_probe FILES OUT, vtk_probe --describe FILE, or vtk_probe --read FILE, or --write or --pack FILE COPY"),
    }
}

/// Wall and processor seconds of one reading, or of one writing after it, as JSON.
fn time(file: &str, copy: Option<(&str, Compression)>) {
    let (start, before) = (Instant::now(), processor_seconds());
    let dataset = io::read(file).unwrap();
    let read = (start.elapsed().as_secs_f64(), processor_seconds() - before);
    let written = copy.map(|(copy, compression)| {
        let (start, before) = (Instant::now(), processor_seconds());
        io::write_temporary_with(copy, &dataset, compression).unwrap().commit().unwrap();
        (start.elapsed().as_secs_f64(), processor_seconds() - before)
    });
    println!("{}", json!({ "read": read, "write": written, "peak": peak_bytes() }));
}

/// Most memory that this process ever held, as Linux counts it; 0 elsewhere.
fn peak_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().trim_end_matches("kB").trim().parse::<u64>().ok()).unwrap_or(0) * 1024
}

/// User and system time of this process, as Linux counts it; 0 elsewhere.
fn processor_seconds() -> f64 {
    const TICKS_A_SECOND: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |place: usize| fields.get(place).and_then(|text| text.parse::<f64>().ok()).unwrap_or(0.0);
    (ticks(11) + ticks(12)) / TICKS_A_SECOND
}

fn probe(files: &Path, out: &Path) {
    for form in ["json", "raw", "zlib", "legacy", "hdf", "hdf_zlib"] {
        std::fs::create_dir_all(out.join(form)).unwrap();
    }
    let entries = std::fs::read_dir(files).unwrap().map(|entry| entry.unwrap().path());
    let mut names: Vec<String> = entries
        .filter(|path| path.is_file())
        .map(|path| path.file_name().unwrap().to_str().unwrap().to_owned())
        .collect();
    names.sort();
    for name in names {
        let result = std::panic::catch_unwind(|| one(files, out, &name));
        match result {
            Ok(Ok(())) => println!("read\t{name}"),
            Ok(Err(error)) => println!("refused\t{name}\t{error}"),
            Err(_) => println!("panic\t{name}"),
        }
    }
}

fn one(files: &Path, out: &Path, name: &str) -> Result<(), io::IoError> {
    let path = files.join(name);
    let dataset = io::read(&path)?;
    std::fs::write(out.join("json").join(format!("{name}.json")), describe(&dataset).to_string()).unwrap();
    // The whole name, because one source is there in several forms.
    let native = format!("{name}.{}", dataset.geometry.extension());
    io::write(out.join("raw").join(&native), &dataset)?;
    io::write_temporary_with(out.join("zlib").join(&native), &dataset, Compression::Zlib)?.commit()?;
    let again = io::read(out.join("zlib").join(&native))?;
    let same = DataSet { title: dataset.title.clone(), version: dataset.version, ..again };
    assert_eq!(format!("{same:?}"), format!("{dataset:?}"), "{name} changed on its way through XML");
    for (form, compression) in [("hdf", Compression::None), ("hdf_zlib", Compression::Zlib)] {
        let path = out.join(form).join(format!("{name}.vtkhdf"));
        io::write_temporary_with(&path, &dataset, compression)?.commit()?;
        let again = io::read(&path)?;
        let (again, same) = (comparable(again), comparable(dataset.clone()));
        assert_eq!(format!("{again:?}"), format!("{same:?}"), "{name} changed on its way through {form}");
    }
    match io::write(out.join("legacy").join(format!("{name}.vtk")), &dataset) {
        Err(io::IoError::Unwritable { found, .. }) if found.contains("rotated axes") => Ok(()),
        other => other,
    }
}

/// Without what a VTKHDF file does not tell: texts on points and cells, information keys, a first index, the width of lists, how polyhedra are laid out, and
/// the order in which roles are listed.
fn comparable(mut dataset: DataSet) -> DataSet {
    (dataset.title, dataset.version) = (String::new(), None);
    let arrays = dataset.point_data.arrays.iter_mut().chain(&mut dataset.cell_data.arrays).chain(&mut dataset.field_data);
    arrays.for_each(|array| array.information.clear());
    for data in [&mut dataset.point_data, &mut dataset.cell_data] {
        data.arrays.retain(|array| !matches!(array.data, ArrayData::String(_)));
        data.arrays.iter_mut().for_each(|array| array.name = array.name.replace(['/', '.'], "_"));
        data.active.iter_mut().for_each(|(_, name)| *name = name.replace(['/', '.'], "_"));
        data.active.sort_by_key(|(role, _)| role.name());
    }
    match &mut dataset.geometry {
        Geometry::RectilinearGrid { extent, coordinates } => {
            *extent = from_zero(*extent);
            for (array, name) in coordinates.iter_mut().zip(["XCoordinates", "YCoordinates", "ZCoordinates"]) {
                array.information.clear();
                array.name = name.into();
            }
        }
        Geometry::StructuredGrid { extent, points } => {
            *extent = from_zero(*extent);
            points.information.clear();
        }
        Geometry::PolyData { points, verts, lines, polys, strips } => {
            points.information.clear();
            [verts, lines, polys, strips].into_iter().for_each(|list| list.width = IndexWidth::default());
        }
        Geometry::UnstructuredGrid { points, cells, polyhedra, .. } => {
            points.information.clear();
            cells.width = IndexWidth::default();
            // Compared by VTK, face by face.
            *polyhedra = None;
        }
        Geometry::ImageData { .. } => {}
    }
    if let Geometry::StructuredGrid { points, .. } | Geometry::PolyData { points, .. } | Geometry::UnstructuredGrid { points, .. } =
        &mut dataset.geometry
    {
        points.name = "Points".into();
        points.component_names.clear();
    }
    dataset
}

fn from_zero(extent: Extent) -> Extent {
    let [x, y, z] = [0, 2, 4].map(|first| extent.0[first + 1] - extent.0[first]);
    if extent.point_count() == 0 { Extent([0, -1, 0, -1, 0, -1]) } else { Extent([0, x, 0, y, 0, z]) }
}

fn describe(dataset: &DataSet) -> Value {
    let mut object = Map::new();
    object.insert("type".into(), dataset.geometry.name().into());
    object.insert("point".into(), attributes(&dataset.point_data));
    object.insert("cell".into(), attributes(&dataset.cell_data));
    object.insert("field".into(), dataset.field_data.iter().map(|array| (array.name.clone(), values(array))).collect());
    let mut put = |key: &str, value: Value| object.insert(key.into(), value);
    match &dataset.geometry {
        Geometry::ImageData { extent, origin, spacing, direction } => {
            put("extent", json!(extent.0));
            put("origin", json!(origin));
            put("spacing", json!(spacing));
            put("dir", json!(direction));
        }
        Geometry::RectilinearGrid { extent, coordinates } => {
            put("extent", json!(extent.0));
            for (axis, array) in ["x", "y", "z"].iter().zip(coordinates.iter()) {
                put(axis, values(array));
            }
        }
        Geometry::StructuredGrid { extent, points } => {
            put("extent", json!(extent.0));
            put("points", values(points));
        }
        Geometry::PolyData { points, verts, lines, polys, strips } => {
            put("points", values(points));
            for (name, list) in [("verts", verts), ("lines", lines), ("polys", polys), ("strips", strips)] {
                put(name, cells(list));
            }
        }
        Geometry::UnstructuredGrid { points, cells: list, types, polyhedra } => {
            put("points", values(points));
            put("cells", cells(list));
            put("types", json!(types));
            put("poly", polyhedra.is_some().into());
        }
    }
    Value::Object(object)
}

fn attributes(attributes: &Attributes) -> Value {
    attributes.arrays.iter().map(|array| (array.name.clone(), values(array))).collect()
}

fn cells(list: &CellArray) -> Value {
    if list.is_empty() { Value::Null } else { json!({ "c": list.connectivity, "o": list.offsets[1..] }) }
}

fn float(value: f64) -> Value {
    match value {
        value if value.is_nan() => "nan".into(),
        f64::INFINITY => "inf".into(),
        f64::NEG_INFINITY => "-inf".into(),
        value => value.into(),
    }
}

fn values(array: &DataArray) -> Value {
    let (name, list) = match &array.data {
        ArrayData::I8(values) => ("I8", json!(values)),
        ArrayData::U8(values) => ("U8", json!(values)),
        ArrayData::I16(values) => ("I16", json!(values)),
        ArrayData::U16(values) => ("U16", json!(values)),
        ArrayData::I32(values) => ("I32", json!(values)),
        ArrayData::U32(values) => ("U32", json!(values)),
        ArrayData::I64(values) => ("I64", json!(values)),
        ArrayData::U64(values) => ("U64", json!(values)),
        ArrayData::F32(values) => ("F32", values.iter().map(|&value| float(value.into())).collect()),
        ArrayData::F64(values) => ("F64", values.iter().map(|&value| float(value)).collect()),
        ArrayData::Bit(values) => ("Bit", values.iter().map(|&bit| u8::from(bit)).collect()),
        ArrayData::String(_) => ("string", json!(array.to_texts())),
        _ => ("?", Value::Null),
    };
    json!({ "t": name, "n": array.components, "v": list })
}
