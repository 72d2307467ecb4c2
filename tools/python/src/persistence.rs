//! Persistence diagrams.

use std::sync::Arc;

use morsmooth::field::VertexId;
use morsmooth::io::{ArrayData, DataArray, DataSet, DiagramField, DiagramLayout, Geometry, diagram_dataset};
use morsmooth::morse::{PersistenceDiagram, persistence_diagram as diagram_of};
use morsmooth::smooth::MeasuredField;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure::Failure;
use crate::field::{Field, to_numpy};
use crate::job::{self, Control, Talk};
use crate::mesh::Mesh;

/// Which field.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Options {
    array: String,
    mask: Option<String>,
}

fn diagram(dataset: &Arc<DataSet>, options: &Options, talk: &mut Talk) -> Result<(Field, MeasuredField, PersistenceDiagram), Failure> {
    talk.stage("reading", 0.0);
    let field = Field::new(dataset, &options.array, options.mask.as_deref())?;
    talk.stage("extrema", 0.2);
    let measured = MeasuredField::new(&field.domain.complex, field.values.clone()).map_err(|error| field.failure(&error))?;
    talk.stage("persistence diagram", 0.4);
    let diagram = diagram_of(&field.domain.complex, &measured.order).map_err(|error| field.failure(&error.into()))?;
    talk.stage("done", 1.0);
    Ok((field, measured, diagram))
}

/// Columns `dimension`, `birth`, `death`, `birth_point`, `death_point`; deaths of classes that never die are infinite, at point -1.
#[pyfunction]
pub fn persistence_pairs<'py>(py: Python<'py>, mesh: &Mesh, options: Options, control: Control) -> PyResult<Bound<'py, PyDict>> {
    let dataset = Arc::clone(&mesh.dataset);
    let (field, diagram) = job::run(py, &control, move |talk| diagram(&dataset, &options, talk).map(|(field, _, diagram)| (field, diagram)))?;
    let pairs = diagram.pairs();
    let point = |vertex: VertexId| i64::from(field.domain.point_of_vertex()[vertex.index()]);
    let value = |vertex: VertexId| field.values[vertex.index()];
    let columns = PyDict::new(py);
    let dimensions: Vec<i8> = pairs.iter().map(|pair| pair.dimension as i8).collect();
    let births: Vec<f64> = pairs.iter().map(|pair| value(pair.birth_vertex)).collect();
    let deaths: Vec<f64> = pairs.iter().map(|pair| pair.death_vertex.map_or(f64::INFINITY, value)).collect();
    let birth_points: Vec<i64> = pairs.iter().map(|pair| point(pair.birth_vertex)).collect();
    let death_points: Vec<i64> = pairs.iter().map(|pair| pair.death_vertex.map_or(-1, point)).collect();
    columns.set_item("dimension", PyArray1::from_vec(py, dimensions))?;
    columns.set_item("birth", PyArray1::from_vec(py, births))?;
    columns.set_item("death", PyArray1::from_vec(py, deaths))?;
    columns.set_item("birth_point", PyArray1::from_vec(py, birth_points))?;
    columns.set_item("death_point", PyArray1::from_vec(py, death_points))?;
    Ok(columns)
}

/// The diagram as lines, in the layout of TTK: `points`, `lines`, `point_data`, `cell_data`.
#[pyfunction]
pub fn persistence_diagram<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    options: Options,
    embed: bool,
    control: Control,
) -> PyResult<Bound<'py, PyDict>> {
    let dataset = Arc::clone(&mesh.dataset);
    let dataset = job::run(py, &control, move |talk| {
        let (field, measured, diagram) = diagram(&dataset, &options, talk)?;
        let value_type = dataset.point_array(&field.name).map(|array| array.data.value_type());
        let value_type = value_type.ok_or_else(|| Failure::internal("internal error: no array"))?;
        let described = DiagramField { domain: &field.domain, values: &measured.values, value_type };
        let layout = if embed { DiagramLayout::Embedded } else { DiagramLayout::Plane };
        Ok(diagram_dataset(&diagram, &described, layout))
    })?;
    let parts = PyDict::new(py);
    let Geometry::UnstructuredGrid { points, cells, .. } = dataset.geometry else {
        return Err(Failure::internal("internal error: no unstructured grid").raise(py));
    };
    parts.set_item("points", numbers(py, points)?)?;
    parts.set_item("lines", PyArray1::from_vec(py, cells.connectivity))?;
    for (name, attributes) in [("point_data", dataset.point_data), ("cell_data", dataset.cell_data)] {
        let arrays = PyDict::new(py);
        for array in attributes.arrays {
            arrays.set_item(array.name.clone(), numbers(py, array)?)?;
        }
        parts.set_item(name, arrays)?;
    }
    Ok(parts)
}

/// An array in the type it has, in rows if it has components.
fn numbers(py: Python<'_>, array: DataArray) -> PyResult<Py<PyAny>> {
    let components = array.components;
    let flat = match array.data {
        ArrayData::U8(values) => PyArray1::from_vec(py, values).into_any().unbind(),
        ArrayData::I8(values) => PyArray1::from_vec(py, values).into_any().unbind(),
        ArrayData::U16(values) => PyArray1::from_vec(py, values).into_any().unbind(),
        ArrayData::I16(values) => PyArray1::from_vec(py, values).into_any().unbind(),
        ArrayData::U32(values) => PyArray1::from_vec(py, values).into_any().unbind(),
        ArrayData::I32(values) => PyArray1::from_vec(py, values).into_any().unbind(),
        ArrayData::U64(values) => PyArray1::from_vec(py, values).into_any().unbind(),
        ArrayData::I64(values) => PyArray1::from_vec(py, values).into_any().unbind(),
        other => to_numpy(py, other),
    };
    if components == 1 { Ok(flat) } else { flat.call_method1(py, "reshape", (-1, components)) }
}
