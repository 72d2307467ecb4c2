//! Discrete Morse theory of a vertex order: extremum pairs, the discrete gradient and what they decide.
//!
//! Minima are read from the gradient of `h`, maxima from the gradient of `-h` with reversed ties. Either gives critical
//! vertices and vertex–edge separatrices, and so also the extrema on the boundary of the domain.

mod ascent;
mod basins;
mod complex;
mod curve;
mod diagram;
mod error;
mod extremum_graph;
mod forest;
mod gradient;
mod lattice_gradient;
mod lattice_star;
mod link;
mod hierarchy;
mod jump;
mod lower_star;
mod morse_smale;
mod pairs;
mod partners;
mod segmentation;
mod selection;
mod skeleton;
mod star;
mod v_paths;

pub use basins::{BasinHierarchy, BasinMerge};
pub use complex::MorseComplex;
pub use curve::{PersistenceCurve, PersistenceGap};
pub use diagram::{
    DiagramStage, PersistenceDiagram, PersistencePair, diagram_of_gradient, diagram_of_gradient_by_stage, persistence_diagram,
};
pub use error::MorseError;
pub use extremum_graph::{Cancellation, ExtremumGraph, Saddle};
pub use crate::mesh::Cell;
pub use gradient::{DiscreteGradient, Pairing, discrete_gradient};
pub use hierarchy::{CellCancellation, MorseHierarchy};
pub use morse_smale::{CriticalPoint, LineKind, MorseSmaleComplex, SeparatrixLine};
pub use pairs::{ExtremumKind, ExtremumPair, extremum_pairs};
pub use segmentation::{MorseSmaleSegmentation, Segmentation};
pub use selection::{Selection, Threshold, WantedExtrema, range, reported_persistences, select};
pub use skeleton::{Separatrices, separatrices};
pub use v_paths::Separatrix;
