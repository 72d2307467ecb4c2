//! From the name of a file, a block or a step to the data set.

use std::fs::File;
use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use crate::io::dataset::DataSet;
use crate::io::error::{Fault, IoError, Place, quoted};

use super::store::Node;
use super::{grids, lists};
use super::steps::{Step, steps};

/// The first bytes of an HDF5 file.
pub(in crate::io) const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// The newest version of the format whose files VTK 9.7 reads.
const NEWEST: i64 = 2;

/// The kinds of data sets that are read.
const KINDS: [&str; 5] = ["ImageData", "RectilinearGrid", "StructuredGrid", "PolyData", "UnstructuredGrid"];

/// The HDF5 file and the address in it, for a name such as `run.vtkhdf/3` or `case.vtkhdf/inlet`; `None` for other names.
pub(in crate::io) fn inside(path: &Path) -> Option<(PathBuf, String)> {
    if path.exists() {
        return None;
    }
    let file = path.ancestors().skip(1).find(|ancestor| ancestor.is_file())?;
    let address = path.strip_prefix(file).ok()?.to_string_lossy().into_owned();
    is_hdf5(file).then(|| (file.to_owned(), address))
}

fn is_hdf5(path: &Path) -> bool {
    let mut head = [0; SIGNATURE.len()];
    File::open(path).and_then(|mut file| file.read_exact(&mut head)).is_ok() && head == SIGNATURE
}

/// Reads a data set.
///
/// # Arguments
/// * `address`: a block, a step, or both parted by `/`; empty for the only data set of the file.
///
/// # Errors
/// [`IoError::Unsupported`] for several data sets without an address, and for kinds that are not read; [`IoError::Malformed`]
/// with the array for what does not fit together, and for arrays larger than the file can be unpacked.
///
/// # Cost
/// Linear in the arrays of the data set; others are not read.
pub(in crate::io) fn read(path: &Path, address: &str) -> Result<DataSet, IoError> {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    guarded(path, |root| find(root, &name, address))
}

/// The times of the steps of a file; `None` for what has no steps, or one, and for other files.
pub(in crate::io) fn times(path: &Path) -> Result<Option<Vec<f64>>, IoError> {
    if !path.is_file() || !is_hdf5(path) {
        return Ok(None);
    }
    guarded(path, steps_of)
}

/// Reads from a file. The crate for HDF5 is large and young: it did not panic on any of 80,000 damaged files, but should it on the next,
/// that is still an error of the file and not of the program.
fn guarded<T>(path: &Path, read: impl FnOnce(&Node) -> Result<T, Fault>) -> Result<T, IoError> {
    let job = AssertUnwindSafe(|| read(&open(path)?).map_err(|fault| fault.in_file(path)));
    catch_unwind(job).unwrap_or_else(|_| {
        Err(Fault::new(Place::File, "an HDF5 file that its reader cannot cope with", "a whole HDF5 file").in_file(path))
    })
}

fn open(path: &Path) -> Result<Node, IoError> {
    let failed = |source| IoError::Read { path: path.to_owned(), source };
    let file = File::open(path).map_err(failed)?;
    let length = file.metadata().map_err(failed)?.len();
    Node::root(file, length).map_err(|fault| fault.in_file(path))
}

/// The kind of a data set, whose version must be one that is known.
fn kind(node: &Node) -> Result<&str, Fault> {
    let found = |what: String| format!("{what} of {}", node.path);
    let Some(version) = node.integers::<2>("Version")? else {
        return Err(Fault::new(Place::File, found("no attribute Version".into()), "one"));
    };
    if !(1..=NEWEST).contains(&version[0]) {
        let text = format!("version {}.{}", version[0], version[1]);
        return Err(Fault::unsupported(Place::File, found(text), format!("1.0 to {NEWEST}.x")));
    }
    node.text("Type").ok_or_else(|| Fault::new(Place::File, found("no attribute Type".into()), "one"))
}

fn is_composite(kind: &str) -> bool {
    matches!(kind, "PartitionedDataSetCollection" | "MultiBlockDataSet")
}

