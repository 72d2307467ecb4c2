#![no_main]
//! Any bytes as a file of VTK: XML.

mod common;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    common::survive("vtu", bytes);
});
