//! XML files that hold no data but the names of files that do: parallel files, blocks, time steps.

use std::collections::BTreeMap;
use std::ops::Range;

use roxmltree::Node;

use crate::io::error::{Fault, Place};

use super::document::{Context, Parts, Source};

/// Names of files, as they stand in an index file, with the line of each.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::io) enum Index {
    /// `.pvti .pvtr .pvts .pvtp .pvtu`: pieces of one data set.
    Parallel {
        /// The geometry of all pieces, as its serial file calls it.
        kind: String,
        /// In the order of the file.
        pieces: Vec<Reference>,
    },
    /// `.vtm .pvd`: data sets side by side, or one after the other.
    Collection(Listing),
}

/// The text of a collection and where in it files are named.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::io) struct Listing {
    /// One after the other in time, or side by side.
    pub is_steps: bool,
    /// In the order of the file.
    pub references: Vec<Reference>,
    /// Addresses of the blocks that have no file.
    pub empty: Vec<String>,
    /// The whole file.
    pub text: String,
}

/// A file named in an index file.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::io) struct Reference {
    /// The name, relative to the index file.
    pub file: String,
    pub place: Place,
    /// Names from the root down to it, parted by `/`; the number of what has no name of its own.
    pub address: String,
    /// The same in numbers only.
    pub numbers: String,
    /// The time, as it is written.
    pub time: Option<String>,
    /// Bytes of the name in the text.
    pub name_span: Range<usize>,
    /// Bytes of the attribute with the name.
    pub attribute_span: Range<usize>,
    /// Bytes of the element.
    pub element_span: Range<usize>,
}

const BLOCKS: [&str; 4] =
    ["vtkMultiBlockDataSet", "vtkMultiPieceDataSet", "vtkPartitionedDataSetCollection", "vtkPartitionedDataSet"];
const PARALLEL: [&str; 5] = ["PImageData", "PRectilinearGrid", "PStructuredGrid", "PPolyData", "PUnstructuredGrid"];
/// Of every list of files, what the start of such a file holds.
pub(in crate::io) const INDEX_MARKS: [&str; 8] =
    ["PImage", "PRectilinear", "PStructured", "PPoly", "PUnstructured", "Collection", "vtkMulti", "vtkPartitioned"];

/// The names in an index file; `None` for a file that holds its data itself, or whose type is not known here.
///
/// # Errors
/// A broken file, or an entry without a name.
pub(in crate::io) fn index(bytes: &[u8]) -> Result<Option<Index>, Fault> {
    let parts = Parts::cut(bytes, Source::Memory(bytes))?;
    let document = parts.parse()?;
    let root = document.root_element();
    let kind = root.attribute("type").unwrap_or_default();
    let is_parallel = PARALLEL.contains(&kind);
    if !is_parallel && kind != "Collection" && !BLOCKS.contains(&kind) {
        return Ok(None);
    }
    let (element, attribute) = if is_parallel { ("Piece", "Source") } else { ("DataSet", "file") };
    let context = Context::new(&parts, root)?;
    let Some(list) = root.children().find(|child| child.has_tag_name(kind)) else {
        return Err(Fault::new(context.place(root), format!("no <{kind}>"), "one, as the type says"));
    };
    if !is_parallel && parts.appended.is_some() {
        let expected = "field data within the list of files";
        return Err(Fault::unsupported(context.place(list), format!("a <{kind}> with appended data"), expected));
    }
    let (mut references, mut empty) = (Vec::new(), Vec::new());
    for Named { node, address, numbers } in leaves(list, element) {
        match node.attribute_node(attribute).filter(|found| !found.value().is_empty()) {
            Some(name) => references.push(Reference {
                file: name.value().to_owned(),
                place: context.place(node),
                address,
                numbers,
                time: node.attribute("timestep").map(str::to_owned),
                name_span: name.range_value(),
                attribute_span: name.range(),
                element_span: node.range(),
            }),
            // Blocks without a file are empty, and so are said to be; steps and pieces are not.
            None if BLOCKS.contains(&kind) => empty.push(address),
            None => {
                let found = format!("<{element}> without {attribute}");
                return Err(Fault::new(context.place(node), found, format!("{attribute}=\"name of a file\"")));
            }
        }
    }
    if references.is_empty() {
        let found = format!("<{kind}> that names no file");
        return Err(Fault::new(context.place(list), found, format!("<{element} {attribute}=\"name of a file\">")));
    }
    Ok(Some(match kind.strip_prefix('P').filter(|_| is_parallel) {
        Some(kind) => Index::Parallel { kind: kind.to_owned(), pieces: references },
        None => {
            let text = parts.text.clone().into_owned();
            Index::Collection(Listing { is_steps: kind == "Collection", references, empty, text })
        }
    }))
}

/// An element with its addresses.
struct Named<'a, 'input> {
    node: Node<'a, 'input>,
    address: String,
    numbers: String,
}

/// The elements of a name in the order of the file, at any depth.
///
/// Each step of an address is a name where no other part of its level has it, else a number.
fn leaves<'a, 'input>(list: Node<'a, 'input>, element: &str) -> Vec<Named<'a, 'input>> {
    let mut found = Vec::new();
    let mut waiting = vec![Named { node: list, address: String::new(), numbers: String::new() }];
    while let Some(Named { node, address, numbers }) = waiting.pop() {
        if node.has_tag_name(element) {
            found.push(Named { node, address, numbers });
            continue;
        }
        let parts: Vec<Node<'_, '_>> = node.children().filter(is_block).collect();
        let mut names: BTreeMap<&str, usize> = BTreeMap::new();
        parts.iter().filter_map(|part| part.attribute("name")).for_each(|name| *names.entry(name).or_default() += 1);
        let below = |above: &str, step: &str| if above.is_empty() { step.to_owned() } else { format!("{above}/{step}") };
        let named = parts.iter().enumerate().map(|(position, &node)| {
            let number = node.attribute("index").map_or_else(|| position.to_string(), str::to_owned);
            let name = node.attribute("name").filter(|name| !name.is_empty() && !name.contains('/') && names[name] == 1);
            Named { node, address: below(&address, name.unwrap_or(&number)), numbers: below(&numbers, &number) }
        });
        let named: Vec<_> = named.collect();
        waiting.extend(named.into_iter().rev());
    }
    found
}

fn is_block(node: &Node<'_, '_>) -> bool {
    ["DataSet", "Block", "Piece", "Partitions"].iter().any(|name| node.has_tag_name(*name))
}
