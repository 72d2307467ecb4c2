//! Arrays on points and cells, and fields.

use crate::io::array::{ArrayData, DataArray};
use crate::io::dataset::{Attributes, Role};
use crate::io::error::{Fault, quoted};

use crate::io::lexer::{Lexer, decoded};
use super::metadata;
use super::values::{LegacyType, values, words};

/// One array of known size, with its metadata.
pub(super) fn array(
    lexer: &mut Lexer<'_>,
    name: String,
    value_type: LegacyType,
    tuples: usize,
    components: usize,
) -> Result<DataArray, Fault> {
    if !(1..=1 << 20).contains(&components) {
        return Err(lexer.fault(format!("{components} components of array {}", quoted(&name)), "1 to 1048576"));
    }
    let Some(count) = tuples.checked_mul(components) else {
        return Err(lexer.fault(format!("{tuples} x {components} values"), "fewer values"));
    };
    let data = values(lexer, value_type, count).map_err(|mut fault| {
        fault.found = format!("{} in array {}", fault.found, quoted(&name));
        fault
    })?;
    let mut array = DataArray::new(name, components, data);
    array.id_type = value_type == LegacyType::Id;
    metadata::read(lexer, &mut array)?;
    Ok(array)
}

/// The arrays after `FIELD`: a name, a count, then `name components tuples type` with values each.
///
/// # Arguments
/// * `tuples`: what every array must have, or `None` for field data.
pub(super) fn field(lexer: &mut Lexer<'_>, tuples: Option<usize>) -> Result<Vec<DataArray>, Fault> {
    lexer.name()?;
    let count: usize = lexer.number("the number of arrays")?;
    let mut arrays = Vec::new();
    for _ in 0..count {
        let word = lexer.text("a name")?;
        // VTK writes this in the place of an array that it could not write.
        if word == "NULL_ARRAY" {
            continue;
        }
        let name = decoded(word);
        let components = lexer.number("the number of components")?;
        let own: usize = lexer.number("the number of tuples")?;
        if let Some(expected) = tuples.filter(|&expected| expected != own) {
            return Err(lexer.fault(format!("{own} tuples in array {}", quoted(&name)), format!("{expected}")));
        }
        let value_type = LegacyType::read(lexer)?;
        arrays.push(array(lexer, name, value_type, own, components)?);
    }
    Ok(arrays)
}

/// Reads what one keyword of `POINT_DATA` or `CELL_DATA` announces. `false`: it is no such keyword.
pub(super) fn attribute(
    lexer: &mut Lexer<'_>,
    keyword: &str,
    tuples: usize,
    attributes: &mut Attributes,
) -> Result<bool, Fault> {
    let (role, components) = match keyword {
        "FIELD" => {
            attributes.arrays.extend(field(lexer, Some(tuples))?);
            return Ok(true);
        }
        "LOOKUP_TABLE" => {
            // Colours for the scalars: VTK keeps them outside of the data, and XML files cannot hold them.
            lexer.name()?;
            let entries: usize = lexer.number("the number of colours")?;
            colours(lexer, entries.saturating_mul(4))?;
            return Ok(true);
        }
        "SCALARS" | "COLOR_SCALARS" => {
            let scalars = scalars(lexer, keyword, tuples)?;
            add(attributes, Role::Scalars, scalars);
            return Ok(true);
        }
        "TEXTURE_COORDINATES" => (Role::TCoords, None),
        "VECTORS" => (Role::Vectors, Some(3)),
        "NORMALS" => (Role::Normals, Some(3)),
        "TENSORS" => (Role::Tensors, Some(9)),
        "TENSORS6" => (Role::Tensors, Some(6)),
        "TANGENTS" => (Role::Tangents, Some(3)),
        "GLOBAL_IDS" => (Role::GlobalIds, Some(1)),
        "PEDIGREE_IDS" => (Role::PedigreeIds, Some(1)),
        "EDGE_FLAGS" => (Role::EdgeFlag, Some(1)),
        "RATIONAL_WEIGHTS" => (Role::RationalWeights, Some(1)),
        "HIGHER_ORDER_DEGREES" => (Role::HigherOrderDegrees, Some(3)),
        "PROCESS_IDS" => (Role::ProcessIds, Some(1)),
        _ => return Ok(false),
    };
    let name = lexer.name()?;
    let components = match components {
        Some(components) => components,
        None => lexer.number("the number of texture coordinates")?,
    };
    let value_type = LegacyType::read(lexer)?;
    let array = array(lexer, name, value_type, tuples, components)?;
    add(attributes, role, array);
    Ok(true)
}

/// The first array of a role stays active, as in VTK.
fn add(attributes: &mut Attributes, role: Role, array: DataArray) {
    if attributes.active(role).is_none() {
        attributes.active.push((role, array.name.clone()));
    }
    attributes.arrays.push(array);
}

fn scalars(lexer: &mut Lexer<'_>, keyword: &str, tuples: usize) -> Result<DataArray, Fault> {
    let name = lexer.name()?;
    if keyword == "COLOR_SCALARS" {
        let components: usize = lexer.number("the number of components")?;
        let data = colours(lexer, tuples.saturating_mul(components))?;
        let mut array = DataArray::new(name, components.max(1), ArrayData::U8(data));
        metadata::read(lexer, &mut array)?;
        return Ok(array);
    }
    let value_type = LegacyType::read(lexer)?;
    let components = match lexer.peek() {
        Some(word) if word.first().is_some_and(u8::is_ascii_digit) => lexer.number("the number of components")?,
        _ => 1,
    };
    if !lexer.accepts("LOOKUP_TABLE") {
        return Err(lexer.fault(format!("scalars {} without LOOKUP_TABLE", quoted(&name)), "LOOKUP_TABLE and its name"));
    }
    lexer.name()?;
    array(lexer, name, value_type, tuples, components)
}

/// Bytes that ascii files write as numbers from 0 to 1.
fn colours(lexer: &mut Lexer<'_>, count: usize) -> Result<Vec<u8>, Fault> {
    if lexer.binary {
        lexer.line();
        return lexer.take(count).map(<[u8]>::to_vec);
    }
    words(lexer, count, "a number from 0 to 1", |word| {
        word.parse::<f32>().ok().map(|share| (255.0 * share + 0.5) as u8)
    })
}
