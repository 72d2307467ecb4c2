//! Several pieces become one data set.

use crate::io::array::{ArrayData, DataArray, with_values};
use crate::io::dataset::{Attributes, CellArray, DataSet, Extent, Geometry, Polyhedra};
use crate::io::error::{Fault, Place, quoted};

/// For each tuple of the whole: its piece and its place there.
type Sources = Vec<(u32, u32)>;

/// Merges pieces of one kind. Empty ones only count if there is no other.
pub(in crate::io) fn merge(mut pieces: Vec<DataSet>) -> Result<DataSet, Fault> {
    let filled = pieces.iter().filter(|piece| piece.point_count() > 0).count();
    if filled > 0 {
        pieces.retain(|piece| piece.point_count() > 0);
    }
    if filled <= 1 {
        return Ok(pieces.swap_remove(0));
    }
    if matches!(pieces[0].geometry, Geometry::PolyData { .. } | Geometry::UnstructuredGrid { .. }) {
        merge_lists(&pieces)
    } else {
        merge_grids(&pieces)
    }
}

fn merge_lists(pieces: &[DataSet]) -> Result<DataSet, Fault> {
    let mut shifts = vec![0i64];
    for piece in pieces {
        shifts.push(shifts[shifts.len() - 1] + piece.point_count() as i64);
    }
    let points = in_turn(pieces.iter().map(DataSet::point_count))?;
    let cells;
    let geometry = match &pieces[0].geometry {
        Geometry::UnstructuredGrid { .. } => {
            cells = in_turn(pieces.iter().map(DataSet::cell_count))?;
            merge_unstructured(pieces, &shifts, &points)?
        }
        _ => {
            let part = |number: usize| pieces.iter().map(move |piece| poly_parts(piece)[number]);
            let joined = |number: usize| join_cells(part(number), &shifts);
            cells = poly_cell_sources(pieces);
            Geometry::PolyData {
                points: gather(pieces.iter().map(point_array), &points)?,
                verts: joined(0),
                lines: joined(1),
                polys: joined(2),
                strips: joined(3),
            }
        }
    };
    let mut whole = DataSet::new(geometry);
    whole.point_data = gather_all(pieces, |piece| &piece.point_data, || Ok(points))?;
    whole.cell_data = gather_all(pieces, |piece| &piece.cell_data, || Ok(cells))?;
    Ok(whole)
}

/// Sources that take the pieces one after the other.
fn in_turn(counts: impl Iterator<Item = usize>) -> Result<Sources, Fault> {
    let mut sources = Vec::new();
    for (piece, count) in counts.enumerate() {
        let count = u32::try_from(count).map_err(|_| Fault::new(Place::File, format!("a piece of {count}"), "at most 2^32 - 1"))?;
        sources.extend((0..count).map(|tuple| (piece as u32, tuple)));
    }
    Ok(sources)
}

fn point_array(piece: &DataSet) -> Option<&DataArray> {
    match &piece.geometry {
        Geometry::StructuredGrid { points, .. }
        | Geometry::PolyData { points, .. }
        | Geometry::UnstructuredGrid { points, .. } => Some(points),
        _ => None,
    }
}

fn poly_parts(piece: &DataSet) -> Vec<&CellArray> {
    match &piece.geometry {
        Geometry::PolyData { verts, lines, polys, strips, .. } => vec![verts, lines, polys, strips],
        _ => Vec::new(),
    }
}

/// Cell arrays list all verts, then all lines, and so on, in the whole as in each piece.
fn poly_cell_sources(pieces: &[DataSet]) -> Sources {
    let mut sources = Vec::new();
    let mut next: Vec<u32> = vec![0; pieces.len()];
    for part in 0..4 {
        for (number, piece) in pieces.iter().enumerate() {
            let end = next[number] + poly_parts(piece)[part].len() as u32;
            sources.extend((next[number]..end).map(|cell| (number as u32, cell)));
            next[number] = end;
        }
    }
    sources
}

fn join_cells<'a>(parts: impl Iterator<Item = &'a CellArray>, shifts: &[i64]) -> CellArray {
    let mut joined: Option<CellArray> = None;
    for (part, shift) in parts.zip(shifts) {
        match &mut joined {
            None => joined = Some(part.clone()),
            Some(joined) => {
                let base = joined.connectivity.len() as i64;
                joined.offsets.extend(part.offsets[1..].iter().map(|offset| offset + base));
                joined.connectivity.extend(part.connectivity.iter().map(|point| point + shift));
            }
        }
    }
    joined.unwrap_or_default()
}

