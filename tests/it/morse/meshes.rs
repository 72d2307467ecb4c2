//! Complexes chosen by property, and fields on them.

use morsmooth::mesh::SimplicialComplex;
use proptest::prelude::*;

/// A grid of points, triangulated with the diagonal (i,j)-(i+1,j+1); triangles with a point for which `keep` is false are
/// left out.
pub fn masked_grid(width: usize, height: usize, keep: impl Fn(usize, usize) -> bool) -> SimplicialComplex {
    let id = |x: usize, y: usize| (y * width + x) as u32;
    let mut triangles = Vec::new();
    for y in 0..height - 1 {
        for x in 0..width - 1 {
            for [a, b, c] in [[(x, y), (x + 1, y), (x + 1, y + 1)], [(x, y), (x + 1, y + 1), (x, y + 1)]] {
                if [a, b, c].iter().all(|&(x, y)| keep(x, y)) {
                    triangles.extend([a, b, c].map(|(x, y)| id(x, y)));
                }
            }
        }
    }
    let points = (0..width * height).map(|k| [(k % width) as f64, (k / width) as f64, 0.0]).collect();
    SimplicialComplex::new(2, points, triangles).unwrap()
}

/// A full grid: a disc.
pub fn grid(width: usize, height: usize) -> SimplicialComplex {
    masked_grid(width, height, |_, _| true)
}

/// A grid with a hole: an annulus.
pub fn annulus(size: usize) -> SimplicialComplex {
    let inner = size / 3..size - size / 3;
    masked_grid(size, size, |x, y| !(inner.contains(&x) && inner.contains(&y)))
}

/// A grid whose opposite sides are glued: a torus, closed, of genus 1.
pub fn torus(size: usize) -> SimplicialComplex {
    let id = |x: usize, y: usize| ((y % size) * size + x % size) as u32;
    let mut triangles = Vec::new();
    for y in 0..size {
        for x in 0..size {
            triangles.extend([id(x, y), id(x + 1, y), id(x + 1, y + 1)]);
            triangles.extend([id(x, y), id(x + 1, y + 1), id(x, y + 1)]);
        }
    }
    let points = vec![[0.0; 3]; size * size];
    SimplicialComplex::new(2, points, triangles).unwrap()
}

/// The boundary of a cube of grids: a closed sphere.
pub fn sphere(size: usize) -> SimplicialComplex {
    let solid = cubes([size; 3]);
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for corners in solid.simplices().chunks_exact(4) {
        for face in [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]] {
            let mut face = face.map(|corner| corners[corner]);
            face.sort_unstable();
            faces.push(face);
        }
    }
    faces.sort_unstable();
    let rim =
        faces.iter().filter(|face| faces.partition_point(|f| f <= face) - faces.partition_point(|f| f < face) == 1);
    let rim: Vec<u32> = rim.flatten().copied().collect();
    let mut used = rim.clone();
    used.sort_unstable();
    used.dedup();
    let renumbered = rim.iter().map(|vertex| used.binary_search(vertex).unwrap() as u32).collect();
    SimplicialComplex::new(2, vec![[0.0; 3]; used.len()], renumbered).unwrap()
}

/// A block of cubes, each cut into the six tetrahedra of Kuhn: a ball.
pub fn cubes(points_an_axis: [usize; 3]) -> SimplicialComplex {
    let [nx, ny, nz] = points_an_axis;
    let id = |p: [usize; 3]| ((p[2] * ny + p[1]) * nx + p[0]) as u32;
    kuhn([nx - 1, ny - 1, nz - 1], nx * ny * nz, id)
}

/// A block of cubes whose opposite sides are glued: a closed 3-manifold.
pub fn three_torus(size: usize) -> SimplicialComplex {
    let id = |p: [usize; 3]| (((p[2] % size) * size + p[1] % size) * size + p[0] % size) as u32;
    kuhn([size; 3], size * size * size, id)
}

