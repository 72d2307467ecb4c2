//! The seams between the pieces of one mesh: ghost cells left out, points that stand in several pieces made one.

use std::collections::HashMap;

use super::array::{ArrayData, DataArray, ValueType};
use super::dataset::{Attributes, CellArray, DataSet, Geometry, Polyhedra, Role};
use super::error::{Fault, Place, quoted};

/// VTK's array of marks, and the bit in it that says "another piece owns this".
const GHOST_TYPE: &str = "vtkGhostType";
const DUPLICATE: u8 = 1;
/// Its predecessor: the number of layers between the cell and the piece's own cells.
const GHOST_LEVELS: &str = "vtkGhostLevels";

/// Positions are the same within so many roundings of the largest coordinate, in the width in which they are stored: pieces that
/// compute the place of a shared point each for itself differ by one or two.
const ROUNDINGS: f64 = 4.0;

/// Values of a shared point agree within this part of the largest value, for 32 and 64 bits: what another order of summation leaves.
const AGREEMENT: (f64, f64) = (1e-5, 1e-9);

/// Closes the seams of pieces that were put one after the other.
///
/// Cells that are marked as another piece's are left out, and with them the points of no other cell. Points of different pieces are
/// one if they have the same global id, or, without global ids, the same position up to rounding; the first piece's values
/// hold. Normals may differ: each piece has its own, of its side of the seam.
///
/// # Arguments
/// * `whole`: poly data or an unstructured grid; `counts`: the number of points of each piece.
///
/// # Errors
/// Points that are one, but whose floating-point values differ: whether the field has a jump there or the pieces are of different
/// states is not ours to decide.
///
/// # Cost
/// O(n + m).
pub(super) fn weld(whole: DataSet, counts: &[usize]) -> Result<DataSet, Fault> {
    let is_kept = own_cells(&whole);
    let was_used = used_points(&whole, |_| true);
    let is_used = used_points(&whole, |cell| is_kept[cell]);
    let same = duplicates(&whole, counts)?;
    check_values(&whole, &same)?;
    // New numbers for the points that stay: of every group the first, if any of its copies is in use.
    let mut is_wanted = vec![false; same.len()];
    for (point, &first) in same.iter().enumerate() {
        // A point of no cell at all was there on purpose.
        is_wanted[first as usize] |= is_used[point] || !was_used[point];
    }
    let kept_points: Vec<usize> = (0..same.len()).filter(|&point| same[point] as usize == point && is_wanted[point]).collect();
    if kept_points.len() == same.len() && is_kept.iter().all(|&kept| kept) {
        return Ok(whole);
    }
    let mut number = vec![-1i64; same.len()];
    for (new, &point) in kept_points.iter().enumerate() {
        number[point] = new as i64;
    }
    let renamed = |point: i64| number[same[point as usize] as usize];
    let kept_cells: Vec<usize> = (0..is_kept.len()).filter(|&cell| is_kept[cell]).collect();
    let point_data = owned(gathered(whole.point_data, &kept_points));
    let cell_data = owned(gathered(whole.cell_data, &kept_cells));
    let geometry = match whole.geometry {
        Geometry::PolyData { points, verts, lines, polys, strips } => {
            let mut first = 0;
            let [verts, lines, polys, strips] = [verts, lines, polys, strips].map(|cells| {
                let own = &is_kept[first..first + cells.len()];
                first += cells.len();
                selected(&cells, own, renamed)
            });
            Geometry::PolyData { points: points.gathered(&kept_points), verts, lines, polys, strips }
        }
        Geometry::UnstructuredGrid { points, cells, types, polyhedra } => Geometry::UnstructuredGrid {
            points: points.gathered(&kept_points),
            cells: selected(&cells, &is_kept, renamed),
            types: kept_cells.iter().map(|&cell| types[cell]).collect(),
            polyhedra: polyhedra.map(|polyhedra| selected_polyhedra(&polyhedra, &is_kept, renamed)),
        },
        other => other,
    };
    Ok(DataSet { geometry, point_data, cell_data, ..whole })
}

