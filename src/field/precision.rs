//! The two widths of floating-point numbers, and the order of the numbers of each.

/// The width of the numbers that are stored, and in which a field or a shape is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// 32 bits: each number rounded to the nearest of its width, as many viewers and formats keep it.
    F32,
    /// 64 bits, as computed.
    #[default]
    F64,
}

impl Precision {
    /// The nearest number of this width.
    pub fn round(self, value: f64) -> f64 {
        match self {
            Self::F32 => f64::from(value as f32),
            Self::F64 => value,
        }
    }

    /// Place of a number among all numbers of this width, after rounding; both zeros have place 0.
    pub(crate) fn place(self, value: f64) -> i64 {
        match self {
            Self::F32 => {
                let value = value as f32;
                let magnitude = i64::from(value.to_bits() & 0x7fff_ffff);
                if value.is_sign_negative() { -magnitude } else { magnitude }
            }
            Self::F64 => {
                let magnitude = (value.to_bits() & 0x7fff_ffff_ffff_ffff) as i64;
                if value.is_sign_negative() { -magnitude } else { magnitude }
            }
        }
    }

    /// The number at a place.
    pub(crate) fn number(self, place: i64) -> f64 {
        let magnitude = place.unsigned_abs();
        let value = match self {
            Self::F32 => f64::from(f32::from_bits(magnitude as u32)),
            Self::F64 => f64::from_bits(magnitude),
        };
        if place < 0 { -value } else { value }
    }
}
