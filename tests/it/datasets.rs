//! The shipped data is what MANIFEST.toml says, and all of it.

use crate::support::dataset;
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;

fn entries() -> Vec<toml::Table> {
    let manifest: toml::Table = std::fs::read_to_string(dataset("MANIFEST.toml")).unwrap().parse().unwrap();
    manifest["dataset"].as_array().unwrap().iter().map(|entry| entry.as_table().unwrap().clone()).collect()
}

fn text<'a>(entry: &'a toml::Table, key: &str) -> &'a str {
    entry.get(key).and_then(|value| value.as_str()).unwrap_or_else(|| panic!("{entry}: no {key}"))
}

#[test]
fn every_file_has_the_hash_of_the_manifest() {
    for entry in entries() {
        let name = text(&entry, "file");
        let bytes = std::fs::read(dataset(name)).unwrap();
        assert_eq!(bytes.len() as i64, entry["bytes"].as_integer().unwrap(), "{name}");
        let hash: String = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(hash, text(&entry, "sha256"), "{name}");
    }
}

#[test]
fn every_entry_names_its_origin_and_a_script_that_exists() {
    for entry in entries() {
        for key in ["what", "array", "source", "licence", "credit"] {
            assert!(!text(&entry, key).is_empty(), "{}: {key} is empty", text(&entry, "file"));
        }
        let script = text(&entry, "command").split(' ').nth(1).unwrap();
        assert!(dataset("..").join(script).exists(), "{script} does not exist");
    }
}

#[test]
fn no_file_is_unlisted() {
    let mut listed = BTreeSet::from(["MANIFEST.toml".to_owned()]);
    for entry in entries() {
        listed.insert(text(&entry, "file").to_owned());
        listed.extend(entry.get("licence_file").map(|file| file.as_str().unwrap().to_owned()));
    }
    let mut there = BTreeSet::new();
    let mut folders = vec![String::new()];
    while let Some(folder) = folders.pop() {
        for found in std::fs::read_dir(dataset(&folder)).unwrap() {
            let found = found.unwrap();
            let name = format!("{folder}{}", found.file_name().into_string().unwrap());
            if found.path().is_dir() {
                folders.push(name + "/");
            } else {
                there.insert(name);
            }
        }
    }
    assert_eq!(there, listed);
}

#[test]
fn the_named_arrays_are_in_the_files() {
    for entry in entries() {
        let (name, array) = (text(&entry, "file"), text(&entry, "array"));
        let bytes = std::fs::read(dataset(name)).unwrap();
        let wanted = match name.rsplit_once('.').unwrap().1 {
            // Tables begin with the names of their columns; in JSON the array is an entry.
            "csv" => format!("{array}\n"),
            "json" => format!("\"{array}\": "),
            _ => format!("Name=\"{array}\""),
        };
        let found = bytes.windows(wanted.len()).any(|window| window == wanted.as_bytes());
        assert!(found, "{}: no array {wanted}", text(&entry, "file"));
    }
}
