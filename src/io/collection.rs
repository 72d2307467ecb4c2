//! Files that list others: the time steps of a ParaView collection (`.pvd`), the blocks of a multi-block data set (`.vtm`).

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use super::error::{Fault, IoError, Place, quoted};
use super::parallel::beside;
use super::pending::PendingFile;
use super::read::is_certainly_xml;
use super::xml::{INDEX_MARKS, Index, Listing, index};

/// How the data sets of a collection stand to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CollectionKind {
    /// One after the other in time.
    Steps,
    /// Side by side.
    Blocks,
}

/// One data set of a collection.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// What it is called within the collection: the names of its blocks from the root, parted by `/`; a number where there is
    /// no name, or where several have it. Steps are numbered from 0.
    pub address: String,
    /// The same in numbers only.
    pub numbers: String,
    /// Time of a step, if the file tells one.
    pub time: Option<f64>,
    /// Its file.
    pub path: PathBuf,
}

/// A file that lists files, with its whole text: written again, everything but the names of the files stays as it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Collection {
    /// What is listed.
    pub kind: CollectionKind,
    /// In the order of the file; at least one.
    pub entries: Vec<Entry>,
    /// Addresses of blocks that are there, but without a file.
    pub empty: Vec<String>,
    listing: Listing,
}

impl Collection {
    /// Reads a list of files; `None` for a file that is none, a parallel file (`.pvtu` and the like) among them. The time steps within
    /// a `.vtkhdf` file are listed as `run.vtkhdf/0` and so on.
    ///
    /// # Errors
    /// [`IoError::Read`] if there is no such file; [`IoError::Malformed`] for a broken list.
    ///
    /// # Cost
    /// Linear in the list; the files in it are not opened, and of other files the first 4 kB are read.
    pub fn read(path: impl AsRef<Path>) -> Result<Option<Self>, IoError> {
        let path = path.as_ref();
        let failed = |source| IoError::Read { path: path.to_owned(), source };
        #[cfg(feature = "vtkhdf")]
        if let Some(times) = super::hdf::times(path)? {
            return Ok(Self::of_steps(path, &times));
        }
        let mut file = File::open(path).map_err(failed)?;
        let mut bytes = Vec::new();
        (&mut file).take(HEAD as u64).read_to_end(&mut bytes).map_err(failed)?;
        if !may_list_files(&bytes) {
            return Ok(None);
        }
        file.read_to_end(&mut bytes).map_err(failed)?;
        match index(&bytes).map_err(|fault| fault.in_file(path))? {
            Some(Index::Collection(listing)) => Ok(Some(Self::of_listing(path, listing))),
            _ => Ok(None),
        }
    }

    pub(super) fn of_listing(path: &Path, listing: Listing) -> Self {
        let kind = if listing.is_steps { CollectionKind::Steps } else { CollectionKind::Blocks };
        let entry = |reference: &super::xml::Reference| Entry {
            address: reference.address.clone(),
            numbers: reference.numbers.clone(),
            time: reference.time.as_deref().and_then(|time| time.trim().parse().ok()).filter(|time: &f64| time.is_finite()),
            path: beside(path, reference),
        };
        Self { kind, entries: listing.references.iter().map(entry).collect(), empty: listing.empty.clone(), listing }
    }

    /// The steps within one file, as a `.pvd` file would list them.
    #[cfg(feature = "vtkhdf")]
    fn of_steps(path: &Path, times: &[f64]) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy();
        let entries: Vec<(f64, String)> = times.iter().enumerate().map(|(step, &time)| (time, format!("{name}/{step}"))).collect();
        let mut text = Vec::new();
        // Nothing can fail in memory.
        write_listing(&mut text, &entries).ok()?;
        match index(&text) {
            Ok(Some(Index::Collection(listing))) => Some(Self::of_listing(path, listing)),
            _ => None,
        }
    }

    /// The data set of an address, by names or by numbers.
    pub fn find(&self, address: &str) -> Option<&Entry> {
        let by = |of: fn(&Entry) -> &String| self.entries.iter().find(|entry| of(entry) == address);
        by(|entry| &entry.address).or_else(|| by(|entry| &entry.numbers))
    }

    /// Writes the list beside `path` with other files in it, to be put in its place by [`PendingFile::commit`].
    ///
    /// Times, names, groups and field data stay as they were written.
    ///
    /// # Arguments
    /// * `files`: one name an entry, relative to the folder of `path`; a step without one is left out, a block becomes empty.
    ///
    /// # Errors
    /// [`IoError::Write`] if the file cannot be created.
    pub fn write_temporary(&self, path: impl AsRef<Path>, files: &[Option<String>]) -> Result<PendingFile, IoError> {
        let text = &self.listing.text;
        PendingFile::create(path.as_ref(), |out| {
            let mut done = 0;
            for (reference, file) in self.listing.references.iter().zip(files) {
                let (span, name) = match (file, self.kind) {
                    (Some(name), _) => (&reference.name_span, escaped(name)),
                    (None, CollectionKind::Steps) => (&reference.element_span, String::new()),
                    (None, CollectionKind::Blocks) => (&reference.attribute_span, String::new()),
                };
                out.write_all(&text.as_bytes()[done..span.start])?;
                out.write_all(name.as_bytes())?;
                done = span.end;
            }
            out.write_all(&text.as_bytes()[done..])
        })
    }
}

