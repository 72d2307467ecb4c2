//! Extremum pairs of a mesh in plain text, as JSON, with the time of every stage on stderr.
//!
//!     cargo run --release --example extremum_pairs -- MESH.txt [OUT.json]
//!     cargo run --release --example extremum_pairs -- --noise WIDTH HEIGHT [DEPTH]
//!
//! The text holds the dimension, the number of vertices and of simplices, then the values, then the simplices, all
//! separated by white space; `tools/reference/gudhi_pairs.py --dump` writes it. `--noise` takes a grid of seeded noise
//! instead and writes no pairs.
#![allow(clippy::print_stderr, clippy::print_stdout)]

use std::error::Error;
use std::fmt::Write as _;
use std::time::Instant;

use morsmooth::audit;
use morsmooth::field::VertexOrder;
use morsmooth::mesh::SimplicialComplex;
use morsmooth::morse::{
    ExtremumGraph, ExtremumKind, ExtremumPair, MorseComplex, Selection, Threshold, extremum_pairs, select, separatrices,
};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["--noise", sizes @ ..] if sizes.len() == 2 || sizes.len() == 3 => {
            let sizes = sizes.iter().map(|size| size.parse()).collect::<Result<Vec<usize>, _>>()?;
            let (complex, values) = noise(&sizes)?;
            run(&complex, &values)?;
        }
        [input, output @ ..] if output.len() <= 1 => {
            let (complex, values) = parse(&std::fs::read_to_string(input)?)?;
            let json = run(&complex, &values)?;
            match output {
                [path] => std::fs::write(path, json)?,
                _ => println!("{json}"),
            }
        }
        _ => return Err("usage: extremum_pairs MESH.txt [OUT.json] | --noise WIDTH HEIGHT [DEPTH]".into()),
    }
    Ok(())
}

fn timed<T>(stage: &str, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    eprintln!("{stage:<28} {:8.2} ms", start.elapsed().as_secs_f64() * 1e3);
    result
}

fn run(complex: &SimplicialComplex, values: &[f64]) -> Result<String, Box<dyn Error>> {
    eprintln!("{} vertices, {} top simplices", complex.vertex_count(), complex.simplex_count());
    let order = timed("vertex order", || VertexOrder::of_values(values))?;
    let minima = timed("pairs of the minima", || extremum_pairs(complex, &order, ExtremumKind::Minimum));
    let maxima = timed("pairs of the maxima", || extremum_pairs(complex, &order, ExtremumKind::Maximum));
    eprintln!("{} minima, {} maxima", minima.len(), maxima.len());
    let found = timed("audit", || audit::extrema(complex, values))?;
    assert_eq!((found.minima.len(), found.maxima.len()), (minima.len(), maxima.len()));
    let mut below = timed("gradient of h", || ExtremumGraph::new(complex, &order, ExtremumKind::Minimum))?;
    let mut above = timed("gradient of -h", || ExtremumGraph::new(complex, &order, ExtremumKind::Maximum))?;
    below.gradient().check_euler()?;
    above.gradient().check_euler()?;
    let morse = timed("Morse complex of h", || MorseComplex::new(complex, below.gradient()));
    eprintln!("{} critical cells, {} separatrices", morse.critical_cells().count(), morse.separatrices().count());
    let wanted = select(&minima, &maxima, values, &Selection::Threshold(Threshold::Fraction(0.2)))?;
    timed("simplification to 20 %", || {
        below.simplify(values, &wanted.minima)?;
        above.simplify(values, &wanted.maxima).map(|_| ())
    })?;
    let skeleton = timed("separatrices that are left", || separatrices(&below, &above));
    eprintln!(
        "{} minima, {} maxima, {} saddles, {} + {} separatrices left",
        wanted.minima.len(),
        wanted.maxima.len(),
        skeleton.saddles.len(),
        skeleton.descending.len(),
        skeleton.ascending.len()
    );
    let mut json = String::new();
    write!(json, "{{\"minima_pairs\": [{}], ", list(&minima, values))?;
    writeln!(json, "\"maxima_pairs\": [{}]}}", list(&maxima, values))?;
    Ok(json)
}

fn list(pairs: &[ExtremumPair], values: &[f64]) -> String {
    let of_pair = |pair: &ExtremumPair| {
        let death = pair.saddle.map_or("null".to_string(), |saddle| format!("{:?}", values[saddle.index()]));
        format!("[{:?}, {death}]", values[pair.extremum.index()])
    };
    pairs.iter().map(of_pair).collect::<Vec<_>>().join(", ")
}

fn parse(text: &str) -> Result<(SimplicialComplex, Vec<f64>), Box<dyn Error>> {
    let mut words = text.split_ascii_whitespace();
    let mut head = || -> Result<usize, Box<dyn Error>> { Ok(words.next().ok_or("no dimension or count")?.parse()?) };
    let (dimension, vertices, simplices) = (head()?, head()?, head()?);
    let values = words.by_ref().take(vertices).map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    let corners = words.by_ref().take(simplices * (dimension + 1)).map(str::parse).collect::<Result<_, _>>()?;
    Ok((SimplicialComplex::new(dimension, vec![[0.0; 3]; vertices], corners)?, values))
}

/// Seeded noise on a grid of triangles or of Kuhn's tetrahedra.
fn noise(sizes: &[usize]) -> Result<(SimplicialComplex, Vec<f64>), Box<dyn Error>> {
    let (nx, ny, nz) = (sizes[0], sizes[1], sizes.get(2).copied().unwrap_or(1));
    let id = |p: [usize; 3]| ((p[2] * ny + p[1]) * nx + p[0]) as u32;
    let orders: &[&[usize]] = match sizes.len() {
        2 => &[&[0, 1], &[1, 0]],
        _ => &[&[0, 1, 2], &[0, 2, 1], &[1, 0, 2], &[1, 2, 0], &[2, 0, 1], &[2, 1, 0]],
    };
    let mut simplices = Vec::new();
    for z in 0..nz.max(2) - 1 {
        for y in 0..ny - 1 {
            for x in 0..nx - 1 {
                for axes in orders {
                    let mut corner = [x, y, z];
                    simplices.push(id(corner));
                    for &axis in *axes {
                        corner[axis] += 1;
                        simplices.push(id(corner));
                    }
                }
            }
        }
    }
    let mut state = 1u64;
    let values = (0..nx * ny * nz).map(|_| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64
    });
    let values = values.collect();
    let complex =
        timed("explicit complex", || SimplicialComplex::new(sizes.len(), vec![[0.0; 3]; nx * ny * nz], simplices))?;
    Ok((complex, values))
}
