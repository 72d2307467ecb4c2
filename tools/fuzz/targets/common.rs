//! What the targets share: bytes as a file, read and then used as the program would.

use std::path::{Path, PathBuf};

use morsmooth::io::{self, DataSet, MaskSources};

/// A grid without arrays may declare any size; using it is what its user asks for.
const MOST_POINTS: usize = 20_000;

/// A place in memory where there is one: the readers take paths.
fn place(extension: &str) -> PathBuf {
    let memory = PathBuf::from("/dev/shm");
    let folder = if memory.is_dir() { memory } else { std::env::temp_dir() };
    folder.join(format!("morsmooth-fuzz-{}.{extension}", std::process::id()))
}

/// Reads the bytes as a file of a format. An error must say what was expected; what is read must survive its use and its writing.
pub fn survive(extension: &str, bytes: &[u8]) {
    let path = place(extension);
    std::fs::write(&path, bytes).expect("a file for the bytes");
    match io::read(&path) {
        Err(error) => assert!(error.to_string().contains("expected") || error.to_string().contains("cannot read"), "{error}"),
        Ok(dataset) if dataset.point_count() > MOST_POINTS => {}
        Ok(dataset) => {
            let _ = io::mask(&dataset, &MaskSources::default()).map(|mask| io::domain(&dataset, &mask));
            if let Some(again) = written(&path.with_extension(dataset.geometry.extension()), &dataset) {
                // XML has no place for these two.
                let again = DataSet { title: dataset.title.clone(), version: dataset.version, ..again };
                assert!(format!("{again:?}") == format!("{dataset:?}"), "changed by XML: {dataset:?}\n{again:?}");
            }
            if let Some(again) = written(&path.with_extension("vtk"), &dataset) {
                let counts = |dataset: &DataSet| (dataset.point_count(), dataset.cell_count(), dataset.point_data.arrays.len());
                assert_eq!(counts(&again), counts(&dataset), "changed by the legacy format");
            }
            written(&path, &dataset);
        }
    }
}

/// What is read back of a data set, if the format of the name can hold it.
fn written(path: &Path, dataset: &DataSet) -> Option<DataSet> {
    let pending = io::write_temporary(path, dataset).ok()?;
    Some(io::read(pending.path()).expect("what was written can be read"))
}
