//! One test binary that mirrors `src/`.
#![allow(clippy::unwrap_used, clippy::print_stderr, clippy::print_stdout)]

mod linalg;
mod qp;
mod support;
