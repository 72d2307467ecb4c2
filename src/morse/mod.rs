//! Discrete Morse theory of a vertex order: extremum pairs and what they decide.

mod pairs;

pub use pairs::{ExtremumKind, ExtremumPair, extremum_pairs};
