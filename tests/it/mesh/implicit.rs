//! Implicit grids against the explicit subdivision, cell by cell.

use std::collections::{BTreeSet, HashMap};

use morsmooth::field::{VertexId, VertexOrder};
use morsmooth::mesh::{
    Cell, Domain, DomainError, Grid, GridGeometry, ImplicitGrid, Mask, MeshError, SimplicialComplex, Triangulation,
};
use proptest::prelude::*;

fn pair(dims: [usize; 3]) -> (ImplicitGrid, SimplicialComplex) {
    let grid = Grid::image(dims, [1.0, -2.0, 0.5], [0.5, 2.0, 3.0]);
    let explicit = Domain::from_grid(&grid, &Mask::none()).unwrap().complex;
    (ImplicitGrid::new(grid).unwrap(), explicit)
}

fn cells<T: Triangulation>(complex: &T) -> Vec<Cell> {
    (0..4).flat_map(|dimension| complex.cells(dimension).collect::<Vec<_>>()).collect()
}

/// Everything that the trait says, against each other: cells correspond in their order.
fn assert_same(dims: [usize; 3]) {
    let (implicit, explicit) = pair(dims);
    assert_eq!(implicit.dimension(), Triangulation::dimension(&explicit));
    assert_eq!(implicit.vertex_count(), Triangulation::vertex_count(&explicit));
    for dimension in 0..4 {
        assert_eq!(implicit.cell_count(dimension), explicit.cell_count(dimension), "{dims:?}, dimension {dimension}");
    }
    let (ours, theirs) = (cells(&implicit), cells(&explicit));
    assert_eq!(ours.len(), theirs.len());
    let explicit_of: HashMap<Cell, Cell> = ours.iter().copied().zip(theirs).collect();
    let translate = |cells: Vec<Cell>| cells.into_iter().map(|cell| explicit_of[&cell]).collect::<Vec<_>>();
    for &cell in &ours {
        let other = explicit_of[&cell];
        assert!(implicit.is_cell(cell) && explicit.is_cell(other));
        assert_eq!(*implicit.cell_vertices(cell), *explicit.cell_vertices(other), "{dims:?} {cell:?}");
        assert_eq!(translate(implicit.facets(cell).collect()), explicit.facets(other).collect::<Vec<_>>());
        assert_eq!(translate(implicit.cofacets(cell).collect()), explicit.cofacets(other).collect::<Vec<_>>());
        assert_eq!(implicit.is_on_boundary(cell), explicit.is_on_boundary(other), "{dims:?} {cell:?}");
        assert_eq!(implicit.barycentre(cell), explicit.barycentre(other));
        let mut corners = implicit.cell_vertices(cell).to_vec();
        corners.reverse();
        assert_eq!(implicit.cell_of(&corners), Some(cell));
        assert_eq!(explicit.cell_of(&corners), Some(other));
    }
    let values: Vec<f64> = (0..implicit.vertex_count()).map(|vertex| ((vertex * 37) % 11) as f64).collect();
    let order = VertexOrder::of_values(&values).unwrap();
    let mut owned = 0;
    for vertex in (0..implicit.vertex_count()).map(VertexId::from) {
        assert_eq!(implicit.point(vertex), Triangulation::point(&explicit, vertex));
        assert_eq!(translate(implicit.star_cells(vertex).collect()), explicit.star_cells(vertex).collect::<Vec<_>>());
        let lower: Vec<Cell> = implicit.lower_star(vertex, &order).collect();
        assert!(lower.iter().all(|cell| cell.highest_vertex(&implicit, &order) == vertex));
        owned += lower.len();
        assert_eq!(translate(lower), explicit.lower_star(vertex, &order).collect::<Vec<_>>());
        let link = |edges: Vec<[VertexId; 2]>| -> BTreeSet<[VertexId; 2]> {
            edges.into_iter().map(|[a, b]| [a.min(b), a.max(b)]).collect()
        };
        let expected = link(explicit.link_edges(vertex).collect());
        assert_eq!(link(implicit.link_edges(vertex).collect()), expected);
        assert_eq!(expected.len(), explicit.star_cells(vertex).filter(|cell| cell.dimension == 2).count());
        assert_eq!(implicit.neighbours(vertex).collect::<Vec<_>>(), explicit.neighbours(vertex));
    }
    assert_eq!(owned, ours.len());
}

