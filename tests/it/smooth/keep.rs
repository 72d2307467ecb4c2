//! More than the extrema is kept: values at saddles, values along separatrices.

use morsmooth::field::Precision;
use morsmooth::mesh::SimplicialComplex;
use morsmooth::monotone::{Strategy, ValueRule};
use morsmooth::morse::{Selection, Threshold};
use morsmooth::smooth::{KeepAlso, Length, SelectOn, SmoothOptions, Smoothed, Smoother, smooth};

use super::judged;
use crate::morse::meshes::{cubes, noise, torus};

/// The grid with points where they belong, a few hills under noise.
fn field() -> (SimplicialComplex, Vec<f64>) {
    let (width, height) = (28usize, 22usize);
    let flat = crate::morse::meshes::grid(width, height);
    let points: Vec<[f64; 3]> = (0..width * height).map(|i| [(i % width) as f64, (i / width) as f64, 0.0]).collect();
    let complex = SimplicialComplex::new(2, points, flat.simplices().to_vec()).unwrap();
    let rough = noise(width * height, 5, 1 << 40);
    let data = (0..width * height)
        .map(|i| ((i % width) as f64 / 4.0).sin() * ((i / width) as f64 / 3.0).cos() + 0.2 * rough[i])
        .collect();
    (complex, data)
}

fn options(keep_also: KeepAlso) -> SmoothOptions<'static> {
    let selection = Selection::Threshold(Threshold::Fraction(0.2));
    SmoothOptions { keep_also, length: Length::Absolute(2.0), ..SmoothOptions::new(selection) }
}

/// Vertices with a fixed value that are no wanted extrema.
fn kept(result: &Smoothed) -> Vec<usize> {
    let is_extremum = |i: usize| {
        let vertex = i.into();
        result.wanted.minima.binary_search(&vertex).is_ok() || result.wanted.maxima.binary_search(&vertex).is_ok()
    };
    (0..result.rules.len()).filter(|&i| matches!(result.rules[i], ValueRule::Exactly(_)) && !is_extremum(i)).collect()
}

#[test]
fn what_is_kept_is_kept_and_paid_for() {
    let (complex, data) = field();
    for select_on in [SelectOn::Data, SelectOn::Smooth] {
        let with = |what| judged(&complex, &data, &SmoothOptions { select_on, ..options(what) }).unwrap();
        let nothing = with(KeepAlso::Nothing);
        assert!(nothing.report.kept_also.is_none());
        let [saddles, separatrices, both] = [KeepAlso::Saddles, KeepAlso::Separatrices, KeepAlso::Both].map(with);
        for result in [&saddles, &separatrices, &both] {
            let report = result.report.kept_also.as_ref().unwrap();
            let kept = kept(result);
            assert_eq!(kept.len(), report.saddles + report.separatrix_vertices);
            for &i in &kept {
                assert_eq!(result.rules[i], ValueRule::Exactly(result.values[i]), "vertex {i}");
            }
            assert!(report.with >= report.without * (1.0 - 1e-6) && report.paid >= -1e-6, "{report:?}");
            // Without means: what the same options give without.
            assert!((report.without / nothing.report.energy.rounds[0] - 1.0).abs() < 1e-6);
        }
        let count = |result: &Smoothed| result.report.kept_also.as_ref().map(|kept| (kept.saddles, kept.separatrix_vertices)).unwrap();
        let (n, m) = (count(&saddles).0, count(&separatrices).1);
        assert!(n > 1 && m > n, "{n} saddles, {m} on separatrices");
        assert_eq!((count(&saddles), count(&separatrices), count(&both)), ((n, 0), (0, m), (n, m)));
        // The more is kept, the higher the least energy of any field that keeps it.
        let bound = |result: &Smoothed| result.report.energy.bound * (1.0 - 1e-9);
        assert!(bound(&nothing) <= saddles.report.energy.bound && bound(&nothing) <= separatrices.report.energy.bound);
        assert!(bound(&saddles) <= both.report.energy.bound && bound(&separatrices) <= both.report.energy.bound);
        if select_on == SelectOn::Data {
            // Saddles have the values of the data, unless the flood moved them.
            let same = kept(&saddles).iter().filter(|&&i| saddles.values[i] == data[i]).count();
            assert!(2 * same >= n, "{same} of {n}");
        }
    }
}

#[test]
fn every_representative_function_and_width_keeps_them() {
    let (complex, data) = field();
    for strategy in [Strategy::SmoothThenSimplify, Strategy::Flood, Strategy::Separatrix, Strategy::Harmonic] {
        for precision in [Precision::F32, Precision::F64] {
            let data: Vec<f64> = data.iter().map(|&value| precision.round(value)).collect();
            let result = judged(&complex, &data, &SmoothOptions { strategy, precision, ..options(KeepAlso::Both) }).unwrap();
            assert!(kept(&result).iter().all(|&i| result.rules[i] == ValueRule::Exactly(result.values[i])));
            assert_eq!(result.report.representative.asked, strategy);
        }
    }
}

#[test]
fn volumes_and_closed_surfaces_too() {
    let side = [9usize, 8, 7];
    let flat = cubes(side);
    let points: Vec<[f64; 3]> = (0..side.iter().product::<usize>())
        .map(|i| [(i % 9) as f64, (i / 9 % 8) as f64, (i / 72) as f64])
        .collect();
    let ball = SimplicialComplex::new(3, points, flat.simplices().to_vec()).unwrap();
    let size = 13;
    let ring = torus(size);
    let points = (0..size * size)
        .map(|i| {
            let turn = |k: usize| std::f64::consts::TAU * k as f64 / size as f64;
            let (u, v) = (turn(i % size), turn(i / size));
            [(4.0 + v.cos()) * u.cos(), (4.0 + v.cos()) * u.sin(), v.sin()]
        })
        .collect();
    let ring = SimplicialComplex::new(2, points, ring.simplices().to_vec()).unwrap();
    for complex in [ball, ring] {
        let data = noise(complex.vertex_count(), 11, 1 << 40);
        let options = SmoothOptions { length: Length::OfDiagonal(0.1), ..options(KeepAlso::Both) };
        let result = judged(&complex, &data, &options).unwrap();
        assert!(result.report.kept_also.as_ref().is_some_and(|kept| kept.saddles > 0 && kept.separatrix_vertices > 0));
    }
}

/// One smoother for several fields and selections gives the bits of each alone.
#[test]
fn a_smoother_shares_without_a_trace() {
    let (complex, first) = field();
    let second: Vec<f64> = first.iter().enumerate().map(|(i, value)| value + 0.01 * (i % 7) as f64).collect();
    let selections = [0.1, 0.3].map(|part| Selection::Threshold(Threshold::Fraction(part)));
    let base = SmoothOptions { length: Length::Automatic, ..options(KeepAlso::Nothing) };
    let mut smoother = Smoother::new(&complex, 2).unwrap();
    for data in [&first, &second] {
        let together = smoother.smooth_each(data, &selections, &base, &mut |_| {}).unwrap();
        for (selection, result) in selections.iter().zip(&together) {
            let options = SmoothOptions { selection: selection.clone(), ..base.clone() };
            let alone = smooth(&complex, data, &options, &mut |_| {}).unwrap();
            assert!(alone.values.iter().zip(&result.values).all(|(a, b)| a.to_bits() == b.to_bits()));
            assert_eq!(alone.report.energy, result.report.energy);
        }
    }
    let error = smoother.smooth(&first, &SmoothOptions { order: 3, ..base }, &mut |_| {}).unwrap_err();
    assert!(error.to_string().contains("order is 3.0; expected the order of the smoother"), "{error}");
}
