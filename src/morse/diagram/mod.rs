//! The persistence diagram of the sublevel sets in all dimensions, read from the discrete gradient.
//!
//! * Minima die at critical edges: union–find over the two V-paths of each.
//! * Top cells fill what critical facets close: union–find over the dual graph, with one node for the outside.
//! * In three dimensions, the critical edges and triangles that are left are paired by reduction of the Morse boundary.
//!   So is the last dimension of domains that are no manifolds along facets.
//!
//! TTK (`PersistenceDiagram`, Discrete Morse Sandwich) lists the same pairs. It gives every essential class the global
//! maximum, [`PersistenceDiagram::highest_vertex`], as death and marks it as not finite, so that its pair 0 is that of the
//! global minimum with the global maximum; classes of dimension 3 it does not list.

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
