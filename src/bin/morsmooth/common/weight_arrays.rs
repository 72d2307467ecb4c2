//! Weights of handles as point arrays of a file, read for those who move a shape by them.

use std::path::Path;

use morsmooth::io::{ArrayData, DataSet, is_same_file, read_mesh_or_outline};
use morsmooth::mesh::{Domain, OutlineOptions};

use crate::failure::Failure;

/// Field data of a file of weights: the names of the handles.
const HANDLE_NAMES: &str = "handle_names";

/// A mesh that was read.
pub struct Mesh<'a> {
    /// The file.
    pub path: &'a Path,
    /// All of it.
    pub dataset: &'a DataSet,
    /// Its elements.
    pub domain: &'a Domain,
}

/// A file whose point arrays are weights on the points of a mesh.
pub struct WeightFile<'a> {
    path: &'a Path,
    mesh: &'a Mesh<'a>,
    /// `None` where the mesh has the weights itself.
    own: Option<DataSet>,
}

impl<'a> WeightFile<'a> {
    /// Reads the file, unless it is the mesh, and compares the numbers of points.
    pub fn read(path: &'a Path, mesh: &'a Mesh<'a>, outline: &OutlineOptions) -> Result<Self, Failure> {
        let own = match is_same_file(mesh.path, path) {
            true => None,
            false => Some(read_mesh_or_outline(path, outline).map_err(|error| Failure::usage(error.to_string()))?),
        };
        let file = Self { path, mesh, own };
        let (found, expected) = (file.dataset().point_count(), mesh.dataset.point_count());
        if found != expected {
            return Err(Failure::file(path, format!("found weights for {found} points; {} has {expected}", mesh.path.display())));
        }
        Ok(file)
    }

    /// What is in the file.
    pub fn dataset(&self) -> &DataSet {
        self.own.as_ref().unwrap_or(self.mesh.dataset)
    }

    /// The handles that the file itself names.
    pub fn handle_names(&self) -> Option<Vec<String>> {
        let array = self.dataset().field_data.iter().find(|array| array.name == HANDLE_NAMES)?;
        matches!(array.data, ArrayData::String(_)).then(|| array.to_texts()).filter(|names| !names.is_empty())
    }

    /// The weights on the vertices, a list a handle.
    ///
    /// # Arguments
    /// * `prefix`: comes before the name of a handle in the name of its array, as the option of this name says.
    pub fn columns(&self, names: &[String], (option, prefix): (&str, &str)) -> Result<Vec<Vec<f64>>, Failure> {
        names.iter().map(|handle| self.column(handle, (option, prefix))).collect()
    }

    fn column(&self, handle: &str, (option, prefix): (&str, &str)) -> Result<Vec<f64>, Failure> {
        let name = format!("{prefix}{handle}");
        let Some(array) = self.dataset().point_array(&name) else {
            let known: Vec<&str> = self.dataset().point_data.arrays.iter().map(|array| array.name.as_str()).collect();
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            let text = format!("found no point array '{name}'; expected the weights of the handle \"{handle}\"");
            return Err(Failure::file(self.path, text)
                .hint(format!("point arrays: {known}; {option} says what comes before the name of a handle")));
        };
        if array.components != 1 || matches!(array.data, ArrayData::String(_)) {
            let text = format!("array '{name}' has {} components; expected one number a point", array.components);
            return Err(Failure::file(self.path, text));
        }
        let values = self.mesh.domain.restrict(&array.to_f64(0));
        if let Some(vertex) = values.iter().position(|value| !value.is_finite()) {
            let point = self.mesh.domain.point_of_vertex()[vertex];
            let text = format!("array '{name}' is {} at point {point}; expected a finite number", values[vertex]);
            return Err(Failure::file(self.path, text));
        }
        Ok(values)
    }
}

/// From one list a handle to one row a vertex: `n x h`.
pub fn rows(columns: &[Vec<f64>]) -> Vec<f64> {
    let vertices = columns.first().map_or(0, Vec::len);
    (0..vertices).flat_map(|vertex| columns.iter().map(move |column| column[vertex])).collect()
}
