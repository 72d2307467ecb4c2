//! One test binary that mirrors `src/`.
#![allow(clippy::unwrap_used, clippy::print_stderr, clippy::print_stdout)]

mod interpolate;
mod io;
mod mesh;
mod monotone;
mod datasets;
mod field;
mod geodesic;
mod deform;
mod house;
mod audit;
mod morse;
mod operators;
mod plot;
mod program;
mod linalg;
mod qp;
mod smooth;
mod support;
