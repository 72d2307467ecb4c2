//! One VTK data set, with everything that its file holds.

use super::array::{ArrayData, DataArray};

/// The points of a structured data set: first and last index along each axis, both included.
///
/// An axis with `last < first` makes the data set empty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extent(
    /// `[x_first, x_last, y_first, y_last, z_first, z_last]`.
    pub [i32; 6],
);

impl Extent {
    /// The extent of `dimensions` points that starts at 0.
    pub(super) fn of_dimensions(dimensions: [i32; 3]) -> Self {
        let [x, y, z] = dimensions.map(|points| points.saturating_sub(1));
        Self([0, x, 0, y, 0, z])
    }

    /// Points along each axis; all 0 if the extent is empty.
    pub fn dimensions(&self) -> [usize; 3] {
        let points = |axis: usize| (i64::from(self.0[2 * axis + 1]) - i64::from(self.0[2 * axis]) + 1).max(0) as usize;
        let dimensions = [points(0), points(1), points(2)];
        if dimensions.contains(&0) { [0; 3] } else { dimensions }
    }

    /// Cells along each axis. A flat axis counts one layer of cells, unless the extent is empty.
    pub fn cell_dimensions(&self) -> [usize; 3] {
        self.dimensions().map(|points| if points > 1 { points - 1 } else { points })
    }

    /// Number of points; `usize::MAX` if it does not fit.
    pub fn point_count(&self) -> usize {
        product(self.dimensions())
    }

    /// Number of cells; `usize::MAX` if it does not fit.
    pub fn cell_count(&self) -> usize {
        product(self.cell_dimensions())
    }
}

fn product(counts: [usize; 3]) -> usize {
    counts[0].saturating_mul(counts[1]).saturating_mul(counts[2])
}

/// Width of the integers in which a file stores cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum IndexWidth {
    /// `Int32`.
    Bits32,
    /// `Int64`.
    #[default]
    Bits64,
}

/// Lists of point numbers: cell `i` is `connectivity[offsets[i] .. offsets[i + 1]]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CellArray {
    /// `cells + 1` rising numbers, the first is 0.
    pub offsets: Vec<i64>,
    /// Point numbers.
    pub connectivity: Vec<i64>,
    /// How a file stores the numbers.
    pub width: IndexWidth,
}

impl Default for CellArray {
    fn default() -> Self {
        Self { offsets: vec![0], connectivity: Vec::new(), width: IndexWidth::default() }
    }
}

impl CellArray {
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Point numbers of one cell.
    pub fn cell(&self, cell: usize) -> &[i64] {
        &self.connectivity[self.offsets[cell] as usize..self.offsets[cell + 1] as usize]
    }

    /// All cells.
    pub fn iter(&self) -> impl Iterator<Item = &[i64]> {
        (0..self.len()).map(|cell| self.cell(cell))
    }

    /// Adds a cell at the end.
    pub fn push(&mut self, points: impl IntoIterator<Item = i64>) {
        self.connectivity.extend(points);
        self.offsets.push(self.connectivity.len() as i64);
    }
}

/// Faces of the polyhedra of an unstructured grid, in either of VTK's layouts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Polyhedra {
    /// Before format version 2.3: for each polyhedron a run `faces, (points, point ...) ...`.
    Stream {
        /// The runs, one after the other.
        faces: Vec<i64>,
        /// For each cell the end of its run in `faces`, or -1 for a cell that is no polyhedron.
        offsets: Vec<i64>,
        /// How a file stores the numbers.
        width: IndexWidth,
    },
    /// From format version 2.3: faces as cells, polyhedra as lists of faces.
    Lists {
        /// Point numbers of every face.
        faces: CellArray,
        /// Face numbers of every cell; empty lists for cells that are no polyhedra.
        cells: CellArray,
    },
}

