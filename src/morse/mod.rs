//! Discrete Morse theory of a vertex order: extremum pairs, the discrete gradient and what they decide.

mod error;
mod gradient;
mod lower_star;
mod pairs;

pub use error::MorseError;
pub use gradient::{Cell, DiscreteGradient, Pairing, discrete_gradient};
pub use pairs::{ExtremumKind, ExtremumPair, extremum_pairs};
