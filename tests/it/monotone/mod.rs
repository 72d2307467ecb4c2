//! Functions with controlled extrema.

mod graph;
