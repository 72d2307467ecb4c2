//! The rules of the house, read off the sources: floors, homes of outside crates, sizes, the top level, the README.

mod source;

use source::Source;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A module uses only modules of lower floors.
const FLOORS: [(&str, usize); 15] = [
    ("linalg", 0),
    ("field", 0),
    ("mesh", 1),
    ("qp", 1),
    ("operators", 2),
    ("morse", 2),
    ("audit", 2),
    ("monotone", 3),
    ("deform", 3),
    ("geodesic", 3),
    ("io", 3),
    ("plot", 3),
    ("smooth", 4),
    ("interpolate", 4),
    ("bin", 5),
];

/// On a lower floor, and forbidden all the same: the audit judges what the engine makes.
const FORBIDDEN: [(&str, &str); 1] = [("audit", "qp")];

/// Where an outside crate may be named; nowhere else.
const HOMES: [(&str, &[&str]); 22] = [
    ("faer", &["linalg"]),
    ("petgraph", &["morse", "monotone"]),
    ("spade", &["mesh/delaunay.rs"]),
    ("robust", &["audit"]),
    ("csv", &["io/formats/csv.rs"]),
    ("jiff", &["io/formats/csv.rs"]),
    ("roxmltree", &["io"]),
    ("flate2", &["io"]),
    ("lz4_flex", &["io"]),
    ("lzma_rust2", &["io"]),
    ("base64", &["io"]),
    ("hdf5_pure", &["io/hdf"]),
    ("vtkio", &["io"]),
    ("ply_rs_bw", &["io/formats/ply.rs"]),
    ("stl_io", &["io/formats/stl.rs"]),
    ("plotters", &["plot"]),
    ("plotters_backend", &["plot"]),
    ("image", &["plot", "io/formats/png.rs"]),
    ("noto_sans_mono_bitmap", &["plot"]),
    ("clap", &["bin"]),
    ("indicatif", &["bin"]),
    ("signal_hook", &["bin"]),
];

/// Outside crates without a home of their own.
const ANYWHERE: [&str; 4] = ["rayon", "serde", "serde_json", "thiserror"];

const TOP_LEVEL: [&str; 9] =
    ["Cargo.toml", "Cargo.lock", "src", "tests", "datasets", "tools", "README.md", "LICENSE-MIT", "LICENSE-APACHE"];

const LONGEST_FILE: usize = 600;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn files(folder: &Path, extension: &str, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            // What cargo builds for the fuzz targets and the wheel is not ours.
            if !path.ends_with("target") {
                files(&path, extension, found);
            }
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
}

fn sources() -> Vec<Source> {
    let (src, mut found) = (root().join("src"), Vec::new());
    files(&src, "rs", &mut found);
    found.iter().map(|file| Source::read(&src, file)).collect()
}

fn floor(module: &str) -> Option<usize> {
    FLOORS.iter().find(|(name, _)| *name == module).map(|&(_, floor)| floor)
}

/// What a file may not use, in words; empty for a good file.
fn faults(source: &Source) -> Vec<String> {
    let module = source.module();
    if module == "lib" {
        return Vec::new();
    }
    let path = source.path.display();
    let Some(own) = floor(&module) else {
        return vec![format!("{path}: module {module} has no floor")];
    };
    let mut faults = Vec::new();
    let crate_root = if module == "bin" { "morsmooth" } else { "crate" };
    for used in source.heads_after(crate_root) {
        let allowed = used == module || floor(&used).is_some_and(|floor| floor < own);
        if module != "bin" && !allowed || FORBIDDEN.contains(&(module.as_str(), used.as_str())) {
            faults.push(format!("{path}: floor {own} uses {used}"));
        }
    }
    // A file at depth d below `src` reaches the crate root with d steps upwards and would slip past the check above.
    let depth = source.path.iter().count() - usize::from(source.path.ends_with("mod.rs"));
    if module != "bin" && source.longest_super_chain() >= depth {
        faults.push(format!("{path}: leaves its module by super::"));
    }
    for (name, homes) in HOMES {
        let at_home = homes.iter().any(|home| source.path.starts_with(home));
        if !at_home && source.names_crate(name) && !is_sibling(&source.path, name) {
            faults.push(format!("{path}: names {name}, whose home is {homes:?}"));
        }
    }
    faults
}

/// Whether `name` is a module beside or below the file, such as a reader called `image`.
fn is_sibling(path: &Path, name: &str) -> bool {
    let folder = root().join("src").join(path.parent().unwrap());
    folder.join(format!("{name}.rs")).exists() || folder.join(name).exists()
}

