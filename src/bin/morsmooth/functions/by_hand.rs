//! Lists of wanted extrema: places, and values that are given, bounded or free.

use std::path::{Path, PathBuf};

use morsmooth::field::VertexId;
use morsmooth::io::Table;
use morsmooth::monotone::ValueRule;
use morsmooth::morse::{ExtremumKind, WantedExtrema};
use serde_json::Value;

use crate::common::input::FieldInput;
use crate::common::shape_input::Locator;
use crate::common::spot::{Spot, SpotColumns, cell_fault, column};
use crate::failure::Failure;

/// One wanted extremum.
#[derive(Debug, Clone)]
pub struct HandWish {
    /// Minimum or maximum.
    pub kind: ExtremumKind,
    /// Its vertex.
    pub vertex: VertexId,
    /// What is asked of its value.
    pub rule: ValueRule,
    /// The file it stands in.
    path: PathBuf,
    /// Its line or number there.
    place: String,
}

/// An entry of a list: its place in the file, where it is, and its value.
type Entry = (String, Spot, ValueRule);

impl HandWish {
    /// File and place, for messages.
    pub fn source(&self) -> String {
        format!("{}, {}", self.path.display(), self.place)
    }

    /// What it is and where, for messages.
    pub fn described(&self, input: &FieldInput) -> String {
        let kind = if self.kind == ExtremumKind::Minimum { "minimum" } else { "maximum" };
        format!("the {kind} at point {} ({})", input.domain.point_of_vertex()[self.vertex.index()], self.source())
    }
}

/// Reads both lists and refuses wishes that no function fulfils whatever its values.
pub fn wishes(minima: Option<&Path>, maxima: Option<&Path>, input: &FieldInput) -> Result<Vec<HandWish>, Failure> {
    let mut wishes = Vec::new();
    for (path, kind) in [(minima, ExtremumKind::Minimum), (maxima, ExtremumKind::Maximum)] {
        let Some(path) = path else { continue };
        let entries = entries(path, kind)?;
        let locator = Locator::new(&input.domain.complex);
        if entries.is_empty() {
            return Err(Failure::file(path, "found no extremum; expected one a line"));
        }
        for (place, spot, rule) in entries {
            let (vertex, _) = spot.vertex((path, &place), input, &locator)?;
            wishes.push(HandWish { kind, vertex, rule, path: path.to_owned(), place });
        }
    }
    if wishes.is_empty() {
        return Err(Failure::usage("found no wanted extrema; expected --minima FILE and --maxima FILE"));
    }
    wishes.sort_by_key(|wish| wish.vertex);
    if let Some(pair) = wishes.windows(2).find(|pair| pair[0].vertex == pair[1].vertex) {
        let text = format!("{} and {} are one vertex; expected each extremum once", pair[0].described(input), pair[1].described(input));
        return Err(Failure::file(&input.path, text));
    }
    let complex = &input.domain.complex;
    for wish in &wishes {
        let beside = complex.neighbours(wish.vertex).iter().filter_map(|&neighbour| {
            wishes.binary_search_by_key(&neighbour, |other| other.vertex).ok().map(|place| &wishes[place])
        });
        if let Some(other) = beside.into_iter().find(|other| other.kind == wish.kind) {
            let text = format!(
                "{} and {} are neighbours, so that one of them is lower; expected extrema of a kind apart by two edges at least",
                wish.described(input),
                other.described(input)
            );
            return Err(Failure::file(&input.path, text));
        }
    }
    Ok(wishes)
}

/// The wishes as the library takes them.
pub fn wanted(wishes: &[HandWish], vertices: usize) -> (WantedExtrema, Vec<ValueRule>) {
    let of = |kind: ExtremumKind| wishes.iter().filter(|wish| wish.kind == kind).map(|wish| wish.vertex).collect();
    let mut rules = vec![ValueRule::Free; vertices];
    wishes.iter().for_each(|wish| rules[wish.vertex.index()] = wish.rule);
    (WantedExtrema { minima: of(ExtremumKind::Minimum), maxima: of(ExtremumKind::Maximum) }, rules)
}

fn entries(path: &Path, kind: ExtremumKind) -> Result<Vec<Entry>, Failure> {
    match path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
        true => json_entries(path, kind),
        false => table_entries(path),
    }
}