#[test]
fn every_shape_of_grid_is_the_explicit_subdivision() {
    for dims in [
        [2, 1, 1],
        [7, 1, 1],
        [1, 5, 1],
        [1, 1, 4],
        [2, 2, 1],
        [5, 4, 1],
        [5, 1, 4],
        [1, 3, 6],
        [2, 9, 1],
        [2, 2, 2],
        [3, 2, 2],
        [2, 4, 2],
        [2, 2, 5],
        [4, 3, 5],
    ] {
        assert_same(dims);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn random_shapes_of_grids_are_the_explicit_subdivision(dims in [1usize..6, 1usize..6, 1usize..6]) {
        if dims != [1, 1, 1] {
            assert_same(dims);
        }
    }
}

#[test]
fn cells_that_leave_the_grid_are_gaps_between_numbers() {
    let (implicit, _) = pair([3, 3, 3]);
    assert_eq!([0, 1, 2, 3].map(|dimension| implicit.cell_bound(dimension)), [27, 27 * 7, 27 * 12, 27 * 6]);
    assert_eq!(implicit.cell_bound(4), 0);
    let last = Cell { dimension: 3, index: 27 * 6 - 1 };
    assert!(!implicit.is_cell(last) && !implicit.is_cell(Cell { dimension: 3, index: 27 * 6 }));
    assert_eq!(implicit.cell_of(&[VertexId(2), VertexId(3)]), None, "the end of a row and the begin of the next");
    assert_eq!(implicit.cell_of(&[VertexId(1), VertexId(3)]), None, "the other diagonal");
    assert_eq!(implicit.cell_of(&[]), None);
}

#[test]
fn a_large_grid_costs_nothing() {
    let grid = ImplicitGrid::new(Grid::image([700, 700, 700], [0.0; 3], [1.0; 3])).unwrap();
    let (n, m) = (700usize, 699usize);
    assert_eq!(grid.cell_count(3), 6 * m * m * m);
    assert_eq!(grid.cell_count(2), 6 * m * m * m + 6 * n * m * m);
    let last = grid.cell_of(&[342_999_999, 342_999_999 - 1 - 700 - 490_000].map(VertexId)).unwrap();
    assert_eq!(grid.cell_vertices(last).len(), 2);
    assert_eq!(grid.cofacets(last).count(), 6, "the diagonal of a cube");
}

#[test]
fn refusals_name_what_was_found() {
    let point = Grid::image([1, 1, 1], [0.0; 3], [1.0; 3]);
    assert!(matches!(ImplicitGrid::new(point), Err(DomainError::Empty { points: 1, .. })));
    let none = Grid::image([0, 5, 1], [0.0; 3], [1.0; 3]);
    assert!(matches!(ImplicitGrid::new(none), Err(DomainError::Empty { points: 0, .. })));
    let huge = Grid::image([1000, 1000, 400], [0.0; 3], [1.0; 3]);
    let found = 12 * 400_000_000;
    let expected = DomainError::Complex(MeshError::TooLarge { what: "numbers of cells of the grid", found });
    assert_eq!(ImplicitGrid::new(huge), Err(expected));
    let bent = Grid { dims: [2, 2, 1], geometry: GridGeometry::Curvilinear { points: vec![[0.0, f64::NAN, 0.0]; 4] } };
    assert!(matches!(ImplicitGrid::new(bent), Err(DomainError::NonFinitePoint { point: 0, .. })));
    let axes = GridGeometry::Rectilinear { x: vec![0.0, 1.0], y: vec![0.0, f64::INFINITY], z: vec![0.0] };
    let stretched = Grid { dims: [2, 2, 1], geometry: axes };
    assert!(matches!(ImplicitGrid::new(stretched), Err(DomainError::NonFinitePoint { point: 2, .. })));
    let far = Grid::image([3, 1, 1], [0.0; 3], [f64::MAX, 1.0, 1.0]);
    assert!(matches!(ImplicitGrid::new(far), Err(DomainError::NonFinitePoint { point: 2, .. })));
    let short = Grid { dims: [3, 1, 1], geometry: GridGeometry::Curvilinear { points: vec![[0.0; 3]; 2] } };
    assert!(matches!(ImplicitGrid::new(short), Err(DomainError::GridShape { .. })));
}
