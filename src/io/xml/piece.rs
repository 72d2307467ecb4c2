//! The pieces of an XML file, each read as a data set of its own.

use roxmltree::Node;

use crate::io::array::{ArrayData, DataArray, ValueType};
use crate::io::cells::{check_offsets, check_points, indices};
use crate::io::dataset::{Attributes, CellArray, DataSet, Extent, Geometry, IndexWidth, Polyhedra, Role};
use crate::io::error::{Fault, Place, quoted};

use super::document::{Context, Parts, Source};
use super::merge::merge;
use super::payload::read_array;

const KINDS: &str = "ImageData, RectilinearGrid, StructuredGrid, PolyData or UnstructuredGrid in one file";

/// Reads an XML file.
///
/// # Arguments
/// * `head`: the whole file, or as much as reaches into its appended raw data.
/// * `source`: the whole file.
pub(in crate::io) fn read(head: &[u8], source: Source<'_>) -> Result<DataSet, Fault> {
    let parts = Parts::cut(head, source)?;
    let document = parts.parse()?;
    let root = document.root_element();
    if !root.has_tag_name("VTKFile") {
        let found = format!("an XML file of <{}>", root.tag_name().name());
        return Err(Fault::unsupported(Place::Line(1), found, "<VTKFile>"));
    }
    let context = Context::new(&parts, root)?;
    let kind = root.attribute("type").unwrap_or_default();
    if !["ImageData", "RectilinearGrid", "StructuredGrid", "PolyData", "UnstructuredGrid"].contains(&kind) {
        return Err(Fault::unsupported(context.place(root), format!("type={}", quoted(kind)), KINDS));
    }
    let Some(grid) = child(root, kind) else {
        return Err(Fault::new(context.place(root), format!("no <{kind}>"), "one, as the type says"));
    };
    let mut pieces = Vec::new();
    for node in grid.children().filter(|node| node.has_tag_name("Piece")) {
        pieces.push(read_piece(&context, kind, grid, node).map_err(|fault| fault.or_at(context.place(node)))?);
    }
    if pieces.is_empty() {
        pieces.push(read_piece(&context, kind, grid, grid)?);
    }
    let mut dataset = merge(pieces).map_err(|fault| fault.or_at(context.place(grid)))?;
    dataset.version = Some(context.version);
    if let Some(field_data) = child(grid, "FieldData").or_else(|| child(root, "FieldData")) {
        dataset.field_data = arrays(field_data).map(|node| read_array(&context, node, None)).collect::<Result<_, _>>()?;
    }
    Ok(dataset)
}

fn child<'a, 'd>(node: Node<'a, 'd>, name: &str) -> Option<Node<'a, 'd>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn arrays<'a, 'd>(node: Node<'a, 'd>) -> impl Iterator<Item = Node<'a, 'd>> {
    node.children().filter(|child| child.has_tag_name("DataArray") || child.has_tag_name("Array"))
}

