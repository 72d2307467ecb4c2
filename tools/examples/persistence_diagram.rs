//! The persistence diagram of a field of a VTK file in plain numbers, with the complex it belongs to.
//!
//!     cargo run --release --example persistence_diagram -- FILE ARRAY FOLDER [MASK]
//!
//! Into FOLDER go `pairs.txt` (a line a pair: dimension, value at birth, value at death or `inf`), `values.f64` (one a
//! vertex) and `simplices.u32` (the vertices of all top simplices), both little-endian. Times go to stdout.
//! `tools/reference/gudhi_diagram.py` compares them with GUDHI.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use morsmooth::field::VertexOrder;
use morsmooth::io::{MaskSources, domain, mask, read};
use morsmooth::morse::{PersistenceDiagram, diagram_of_gradient, discrete_gradient};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, array, folder, masks @ ..] = arguments.as_slice() else {
        return Err("usage: persistence_diagram FILE ARRAY FOLDER [MASK]".into());
    };
    let dataset = read(file)?;
    let sources =
        MaskSources { array: masks.first().cloned(), holes: vec![array.clone()], ..MaskSources::default() };
    let domain = domain(&dataset, &mask(&dataset, &sources)?)?;
    let on_points = dataset.point_array(array).ok_or("no such array")?.to_f64(0);
    let values = domain.restrict(&on_points);
    let complex = &domain.complex;

    let start = Instant::now();
    let order = VertexOrder::of_values(&values)?;
    let gradient = discrete_gradient(complex, &order)?;
    let gradient_seconds = start.elapsed().as_secs_f64();
    let diagram = diagram_of_gradient(complex, &order, &gradient);
    let seconds = start.elapsed().as_secs_f64();
    diagram.check_euler()?;
    println!(
        "{} vertices, {} top simplices, critical cells {:?}, pairs {:?}, Betti numbers {:?}, {seconds:.3} s ({gradient_seconds:.3} s of it the gradient)",
        complex.vertex_count(),
        complex.simplex_count(),
        diagram.critical_counts(),
        diagram.finite_counts(),
        diagram.betti_numbers(),
    );

    let folder = Path::new(folder);
    std::fs::write(folder.join("pairs.txt"), listed(&diagram, &values))?;
    std::fs::write(folder.join("values.f64"), values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>())?;
    let corners = complex.simplices().iter().flat_map(|vertex| vertex.to_le_bytes());
    std::fs::write(folder.join("simplices.u32"), corners.collect::<Vec<u8>>())?;
    Ok(())
}

fn listed(diagram: &PersistenceDiagram, values: &[f64]) -> String {
    let mut text = String::new();
    for pair in diagram.pairs() {
        let death = pair.death_vertex.map_or(f64::INFINITY, |vertex| values[vertex.index()]);
        // Shortest decimals that read back as the same number.
        let _ = writeln!(text, "{} {:?} {death:?}", pair.dimension, values[pair.birth_vertex.index()]);
    }
    text
}
