//! Colours of values and of marks.

/// A colour, red, green and blue.
pub(super) type Rgb = [u8; 3];

pub(super) const WHITE: Rgb = [255, 255, 255];
pub(super) const INK: Rgb = [38, 38, 42];
pub(super) const FAINT_INK: Rgb = [120, 120, 126];
/// Where a planar domain has no point: masked or outside.
pub(super) const OUTSIDE: Rgb = [232, 232, 234];
pub(super) const MINIMUM: Rgb = [24, 84, 214];
pub(super) const MAXIMUM: Rgb = [214, 30, 38];

/// Coefficients by rising power of t, a column for each of red, green and blue: a least-squares fit of degree 6 to the
/// published table of viridis (N. Smith, S. van der Walt 2015, CC0), off by at most 0.017 in any channel.
const VIRIDIS: [[f64; 3]; 7] = [
    [0.2745, 0.0058, 0.3327],
    [0.1077, 1.3965, 1.3868],
    [-0.3272, 0.2148, 0.092],
    [-4.5999, -5.7582, -19.2918],
    [6.2037, 14.154, 56.6563],
    [4.7518, -13.7494, -65.321],
    [-5.4321, 4.6416, 26.2721],
];

/// Equally spaced anchors of the map for signed values: equally light at equal distance from the grey middle.
const DIVERGING: [[f64; 3]; 7] = [
    [0.05, 0.27, 0.33],
    [0.20, 0.53, 0.56],
    [0.57, 0.78, 0.78],
    [0.95, 0.95, 0.94],
    [0.89, 0.75, 0.52],
    [0.73, 0.48, 0.19],
    [0.42, 0.22, 0.05],
];

/// How values become colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColourMap {
    /// Dark violet to yellow, lightness rising evenly: for values of one sign, or without a natural zero.
    Viridis,
    /// Teal over light grey to brown: for values of both signs about zero.
    Diverging,
}

impl ColourMap {
    /// The colour at `t`, from 0 (lowest) to 1 (highest); outside of that the nearest end.
    pub fn colour(self, t: f64) -> [u8; 3] {
        let t = t.clamp(0.0, 1.0);
        let channel = |c: usize| match self {
            Self::Viridis => VIRIDIS.iter().rev().fold(0.0, |sum, row| sum * t + row[c]),
            Self::Diverging => {
                let place = t * (DIVERGING.len() - 1) as f64;
                let low = (place as usize).min(DIVERGING.len() - 2);
                let part = place - low as f64;
                DIVERGING[low][c] * (1.0 - part) + DIVERGING[low + 1][c] * part
            }
        };
        [0, 1, 2].map(|c| (channel(c).clamp(0.0, 1.0) * 255.0).round() as u8)
    }

    /// The map as a table, fast enough for every pixel.
    pub(super) fn table(self) -> Vec<Rgb> {
        (0..TABLE_LENGTH).map(|k| self.colour(k as f64 / (TABLE_LENGTH - 1) as f64)).collect()
    }
}

pub(super) const TABLE_LENGTH: usize = 1024;

/// `a` with a part `alpha` of `b` laid over it.
pub(super) fn mix(a: Rgb, b: Rgb, alpha: f64) -> Rgb {
    [0, 1, 2].map(|c| (f64::from(a[c]) + (f64::from(b[c]) - f64::from(a[c])) * alpha).round() as u8)
}
