//! Legacy VTK files, version 1.0 to 5.1, ascii and binary.

mod attributes;
mod metadata;
mod order;
mod read;
mod values;
mod write;

pub(super) use read::{LEGACY_MARK, read};
pub(super) use write::{check, write};
