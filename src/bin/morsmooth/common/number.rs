//! Numbers as people read them.

/// Six decimals where they show the number; powers of ten where it is too large or too small for that.
pub fn short(value: f64) -> String {
    const PLAIN: std::ops::Range<f64> = 1e-3..1e9;
    if value == 0.0 || !value.is_finite() || PLAIN.contains(&value.abs()) { format!("{value:.6}") } else { format!("{value:.6e}") }
}

/// The fewest digits that tell a number from its neighbours in the sixth digit: 5, 0.5, 12.25.
pub fn plain(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    format!("{rounded}")
}
