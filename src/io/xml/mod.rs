//! VTK XML files.

mod base64;
mod blocks;
mod document;
mod index;
mod merge;
mod payload;
mod piece;
mod write;

pub(super) use document::{Source, reaches_raw_data};
pub(super) use index::{INDEX_MARKS, Index, Listing, Reference, index};
pub(super) use merge::merge;
pub(super) use piece::read;
pub(super) use write::write;
