//! Handles from files: `.tgf` as libigl writes it, `.json`, and arrays of numbers.

use std::collections::BTreeMap;
use std::path::Path;

use crate::field::VertexId;
use crate::mesh::{Handle, HandleSet, HandleShape};

use super::array::{ArrayData, DataArray};
use super::dataset::{CellArray, DataSet, Geometry};
use super::error::{Fault, IoError, Place, quoted};
use super::json::{self, Coordinates};
use super::lexer::Lexer;

/// Reads the handles of a file.
///
/// * `.json`: `{"handles": [{"name": "head", "point": [x, y, z]}, {"name": "arm", "bone": [[x, y, z], [x, y, z]]},
///   {"name": "base", "region": [0, 1, 2]}], "cage": [["head", "foot"]]}`. A place has two or three coordinates; a region has point
///   numbers of the mesh file; `cage` joins point handles.
/// * `.tgf`: lines `number x y z` with anything after them, a line `#`, lines `from to` of bones, or `from to is_bone is_pseudo
///   is_cage`, numbers counted from 1, and after a second `#` nothing that is read. Pseudo edges are skipped. Points at the end of no bone are point handles
///   `point_<number>` and come first, then bones `bone_1`, `bone_2` in the order of the file, as in libigl.
///
/// # Errors
/// [`IoError`] with the line where a format has lines, with the name of the handle where it has not.
///
/// # Cost
/// Linear in the size of the file.
pub fn read_handles(path: impl AsRef<Path>) -> Result<HandleSet, IoError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| IoError::Read { path: path.to_owned(), source })?;
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_ascii_lowercase();
    let set = match extension.as_str() {
        "json" => of_json(&bytes),
        "tgf" => of_tgf(&bytes),
        _ => Err(Fault::unsupported(Place::File, format!("a file .{extension}"), "handles in a .json or .tgf file")),
    };
    set.map_err(|fault| fault.in_file(path))
}

/// Handles from an array of whole numbers: the points with one number are one region.
///
/// A point array says it of points, a cell array of the points of cells. The lowest number, if it is 0 or less, is no handle. The handle of
/// number 3 in the array `part` is called `part_3`; handles come by rising numbers.
///
/// # Returns
/// Regions of point numbers.
///
/// # Errors
/// What was found and what was expected, in words.
///
/// # Cost
/// O((points + cells) log n).
pub fn region_handles(dataset: &DataSet, array: &str) -> Result<HandleSet, String> {
    let mut regions: BTreeMap<i64, Vec<VertexId>> = BTreeMap::new();
    if let Some(numbers) = dataset.point_array(array) {
        for (point, number) in whole_numbers(numbers)?.into_iter().enumerate() {
            regions.entry(number).or_default().push(VertexId::from(point));
        }
    } else if let Some(numbers) = dataset.cell_array(array) {
        let numbers = whole_numbers(numbers)?;
        let cells = cell_lists(dataset).ok_or_else(|| format!("found cell array \"{array}\" of a grid; expected a point array"))?;
        for (points, number) in cells.into_iter().flat_map(|cells| cells.iter()).zip(numbers) {
            regions.entry(number).or_default().extend(points.iter().map(|&point| VertexId::from(point as usize)));
        }
    } else {
        let known: Vec<&str> = dataset.point_data.arrays.iter().chain(&dataset.cell_data.arrays).map(|array| array.name.as_str()).collect();
        return Err(format!("found no point or cell array \"{array}\"; expected one of: {}", known.join(", ")));
    }
    if regions.first_key_value().is_some_and(|(&lowest, _)| lowest <= 0) {
        regions.pop_first();
    }
    let handles = regions.into_iter().map(|(number, mut points)| {
        points.sort_unstable();
        points.dedup();
        Handle { name: format!("{array}_{number}"), shape: HandleShape::Region(points) }
    });
    let handles: Vec<Handle> = handles.collect();
    match handles.is_empty() {
        true => Err(format!("array \"{array}\" has no number above 0 or above its lowest; expected one for each handle")),
        false => Ok(HandleSet { handles, cage_edges: Vec::new() }),
    }
}

/// The cells in the order in which arrays count them; `None` for grids.
fn cell_lists(dataset: &DataSet) -> Option<Vec<&CellArray>> {
    match &dataset.geometry {
        Geometry::PolyData { verts, lines, polys, strips, .. } => Some(vec![verts, lines, polys, strips]),
        Geometry::UnstructuredGrid { cells, .. } => Some(vec![cells]),
        Geometry::ImageData { .. } | Geometry::RectilinearGrid { .. } | Geometry::StructuredGrid { .. } => None,
    }
}

fn whole_numbers(array: &DataArray) -> Result<Vec<i64>, String> {
    let expected = "one whole number each";
    if array.components != 1 || matches!(array.data, ArrayData::String(_)) {
        return Err(format!("found {} components of type {} in array \"{}\"; expected {expected}", array.components, array.data.value_type().xml_name(), array.name));
    }
    let whole = |(place, value): (usize, f64)| match value.fract() == 0.0 && value.abs() < 2f64.powi(53) {
        true => Ok(value as i64),
        false => Err(format!("found {value} at place {place} of array \"{}\"; expected {expected}", array.name)),
    };
    array.to_f64(0).into_iter().enumerate().map(whole).collect()
}

/// The file as it is written.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct HandleFile {
    handles: Vec<HandleEntry>,
    #[serde(default)]
    cage: Vec<[String; 2]>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct HandleEntry {
    name: String,
    point: Option<Coordinates>,
    bone: Option<[Coordinates; 2]>,
    region: Option<Vec<u32>>,
}

