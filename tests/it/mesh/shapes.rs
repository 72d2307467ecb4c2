//! Small meshes by property, for all tests.

use morsmooth::mesh::{Domain, Grid, Mask, SimplicialComplex};

/// A stream of numbers in [0, 1), the same on every machine (splitmix64).
pub struct Noise(pub u64);

impl Noise {
    pub fn next(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A permutation of `0..count` (Fisher–Yates).
    pub fn permutation(&mut self, count: usize) -> Vec<u32> {
        let mut list: Vec<u32> = (0..count as u32).collect();
        for last in (1..count).rev() {
            list.swap(last, (self.bits() % (last as u64 + 1)) as usize);
        }
        list
    }
}

/// A grid subdivided as the library does it, with unit spacing.
pub fn grid(dims: [usize; 3]) -> SimplicialComplex {
    Domain::from_grid(&Grid::image(dims, [0.0; 3], [1.0; 3]), &Mask::none()).unwrap().complex
}

/// A grid whose points off the outer faces are moved by up to `jitter`, so that the domain keeps its shape.
pub fn jittered(dims: [usize; 3], jitter: f64, seed: u64) -> SimplicialComplex {
    let mut noise = Noise(seed);
    let flat = grid(dims);
    let moved = flat.points().iter().map(|point| {
        let inside = (0..3).all(|axis| dims[axis] == 1 || (point[axis] > 0.0 && point[axis] < (dims[axis] - 1) as f64));
        let shift: [f64; 3] = std::array::from_fn(|_| (noise.next() - 0.5) * 2.0 * jitter);
        std::array::from_fn(|axis| point[axis] + if inside && dims[axis] > 1 { shift[axis] } else { 0.0 })
    });
    SimplicialComplex::new(flat.dimension(), moved.collect(), flat.simplices().to_vec()).unwrap()
}

/// Whether a vertex of a grid of these dimensions lies on no outer face.
pub fn is_inside(dims: [usize; 3], vertex: usize) -> bool {
    let place = [vertex % dims[0], vertex / dims[0] % dims[1], vertex / dims[0] / dims[1]];
    (0..3).all(|axis| dims[axis] == 1 || (place[axis] > 0 && place[axis] + 1 < dims[axis]))
}

/// The same complex with its points mapped.
pub fn mapped(complex: &SimplicialComplex, map: impl Fn([f64; 3]) -> [f64; 3]) -> SimplicialComplex {
    let points = complex.points().iter().map(|&point| map(point)).collect();
    SimplicialComplex::new(complex.dimension(), points, complex.simplices().to_vec()).unwrap()
}

/// A turn in space that leaves no axis fixed.
pub fn turned(p: [f64; 3]) -> [f64; 3] {
    let (s, c) = 0.7f64.sin_cos();
    let q = [c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]];
    let (s, c) = 1.1f64.sin_cos();
    [q[0], c * q[1] - s * q[2], s * q[1] + c * q[2]]
}

/// A sphere: an octahedron with its triangles cut in four, `rounds` times.
pub fn sphere(rounds: usize) -> SimplicialComplex {
    let mut points = vec![[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..rounds {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let (p, q): ([f64; 3], [f64; 3]) = (points[a as usize], points[b as usize]);
                let sum: [f64; 3] = std::array::from_fn(|axis| p[axis] + q[axis]);
                let length = sum.iter().map(|part| part * part).sum::<f64>().sqrt();
                points.push(sum.map(|part| part / length));
                points.len() as u32 - 1
            })
        };
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let (d, e, f) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
        }
        triangles = finer;
    }
    SimplicialComplex::new(2, points, triangles.concat()).unwrap()
}

/// A torus of `m x n` squares, each cut in two.
pub fn torus(m: usize, n: usize) -> SimplicialComplex {
    let at = |i: usize, j: usize| (i % m + m * (j % n)) as u32;
    let turn = |part: usize, whole: usize| (part as f64 / whole as f64 * std::f64::consts::TAU).sin_cos();
    let points = (0..m * n).map(|vertex| {
        let ((s, c), (t, d)) = (turn(vertex % m, m), turn(vertex / m, n));
        [(2.0 + d) * c, (2.0 + d) * s, t]
    });
    let mut triangles = Vec::new();
    for (i, j) in (0..n).flat_map(|j| (0..m).map(move |i| (i, j))) {
        triangles.extend([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
    }
    SimplicialComplex::new(2, points.collect(), triangles).unwrap()
}

/// The same complex with its vertices renumbered; `new_of_old[v]` is the new number of `v`.
pub fn renumbered(complex: &SimplicialComplex, new_of_old: &[u32]) -> SimplicialComplex {
    let mut points = vec![[0.0; 3]; complex.vertex_count()];
    for (old, &new) in new_of_old.iter().enumerate() {
        points[new as usize] = complex.points()[old];
    }
    let simplices = complex.simplices().iter().map(|&old| new_of_old[old as usize]).collect();
    SimplicialComplex::new(complex.dimension(), points, simplices).unwrap()
}

/// Runs the same work with one thread and with four.
pub fn with_threads<T>(work: impl Fn() -> T + Send + Sync) -> [T; 2]
where
    T: Send,
{
    [1, 4].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(&work))
}