fn kuhn(cells: [usize; 3], vertices: usize, id: impl Fn([usize; 3]) -> u32) -> SimplicialComplex {
    let mut tetrahedra = Vec::new();
    for z in 0..cells[2] {
        for y in 0..cells[1] {
            for x in 0..cells[0] {
                for axes in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
                    let mut corner = [x, y, z];
                    tetrahedra.push(id(corner));
                    for axis in axes {
                        corner[axis] += 1;
                        tetrahedra.push(id(corner));
                    }
                }
            }
        }
    }
    SimplicialComplex::new(3, vec![[0.0; 3]; vertices], tetrahedra).unwrap()
}

/// A chain of `n` vertices.
pub fn line(n: usize) -> SimplicialComplex {
    let edges = (1..n as u32).flat_map(|v| [v - 1, v]).collect();
    SimplicialComplex::new(1, vec![[0.0; 3]; n], edges).unwrap()
}

/// Every mesh of this file in a small size, with its Euler characteristic (isolated vertices not counted).
pub fn all() -> Vec<(&'static str, SimplicialComplex, i64)> {
    vec![
        ("line", line(40), 1),
        ("disc", grid(13, 9), 1),
        ("annulus", annulus(15), 0),
        ("two strips", masked_grid(12, 12, |x, _| x != 5), 2),
        ("torus", torus(9), 0),
        ("sphere", sphere(6), 2),
        ("ball", cubes([6, 5, 4]), 1),
        ("three-torus", three_torus(5), 0),
    ]
}

/// Seeded noise in steps of 1 / `levels`: ties for few levels.
pub fn noise(n: usize, seed: u64, levels: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x2545_f491_4f6c_dd1d;
    let mut next = || {
        // splitmix64
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    (0..n).map(|_| (next() % levels) as f64 / levels as f64).collect()
}

/// Random pure complexes, mostly non-manifold, with isolated vertices and several components, and a field with ties.
pub fn random_field() -> impl Strategy<Value = (SimplicialComplex, Vec<f64>)> {
    (1usize..=3, 4usize..=11).prop_flat_map(|(dimension, n)| {
        let simplex = prop::sample::subsequence((0..n as u32).collect::<Vec<_>>(), dimension + 1);
        let simplices = prop::collection::btree_set(simplex, 1..14);
        let values = prop::collection::vec((0..7i32).prop_map(f64::from), n);
        (simplices, values).prop_map(move |(simplices, values)| {
            let flat = simplices.into_iter().flatten().collect();
            (SimplicialComplex::new(dimension, vec![[0.0; 3]; n], flat).unwrap(), values)
        })
    })
}

/// Random parts of small grids of simplices, some with glued sides: boundary, holes, cavities, pinched vertices and edges,
/// several components; and a field with few or many ties.
pub fn random_part() -> impl Strategy<Value = (SimplicialComplex, Vec<f64>)> {
    let whole = prop_oneof![
        Just(line(12)),
        Just(grid(5, 6)),
        Just(torus(4)),
        Just(sphere(3)),
        Just(cubes([3, 3, 3])),
        Just(cubes([4, 4, 3])),
        Just(three_torus(3)),
    ];
    (whole, 1u64..200, 1u64..40, 50usize..=100).prop_map(|(whole, seed, levels, kept)| {
        let chosen = noise(whole.simplex_count(), seed, 100);
        let is_kept = |simplex: &usize| *simplex == 0 || chosen[*simplex] * 100.0 <= kept as f64;
        let simplices: Vec<u32> =
            (0..whole.simplex_count()).filter(is_kept).flat_map(|simplex| whole.simplex(simplex).to_vec()).collect();
        let vertices = whole.vertex_count();
        let part = SimplicialComplex::new(whole.dimension(), vec![[0.0; 3]; vertices], simplices).unwrap();
        (part, noise(vertices, seed + 1, levels))
    })
}