#[test]
fn modules_use_lower_floors_only() {
    let faults: Vec<String> = sources().iter().flat_map(faults).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_floor_check_sees_what_it_should() {
    let read = |path: &str, text: &str| {
        faults(&Source { path: path.into(), tokens: source::tokens(text) })
    };
    assert_eq!(read("plot/x.rs", "use crate::{field::VertexId, mesh};").len(), 0);
    assert_eq!(read("plot/x.rs", "fn f() { crate::plot::g(); let s = \"crate::smooth\"; } // crate::smooth").len(), 0);
    assert_eq!(read("plot/x.rs", "use crate::{field::{A, smooth}, mesh::B, smooth::C};").len(), 1);
    assert_eq!(read("plot/x.rs", "use crate::io::Reader;").len(), 1);
    assert_eq!(read("qp/x.rs", "type T = crate::mesh::SimplicialComplex;").len(), 1);
    assert_eq!(read("audit/x.rs", "use crate::qp::Engine; use crate::morse::pairs;").len(), 2);
    assert_eq!(read("audit/x.rs", "use super::super::qp::Engine;").len(), 1);
    assert_eq!(read("audit/mod.rs", "use super::field::VertexId;").len(), 1);
    assert_eq!(read("audit/x.rs", "use super::report::Audit;").len(), 0);
    assert_eq!(read("qp/x.rs", "use faer::Mat;").len(), 1);
    assert_eq!(read("linalg/x.rs", "use faer::Mat; fn f<'a>(c: &'a str) -> char { '\"' }").len(), 0);
    assert_eq!(read("mesh/x.rs", "let a: ::spade::Point2<f64>;").len(), 1);
    assert_eq!(read("mesh/delaunay.rs", "use spade as s;").len(), 0);
    assert_eq!(read("newcomer/x.rs", "").len(), 1);
}

#[test]
fn every_dependency_has_a_home() {
    let manifest: toml::Table = std::fs::read_to_string(root().join("Cargo.toml")).unwrap().parse().unwrap();
    for name in manifest["dependencies"].as_table().unwrap().keys() {
        let name = name.replace('-', "_");
        let known = HOMES.iter().any(|(home, _)| *home == name) || ANYWHERE.contains(&name.as_str());
        assert!(known, "{name}: say in tests/it/house.rs where it may be used");
    }
}

#[test]
fn unsafe_code_is_forbidden_everywhere() {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).unwrap();
    assert!(manifest.contains("unsafe_code = \"forbid\"") && manifest.contains("missing_docs = \"deny\""));
    let forbid = ["#", "!", "[", "forbid", "(", "unsafe_code", ")", "]"];
    let library = Source::read(&root().join("src"), &root().join("src/lib.rs"));
    assert!(library.has(&forbid), "src/lib.rs lacks #![forbid(unsafe_code)]");
    for source in sources() {
        let path = source.path.display();
        assert!(!source.has(&["unsafe", "{"]) && !source.has(&["unsafe", "fn"]), "{path}: unsafe");
    }
}

#[test]
fn the_library_neither_panics_by_habit_nor_prints() {
    for source in sources() {
        let path = source.path.display();
        assert!(!source.has(&["todo", "!"]) && !source.has(&["unimplemented", "!"]), "{path}: unfinished");
        assert!(!source.has(&[".", "unwrap", "("]), "{path}: unwrap; use a typed error, or expect with the reason");
        assert!(!source.has(&["dbg", "!"]), "{path}: dbg!");
        for printing in ["print", "println", "eprint", "eprintln"] {
            let prints = source.has(&[printing, "!"]);
            assert!(!prints || source.module() == "bin", "{path}: only the program prints");
        }
    }
}

#[test]
fn module_files_hold_docs_and_names_only() {
    for source in sources().iter().filter(|source| source.path.ends_with("mod.rs")) {
        for item in ["fn", "struct", "enum", "impl", "trait", "const", "static"] {
            assert!(!source.has(&[item]), "{}: {item} belongs into a file of its own", source.path.display());
        }
    }
}

#[test]
fn files_stay_short() {
    let mut found = Vec::new();
    for (folder, extension) in [("src", "rs"), ("tests", "rs"), ("tools", "rs"), ("tools", "py")] {
        files(&root().join(folder), extension, &mut found);
    }
    for file in found {
        let lines = std::fs::read_to_string(&file).unwrap().lines().count();
        assert!(lines <= LONGEST_FILE, "{}: {lines} lines; expected at most {LONGEST_FILE}", file.display());
    }
}

#[test]
fn the_top_level_holds_nothing_else() {
    let mut unknown = BTreeSet::new();
    for entry in std::fs::read_dir(root()).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let known = TOP_LEVEL.contains(&name.as_str());
        // The README's command writes `out.vti` here; version control ignores it.
        let ignored = name.starts_with('.') || name.starts_with("target") || name.starts_with("out.");
        if !known && !ignored {
            unknown.insert(name);
        }
    }
    assert!(unknown.is_empty(), "not wanted at the top level: {unknown:?}");
    for name in TOP_LEVEL {
        assert!(root().join(name).exists(), "{name} is missing");
    }
}

/// Indented lines of the README, which are commands or output.
fn readme_commands() -> Vec<String> {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    readme.lines().filter_map(|line| line.strip_prefix("    ")).map(str::to_owned).collect()
}

#[test]
fn the_readme_and_continuous_integration_run_the_same_tests() {
    let commands = readme_commands();
    let test = "cargo test --release";
    assert!(commands.iter().any(|command| command == test), "the README lacks `{test}`");
    let ci = std::fs::read_to_string(root().join(".ci/run")).unwrap();
    let run: Vec<&str> = ci.lines().filter(|line| line.contains("cargo")).collect();
    assert_eq!(run, [format!("exec {test} </dev/null")], ".ci/run runs exactly the README's test command");
}

#[test]
fn the_readme_names_files_that_exist() {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let words = readme.split(|c: char| c.is_whitespace() || "`()[]<>,;\"'".contains(c));
    for word in words.map(|word| word.trim_end_matches(['.', ':'])) {
        let named = ["datasets/", "tools/", "src/", "tests/"].iter().any(|folder| word.starts_with(folder));
        assert!(!named || root().join(word).exists(), "README.md names {word}, which does not exist");
    }
    let commands = readme_commands();
    assert!(commands.iter().any(|command| command.starts_with("cargo run --release -- smooth datasets/jet.vti ")));
}
