//! JSON files with their places.

use super::error::{Fault, Place};

/// Two or three coordinates; the third is 0 where it is left out.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(try_from = "Vec<f64>")]
pub(super) struct Coordinates(pub [f64; 3]);

impl TryFrom<Vec<f64>> for Coordinates {
    type Error = String;

    fn try_from(parts: Vec<f64>) -> Result<Self, String> {
        match parts[..] {
            [x, y] => Ok(Self([x, y, 0.0])),
            [x, y, z] => Ok(Self([x, y, z])),
            _ => Err(format!("{} coordinates; expected 2 or 3", parts.len())),
        }
    }
}

/// The entries of an object in the order of the file, each name once.
#[derive(Debug, Clone)]
pub(super) struct Entries<T>(pub Vec<(String, T)>);

impl<'de, T: serde::Deserialize<'de>> serde::Deserialize<'de> for Entries<T> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Visitor(std::marker::PhantomData))
    }
}

struct Visitor<T>(std::marker::PhantomData<T>);

impl<'de, T: serde::Deserialize<'de>> serde::de::Visitor<'de> for Visitor<T> {
    type Value = Entries<T>;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("an object with an entry for each name")
    }

    fn visit_map<A: serde::de::MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut entries: Vec<(String, T)> = Vec::new();
        while let Some(name) = map.next_key::<String>()? {
            // The last of two entries would win silently.
            if entries.iter().any(|(other, _)| *other == name) {
                return Err(serde::de::Error::custom(format!("\"{name}\" for the second time; expected each name once")));
            }
            entries.push((name, map.next_value()?));
        }
        Ok(Entries(entries))
    }
}

/// Reads a JSON text; what is wrong with it comes with its line.
pub(super) fn parse<T: serde::de::DeserializeOwned>(bytes: &[u8]) -> Result<T, Fault> {
    serde_json::from_slice(bytes).map_err(|error| {
        let place = if error.line() > 0 { Place::Line(error.line()) } else { Place::File };
        let text = error.to_string();
        // The message ends in a place, which is told already.
        let text = text.rsplit_once(" at line ").map_or(text.as_str(), |(text, _)| text);
        match text.split_once(", expected ").or_else(|| text.split_once("; expected ")) {
            Some((found, expected)) => Fault::new(place, found, expected),
            None => Fault::new(place, text, "JSON as documented"),
        }
    })
}
