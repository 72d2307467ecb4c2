//! From positions in space to positions on the sheet: planar domains in their own plane, others seen from one side.

use crate::mesh::SimplicialComplex;

/// Variance across a plane, relative to that along it, below which a domain counts as planar: coordinates stored in
/// single precision scatter by 1e-7 of the extent, so their variance by 1e-14.
const FLATNESS: f64 = 1e-10;

/// How far the eye is raised above the horizontal and moved to the right, in radians, so that depth shows.
const RAISED: f64 = 0.35;
const TURNED: f64 = 0.25;

/// What the domain looks like from the eye: right and up in the units of the file, and towards the eye.
pub(super) struct View {
    /// One position a vertex: right, up, towards the eye.
    pub(super) positions: Vec<[f64; 3]>,
    /// Least right and up.
    pub(super) low: [f64; 2],
    /// Greatest right and up.
    pub(super) high: [f64; 2],
    /// The domain lies in the plane of the sheet.
    pub(super) planar: bool,
}

impl View {
    /// Chooses a frame: that of the domain's plane, upright where the plane is spanned by two axes; for other domains
    /// across the axis of least extent, from above.
    pub(super) fn of(complex: &SimplicialComplex) -> Self {
        let (frame, planar) = frame(complex.points());
        let positions: Vec<[f64; 3]> = complex.points().iter().map(|&p| frame.map(|axis| dot(axis, p))).collect();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        // Points of no simplex are not drawn and must not shrink what is.
        for &vertex in complex.simplices() {
            for axis in 0..2 {
                low[axis] = low[axis].min(positions[vertex as usize][axis]);
                high[axis] = high[axis].max(positions[vertex as usize][axis]);
            }
        }
        Self { positions, low, high, planar }
    }

    /// Extent to the right and upwards.
    pub(super) fn extent(&self) -> [f64; 2] {
        [self.high[0] - self.low[0], self.high[1] - self.low[1]]
    }
}

/// Right, up and towards the eye, and whether all points lie in the plane of the first two.
pub(super) fn frame(points: &[[f64; 3]]) -> ([[f64; 3]; 3], bool) {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in points {
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    let extent = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let thin = [2, 1, 0].into_iter().fold(2, |best, axis| if extent[axis] < extent[best] { axis } else { best });
    let largest = extent.iter().fold(0.0, |a: f64, &b| a.max(b));
    if extent[thin] <= FLATNESS.sqrt() * largest {
        return (upright(thin), true);
    }
    let (axes, variances) = principal_axes(points);
    if variances[2] <= FLATNESS * variances[0] {
        return (axes, true);
    }
    let [right, up, towards] = upright(thin);
    let turn = |a: [f64; 3], b: [f64; 3], angle: f64| {
        let (sin, cos) = angle.sin_cos();
        ([0, 1, 2].map(|k| cos * a[k] - sin * b[k]), [0, 1, 2].map(|k| sin * a[k] + cos * b[k]))
    };
    let (right, towards) = turn(right, towards, TURNED);
    let (up, towards) = turn(up, towards, RAISED);
    ([right, up, towards], false)
}

/// Right, up and towards the eye when looking along axis `thin`: x to the right before y, z upwards before y.
fn upright(thin: usize) -> [[f64; 3]; 3] {
    let (right, up) = [(1, 2), (0, 2), (0, 1)][thin];
    let unit = |axis: usize| [0, 1, 2].map(|k| f64::from(u8::from(k == axis)));
    let (right, up) = (unit(right), unit(up));
    [right, up, cross(right, up)]
}

/// Axes of falling variance, a right-handed frame, the first two with their largest component positive.
fn principal_axes(points: &[[f64; 3]]) -> ([[f64; 3]; 3], [f64; 3]) {
    let count = points.len().max(1) as f64;
    let mean = points.iter().fold([0.0; 3], |sum, p| [0, 1, 2].map(|k| sum[k] + p[k] / count));
    let mut matrix = [[0.0; 3]; 3];
    for point in points {
        for row in 0..3 {
            for column in 0..3 {
                matrix[row][column] += (point[row] - mean[row]) * (point[column] - mean[column]) / count;
            }
        }
    }
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Cyclic Jacobi rotations; six sweeps leave nothing off the diagonal of a 3 x 3 matrix but rounding.
    for _ in 0..6 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if matrix[p][q] == 0.0 {
                continue;
            }
            let theta = 0.5 * (matrix[q][q] - matrix[p][p]) / matrix[p][q];
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let (c, s) = (1.0 / t.hypot(1.0), t / t.hypot(1.0));
            for row in &mut matrix {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            for k in 0..3 {
                (matrix[p][k], matrix[q][k]) = (c * matrix[p][k] - s * matrix[q][k], s * matrix[p][k] + c * matrix[q][k]);
                (vectors[p][k], vectors[q][k]) =
                    (c * vectors[p][k] - s * vectors[q][k], s * vectors[p][k] + c * vectors[q][k]);
            }
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| matrix[b][b].total_cmp(&matrix[a][a]));
    let positive = |axis: [f64; 3]| {
        let largest = axis.iter().fold(0.0, |best: f64, &c| if c.abs() > best.abs() + 1e-9 { c } else { best });
        if largest < 0.0 { axis.map(|c| -c) } else { axis }
    };
    let (first, second) = (positive(vectors[order[0]]), positive(vectors[order[1]]));
    ([first, second, cross(first, second)], order.map(|k| matrix[k][k]))
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
