//! Image, rectilinear and curvilinear grids and their Freudenthal (Kuhn) subdivision.
//!
//! Literature: Freudenthal 1942, *Simplizialzerlegungen von beschränkter Flachheit*; Kuhn 1960, *Some combinatorial
//! lemmas in topology*.

/// A structured grid: points `(i, j, k)`, `i` fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Points along each axis; 1 for a flat axis. Any axes may be flat.
    pub dims: [usize; 3],
    /// Where the points are.
    pub geometry: GridGeometry,
}

/// Where the points of a grid are, in the units of the file.
#[derive(Debug, Clone, PartialEq)]
pub enum GridGeometry {
    /// VTK image data: point `(i, j, k)` of the extent lies at `origin + direction * (spacing .* (i, j, k))`.
    Image {
        /// Position of index (0, 0, 0), which need not lie in the extent.
        origin: [f64; 3],
        /// Distance of neighbouring points along each index axis.
        spacing: [f64; 3],
        /// 3 x 3 matrix, row by row; [`GridGeometry::IDENTITY`] where the file has none.
        direction: [f64; 9],
        /// First and last index along each axis: `[i0, i1, j0, j1, k0, k1]`.
        extent: [i64; 6],
    },
    /// VTK rectilinear grid: point `(i, j, k)` lies at `(x[i], y[j], z[k])`.
    Rectilinear {
        /// `dims[0]` coordinates.
        x: Vec<f64>,
        /// `dims[1]` coordinates.
        y: Vec<f64>,
        /// `dims[2]` coordinates.
        z: Vec<f64>,
    },
    /// VTK structured grid: every point given, `i` fastest.
    Curvilinear {
        /// `dims[0] * dims[1] * dims[2]` positions.
        points: Vec<[f64; 3]>,
    },
}

impl GridGeometry {
    /// The direction matrix of a grid that is not turned.
    pub const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
}

impl Grid {
    /// An image grid that starts at index (0, 0, 0) and is not turned.
    pub fn image(dims: [usize; 3], origin: [f64; 3], spacing: [f64; 3]) -> Self {
        let last = dims.map(|count| count as i64 - 1);
        let extent = [0, last[0], 0, last[1], 0, last[2]];
        Self { dims, geometry: GridGeometry::Image { origin, spacing, direction: GridGeometry::IDENTITY, extent } }
    }

    /// Number of points.
    pub fn point_count(&self) -> usize {
        self.dims.iter().product()
    }

    /// Number of cells as VTK counts them: a flat axis counts once; no point, no cell.
    pub fn cell_count(&self) -> usize {
        if self.point_count() == 0 {
            return 0;
        }
        self.dims.iter().map(|&count| if count > 1 { count - 1 } else { 1 }).product()
    }
}
