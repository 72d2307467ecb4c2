//! Commands on files as they are.

pub mod convert;
pub mod info;
