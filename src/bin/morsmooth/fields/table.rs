//! The table of thresholds, as people read it.

use morsmooth::morse::PersistenceCurve;
use morsmooth::smooth::{ExtremumCount, MeasuredField};

use crate::common::number::short;

/// Thresholds of the table, in per cent of the range.
const THRESHOLDS: [f64; 10] = [0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 40.0, 50.0];

/// What a field is, and how many minima and maxima each threshold leaves.
pub fn threshold_table(what: &str, field: &MeasuredField, curve: &PersistenceCurve) -> Vec<String> {
    let (low, high) = field.range();
    let mut lines = vec![
        format!("{what} on {} vertices, values {} to {}", field.values.len(), short(low), short(high)),
        format!("{}, boundary included", ExtremumCount { minima: field.minima.len(), maxima: field.maxima.len() }),
        String::new(),
        format!("{:>11} {:>14} {:>8} {:>8}", "persistence", "in file units", "minima", "maxima"),
    ];
    for percent in THRESHOLDS {
        let threshold = percent / 100.0 * (high - low);
        let (minima, maxima) = curve.at(threshold);
        lines.push(format!("{:>11} {:>14} {minima:>8} {maxima:>8}", format!("> {percent} %"), short(threshold)));
    }
    lines
}
