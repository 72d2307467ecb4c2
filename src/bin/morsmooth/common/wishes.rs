//! Which extrema are wanted, once or several times, and what the arrays that come of it are called.

use std::path::Path;

use morsmooth::morse::{Selection, Threshold};

use crate::args::SelectionArgs;
use crate::common::input::{FieldInput, PointKind, read_points};
use crate::common::number::plain;
use crate::failure::Failure;

/// One set of wanted extrema.
pub struct Wish {
    /// The rule.
    pub selection: Selection,
    /// What the name of the array ends in; empty where there is one rule only.
    pub ending: String,
}

/// Everything that was asked for; at least one.
pub fn wishes(args: &SelectionArgs, input: &FieldInput) -> Result<Vec<Wish>, Failure> {
    let with = |selection, ending: String| Wish { selection, ending };
    let fractions = args.persistence.iter().map(|&part| {
        with(Selection::Threshold(Threshold::Fraction(part)), format!("_{}pct", plain(100.0 * part)))
    });
    let values = args.persistence_abs.iter().map(|&value| with(Selection::Threshold(Threshold::Absolute(value)), format!("_above{}", plain(value))));
    let counts = args.extrema.iter().map(|&count| with(Selection::Count(count), format!("_{count}extrema")));
    let mut wishes: Vec<Wish> = fractions.chain(values).chain(counts).collect();
    if let Some(path) = &args.keep {
        wishes.push(with(Selection::Set(read_points(path, PointKind::Extrema, input)?), String::new()));
    }
    for (place, wish) in wishes.iter().enumerate() {
        if wishes[..place].iter().any(|other| other.ending == wish.ending) {
            return Err(Failure::usage(format!(
                "found the threshold '{}' twice; expected each once",
                wish.ending.trim_start_matches('_')
            )));
        }
    }
    match wishes.as_mut_slice() {
        [] => Err(none_wanted()),
        [only] => {
            only.ending.clear();
            Ok(wishes)
        }
        _ => Ok(wishes),
    }
}

fn none_wanted() -> Failure {
    Failure::usage("found no wanted extrema; expected one of --persistence, --persistence-abs, --extrema, --keep")
        .hint("'morsmooth persistence FILE' shows what each threshold would leave; --persistence 10% is a good start")
}

/// Refuses a run that wants nothing, before any file is read.
pub fn check_any(args: &SelectionArgs) -> Result<(), Failure> {
    let SelectionArgs { persistence, persistence_abs, extrema, keep } = args;
    match persistence.is_empty() && persistence_abs.is_empty() && extrema.is_empty() && keep.is_none() {
        true => Err(none_wanted()),
        false => Ok(()),
    }
}

/// Names of the arrays to be written for one field, one a wish.
///
/// # Errors
/// If one would take the place of an array of the input that is neither the one worked on nor an earlier result, or that
/// has a `role` in the run.
pub fn array_names(
    asked: Option<&str>,
    usual_ending: &str,
    input: &FieldInput,
    wishes: &[Wish],
    roles: &[(&str, Option<&str>)],
) -> Result<Vec<String>, Failure> {
    if asked == Some("") {
        return Err(Failure::usage("found an empty name for --output-array; expected a name"));
    }
    let usual = format!("{}{usual_ending}", input.name);
    let base = asked.unwrap_or(&usual);
    let names: Vec<String> = wishes.iter().map(|wish| format!("{base}{}", wish.ending)).collect();
    for (name, wish) in names.iter().zip(wishes) {
        if let Some((role, _)) = roles.iter().find(|(_, array)| *array == Some(name.as_str())) {
            return Err(Failure::usage(format!("the result would replace the array '{name}' of {role}; expected another --output-array")));
        }
        let is_worked_on = !input.is_derived && *name == input.name;
        let is_earlier_result = *name == format!("{usual}{}", wish.ending);
        if input.dataset.point_array(name).is_some() && !is_worked_on && !is_earlier_result {
            return Err(Failure::usage(format!("the result would replace the array '{name}' of the input; expected another --output-array")));
        }
    }
    Ok(names)
}

/// Refuses one name for the results of several fields.
pub fn check_single_name(asked: Option<&str>, inputs: &[FieldInput]) -> Result<(), Failure> {
    match asked {
        Some(name) if inputs.len() > 1 => Err(Failure::usage(format!(
            "found --output-array {name} for {} arrays; expected it with one array only", inputs.len()
        ))),
        _ => Ok(()),
    }
}

/// Refuses the file with the wanted points as a target.
pub fn check_keep(args: &SelectionArgs, output: &Path) -> Result<(), Failure> {
    match &args.keep {
        Some(keep) if morsmooth::io::is_same_file(keep, output) => {
            Err(Failure::file(output, "the output would overwrite the file of --keep; expected another name"))
        }
        _ => Ok(()),
    }
}