fn of_json(bytes: &[u8]) -> Result<HandleSet, Fault> {
    let file: HandleFile = json::parse(bytes)?;
    let mut handles = Vec::with_capacity(file.handles.len());
    for HandleEntry { name, point, bone, region } in file.handles {
        let shape = match (point, bone, region) {
            (Some(point), None, None) => HandleShape::Point(point.0),
            (None, Some([root, tip]), None) => HandleShape::Bone([root.0, tip.0]),
            (None, None, Some(points)) => HandleShape::Region(points.into_iter().map(VertexId).collect()),
            (None, None, None) => return Err(shape_fault(&name, "none of them")),
            _ => return Err(shape_fault(&name, "several of them")),
        };
        handles.push(Handle { name, shape });
    }
    let mut cage_edges = Vec::with_capacity(file.cage.len());
    for ends in file.cage {
        let mut edge = [0; 2];
        for (slot, name) in edge.iter_mut().zip(&ends) {
            *slot = handles.iter().position(|handle| handle.name == *name).ok_or_else(|| {
                Fault::new(Place::File, format!("a cage edge to {}", quoted(name)), "the name of a handle of this file")
            })?;
        }
        cage_edges.push(edge);
    }
    Ok(HandleSet { handles, cage_edges })
}

fn shape_fault(name: &str, found: &str) -> Fault {
    Fault::new(Place::File, format!("{found} at handle {}", quoted(name)), "one of \"point\", \"bone\", \"region\"")
}

fn of_tgf(bytes: &[u8]) -> Result<HandleSet, Fault> {
    let mut lexer = Lexer::new(bytes);
    let mut points: Vec<[f64; 3]> = Vec::new();
    let (mut bones, mut cage): (Vec<[usize; 2]>, Vec<[usize; 2]>) = Default::default();
    let mut section = 0;
    while !lexer.is_at_end() && section < 2 {
        let place = lexer.place();
        let line = String::from_utf8_lossy(lexer.line()).into_owned();
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.first() {
            None => {}
            Some(word) if word.starts_with('#') => section += 1,
            Some(_) if section == 0 => points.push(tgf_point(&words, points.len(), place)?),
            Some(_) => match tgf_edge(&words, points.len(), place)? {
                (ends, EdgeKind::Bone) => bones.push(ends),
                (ends, EdgeKind::Cage) => cage.push(ends),
                (_, EdgeKind::Pseudo) => {}
            },
        }
    }
    if points.is_empty() {
        return Err(Fault::new(Place::File, "no point", "lines 'number x y z', a line '#', lines 'from to'"));
    }
    let free: Vec<usize> = (0..points.len()).filter(|point| !bones.iter().any(|ends| ends.contains(point))).collect();
    let mut handles: Vec<Handle> =
        free.iter().map(|&point| Handle { name: format!("point_{}", point + 1), shape: HandleShape::Point(points[point]) }).collect();
    handles.extend(bones.iter().enumerate().map(|(bone, ends)| Handle {
        name: format!("bone_{}", bone + 1),
        shape: HandleShape::Bone(ends.map(|end| points[end])),
    }));
    let handle_of = |point: usize| {
        free.binary_search(&point).map_err(|_| Fault::new(Place::File, format!("a cage edge to point {}", point + 1), "a point at the end of no bone"))
    };
    let cage_edges = cage.iter().map(|&[a, b]| Ok([handle_of(a)?, handle_of(b)?])).collect::<Result<_, Fault>>()?;
    Ok(HandleSet { handles, cage_edges })
}

/// What an edge of a `.tgf` file is.
enum EdgeKind {
    Bone,
    Pseudo,
    Cage,
}

fn tgf_point(words: &[&str], before: usize, place: Place) -> Result<[f64; 3], Fault> {
    let expected = format!("'{} x y z'", before + 1);
    let fault = |found: String| Fault::new(place, found, &expected);
    if words.len() < 4 {
        return Err(fault(format!("{} words", words.len())));
    }
    // Points are known by their place; a file that numbers them otherwise would be misread.
    if words[0].parse() != Ok(before + 1) {
        return Err(fault(quoted(words[0])));
    }
    let mut point = [0.0; 3];
    for (slot, word) in point.iter_mut().zip(&words[1..]) {
        *slot = word.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| fault(quoted(word)))?;
    }
    Ok(point)
}

fn tgf_edge(words: &[&str], points: usize, place: Place) -> Result<([usize; 2], EdgeKind), Fault> {
    let fault = |found: String, expected: String| Fault::new(place, found, expected);
    if words.len() < 2 {
        return Err(fault(format!("{} word", words.len()), "'from to' or 'from to is_bone is_pseudo is_cage'".into()));
    }
    let mut ends = [0; 2];
    for (slot, word) in ends.iter_mut().zip(words) {
        let number = word.parse::<usize>().ok().filter(|number| (1..=points).contains(number));
        *slot = number.ok_or_else(|| fault(quoted(word), format!("a point from 1 to {points}")))? - 1;
    }
    let flags = words[2..].iter().map(|word| match *word {
        "0" => Ok(false),
        "1" => Ok(true),
        other => Err(fault(quoted(other), "0 or 1".into())),
    });
    // An edge without flags is a bone: the skeletons of libigl's tutorial have none.
    let kind = match flags.take(3).collect::<Result<Vec<bool>, Fault>>()?[..] {
        [] | [true, ..] => EdgeKind::Bone,
        [_, _, true] => EdgeKind::Cage,
        _ => EdgeKind::Pseudo,
    };
    Ok((ends, kind))
}
