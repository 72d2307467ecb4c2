//! What the targets share: bytes as a file, read and then used as the program would.

use std::path::PathBuf;

use morsmooth::io::{self, MaskSources};

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
        // A grid without arrays may declare any size; that is what its user asks for.
        Ok(dataset) if dataset.point_count() > 20_000 => {}
        Ok(dataset) => {
            let _ = io::mask(&dataset, &MaskSources::default()).map(|mask| io::domain(&dataset, &mask));
            let copy = path.with_extension(dataset.geometry.extension());
            if let Ok(pending) = io::write_temporary(&copy, &dataset) {
                let again = io::read(pending.path()).expect("what was written can be read");
                assert_eq!((again.point_count(), again.cell_count()), (dataset.point_count(), dataset.cell_count()));
            }
        }
    }
}
