//! Test problems: noisy fields on jittered grids whose extrema are prescribed, and their pieces.
//!
//! Shared by the benchmark and the tests, and built from scratch here: own cotangent matrix, own representative function,
//! own start, so that the engine is judged by code that knows nothing of the library's mesh modules.

use morsmooth::linalg::CsrMatrix;
use morsmooth::qp::{Constraints, Engine, Objective, Problem, Term};

/// What a field is asked to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Case {
    /// Ten bumps and five dips under noise of 0.1, smoothing length 2 % of the side.
    Data,
    /// Only two handles, no data.
    NoData,
    /// As `Data`, but the order of the vertices comes from the noise-free field's pinned minimiser, flooded: few rows are active.
    Smooth,
}

/// A problem with all that a caller of the engine has at hand.
pub struct Instance {
    pub problem: Problem,
    /// Places of the unknowns.
    pub coordinates: Vec<[f64; 3]>,
    /// A strictly feasible start: 0.9 sweep + 0.1 levels.
    pub start: Vec<f64>,
    /// The minimiser without rows.
    pub pinned: Vec<f64>,
}

/// Sebastiano Vigna's SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.unit(), self.unit());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
}

/// A grid of `side x side` points a unit apart, inner ones moved by up to `jitter`, and its triangles.
pub fn jittered_grid(side: usize, jitter: f64, random: &mut Random) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut points = Vec::with_capacity(side * side);
    for row in 0..side {
        for column in 0..side {
            let inner = |at: usize| at > 0 && at + 1 < side;
            let mut shift = |free: bool| if free { jitter * (2.0 * random.unit() - 1.0) } else { 0.0 };
            points.push([column as f64 + shift(inner(column)), row as f64 + shift(inner(row)), 0.0]);
        }
    }
    let mut triangles = Vec::with_capacity(2 * (side - 1) * (side - 1));
    for row in 0..side - 1 {
        for column in 0..side - 1 {
            let at = |r: usize, c: usize| (r * side + c) as u32;
            let (a, b, c, d) = (at(row, column), at(row, column + 1), at(row + 1, column + 1), at(row + 1, column));
            triangles.push([a, b, c]);
            triangles.push([a, c, d]);
        }
    }
    (points, triangles)
}

/// Cotangent Laplacian (rows sum to zero) and lumped mass; `clamp` bounds the edge weights from below.
pub fn laplacian(points: &[[f64; 3]], triangles: &[[u32; 3]], clamp: Option<f64>) -> (CsrMatrix, Vec<f64>) {
    let n = points.len();
    let mut mass = vec![0.0; n];
    let mut entries = Vec::new();
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| points[v as usize]);
        let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
        for corner in 0..3 {
            mass[triangle[corner] as usize] += area / 3.0;
            let (i, j, k) = (triangle[corner], triangle[(corner + 1) % 3], triangle[(corner + 2) % 3]);
            let [p, q, r] = [k, i, j].map(|v| points[v as usize]);
            let cot = ((q[0] - p[0]) * (r[0] - p[0]) + (q[1] - p[1]) * (r[1] - p[1])) / (2.0 * area);
            entries.push((i.min(j), i.max(j), 0.5 * cot));
        }
    }
    let edges = CsrMatrix::from_triplets(n, n, &entries).unwrap();
    let mut triplets = Vec::new();
    for i in 0..n {
        let (columns, weights) = edges.row(i);
        for (&j, &weight) in columns.iter().zip(weights) {
            let weight = clamp.map_or(weight, |low| weight.max(low));
            triplets.extend([(i as u32, j, -weight), (j, i as u32, -weight), (i as u32, i as u32, weight), (j, j, weight)]);
        }
    }
    (CsrMatrix::from_triplets(n, n, &triplets).unwrap(), mass)
}

