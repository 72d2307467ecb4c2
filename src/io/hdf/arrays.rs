//! The arrays on points, on cells, and on the whole data set.

use std::ops::Range;

use crate::io::array::{ArrayData, DataArray};
use crate::io::dataset::{Attributes, Role};
use crate::io::error::{Fault, Place};

use super::steps::Step;
use super::store::{Node, Stored};

/// Attribute of an array that VTK takes for more than numbers.
pub(super) const ROLE: &str = "Attribute";
/// Attributes that VTK does not know and leaves alone: what it has no room for.
pub(super) const COMPONENT_NAMES: &str = "ComponentNames";
pub(super) const NUMBER_KIND: &str = "NumberKind";
pub(super) const KIND_BIT: &str = "Bit";
pub(super) const KIND_ID: &str = "IdType";

/// The arrays of a group, such as `PointData`.
///
/// # Arguments
/// * `read`: values of one array, and how many there are in a tuple.
pub(super) fn attributes(
    group: Option<&Node>,
    mut read: impl FnMut(&str, &Stored) -> Result<(ArrayData, usize), Fault>,
) -> Result<Attributes, Fault> {
    let mut attributes = Attributes::default();
    let Some(group) = group else { return Ok(attributes) };
    for name in group.names() {
        let stored = group.needed(name)?;
        let (data, components) = read(name, &stored)?;
        attributes.arrays.push(described(name, components, data, &stored));
        if let Some(role) = stored.attribute(ROLE).as_deref().and_then(role) {
            attributes.active.push((role, name.to_owned()));
        }
    }
    // Version 1.0 names the active arrays at the group.
    for role in Role::all() {
        if let Some(name) = group.text(role.name()).filter(|name| attributes.array(name).is_some() && attributes.active(role).is_none()) {
            attributes.active.push((role, name.to_owned()));
        }
    }
    Ok(attributes)
}

fn role(name: &str) -> Option<Role> {
    Role::all().find(|role| role.name().eq_ignore_ascii_case(name))
}

/// An array with what its attributes say.
fn described(name: &str, components: usize, data: ArrayData, stored: &Stored) -> DataArray {
    let kind = stored.attribute(NUMBER_KIND);
    let data = match data {
        ArrayData::U8(values) if kind.as_deref() == Some(KIND_BIT) => ArrayData::Bit(values.into_iter().map(|value| value != 0).collect()),
        other => other,
    };
    let id_type = kind.as_deref() == Some(KIND_ID) && matches!(data, ArrayData::I64(_) | ArrayData::I32(_));
    let component_names = Some(stored.texts(COMPONENT_NAMES)).filter(|names| names.len() == components).unwrap_or_default();
    DataArray { id_type, component_names, ..DataArray::new(name, components, data) }
}

/// Rows of an array that has one a point or cell.
pub(super) fn rows(stored: &Stored, range: Range<u64>) -> Result<(ArrayData, usize), Fault> {
    let components = components(stored, stored.row())?;
    if stored.shape.len() > 2 {
        let found = format!("the axes {:?} of {}", stored.shape, stored.path);
        return Err(Fault::new(Place::File, found, "one for the tuples and one for their components"));
    }
    Ok((stored.rows(range)?, components))
}

/// Rows with a certain number of components, such as positions.
pub(super) fn tuples(stored: &Stored, range: Range<u64>, components: u64) -> Result<ArrayData, Fault> {
    if stored.row() != components {
        let found = format!("{} numbers a row in {}", stored.row(), stored.path);
        return Err(Fault::new(Place::File, found, format!("{components}")));
    }
    stored.rows(range)
}

pub(super) fn components(stored: &Stored, components: u64) -> Result<usize, Fault> {
    const MOST: u64 = 1 << 20;
    match usize::try_from(components) {
        Ok(count) if (1..=MOST).contains(&components) => Ok(count),
        _ => Err(Fault::new(Place::File, format!("{components} components in {}", stored.path), format!("1 to {MOST}"))),
    }
}

/// The first components of every tuple.
fn first_components(array: DataArray, wanted: usize) -> DataArray {
    let kept: Vec<usize> = (0..array.data.len()).filter(|place| place % array.components < wanted).collect();
    let flat = DataArray { components: 1, ..array }.gathered(&kept);
    DataArray { components: wanted, component_names: Vec::new(), ..flat }
}

/// Where VTK's reader puts the time of a step.
const TIME: &str = "Time";

/// Arrays on the whole data set: of any length, or those of one step, with its time.
pub(super) fn field_data(node: &Node, step: Option<&Step>) -> Result<Vec<DataArray>, Fault> {
    let mut arrays = stored_field_data(node, step)?;
    let time = match step {
        Some(step) => step.time()?,
        None => None,
    };
    if let Some(time) = time.filter(|_| arrays.iter().all(|array| array.name != TIME)) {
        arrays.push(DataArray::new(TIME, 1, ArrayData::F64(vec![time])));
    }
    Ok(arrays)
}

fn stored_field_data(node: &Node, step: Option<&Step>) -> Result<Vec<DataArray>, Fault> {
    let Some(group) = node.child("FieldData")? else { return Ok(Vec::new()) };
    let mut arrays = Vec::new();
    for name in group.names() {
        let stored = group.needed(name)?;
        let (range, wanted) = match step {
            None => (0..stored.shape[0], None),
            Some(step) => {
                let start = step.number(["FieldDataOffsets", name])?.unwrap_or(step.number);
                // Components and tuples, in this order.
                let size = step.numbers(["FieldDataSizes", name], 2)?;
                let tuples = size.as_ref().map_or(1, |size| size[1]);
                (start..start.saturating_add(tuples), size.map(|size| size[0]))
            }
        };
        let (data, components) = rows(&stored, range)?;
        // A step may have fewer components than the array has room for.
        let array = described(name, components, data, &stored);
        arrays.push(match wanted.and_then(|wanted| usize::try_from(wanted).ok()).filter(|&wanted| wanted > 0 && wanted < components) {
            Some(wanted) => first_components(array, wanted),
            None => array,
        });
    }
    Ok(arrays)
}