/// The file behind a name: for `case.vtm/inlet` or `steps.pvd/3` that of the block or step, for others the name itself. Blocks and
/// steps of a `.vtkhdf` file have no files of their own: it is that file.
///
/// A file is a folder of what it lists; blocks are named as [`Entry::address`] or [`Entry::numbers`] say.
///
/// # Errors
/// [`IoError::Malformed`] with the addresses that there are, if the one asked for is not among them.
///
/// # Cost
/// For a path that exists, none.
pub fn resolve(path: impl AsRef<Path>) -> Result<PathBuf, IoError> {
    let path = path.as_ref();
    if path.exists() {
        return Ok(path.to_owned());
    }
    #[cfg(feature = "vtkhdf")]
    if let Some((file, _)) = super::hdf::inside(path) {
        return Ok(file);
    }
    let Some(list) = path.ancestors().skip(1).find(|ancestor| ancestor.is_file()) else { return Ok(path.to_owned()) };
    let mut list = list.to_owned();
    let mut rest = path.strip_prefix(&list).map(|rest| rest.to_string_lossy().into_owned()).unwrap_or_default();
    let mut seen = BTreeSet::new();
    loop {
        let Some(collection) = Collection::read(&list)? else {
            let found = format!("one data set, where its block {} was asked for", quoted(&rest));
            return Err(Fault::new(Place::File, found, "a list of data sets (.vtm .pvd)").in_file(&list));
        };
        if let Some(entry) = collection.find(&rest) {
            return Ok(entry.path.clone());
        }
        // A block may be a list itself.
        let begins = |entry: &&Entry| [&entry.address, &entry.numbers].iter().any(|part| rest.strip_prefix(*part).is_some_and(|end| end.starts_with('/')));
        match collection.entries.iter().find(begins) {
            Some(entry) if seen.insert(entry.path.clone()) => {
                let taken = if rest.starts_with(&format!("{}/", entry.address)) { &entry.address } else { &entry.numbers };
                rest = rest[taken.len() + 1..].to_owned();
                list = entry.path.clone();
            }
            _ => {
                let found = format!("no block {}", quoted(&rest));
                return Err(Fault::new(Place::File, found, format!("one of {}", addresses(&collection))).in_file(&list));
            }
        }
    }
}

/// The first addresses, for messages.
pub(super) fn addresses(collection: &Collection) -> String {
    const LISTED: usize = 6;
    let mut names: Vec<&str> = collection.entries.iter().take(LISTED).map(|entry| entry.address.as_str()).collect();
    if collection.entries.len() > LISTED {
        names.push("...");
    }
    names.join(", ")
}

/// How much of a file tells whether it lists others.
const HEAD: usize = 4096;

/// Whether the head of a file has a type that stands for other files, so that it is worth parsing for their names.
pub(super) fn may_list_files(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD)];
    let is_xml = is_certainly_xml(head);
    let head = String::from_utf8_lossy(head);
    is_xml && INDEX_MARKS.iter().any(|mark| head.contains(mark))
}

/// Writes a collection of time steps beside `path`, to be put in its place by [`PendingFile::commit`].
///
/// # Arguments
/// * `entries`: time and file name of each, names relative to the folder of the collection.
///
/// # Errors
/// [`IoError::Write`] if the file cannot be created.
pub fn write_collection(path: impl AsRef<Path>, entries: &[(f64, String)]) -> Result<PendingFile, IoError> {
    PendingFile::create(path.as_ref(), |file| write_listing(file, entries))
}

fn write_listing(file: &mut impl Write, entries: &[(f64, String)]) -> std::io::Result<()> {
    writeln!(file, "<?xml version=\"1.0\"?>")?;
    writeln!(file, "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  <Collection>")?;
    for (time, name) in entries {
        writeln!(file, "    <DataSet timestep=\"{time}\" group=\"\" part=\"0\" file=\"{}\"/>", escaped(name))?;
    }
    writeln!(file, "  </Collection>\n</VTKFile>")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;").replace('\'', "&apos;")
}
