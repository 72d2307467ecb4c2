//! Random matrices and positions for the tests.

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    /// Even in -1 to 1.
    pub fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A rotation of a random quaternion; about the z axis in 2-D.
    pub fn rotation(&mut self, dimension: usize) -> [[f64; 3]; 3] {
        if dimension == 2 {
            return super::scenes::turn(std::f64::consts::PI * self.even());
        }
        let q: [f64; 4] = std::array::from_fn(|_| self.even());
        let size = q.iter().map(|part| part * part).sum::<f64>().sqrt();
        let [w, x, y, z] = q.map(|part| part / size);
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ]
    }

    pub fn positions(&mut self, rest: &[f64], amount: f64) -> Vec<f64> {
        rest.iter().map(|x| x + amount * self.even()).collect()
    }
}
