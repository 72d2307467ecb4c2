//! The module `mesh`.

mod complexes;
mod faults;
mod grids;
mod masks;
mod polygons;
mod refusals;
pub mod shapes;
mod timing;
mod volumes;