/// Where the points and cells of a data set are.
#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// A regular grid: point `(i, j, k)` lies at `origin + direction (i, j, k) * spacing`.
    ImageData {
        /// Indices of the points.
        extent: Extent,
        /// Position of point (0, 0, 0), which may lie outside the extent.
        origin: [f64; 3],
        /// Distance of neighbours along each axis, in the unit of the file.
        spacing: [f64; 3],
        /// Row-major matrix whose columns are the axes; the identity almost always.
        direction: [f64; 9],
    },
    /// A grid with one list of coordinates an axis.
    RectilinearGrid {
        /// Indices of the points.
        extent: Extent,
        /// Coordinates along x, y, z.
        coordinates: Box<[DataArray; 3]>,
    },
    /// A grid with a position for each point.
    StructuredGrid {
        /// Indices of the points.
        extent: Extent,
        /// `n x 3` positions.
        points: DataArray,
    },
    /// Vertices, lines, polygons and strips. Cell arrays list them in this order.
    PolyData {
        /// `n x 3` positions.
        points: DataArray,
        /// Poly-vertices.
        verts: CellArray,
        /// Polylines.
        lines: CellArray,
        /// Polygons.
        polys: CellArray,
        /// Triangle strips.
        strips: CellArray,
    },
    /// Cells of any kind.
    UnstructuredGrid {
        /// `n x 3` positions.
        points: DataArray,
        /// Point numbers of the cells.
        cells: CellArray,
        /// VTK's number for the kind of each cell.
        types: Vec<u8>,
        /// Faces, if a cell is a polyhedron.
        polyhedra: Option<Polyhedra>,
    },
}

impl Geometry {
    /// The name of the kind, as VTK writes it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::ImageData { .. } => "ImageData",
            Self::RectilinearGrid { .. } => "RectilinearGrid",
            Self::StructuredGrid { .. } => "StructuredGrid",
            Self::PolyData { .. } => "PolyData",
            Self::UnstructuredGrid { .. } => "UnstructuredGrid",
        }
    }

    /// The file extension that VTK gives the kind.
    pub fn extension(&self) -> &'static str {
        match self {
            Self::ImageData { .. } => "vti",
            Self::RectilinearGrid { .. } => "vtr",
            Self::StructuredGrid { .. } => "vts",
            Self::PolyData { .. } => "vtp",
            Self::UnstructuredGrid { .. } => "vtu",
        }
    }
}

/// What VTK takes an array for, when a filter does not name one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are VTK's")]
#[non_exhaustive]
pub enum Role {
    Scalars,
    Vectors,
    Normals,
    TCoords,
    Tensors,
    GlobalIds,
    PedigreeIds,
    EdgeFlag,
    Tangents,
    RationalWeights,
    HigherOrderDegrees,
    ProcessIds,
}

impl Role {
    const NAMES: [(Self, &'static str); 12] = [
        (Self::Scalars, "Scalars"),
        (Self::Vectors, "Vectors"),
        (Self::Normals, "Normals"),
        (Self::TCoords, "TCoords"),
        (Self::Tensors, "Tensors"),
        (Self::GlobalIds, "GlobalIds"),
        (Self::PedigreeIds, "PedigreeIds"),
        (Self::EdgeFlag, "EdgeFlag"),
        (Self::Tangents, "Tangents"),
        (Self::RationalWeights, "RationalWeights"),
        (Self::HigherOrderDegrees, "HigherOrderDegrees"),
        (Self::ProcessIds, "ProcessIds"),
    ];

    /// Every role, in VTK's order.
    #[cfg(feature = "vtkhdf")]
    pub(super) fn all() -> impl Iterator<Item = Self> {
        Self::NAMES.iter().map(|entry| entry.0)
    }

    /// The name in VTK XML.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].1
    }

    pub(super) fn of_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|entry| entry.1 == name).map(|entry| entry.0)
    }
}

/// The arrays on the points, or on the cells, of a data set.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Attributes {
    /// In the order of the file.
    pub arrays: Vec<DataArray>,
    /// Names of the arrays that are active in a role.
    pub active: Vec<(Role, String)>,
}

impl Attributes {
    /// The first array of that name.
    pub fn array(&self, name: &str) -> Option<&DataArray> {
        self.arrays.iter().find(|array| array.name == name)
    }

    /// The name of the array that is active in a role.
    pub fn active(&self, role: Role) -> Option<&str> {
        self.active.iter().find(|entry| entry.0 == role).map(|entry| entry.1.as_str())
    }

    /// Replaces the array of the same name, in its place, or appends a new one.
    pub fn set(&mut self, array: DataArray) {
        match self.arrays.iter_mut().find(|present| present.name == array.name) {
            Some(present) => *present = array,
            None => self.arrays.push(array),
        }
    }
}