/// Whether a cell is not marked as another piece's.
fn own_cells(whole: &DataSet) -> Vec<bool> {
    let count = whole.cell_count();
    let marks = |name: &str| whole.cell_array(name).filter(|array| array.components == 1).map(|array| array.to_f64(0));
    match (marks(GHOST_TYPE), marks(GHOST_LEVELS)) {
        (Some(marks), _) => marks.iter().map(|&mark| mark as u64 & u64::from(DUPLICATE) == 0).collect(),
        (None, Some(levels)) => levels.iter().map(|&level| level == 0.0).collect(),
        (None, None) => vec![true; count],
    }
}

fn cell_arrays(whole: &DataSet) -> Vec<&CellArray> {
    match &whole.geometry {
        Geometry::PolyData { verts, lines, polys, strips, .. } => vec![verts, lines, polys, strips],
        Geometry::UnstructuredGrid { cells, .. } => vec![cells],
        _ => Vec::new(),
    }
}

fn used_points(whole: &DataSet, is_counted: impl Fn(usize) -> bool) -> Vec<bool> {
    let mut used = vec![false; whole.point_count()];
    for (cell, points) in cell_arrays(whole).into_iter().flat_map(CellArray::iter).enumerate() {
        if is_counted(cell) {
            points.iter().for_each(|&point| used[point as usize] = true);
        }
    }
    used
}

/// For every point the first one that it is the same as.
fn duplicates(whole: &DataSet, counts: &[usize]) -> Result<Vec<u32>, Fault> {
    let total = whole.point_count();
    if u32::try_from(total).is_err() {
        return Err(Fault::new(Place::File, format!("{total} points"), "fewer than 2^32"));
    }
    let pieces: Vec<u32> = (0u32..).zip(counts).flat_map(|(piece, &count)| std::iter::repeat_n(piece, count)).collect();
    let ids = whole.point_data.active(Role::GlobalIds).and_then(|name| whole.point_array(name)).and_then(integers);
    Ok(match ids {
        Some(ids) => same_ids(&ids, &pieces),
        None => same_places(whole, &pieces),
    })
}

fn same_ids(ids: &[u64], pieces: &[u32]) -> Vec<u32> {
    let mut first: HashMap<u64, u32> = HashMap::with_capacity(ids.len());
    let point = |(point, &id): (usize, &u64)| {
        let known = *first.entry(id).or_insert(point as u32);
        if pieces[known as usize] == pieces[point] { point as u32 } else { known }
    };
    ids.iter().enumerate().map(point).collect()
}

/// Points of different pieces nearer than the rounding of the largest coordinate. Within a piece, points at one place are meant.
fn same_places(whole: &DataSet, pieces: &[u32]) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    let positions = whole.points_f64();
    let is_double = match &whole.geometry {
        Geometry::PolyData { points, .. } | Geometry::UnstructuredGrid { points, .. } => points.data.value_type() == ValueType::F64,
        _ => true,
    };
    let largest = positions.iter().flatten().filter(|value| value.is_finite()).fold(0.0, |most: f64, value| most.max(value.abs()));
    let near = ROUNDINGS * largest * if is_double { f64::EPSILON } else { f64::from(f32::EPSILON) };
    let width = 4.0 * near.max(f64::MIN_POSITIVE);
    // Points by box, as lists: the last one of a box, and for every point the one before it.
    let mut last: HashMap<[i64; 3], u32> = HashMap::with_capacity(positions.len());
    let mut before = vec![NONE; positions.len()];
    let mut same: Vec<u32> = (0..positions.len() as u32).collect();
    for (point, place) in positions.iter().enumerate() {
        let box_of = |shift: f64| place.map(|value| ((value + shift) / width).floor() as i64);
        let (low, high) = (box_of(-near), box_of(near));
        let mut found = NONE;
        for corner in 0..8 {
            let cell: [i64; 3] = std::array::from_fn(|axis| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] });
            // A box that is no neighbour on some axis is searched once.
            if (0..3).any(|axis| corner >> axis & 1 == 1 && low[axis] == high[axis]) {
                continue;
            }
            let mut other = last.get(&cell).copied().unwrap_or(NONE);
            while other != NONE {
                let is_near = (0..3).all(|axis| (positions[other as usize][axis] - place[axis]).abs() <= near);
                if is_near && pieces[other as usize] != pieces[point] {
                    found = found.min(same[other as usize]);
                }
                other = before[other as usize];
            }
        }
        if found != NONE {
            same[point] = found;
        }
        let slot = last.entry(box_of(0.0)).or_insert(NONE);
        before[point] = std::mem::replace(slot, point as u32);
    }
    same
}

