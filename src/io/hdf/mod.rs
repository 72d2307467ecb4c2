//! VTKHDF files (`.vtkhdf`): VTK's data sets in an HDF5 file, version 1 and 2 of the format.
//!
//! The group `VTKHDF` names the kind in its attribute `Type`. Lists of parts, such as the ranks of a simulation leave them, stand one
//! behind the other in the same arrays; time steps are windows into them. The format is described in VTK's documentation, "VTKHDF
//! format specification"; what it leaves open was tried out with VTK 9.7.

mod arrays;
mod grids;
mod lists;
mod polyhedra;
mod read;
mod steps;
mod store;
mod write;

pub(super) use read::{SIGNATURE, inside, read, times};
pub(super) use write::{check, losses, write};
