//! Poly data and unstructured grids, part by part.

use crate::io::array::DataArray;
use crate::io::cells::{check_offsets, check_points, indices};
use crate::io::dataset::{Attributes, CellArray, DataSet, Geometry};
use crate::io::error::{Fault, Place};
use crate::io::parallel::joined;

use super::arrays::{attributes, field_data, rows, tuples};
use super::polyhedra::Faces;
use super::steps::{Step, counts};
use super::store::{Node, Stored};

/// The groups of poly data, in the order in which VTK counts cells.
pub(super) const KINDS: [&str; 4] = ["Vertices", "Lines", "Polygons", "Strips"];

/// Lists of point numbers in a group, and how they are divided among parts.
struct Lists {
    connectivity: Stored,
    offsets: Stored,
    cells: Vec<u64>,
    members: Vec<u64>,
    /// Where the next part begins in `offsets`, in `connectivity`.
    next: [u64; 2],
}

impl Lists {
    /// # Arguments
    /// * `parts`: the numbers of the parts that are read; `column`: that of these lists in arrays that name all kinds.
    fn open(node: &Node, step: Option<&Step>, parts: &std::ops::Range<u64>, (column, columns): (usize, usize)) -> Result<Self, Fault> {
        let start = |name: &str| match step {
            None => Ok::<_, Fault>(0),
            Some(step) => Ok(step.numbers([name, ""], columns)?.map_or(0, |starts| starts[column])),
        };
        let of_parts = |name: &str| part_counts(node, name, parts);
        let cells = start("CellOffsets")?;
        Ok(Self {
            connectivity: node.needed("Connectivity")?,
            offsets: node.needed("Offsets")?,
            cells: of_parts("NumberOfCells")?,
            members: of_parts("NumberOfConnectivityIds")?,
            // Every part before has one offset more than cells.
            next: [cells.saturating_add(parts.start), start("ConnectivityIdOffsets")?],
        })
    }

    /// The lists of a part; parts are asked for in turn.
    fn part(&mut self, part: usize, points: u64) -> Result<CellArray, Fault> {
        let (cells, members) = (self.cells[part], self.members[part]);
        let ends = [self.next[0].saturating_add(cells).saturating_add(1), self.next[1].saturating_add(members)];
        let offsets = self.offsets.integers(self.next[0]..ends[0])?;
        let connectivity = DataArray::new("Connectivity", 1, self.connectivity.rows(self.next[1]..ends[1])?);
        self.next = ends;
        let (connectivity, width) = indices(connectivity).map_err(|fault| at(fault, &self.connectivity.path))?;
        check_offsets(&offsets, usize::try_from(members).ok()).map_err(|fault| at(fault, &self.offsets.path))?;
        let cells = CellArray { offsets, connectivity, width };
        check_points(&cells, usize::try_from(points).unwrap_or(usize::MAX)).map_err(|fault| at(fault, &self.connectivity.path))?;
        Ok(cells)
    }
}

/// A fault with the array that it was found in.
pub(super) fn at(fault: Fault, path: &str) -> Fault {
    Fault { found: format!("{} in {path}", fault.found), ..fault }
}

/// How many there are of something in some of the parts.
fn part_counts(node: &Node, name: &str, parts: &std::ops::Range<u64>) -> Result<Vec<u64>, Fault> {
    let stored = node.needed(name)?;
    counts(&stored.integers(parts.clone())?, &stored.path)
}

/// The parts of a data set, or of one of its steps.
struct Parts {
    range: std::ops::Range<u64>,
    points: Vec<u64>,
    /// Where the first part begins.
    first_point: u64,
    first_cell: u64,
}

impl Parts {
    fn of(node: &Node, step: Option<&Step>, kinds: usize) -> Result<Self, Fault> {
        let all = node.needed("NumberOfPoints")?.shape[0];
        let (mut range, mut first_point, mut first_cell) = (0..all, 0, 0);
        if let Some(step) = step {
            let start = step.number(["PartOffsets", ""])?.unwrap_or(0);
            let count = step.number(["NumberOfParts", ""])?.unwrap_or(all / step.count);
            range = start..start.saturating_add(count);
            first_point = step.number(["PointOffsets", ""])?.unwrap_or(0);
            let cells = step.numbers(["CellOffsets", ""], kinds)?.unwrap_or_default();
            first_cell = cells.iter().take(kinds).fold(0, |sum: u64, &cells| sum.saturating_add(cells));
        }
        let points = part_counts(node, "NumberOfPoints", &range)?;
        Ok(Self { range, points, first_point, first_cell })
    }
}

