//! Simplices of zero measure and coordinates beyond the range of numbers.

use crate::mesh::shapes::{grid, mapped};
use morsmooth::field::VertexId;
use morsmooth::mesh::{CellList, CellShape, Domain, Mask, SimplicialComplex};
use morsmooth::operators::{Derived, OperatorError, cotangent_laplacian, derive, gradients, lumped_mass, positive_laplacian, vertex_gradients};

/// What every operator says about a complex.
fn errors(complex: &SimplicialComplex) -> Vec<OperatorError> {
    let (n, zeros) = (complex.vertex_count(), vec![0.0; complex.vertex_count()]);
    [
        cotangent_laplacian(complex).err(),
        positive_laplacian(complex).err(),
        lumped_mass(complex).err(),
        gradients(complex, &zeros).err(),
        vertex_gradients(complex, &zeros).err(),
        derive(complex, &vec![[0.0; 3]; n], Derived::Divergence).err(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

#[test]
fn zero_measure_is_named_by_simplex_vertices_and_points() {
    // Point 0 is of no cell, so vertices and points have different numbers.
    let points = [[9.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.1, 0.1, 0.0], [0.3, 0.3, 0.0]];
    let cells = CellList::uniform(CellShape::Triangle, 3, &[1, 2, 3, 1, 4, 5, 4, 5, 1]);
    let domain = Domain::from_cells(&points, &cells, &Mask::none()).unwrap();
    let found = errors(&domain.complex);
    assert_eq!(found.len(), 6);
    for error in found {
        let OperatorError::ZeroMeasure { simplex, vertices, ratio } = &error else { panic!("{error}") };
        assert_eq!((*simplex, vertices.as_slice()), (1, [0, 3, 4].map(VertexId).as_slice()));
        assert_eq!(domain.points_of(vertices), [1, 4, 5]);
        assert!(*ratio < 1e-16);
    }
}

#[test]
fn coincident_points_have_zero_measure_in_every_dimension() {
    for dims in [[3, 1, 1], [3, 3, 1], [3, 3, 3]] {
        assert_eq!(errors(&mapped(&grid(dims), |_| [1.0; 3])).len(), 6);
        let broken = mapped(&grid(dims), |p| if p[0] == 1.0 { [f64::NAN; 3] } else { p });
        assert_eq!(errors(&broken).len(), 6);
    }
}

#[test]
fn overflow_and_underflow_are_refused() {
    let tiny = mapped(&grid([3, 3, 3]), |p| p.map(|part| part * 1e-110));
    assert!(matches!(lumped_mass(&tiny), Err(OperatorError::Scale { quantity: "lumped mass", .. })));
    let huge = mapped(&grid([3, 3, 1]), |p| p.map(|part| part * 1e200));
    assert!(matches!(lumped_mass(&huge), Err(OperatorError::Scale { .. })));
    let error = cotangent_laplacian(&huge).unwrap_err();
    assert!(error.to_string().contains("expected a finite, positive sum: rescale the coordinates"), "{error}");
}
