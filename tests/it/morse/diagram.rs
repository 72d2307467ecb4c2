//! The persistence diagram in all dimensions against reduction of the whole boundary matrix, and theorems about it.

use morsmooth::field::{VertexId, VertexOrder};
use morsmooth::mesh::{Domain, Grid, ImplicitGrid, Mask, SimplicialComplex, Triangulation};
use morsmooth::morse::{
    Cell, ExtremumKind, MorseError, PersistenceDiagram, discrete_gradient, extremum_pairs, persistence_diagram,
};
use proptest::prelude::*;

use super::{brute, meshes};

/// The diagram, equal to the reduced boundary matrix and consistent in itself.
fn check(complex: &SimplicialComplex, values: &[f64]) -> PersistenceDiagram {
    let order = VertexOrder::of_values(values).unwrap();
    let diagram = persistence_diagram(complex, &order).unwrap();
    diagram.check_euler().unwrap();
    assert_eq!(vertices(&diagram), brute::diagram(complex, &order));
    let gradient = discrete_gradient(complex, &order).unwrap();
    assert_eq!(diagram.critical_counts(), gradient.critical_counts());
    for pair in diagram.pairs() {
        assert!(gradient.is_critical(pair.birth) && pair.birth.dimension == pair.dimension);
        assert_eq!(pair.birth.highest_vertex(complex, &order), pair.birth_vertex);
        assert_eq!(pair.death.map(|death| death.highest_vertex(complex, &order)), pair.death_vertex);
        assert!(pair.death.is_none_or(|death| gradient.is_critical(death) && death.dimension == pair.dimension + 1));
        assert!(pair.persistence(values).is_none_or(|persistence| persistence >= 0.0));
    }
    let births: Vec<u32> = diagram.pairs().iter().map(|pair| order.rank(pair.birth_vertex)).collect();
    assert!(births.is_sorted());
    diagram
}

