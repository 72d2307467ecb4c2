//! Poses between two poses.

use super::pose::{HandleTransform, Pose, Rotation};

impl Rotation {
    /// The rotation a share of the way from this one to another.
    ///
    /// Between two angles the angle is linear, so that turns count as given. Otherwise quaternions turn evenly along the shorter arc
    /// (slerp); of two that are half a turn apart, the arc of the quaternions as given.
    ///
    /// # Arguments
    /// * `share`: 0 is this rotation, 1 the other one.
    ///
    /// # Source
    /// Shoemake 1985, *Animating rotation with quaternion curves*.
    ///
    /// # Example
    /// ```
    /// use morsmooth::mesh::Rotation;
    /// let turns = Rotation::Angle(0.0).between(Rotation::Angle(4.0 * std::f64::consts::PI), 0.25);
    /// assert_eq!(turns, Rotation::Angle(std::f64::consts::PI));
    /// ```
    pub fn between(self, other: Self, share: f64) -> Self {
        if let (Self::Angle(from), Self::Angle(to)) = (self, other) {
            return Self::Angle(from + share * (to - from));
        }
        let (from, mut to) = (self.quaternion(), other.quaternion());
        let mut cosine: f64 = from.iter().zip(&to).map(|(a, b)| a * b).sum();
        if cosine < 0.0 {
            to = to.map(|part| -part);
            cosine = -cosine;
        }
        let angle = cosine.min(1.0).acos();
        // Nearly equal ones have no plane to turn in; a straight line is as good.
        let [a, b] = match angle.sin() {
            sine if sine > 1e-9 => [((1.0 - share) * angle).sin() / sine, (share * angle).sin() / sine],
            _ => [1.0 - share, share],
        };
        let blend: [f64; 4] = std::array::from_fn(|part| a * from[part] + b * to[part]);
        Self::Quaternion(Self::Quaternion(blend).quaternion())
    }
}

impl Pose {
    /// The pose a share of the way from this one to another: rotations by [`Rotation::between`]; translations, pivots linearly; scales
    /// geometrically, so that growing and shrinking look alike.
    ///
    /// # Arguments
    /// * `other`: as many transforms; `share`: 0 is this pose, 1 the other one.
    ///
    /// # Panics
    /// Unless both have equally many transforms.
    pub fn between(&self, other: &Self, share: f64) -> Self {
        assert_eq!(self.transforms.len(), other.transforms.len(), "poses of the same handles");
        let line = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|axis| a[axis] + share * (b[axis] - a[axis]));
        let blend = |(a, b): (&HandleTransform, &HandleTransform)| HandleTransform {
            rotation: a.rotation.between(b.rotation, share),
            translation: line(a.translation, b.translation),
            scale: if a.scale == b.scale { a.scale } else { a.scale * (b.scale / a.scale).powf(share) },
            pivot: line(a.pivot, b.pivot),
        };
        Self { transforms: self.transforms.iter().zip(&other.transforms).map(blend).collect() }
    }
}