fn integers(array: &DataArray) -> Option<Vec<u64>> {
    match &array.data {
        ArrayData::I32(values) => Some(values.iter().map(|&value| i64::from(value) as u64).collect()),
        ArrayData::I64(values) => Some(values.iter().map(|&value| value as u64).collect()),
        ArrayData::U32(values) => Some(values.iter().map(|&value| u64::from(value)).collect()),
        ArrayData::U64(values) => Some(values.clone()),
        _ => None,
    }
}

/// Refuses points that are one but whose values differ. Integers may: they say which process a copy belongs to, and the like.
fn check_values(whole: &DataSet, same: &[u32]) -> Result<(), Fault> {
    let normals = whole.point_data.active(Role::Normals);
    let is_field = |array: &&DataArray| array.data.value_type().is_float() && array.name != "Normals" && normals != Some(array.name.as_str());
    for array in whole.point_data.arrays.iter().filter(is_field) {
        let values = |tuple: usize| (0..array.components).map(move |part| array.data.number(tuple * array.components + part));
        let all = (0..array.data.len()).filter_map(|index| array.data.number(index)).filter(|value| value.is_finite());
        let largest = all.fold(0.0, |most: f64, value| most.max(value.abs()));
        let tolerance = largest * if array.data.value_type() == ValueType::F64 { AGREEMENT.1 } else { AGREEMENT.0 };
        let are_apart = |a: f64, b: f64| if a.is_finite() && b.is_finite() { (a - b).abs() > tolerance } else { a.to_bits() != b.to_bits() && !(a.is_nan() && b.is_nan()) };
        let differ = |point: usize, first: usize| {
            values(point).zip(values(first)).any(|pair| matches!(pair, (Some(a), Some(b)) if are_apart(a, b)))
        };
        let found = same.iter().enumerate().find(|&(point, &first)| first as usize != point && differ(point, first as usize));
        if let Some((point, &first)) = found {
            let shown = |tuple: usize| values(tuple).map(|value| format!("{:?}", value.unwrap_or(f64::NAN))).collect::<Vec<_>>().join(" ");
            let place = whole.points_f64()[point];
            return Err(Fault::new(
                Place::File,
                format!("{} and {} in array {} for the point at {place:?} that two pieces share", shown(first as usize), shown(point), quoted(&array.name)),
                "the same values: pieces of one state",
            ));
        }
    }
    Ok(())
}

fn gathered(attributes: Attributes, tuples: &[usize]) -> Attributes {
    let arrays = attributes.arrays.into_iter().map(|array| array.gathered(tuples)).collect();
    Attributes { arrays, active: attributes.active }
}

/// Takes the marks of copies away: what is left is nobody's copy.
pub(super) fn owned(mut attributes: Attributes) -> Attributes {
    for array in &mut attributes.arrays {
        match &mut array.data {
            ArrayData::U8(marks) if array.name == GHOST_TYPE => marks.iter_mut().for_each(|mark| *mark &= !DUPLICATE),
            ArrayData::U8(levels) if array.name == GHOST_LEVELS => levels.fill(0),
            _ => {}
        }
    }
    attributes
}

fn selected(cells: &CellArray, is_kept: &[bool], renamed: impl Fn(i64) -> i64) -> CellArray {
    let mut chosen = CellArray { width: cells.width, ..CellArray::default() };
    for (points, _) in cells.iter().zip(is_kept).filter(|(_, kept)| **kept) {
        chosen.push(points.iter().map(|&point| renamed(point)));
    }
    chosen
}

/// Polyhedra as lists, with the faces of those that stay.
fn selected_polyhedra(polyhedra: &Polyhedra, is_kept: &[bool], renamed: impl Fn(i64) -> i64) -> Polyhedra {
    let (faces, cells) = polyhedra.to_lists();
    let mut kept_faces = CellArray { width: faces.width, ..CellArray::default() };
    let mut kept_cells = CellArray { width: cells.width, ..CellArray::default() };
    for (list, _) in cells.iter().zip(is_kept).filter(|(_, kept)| **kept) {
        let first = kept_faces.len() as i64;
        list.iter().for_each(|&face| kept_faces.push(faces.cell(face as usize).iter().map(|&point| renamed(point))));
        kept_cells.push(first..first + list.len() as i64);
    }
    Polyhedra::Lists { faces: kept_faces, cells: kept_cells }
}
