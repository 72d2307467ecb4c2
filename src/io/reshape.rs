//! The same data set as another kind of geometry.

use super::array::{ArrayData, DataArray};
use super::dataset::{CellArray, DataSet, Geometry};
use super::formats::{Shapes, kind, poly_data};
use super::write::Objection;

/// The kind of geometry that a file of some format holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum GeometryKind {
    /// `.vti`.
    ImageData,
    /// `.vtr`.
    RectilinearGrid,
    /// `.vts`.
    StructuredGrid,
    /// `.vtp`, and the mesh formats of surfaces.
    PolyData,
    /// `.vtu`, and the mesh formats of volumes.
    UnstructuredGrid,
}

impl GeometryKind {
    /// The kind that files of an extension hold; `None` for `.vtk`, which holds every kind, and for unknown ones.
    pub fn of_extension(extension: &str) -> Option<Self> {
        match extension.to_ascii_lowercase().as_str() {
            "vti" | "png" | "npy" => Some(Self::ImageData),
            "vtr" => Some(Self::RectilinearGrid),
            "vts" => Some(Self::StructuredGrid),
            "vtp" | "obj" | "off" | "ply" | "stl" => Some(Self::PolyData),
            "vtu" | "mesh" | "msh" => Some(Self::UnstructuredGrid),
            _ => None,
        }
    }

    fn of(geometry: &Geometry) -> Self {
        match geometry {
            Geometry::ImageData { .. } => Self::ImageData,
            Geometry::RectilinearGrid { .. } => Self::RectilinearGrid,
            Geometry::StructuredGrid { .. } => Self::StructuredGrid,
            Geometry::PolyData { .. } => Self::PolyData,
            Geometry::UnstructuredGrid { .. } => Self::UnstructuredGrid,
        }
    }
}

/// Why a data set has no counterpart of another kind.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("found {found}; expected {expected}")]
pub struct ReshapeError {
    /// What the data set has.
    pub found: String,
    /// What the kind can hold.
    pub expected: String,
}

impl From<Objection> for ReshapeError {
    fn from((found, expected): Objection) -> Self {
        Self { found, expected }
    }
}

/// The same points, cells and arrays as another kind of geometry.
///
/// Every kind becomes an unstructured grid, an image also a rectilinear or structured grid, a rectilinear grid a structured one,
/// and an unstructured grid of vertices, lines and polygons poly data (whose cells VTK counts kind by kind, so their arrays are
/// rearranged with them). Points keep their numbers.
///
/// # Errors
/// [`ReshapeError`] for everything else, with the first cell that does not fit.
///
/// # Cost
/// Linear; what need not change is moved.
pub fn reshape(dataset: DataSet, kind: GeometryKind) -> Result<DataSet, ReshapeError> {
    use GeometryKind as Kind;
    match (Kind::of(&dataset.geometry), kind) {
        (from, to) if from == to => Ok(dataset),
        (_, Kind::UnstructuredGrid) => unstructured(dataset),
        (Kind::ImageData, Kind::RectilinearGrid) => rectilinear(dataset),
        (Kind::ImageData | Kind::RectilinearGrid, Kind::StructuredGrid) => Ok(structured(dataset)),
        (Kind::UnstructuredGrid, Kind::PolyData) => poly(dataset),
        (_, to) => Err(ReshapeError {
            found: dataset.geometry.name().to_owned(),
            expected: match to {
                Kind::PolyData => "poly data, or an unstructured grid of vertices, lines and polygons".to_owned(),
                Kind::ImageData => "image data".to_owned(),
                _ => "image data or a rectilinear grid".to_owned(),
            },
        }),
    }
}

fn with_geometry(dataset: DataSet, geometry: Geometry) -> DataSet {
    DataSet { geometry, version: None, ..dataset }
}

fn rectilinear(dataset: DataSet) -> Result<DataSet, ReshapeError> {
    let Geometry::ImageData { extent, origin, spacing, direction } = dataset.geometry else { return Ok(dataset) };
    if direction != [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0] {
        let expected = "axes along x, y and z".to_owned();
        return Err(ReshapeError { found: format!("an image with the axes {direction:?}"), expected });
    }
    let coordinates = [0, 1, 2].map(|axis| {
        let places = (extent.0[2 * axis]..=extent.0[2 * axis + 1]).map(|index| origin[axis] + f64::from(index) * spacing[axis]);
        DataArray::new(["x", "y", "z"][axis], 1, ArrayData::F64(places.collect()))
    });
    Ok(with_geometry(dataset, Geometry::RectilinearGrid { extent, coordinates: Box::new(coordinates) }))
}

