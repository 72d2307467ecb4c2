//! Which elements of a mesh are folded over their neighbours, whatever the order of their corners in the file.

use crate::mesh::{SimplicialComplex, cross, dot, minus};
use rayon::prelude::*;

/// A facet by rising vertices (the third is unused in 2-D), its element, and the orientation that the element's corners give it.
type Facet = ([u32; 3], u32, bool);

/// Elements that lie on the wrong side of a facet, rising.
///
/// Two elements at a facet lie on different sides of it exactly if their signed measures agree once their corners are ordered
/// alike. Walking over facets sorts each part of the mesh into two orientations; the one with the smaller measure is inverted.
/// Facets with three and more elements carry no information and are not walked over.
///
/// # Cost
/// O(m log m), the sort of the facets in parallel.
pub(super) fn inverted(complex: &SimplicialComplex, measures: &[f64]) -> Vec<usize> {
    let elements = complex.simplex_count();
    let corners = complex.dimension() + 1;
    let mut facets: Vec<Facet> =
        (0..elements).into_par_iter().flat_map_iter(|i| (0..corners).map(move |omitted| facet(complex, i, omitted))).collect();
    facets.par_sort_unstable();
    // Neighbours by element and place; `true` where the two are folded over each other.
    let mut across: Vec<Vec<(u32, bool)>> = vec![Vec::new(); elements];
    let mut begin = 0;
    while begin < facets.len() {
        let end = begin + facets[begin..].iter().take_while(|facet| facet.0 == facets[begin].0).count();
        if end - begin == 2 {
            let ((_, one, first), (_, other, second)) = (facets[begin], facets[begin + 1]);
            // Corners ordered alike induce opposite orientations of the common facet; `facet` includes the sign of the measure.
            across[one as usize].push((other, first == second));
            across[other as usize].push((one, first == second));
        }
        begin = end;
    }
    let mut side: Vec<Option<bool>> = vec![None; elements];
    let mut wrong = Vec::new();
    for seed in 0..elements {
        if side[seed].is_some() {
            continue;
        }
        side[seed] = Some(false);
        let (mut part, mut next) = (vec![seed], 0);
        let mut size = [0.0, 0.0];
        while next < part.len() {
            let here = part[next];
            next += 1;
            let own = side[here].unwrap_or(false);
            size[usize::from(own)] += measures[here];
            for &(other, folded) in &across[here] {
                let other = other as usize;
                if side[other].is_none() {
                    side[other] = Some(own != folded);
                    part.push(other);
                }
            }
        }
        let minority = size[1] <= size[0];
        wrong.extend(part.into_iter().filter(|&element| side[element] == Some(minority)));
    }
    wrong.sort_unstable();
    wrong
}

fn facet(complex: &SimplicialComplex, element: usize, omitted: usize) -> Facet {
    let corners = complex.simplex(element);
    let mut vertices = [u32::MAX; 3];
    let others = corners.iter().enumerate().filter(|&(place, _)| place != omitted).map(|(_, &vertex)| vertex);
    for (slot, vertex) in vertices.iter_mut().zip(others) {
        *slot = vertex;
    }
    // Every exchange of a sort turns the orientation; so does every other omitted corner, and a negative measure.
    let mut positive = omitted.is_multiple_of(2);
    for (a, b) in [(0, 1), (1, 2), (0, 1)] {
        if vertices[a] > vertices[b] {
            vertices.swap(a, b);
            positive = !positive;
        }
    }
    (vertices, element as u32, positive == is_positive(complex, corners))
}

fn is_positive(complex: &SimplicialComplex, corners: &[u32]) -> bool {
    let at = |corner: usize| complex.points()[corners[corner] as usize];
    let (a, b) = (minus(at(1), at(0)), minus(at(2), at(0)));
    match corners.len() {
        3 => cross(a, b)[2] > 0.0,
        _ => dot(cross(a, b), minus(at(3), at(0))) > 0.0,
    }
}
