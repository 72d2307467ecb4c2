//! Poses: where each handle goes.

use crate::linalg::small::Square;

/// A rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rotation {
    /// About the z axis, counter-clockwise, in radians; any number of turns, and they count: weights blend the angle itself.
    Angle(f64),
    /// A unit quaternion `[w, x, y, z]`; q and -q are the same rotation.
    Quaternion([f64; 4]),
}

/// Where a handle goes: `x' = pivot + scale R (x - pivot) + translation`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandleTransform {
    /// R.
    pub rotation: Rotation,
    /// Added last, in the units of the mesh.
    pub translation: [f64; 3],
    /// Positive; 1 keeps the size.
    pub scale: f64,
    /// The place that rotation and scale leave where it is.
    pub pivot: [f64; 3],
}

/// Where all handles go.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pose {
    /// One a handle, in the order of the handles.
    pub transforms: Vec<HandleTransform>,
}

impl Rotation {
    /// No rotation.
    pub const IDENTITY: Self = Self::Angle(0.0);

    /// A rotation about an axis of any length but zero, right-handed.
    ///
    /// # Arguments
    /// * `angle`: radians.
    ///
    /// # Returns
    /// An angle if the axis is the z axis, so that turns count; a quaternion otherwise; `None` if the axis has no direction.
    pub fn about(axis: [f64; 3], angle: f64) -> Option<Self> {
        let largest = axis.iter().fold(0.0f64, |most, part| most.max(part.abs()));
        let axis = axis.map(|part| part / largest);
        let length = axis.iter().map(|part| part * part).sum::<f64>().sqrt();
        if !length.is_finite() {
            return None;
        }
        if axis[0] == 0.0 && axis[1] == 0.0 {
            return Some(Self::Angle(angle * axis[2]));
        }
        let (sine, cosine) = (angle / 2.0).sin_cos();
        let [x, y, z] = axis.map(|part| part / length * sine);
        Some(Self::Quaternion([cosine, x, y, z]))
    }

    /// The unit quaternion `[w, x, y, z]`. A quaternion that is not of length 1 is scaled to it.
    pub fn quaternion(self) -> [f64; 4] {
        match self {
            Self::Angle(angle) => {
                let (sine, cosine) = (angle / 2.0).sin_cos();
                [cosine, 0.0, 0.0, sine]
            }
            Self::Quaternion(parts) => {
                let length = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
                parts.map(|part| part / length)
            }
        }
    }

    /// The rotation matrix, row by row.
    pub fn matrix(self) -> Square<3> {
        if let Self::Angle(angle) = self {
            let (sine, cosine) = angle.sin_cos();
            return [[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]];
        }
        let [w, x, y, z] = self.quaternion();
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    }

    /// The angle about the z axis, in radians, if the rotation keeps the planes z = constant: turns of an angle are kept, a quaternion
    /// gives -pi to pi.
    pub fn planar_angle(self) -> Option<f64> {
        match self {
            Self::Angle(angle) => Some(angle),
            Self::Quaternion([w, x, y, z]) => (x == 0.0 && y == 0.0).then(|| 2.0 * (z * w.signum()).atan2(w.abs())),
        }
    }
}

impl HandleTransform {
    /// Keeps everything where it is.
    pub const REST: Self = Self { rotation: Rotation::IDENTITY, translation: [0.0; 3], scale: 1.0, pivot: [0.0; 3] };

    /// Where a point goes that the handle carries.
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        let matrix = self.rotation.matrix();
        let offset: [f64; 3] = std::array::from_fn(|axis| point[axis] - self.pivot[axis]);
        std::array::from_fn(|row| {
            let turned: f64 = (0..3).map(|column| matrix[row][column] * offset[column]).sum();
            self.pivot[row] + self.scale * turned + self.translation[row]
        })
    }

    /// The shift `t` of `x' = scale R x + t`.
    pub fn shift(&self) -> [f64; 3] {
        self.apply([0.0; 3])
    }
}

impl Pose {
    /// All handles where they are.
    pub fn rest(handles: usize) -> Self {
        Self { transforms: vec![HandleTransform::REST; handles] }
    }
}
