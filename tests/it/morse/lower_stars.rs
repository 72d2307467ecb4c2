//! The gradient against the published algorithm written down word for word.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use morsmooth::field::{VertexId, VertexOrder};
use morsmooth::mesh::{Cell, SimplicialComplex, Triangulation};
use morsmooth::morse::{Pairing, discrete_gradient};
use proptest::prelude::*;

use super::meshes;

/// Ranks of the vertices of a cell, highest first: the order of Robins, Wood and Sheppard.
type Key = Vec<u32>;

/// Robins, Wood, Sheppard 2011, algorithm *ProcessLowerStars*, with sets for queues.
fn pairs(complex: &SimplicialComplex, order: &VertexOrder) -> BTreeMap<Cell, Pairing> {
    let mut pairing = BTreeMap::new();
    for vertex in (0..complex.vertex_count()).map(VertexId::from) {
        if complex.neighbours(vertex).is_empty() {
            continue;
        }
        let key = |cell: Cell| {
            let mut key: Key = complex.cell_vertices(cell).iter().map(|&corner| order.rank(corner)).collect();
            key.sort_unstable_by_key(|&rank| Reverse(rank));
            key
        };
        let star: BTreeMap<Key, Cell> = complex.lower_star(vertex, order).map(|cell| (key(cell), cell)).collect();
        let mut done: BTreeSet<Key> = BTreeSet::new();
        let facets = |cell: &Key| -> Vec<Key> {
            let without = |omitted: usize| {
                let mut facet = cell.clone();
                facet.remove(omitted);
                facet
            };
            (0..cell.len()).map(without).filter(|facet| star.contains_key(facet)).collect()
        };
        let cofacets = |cell: &Key| -> Vec<Key> {
            let one_more = star.keys().filter(|other| other.len() == cell.len() + 1);
            one_more.filter(|other| cell.iter().all(|rank| other.contains(rank))).cloned().collect()
        };
        let open = |cell: &Key, done: &BTreeSet<Key>| -> Vec<Key> {
            facets(cell).into_iter().filter(|facet| !done.contains(facet)).collect()
        };
        let mut pair = |lower: &Key, upper: &Key| {
            pairing.insert(star[lower], Pairing::Up(star[upper]));
            pairing.insert(star[upper], Pairing::Down(star[lower]));
        };
        let own = vec![order.rank(vertex)];
        let Some(steepest) = star.keys().filter(|cell| cell.len() == 2).min().cloned() else {
            continue;
        };
        pair(&own, &steepest);
        done.extend([own, steepest.clone()]);
        let mut zero: BTreeSet<Key> = star.keys().filter(|cell| cell.len() == 2 && **cell != steepest).cloned().collect();
        let mut one: BTreeSet<Key> =
            cofacets(&steepest).into_iter().filter(|cofacet| open(cofacet, &done).len() == 1).collect();
        while !one.is_empty() || !zero.is_empty() {
            while let Some(cell) = one.pop_first() {
                let facets = open(&cell, &done);
                if facets.is_empty() {
                    if !done.contains(&cell) {
                        zero.insert(cell);
                    }
                    continue;
                }
                pair(&facets[0], &cell);
                done.extend([facets[0].clone(), cell.clone()]);
                zero.remove(&facets[0]);
                for next in cofacets(&facets[0]).into_iter().chain(cofacets(&cell)) {
                    if !done.contains(&next) && open(&next, &done).len() == 1 {
                        one.insert(next);
                    }
                }
            }
            if let Some(critical) = zero.pop_first().filter(|cell| !done.contains(cell)) {
                done.insert(critical.clone());
                one.extend(cofacets(&critical).into_iter().filter(|cofacet| open(cofacet, &done).len() == 1));
            }
        }
    }
    pairing
}

fn assert_as_published(complex: &SimplicialComplex, values: &[f64]) {
    let order = VertexOrder::of_values(values).unwrap();
    let gradient = discrete_gradient(complex, &order).unwrap();
    let expected = pairs(complex, &order);
    for cell in (0..4).flat_map(|dimension| complex.cells(dimension)) {
        if cell.dimension == 0 && complex.neighbours(VertexId(cell.index)).is_empty() {
            assert_eq!(gradient.pairing(cell), Pairing::Outside);
        } else {
            let expected = expected.get(&cell).copied().unwrap_or(Pairing::Critical);
            assert_eq!(gradient.pairing(cell), expected, "{cell:?} on {:?}", complex.cell_vertices(cell));
        }
    }
}

#[test]
fn every_mesh_is_paired_as_published() {
    for (_, complex, _) in meshes::all() {
        for levels in [1, 6, 1 << 40] {
            assert_as_published(&complex, &meshes::noise(complex.vertex_count(), 11, levels));
        }
    }
}

#[test]
fn vertices_with_many_lower_neighbours_are_paired_as_published() {
    // Wheels whose hub has 15 to 18 lower neighbours, and cones of such wheels.
    for rim in 15u32..19 {
        let triangles: Vec<u32> = (0..rim).flat_map(|k| [rim, k, (k + 1) % rim]).collect();
        let mut values = meshes::noise(rim as usize + 1, rim.into(), 1 << 40);
        values[rim as usize] = 2.0;
        let wheel = SimplicialComplex::new(2, vec![[0.0; 3]; rim as usize + 1], triangles).unwrap();
        assert_as_published(&wheel, &values);
        let tetrahedra = (0..rim).flat_map(|k| [rim, k, (k + 1) % rim, rim + 1]).collect();
        let cone = SimplicialComplex::new(3, vec![[0.0; 3]; rim as usize + 2], tetrahedra).unwrap();
        for top in [0.5, 3.0, -1.0] {
            let mut values = values.clone();
            values.push(top);
            assert_as_published(&cone, &values);
        }
    }
}

proptest! {
    #[test]
    fn random_complexes_are_paired_as_published((complex, values) in meshes::random_field()) {
        assert_as_published(&complex, &values);
    }
}
