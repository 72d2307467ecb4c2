//! Discrete Morse theory of a vertex order: extremum pairs, the discrete gradient and what they decide.
//!
//! Minima are read from the gradient of `h`, maxima from the gradient of `-h` with reversed ties. Either gives critical
//! vertices and vertex–edge separatrices, and so also the extrema on the boundary of the domain.

mod ascent;
mod basins;
mod cancellations;
mod complex;
mod connector;
mod curve;
mod diagram;
mod error;
mod extremum_graph;
mod forest;
mod gradient;
mod hierarchy;
mod jump;
mod lattice_gradient;
mod lattice_scan;
mod lattice_star;
mod link;
mod lower_star;
mod mask_star;
mod morse_smale;
mod pairs;
mod partners;
mod segmentation;
mod selection;
mod skeleton;
mod small_star;
mod star;
mod sweep;
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
pub use cancellations::CellCancellation;
pub use hierarchy::{MorseHierarchy, SaddlePairs};
pub use morse_smale::{CriticalPoint, LineKind, MorseSmaleComplex, SeparatrixLine};
pub use pairs::{ExtremumKind, ExtremumPair, extremum_pairs};
pub use segmentation::{MorseSmaleSegmentation, Segmentation};
pub use selection::{Selection, Threshold, WantedExtrema, range, reported_persistences, select};
pub use skeleton::{Separatrices, separatrices};
pub use v_paths::Separatrix;
