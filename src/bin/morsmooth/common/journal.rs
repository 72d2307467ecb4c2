//! What finished steps left: a line of JSON each, beside the collection, so that a run that was interrupted goes on where it was.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use morsmooth::io::fingerprint;
use morsmooth::plot::write_atomically;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::failure::Failure;

/// A step whose file is in its place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Name of the file written, in the folder of the collection.
    pub file: String,
    /// Its length.
    pub bytes: u64,
    /// Fingerprint of its content, so that a file which was cut or changed since is not taken for finished.
    pub content: String,
    /// Fingerprint of what it was made of.
    pub input: String,
    /// Everything asked that decides on the content.
    pub settings: String,
    /// What was measured.
    pub told: Value,
}

/// The records of a collection.
pub struct Journal {
    path: PathBuf,
    folder: PathBuf,
    /// By name of the file without its extension.
    known: BTreeMap<String, Record>,
    /// Open from the first step on: a run that finishes none leaves no journal.
    file: Mutex<Option<File>>,
}

impl Journal {
    /// Opens the journal of a collection, or begins one.
    pub fn open(output: &Path) -> Result<Self, Failure> {
        let path = place(output);
        let known: BTreeMap<String, Record> = records(&path).into_iter().map(|record| (stem(&record.file), record)).collect();
        if path.exists() {
            // Without the half line that an interruption may have left, after which nothing could be added.
            write_lines(&path, known.values())?;
        }
        Ok(Self { folder: folder(output), path, known, file: Mutex::new(None) })
    }

    /// The record of a step that is finished: same settings, same input, and its file as it was written.
    pub fn finished(&self, target: &Path, settings: &str, input: &str) -> Option<&Record> {
        let name = target.file_name()?.to_string_lossy();
        let record = self.known.get(name.as_ref())?;
        let file = self.folder.join(&record.file);
        let is_whole = || {
            std::fs::metadata(&file).is_ok_and(|found| found.is_file() && found.len() == record.bytes)
                && fingerprint(&file).is_ok_and(|found| hexadecimal(found) == record.content)
        };
        (record.settings == settings && record.input == input && is_whole()).then_some(record)
    }

    /// Adds a step whose file is in its place.
    pub fn add(&self, record: &Record) -> Result<(), Failure> {
        let mut line = serde_json::to_string(record).map_err(|error| cannot_write(&self.path, &error))?;
        line.push('\n');
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let open = || OpenOptions::new().append(true).create(true).open(&self.path);
        let opened = match file.take() {
            Some(opened) => Ok(opened),
            None => open(),
        };
        let written = opened.and_then(|mut opened| opened.write_all(line.as_bytes()).map(|()| opened));
        *file = Some(written.map_err(|error| cannot_write(&self.path, &error))?);
        Ok(())
    }

    /// Ends a run: one line a step that is finished.
    pub fn close(self, finished: &[&Record]) -> Result<(), Failure> {
        if finished.is_empty() && !self.path.exists() {
            return Ok(());
        }
        write_lines(&self.path, finished.iter().copied())
    }
}

/// The files that earlier runs wrote for a collection.
pub fn files(output: &Path) -> Vec<PathBuf> {
    let folder = folder(output);
    records(&place(output)).iter().map(|record| folder.join(&record.file)).collect()
}

/// Where the journal of a collection is.
pub fn place(output: &Path) -> PathBuf {
    let mut name = output.as_os_str().to_owned();
    name.push(".jsonl");
    name.into()
}

/// A fingerprint as text.
pub fn hexadecimal(fingerprint: u64) -> String {
    format!("{fingerprint:016x}")
}

fn folder(output: &Path) -> PathBuf {
    output.parent().unwrap_or(Path::new("")).to_owned()
}

fn stem(file: &str) -> String {
    Path::new(file).file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Lines that are none of ours say of nothing that it is finished, so they are passed over. A name with a folder would lead elsewhere.
fn records(path: &Path) -> Vec<Record> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let records = text.lines().filter_map(|line| serde_json::from_str::<Record>(line).ok());
    records.filter(|record| Path::new(&record.file).file_name().is_some_and(|name| name == record.file.as_str())).collect()
}

fn write_lines<'a>(path: &Path, records: impl Iterator<Item = &'a Record>) -> Result<(), Failure> {
    let mut text = String::new();
    for record in records {
        text.push_str(&serde_json::to_string(record).map_err(|error| cannot_write(path, &error))?);
        text.push('\n');
    }
    write_atomically(path, text.as_bytes()).map_err(|error| Failure::usage(error.to_string()))
}

fn cannot_write(path: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::file(path, format!("cannot be written: {error}"))
}