/// One VTK data set: geometry and arrays, in the types and the order of its file.
///
/// Reading and then writing a data set loses nothing that VTK would keep: names, types, values bit for bit, roles,
/// component names, information keys and field data.
#[derive(Debug, Clone, PartialEq)]
pub struct DataSet {
    /// Points and cells.
    pub geometry: Geometry,
    /// Arrays on the points.
    pub point_data: Attributes,
    /// Arrays on the cells.
    pub cell_data: Attributes,
    /// Arrays on the data set as a whole, of any length.
    pub field_data: Vec<DataArray>,
    /// The second line of a legacy file; empty otherwise.
    pub title: String,
    /// Version of the XML format, which for some higher-order cells decides the order of their points: from 2.1, and from 5.1 of the
    /// legacy format, Lagrange and Bézier hexahedra have the points of two of their edges exchanged.
    pub version: Option<[u32; 2]>,
}

impl DataSet {
    /// A data set without arrays.
    pub fn new(geometry: Geometry) -> Self {
        Self {
            geometry,
            point_data: Attributes::default(),
            cell_data: Attributes::default(),
            field_data: Vec::new(),
            title: String::new(),
            version: None,
        }
    }

    /// The first point array of that name.
    pub fn point_array(&self, name: &str) -> Option<&DataArray> {
        self.point_data.array(name)
    }

    /// The first cell array of that name.
    pub fn cell_array(&self, name: &str) -> Option<&DataArray> {
        self.cell_data.array(name)
    }

    /// Replaces the point array of the same name, in its place, or appends a new one.
    pub fn set_point_array(&mut self, array: DataArray) {
        self.point_data.set(array);
    }

    /// Number of points.
    pub fn point_count(&self) -> usize {
        match &self.geometry {
            Geometry::ImageData { extent, .. }
            | Geometry::RectilinearGrid { extent, .. }
            | Geometry::StructuredGrid { extent, .. } => extent.point_count(),
            Geometry::PolyData { points, .. } | Geometry::UnstructuredGrid { points, .. } => points.tuples(),
        }
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        match &self.geometry {
            Geometry::ImageData { extent, .. }
            | Geometry::RectilinearGrid { extent, .. }
            | Geometry::StructuredGrid { extent, .. } => extent.cell_count(),
            Geometry::PolyData { verts, lines, polys, strips, .. } => {
                verts.len() + lines.len() + polys.len() + strips.len()
            }
            Geometry::UnstructuredGrid { cells, .. } => cells.len(),
        }
    }

    /// Positions of the points, x fastest in grids. Allocates 24 bytes a point.
    pub fn points_f64(&self) -> Vec<[f64; 3]> {
        match &self.geometry {
            Geometry::ImageData { extent, origin, spacing, direction } => grid_points(extent, |index| {
                let steps = [0, 1, 2].map(|axis| f64::from(index[axis]) * spacing[axis]);
                [0, 1, 2].map(|row| {
                    let along = |axis: usize| direction[3 * row + axis] * steps[axis];
                    origin[row] + (along(0) + along(1) + along(2))
                })
            }),
            Geometry::RectilinearGrid { extent, coordinates } => {
                let lists = [0, 1, 2].map(|axis| coordinates[axis].to_f64(0));
                grid_points(extent, |index| {
                    [0, 1, 2].map(|axis| {
                        let place = (i64::from(index[axis]) - i64::from(extent.0[2 * axis])) as usize;
                        lists[axis].get(place).copied().unwrap_or(f64::NAN)
                    })
                })
            }
            Geometry::StructuredGrid { points, .. }
            | Geometry::PolyData { points, .. }
            | Geometry::UnstructuredGrid { points, .. } => positions(points),
        }
    }
}

fn grid_points(extent: &Extent, position: impl Fn([i32; 3]) -> [f64; 3]) -> Vec<[f64; 3]> {
    let [x0, x1, y0, y1, z0, z1] = extent.0;
    let mut points = Vec::with_capacity(extent.point_count());
    for z in z0..=z1 {
        for y in y0..=y1 {
            points.extend((x0..=x1).map(|x| position([x, y, z])));
        }
    }
    points
}

fn positions(points: &DataArray) -> Vec<[f64; 3]> {
    match &points.data {
        ArrayData::F64(values) => values.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect(),
        ArrayData::F32(values) => values.chunks_exact(3).map(|p| [p[0].into(), p[1].into(), p[2].into()]).collect(),
        other => (0..points.tuples())
            .map(|tuple| [0, 1, 2].map(|axis| other.number(3 * tuple + axis).unwrap_or(f64::NAN)))
            .collect(),
    }
}
