//! Functions with controlled extrema.

mod fit;
mod graph;
