//! Images, rectilinear and structured grids.

use crate::io::array::{ArrayData, DataArray};
use crate::io::dataset::{Attributes, DataSet, Extent, Geometry};
use crate::io::error::{Fault, Place};

use super::arrays::{attributes, components, field_data};
use super::steps::Step;
use super::store::{Node, Stored};

/// An image; the values of steps stand along a first axis of the arrays.
pub(super) fn image(node: &Node, step: Option<&Step>) -> Result<DataSet, Fault> {
    let extent = node.integers::<6>("WholeExtent")?.ok_or_else(|| missing(node, "WholeExtent"))?;
    let extent = Extent(whole(extent, node)?);
    let origin = node.numbers::<3>("Origin")?.ok_or_else(|| missing(node, "Origin"))?;
    let spacing = node.numbers::<3>("Spacing")?.ok_or_else(|| missing(node, "Spacing"))?;
    let direction = node.numbers::<9>("Direction")?.unwrap_or([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    filled(node, step, Geometry::ImageData { extent, origin, spacing, direction })
}

/// A grid with a list of coordinates for each axis.
pub(super) fn rectilinear(node: &Node) -> Result<DataSet, Fault> {
    let extent = dimensions(node)?;
    let list = |axis: usize| {
        let name = ["XCoordinates", "YCoordinates", "ZCoordinates"][axis];
        let stored = node.needed(name)?;
        let data = numbers(&stored)?;
        let expected = extent.dimensions()[axis];
        match data.len() == expected {
            true => Ok(DataArray::new(name, 1, data)),
            false => Err(Fault::new(Place::File, format!("{} numbers in {}", data.len(), stored.path), format!("{expected}"))),
        }
    };
    let coordinates = Box::new([list(0)?, list(1)?, list(2)?]);
    filled(node, None, Geometry::RectilinearGrid { extent, coordinates })
}

/// A grid with a position for each point.
pub(super) fn structured(node: &Node) -> Result<DataSet, Fault> {
    let extent = dimensions(node)?;
    let stored = node.needed("Points")?;
    let data = numbers(&stored)?;
    if extent.point_count().checked_mul(3) != Some(data.len()) {
        let found = format!("{} numbers in {}", data.len(), stored.path);
        return Err(Fault::new(Place::File, found, format!("3 for each of {} points", extent.point_count())));
    }
    filled(node, None, Geometry::StructuredGrid { extent, points: DataArray::new("Points", 3, data) })
}

/// Values that are numbers.
fn numbers(stored: &Stored) -> Result<ArrayData, Fault> {
    match stored.all()? {
        ArrayData::String(_) => Err(Fault::new(Place::File, format!("texts in {}", stored.path), "numbers")),
        data => Ok(data),
    }
}

fn missing(node: &Node, name: &str) -> Fault {
    Fault::new(Place::File, format!("no attribute {name} of {}", node.path), "one")
}

fn whole<const N: usize>(numbers: [i64; N], node: &Node) -> Result<[i32; N], Fault> {
    let mut narrow = [0; N];
    for (narrow, number) in narrow.iter_mut().zip(numbers) {
        *narrow = i32::try_from(number).map_err(|_| {
            Fault::new(Place::File, format!("index {number} in the extent of {}", node.path), "numbers within 32 signed bits")
        })?;
    }
    Ok(narrow)
}

fn dimensions(node: &Node) -> Result<Extent, Fault> {
    let dimensions = node.integers::<3>("Dimensions")?.ok_or_else(|| missing(node, "Dimensions"))?;
    let dimensions = whole(dimensions, node)?;
    match dimensions.iter().all(|&count| count > 0) {
        true => Ok(Extent::of_dimensions(dimensions)),
        false => Ok(Extent([0, -1, 0, -1, 0, -1])),
    }
}

fn filled(node: &Node, step: Option<&Step>, geometry: Geometry) -> Result<DataSet, Fault> {
    let mut dataset = DataSet::new(geometry);
    let data = |name: &str, count: usize| -> Result<Attributes, Fault> {
        let group = node.child(&format!("{name}Data"))?;
        let starts = format!("{name}DataOffsets");
        attributes(group.as_ref(), |array, stored| {
            let start = match step {
                None => None,
                Some(step) => Some(step.number([&starts, array])?.unwrap_or(step.number)),
            };
            layers(stored, count as u64, start)
        })
    };
    dataset.point_data = data("Point", dataset.point_count())?;
    dataset.cell_data = data("Cell", dataset.cell_count())?;
    dataset.field_data = field_data(node, step)?;
    Ok(dataset)
}

/// The values of a grid with `count` places, or those of the step that begins at `start`. Flat axes may be left out of the shape.
fn layers(stored: &Stored, count: u64, start: Option<u64>) -> Result<(ArrayData, usize), Fault> {
    let (rows, values, rest) = match start {
        None => (0..stored.shape[0], stored.shape[0].saturating_mul(stored.row()), &stored.shape[..]),
        Some(start) => (start..start.saturating_add(1), stored.row(), &stored.shape[1..]),
    };
    let last = rest.last().copied().unwrap_or(1);
    let misfit = || {
        let found = format!("the axes {:?} of {}", stored.shape, stored.path);
        Err(Fault::new(Place::File, found, format!("{count} places, with their components along a last axis")))
    };
    if count == 0 {
        let is_tuple = rest.len() > 3 && last > 0;
        return match values == 0 {
            true => Ok((stored.rows(0..0)?, if is_tuple { components(stored, last)? } else { 1 })),
            false => misfit(),
        };
    }
    let width = values / count;
    if values % count != 0 || width == 0 || (width > 1 && width != last) {
        return misfit();
    }
    Ok((stored.rows(rows)?, components(stored, width)?))
}
