//! Mesh files of other programs: `.obj .off .ply .stl .mesh .msh`; tables: `.csv .tsv`; images: `.png`; arrays: `.npy`.
//!
//! Points keep their numbers, since handles and extrema are named by them; the crate `tobj` renumbers points by group and
//! no maintained crate reads `.off`, Medit or Gmsh files, so these four are read here. `.ply` and `.stl` go through crates.

mod csv;
mod format;
mod gmsh;
mod gmsh_write;
mod medit;
mod npy;
mod obj;
mod off;
mod parts;
mod ply;
mod png;
mod series;
mod shapes;
mod stl;
mod table;

pub(super) use format::MeshFormat;
pub(super) use parts::{kind, poly_data};
pub(super) use shapes::Shapes;
pub use png::image_dataset;
pub use series::polyline;
pub use table::{Table, TableAxis};
