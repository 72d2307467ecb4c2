//! The module `mesh`.

mod complexes;
mod faults;
mod grids;
mod handles;
mod implicit;
mod masks;
mod outlines;
mod polygons;
mod real;
mod refusals;
pub mod shapes;
mod volumes;
