//! Given colours: at points, along curves, or the pixels of an image.

use std::collections::BTreeMap;
use std::path::Path;

use morsmooth::field::VertexId;
use morsmooth::io::{ArrayData, DataSet, Table, read};
use serde_json::Value;

use crate::common::input::FieldInput;
use crate::common::shape_input::{Locator, distance};
use crate::common::spot::{Spot, SpotColumns, beside, cell_fault, column};
use crate::failure::Failure;

/// Red, green and blue, 0 to 1.
pub type Colour = [f64; 3];

/// A place with a colour; several of one curve are joined.
struct Dab {
    place: String,
    curve: Option<String>,
    spot: Spot,
    colour: Colour,
}

/// The colours of a file, at vertices of the domain, by rising vertex.
pub fn given(path: &Path, input: &FieldInput) -> Result<Vec<(VertexId, Colour)>, Failure> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_ascii_lowercase();
    let dabs = match extension.as_str() {
        "png" => return pixels(path, input),
        "json" => json_dabs(path)?,
        _ => table_dabs(path)?,
    };
    let mut painted = Painted { path, input, colours: BTreeMap::new() };
    let locator = Locator::new(&input.domain.complex);
    let mut before: Option<(&Dab, [f64; 3])> = None;
    for dab in &dabs {
        let (vertex, position) = dab.spot.vertex((path, &dab.place), input, &locator)?;
        let last = before.filter(|(last, _)| dab.curve.is_some() && last.curve == dab.curve);
        match last {
            None => painted.set(vertex, dab.colour, &dab.place)?,
            Some((last, from)) => {
                let whole = distance(from, position);
                for vertex in locator.along(from, position).map_err(|far| beside((path, &dab.place), input, position, far))? {
                    let at = input.domain.complex.point(vertex);
                    let along: f64 = (0..3).map(|axis| (at[axis] - from[axis]) * (position[axis] - from[axis])).sum();
                    let part = if whole > 0.0 { (along / (whole * whole)).clamp(0.0, 1.0) } else { 1.0 };
                    // Written so that equal ends give the same bits in between.
                    let colour = [0, 1, 2].map(|channel| last.colour[channel] + part * (dab.colour[channel] - last.colour[channel]));
                    painted.colours.entry(vertex).or_insert_with(|| (colour, dab.place.clone()));
                }
                painted.colours.insert(vertex, (dab.colour, dab.place.clone()));
            }
        }
        before = Some((dab, position));
    }
    if painted.colours.is_empty() {
        return Err(Failure::file(path, "found no colour; expected one a row"));
    }
    Ok(painted.colours.into_iter().map(|(vertex, (colour, _))| (vertex, colour)).collect())
}

struct Painted<'a> {
    path: &'a Path,
    input: &'a FieldInput,
    colours: BTreeMap<VertexId, (Colour, String)>,
}

impl Painted<'_> {
    fn set(&mut self, vertex: VertexId, colour: Colour, place: &str) -> Result<(), Failure> {
        if let Some((other, first)) = self.colours.get(&vertex)
            && *other != colour
        {
            let point = self.input.domain.point_of_vertex()[vertex.index()];
            let text = format!("{first} and {place} give point {point} the colours {} and {}; expected one colour a vertex", hex(*other), hex(colour));
            return Err(Failure::file(self.path, text).hint("a finer mesh (--max-edge) tells places apart that share a nearest vertex"));
        }
        self.colours.insert(vertex, (colour, place.to_owned()));
        Ok(())
    }
}

