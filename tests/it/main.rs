//! One test binary that mirrors `src/`.
#![allow(clippy::unwrap_used, clippy::print_stderr, clippy::print_stdout)]

mod datasets;
mod house;
mod plot;
mod support;
