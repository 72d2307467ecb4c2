//! `METADATA` blocks: component names and information keys of the array before them.

use crate::io::array::{DataArray, InformationKey, InformationValue};
use crate::io::error::Fault;

use crate::io::lexer::{Lexer, decoded};

/// Reads a block if one follows, up to the blank line that ends it.
pub(super) fn read(lexer: &mut Lexer<'_>, array: &mut DataArray) -> Result<(), Fault> {
    if !lexer.accepts("METADATA") {
        return Ok(());
    }
    lexer.line();
    let mut lines = Vec::new();
    loop {
        if lexer.is_at_end() {
            return Err(lexer.fault("the end of the file within METADATA", "a blank line after it"));
        }
        let line = String::from_utf8_lossy(lexer.line().trim_ascii()).into_owned();
        if line.is_empty() {
            break;
        }
        lines.push(line);
    }
    let mut lines = lines.into_iter().peekable();
    while let Some(line) = lines.next() {
        if line == "COMPONENT_NAMES" {
            // A component without a name has no line of its own, because a blank line would end the block.
            let names: Vec<String> = lines.by_ref().take(array.components).map(|name| decoded(&name)).collect();
            if names.len() == array.components {
                array.component_names = names;
            }
        } else if let Some((name, location)) = line.strip_prefix("NAME ").and_then(|rest| rest.split_once(" LOCATION ")) {
            let Some(data) = lines.next_if(|line| line.starts_with("DATA")) else { continue };
            let mut words: Vec<String> = data.split_ascii_whitespace().skip(1).map(decoded).collect();
            let count = words.first().and_then(|count| count.parse::<usize>().ok());
            // Lists of texts stand one a line behind their number.
            if words.len() == 1 && count.is_some() && lines.peek().is_some_and(|line| !line.starts_with("NAME ")) {
                words.extend(lines.by_ref().take(count.unwrap_or(0)).map(|line| decoded(&line)));
            }
            let value = if count == Some(words.len().wrapping_sub(1)) && words.len() > 1 {
                InformationValue::List(words.split_off(1))
            } else {
                InformationValue::Single(words.join(" "))
            };
            array.information.push(InformationKey { name: decoded(name), location: decoded(location), value });
        }
    }
    Ok(())
}
