//! The persistence diagram of the sublevel sets in all dimensions, read from the discrete gradient.
//!
//! * Minima die at critical edges: union–find over the two V-paths of each.
//! * Top cells fill what critical facets close: union–find over the dual graph, with one node for the outside.
//! * In three dimensions, the critical edges and triangles that are left are paired by reduction of the Morse boundary.
//!   So is the last dimension of domains that are no manifolds along facets.
//!
//! TTK writes the same pairs to files but for one convention: the class of the global minimum, which never dies, is paired
//! with the global maximum and marked as not finite, and other essential classes are left out.

mod build;
mod column;
mod critical;
mod extrema;
mod flow;
mod landscape;
mod pair;
mod reduction;

pub use build::{DiagramStage, diagram_of_gradient, diagram_of_gradient_by_stage, persistence_diagram};
pub use pair::{PersistenceDiagram, PersistencePair};
