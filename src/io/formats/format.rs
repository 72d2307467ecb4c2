//! The formats, by the extension of a file name.

use std::io::{BufWriter, Write};

use crate::io::dataset::DataSet;
use crate::io::error::Fault;
use crate::io::write::Objection;

use super::shapes::Shapes;
use super::{gmsh, gmsh_write, medit, npy, obj, off, ply, png, series, stl};

/// A format of a mesh file, named by its extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) enum MeshFormat {
    Obj,
    Off,
    Ply,
    Stl,
    Medit,
    Gmsh,
    Png,
    Npy,
    /// A table with this separator.
    Table(u8),
}

impl MeshFormat {
    const EXTENSIONS: [(&'static str, Self); 10] = [
        ("obj", Self::Obj),
        ("off", Self::Off),
        ("ply", Self::Ply),
        ("stl", Self::Stl),
        ("mesh", Self::Medit),
        ("msh", Self::Gmsh),
        ("png", Self::Png),
        ("npy", Self::Npy),
        ("csv", Self::Table(b',')),
        ("tsv", Self::Table(b'\t')),
    ];

    pub fn of_extension(extension: &str) -> Option<Self> {
        Self::EXTENSIONS.into_iter().find(|entry| entry.0.eq_ignore_ascii_case(extension)).map(|entry| entry.1)
    }

    pub fn read(self, bytes: &[u8]) -> Result<DataSet, Fault> {
        match self {
            Self::Obj => obj::read(bytes),
            Self::Off => off::read(bytes),
            Self::Ply => ply::read(bytes),
            Self::Stl => stl::read(bytes),
            Self::Medit => medit::read(bytes),
            Self::Gmsh => gmsh::read(bytes),
            Self::Png => png::read(bytes),
            Self::Npy => npy::read(bytes),
            Self::Table(_) => series::read(bytes),
        }
    }

    /// What of a data set the format cannot hold, in words; an empty list if nothing is lost.
    ///
    /// # Errors
    /// What makes writing impossible: cells that the format does not know.
    pub fn losses(self, dataset: &DataSet) -> Result<Vec<String>, Objection> {
        if let Self::Table(_) = self {
            return series::check(dataset).map(|()| series::losses(dataset));
        }
        if self == Self::Png {
            return png::losses(dataset);
        }
        if self == Self::Npy {
            return npy::losses(dataset);
        }
        let shapes = Shapes::of(dataset)?;
        shapes.check(self)?;
        Ok(shapes.losses(self, dataset))
    }

    pub fn write<W: Write>(self, dataset: &DataSet, out: &mut BufWriter<W>) -> std::io::Result<()> {
        if let Self::Table(delimiter) = self {
            return series::write(dataset, delimiter, out);
        }
        if self == Self::Png {
            return png::write(dataset, out);
        }
        if self == Self::Npy {
            return npy::write(dataset, out);
        }
        let shapes = Shapes::of(dataset).map_err(|(found, expected)| invalid(found, expected))?;
        match self {
            Self::Obj => obj::write(&shapes, out),
            Self::Off => off::write(&shapes, out),
            Self::Ply => ply::write(&shapes, dataset, out),
            Self::Stl => stl::write(&shapes, out),
            Self::Medit => medit::write(&shapes, dataset, out),
            Self::Gmsh => gmsh_write::write(&shapes, dataset, out),
            Self::Png | Self::Npy | Self::Table(_) => Ok(()),
        }
    }
}

fn invalid(found: String, expected: String) -> std::io::Error {
    std::io::Error::other(format!("found {found}; expected {expected}"))
}