fn read_piece(context: &Context<'_>, kind: &str, grid: Node<'_, '_>, node: Node<'_, '_>) -> Result<DataSet, Fault> {
    let count = |name: &str| Ok::<_, Fault>(context.number::<usize>(node, name)?.unwrap_or(0));
    let extent = || {
        let own = context.numbers(node, "Extent")?;
        Ok::<_, Fault>(Extent(own.or(context.numbers(grid, "WholeExtent")?).unwrap_or([0, -1, 0, -1, 0, -1])))
    };
    let geometry = match kind {
        "ImageData" => Geometry::ImageData {
            extent: extent()?,
            origin: context.numbers(grid, "Origin")?.unwrap_or([0.0; 3]),
            spacing: context.numbers(grid, "Spacing")?.unwrap_or([1.0; 3]),
            direction: context.numbers(grid, "Direction")?.unwrap_or([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]),
        },
        "RectilinearGrid" => {
            let extent = extent()?;
            Geometry::RectilinearGrid { extent, coordinates: Box::new(coordinates(context, node, extent)?) }
        }
        "StructuredGrid" => {
            let extent = extent()?;
            Geometry::StructuredGrid { extent, points: points(context, node, extent.point_count())? }
        }
        "PolyData" => {
            let point_count = count("NumberOfPoints")?;
            let part = |name: &str| -> Result<CellArray, Fault> {
                match child(node, name) {
                    Some(part) => cells(context, part, count(&format!("NumberOf{name}"))?, point_count),
                    None => Ok(CellArray::default()),
                }
            };
            Geometry::PolyData {
                points: points(context, node, point_count)?,
                verts: part("Verts")?,
                lines: part("Lines")?,
                polys: part("Polys")?,
                strips: part("Strips")?,
            }
        }
        _ => {
            let (point_count, cell_count) = (count("NumberOfPoints")?, count("NumberOfCells")?);
            unstructured(context, node, point_count, cell_count)?
        }
    };
    let mut dataset = DataSet::new(geometry);
    dataset.point_data = attributes(context, child(node, "PointData"), dataset.point_count())?;
    dataset.cell_data = attributes(context, child(node, "CellData"), dataset.cell_count())?;
    Ok(dataset)
}

fn attributes(context: &Context<'_>, node: Option<Node<'_, '_>>, tuples: usize) -> Result<Attributes, Fault> {
    let Some(node) = node else { return Ok(Attributes::default()) };
    Ok(Attributes {
        arrays: arrays(node).map(|array| read_array(context, array, Some(tuples))).collect::<Result<_, _>>()?,
        active: node
            .attributes()
            .filter_map(|attribute| Some((Role::of_name(attribute.name())?, attribute.value().to_owned())))
            .collect(),
    })
}

/// The positions of a piece; a piece without points may leave them out.
fn points(context: &Context<'_>, node: Node<'_, '_>, count: usize) -> Result<DataArray, Fault> {
    let Some(array) = child(node, "Points").and_then(|points| arrays(points).next()) else {
        if count == 0 {
            return Ok(DataArray::new("Points", 3, ArrayData::F32(Vec::new())));
        }
        return Err(Fault::new(context.place(node), format!("{count} points without positions"), "<Points>"));
    };
    let points = read_array(context, array, Some(count))?;
    if points.components != 3 || points.data.value_type() == ValueType::String {
        let found = format!("points of {} x {}", points.components, points.data.value_type().xml_name());
        return Err(Fault::new(context.place(array), found, "three numbers a point"));
    }
    Ok(points)
}

fn coordinates(context: &Context<'_>, node: Node<'_, '_>, extent: Extent) -> Result<[DataArray; 3], Fault> {
    let place = context.place(node);
    let list = child(node, "Coordinates");
    let dimensions = extent.dimensions();
    let mut lists = list.into_iter().flat_map(arrays);
    let mut next = |axis: usize| match lists.next() {
        Some(array) => {
            let coordinates = read_array(context, array, Some(dimensions[axis]))?;
            if coordinates.components != 1 || coordinates.data.value_type() == ValueType::String {
                return Err(Fault::new(context.place(array), "coordinates that are not one number each", "one number"));
            }
            Ok(coordinates)
        }
        None if dimensions[axis] == 0 => Ok(DataArray::new("", 1, ArrayData::F64(Vec::new()))),
        None => Err(Fault::new(place, "too few coordinate arrays", "<Coordinates> with three arrays")),
    };
    Ok([next(0)?, next(1)?, next(2)?])
}

/// The array of a name inside an element.
fn named<'a, 'd>(node: Node<'a, 'd>, name: &str) -> Option<Node<'a, 'd>> {
    arrays(node).find(|array| array.attribute("Name") == Some(name))
}

