//! The module `mesh`.

mod complexes;
mod faults;
mod grids;
mod implicit;
mod masks;
mod polygons;
mod real;
mod refusals;
pub mod shapes;
mod volumes;