/// Rows: `point`, `point, value`, `x, y, value` or `x, y, z, value`; or columns by name.
fn table_entries(path: &Path) -> Result<Vec<Entry>, Failure> {
    let told = |error: morsmooth::io::IoError| Failure::usage(error.to_string());
    let table = Table::read_list(path).map_err(told)?;
    let (columns, value) = match (table.has_header(), table.width()) {
        (true, _) => (SpotColumns::named(&table, &["point", "vertex", "id"])?, column(&table, &["value"])),
        (false, width @ 1..=2) => (SpotColumns::new(&table, Some(0), Vec::new())?, (width > 1).then(|| width - 1)),
        (false, width @ 3..=4) => (SpotColumns::new(&table, None, (0..width - 1).collect())?, Some(width - 1)),
        (false, _) => (SpotColumns::new(&table, None, Vec::new())?, None),
    };
    if !columns.are_enough(1) {
        let found = table.names().join(", ");
        return Err(Failure::file(path, format!("found the columns {found}; expected point, value or x, y, z, value")));
    }
    let row = |row: usize| {
        let place = format!("line {}", table.line(row));
        let rule = match value {
            None => ValueRule::Free,
            Some(column) => rule(table.cell(row, column))
                .ok_or_else(|| cell_fault(path, &table, (row, column), "a value, an interval such as 0.2..0.5, or nothing"))?,
        };
        Ok((place, columns.spot(path, &table, row)?, rule))
    };
    (0..table.len()).map(row).collect()
}

/// `0.5`, `0.2..0.8`, or nothing.
fn rule(text: &str) -> Option<ValueRule> {
    // A comma is the decimal mark here: cells are not separated by it, or it would not be in one.
    let number = |text: &str| text.trim().replacen(',', ".", 1).parse::<f64>().ok().filter(|value| value.is_finite());
    match (text.trim(), text.split_once("..")) {
        ("" | "free", _) => Some(ValueRule::Free),
        (_, Some((low, high))) => interval(number(low)?, number(high)?),
        (text, None) => number(text).map(ValueRule::Exactly),
    }
}

fn interval(low: f64, high: f64) -> Option<ValueRule> {
    match low.partial_cmp(&high)? {
        std::cmp::Ordering::Less => Some(ValueRule::Within(low, high)),
        std::cmp::Ordering::Equal => Some(ValueRule::Exactly(low)),
        std::cmp::Ordering::Greater => None,
    }
}

/// A list of `{"point": 17, "value": 0.5}`, `{"position": [x, y, z], "value": [0.2, 0.8]}` or plain point numbers; or a report of
/// `morsmooth`, of which the wanted extrema of the kind count.
fn json_entries(path: &Path, kind: ExtremumKind) -> Result<Vec<Entry>, Failure> {
    let bytes = std::fs::read(path).map_err(|error| Failure::file(path, format!("cannot be read: {error}")))?;
    let root: Value = serde_json::from_slice(&bytes).map_err(|error| Failure::file(path, format!("is no JSON: {error}")))?;
    let key = if kind == ExtremumKind::Minimum { "minima" } else { "maxima" };
    let list = root.as_array().or_else(|| root[key].as_array()).or_else(|| root["wanted"][key].as_array());
    let list = list.ok_or_else(|| Failure::file(path, format!("found no list; expected [...] or {{\"{key}\": [...]}}")))?;
    let entry = |(number, entry): (usize, &Value)| {
        let place = format!("entry {}", number + 1);
        let fault = |expected: &str| Failure::file(path, format!("{place}: found {entry}; expected {expected}"));
        let point = [entry, &entry["point"], &entry["vertex"]].into_iter().find_map(Value::as_u64);
        let position = [&entry["position"], &entry["point"]].into_iter().find_map(Value::as_array);
        let spot = match (point, position) {
            (Some(point), _) => Spot::Point(point),
            (None, Some(list)) if (1..=3).contains(&list.len()) => {
                let mut at = [0.0; 3];
                for (axis, number) in list.iter().enumerate() {
                    at[axis] = number.as_f64().ok_or_else(|| fault("coordinates"))?;
                }
                Spot::Position(at)
            }
            _ => return Err(fault("\"point\": a point number, or \"position\": [x, y, z]")),
        };
        let rule = match &entry["value"] {
            Value::Null => Some(ValueRule::Free),
            Value::Number(value) => value.as_f64().map(ValueRule::Exactly),
            Value::String(text) => rule(text),
            Value::Array(ends) => match ends.as_slice() {
                [low, high] => low.as_f64().zip(high.as_f64()).and_then(|(low, high)| interval(low, high)),
                _ => None,
            },
            _ => None,
        };
        let rule = rule.ok_or_else(|| fault("\"value\": a number, [low, high] or null"))?;
        Ok((place, spot, rule))
    };
    list.iter().enumerate().map(entry).collect()
}
