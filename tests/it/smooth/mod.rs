//! The pipeline of the library: theorems, and whatever random fields come up with.

mod keep;
mod random;
mod simplify;
mod theorems;

use morsmooth::audit::{Plateaus, Wanted, audit};
use morsmooth::field::{Precision, VertexId};
use morsmooth::mesh::SimplicialComplex;
use morsmooth::monotone::{Strictness, ValueRule};
use morsmooth::smooth::{SmoothError, SmoothOptions, Smoothed, smooth};

/// Smooths and judges. `Err` is a typed refusal; a field that breaks any promise panics.
pub fn judged(complex: &SimplicialComplex, data: &[f64], options: &SmoothOptions<'_>) -> Result<Smoothed, SmoothError> {
    let result = smooth(complex, data, options, &mut |_| {})?;
    let ruled = |vertices: &[VertexId]| -> Vec<_> {
        let rule = |vertex: VertexId| match result.rules[vertex.index()] {
            ValueRule::Free => None,
            ValueRule::Exactly(value) => Some(morsmooth::audit::ValueRule::Exactly(value)),
            ValueRule::Within(low, high) => Some(morsmooth::audit::ValueRule::Within(low, high)),
        };
        vertices.iter().map(|&vertex| (vertex, rule(vertex))).collect()
    };
    let (minima, maxima) = (ruled(&result.wanted.minima), ruled(&result.wanted.maxima));
    let plateaus = if options.strictness == Strictness::Plain { Plateaus::Refused } else { Plateaus::Allowed };
    let verdict = audit(complex, &result.values, &Wanted { minima: &minima, maxima: &maxima, plateaus }).unwrap();
    assert!(verdict.passed, "{verdict:?}\n{options:?}\n{data:?}");
    if options.precision == Precision::F32 {
        assert!(result.values.iter().all(|&value| f64::from(value as f32) == value));
    }
    // By a second count, without ties.
    if options.strictness == Strictness::Plain {
        for (wanted, sign) in [(&result.wanted.minima, 1.0), (&result.wanted.maxima, -1.0)] {
            let value = |vertex: VertexId| sign * result.values[vertex.index()];
            let found: Vec<VertexId> = (0..data.len())
                .map(VertexId::from)
                .filter(|&v| !complex.neighbours(v).is_empty() && complex.neighbours(v).iter().all(|&w| value(v) < value(w)))
                .collect();
            assert_eq!(&found, wanted);
        }
    }
    for vertex in (0..data.len()).filter(|&v| complex.neighbours(v.into()).is_empty()) {
        assert_eq!(result.values[vertex], options.precision.round(data[vertex]));
    }
    Ok(result)
}
