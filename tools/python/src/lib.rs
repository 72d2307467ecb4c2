//! The extension module `morsmooth._native`: numbers from Python to the library and back. What it offers is documented in
//! `python/morsmooth`, which is the only caller.

mod deform;
mod failure;
mod field;
mod geodesic;
mod job;
mod mesh;
mod persistence;
mod rig;
mod smooth;
mod weights;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::deform::deform;
    #[pymodule_export]
    use crate::geodesic::geodesic;
    #[pymodule_export]
    use crate::mesh::{Mesh, faults};
    #[pymodule_export]
    use crate::persistence::{persistence_diagram, persistence_pairs};
    #[pymodule_export]
    use crate::smooth::{simplify, smooth};
    #[pymodule_export]
    use crate::weights::weights;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
