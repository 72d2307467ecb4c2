//! Runs of the program: what it writes, what it says, what it refuses.

mod animate;
mod bad_fields;
mod bad_files;
mod bad_usage;
mod command;
mod by_hand;
mod complex;
mod deform;
mod diffuse;
mod fields;
mod geodesic;
mod handles;
#[cfg(feature = "vtkhdf")]
mod hdf;
mod kinds;
mod options;
mod persistence;
mod pose;
mod queries;
mod series;
mod simplify;
mod steps;
#[cfg(unix)]
mod stop;
mod unusual;
mod weights;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

use morsmooth::io::{ArrayData, Attributes, DataArray, DataSet, read, write};
use serde_json::Value;
use tempfile::TempDir;

/// A run that takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(240);

/// What a run said.
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

/// A folder with files, in which the program runs.
pub struct Bench {
    folder: TempDir,
}

impl Bench {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    /// With one data set `in.<extension of its kind>`.
    pub fn with(dataset: &DataSet) -> Self {
        let bench = Self::new();
        bench.put(&format!("in.{}", dataset.geometry.extension()), dataset);
        bench
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn put(&self, name: &str, dataset: &DataSet) {
        write(self.path(name), dataset).unwrap();
    }

    pub fn text(&self, name: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), text).unwrap();
    }

    pub fn read(&self, name: &str) -> DataSet {
        read(self.path(name)).unwrap()
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&std::fs::read(self.path(name)).unwrap()).unwrap()
    }

    /// Runs the program here. No run may panic.
    pub fn run(&self, arguments: &[&str]) -> Run {
        let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_morsmooth"));
        let output = command.current_dir(self.folder.path()).timeout(PATIENCE).args(arguments).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
        let run = Run { code: output.status.code().unwrap(), stdout: text(&output.stdout), stderr: text(&output.stderr) };
        assert!(!run.stderr.contains("panicked"), "{arguments:?}: {}", run.stderr);
        run
    }

    /// The run must end with code 2, one error with these words, and every file as it was.
    pub fn refuses(&self, arguments: &[&str], words: &[&str]) {
        let before = self.contents();
        let run = self.run(arguments);
        assert_eq!(run.code, 2, "{arguments:?}: {}{}", run.stdout, run.stderr);
        assert_eq!(run.stdout, "", "{arguments:?}");
        assert_eq!(run.stderr.lines().filter(|line| line.starts_with("error: ")).count(), 1, "{arguments:?}: {}", run.stderr);
        for word in words {
            assert!(run.stderr.contains(word), "{arguments:?}: no {word:?} in {}", run.stderr);
        }
        assert!(before == self.contents(), "{arguments:?} changed files: {:?}", self.contents().keys());
    }

    /// Smooths `in.x` to `out.x`, quietly; the output must be right in every respect.
    pub fn smooths(&self, input: &str, arguments: &[&str]) -> Value {
        let output = input.replace("in", "out");
        let original = std::fs::read(self.path(input)).unwrap();
        let fixed = ["smooth", input, &output, "--quiet", "--report", "report.json"];
        let run = self.run(&[&fixed, arguments].concat());
        assert_eq!(run.code, 0, "{arguments:?}: {}{}", run.stdout, run.stderr);
        assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""), "--quiet");
        assert!(original == std::fs::read(self.path(input)).unwrap(), "the input was changed");
        let report = self.json("report.json");
        check_output(&self.read(input), &self.read(&output), &report);
        report
    }

    fn contents(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut found = BTreeMap::new();
        let mut folders = vec![self.folder.path().to_path_buf()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path.clone());
                    found.insert(path, Vec::new());
                } else {
                    found.insert(path.clone(), std::fs::read(&path).unwrap_or_default());
                }
            }
        }
        found
    }
}

/// Everything but the new array is as before; the new array has the reported extrema and no other.
fn check_output(before: &DataSet, after: &DataSet, report: &Value) {
    let name = report["output_array"].as_str().unwrap();
    assert_eq!(before.geometry, after.geometry);
    same_arrays(&before.point_data, &after.point_data, name);
    same_arrays(&before.cell_data, &after.cell_data, "");
    assert_eq!(before.field_data.len(), after.field_data.len());
    before.field_data.iter().zip(&after.field_data).for_each(|(a, b)| same_array(a, b));

    let array = after.point_array(name).unwrap();
    let is_single = before.point_array(report["array"].as_str().unwrap()).map(|array| matches!(array.data, ArrayData::F32(_)));
    match is_single {
        Some(true) => assert!(matches!(array.data, ArrayData::F32(_))),
        Some(false) => assert!(matches!(array.data, ArrayData::F64(_))),
        // A derived field has the width of its vector.
        None => assert!(array.data.value_type().is_float()),
    }
    assert_eq!(report["audit"]["passed"], true);
    let (minima, maxima) = fields::plain_extrema(after, &array.to_f64(0), report["mask"].as_str(), report["array"].as_str());
    assert_eq!(minima, wanted_points(report, "minima"), "minima");
    assert_eq!(maxima, wanted_points(report, "maxima"), "maxima");
    assert_eq!(report["audit"]["minima"], minima.len());
    assert_eq!(report["audit"]["maxima"], maxima.len());
}

/// Points of the wanted extrema of one kind, as the report lists them.
pub fn wanted_points(report: &Value, kind: &str) -> Vec<usize> {
    report["wanted"][kind].as_array().unwrap().iter().map(|entry| entry["point"].as_u64().unwrap() as usize).collect()
}

fn same_arrays(before: &Attributes, after: &Attributes, except: &str) {
    assert_eq!(before.active, after.active);
    let others = |attributes: &Attributes| -> Vec<DataArray> {
        attributes.arrays.iter().filter(|array| array.name != except).cloned().collect()
    };
    let (before, after) = (others(before), others(after));
    assert_eq!(before.len(), after.len());
    before.iter().zip(&after).for_each(|(a, b)| same_array(a, b));
}

/// Equal, NaN and the sign of zero included.
fn same_array(a: &DataArray, b: &DataArray) {
    let bits = |array: &DataArray| -> Option<Vec<u64>> {
        match &array.data {
            ArrayData::F32(values) => Some(values.iter().map(|value| u64::from(value.to_bits())).collect()),
            ArrayData::F64(values) => Some(values.iter().map(|value| value.to_bits()).collect()),
            _ => None,
        }
    };
    assert_eq!((&a.name, a.components, &a.component_names), (&b.name, b.components, &b.component_names));
    assert_eq!((a.id_type, &a.information), (b.id_type, &b.information));
    match bits(a) {
        Some(values) => assert!(Some(values) == bits(b), "array {} changed", a.name),
        None => assert!(a.data == b.data, "array {} changed", a.name),
    }
}
