//! Ctrl-C while a file is written: the place is as it was, and nothing lies beside it.

use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use morsmooth::io::{ArrayData, DataArray, DataSet, Extent, Geometry};

use super::Bench;

/// A program that has written its output when the signal comes is started again, so often at the most.
const TRIALS: usize = 20;

/// An image that takes a while to be written as text.
fn large() -> DataSet {
    let extent = Extent([0, 799, 0, 499, 0, 0]);
    let direction = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let mut dataset = DataSet::new(Geometry::ImageData { extent, origin: [0.0; 3], spacing: [1.0; 3], direction });
    for name in ["a", "b", "c"] {
        let values = (0..400_000).map(|point| f64::from(point).sqrt()).collect();
        dataset.set_point_array(DataArray::new(name, 1, ArrayData::F64(values)));
    }
    dataset
}

fn names(bench: &Bench) -> Vec<String> {
    let entries = std::fs::read_dir(bench.path("")).unwrap();
    let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Starts a conversion and signals it as soon as its temporary file is there.
fn interrupted(bench: &Bench, signal: &str) -> std::process::ExitStatus {
    let mut child: Child = Command::new(env!("CARGO_BIN_EXE_morsmooth"))
        .args(["convert", "in.vti", "out.csv"])
        .current_dir(bench.path(""))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while child.try_wait().unwrap().is_none() && !names(bench).iter().any(|name| name.contains(".part")) {
        std::thread::sleep(Duration::from_millis(1));
    }
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status().unwrap();
    let ended = child.wait().unwrap();
    assert!(sent.success() || ended.success(), "kill: {sent}");
    ended
}

#[test]
fn an_interrupted_write_leaves_nothing_behind() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        let bench = Bench::with(&large());
        let was_stopped = (0..TRIALS).any(|_| {
            bench.text("out.csv", "x\n1\n");
            let ended = interrupted(&bench, signal);
            assert_eq!(ended.signal(), None, "{signal} was not answered");
            assert_eq!(names(&bench), ["in.vti", "out.csv"]);
            ended.code() == Some(code) && std::fs::read_to_string(bench.path("out.csv")).unwrap() == "x\n1\n"
        });
        assert!(was_stopped, "{signal} never met a write that was under way");
    }
}
