#![no_main]
//! Any bytes as a file of VTK: the legacy format.

mod common;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    common::survive("vtk", bytes);
});