/// Integers of an array inside an element, with the width in which they are stored.
fn integers(
    context: &Context<'_>,
    node: Node<'_, '_>,
    name: &str,
    count: Option<usize>,
) -> Result<(Vec<i64>, IndexWidth), Fault> {
    let Some(array) = named(node, name) else {
        if count == Some(0) {
            return Ok((Vec::new(), IndexWidth::default()));
        }
        return Err(Fault::new(context.place(node), format!("no array {}", quoted(name)), "one"));
    };
    indices(read_array(context, array, count)?).map_err(|fault| fault.or_at(context.place(array)))
}

fn cells(context: &Context<'_>, node: Node<'_, '_>, count: usize, points: usize) -> Result<CellArray, Fault> {
    lists(context, node, ["offsets", "connectivity"], count, points)
}

/// Lists stored as ends and members.
fn lists(
    context: &Context<'_>,
    node: Node<'_, '_>,
    [ends, members]: [&str; 2],
    count: usize,
    bound: usize,
) -> Result<CellArray, Fault> {
    let (ends, _) = integers(context, node, ends, Some(count))?;
    let mut offsets = Vec::with_capacity(ends.len() + 1);
    offsets.push(0);
    offsets.extend(ends);
    let place = context.place(node);
    check_offsets(&offsets, None).map_err(|fault| fault.or_at(place))?;
    let last = offsets.last().map_or(0, |&last| last as usize);
    let (connectivity, width) = integers(context, node, members, Some(last))?;
    let cells = CellArray { offsets, connectivity, width };
    check_points(&cells, bound).map_err(|fault| fault.or_at(place))?;
    Ok(cells)
}

fn unstructured(context: &Context<'_>, node: Node<'_, '_>, point_count: usize, cell_count: usize) -> Result<Geometry, Fault> {
    let points = points(context, node, point_count)?;
    let Some(list) = child(node, "Cells") else {
        if cell_count == 0 {
            return Ok(Geometry::UnstructuredGrid { points, cells: CellArray::default(), types: Vec::new(), polyhedra: None });
        }
        return Err(Fault::new(context.place(node), format!("{cell_count} cells without <Cells>"), "<Cells>"));
    };
    let cells = cells(context, list, cell_count, point_count)?;
    let (numbers, _) = integers(context, list, "types", Some(cell_count))?;
    let types = numbers
        .iter()
        .enumerate()
        .map(|(cell, &number)| {
            u8::try_from(number)
                .map_err(|_| Fault::new(context.place(list), format!("type {number} of cell {cell}"), "0 to 255"))
        })
        .collect::<Result<_, _>>()?;
    let polyhedra = polyhedra(context, list, cell_count, point_count)?;
    Ok(Geometry::UnstructuredGrid { points, cells, types, polyhedra })
}

fn polyhedra(context: &Context<'_>, list: Node<'_, '_>, cells: usize, points: usize) -> Result<Option<Polyhedra>, Fault> {
    let length = |array: Node<'_, '_>| Ok::<_, Fault>(read_array(context, array, None)?.data.len());
    if let (Some(_), Some(ends)) = (named(list, "polyhedron_to_faces"), named(list, "face_offsets")) {
        let faces = lists(context, list, ["face_offsets", "face_connectivity"], length(ends)?, points)?;
        let cells = lists(context, list, ["polyhedron_offsets", "polyhedron_to_faces"], cells, faces.len())?;
        return Ok((!cells.connectivity.is_empty()).then_some(Polyhedra::Lists { faces, cells }));
    }
    if let (Some(array), Some(_)) = (named(list, "faces"), named(list, "faceoffsets")) {
        let (faces, width) = integers(context, list, "faces", Some(length(array)?))?;
        if faces.is_empty() {
            return Ok(None);
        }
        let (offsets, _) = integers(context, list, "faceoffsets", Some(cells))?;
        let stream = Polyhedra::Stream { faces, offsets, width };
        stream.check(points).map_err(|fault| fault.or_at(context.place(list)))?;
        return Ok(Some(stream));
    }
    Ok(None)
}
