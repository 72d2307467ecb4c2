//! The vertex order against a plain sort: ties, both zeros, far and close values, any number of threads.

use morsmooth::field::{FieldError, Precision, VertexId, VertexOrder};
use proptest::prelude::*;

fn assert_sorted(values: &[f64]) {
    let order = VertexOrder::of_values(values).unwrap();
    let mut expected: Vec<u32> = (0..values.len() as u32).collect();
    expected.sort_by(|&a, &b| values[a as usize].partial_cmp(&values[b as usize]).unwrap());
    assert!(order.sequence().iter().map(|vertex| vertex.0).eq(expected.iter().copied()));
    for (rank, &vertex) in expected.iter().enumerate() {
        assert_eq!(order.rank(VertexId(vertex)) as usize, rank);
    }
    let reversed = order.reversed();
    assert!(reversed.sequence().iter().eq(order.sequence().iter().rev()));
}

/// Numbers without a pattern, 0 to 2^53 - 1.
fn numbers(count: usize) -> impl Iterator<Item = u64> {
    (0..count as u64).map(|k| {
        let mut z = k.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (z ^ (z >> 29)) >> 11
    })
}

#[test]
fn long_fields_of_every_kind_are_sorted() {
    let n = 100_000;
    let unit = |z: u64| z as f64 / (1u64 << 53) as f64;
    let kinds: [fn(f64, u64) -> f64; 9] = [
        |x, _| x,
        |x, _| x - 0.5,
        |x, _| 1e6 + 1e-9 * x,
        |x, z| if z % 1000 == 7 { 1e300 } else { 300.0 + 1e-10 * x },
        |x, z| if z % 2 == 0 { 0.0 } else if z % 4 == 1 { -0.0 } else { x - 0.5 },
        |_, z| (z % 3) as f64 - 1.0,
        |_, _| -7.25,
        |x, z| (x - 0.5) * 10f64.powi((z % 600) as i32 - 300),
        |x, _| (x - 0.5) * f64::MAX,
    ];
    for kind in kinds {
        let values: Vec<f64> = numbers(n).map(|z| kind(unit(z), z)).collect();
        assert_sorted(&values);
        assert_sorted(&values[..8191]);
    }
}

#[test]
fn threads_change_no_rank() {
    let values: Vec<f64> = numbers(300_000).map(|z| (z % 70_000) as f64).collect();
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| VertexOrder::of_values(&values).unwrap())
    };
    let one = with_threads(1);
    assert_eq!(one, with_threads(2));
    assert_eq!(one, with_threads(3));
}

#[test]
fn the_first_value_that_is_not_finite_is_named() {
    let mut values = vec![1.0; 200_000];
    values[150_000] = f64::INFINITY;
    values[170_000] = f64::NAN;
    let error = VertexOrder::of_values(&values).unwrap_err();
    assert_eq!(error, FieldError::NonFinite { vertex: VertexId(150_000), value: f64::INFINITY });
    assert!(VertexOrder::of_values(&[]).unwrap().is_empty());
}

proptest! {
    #[test]
    fn any_finite_values_are_sorted(values in prop::collection::vec(any::<f64>().prop_filter("finite", |v| v.is_finite()), 0..200)) {
        assert_sorted(&values);
    }
}

#[test]
fn numbers_are_rounded_to_their_width() {
    let third = 1.0 / 3.0;
    assert_eq!(Precision::F64.round(third), third);
    assert_eq!(Precision::F32.round(third), f64::from(third as f32));
    assert!(Precision::F32.round(third) != third && Precision::F32.round(0.25) == 0.25);
    assert_eq!(Precision::default(), Precision::F64);
}
