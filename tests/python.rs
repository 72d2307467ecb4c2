//! Real VTK, PyVista and ParaView against this program: files in both directions, the Python package, the filters.
//!
//! A virtual environment under `target/python` gets the packages of `tools/python/tests/requirements.txt` from PyPI once, and the
//! wheel each time. Where there is no Python or no network, what was not checked is said on standard error, past the capture of the test
//! harness, and the tests pass. With `MORSMOOTH_PYTHON=required` they fail then; with `MORSMOOTH_PYTHON=off` nothing is tried.
#![allow(clippy::unwrap_used)]

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use std::time::Instant;

const PROGRAM: &str = env!("CARGO_BIN_EXE_morsmooth");

/// What the tools say when the network is why they failed, or when the index has no package for this Python.
const NO_NETWORK: [&str; 12] = [
    "NameResolutionError",
    "Temporary failure in name resolution",
    "Failed to establish a new connection",
    "Network is unreachable",
    "Connection refused",
    "ConnectTimeoutError",
    "Read timed out",
    "No matching distribution found",
    "Could not resolve host",
    "Could not connect to server",
    "spurious network error",
    "failed to download",
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Says something whether or not the test passes.
fn say(text: &str) {
    let _ = writeln!(std::io::stderr(), "python: {text}");
}

/// Notes what was not checked, or fails if it had to be.
fn skip(what: &str, why: &str) {
    assert!(std::env::var("MORSMOOTH_PYTHON").as_deref() != Ok("required"), "{what} must be checked, but {why}");
    say(&format!("skipped: {what}: {why}"));
}

/// Runs a command to its end.
fn run(command: &mut Command) -> Result<Output, String> {
    command.current_dir(root()).stdin(Stdio::null()).output().map_err(|error| error.to_string())
}

/// Both streams, the last lines of them.
fn said(output: &Output) -> String {
    let text = format!("{}\n{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    lines[lines.len().saturating_sub(60)..].join("\n")
}

/// Runs a command that only the network may keep from succeeding: `Err` is why it did not.
fn fetch(command: &mut Command) -> Result<(), String> {
    let output = run(command)?;
    let text = said(&output);
    match NO_NETWORK.iter().find(|sign| text.contains(**sign)) {
        _ if output.status.success() => Ok(()),
        Some(sign) => Err(format!("no network, or no package for this machine ({sign})")),
        None => panic!("{command:?} failed:\n{text}"),
    }
}

/// The Python of the virtual environment, with all packages and the wheel; made once, by whichever test comes first.
fn python() -> Result<&'static Path, &'static str> {
    static PYTHON: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    match PYTHON.get_or_init(prepare) {
        Ok(path) => Ok(path),
        Err(why) => Err(why),
    }
}

fn prepare() -> Result<PathBuf, String> {
    if std::env::var("MORSMOOTH_PYTHON").as_deref() == Ok("off") {
        return Err("MORSMOOTH_PYTHON=off".to_owned());
    }
    let begin = Instant::now();
    let check = "import sys, venv, ensurepip; assert sys.version_info >= (3, 9), sys.version";
    let output = run(Command::new("python3").args(["-c", check])).map_err(|error| format!("python3 cannot be run ({error})"))?;
    if !output.status.success() {
        return Err(format!("python3 is no Python >= 3.9 with venv and pip ({})", said(&output)));
    }
    let folder = root().join("target/python/venv");
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let requirements = root().join("tools/python/tests/requirements.txt");
    let wanted = std::fs::read_to_string(&requirements).unwrap();
    let stamp = folder.join("installed.txt");
    if std::fs::read_to_string(&stamp).ok().as_deref() != Some(wanted.as_str()) {
        fetch(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&folder))?;
        fetch(Command::new(&python).args(["-m", "pip", "install", "--quiet", "-r"]).arg(&requirements))?;
        std::fs::write(&stamp, wanted).unwrap();
    }
    let packages = begin.elapsed().as_secs_f64();
    // As a user installs it, but with the builder and NumPy that are there.
    let install = ["-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-deps", "--force-reinstall", "tools/python"];
    fetch(Command::new(&python).args(install).env("PATH", path_with(&folder)))?;
    say(&format!("packages {packages:.0} s, wheel {:.0} s", begin.elapsed().as_secs_f64() - packages));
    Ok(python)
}

/// The search path with the tools of the environment first.
fn path_with(folder: &Path) -> std::ffi::OsString {
    let own = folder.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let rest = std::env::var_os("PATH").unwrap_or_default();
    std::env::join_paths(std::iter::once(own).chain(std::env::split_paths(&rest))).unwrap()
}

/// Runs a script of the repository and says how it ended.
fn script(python: &Path, words: &[&str]) {
    let begin = Instant::now();
    let output = run(Command::new(python).args(words).env("MORSMOOTH_PROGRAM", PROGRAM)).unwrap();
    assert!(output.status.success(), "python {} failed:\n{}", words.join(" "), said(&output));
    let text = said(&output);
    // What pytest skips, with its reasons, must not go unseen.
    text.lines().filter(|line| line.starts_with("SKIPPED")).for_each(say);
    let last = text.lines().next_back().unwrap_or_default();
    say(&format!("{}: {last} ({:.0} s)", words.join(" "), begin.elapsed().as_secs_f64()));
}

#[test]
fn vtk_reads_what_is_written_and_the_other_way_round() {
    let what = "files against real VTK";
    match python() {
        Err(why) => skip(what, why),
        Ok(python) => {
            let folder = tempfile::tempdir().unwrap();
            let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
            script(python, &["tools/vtk/generate.py", &path("files")]);
            script(python, &["tools/vtk/roundtrip.py", &path("files"), &path("out")]);
            script(python, &["tools/vtk/generate_pyvista.py", &path("pyvista")]);
            script(python, &["tools/vtk/roundtrip.py", &path("pyvista"), &path("pyvista_out")]);
            let jet = ["datasets/jet.vti", "--array", "vorticity_magnitude", "--mask", "valid"];
            script(python, &[&["tools/vtk/diagram.py", "--program", PROGRAM], &jet[..]].concat());
            let complex = path("complex");
            std::fs::create_dir(&complex).unwrap();
            let words = ["complex", jet[0], complex.as_str(), jet[1], jet[2], jet[3], jet[4], "--persistence", "10%"];
            let output = run(Command::new(PROGRAM).args(words)).unwrap();
            assert!(output.status.success(), "{}", said(&output));
            script(python, &["tools/vtk/complex.py", &complex]);
        }
    }
}

#[test]
fn the_wheel_does_what_the_program_does() {
    match python() {
        Err(why) => skip("the Python package", why),
        Ok(python) => script(python, &["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", "tools/python/tests"]),
    }
}

#[test]
fn paraview_runs_the_filters_and_spreads_a_series() {
    let what = "the filters in ParaView";
    // Without ParaView nothing else is made for this test.
    if !["pvpython", "pvbatch"].iter().all(|name| is_installed(name)) {
        return skip_paraview(what);
    }
    match python() {
        Err(why) => skip(what, why),
        Ok(python) => script(python, &["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", "tools/paraview"]),
    }
}

#[test]
fn what_paraview_saves_is_read_as_vtk_reads_it() {
    let what = "files saved by ParaView";
    if !["pvpython", "pvbatch", "mpiexec"].iter().all(|name| is_installed(name)) {
        return skip_paraview(what);
    }
    match python() {
        Err(why) => skip(what, why),
        Ok(python) => {
            let folder = tempfile::tempdir().unwrap();
            let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
            script(python, &["tools/vtk/generate_paraview.py", &path("files")]);
            script(python, &["tools/vtk/roundtrip.py", &path("files"), &path("out")]);
        }
    }
}

/// ParaView comes from no package index: its absence is said, and never an error.
fn skip_paraview(what: &str) {
    say(&format!("skipped: {what}: pvpython, pvbatch or mpiexec is not installed (apt-get install paraview python3-paraview openmpi-bin)"));
}

fn is_installed(name: &str) -> bool {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&paths).any(|folder| folder.join(name).is_file())
}
