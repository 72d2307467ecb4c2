//! What the readers of mesh files gather, and the data set that it makes.

use crate::io::array::{ArrayData, DataArray};
use crate::io::dataset::{Attributes, CellArray, DataSet, Geometry};
use crate::io::error::{Fault, Place};

/// VTK's numbers of the cells that these formats know.
pub(in crate::io) mod kind {
    pub const VERTEX: u8 = 1;
    pub const LINE: u8 = 3;
    pub const POLYLINE: u8 = 4;
    pub const TRIANGLE: u8 = 5;
    pub const STRIP: u8 = 6;
    pub const POLYGON: u8 = 7;
    pub const PIXEL: u8 = 8;
    pub const QUAD: u8 = 9;
    pub const TETRAHEDRON: u8 = 10;
    pub const VOXEL: u8 = 11;
    pub const HEXAHEDRON: u8 = 12;
    pub const WEDGE: u8 = 13;
    pub const PYRAMID: u8 = 14;
}

/// Points and cells of a file, as they come.
#[derive(Default)]
pub(super) struct Parts {
    pub points: Vec<f64>,
    pub cells: CellArray,
    pub types: Vec<u8>,
    pub point_arrays: Vec<DataArray>,
    /// A tuple a cell, in the order of `cells`.
    pub cell_arrays: Vec<DataArray>,
}

impl Parts {
    pub fn push(&mut self, kind: u8, points: impl IntoIterator<Item = i64>) {
        self.cells.push(points);
        self.types.push(kind);
    }

    pub fn point_count(&self) -> usize {
        self.points.len() / 3
    }

    /// The number of a point that a file counts from 1, or from the last one back with negative numbers.
    pub fn resolve(&self, number: i64, place: impl Fn() -> Place) -> Result<i64, Fault> {
        let count = self.point_count() as i64;
        let index = if number < 0 { count + number } else { number - 1 };
        if (0..count).contains(&index) {
            return Ok(index);
        }
        Err(Fault::new(place(), format!("point {number}"), format!("points from 1 to {count}")))
    }

    /// Vertices, lines and polygons; cells and their arrays are put into VTK's order.
    pub fn into_poly_data(self) -> DataSet {
        let points = DataArray::new("Points", 3, ArrayData::F64(self.points));
        poly_data(points, &self.cells, &self.types, self.point_arrays, self.cell_arrays)
    }

    /// Cells of any kind, in the order of the file.
    pub fn into_unstructured(self) -> DataSet {
        let points = DataArray::new("Points", 3, ArrayData::F64(self.points));
        let geometry = Geometry::UnstructuredGrid { points, cells: self.cells, types: self.types, polyhedra: None };
        DataSet {
            point_data: Attributes { arrays: self.point_arrays, active: Vec::new() },
            cell_data: Attributes { arrays: self.cell_arrays, active: Vec::new() },
            ..DataSet::new(geometry)
        }
    }
}

/// Poly data of cells up to dimension 2, the arrays of cells rearranged as VTK counts them: vertices, lines, polygons, strips.
pub(in crate::io) fn poly_data(
    points: DataArray,
    cells: &CellArray,
    types: &[u8],
    point_arrays: Vec<DataArray>,
    cell_arrays: Vec<DataArray>,
) -> DataSet {
    let group = |cell: usize| match types[cell] {
        0..=2 => 0,
        kind::LINE | kind::POLYLINE => 1,
        kind::STRIP => 3,
        _ => 2,
    };
    let mut groups: [CellArray; 4] = Default::default();
    let mut order: Vec<usize> = (0..types.len()).collect();
    order.sort_by_key(|&cell| group(cell));
    for &cell in &order {
        groups[group(cell)].push(cells.cell(cell).iter().copied());
    }
    let is_sorted = order.iter().enumerate().all(|(place, &cell)| place == cell);
    let [verts, lines, polys, strips] = groups;
    let arrays = if is_sorted {
        cell_arrays
    } else {
        cell_arrays.into_iter().map(|array| array.gathered(&order)).collect()
    };
    DataSet {
        point_data: Attributes { arrays: point_arrays, active: Vec::new() },
        cell_data: Attributes { arrays, active: Vec::new() },
        ..DataSet::new(Geometry::PolyData { points, verts, lines, polys, strips })
    }
}
