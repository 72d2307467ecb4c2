//! Subdivision of hexahedra, voxels, wedges and pyramids: conforming, complete, positively oriented.

use super::shapes::Noise;
use morsmooth::field::VertexId;
use morsmooth::mesh::{CellList, CellShape, Domain, Mask, MeshFault, faults};
use proptest::prelude::*;

/// A box of `dims` cells with numbers of points in random order and inner points moved a little.
///
/// Columns along z are of wedges (two a cell, cut along one of both diagonals) or of hexahedra, voxels (where the
/// points are not moved) and sixfold pyramids, at random.
fn random_block(dims: [usize; 3], jitter: f64, seed: u64) -> (Vec<[f64; 3]>, CellList) {
    let mut noise = Noise(seed);
    let [nx, ny, nz] = dims;
    let corners = (nx + 1) * (ny + 1) * (nz + 1);
    let number = noise.permutation(corners + nx * ny * nz);
    let mut points = vec![[0.0; 3]; number.len()];
    let at = |i: usize, j: usize, k: usize| number[i + (nx + 1) * (j + (ny + 1) * k)];
    for (i, j, k) in places([nx + 1, ny + 1, nz + 1]) {
        let inside = i % nx != 0 && j % ny != 0 && k % nz != 0;
        let shift = [0; 3].map(|_| if inside { (noise.next() - 0.5) * 2.0 * jitter } else { 0.0 });
        points[at(i, j, k) as usize] = [i as f64 + shift[0], j as f64 + shift[1], k as f64 + shift[2]];
    }
    let mut cells = CellList::new();
    for (i, j) in (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))) {
        let (wedges, turn) = (noise.bits().is_multiple_of(3), (noise.bits() % 4) as usize);
        for k in 0..nz {
            let outline = |k: usize| [at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k)];
            let (bottom, top) = (outline(k), outline(k + 1));
            let [p, q, r, s] = [0, 1, 2, 3].map(|corner| (corner + turn) % 4);
            if wedges {
                cells.push(CellShape::Wedge, &[bottom[p], bottom[q], bottom[r], top[p], top[q], top[r]]);
                cells.push(CellShape::Wedge, &[bottom[p], bottom[r], bottom[s], top[p], top[r], top[s]]);
                continue;
            }
            let hexahedron = [bottom[p], bottom[q], bottom[r], bottom[s], top[p], top[q], top[r], top[s]];
            match noise.bits() % 3 {
                0 => cells.push(CellShape::Hexahedron, &hexahedron),
                1 => cells.push(
                    CellShape::Voxel,
                    &[bottom[0], bottom[1], bottom[3], bottom[2], top[0], top[1], top[3], top[2]],
                ),
                _ => {
                    let centre = number[corners + i + nx * (j + ny * k)];
                    let sum = hexahedron.iter().fold([0.0; 3], |sum, &point| {
                        std::array::from_fn(|axis| sum[axis] + points[point as usize][axis] / 8.0)
                    });
                    points[centre as usize] = sum;
                    for face in [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]] {
                        let [a, b, c, d] = face.map(|corner| hexahedron[corner]);
                        cells.push(CellShape::Pyramid, &[a, b, c, d, centre]);
                    }
                }
            }
        }
    }
    (points, cells)
}

fn places(dims: [usize; 3]) -> impl Iterator<Item = (usize, usize, usize)> {
    let [nx, ny, nz] = dims;
    (0..nx * ny * nz).map(move |place| (place % nx, place / nx % ny, place / nx / ny))
}

