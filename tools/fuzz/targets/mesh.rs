#![no_main]
//! Any bytes as a mesh, a table, an image or an array: the first byte chooses the format.

mod common;

/// As in seeds.py.
const EXTENSIONS: [&str; 10] = ["obj", "off", "ply", "stl", "mesh", "msh", "csv", "png", "npy", "tsv"];

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Some((first, rest)) = bytes.split_first() {
        common::survive(EXTENSIONS[usize::from(*first) % EXTENSIONS.len()], rest);
    }
});
