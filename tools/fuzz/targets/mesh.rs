#![no_main]
//! Any bytes as a mesh, a table or an image: the first byte chooses the format.

mod common;

const EXTENSIONS: [&str; 8] = ["obj", "off", "ply", "stl", "mesh", "msh", "csv", "png"];

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Some((first, rest)) = bytes.split_first() {
        common::survive(EXTENSIONS[usize::from(*first) % EXTENSIONS.len()], rest);
    }
});
