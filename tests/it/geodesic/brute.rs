//! An exhaustive search for shortest paths: every sequence of triangles is unfolded, nothing is pruned but by length.

use morsmooth::field::VertexId;
use morsmooth::mesh::SimplicialComplex;
use proptest::prelude::*;

use super::{Random, distance, from, grid, icosahedron};

/// Straight lines from one vertex to all others, then shortest chains of them: paths bend at vertices only.
pub fn all_distances(complex: &SimplicialComplex) -> Vec<Vec<f64>> {
    let n = complex.vertex_count();
    let length = |a: u32, b: u32| distance(complex.points()[a as usize], complex.points()[b as usize]);
    let mut table = vec![vec![f64::INFINITY; n]; n];
    (0..n).for_each(|vertex| table[vertex][vertex] = 0.0);
    for edge in complex.edges() {
        let d = length(edge[0].0, edge[1].0);
        table[edge[0].index()][edge[1].index()] = d;
        table[edge[1].index()][edge[0].index()] = d;
    }
    chain(&mut table);
    let bound = table.iter().flatten().filter(|d| d.is_finite()).fold(0.0f64, |most, &d| most.max(d)) * (1.0 + 1e-9);
    for vertex in 0..n as u32 {
        for &triangle in complex.star(VertexId(vertex)) {
            let corners = complex.simplex(triangle as usize);
            let first = corners.iter().position(|&corner| corner == vertex).unwrap();
            let (a, b) = (corners[(first + 1) % 3], corners[(first + 2) % 3]);
            let pa = [length(vertex, a), 0.0];
            let pb = third([0.0, 0.0], pa, length(vertex, b), length(a, b), 1.0);
            let mut search = Search { complex, table: &mut table[vertex as usize], bound };
            search.unfold((a, pa), (b, pb), triangle, pa, pb);
        }
    }
    chain(&mut table);
    table
}

fn chain(table: &mut [Vec<f64>]) {
    for k in 0..table.len() {
        for i in 0..table.len() {
            for j in 0..table.len() {
                let way = table[i][k] + table[k][j];
                if way < table[i][j] {
                    table[i][j] = way;
                }
            }
        }
    }
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The point at given distances from `p` and `q`, to the left of `p q` for side 1, to the right for -1.
fn third(p: [f64; 2], q: [f64; 2], from_p: f64, from_q: f64, side: f64) -> [f64; 2] {
    let base = (q[0] - p[0]).hypot(q[1] - p[1]);
    let (ux, uy) = ((q[0] - p[0]) / base, (q[1] - p[1]) / base);
    let x = (from_p * from_p - from_q * from_q + base * base) / (2.0 * base);
    let y = side * (from_p * from_p - x * x).max(0.0).sqrt();
    [p[0] + x * ux - y * uy, p[1] + x * uy + y * ux]
}

struct Search<'a> {
    complex: &'a SimplicialComplex,
    table: &'a mut [f64],
    bound: f64,
}

impl Search<'_> {
    /// Crosses the edge from `a` to `b`, seen from the origin between the rays `low` and `high`, out of a triangle.
    fn unfold(&mut self, a: (u32, [f64; 2]), b: (u32, [f64; 2]), triangle: u32, low: [f64; 2], high: [f64; 2]) {
        let (along, normal) = ([b.1[0] - a.1[0], b.1[1] - a.1[1]], cross(a.1, b.1));
        if cross(low, high) <= 1e-13 * low[0].hypot(low[1]) * high[0].hypot(high[1]) || normal / along[0].hypot(along[1]) > self.bound {
            return;
        }
        let across = self.complex.star(VertexId(a.0)).iter().copied().find(|&other| {
            other != triangle && self.complex.simplex(other as usize).contains(&b.0)
        });
        let Some(next) = across else { return };
        let c = *self.complex.simplex(next as usize).iter().find(|&&corner| corner != a.0 && corner != b.0).unwrap();
        let length = |p: u32| distance(self.complex.points()[p as usize], self.complex.points()[c as usize]);
        let pc = third(a.1, b.1, length(a.0), length(b.0), -1.0);
        let slack = 1e-12 * self.bound * self.bound;
        if cross(low, pc) >= -slack && cross(pc, high) >= -slack {
            let slot = &mut self.table[c as usize];
            *slot = slot.min(pc[0].hypot(pc[1]));
        }
        self.unfold(a, (c, pc), next, low, if cross(pc, high) > 0.0 { pc } else { high });
        self.unfold((c, pc), b, next, if cross(low, pc) > 0.0 { pc } else { low }, high);
    }
}

fn compare(complex: &SimplicialComplex) {
    let table = all_distances(complex);
    let scale = table.iter().flatten().filter(|d| d.is_finite()).fold(0.0f64, |most, &d| most.max(d));
    for (source, row) in table.iter().enumerate().filter(|&(source, _)| !complex.star(VertexId::from(source)).is_empty()) {
        for (vertex, (&found, &expected)) in from(complex, source).iter().zip(row).enumerate() {
            let is_same = found == expected || (found - expected).abs() <= 1e-10 * scale;
            assert!(is_same, "{source} to {vertex}: {found}, exhaustive search {expected}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn terrains_agree_with_the_exhaustive_search(seed in any::<u64>(), steepness in 0.0..2.0f64) {
        let place = |x: f64, y: f64, random: &mut Random| {
            [x + 0.5 * random.next(), y + 0.5 * random.next(), steepness * random.next()]
        };
        compare(&grid([5, 4], &mut Random(seed), place, |_, _| true));
    }

    #[test]
    fn holes_agree_with_the_exhaustive_search(seed in any::<u64>(), hole in 0..12usize) {
        let place = |x: f64, y: f64, random: &mut Random| [x + 0.3 * random.next(), y + 0.3 * random.next(), 0.5 * random.next()];
        compare(&grid([5, 4], &mut Random(seed), place, |i, j| j * 4 + i != hole));
    }

    #[test]
    fn closed_surfaces_agree_with_the_exhaustive_search(seed in any::<u64>(), noise in 0.0..1.0f64) {
        compare(&icosahedron(noise, &mut Random(seed)));
    }
}

#[test]
fn a_band_with_one_side_agrees_with_the_exhaustive_search() {
    // A Möbius band: no consistent orientation.
    let n = 7u32;
    let turn = std::f64::consts::TAU / f64::from(n);
    let mut points = Vec::new();
    for k in 0..n {
        let (angle, half) = (turn * f64::from(k), turn * f64::from(k) / 2.0);
        for width in [-0.5, 0.5] {
            let radius = 2.0 + width * half.cos();
            points.push([radius * angle.cos(), radius * angle.sin(), width * half.sin()]);
        }
    }
    let mut corners = Vec::new();
    for k in 0..n {
        let [a, b] = [2 * k, 2 * k + 1];
        let [c, d] = if k + 1 < n { [a + 2, b + 2] } else { [1, 0] };
        corners.extend([a, b, c, b, d, c]);
    }
    compare(&SimplicialComplex::new(2, points, corners).unwrap());
}

#[test]
fn a_flat_grid_with_every_tie_agrees_with_the_exhaustive_search() {
    compare(&grid([5, 5], &mut Random(1), |x, y, _| [x, y, 0.0], |_, _| true));
    compare(&grid([5, 5], &mut Random(2), |x, y, _| [x, y, 0.0], |i, j| !(i == 1 && (j == 1 || j == 2))));
}