/// A colour as `#rrggbb`.
fn hex(colour: Colour) -> String {
    let [r, g, b] = morsmooth::plot::to_bytes(colour);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// `#rrggbb` or `#rgb`.
pub fn parse_colour(text: &str) -> Option<Colour> {
    let digits = text.trim().strip_prefix('#')?;
    let number = |part: Option<&str>| u8::from_str_radix(part?, 16).ok();
    let bytes = match digits.len() {
        6 => [0, 2, 4].map(|at| number(digits.get(at..at + 2))),
        3 => [0, 1, 2].map(|at| number(digits.get(at..at + 1)).map(|half| 17 * half)),
        _ => return None,
    };
    match bytes {
        [Some(r), Some(g), Some(b)] => Some([r, g, b].map(|byte| f64::from(byte) / 255.0)),
        _ => None,
    }
}

fn table_dabs(path: &Path) -> Result<Vec<Dab>, Failure> {
    let told = |error: morsmooth::io::IoError| Failure::usage(error.to_string());
    let table = Table::read(path).map_err(told)?;
    let columns = SpotColumns::named(&table, &["point", "vertex"])?;
    let (curve, colour) = (column(&table, &["curve"]), column(&table, &["colour", "color"]));
    let channels = [["r", "red"], ["g", "green"], ["b", "blue"]].map(|names| column(&table, &names));
    if !columns.are_enough(2) || colour.is_none() && channels.contains(&None) {
        let found = table.names().join(", ");
        return Err(Failure::file(path, format!("found the columns {found}; expected x, y (or point) and colour (or r, g, b)")));
    }
    let dab = |row: usize| {
        let place = format!("line {}", table.line(row));
        let fault = |column: usize, expected: &str| cell_fault(path, &table, (row, column), expected);
        let colour = match (colour, channels) {
            (Some(column), _) => parse_colour(table.cell(row, column)).ok_or_else(|| fault(column, "a colour such as #ff8000"))?,
            (None, channels) => {
                let mut colour = [0.0; 3];
                for (channel, column) in channels.into_iter().flatten().enumerate() {
                    let byte = table.cell(row, column).replacen(',', ".", 1).parse::<f64>().ok().filter(|byte| (0.0..=255.0).contains(byte));
                    colour[channel] = byte.ok_or_else(|| fault(column, "a number from 0 to 255"))? / 255.0;
                }
                colour
            }
        };
        let spot = columns.spot(path, &table, row)?;
        let curve = curve.map(|column| table.cell(row, column).to_owned()).filter(|name| !name.is_empty());
        Ok(Dab { place, curve, spot, colour })
    };
    (0..table.len()).map(dab).collect()
}

/// A list of `{"point": 17 or [x, y], "colour": "#ff8000"}` and `{"curve": [[x, y], ...], "colours": ["#..", ...] or "colour": "#.."}`.
fn json_dabs(path: &Path) -> Result<Vec<Dab>, Failure> {
    let bytes = std::fs::read(path).map_err(|error| Failure::file(path, format!("cannot be read: {error}")))?;
    let root: Value = serde_json::from_slice(&bytes).map_err(|error| Failure::file(path, format!("is no JSON: {error}")))?;
    let list = root.as_array().ok_or_else(|| Failure::file(path, "found no list; expected [{\"point\": [x, y], \"colour\": \"#ff8000\"}, ...]"))?;
    let mut dabs = Vec::new();
    for (number, entry) in list.iter().enumerate() {
        let place = format!("entry {}", number + 1);
        let fault = |expected: &str| Failure::file(path, format!("{place}: found {entry}; expected {expected}"));
        let position = |value: &Value| -> Option<Spot> {
            let list = value.as_array()?;
            let mut at = [0.0; 3];
            for (axis, number) in list.iter().enumerate() {
                *at.get_mut(axis)? = number.as_f64()?;
            }
            (list.len() >= 2).then_some(Spot::Position(at))
        };
        let colour = |value: &Value| value.as_str().and_then(parse_colour);
        let one = [&entry["colour"], &entry["color"]].into_iter().find_map(colour);
        if let Some(places) = entry["curve"].as_array() {
            let several = [&entry["colours"], &entry["colors"]].into_iter().find_map(Value::as_array);
            for (at, value) in places.iter().enumerate() {
                let own = several.and_then(|colours| colours.get(at)).and_then(colour).or(one);
                let (Some(spot), Some(colour)) = (position(value), own) else {
                    return Err(fault("\"curve\": [[x, y], ...] with \"colour\", or with as many \"colours\" such as \"#ff8000\""));
                };
                dabs.push(Dab { place: place.clone(), curve: Some(place.clone()), spot, colour });
            }
            continue;
        }
        let spot = entry["point"].as_u64().map(Spot::Point).or_else(|| position(&entry["point"]));
        let (Some(spot), Some(colour)) = (spot, one) else {
            return Err(fault("\"point\": [x, y] or a point number, and \"colour\": \"#ff8000\""));
        };
        dabs.push(Dab { place, curve: None, spot, colour });
    }
    Ok(dabs)
}

/// Red, green, blue and alpha of every point of an image, 0 to 1.
pub fn image_colours(dataset: &DataSet) -> Option<Vec<[f64; 4]>> {
    let array = dataset.point_data.arrays.iter().find(|array| matches!(array.data, ArrayData::U8(_)) && (1..=4).contains(&array.components))?;
    let ArrayData::U8(bytes) = &array.data else { return None };
    let part = |byte: u8| f64::from(byte) / 255.0;
    let colour = |pixel: &[u8]| match *pixel {
        [grey] => [part(grey), part(grey), part(grey), 1.0],
        [grey, alpha] => [part(grey), part(grey), part(grey), part(alpha)],
        [r, g, b] => [part(r), part(g), part(b), 1.0],
        [r, g, b, alpha, ..] => [part(r), part(g), part(b), part(alpha)],
        [] => [0.0; 4],
    };
    Some(bytes.chunks_exact(array.components).map(colour).collect())
}

/// The pixels of an image that are not transparent, on an image of the same size.
fn pixels(path: &Path, input: &FieldInput) -> Result<Vec<(VertexId, Colour)>, Failure> {
    let dataset = read(path).map_err(|error| Failure::usage(error.to_string()))?;
    let colours = image_colours(&dataset).ok_or_else(|| Failure::file(path, "found no image of bytes; expected a PNG image"))?;
    if colours.len() != input.domain.point_count() {
        let text = format!("found {} pixels; expected {}, as many as {} has points", colours.len(), input.domain.point_count(), input.path.display());
        return Err(Failure::file(path, text));
    }
    let vertices = input.domain.vertex_of_point();
    let found: Vec<(VertexId, Colour)> = colours
        .iter()
        .zip(vertices)
        .filter(|(colour, _)| colour[3] > 0.0)
        .filter_map(|(&[r, g, b, _], vertex)| Some(((*vertex)?, [r, g, b])))
        .collect();
    match found.is_empty() {
        true => Err(Failure::file(path, "all pixels on the domain are transparent; expected opaque ones where colours are given")),
        false => Ok(found),
    }
}