/// Where the next part begins in the arrays of a group, by array.
struct Window<'a> {
    group: Option<Node>,
    /// The group of the steps that says where each array begins.
    starts: &'static str,
    step: Option<&'a Step>,
    /// Where an array begins of which nothing is said.
    first: u64,
    /// Tuples of the parts that were read.
    passed: u64,
}

impl Window<'_> {
    fn part(&mut self, count: u64) -> Result<Attributes, Fault> {
        let read = |name: &str, stored: &Stored| {
            let own = match self.step {
                None => None,
                Some(step) => step.number([self.starts, name])?,
            };
            let start = own.unwrap_or(self.first).saturating_add(self.passed);
            rows(stored, start..start.saturating_add(count))
        };
        let attributes = attributes(self.group.as_ref(), read)?;
        self.passed = self.passed.saturating_add(count);
        Ok(attributes)
    }
}

/// Vertices, lines, polygons and strips.
pub(super) fn poly_data(node: &Node, step: Option<&Step>) -> Result<DataSet, Fault> {
    let parts = Parts::of(node, step, KINDS.len())?;
    let mut lists = Vec::new();
    for (column, name) in KINDS.iter().enumerate() {
        // A kind that no cell is of may be left out.
        if let Some(group) = node.child(name)? {
            lists.push((column, Lists::open(&group, step, &parts.range, (column, KINDS.len()))?));
        }
    }
    read_parts(node, step, &parts, |part, points, positions| {
        let mut cells: [CellArray; 4] = Default::default();
        for (column, list) in &mut lists {
            cells[*column] = list.part(part, points)?;
        }
        let [verts, lines, polys, strips] = cells;
        Ok(Geometry::PolyData { points: positions, verts, lines, polys, strips })
    })
}

/// Cells of any kind.
pub(super) fn unstructured(node: &Node, step: Option<&Step>) -> Result<DataSet, Fault> {
    let parts = Parts::of(node, step, 1)?;
    let mut lists = Lists::open(node, step, &parts.range, (0, 1))?;
    let types = node.needed("Types")?;
    let (mut next, mut all_types) = (parts.first_cell, Vec::new());
    for &count in &lists.cells {
        let end = next.saturating_add(count);
        let numbers = types.integers(next..end)?;
        let types = numbers.iter().map(|&number| u8::try_from(number));
        let types: Result<Vec<u8>, _> = types.collect();
        all_types.push(types.map_err(|_| Fault::new(Place::File, format!("a number above 255 or below 0 in {}", types_path(node)), "types of cells"))?);
        next = end;
    }
    let mut faces = Faces::open(node, step, &parts.range, &all_types)?;
    read_parts(node, step, &parts, |part, points, positions| {
        let cells = lists.part(part, points)?;
        let types = std::mem::take(&mut all_types[part]);
        let polyhedra = match &mut faces {
            Some(faces) => faces.part(part, cells.len() as u64, points)?,
            None => None,
        };
        Ok(Geometry::UnstructuredGrid { points: positions, cells, types, polyhedra })
    })
}

fn types_path(node: &Node) -> String {
    format!("{}/Types", node.path)
}

/// Reads every part and puts them together.
///
/// # Arguments
/// * `geometry`: the cells of a part, from its number, its number of points, and their positions.
fn read_parts(
    node: &Node,
    step: Option<&Step>,
    parts: &Parts,
    mut geometry: impl FnMut(usize, u64, DataArray) -> Result<Geometry, Fault>,
) -> Result<DataSet, Fault> {
    let positions = node.needed("Points")?;
    let window = |name: &'static str, starts: &'static str, first: u64| {
        Ok::<_, Fault>(Window { group: node.child(name)?, starts, step, first, passed: 0 })
    };
    let mut point_data = window("PointData", "PointDataOffsets", parts.first_point)?;
    let mut cell_data = window("CellData", "CellDataOffsets", parts.first_cell)?;
    let mut start = parts.first_point;
    let mut pieces = Vec::new();
    for (part, &count) in parts.points.iter().enumerate() {
        let end = start.saturating_add(count);
        let points = DataArray::new("Points", 3, tuples(&positions, start..end, 3)?);
        start = end;
        let mut piece = DataSet::new(geometry(part, count, points)?);
        piece.point_data = point_data.part(count)?;
        piece.cell_data = cell_data.part(piece.cell_count() as u64)?;
        // Empty parts say nothing but the types of the arrays, for which one is enough.
        if count > 0 || pieces.is_empty() {
            pieces.push(piece);
        }
    }
    if pieces.is_empty() {
        return Err(Fault::new(Place::File, format!("no part in {}", node.path), "at least one, which may be empty"));
    }
    Ok(DataSet { field_data: field_data(node, step)?, ..joined(pieces)? })
}
