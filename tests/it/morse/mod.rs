//! Discrete Morse theory: theorems, and two roads to everything.

mod brute;
mod complex;
mod diagram;
mod hierarchy;
mod morse_smale;
mod gradient;
mod grids;
mod lower_stars;
pub mod meshes;
mod pairs;
mod selection;
mod simplify;
