//! The module `io`, on files that real VTK wrote (`tools/vtk/generate.py`), on damaged ones and on hand-written ones.

mod arrays;
mod collections;
mod damage;
mod domains;
mod fuzzed;
mod handles;
#[cfg(feature = "vtkhdf")]
mod hdf;
mod large;
mod images;
mod meshes;
#[cfg(feature = "vtkio")]
mod model;
mod parallel;
mod encodings;
mod refusals;
mod replacing;
mod roundtrip;
mod speed;
mod tables;
mod versions;

use std::path::{Path, PathBuf};

use morsmooth::io::{DataSet, read};

/// A file written by real VTK.
fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/io/files").join(name)
}

/// All files written by real VTK, sorted.
fn files() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(file("")).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).filter(|path| path.is_file()).collect();
    paths.sort();
    assert!(paths.len() >= 60, "files are missing");
    paths
}

/// A data set as text in which NaN equals NaN and -0 differs from 0; without what a file need not tell.
fn content(dataset: &DataSet) -> String {
    format!("{:?}", DataSet { title: String::new(), version: None, ..dataset.clone() })
}

/// The data set in a file with this text.
fn read_text(folder: &tempfile::TempDir, name: &str, bytes: &[u8]) -> Result<DataSet, morsmooth::io::IoError> {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    read(path)
}
