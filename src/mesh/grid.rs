//! Image, rectilinear and curvilinear grids and their Freudenthal (Kuhn) subdivision.
//!
//! Literature: Freudenthal 1942, *Simplizialzerlegungen von beschränkter Flachheit*; Kuhn 1960, *Some combinatorial
//! lemmas in topology*.

use super::{DomainError, MeshError};

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

    /// Number of points; `usize::MAX` if there are more.
    pub fn point_count(&self) -> usize {
        self.dims.iter().fold(1, |product, &count| product.saturating_mul(count))
    }

    /// Number of cells as VTK counts them: a flat axis counts once; no point, no cell.
    pub fn cell_count(&self) -> usize {
        if self.point_count() == 0 {
            return 0;
        }
        self.dims.iter().fold(1, |product, &count| product.saturating_mul(count.saturating_sub(1).max(1)))
    }

    /// Position of a point.
    ///
    /// # Arguments
    /// * `point`: `i + dims[0] * (j + dims[1] * k)`, in a grid whose geometry fits its dimensions.
    pub fn point(&self, point: usize) -> [f64; 3] {
        let place = [point % self.dims[0], point / self.dims[0] % self.dims[1], point / self.dims[0] / self.dims[1]];
        match &self.geometry {
            GridGeometry::Image { origin, spacing, direction, extent } => {
                let step = |axis: usize| spacing[axis] * (extent[2 * axis] as f64 + place[axis] as f64);
                let [x, y, z] = [step(0), step(1), step(2)];
                let row = |axis: usize| direction[3 * axis] * x + direction[3 * axis + 1] * y + direction[3 * axis + 2] * z;
                [origin[0] + row(0), origin[1] + row(1), origin[2] + row(2)]
            }
            GridGeometry::Rectilinear { x, y, z } => [x[place[0]], y[place[1]], z[place[2]]],
            GridGeometry::Curvilinear { points } => points[point],
        }
    }

    /// Refuses a geometry that does not fit the dimensions, and grids beyond 32-bit numbers.
    pub(super) fn check(&self) -> Result<(), DomainError> {
        let found = self.point_count();
        if u32::try_from(found).is_err() {
            return Err(MeshError::TooLarge { what: "points of the grid", found }.into());
        }
        let fit = |axis: usize, expected: usize, found: i64| {
            if found == expected as i64 { Ok(()) } else { Err(DomainError::GridShape { axis, expected, found }) }
        };
        match &self.geometry {
            GridGeometry::Image { extent, .. } => (0..3).try_for_each(|axis| {
                let found = extent[2 * axis + 1].saturating_sub(extent[2 * axis]).saturating_add(1);
                fit(axis, self.dims[axis], found)
            }),
            GridGeometry::Rectilinear { x, y, z } => {
                let mut axes = [x, y, z].into_iter().enumerate();
                axes.try_for_each(|(axis, list)| fit(axis, self.dims[axis], list.len() as i64))
            }
            GridGeometry::Curvilinear { points } => fit(3, found, points.len() as i64),
        }
    }

    /// Number of axes that are not flat.
    pub(super) fn dimension(&self) -> usize {
        self.dims.iter().filter(|&&count| count > 1).count()
    }

    /// The first point of a cell.
    pub(super) fn cell_origin(&self, cell: usize) -> u32 {
        let cells = self.dims.map(|count| (count - 1).max(1));
        let (i, j, k) = (cell % cells[0], cell / cells[0] % cells[1], cell / cells[0] / cells[1]);
        (i + self.dims[0] * (j + self.dims[1] * k)) as u32
    }

    /// The simplices of every cell, as offsets from its first point.
    ///
    /// Simplex of a permutation of the axes: walk from the first corner to the last, one axis after the other. Odd
    /// permutations have two corners exchanged, so that all simplices are oriented alike.
    pub(super) fn cell_simplices(&self) -> Vec<Vec<u32>> {
        const ORDERS: [&[&[usize]]; 4] = [
            &[],
            &[&[0]],
            &[&[0, 1], &[1, 0]],
            &[&[0, 1, 2], &[1, 2, 0], &[2, 0, 1], &[0, 2, 1], &[1, 0, 2], &[2, 1, 0]],
        ];
        let strides = [1, self.dims[0], self.dims[0] * self.dims[1]];
        let steps: Vec<u32> = (0..3).filter(|&axis| self.dims[axis] > 1).map(|axis| strides[axis] as u32).collect();
        let walk = |order: &&[usize]| {
            let mut corners = vec![0];
            for &axis in order.iter() {
                corners.push(corners[corners.len() - 1] + steps[axis]);
            }
            let inversions = order.iter().enumerate().map(|(at, a)| order[at..].iter().filter(|b| *b < a).count());
            if inversions.sum::<usize>() % 2 == 1 {
                let last = corners.len() - 1;
                corners.swap(last - 1, last);
            }
            corners
        };
        ORDERS[self.dimension()].iter().map(walk).collect()
    }
}
