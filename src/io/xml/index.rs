//! XML files that hold no data but the names of files that do: parallel files, blocks, time steps.

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
    /// `.vtm`: data sets side by side.
    Blocks(Vec<Reference>),
    /// `.pvd`: data sets one after the other.
    Steps(Vec<Reference>),
}

/// A file named in an index file.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::io) struct Reference {
    /// The name, relative to the index file.
    pub file: String,
    pub place: Place,
}

/// The names in an index file; `None` for a file that holds its data itself, or whose type is not known here.
///
/// # Errors
/// A broken file, or an entry without a name.
pub(in crate::io) fn index(bytes: &[u8]) -> Result<Option<Index>, Fault> {
    let parts = Parts::cut(bytes, Source::Memory(bytes))?;
    let document = parts.parse()?;
    let root = document.root_element();
    let kind = root.attribute("type").unwrap_or_default();
    let (element, attribute) = match kind {
        "PImageData" | "PRectilinearGrid" | "PStructuredGrid" | "PPolyData" | "PUnstructuredGrid" => ("Piece", "Source"),
        "vtkMultiBlockDataSet" | "vtkMultiPieceDataSet" | "vtkPartitionedDataSetCollection" => ("DataSet", "file"),
        "Collection" => ("DataSet", "file"),
        _ => return Ok(None),
    };
    let context = Context::new(&parts, root)?;
    let Some(list) = root.children().find(|child| child.has_tag_name(kind)) else {
        return Err(Fault::new(context.place(root), format!("no <{kind}>"), "one, as the type says"));
    };
    let named = |node: Node<'_, '_>| match node.attribute(attribute) {
        Some(file) if !file.is_empty() => Ok(Reference { file: file.to_owned(), place: context.place(node) }),
        _ => Err(Fault::new(context.place(node), format!("<{element}> without {attribute}"), format!("{attribute}=\"name of a file\""))),
    };
    let parallel = kind.strip_prefix('P').filter(|_| element == "Piece");
    // Blocks without a file are empty, and so are said to be.
    let is_listed = |node: &Node<'_, '_>| node.has_tag_name(element) && (element == "Piece" || kind == "Collection" || node.has_attribute(attribute));
    let references = list.descendants().filter(is_listed).map(named).collect::<Result<Vec<_>, _>>()?;
    if references.is_empty() {
        return Err(Fault::new(context.place(list), format!("<{kind}> that names no file"), format!("<{element} {attribute}=\"name of a file\">")));
    }
    Ok(Some(match (parallel, kind) {
        (Some(kind), _) => Index::Parallel { kind: kind.to_owned(), pieces: references },
        (None, "Collection") => Index::Steps(references),
        (None, _) => Index::Blocks(references),
    }))
}