/// A problem of `side x side` unknowns with the polyharmonic energy of order k.
pub fn instance(side: usize, order: usize, case: Case, seed: u64) -> Instance {
    let mut random = Random(seed);
    let n = side * side;
    let (points, triangles) = jittered_grid(side, 0.2, &mut random);
    let (stiffness, mass) = laplacian(&points, &triangles, None);
    let (positive, _) = laplacian(&points, &triangles, Some(1e-3));
    let mean = mass.iter().sum::<f64>() / n as f64;
    let mass: Vec<f64> = mass.iter().map(|m| m / mean).collect();
    let nearest = |x: f64, y: f64| {
        let far = |p: &[f64; 3]| (p[0] - x * (side - 1) as f64).powi(2) + (p[1] - y * (side - 1) as f64).powi(2);
        (0..n).min_by(|&a, &b| far(&points[a]).total_cmp(&far(&points[b]))).unwrap()
    };
    let mut fixed = vec![None; n];
    let mut poles = vec![None; n];
    let chain = Term::Chain { scale: 1.0, stiffness, weights: mass.iter().map(|m| 1.0 / m).collect(), order };
    let objective = if case == Case::NoData {
        for (x, y, value) in [(0.27, 0.31, 0.0), (0.71, 0.66, 1.0)] {
            fixed[nearest(x, y)] = Some(value);
            poles[nearest(x, y)] = Some(value);
        }
        Objective { terms: vec![chain], linear: vec![0.0; n], constant: 0.0 }
    } else {
        let mut bumps: Vec<(f64, f64, f64)> = Vec::new();
        while bumps.len() < 15 {
            let (x, y) = (0.08 + 0.84 * random.unit(), 0.08 + 0.84 * random.unit());
            if bumps.iter().all(|b| (b.0 - x).hypot(b.1 - y) > 0.17) {
                let height = 0.5 + random.unit();
                bumps.push((x, y, if bumps.len() < 10 { height } else { -height }));
            }
        }
        let clean = |p: &[f64; 3]| -> f64 {
            let scale = (side - 1) as f64;
            let bump = |b: &(f64, f64, f64)| b.2 * (-((p[0] / scale - b.0).powi(2) + (p[1] / scale - b.1).powi(2)) / 0.006).exp();
            bumps.iter().map(bump).sum()
        };
        let data: Vec<f64> = points.iter().map(|p| clean(p) + 0.1 * random.normal()).collect();
        for bump in &bumps {
            let vertex = nearest(bump.0, bump.1);
            fixed[vertex] = Some(clean(&points[vertex]));
            poles[vertex] = Some(if bump.2 > 0.0 { 1.0 } else { 0.0 });
        }
        let omega = (0.02 * side as f64).powi(-2 * order as i32);
        Objective {
            terms: vec![chain, Term::Diagonal(mass.iter().map(|m| 2.0 * omega * m).collect())],
            linear: mass.iter().zip(&data).map(|(m, h)| -2.0 * omega * m * h).collect(),
            constant: mass.iter().zip(&data).map(|(m, h)| omega * m * h * h).sum(),
        }
    };
    let mut engine = Engine::new(&objective, None, Some(&points)).unwrap();
    let pinned = engine.minimise(&objective, &fixed).unwrap().x;
    let edges: Vec<Vec<u32>> = (0..n).map(|i| positive.row(i).0.iter().copied().filter(|&j| j as usize != i).collect()).collect();
    let rank = if case == Case::Smooth {
        flooded(&edges, &pinned, &poles)
    } else {
        let harmonic = Objective { terms: vec![Term::Matrix(positive)], linear: vec![0.0; n], constant: 0.0 };
        engine.minimise(&harmonic, &poles).unwrap().x
    };
    let arcs = monotonicity_edges(&edges, &rank, &fixed);
    let triplets: Vec<(u32, u32, f64)> =
        arcs.iter().enumerate().flat_map(|(row, &(low, high))| [(row as u32, low, -1.0), (row as u32, high, 1.0)]).collect();
    let rows = CsrMatrix::from_triplets(arcs.len(), n, &triplets).unwrap();
    let levels = levels(&arcs, &rank, &fixed);
    let swept = sweep(&arcs, &rank, &fixed, &pinned);
    let start = swept.iter().zip(&levels).map(|(s, l)| 0.9 * s + 0.1 * l).collect();
    let constraints = Constraints::nonnegative(rows, vec![0.0; arcs.len()]);
    Instance { problem: Problem { objective, fixed, constraints }, coordinates: points, start, pinned }
}

fn monotonicity_edges(edges: &[Vec<u32>], rank: &[f64], fixed: &[Option<f64>]) -> Vec<(u32, u32)> {
    let below = |a: u32, b: u32| (rank[a as usize], a) < (rank[b as usize], b);
    let mut arcs = Vec::new();
    let mut add = |a: u32, b: u32| arcs.push(if below(a, b) { (a, b) } else { (b, a) });
    for (i, neighbours) in edges.iter().enumerate() {
        let i32 = i as u32;
        if fixed[i].is_some() {
            neighbours.iter().for_each(|&j| add(i32, j));
        } else {
            let key = |j: &u32| (rank[*j as usize], *j);
            add(i32, *neighbours.iter().min_by(|a, b| key(a).partial_cmp(&key(b)).unwrap()).unwrap());
            add(i32, *neighbours.iter().max_by(|a, b| key(a).partial_cmp(&key(b)).unwrap()).unwrap());
        }
    }
    arcs.sort_unstable();
    arcs.dedup();
    arcs
}

