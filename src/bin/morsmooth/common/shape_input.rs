//! A domain without a field of its own: a mesh, an image, an outline that is filled, or a series.

use std::path::Path;
use std::sync::Arc;

use morsmooth::field::VertexId;
use morsmooth::io::{ArrayData, DataArray, DataSet, Table, outline_dataset, read};
use morsmooth::mesh::SimplicialComplex;

use crate::args::{FieldArgs, OutlineArgs};
use crate::common::ground::Grounds;
use crate::common::input::FieldInput;
use crate::failure::Failure;

/// Reads a file; a table with columns x and y, or without a header, is an outline, and any other table a series.
pub fn load(path: &Path, outline: &OutlineArgs) -> Result<DataSet, Failure> {
    let told = |error: morsmooth::io::IoError| Failure::usage(error.to_string());
    let is_table = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"));
    // What is wrong with a table is said where it is read for good.
    if is_table && Table::read_list(path).is_ok_and(|table| is_outline(&table)) {
        return outline_dataset(path, &outline.options()).map_err(told);
    }
    read(path).map_err(told)
}

fn is_outline(table: &Table) -> bool {
    let has = |name: &str| table.names().iter().any(|own| own.eq_ignore_ascii_case(name));
    let is_pair = table.width() >= 2 && !table.has_header() && table.numbers(0).is_ok() && table.numbers(1).is_ok();
    has("x") && has("y") || is_pair
}

/// The domain of a data set, with results to be called `name`.
pub fn domain(path: &Path, dataset: DataSet, mask: Option<&String>, name: &str) -> Result<FieldInput, Failure> {
    // Numbers of points vary on every part of the domain, so that no part is left out as constant.
    let numbers = (0..dataset.point_count()).map(|point| point as f64).collect();
    let array = DataArray::new(name, 1, ArrayData::F64(numbers));
    let args = FieldArgs { input: path.to_owned(), array: None, mask: mask.cloned(), derive: None };
    let mut numbered = dataset.clone();
    numbered.set_point_array(array.clone());
    let mut input = FieldInput::of_array(&Arc::new(numbered), &array, &args, &Grounds::of_one_file())?;
    input.dataset = Arc::new(dataset);
    // Points outside have no value.
    input.on_points.iter_mut().for_each(|value| *value = f64::NAN);
    Ok(input)
}

/// Finds the vertices next to positions.
pub struct Locator<'a> {
    complex: &'a SimplicialComplex,
    /// The longest edge: no position on the mesh is farther from a vertex.
    longest: f64,
}

impl<'a> Locator<'a> {
    /// Measures the edges.
    pub fn new(complex: &'a SimplicialComplex) -> Self {
        let length = |&[a, b]: &[VertexId; 2]| distance(complex.point(a), complex.point(b));
        Self { complex, longest: complex.edges().iter().map(length).fold(0.0, f64::max) }
    }

    /// The nearest vertex, or its distance where that is more than the longest edge.
    pub fn nearest(&self, position: [f64; 3]) -> Result<VertexId, f64> {
        let found = self.complex.points().iter().enumerate().map(|(vertex, &point)| (distance(point, position), vertex));
        match found.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))) {
            Some((distance, vertex)) if distance <= self.longest => Ok(VertexId::from(vertex)),
            Some((distance, _)) => Err(distance),
            None => Err(f64::INFINITY),
        }
    }

    /// Vertices along a segment, joined by edges, in its direction.
    pub fn along(&self, from: [f64; 3], to: [f64; 3]) -> Result<Vec<VertexId>, f64> {
        let complex = self.complex;
        let count = complex.edges().len().max(1) as f64;
        let mean = complex.edges().iter().map(|&[a, b]| distance(complex.point(a), complex.point(b))).sum::<f64>() / count;
        // Four samples an edge, so that hardly a vertex beside the segment is missed.
        let samples = (4.0 * distance(from, to) / mean).ceil().clamp(1.0, 1e5) as usize;
        let mut found: Vec<VertexId> = Vec::new();
        for sample in 0..=samples {
            let part = sample as f64 / samples as f64;
            let position = [0, 1, 2].map(|axis| from[axis] + part * (to[axis] - from[axis]));
            let vertex = self.nearest(position)?;
            let Some(&last) = found.last() else {
                found.push(vertex);
                continue;
            };
            if last == vertex {
                continue;
            }
            let neighbours = complex.neighbours(last);
            if !neighbours.contains(&vertex) {
                // A common neighbour closes the gap.
                let between = neighbours.iter().filter(|neighbour| complex.neighbours(**neighbour).contains(&vertex));
                let near = |vertex: &&VertexId| distance(complex.point(**vertex), position);
                found.extend(between.min_by(|a, b| near(a).total_cmp(&near(b))));
            }
            found.push(vertex);
        }
        Ok(found)
    }
}

/// How far two points are apart.
pub fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt()
}
