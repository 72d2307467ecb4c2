//! Orders of elimination on grids, surfaces and volumes: work and fill of minimum degree and of nested dissection.
//!
//! ```text
//! cargo run --release --example orders -- [grid:SIDE | cube:SIDE | FILE ...]
//! ```
//!
//! Files: OFF, OBJ, Medit (.mesh). Matrices: the patterns of `L^k` for k = 1, 2, 3 of the mesh's graph.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::time::Instant;

use morsmooth::linalg::{CsrMatrix, Permutation, SymbolicCholesky, minimum_degree, nested_dissection};

type Mesh = (Vec<[f64; 3]>, Vec<(u32, u32)>);

/// Vertices and edges of a regular grid with the diagonals of its simplices.
fn grid(side: usize, dimension: u32) -> Mesh {
    let n = side.pow(dimension);
    let at = |i: usize| [i % side, i / side % side, i / side / side];
    let places = (0..n).map(|i| at(i).map(|x| x as f64)).collect();
    let mut edges = Vec::new();
    let steps: &[[usize; 3]] =
        &[[1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]][..if dimension == 2 { 3 } else { 7 }];
    for i in 0..n {
        for step in steps {
            let to: [usize; 3] = std::array::from_fn(|axis| at(i)[axis] + step[axis]);
            if to.iter().take(dimension as usize).all(|&x| x < side) {
                edges.push((i as u32, (to[0] + side * (to[1] + side * to[2])) as u32));
            }
        }
    }
    (places, edges)
}

/// Vertices and the edges of the faces or tetrahedra of an OFF, OBJ or Medit file.
fn read(path: &str) -> Mesh {
    let text = std::fs::read_to_string(path).unwrap();
    let mut places = Vec::new();
    let mut edges = Vec::new();
    let mut add = |corners: &[u32]| {
        for (first, a) in corners.iter().enumerate() {
            edges.extend(corners[first + 1..].iter().map(|&b| (*a, b)));
        }
    };
    let numbers = |line: &str| -> Vec<f64> { line.split_whitespace().map_while(|word| word.parse().ok()).collect() };
    if path.ends_with(".obj") {
        for line in text.lines() {
            if let Some(rest) = line.strip_prefix("v ") {
                let p = numbers(rest);
                places.push([p[0], p[1], p[2]]);
            } else if let Some(rest) = line.strip_prefix("f ") {
                let corner = |word: &str| word.split('/').next().unwrap().parse::<u32>().unwrap() - 1;
                add(&rest.split_whitespace().map(corner).collect::<Vec<_>>());
            }
        }
    } else if path.ends_with(".off") {
        let mut lines = text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#')).skip(1);
        let counts = numbers(lines.next().unwrap());
        for _ in 0..counts[0] as usize {
            let p = numbers(lines.next().unwrap());
            places.push([p[0], p[1], p[2]]);
        }
        for _ in 0..counts[1] as usize {
            let face = numbers(lines.next().unwrap());
            add(&face[1..=face[0] as usize].iter().map(|&v| v as u32).collect::<Vec<_>>());
        }
    } else {
        let words: Vec<&str> = text.split_whitespace().collect();
        let section = |name: &str| words.iter().position(|word| *word == name).unwrap();
        let number = |place: usize| words[place].parse::<f64>().unwrap();
        let begin = section("Vertices");
        for vertex in 0..number(begin + 1) as usize {
            places.push(std::array::from_fn(|axis| number(begin + 2 + 4 * vertex + axis)));
        }
        let begin = section("Tetrahedra");
        for cell in 0..number(begin + 1) as usize {
            add(&(0..4).map(|corner| number(begin + 2 + 5 * cell + corner) as u32 - 1).collect::<Vec<_>>());
        }
    }
    (places, edges)
}

fn main() {
    println!("| mesh | n | k | order | seconds (2 threads, wall) | nnz(L) | GF |");
    println!("|---|---|---|---|---|---|---|");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    for name in std::env::args().skip(1) {
        let (places, edges) = match name.split_once(':') {
            Some(("grid", side)) => grid(side.parse().unwrap(), 2),
            Some(("cube", side)) => grid(side.parse().unwrap(), 3),
            _ => read(&name),
        };
        let n = places.len();
        let mut triplets: Vec<(u32, u32, f64)> = (0..n as u32).map(|i| (i, i, 1.0)).collect();
        edges.iter().for_each(|&(a, b)| triplets.extend([(a, b, 1.0), (b, a, 1.0)]));
        let graph = CsrMatrix::from_triplets(n, n, &triplets).unwrap();
        let mut power = graph.clone();
        let short = name.rsplit('/').next().unwrap();
        for k in 1..=3 {
            if k > 1 {
                power = graph.weighted_product(&vec![1.0; n], &power);
            }
            let report = |who: &str, order: &dyn Fn() -> Permutation| {
                let clock = Instant::now();
                let order = order();
                let seconds = clock.elapsed().as_secs_f64();
                let symbolic = SymbolicCholesky::new(&power, order).unwrap();
                let (entries, flops) = (symbolic.factor_entries() as f64, symbolic.factor_flops() * 1e-9);
                println!("| {short} | {n} | {k} | {who} | {seconds:.3} | {entries:.3e} | {flops:.3} |");
            };
            report("minimum degree", &|| minimum_degree(&power).unwrap());
            report("dissection", &|| pool.install(|| nested_dissection(&power, &places).unwrap()));
        }
    }
}