fn merge_unstructured(pieces: &[DataSet], shifts: &[i64], sources: &Sources) -> Result<Geometry, Fault> {
    let (mut all_cells, mut all_types, mut all_polyhedra) = (Vec::new(), Vec::new(), Vec::new());
    for piece in pieces {
        if let Geometry::UnstructuredGrid { cells, types, polyhedra, .. } = &piece.geometry {
            all_cells.push(cells);
            all_types.extend_from_slice(types);
            all_polyhedra.push(polyhedra.as_ref());
        }
    }
    let polyhedra = if all_polyhedra.iter().all(Option::is_none) {
        None
    } else {
        let counts: Vec<usize> = all_cells.iter().map(|cells| cells.len()).collect();
        Some(join_polyhedra(&all_polyhedra, &counts, shifts)?)
    };
    Ok(Geometry::UnstructuredGrid {
        points: gather(pieces.iter().map(point_array), sources)?,
        cells: join_cells(all_cells.into_iter(), shifts),
        types: all_types,
        polyhedra,
    })
}

fn join_polyhedra(parts: &[Option<&Polyhedra>], cell_counts: &[usize], shifts: &[i64]) -> Result<Polyhedra, Fault> {
    let without = |count: usize| CellArray { offsets: vec![0; count + 1], ..CellArray::default() };
    let mut faces = Vec::new();
    let mut lists = Vec::new();
    for (part, &count) in parts.iter().zip(cell_counts) {
        match part {
            None => {
                faces.push(CellArray::default());
                lists.push(without(count));
            }
            Some(part) => {
                let (part_faces, part_cells) = part.to_lists();
                faces.push(part_faces);
                lists.push(part_cells);
            }
        }
    }
    let mut face_shifts = vec![0];
    for part in &faces {
        face_shifts.push(face_shifts[face_shifts.len() - 1] + part.len() as i64);
    }
    Ok(Polyhedra::Lists { faces: join_cells(faces.iter(), shifts), cells: join_cells(lists.iter(), &face_shifts) })
}

fn merge_grids(pieces: &[DataSet]) -> Result<DataSet, Fault> {
    if let Some(piece) = pieces.iter().position(|piece| frame(piece) != frame(&pieces[0])) {
        let found = format!("another origin, spacing or direction in piece {piece} than in the first");
        return Err(Fault::new(Place::File, found, "pieces of one grid"));
    }
    let extents: Vec<Extent> = pieces.iter().map(extent_of).collect();
    let mut bounds = extents[0].0;
    for Extent(extent) in &extents {
        for axis in 0..3 {
            bounds[2 * axis] = bounds[2 * axis].min(extent[2 * axis]);
            bounds[2 * axis + 1] = bounds[2 * axis + 1].max(extent[2 * axis + 1]);
        }
    }
    let whole_extent = Extent(bounds);
    let point_sources = || grid_sources(&extents, whole_extent, false);
    let geometry = match &pieces[0].geometry {
        Geometry::ImageData { origin, spacing, direction, .. } => {
            Geometry::ImageData { extent: whole_extent, origin: *origin, spacing: *spacing, direction: *direction }
        }
        Geometry::RectilinearGrid { .. } => {
            Geometry::RectilinearGrid { extent: whole_extent, coordinates: Box::new(merge_coordinates(pieces, &extents, whole_extent)?) }
        }
        _ => Geometry::StructuredGrid {
            extent: whole_extent,
            points: gather(pieces.iter().map(point_array), &point_sources()?)?,
        },
    };
    let mut whole = DataSet::new(geometry);
    whole.point_data = gather_all(pieces, |piece| &piece.point_data, point_sources)?;
    whole.cell_data = gather_all(pieces, |piece| &piece.cell_data, || grid_sources(&extents, whole_extent, true))?;
    Ok(whole)
}

/// Origin, spacing and direction of an image.
fn frame(piece: &DataSet) -> Option<([f64; 3], [f64; 3], [f64; 9])> {
    match &piece.geometry {
        Geometry::ImageData { origin, spacing, direction, .. } => Some((*origin, *spacing, *direction)),
        _ => None,
    }
}

fn extent_of(piece: &DataSet) -> Extent {
    match &piece.geometry {
        Geometry::ImageData { extent, .. }
        | Geometry::RectilinearGrid { extent, .. }
        | Geometry::StructuredGrid { extent, .. } => *extent,
        _ => Extent([0, -1, 0, -1, 0, -1]),
    }
}