/// Arcs sorted so that every arc into a vertex comes before the arcs out of it.
fn by_rank(arcs: &[(u32, u32)], rank: &[f64]) -> Vec<(u32, u32)> {
    let mut sorted = arcs.to_vec();
    sorted.sort_by(|a, b| (rank[a.0 as usize], a.0, a.1).partial_cmp(&(rank[b.0 as usize], b.0, b.1)).unwrap());
    sorted
}

fn levels(arcs: &[(u32, u32)], rank: &[f64], fixed: &[Option<f64>]) -> Vec<f64> {
    let n = rank.len();
    let up = by_rank(arcs, rank);
    let mut down = arcs.to_vec();
    down.sort_by(|a, b| (rank[b.1 as usize], b.1, b.0).partial_cmp(&(rank[a.1 as usize], a.1, a.0)).unwrap());
    let (mut depth, mut height) = (vec![0.0f64; n], vec![0.0f64; n]);
    let mut low: Vec<f64> = fixed.iter().map(|f| f.unwrap_or(f64::NEG_INFINITY)).collect();
    let mut high: Vec<f64> = fixed.iter().map(|f| f.unwrap_or(f64::INFINITY)).collect();
    for &(a, b) in &up {
        let (a, b) = (a as usize, b as usize);
        depth[b] = if fixed[b].is_some() { 0.0 } else { depth[b].max(depth[a] + 1.0) };
        if fixed[b].is_none() {
            low[b] = low[b].max(low[a]);
        }
    }
    for &(a, b) in &down {
        let (a, b) = (a as usize, b as usize);
        height[a] = if fixed[a].is_some() { 0.0 } else { height[a].max(height[b] + 1.0) };
        if fixed[a].is_none() {
            high[a] = high[a].min(high[b]);
        }
    }
    (0..n).map(|i| fixed[i].unwrap_or(low[i] + (high[i] - low[i]) * depth[i] / (depth[i] + height[i]))).collect()
}

fn sweep(arcs: &[(u32, u32)], rank: &[f64], fixed: &[Option<f64>], x: &[f64]) -> Vec<f64> {
    let mut f = x.to_vec();
    let up = by_rank(arcs, rank);
    let mut down = arcs.to_vec();
    down.sort_by(|a, b| (rank[b.1 as usize], b.1, b.0).partial_cmp(&(rank[a.1 as usize], a.1, a.0)).unwrap());
    for &(a, b) in &up {
        if fixed[b as usize].is_none() {
            f[b as usize] = f[b as usize].max(f[a as usize]);
        }
    }
    for &(a, b) in &down {
        if fixed[a as usize].is_none() {
            f[a as usize] = f[a as usize].min(f[b as usize]);
        }
    }
    f
}

/// The order of a field after flooding it, in turns from below and from above, to extrema at the poles alone.
fn flooded(edges: &[Vec<u32>], field: &[f64], poles: &[Option<f64>]) -> Vec<f64> {
    let n = field.len();
    let mut rank = field.to_vec();
    let spurious = |rank: &[f64]| {
        (0..n).filter(|&i| poles[i].is_none()).any(|i| {
            let above = edges[i].iter().filter(|&&j| (rank[j as usize], j) > (rank[i], i as u32)).count();
            above == 0 || above == edges[i].len()
        })
    };
    for turn in 0..100 {
        if !spurious(&rank) {
            break;
        }
        let (seed, last) = if turn % 2 == 0 { (0.0, 1.0) } else { (1.0, 0.0) };
        let value = |i: usize| if turn % 2 == 0 { rank[i] } else { -rank[i] };
        // Vertices enter by value once a neighbour is in; seeds before their neighbours, opposite poles after all of theirs.
        let mut heap = std::collections::BinaryHeap::new();
        let mut entered = vec![false; n];
        let mut order = Vec::with_capacity(n);
        let key = |v: f64| {
            let bits = v.to_bits() as i64;
            std::cmp::Reverse(bits ^ (((bits >> 63) as u64) >> 1) as i64)
        };
        let mut queued = vec![false; n];
        for i in 0..n {
            if poles[i] == Some(seed) {
                heap.push((key(f64::NEG_INFINITY), std::cmp::Reverse(i)));
                queued[i] = true;
            }
        }
        while let Some((_, std::cmp::Reverse(i))) = heap.pop() {
            entered[i] = true;
            order.push(i);
            for &j in &edges[i] {
                let j = j as usize;
                let ready = poles[j] != Some(last) || edges[j].iter().all(|&k| entered[k as usize]);
                if !queued[j] && ready {
                    heap.push((key(value(j)), std::cmp::Reverse(j)));
                    queued[j] = true;
                }
            }
        }
        for (position, &i) in order.iter().enumerate() {
            rank[i] = if turn % 2 == 0 { position as f64 } else { (n - position) as f64 };
        }
    }
    rank
}
