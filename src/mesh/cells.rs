//! Cells of any shape as a file holds them, with the corner numbering of VTK.

/// The shape of a cell; corners are numbered as VTK numbers them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CellShape {
    /// One point (VTK type 1).
    Vertex,
    /// Any number of points (2).
    PolyVertex,
    /// Two points (3).
    Line,
    /// A chain of two or more points (4).
    PolyLine,
    /// Three points (5).
    Triangle,
    /// `n` points, triangle `t` on points `t, t + 1, t + 2`, every second one turned (6).
    TriangleStrip,
    /// A simple polygon, convex or not, given by its outline (7).
    Polygon,
    /// An axis-parallel rectangle: (0,0), (1,0), (0,1), (1,1) (8).
    Pixel,
    /// A quadrilateral given by its outline (9).
    Quad,
    /// Four points (10).
    Tetrahedron,
    /// An axis-parallel box: x runs fastest, then y, then z (11).
    Voxel,
    /// Bottom outline 0–3, top outline 4–7 (12).
    Hexahedron,
    /// Triangles 0–2 and 3–5, joined by the edges 0–3, 1–4, 2–5 (13).
    Wedge,
    /// Base outline 0–3 and apex 4 (14).
    Pyramid,
    /// A shape that has no subdivision here, by its VTK type.
    Other(u8),
}

impl CellShape {
    /// Dimension of the simplices into which a cell of this shape is subdivided, 0 to 3; `None` for [`Self::Other`].
    pub const fn dimension(self) -> Option<usize> {
        match self {
            Self::Vertex | Self::PolyVertex => Some(0),
            Self::Line | Self::PolyLine => Some(1),
            Self::Triangle | Self::TriangleStrip | Self::Polygon | Self::Pixel | Self::Quad => Some(2),
            Self::Tetrahedron | Self::Voxel | Self::Hexahedron | Self::Wedge | Self::Pyramid => Some(3),
            Self::Other(_) => None,
        }
    }

    /// Number of corners where the shape fixes it.
    pub const fn corner_count(self) -> Option<usize> {
        match self {
            Self::Vertex => Some(1),
            Self::Line => Some(2),
            Self::Triangle => Some(3),
            Self::Pixel | Self::Quad | Self::Tetrahedron => Some(4),
            Self::Pyramid => Some(5),
            Self::Wedge => Some(6),
            Self::Voxel | Self::Hexahedron => Some(8),
            Self::PolyVertex | Self::PolyLine | Self::TriangleStrip | Self::Polygon | Self::Other(_) => None,
        }
    }

    /// The shape with this VTK cell type.
    pub const fn from_vtk(cell_type: u8) -> Self {
        match cell_type {
            1 => Self::Vertex,
            2 => Self::PolyVertex,
            3 => Self::Line,
            4 => Self::PolyLine,
            5 => Self::Triangle,
            6 => Self::TriangleStrip,
            7 => Self::Polygon,
            8 => Self::Pixel,
            9 => Self::Quad,
            10 => Self::Tetrahedron,
            11 => Self::Voxel,
            12 => Self::Hexahedron,
            13 => Self::Wedge,
            14 => Self::Pyramid,
            other => Self::Other(other),
        }
    }

    /// The VTK cell type of this shape.
    pub const fn vtk(self) -> u8 {
        match self {
            Self::Vertex => 1,
            Self::PolyVertex => 2,
            Self::Line => 3,
            Self::PolyLine => 4,
            Self::Triangle => 5,
            Self::TriangleStrip => 6,
            Self::Polygon => 7,
            Self::Pixel => 8,
            Self::Quad => 9,
            Self::Tetrahedron => 10,
            Self::Voxel => 11,
            Self::Hexahedron => 12,
            Self::Wedge => 13,
            Self::Pyramid => 14,
            Self::Other(other) => other,
        }
    }
}

/// Cells of mixed shapes, each a list of point numbers.
///
/// Cell `c` has the corners `connectivity[offsets[c]..offsets[c + 1]]`. The fields are what a file says and may
/// disagree; [`Domain::from_cells`](super::Domain::from_cells) checks them.
///
/// # Example
/// ```
/// use morsmooth::mesh::{CellList, CellShape};
/// let mut cells = CellList::new();
/// cells.push(CellShape::Quad, &[0, 1, 4, 3]);
/// assert_eq!(cells.corners(0), [0, 1, 4, 3]);
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CellList {
    /// Shape of every cell.
    pub shapes: Vec<CellShape>,
    /// One number more than there are cells; starts with 0, does not fall, ends with the length of `connectivity`.
    pub offsets: Vec<u32>,
    /// Point numbers of all cells, one cell after the other.
    pub connectivity: Vec<u32>,
}

impl Default for CellList {
    fn default() -> Self {
        Self { shapes: Vec::new(), offsets: vec![0], connectivity: Vec::new() }
    }
}

impl CellList {
    /// A list without cells.
    pub fn new() -> Self {
        Self::default()
    }

    /// Cells that all have the same shape.
    ///
    /// # Arguments
    /// * `corners`: flat, `stride` point numbers a cell; a rest shorter than `stride` becomes a last, short cell.
    pub fn uniform(shape: CellShape, stride: usize, corners: &[u32]) -> Self {
        let mut cells = Self::new();
        for cell in corners.chunks(stride) {
            cells.push(shape, cell);
        }
        cells
    }

    /// Appends a cell.
    pub fn push(&mut self, shape: CellShape, corners: &[u32]) {
        self.shapes.push(shape);
        self.connectivity.extend_from_slice(corners);
        self.offsets.push(self.connectivity.len() as u32);
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.shapes.len()
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// Point numbers of a cell.
    pub fn corners(&self, cell: usize) -> &[u32] {
        &self.connectivity[self.offsets[cell] as usize..self.offsets[cell + 1] as usize]
    }
}
