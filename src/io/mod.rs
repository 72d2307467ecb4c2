//! Files in and out: VTK XML and legacy VTK, with everything that they hold, and the mesh files of other programs.
//!
//! [`read`] gives a [`DataSet`]: geometry and arrays in the types and the order of the file. [`write()`] and
//! [`write_temporary`] put it back; what was not changed survives bit for bit. [`read_handles`], [`read_pose`] and [`read_outline`] read
//! what moves a shape, and shapes given by their rim.

mod array;
mod bytes;
mod cells;
mod collection;
mod dataset;
mod diagram;
mod dmat;
mod domain;
mod error;
mod fingerprint;
mod formats;
mod handles;
#[cfg(feature = "vtkhdf")]
mod hdf;
mod json;
mod legacy;
mod lexer;
#[cfg(feature = "vtkio")]
mod model;
mod outline;
mod parallel;
mod pending;
mod pose;
mod positions;
mod read;
mod reshape;
mod ttk;
mod weld;
mod write;
mod xml;

pub use array::{ArrayData, DataArray, InformationKey, InformationValue, ValueType};
pub use collection::{Collection, CollectionKind, Entry, resolve, write_collection};
pub use dataset::{Attributes, CellArray, DataSet, Extent, Geometry, IndexWidth, Polyhedra, Role};
pub use diagram::{DiagramField, DiagramLayout, diagram_dataset};
pub use domain::{DomainIoError, MaskSources, domain, grid, mask};
pub use error::{IoError, Place};
pub use fingerprint::fingerprint;
pub use formats::{Table, TableAxis, image_dataset, polyline};
pub use handles::{read_handles, region_handles};
pub use outline::{outline_dataset, read_mesh_or_outline, read_outline};
pub use pending::{PendingFile, is_same_file, remove_pending_files};
pub use pose::{read_keys, read_pose};
pub use positions::set_positions;
pub use read::read;
pub use reshape::{GeometryKind, ReshapeError, reshape};
pub use ttk::{Numbering, TtkComplex, TtkError};
#[cfg(feature = "vtkio")]
pub use model::{VtkioError, from_vtkio, to_vtkio};
pub use write::{Compression, losses, write, write_temporary, write_temporary_with};