fn signed_volume(domain: &Domain, simplex: usize) -> f64 {
    let [a, b, c, d]: [usize; 4] = std::array::from_fn(|corner| domain.complex.simplex(simplex)[corner] as usize);
    let p = domain.complex.points();
    let [u, v, w]: [[f64; 3]; 3] = [b, c, d].map(|q| std::array::from_fn(|axis| p[q][axis] - p[a][axis]));
    let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    (cross[0] * w[0] + cross[1] * w[1] + cross[2] * w[2]) / 6.0
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn mixed_blocks_conform(nx in 1usize..4, ny in 1usize..4, nz in 1usize..4, seed in any::<u64>(), jitter in 0.0f64..0.1) {
        let (points, cells) = random_block([nx, ny, nz], jitter, seed);
        let domain = Domain::from_cells(&points, &cells, &Mask::none()).unwrap();
        // No branch, no pinch, no opposite neighbours; only centres that no pyramid uses are unreferenced.
        let rest: Vec<MeshFault> = faults(&domain).into_iter().filter(|f| !matches!(f, MeshFault::UnreferencedPoints { .. })).collect();
        prop_assert_eq!(rest, []);
        // Every triangle with one tetrahedron lies on the box, so every inner one has two.
        let complex = &domain.complex;
        let mut uses = vec![0; complex.triangles().len()];
        for simplex in 0..complex.simplex_count() {
            let v: Vec<VertexId> = complex.simplex(simplex).iter().map(|&v| VertexId(v)).collect();
            for face in [[v[1], v[2], v[3]], [v[0], v[2], v[3]], [v[0], v[1], v[3]], [v[0], v[1], v[2]]] {
                uses[complex.triangle(face).unwrap().0 as usize] += 1;
            }
        }
        let size = [nx as f64, ny as f64, nz as f64];
        for (triangle, &uses) in complex.triangles().iter().zip(&uses) {
            let on_box = (0..3).any(|axis| [0.0, size[axis]].iter().any(|&side| triangle.iter().all(|&v| complex.point(v)[axis] == side)));
            prop_assert_eq!(uses, if on_box { 1 } else { 2 });
        }
        let volumes: Vec<f64> = (0..complex.simplex_count()).map(|simplex| signed_volume(&domain, simplex)).collect();
        prop_assert!(volumes.iter().all(|&volume| volume > 0.0));
        let whole: f64 = size.iter().product();
        prop_assert!((volumes.iter().sum::<f64>() - whole).abs() < 1e-12 * whole);
        // One sphere-like ball: its Euler characteristic is 1.
        let [v, e, t, c] = [complex.vertex_count(), complex.edges().len(), complex.triangles().len(), complex.simplex_count()];
        prop_assert_eq!((v + t) as i64 - (e + c) as i64, 1);
    }
}

#[test]
fn counts_of_tetrahedra() {
    let unit: Vec<[f64; 3]> = places([2, 2, 2]).map(|(i, j, k)| [i as f64, j as f64, k as f64]).collect();
    let count = |shape, corners: &[u32]| {
        let cells = CellList::uniform(shape, corners.len(), corners);
        Domain::from_cells(&unit, &cells, &Mask::none()).unwrap().complex.simplex_count()
    };
    assert_eq!(count(CellShape::Hexahedron, &[0, 1, 3, 2, 4, 5, 7, 6]), 6);
    assert_eq!(count(CellShape::Voxel, &[0, 1, 2, 3, 4, 5, 6, 7]), 6);
    assert_eq!(count(CellShape::Wedge, &[0, 1, 2, 4, 5, 6]), 3);
    assert_eq!(count(CellShape::Wedge, &[4, 5, 6, 0, 1, 2]), 3); // numbered the other way round
    assert_eq!(count(CellShape::Pyramid, &[0, 1, 3, 2, 4]), 2);
    assert_eq!(count(CellShape::Pyramid, &[5, 1, 3, 7, 0]), 2); // the apex is the smallest
}

#[test]
fn a_collapsed_hexahedron_is_a_wedge() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    for corners in [[0, 1, 2, 2, 3, 4, 5, 5], [1, 0, 0, 2, 4, 3, 3, 5]] {
        let cells = CellList::uniform(CellShape::Hexahedron, 8, &corners);
        let domain = Domain::from_cells(&points, &cells, &Mask::none()).unwrap();
        assert_eq!(domain.notes, [MeshFault::CollapsedCells { count: 1, first: 0 }]);
        let volume: f64 = (0..domain.complex.simplex_count()).map(|simplex| signed_volume(&domain, simplex)).sum();
        assert!((volume - 0.5).abs() < 1e-15);
    }
}
