//! What is refused before any work, and the units in which the rest is safe from overflow.

use crate::field::{FieldError, VertexId, check_finite};
use crate::mesh::SimplicialComplex;

use super::error::SmoothError;
use super::options::{ExtremumValues, Length, SmoothOptions};

/// Refuses options out of their range, and data that no smooth field is near, before any work.
///
/// # Arguments
/// * `data`: `n` values, one a vertex of `complex`.
///
/// # Errors
/// [`SmoothError`], as [`smooth`](super::smooth) would give it.
///
/// # Cost
/// O(n + m).
pub fn check_field(complex: &SimplicialComplex, data: &[f64], options: &SmoothOptions<'_>) -> Result<(), SmoothError> {
    check_options(complex, data, options)?;
    if data.len() != complex.vertex_count() {
        return Err(FieldError::LengthMismatch { expected: complex.vertex_count(), found: data.len() }.into());
    }
    check_finite(data)?;
    if let Some(constant) = constant_components(complex, data).first() {
        return Err(SmoothError::Constant { vertex: constant[0], vertices: constant.len(), value: data[constant[0].index()] });
    }
    check_confidence(complex, options.confidence)?;
    unit(data.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)))).map(|_| ())
}

/// Refuses options out of their range.
fn check_options(complex: &SimplicialComplex, data: &[f64], options: &SmoothOptions<'_>) -> Result<(), SmoothError> {
    let range = |option, found: f64, expected, fits: bool| match fits {
        true => Ok(()),
        false => Err(SmoothError::OptionRange { option, found, expected }),
    };
    if complex.simplex_count() == 0 {
        return Err(SmoothError::Empty { vertices: complex.vertex_count(), simplices: 0 });
    }
    range("order", options.order as f64, "1, 2, 3 or 4", (1..=4).contains(&options.order))?;
    let has_effect = options.smoothness.is_none() || options.order > 1;
    range("order", options.order as f64, "2, 3 or 4 with a smoothness mask, which has no effect at order 1", has_effect)?;
    match options.length {
        Length::OfDiagonal(found) | Length::Absolute(found) => {
            range("smoothing length", found, "a finite number above 0", found > 0.0 && found.is_finite())?;
        }
        Length::Automatic => {}
    }
    if let ExtremumValues::Within(found) = options.values {
        range("interval of the values", found, "a finite part not below 0", found >= 0.0 && found.is_finite())?;
    }
    range("relative gap", options.relative_gap, "a number in (0, 0.1]", options.relative_gap > 0.0 && options.relative_gap <= 0.1)?;
    type Fits = fn(f64) -> bool;
    let lists: [(&'static str, _, &'static str, Fits); 2] = [
        ("confidence", options.confidence, "a finite number not below 0", |value| value >= 0.0 && value.is_finite()),
        ("smoothness mask", options.smoothness, "a number in [0, 1]", |value| (0.0..=1.0).contains(&value)),
    ];
    for (option, values, expected, fits) in lists {
        let Some(values) = values else { continue };
        if values.len() != data.len() {
            return Err(SmoothError::OptionLength { option, expected: complex.vertex_count(), found: values.len() });
        }
        if let Some(vertex) = values.iter().position(|&value| !fits(value)) {
            return Err(SmoothError::OptionValue { option, vertex: vertex.into(), found: values[vertex], expected });
        }
    }
    Ok(())
}

/// The components with one value only, near which there is no strict field.
///
/// # Arguments
/// * `values`: `n` values, one a vertex of `complex`.
///
/// # Returns
/// The vertices of each such component by rising index, components by their lowest vertex; isolated vertices are none.
///
/// # Cost
/// O(n + m).
pub fn constant_components(complex: &SimplicialComplex, values: &[f64]) -> Vec<Vec<VertexId>> {
    let (component, count) = complex.components();
    let mut members: Vec<Vec<VertexId>> = vec![Vec::new(); count];
    for (vertex, &number) in component.iter().enumerate() {
        members[number as usize].push(vertex.into());
    }
    let is_constant = |vertices: &Vec<VertexId>| {
        vertices.len() > 1 && vertices.iter().all(|vertex| values[vertex.index()] == values[vertices[0].index()])
    };
    members.into_iter().filter(is_constant).collect()
}

/// Refuses a component on which no data value counts: nothing would decide on its level.
fn check_confidence(complex: &SimplicialComplex, confidence: Option<&[f64]>) -> Result<(), SmoothError> {
    let Some(confidence) = confidence else { return Ok(()) };
    let (component, count) = complex.components();
    let mut counts = vec![false; count];
    component.iter().zip(confidence).for_each(|(&number, &value)| counts[number as usize] |= value > 0.0);
    match component.iter().position(|&number| !counts[number as usize]) {
        Some(vertex) => Err(SmoothError::NoConfidence { vertex: vertex.into() }),
        None => Ok(()),
    }
}

/// The power of two at or below the range of the values: dividing by it changes no digit.
pub(super) fn unit((low, high): (f64, f64)) -> Result<f64, SmoothError> {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    let range = high - low;
    match range.is_finite() {
        true => Ok(f64::from_bits(range.to_bits() & EXPONENT).max(f64::MIN_POSITIVE)),
        false => Err(SmoothError::Range { low, high }),
    }
}

/// Refuses a length of which the energy cannot be assembled.
pub(super) fn check_power(length: f64, order: usize) -> Result<(), SmoothError> {
    const POWERS: std::ops::Range<f64> = 1e-300..1e300;
    let power = 2 * order as i32;
    match POWERS.contains(&length.powi(power)) {
        true => Ok(()),
        false => Err(SmoothError::LengthPower { length, power }),
    }
}
