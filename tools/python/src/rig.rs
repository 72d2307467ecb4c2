//! Handles and poses: from files, from Python's own objects by way of the files' format, and from arrays.

use std::path::{Path, PathBuf};

use morsmooth::field::VertexId;
use morsmooth::io::{DataSet, IoError, MaskSources, domain, mask, read_handles, read_pose, region_handles};
use morsmooth::mesh::{AttachOptions, AttachedHandles, Domain, HandleSet, MeshFault, Pose, SimplicialComplex, check, folds};
use pyo3::prelude::*;

use crate::failure::Failure;

/// A file, or what would stand in one.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Source {
    path: Option<PathBuf>,
    json: Option<String>,
    /// Name of an array of the mesh.
    array: Option<String>,
}

impl Source {
    /// Reads it, by the reader of the library, so that both forms mean the same and are refused in the same words.
    fn read<T>(&self, what: &str, read: impl Fn(&Path) -> Result<T, IoError>) -> Result<T, Failure> {
        if let Some(path) = &self.path {
            return read(path).map_err(Failure::input);
        }
        let fail = |error: std::io::Error| Failure::input(format!("{what} could not be handed over in a temporary file: {error}"));
        let folder = tempfile::tempdir().map_err(fail)?;
        let path = folder.path().join(format!("{what}.json"));
        std::fs::write(&path, self.json.as_deref().unwrap_or("{}")).map_err(fail)?;
        read(&path).map_err(|error| Failure::input(error.to_string().replace(&path.display().to_string(), what)))
    }
}

/// A mesh with handles.
pub struct Scene {
    /// What is computed on.
    pub domain: Domain,
    /// Regions in vertices.
    pub handles: HandleSet,
    /// The vertices that carry them.
    pub attached: AttachedHandles,
}

impl Scene {
    /// Builds the domain and attaches the handles.
    pub fn new(dataset: &DataSet, source: &Source) -> Result<Self, Failure> {
        let kept = mask(dataset, &MaskSources::default()).map_err(Failure::input)?;
        let domain = domain(dataset, &kept).map_err(Failure::input)?;
        let set = match &source.array {
            Some(name) => region_handles(dataset, name).map_err(Failure::input)?,
            None => source.read("handles", |path| read_handles(path))?,
        };
        let handles = set.renumbered(domain.vertex_of_point()).map_err(Failure::input)?;
        let attached = handles.attach(&domain.complex, &AttachOptions::default()).map_err(Failure::input)?;
        Ok(Self { domain, handles, attached })
    }

    /// Refuses meshes on which weights mean nothing.
    pub fn check_for_weights(&self) -> Result<(), Failure> {
        check(&self.domain).map_err(Failure::input)?;
        let loose = |note: &&MeshFault| matches!(note, MeshFault::UnreferencedPoints { .. } | MeshFault::IsolatedPoints { .. });
        if let Some(MeshFault::UnreferencedPoints { count, first } | MeshFault::IsolatedPoints { count, first }) =
            self.domain.notes.iter().find(loose)
        {
            let text = format!("{count} points belong to no cell, first point {first}; expected every point to be a corner of one");
            return Err(Failure::input(text).hint("no handle reaches them, so they have no weights: remove them from the mesh"));
        }
        if let Some(fold) = folds(&self.domain.complex).first() {
            let cells = [fold.first, fold.second].map(|simplex| self.domain.cell_of_simplex()[simplex]);
            let corners = [fold.first, fold.second].map(|simplex| {
                let vertices: Vec<VertexId> = self.domain.complex.simplex(simplex).iter().map(|&vertex| VertexId(vertex)).collect();
                self.domain.points_of(&vertices)
            });
            return Err(Failure::input(format!(
                "cells {} and {} (points {:?} and {:?}) lie on the same side of what they share: one of them is inverted; expected \
                 neighbours on either side",
                cells[0], cells[1], corners[0], corners[1]
            )));
        }
        Ok(())
    }

    /// The elements.
    pub fn complex(&self) -> &SimplicialComplex {
        &self.domain.complex
    }

    /// Reads a pose of the handles.
    pub fn pose(&self, source: &Source) -> Result<Pose, Failure> {
        source.read("pose", |path| read_pose(path, &self.handles, &self.domain.complex))
    }
}