#[test]
fn every_mesh_agrees_with_the_boundary_matrix() {
    for (name, complex, euler) in meshes::all() {
        for (seed, levels) in [(1, 1), (2, 3), (3, 20), (4, 1 << 40), (5, 1 << 40)] {
            let diagram = check(&complex, &meshes::noise(complex.vertex_count(), seed, levels));
            let [components, tunnels, cavities, solids] = diagram.betti_numbers().map(|betti| betti as i64);
            assert_eq!(components - tunnels + cavities - solids, euler, "{name}");
            assert_eq!(diagram.instant_counts(), [0; 4], "{name}: a lower link on a manifold has a perfect gradient");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]
    #[test]
    fn any_random_complex_agrees_with_the_boundary_matrix((complex, values) in meshes::random_field()) {
        check(&complex, &values);
    }

    #[test]
    fn any_part_of_a_grid_agrees_with_the_boundary_matrix((complex, values) in meshes::random_part()) {
        check(&complex, &values);
    }
}

/// (dimension, birth vertex, death vertex) of all pairs, sorted.
fn vertices(diagram: &PersistenceDiagram) -> Vec<(u8, VertexId, Option<VertexId>)> {
    let mut found: Vec<_> =
        diagram.pairs().iter().map(|pair| (pair.dimension, pair.birth_vertex, pair.death_vertex)).collect();
    found.sort_unstable();
    found
}

#[test]
fn turning_a_field_on_a_closed_manifold_upside_down_swaps_birth_and_death() {
    // Poincaré duality: a k-class that lives from v to w is a (d-1-k)-class of -h that lives from w to v, an essential
    // k-class an essential (d-k)-class that is born at the same vertex.
    for complex in [meshes::torus(12), meshes::sphere(7), meshes::three_torus(6)] {
        let top = complex.dimension() as u8;
        for (seed, levels) in [(1, 2), (2, 9), (3, 1 << 40)] {
            let order = VertexOrder::of_values(&meshes::noise(complex.vertex_count(), seed, levels)).unwrap();
            let below = persistence_diagram(&complex, &order).unwrap();
            let above = persistence_diagram(&complex, &order.reversed()).unwrap();
            let mut turned: Vec<_> = vertices(&above)
                .into_iter()
                .map(|(dimension, birth, death)| match death {
                    Some(death) => (top - 1 - dimension, death, Some(birth)),
                    None => (top - dimension, birth, None),
                })
                .collect();
            turned.sort_unstable();
            assert_eq!(vertices(&below), turned);
        }
    }
}

#[test]
fn long_cycles_of_a_lattice_of_wires_are_dual_to_themselves() {
    // Wires along all three axes with a little noise: tunnels between them are long sums of edges, and those of the
    // field upside down are sums of other ones, but they must be the same pairs.
    let size = 16;
    let complex = meshes::three_torus(size);
    let noise = meshes::noise(complex.vertex_count(), 3, 1 << 40);
    let wires = |v: usize| {
        let [a, b, c] = [v % size % 4, v / size % size % 4, v / size / size % 4];
        u8::from(a == 0 && b == 0) + u8::from(b == 2 && c == 0) + u8::from(a == 2 && c == 2)
    };
    let values: Vec<f64> = noise.iter().enumerate().map(|(v, noise)| 1e-3 * noise - f64::from(wires(v))).collect();
    let order = VertexOrder::of_values(&values).unwrap();
    let tunnels = |diagram: &PersistenceDiagram| -> Vec<_> {
        diagram.of_dimension(1).filter_map(|pair| Some((pair.birth_vertex, pair.death_vertex?))).collect()
    };
    let below = persistence_diagram(&complex, &order).unwrap();
    let above = persistence_diagram(&complex, &order.reversed()).unwrap();
    below.check_euler().unwrap();
    assert_eq!([below.betti_numbers(), above.betti_numbers()], [[1, 3, 3, 1]; 2]);
    let mut turned: Vec<_> = tunnels(&above).into_iter().map(|(birth, death)| (death, birth)).collect();
    let mut found = tunnels(&below);
    turned.sort_unstable();
    found.sort_unstable();
    assert!(found.len() > 300, "{}", found.len());
    assert_eq!(found, turned);
}

#[test]
fn extremum_pairs_are_the_first_dimension_and_on_closed_manifolds_the_last() {
    for (name, complex, _) in meshes::all() {
        let order = VertexOrder::of_values(&meshes::noise(complex.vertex_count(), 8, 50)).unwrap();
        let diagram = persistence_diagram(&complex, &order).unwrap();
        let pairs_of = |kind| {
            let mut pairs: Vec<_> =
                extremum_pairs(&complex, &order, kind).iter().map(|pair| (pair.extremum, pair.saddle)).collect();
            pairs.sort_unstable();
            pairs
        };
        let mut minima: Vec<_> =
            diagram.of_dimension(0).map(|pair| (pair.birth_vertex, pair.death_vertex)).collect();
        minima.sort_unstable();
        assert_eq!(minima, pairs_of(ExtremumKind::Minimum), "{name}");
        if ["torus", "sphere", "three-torus"].contains(&name) {
            let top = complex.dimension();
            let filled = diagram.of_dimension(top - 1).filter_map(|pair| Some((pair.death_vertex?, Some(pair.birth_vertex))));
            let essential = diagram.of_dimension(top).map(|pair| (pair.birth_vertex, None));
            let mut maxima: Vec<_> = filled.chain(essential).collect();
            maxima.sort_unstable();
            assert_eq!(maxima, pairs_of(ExtremumKind::Maximum), "{name}");
        }
    }
}

#[test]
fn a_cavity_and_a_tunnel_live_from_their_wall_to_their_filling() {
    // Distance from the centre of a ball of cubes, upside down inside: the shell comes first, the centre last.
    let ball = meshes::cubes([7, 7, 7]);
    let distance = |v: usize| {
        let place = [v % 7, v / 7 % 7, v / 49];
        place.into_iter().map(|at| at.abs_diff(3)).max().unwrap()
    };
    let values: Vec<f64> = (0..343).map(|v| 3.0 - distance(v) as f64).collect();
    let diagram = persistence_diagram(&ball, &VertexOrder::of_values(&values).unwrap()).unwrap();
    let cavities: Vec<f64> = diagram.of_dimension(2).filter_map(|pair| pair.persistence(&values)).filter(|&p| p > 0.0).collect();
    assert_eq!(cavities, [3.0]);
    assert!(diagram.of_dimension(1).all(|pair| pair.persistence(&values) == Some(0.0)));
    assert_eq!(diagram.betti_numbers(), [1, 0, 0, 0]);
    // A disc that rises to its centre line: no tunnel. With the middle cut out, one that never dies.
    let ring = meshes::annulus(12);
    let flat = persistence_diagram(&ring, &VertexOrder::of_values(&[0.0; 144]).unwrap()).unwrap();
    assert_eq!(flat.betti_numbers(), [1, 1, 0, 0]);
    assert_eq!(flat.finite_counts(), [0; 4]);
    assert_eq!(flat.pairs()[0].birth, Cell::vertex(VertexId(0)));
    assert_eq!(flat.highest_vertex(), Some(VertexId(143)));
}

/// Whether two diagrams of one dimension can be matched so that no end moves by more than `distance`; what is left
/// unmatched is at most twice that from birth to death.
fn is_within(one: &[(f64, f64)], other: &[(f64, f64)], distance: f64) -> bool {
    // Nodes of either side: its own points, then a place on the diagonal for every point of the other side.
    let near = |a: &(f64, f64), b: &(f64, f64)| {
        (a.0 - b.0).abs() <= distance && (a.1 == b.1 || (a.1 - b.1).abs() <= distance)
    };
    let small = |a: &(f64, f64)| a.1 - a.0 <= 2.0 * distance;
    let nodes = one.len() + other.len();
    let joined = |left: usize, right: usize| match (one.get(left), other.get(right)) {
        (Some(a), Some(b)) => near(a, b),
        (Some(a), None) => small(a),
        (None, Some(b)) => small(b),
        (None, None) => true,
    };
    fn augment(
        left: usize,
        joined: &dyn Fn(usize, usize) -> bool,
        seen: &mut [bool],
        partner: &mut [Option<usize>],
    ) -> bool {
        for right in 0..seen.len() {
            if !seen[right] && joined(left, right) {
                seen[right] = true;
                if partner[right].is_none_or(|other| augment(other, joined, seen, partner)) {
                    partner[right] = Some(left);
                    return true;
                }
            }
        }
        false
    }
    let mut partner = vec![None; nodes];
    (0..nodes).all(|left| augment(left, &joined, &mut vec![false; nodes], &mut partner))
}

proptest! {
    /// Cohen-Steiner, Edelsbrunner, Harer 2007: the bottleneck distance of the diagrams is at most that of the fields.
    #[test]
    fn a_small_change_of_the_field_changes_the_diagram_little(
        (complex, values) in meshes::random_part(),
        seed in 0u64..1000,
        amount in 0.0f64..0.3,
    ) {
        let change = meshes::noise(values.len(), seed, 1 << 40);
        let moved: Vec<f64> = values.iter().zip(&change).map(|(value, change)| value + amount * (2.0 * change - 1.0)).collect();
        let points = |values: &[f64], dimension: usize| -> Vec<(f64, f64)> {
            let diagram = persistence_diagram(&complex, &VertexOrder::of_values(values).unwrap()).unwrap();
            let value = |vertex: VertexId| values[vertex.index()];
            diagram
                .of_dimension(dimension)
                .map(|pair| (value(pair.birth_vertex), pair.death_vertex.map_or(f64::INFINITY, value)))
                .filter(|point| point.0 != point.1)
                .collect()
        };
        for dimension in 0..=complex.dimension() {
            // Rounding of the sums above, at values up to 1.3.
            prop_assert!(is_within(&points(&values, dimension), &points(&moved, dimension), amount + 4.0 * f64::EPSILON));
        }
    }

    /// The diagram in values does not depend on the numbers of the vertices as long as no two values are equal.
    #[test]
    fn renumbering_the_vertices_changes_nothing(seed in 0u64..1000, size in 3usize..6) {
        let complex = meshes::cubes([size, 4, 3]);
        let n = complex.vertex_count();
        let values = meshes::noise(n, seed, 1 << 50);
        let shuffled = VertexOrder::of_values(&meshes::noise(n, seed + 1, 1 << 50)).unwrap();
        let simplices = complex.simplices().iter().map(|&vertex| shuffled.rank(VertexId(vertex))).collect();
        let renumbered = SimplicialComplex::new(3, vec![[0.0; 3]; n], simplices).unwrap();
        let moved: Vec<f64> = shuffled.sequence().iter().map(|vertex| values[vertex.index()]).collect();
        let ranks = |complex: &SimplicialComplex, values: &[f64]| {
            let order = VertexOrder::of_values(values).unwrap();
            let diagram = persistence_diagram(complex, &order).unwrap();
            let rank = |vertex: VertexId| order.rank(vertex);
            diagram.pairs().iter().map(|pair| (pair.dimension, rank(pair.birth_vertex), pair.death_vertex.map(rank))).collect::<Vec<_>>()
        };
        prop_assert_eq!(ranks(&complex, &values), ranks(&renumbered, &moved));
    }
}

#[test]
fn grids_without_stored_cells_have_the_same_pairs() {
    for dims in [[30, 1, 1], [9, 14, 1], [1, 7, 8], [6, 5, 7], [2, 9, 2]] {
        let grid = Grid::image(dims, [0.0; 3], [1.0; 3]);
        let complex = Domain::from_grid(&grid, &Mask::none()).unwrap().complex;
        let implicit = ImplicitGrid::new(grid).unwrap();
        for levels in [2, 12, 1 << 40] {
            let order = VertexOrder::of_values(&meshes::noise(complex.vertex_count(), 4, levels)).unwrap();
            let stored = persistence_diagram(&complex, &order).unwrap();
            let computed = persistence_diagram(&implicit, &order).unwrap();
            computed.check_euler().unwrap();
            assert_eq!(stored.critical_counts(), computed.critical_counts());
            assert_eq!(stored.pairs().len(), computed.pairs().len());
            for (one, other) in stored.pairs().iter().zip(computed.pairs()) {
                assert_eq!(*complex.cell_vertices(one.birth), *implicit.cell_vertices(other.birth));
                let stored_death = one.death.map(|cell| complex.cell_vertices(cell).to_vec());
                assert_eq!(stored_death, other.death.map(|cell| implicit.cell_vertices(cell).to_vec()));
            }
        }
    }
}

#[test]
fn threads_change_no_bit() {
    let ball = meshes::cubes([14, 13, 12]);
    for levels in [4, 1 << 40] {
        let order = VertexOrder::of_values(&meshes::noise(ball.vertex_count(), 5, levels)).unwrap();
        let with_threads = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| persistence_diagram(&ball, &order).unwrap())
        };
        let alone = with_threads(1);
        for threads in [2, 3, 8] {
            assert_eq!(alone, with_threads(threads));
        }
    }
}

#[test]
fn an_order_of_another_length_is_refused() {
    let order = VertexOrder::of_values(&[0.0; 5]).unwrap();
    let found = persistence_diagram(&meshes::line(4), &order).unwrap_err();
    assert_eq!(found, MorseError::OrderLength { expected: 4, found: 5 });
}
