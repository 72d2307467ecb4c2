//! Masks, holes, components, and the way between points and vertices.

use morsmooth::field::VertexId;
use morsmooth::mesh::{CellList, CellShape, Domain, DomainError, Grid, Mask, MeshFault};
use proptest::prelude::*;
use std::collections::BTreeSet;

proptest! {
    /// A simplex survives if and only if its points and its cell are kept.
    #[test]
    fn survivors_equal_brute_force(
        points in proptest::collection::vec(proptest::bool::weighted(0.8), 20),
        cells in proptest::collection::vec(proptest::bool::weighted(0.8), 12),
    ) {
        let grid = Grid::image([5, 4, 1], [0.0; 3], [1.0; 3]);
        let whole = Domain::from_grid(&grid, &Mask::none()).unwrap();
        let expected: Vec<(u32, Vec<u32>)> = (0..whole.complex.simplex_count())
            .map(|simplex| (whole.cell_of_simplex()[simplex], whole.complex.simplex(simplex).to_vec()))
            .filter(|(cell, corners)| cells[*cell as usize] && corners.iter().all(|&point| points[point as usize]))
            .collect();
        let mask = Mask { keep_points: Some(points.clone()), keep_cells: Some(cells) };
        match Domain::from_grid(&grid, &mask) {
            Err(error) => {
                prop_assert!(expected.is_empty());
                prop_assert!(matches!(error, DomainError::Empty { .. }), "{error}");
            }
            Ok(domain) => {
                let survivors: Vec<(u32, Vec<u32>)> = (0..domain.complex.simplex_count())
                    .map(|simplex| {
                        let corners: Vec<VertexId> = domain.complex.simplex(simplex).iter().map(|&v| VertexId(v)).collect();
                        (domain.cell_of_simplex()[simplex], domain.points_of(&corners))
                    })
                    .collect();
                prop_assert_eq!(&survivors, &expected);
                let used: BTreeSet<u32> = expected.iter().flat_map(|(_, corners)| corners.clone()).collect();
                prop_assert_eq!(domain.point_of_vertex(), used.iter().copied().collect::<Vec<_>>());
                let isolated = (0..20u32).filter(|&point| points[point as usize] && !used.contains(&point)).collect::<Vec<_>>();
                let note = isolated.first().map(|&first| MeshFault::IsolatedPoints { count: isolated.len(), first });
                prop_assert_eq!(domain.notes.first(), note.as_ref());
                for (vertex, &point) in domain.point_of_vertex().iter().enumerate() {
                    prop_assert_eq!(domain.vertex_of_point()[point as usize], Some(VertexId::from(vertex)));
                    prop_assert_eq!(domain.complex.points()[vertex], whole.complex.points()[point as usize]);
                }
            }
        }
    }
}

#[test]
fn nan_is_a_hole_and_values_travel_both_ways() {
    let mut values: Vec<f64> = (0..25).map(|point| point as f64).collect();
    values[12] = f64::NAN;
    let mask = Mask::none().without_nan(&values);
    let domain = Domain::from_grid(&Grid::image([5, 5, 1], [0.0; 3], [1.0; 3]), &mask).unwrap();
    assert_eq!(domain.complex.vertex_count(), 24);
    assert_eq!(domain.complex.simplex_count(), 32 - 6);
    // A disc with a hole.
    let [v, e, t] = [domain.complex.vertex_count(), domain.complex.edges().len(), domain.complex.simplex_count()];
    assert_eq!(v as i64 - e as i64 + t as i64, 0);
    let inside = domain.restrict(&values);
    assert!(inside.iter().all(|value| value.is_finite()));
    let doubled: Vec<f64> = inside.iter().map(|value| 2.0 * value).collect();
    let mut output = values.clone();
    domain.extend(&doubled, &mut output);
    for point in 0..25 {
        if point == 12 {
            assert!(output[point].is_nan(), "a point outside keeps its value");
        } else {
            assert_eq!(output[point], 2.0 * values[point]);
        }
    }
}

#[test]
fn infinity_is_no_hole() {
    let mask = Mask::none().without_nan(&[1.0, f64::INFINITY, f64::NAN]);
    assert_eq!(mask.keep_points, Some(vec![true, true, false]));
    // It joins what was masked before.
    let mask = Mask { keep_points: Some(vec![false, true, true]), keep_cells: None }.without_nan(&[1.0, f64::INFINITY, f64::NAN]);
    assert_eq!(mask.keep_points, Some(vec![false, true, false]));
}

#[test]
fn a_mask_can_split_the_domain() {
    let grid = Grid::image([7, 3, 1], [0.0; 3], [1.0; 3]);
    let keep = (0..21).map(|point| point % 7 != 3).collect();
    let domain = Domain::from_grid(&grid, &Mask { keep_points: Some(keep), keep_cells: None }).unwrap();
    assert_eq!(domain.complex.components().1, 2);
}

#[test]
fn masked_points_may_have_any_coordinates() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f64::NAN; 3]];
    let cells = CellList::uniform(CellShape::Triangle, 3, &[0, 1, 2, 1, 3, 2]);
    let error = Domain::from_cells(&points, &cells, &Mask::none()).unwrap_err();
    assert!(matches!(error, DomainError::NonFinitePoint { point: 3, .. }));
    let mask = Mask { keep_points: Some(vec![true, true, true, false]), keep_cells: None };
    let domain = Domain::from_cells(&points, &cells, &mask).unwrap();
    assert_eq!((domain.complex.vertex_count(), domain.notes.len()), (3, 0));
}
