//! The audit of plateaus, against a count by hand and by brute force.

use crate::mesh::shapes::{Noise, grid};
use morsmooth::audit::{ExtremumType, audit_plateaus};
use morsmooth::field::{FieldError, VertexId};
use morsmooth::mesh::SimplicialComplex;

/// Sets of joined equal vertices by repeated relabelling, then a look at all neighbours of each.
fn by_brute_force(complex: &SimplicialComplex, values: &[f64], given: &[(VertexId, f64)]) -> (usize, usize, usize) {
    let mut label: Vec<usize> = (0..values.len()).collect();
    loop {
        let mut changed = false;
        for &[a, b] in complex.edges() {
            let (a, b) = (a.index(), b.index());
            if values[a] == values[b] && label[a] != label[b] {
                let least = label[a].min(label[b]);
                (label[a], label[b], changed) = (least, least, true);
            }
        }
        if !changed {
            break;
        }
    }
    let (mut minima, mut maxima, mut spurious) = (0, 0, 0);
    for place in 0..values.len() {
        let members: Vec<usize> = (0..values.len()).filter(|&vertex| label[vertex] == place).collect();
        let around = || members.iter().flat_map(|&v| complex.neighbours(v.into())).map(|v| values[v.index()]);
        let (lower, higher) = (around().any(|v| v < values[place]), around().any(|v| v > values[place]));
        if members.is_empty() || lower == higher {
            continue;
        }
        minima += usize::from(higher);
        maxima += usize::from(lower);
        spurious += usize::from(!given.iter().any(|(vertex, _)| members.contains(&vertex.index())));
    }
    (minima, maxima, spurious)
}

#[test]
fn it_agrees_with_brute_force_on_fields_of_few_values() {
    for (seed, dims) in [(1, [9, 8, 1]), (2, [5, 4, 4]), (3, [30, 1, 1])] {
        let complex = grid(dims);
        let mut noise = Noise(seed);
        for _ in 0..20 {
            let levels = 2.0 + (6.0 * noise.next()).floor();
            let values: Vec<f64> = (0..complex.vertex_count()).map(|_| (levels * noise.next()).floor() * 0.25).collect();
            let given: Vec<(VertexId, f64)> =
                (0..values.len()).filter(|_| noise.next() < 0.1).map(|v| (VertexId::from(v), values[v])).collect();
            let report = audit_plateaus(&complex, &values, &given).unwrap();
            let found = (report.found_minima, report.found_maxima, report.spurious.count);
            assert_eq!(found, by_brute_force(&complex, &values, &given));
            assert!(report.moved_values.is_empty());
        }
    }
}

#[test]
fn what_is_missing_moved_or_flat_is_named() {
    let line = grid([6, 1, 1]);
    let given = [(VertexId(0), 0.0), (VertexId(5), 1.0)];
    let judge = |values: [f64; 6]| audit_plateaus(&line, &values, &given).unwrap();
    assert!(judge([0.0, 0.1, 0.2, 0.3, 0.4, 1.0]).passed);
    // A plateau on the way is an extremum of no one, but its vertices have no strict neighbours on one side.
    let flat = judge([0.0, 0.1, 0.2, 0.2, 0.4, 1.0]);
    assert_eq!((flat.passed, flat.spurious.count, flat.flat.first), (false, 0, vec![VertexId(2), VertexId(3)]));
    let below = judge([0.0, -0.1, 0.2, 0.3, 0.4, 1.0]);
    assert_eq!(below.missing.first, [(VertexId(0), ExtremumType::Minimum)]);
    assert_eq!(below.spurious.first, [(VertexId(1), ExtremumType::Minimum)]);
    let moved = judge([0.0, 0.1, 0.2, 0.3, 0.4, 0.9]);
    assert_eq!((moved.passed, moved.moved_values.first[0].vertex), (false, VertexId(5)));
    // All of a part at one value is no extremum; given values that are all one ask for nothing.
    let constant = audit_plateaus(&line, &[2.0; 6], &[(VertexId(3), 2.0)]).unwrap();
    assert_eq!((constant.passed, constant.found_minima, constant.wanted_minima), (true, 0, 0));
    assert_eq!(
        audit_plateaus(&line, &[0.0; 5], &given),
        Err(FieldError::LengthMismatch { expected: 6, found: 5 })
    );
}