/// Names of the blocks with a data set and of those without, in the order of their numbers where they have any.
fn blocks(root: &Node) -> Result<(Vec<String>, Vec<String>), Fault> {
    let (mut filled, mut empty) = (Vec::new(), Vec::new());
    for name in root.groups().iter().filter(|name| *name != "Assembly") {
        let Some(block) = root.child(name)? else { continue };
        let number = block.integers::<1>("Index")?.map(|[number]| number);
        let list = if block.text("Type").is_some() { &mut filled } else { &mut empty };
        list.push((number, name.clone()));
    }
    filled.sort_by_key(|(number, _)| *number);
    let names = |list: Vec<(Option<i64>, String)>| list.into_iter().map(|(_, name)| name).collect();
    Ok((names(filled), names(empty)))
}

fn steps_of(root: &Node) -> Result<Option<Vec<f64>>, Fault> {
    let Some((group, count)) = steps(root)?.filter(|(_, count)| *count > 1) else { return Ok(None) };
    let values = group.needed("Values")?.all()?;
    // A step without a time counts by its number.
    let time = |step: usize| values.number(step).filter(|time| time.is_finite()).unwrap_or(step as f64);
    let times: Vec<f64> = (0..values.len()).map(time).take(usize::try_from(count).unwrap_or(0)).collect();
    Ok(Some(times))
}

fn find(root: &Node, name: &str, address: &str) -> Result<DataSet, Fault> {
    if !is_composite(kind(root)?) {
        return step_of(root, name, address);
    }
    let (filled, empty) = blocks(root)?;
    let (block, rest) = address.split_once('/').unwrap_or((address, ""));
    match root.child(block)? {
        Some(node) if filled.iter().any(|name| name == block) => step_of(&node, &format!("{name}/{block}"), rest),
        _ if filled.is_empty() => Err(Fault::unsupported(Place::File, format!("a collection of {} empty blocks", empty.len()), "one with a data set")),
        _ if address.is_empty() => {
            let found = format!("a collection of {} blocks as one data set", filled.len() + empty.len());
            Err(Fault::unsupported(Place::File, found, format!("one of them, such as {name}/{} (there are {})", filled[0], some(&filled))))
        }
        _ => Err(Fault::new(Place::File, format!("no block {}", quoted(address)), format!("one of {}", some(&filled)))),
    }
}

/// The first names, for messages.
fn some(names: &[String]) -> String {
    const LISTED: usize = 6;
    let more = if names.len() > LISTED { ", ..." } else { "" };
    let first: Vec<&str> = names.iter().take(LISTED).map(String::as_str).collect();
    format!("{}{more}", first.join(", "))
}

/// The data set of a group, or the step of it that is asked for.
fn step_of(node: &Node, name: &str, address: &str) -> Result<DataSet, Fault> {
    let kind = kind(node)?;
    if !KINDS.contains(&kind) {
        let expected = "ImageData, RectilinearGrid, StructuredGrid, PolyData or UnstructuredGrid";
        return Err(Fault::unsupported(Place::File, format!("Type {} of {}", quoted(kind), node.path), expected));
    }
    let step = match steps(node)? {
        None if address.is_empty() => None,
        None => {
            let found = format!("one data set, where its step {} was asked for", quoted(address));
            return Err(Fault::new(Place::File, found, "a data set with steps"));
        }
        Some((group, 1)) if address.is_empty() => Some(Step::new(group, 1, 0)),
        Some((_, count)) if address.is_empty() => {
            let found = format!("a collection of {count} time steps as one data set");
            let expected = format!("one of them, such as {name}/0 (there are 0 to {})", count - 1);
            return Err(Fault::unsupported(Place::File, found, expected));
        }
        Some((group, count)) => match address.parse().ok().filter(|&step: &u64| step < count) {
            Some(number) => Some(Step::new(group, count, number)),
            None => return Err(Fault::new(Place::File, format!("no step {}", quoted(address)), format!("one of 0 to {}", count - 1))),
        },
    };
    let step = step.as_ref();
    match kind {
        "ImageData" => grids::image(node, step),
        "PolyData" => lists::poly_data(node, step),
        "UnstructuredGrid" => lists::unstructured(node, step),
        // The format knows no steps of these; the reader would take all of them for one.
        _ if step.is_some() => Err(Fault::unsupported(Place::File, format!("time steps of Type {}", quoted(kind)), "one data set")),
        "RectilinearGrid" => grids::rectilinear(node),
        _ => grids::structured(node),
    }
}
