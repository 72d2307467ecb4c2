//! Data sets from numpy arrays.

use std::sync::Arc;

use morsmooth::io::{ArrayData, Attributes, CellArray, DataArray, DataSet, Extent, Geometry, MaskSources, domain, mask};
use morsmooth::mesh::MeshFault;
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::failure::Failure;
use crate::job::{self, Control};

/// Points, cells and the arrays that a call needs.
#[pyclass(module = "morsmooth._native")]
pub struct Mesh {
    pub dataset: Arc<DataSet>,
}

/// Offsets, one more than cells, and point numbers.
type Cells<'py> = (PyReadonlyArray1<'py, i64>, PyReadonlyArray1<'py, i64>);

#[pymethods]
impl Mesh {
    /// A regular grid.
    #[staticmethod]
    fn image(extent: [i32; 6], origin: [f64; 3], spacing: [f64; 3], direction: [f64; 9]) -> Self {
        Self::new(Geometry::ImageData { extent: Extent(extent), origin, spacing, direction })
    }

    /// A grid with one list of coordinates an axis.
    #[staticmethod]
    fn rectilinear(
        py: Python<'_>,
        extent: [i32; 6],
        x: PyReadonlyArray1<'_, f64>,
        y: PyReadonlyArray1<'_, f64>,
        z: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Self> {
        let extent = Extent(extent);
        let lists = [x.as_slice()?.to_vec(), y.as_slice()?.to_vec(), z.as_slice()?.to_vec()];
        if extent.dimensions() != [0, 1, 2].map(|axis: usize| lists[axis].len()) {
            return Err(Failure::input("found other numbers of coordinates than the extent has points").raise(py));
        }
        let coordinates = Box::new(lists.map(|list| DataArray::new("", 1, ArrayData::F64(list))));
        Ok(Self::new(Geometry::RectilinearGrid { extent, coordinates }))
    }

    /// A grid with a position for each point.
    #[staticmethod]
    fn structured(py: Python<'_>, extent: [i32; 6], points: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (extent, points) = (Extent(extent), positions(points)?);
        if extent.point_count() != points.tuples() {
            let text = format!("found {} points; the grid has {}", points.tuples(), extent.point_count());
            return Err(Failure::input(text).raise(py));
        }
        Ok(Self::new(Geometry::StructuredGrid { extent, points }))
    }

    /// Vertices, lines, polygons and strips.
    #[staticmethod]
    fn poly(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        verts: Cells<'_>,
        lines: Cells<'_>,
        polys: Cells<'_>,
        strips: Cells<'_>,
    ) -> PyResult<Self> {
        let points = positions(points)?;
        let [verts, lines, polys, strips] = [verts, lines, polys, strips].map(|list| cells(py, &list));
        Ok(Self::new(Geometry::PolyData { points, verts: verts?, lines: lines?, polys: polys?, strips: strips? }))
    }

    /// Cells of any kind.
    #[staticmethod]
    fn grid(py: Python<'_>, points: &Bound<'_, PyAny>, list: Cells<'_>, types: PyReadonlyArray1<'_, u8>) -> PyResult<Self> {
        let (points, cells) = (positions(points)?, cells(py, &list)?);
        let types = types.as_slice()?.to_vec();
        if types.len() != cells.len() {
            return Err(Failure::input(format!("found {} types for {} cells", types.len(), cells.len())).raise(py));
        }
        // Faces of polyhedra are not passed on: no computation takes polyhedra, and the library says so.
        Ok(Self::new(Geometry::UnstructuredGrid { points, cells, types, polyhedra: None }))
    }

    #[getter]
    fn point_count(&self) -> usize {
        self.dataset.point_count()
    }

    #[getter]
    fn cell_count(&self) -> usize {
        self.dataset.cell_count()
    }

    /// Adds an array on the points, `n` or `n x c`.
    fn set_point_array(&mut self, py: Python<'_>, name: &str, values: &Bound<'_, PyAny>) -> PyResult<()> {
        let count = self.dataset.point_count();
        set(py, &mut Arc::make_mut(&mut self.dataset).point_data, ("points", count), array(name, values)?)
    }

    /// Adds an array on the cells, `m` or `m x c`.
    fn set_cell_array(&mut self, py: Python<'_>, name: &str, values: &Bound<'_, PyAny>) -> PyResult<()> {
        let count = self.dataset.cell_count();
        set(py, &mut Arc::make_mut(&mut self.dataset).cell_data, ("cells", count), array(name, values)?)
    }
}

impl Mesh {
    fn new(geometry: Geometry) -> Self {
        Self { dataset: Arc::new(DataSet::new(geometry)) }
    }
}

fn set(py: Python<'_>, attributes: &mut Attributes, (what, count): (&str, usize), array: DataArray) -> PyResult<()> {
    if array.tuples() != count {
        let text = format!("the array '{}' has {} values; the mesh has {count} {what}", array.name, array.tuples());
        return Err(Failure::input(text).raise(py));
    }
    attributes.set(array);
    Ok(())
}

/// `n x 3` positions of 32 or 64 bits.
fn positions(values: &Bound<'_, PyAny>) -> PyResult<DataArray> {
    let points = array("Points", values)?;
    if points.components != 3 || !points.data.value_type().is_float() {
        return Err(Failure::input("found points that are not n x 3 floating-point numbers").raise(values.py()));
    }
    Ok(points)
}

fn cells(py: Python<'_>, (offsets, connectivity): &Cells<'_>) -> PyResult<CellArray> {
    let (offsets, connectivity) = (offsets.as_slice()?.to_vec(), connectivity.as_slice()?.to_vec());
    let is_rising = offsets.first() == Some(&0) && offsets.is_sorted() && offsets.last().copied() == i64::try_from(connectivity.len()).ok();
    if !is_rising {
        return Err(Failure::input("found offsets of cells that do not rise from 0 to the length of the connectivity").raise(py));
    }
    Ok(CellArray { offsets, connectivity, ..CellArray::default() })
}

/// An array of numbers in rows, with the type it has.
fn array(name: &str, values: &Bound<'_, PyAny>) -> PyResult<DataArray> {
    fn of<T: Element + Copy>(values: &Bound<'_, PyAny>, wrap: impl Fn(Vec<T>) -> ArrayData) -> PyResult<Option<(usize, ArrayData)>> {
        let Ok(values) = values.cast::<PyArrayDyn<T>>() else { return Ok(None) };
        let components = if values.ndim() > 1 { values.shape()[1..].iter().product() } else { 1 };
        Ok(Some((components, wrap(values.readonly().as_slice()?.to_vec()))))
    }
    let found = [
        of::<f64>(values, ArrayData::F64)?,
        of::<f32>(values, ArrayData::F32)?,
        of::<i64>(values, ArrayData::I64)?,
        of::<i32>(values, ArrayData::I32)?,
        of::<u8>(values, ArrayData::U8)?,
        of::<i8>(values, ArrayData::I8)?,
        of::<i16>(values, ArrayData::I16)?,
        of::<u16>(values, ArrayData::U16)?,
        of::<u32>(values, ArrayData::U32)?,
        of::<u64>(values, ArrayData::U64)?,
    ];
    match found.into_iter().flatten().next() {
        Some((components, data)) => Ok(DataArray::new(name, components.max(1), data)),
        None => Err(Failure::input(format!("the array '{name}' does not hold numbers")).raise(values.py())),
    }
}

/// What is unusual about a mesh: a text and whether it says that points lie on each other, for each fault.
#[pyfunction]
pub fn faults(py: Python<'_>, mesh: &Mesh, control: Control) -> PyResult<Vec<(String, bool)>> {
    let dataset = Arc::clone(&mesh.dataset);
    job::run(py, &control, move |talk| {
        talk.stage("checking", 0.0);
        let kept = mask(&dataset, &MaskSources::default()).map_err(Failure::input)?;
        let domain = domain(&dataset, &kept).map_err(Failure::input)?;
        let found = morsmooth::mesh::faults(&domain);
        Ok(found.iter().map(|fault| (fault.to_string(), matches!(fault, MeshFault::DuplicatePoints { .. }))).collect())
    })
}