/// Sources that put every piece where its extent says; where pieces overlap, the later one holds, as in VTK.
fn grid_sources(extents: &[Extent], whole: Extent, cells: bool) -> Result<Sources, Fault> {
    const NOWHERE: (u32, u32) = (u32::MAX, u32::MAX);
    let dimensions = |extent: &Extent| if cells { extent.cell_dimensions() } else { extent.dimensions() };
    let count = |extent: &Extent| dimensions(extent).iter().fold(1usize, |product, &length| product.saturating_mul(length));
    let wanted = count(&whole);
    let given = extents.iter().fold(0usize, |sum, extent| sum.saturating_add(count(extent)));
    let gap = |covered: usize| {
        let what = if cells { "cells" } else { "points" };
        Fault::new(Place::File, format!("pieces that cover {covered} of {wanted} {what}"), "pieces without gaps between them")
    };
    // Before anything is allocated: the pieces hold data, the space between them need not.
    if given < wanted || wanted > u32::MAX as usize {
        return Err(gap(given));
    }
    let [whole_x, whole_y, _] = dimensions(&whole);
    let mut sources = vec![NOWHERE; wanted];
    for (piece, extent) in extents.iter().enumerate() {
        let first = [0, 2, 4].map(|low| (i64::from(extent.0[low]) - i64::from(whole.0[low])) as usize);
        // A flat piece counts one layer of cells, which the whole, if not flat, has elsewhere.
        if cells && (0..3).any(|axis| extent.dimensions()[axis] == 1 && whole.dimensions()[axis] > 1) {
            continue;
        }
        let [nx, ny, nz] = dimensions(extent);
        let mut tuple = 0;
        for z in first[2]..first[2] + nz {
            for y in first[1]..first[1] + ny {
                let row = (z * whole_y + y) * whole_x + first[0];
                for (step, slot) in sources[row..row + nx].iter_mut().enumerate() {
                    *slot = (piece as u32, tuple + step as u32);
                }
                tuple += nx as u32;
            }
        }
    }
    match sources.iter().filter(|&&source| source == NOWHERE).count() {
        0 => Ok(sources),
        missing => Err(gap(wanted - missing)),
    }
}

fn merge_coordinates(pieces: &[DataSet], extents: &[Extent], whole: Extent) -> Result<[DataArray; 3], Fault> {
    let merged = |axis: usize| {
        let along = |extent: &Extent| {
            let mut line = [0; 6];
            line[..2].copy_from_slice(&extent.0[2 * axis..2 * axis + 2]);
            Extent(line)
        };
        let lines: Vec<Extent> = extents.iter().map(along).collect();
        let sources = grid_sources(&lines, along(&whole), false)?;
        let lists = pieces.iter().map(|piece| match &piece.geometry {
            Geometry::RectilinearGrid { coordinates, .. } => Some(&coordinates[axis]),
            _ => None,
        });
        gather(lists, &sources)
    };
    Ok([merged(0)?, merged(1)?, merged(2)?])
}

fn gather_all<'a>(
    pieces: &'a [DataSet],
    attributes: impl Fn(&'a DataSet) -> &'a Attributes,
    sources: impl FnOnce() -> Result<Sources, Fault>,
) -> Result<Attributes, Fault> {
    let first = attributes(&pieces[0]);
    if first.arrays.is_empty() {
        return Ok(first.clone());
    }
    let sources = sources()?;
    let arrays = first.arrays.iter().map(|array| {
        gather(pieces.iter().map(|piece| attributes(piece).array(&array.name)), &sources)
    });
    Ok(Attributes { arrays: arrays.collect::<Result<_, _>>()?, active: first.active.clone() })
}

/// One array out of the arrays of all pieces.
fn gather<'a>(parts: impl Iterator<Item = Option<&'a DataArray>>, sources: &Sources) -> Result<DataArray, Fault> {
    let mut list: Vec<&DataArray> = Vec::new();
    for (piece, part) in parts.enumerate() {
        let fits = |part: &&DataArray| {
            list.first().is_none_or(|first| {
                first.components == part.components && first.data.value_type() == part.data.value_type()
            })
        };
        match part.filter(fits) {
            Some(part) => list.push(part),
            None => {
                let name = list.first().map_or("", |first| &first.name);
                let found = format!("no array {} of that type in piece {piece}", quoted(name));
                return Err(Fault::new(Place::File, found, "the arrays of the first piece in every piece"));
            }
        }
    }
    let Some(first) = list.first() else {
        return Err(Fault::new(Place::File, "no piece", "one"));
    };
    let components = first.components;
    let mut data = first.data.value_type().empty();
    macro_rules! fill {
        ($($variant:ident),*) => {
            match &mut data {
                $(ArrayData::$variant(values) => {
                    values.reserve(sources.len() * components);
                    for &(piece, tuple) in sources {
                        if let ArrayData::$variant(part) = &list[piece as usize].data {
                            let start = tuple as usize * components;
                            values.extend_from_slice(&part[start..start + components]);
                        }
                    }
                })*
            }
        };
    }
    fill!(I8, U8, I16, U16, I32, U32, I64, U64, F32, F64, Bit, String);
    debug_assert_eq!(with_values!(&data, values => values.len()), sources.len() * components);
    let mut whole = DataArray { data, ..DataArray::new(first.name.clone(), components, ArrayData::Bit(Vec::new())) };
    whole.component_names.clone_from(&first.component_names);
    whole.id_type = first.id_type;
    // Ranges that VTK caches hold for one piece, not for the whole.
    whole.information = first.information.iter().filter(|key| !key.name.ends_with("_RANGE")).cloned().collect();
    Ok(whole)
}