fn structured(dataset: DataSet) -> DataSet {
    let points = positions(&dataset);
    match dataset.geometry {
        Geometry::ImageData { extent, .. } | Geometry::RectilinearGrid { extent, .. } => {
            with_geometry(dataset, Geometry::StructuredGrid { extent, points })
        }
        _ => dataset,
    }
}

fn positions(dataset: &DataSet) -> DataArray {
    DataArray::new("Points", 3, ArrayData::F64(dataset.points_f64().into_iter().flatten().collect()))
}

/// Cells of grids as VTK has them: lines, pixels and voxels, or quads and hexahedra where points lie anywhere.
fn unstructured(dataset: DataSet) -> Result<DataSet, ReshapeError> {
    let (cells, types) = match &dataset.geometry {
        Geometry::ImageData { extent, .. } | Geometry::RectilinearGrid { extent, .. } => grid_cells(extent.dimensions(), true),
        Geometry::StructuredGrid { extent, .. } => grid_cells(extent.dimensions(), false),
        _ => {
            let shapes = Shapes::of(&dataset)?;
            let mut cells = CellArray::default();
            let mut types = Vec::new();
            for (kind, corners) in shapes.cells() {
                cells.push(corners.iter().copied());
                types.push(kind);
            }
            (cells, types)
        }
    };
    let mut dataset = dataset;
    let points = match &mut dataset.geometry {
        Geometry::StructuredGrid { points, .. } | Geometry::PolyData { points, .. } => {
            std::mem::replace(points, DataArray::new("", 1, ArrayData::F64(Vec::new())))
        }
        _ => positions(&dataset),
    };
    Ok(with_geometry(dataset, Geometry::UnstructuredGrid { points, cells, types, polyhedra: None }))
}

fn grid_cells(dimensions: [usize; 3], are_axes_straight: bool) -> (CellArray, Vec<u8>) {
    let long: Vec<usize> = (0..3).filter(|&axis| dimensions[axis] > 1).collect();
    let strides = [1, dimensions[0], dimensions[0] * dimensions[1]];
    let shape = match (long.len(), are_axes_straight) {
        (0, _) => kind::VERTEX,
        (1, _) => kind::LINE,
        (2, true) => kind::PIXEL,
        (2, false) => kind::QUAD,
        (_, true) => kind::VOXEL,
        (_, false) => kind::HEXAHEDRON,
    };
    let mut corners: Vec<usize> = (0..1usize << long.len())
        .map(|corner| long.iter().enumerate().map(|(bit, &axis)| (corner >> bit & 1) * strides[axis]).sum())
        .collect();
    if matches!(shape, kind::QUAD | kind::HEXAHEDRON) {
        // Around, not row by row.
        corners.chunks_mut(4).for_each(|layer| layer.swap(2, 3));
    }
    let mut cells = CellArray::default();
    let mut types = Vec::new();
    if dimensions.contains(&0) {
        return (cells, types);
    }
    let counts = dimensions.map(|points| if points > 1 { points - 1 } else { 1 });
    for k in 0..counts[2] {
        for j in 0..counts[1] {
            for i in 0..counts[0] {
                let first = i + strides[1] * j + strides[2] * k;
                cells.push(corners.iter().map(|corner| (first + corner) as i64));
                types.push(shape);
            }
        }
    }
    (cells, types)
}

fn poly(dataset: DataSet) -> Result<DataSet, ReshapeError> {
    let Geometry::UnstructuredGrid { points, cells, types, .. } = dataset.geometry else { return Ok(dataset) };
    if let Some(cell) = types.iter().position(|kind| !matches!(kind, 0..=7 | 9)) {
        return Err(ReshapeError {
            found: format!("cell {cell} of VTK type {}", types[cell]),
            expected: "vertices, lines and polygons (types 1 to 7 and 9)".to_owned(),
        });
    }
    let (point_active, cell_active) = (dataset.point_data.active, dataset.cell_data.active);
    let made = poly_data(points, &cells, &types, dataset.point_data.arrays, dataset.cell_data.arrays);
    let mut made = DataSet { field_data: dataset.field_data, title: dataset.title, ..made };
    made.point_data.active = point_active;
    made.cell_data.active = cell_active;
    Ok(made)
}
