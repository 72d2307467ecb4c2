//! Distances along meshes: closed forms, an exhaustive search as second road, invariances, refusals.

mod brute;
mod closed_forms;
mod exact;
mod heat;
mod refusals;

use morsmooth::field::VertexId;
use morsmooth::geodesic::{SurfacePoint, exact_distances};
use morsmooth::mesh::SimplicialComplex;

/// Random numbers in [0, 1) from a seed.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

pub fn at(vertex: usize) -> SurfacePoint {
    SurfacePoint::Vertex(VertexId::from(vertex))
}

pub fn from(complex: &SimplicialComplex, vertex: usize) -> Vec<f64> {
    exact_distances(complex, &[at(vertex)]).unwrap()
}

pub fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

/// A grid of `width x height` points, each square cut along a diagonal chosen at random; `place` moves them, `keep` drops squares.
pub fn grid(
    [width, height]: [usize; 2],
    random: &mut Random,
    mut place: impl FnMut(f64, f64, &mut Random) -> [f64; 3],
    keep: impl Fn(usize, usize) -> bool,
) -> SimplicialComplex {
    let mut points = Vec::new();
    for j in 0..height {
        for i in 0..width {
            points.push(place(i as f64, j as f64, random));
        }
    }
    let mut corners = Vec::new();
    for j in 0..height - 1 {
        for i in 0..width - 1 {
            let [a, b, c, d] = [j * width + i, j * width + i + 1, (j + 1) * width + i + 1, (j + 1) * width + i].map(|k| k as u32);
            if keep(i, j) {
                corners.extend(if random.next() < 0.5 { [a, b, c, a, c, d] } else { [a, b, d, b, c, d] });
            }
        }
    }
    SimplicialComplex::new(2, points, corners).unwrap()
}

/// An icosahedron whose points are moved along their rays by up to `noise`.
pub fn icosahedron(noise: f64, random: &mut Random) -> SimplicialComplex {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points = Vec::new();
    for (one, long) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        points.extend([[0.0, one, long], [one, long, 0.0], [long, 0.0, one]]);
    }
    let mut corners = Vec::new();
    for a in 0..12usize {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if [(a, b), (b, c), (a, c)].iter().all(|&(p, q)| (distance(points[p], points[q]) - 2.0).abs() < 1e-9) {
                    corners.extend([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    for point in &mut points {
        let factor = 1.0 + noise * (random.next() - 0.5);
        *point = point.map(|part| part * factor);
    }
    SimplicialComplex::new(2, points, corners).unwrap()
}
