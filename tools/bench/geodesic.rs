//! Seconds of distances along a mesh, on one thread, for a comparison with other programs.
//!
//! ```text
//! cargo run --release --example geodesic -- MESH OUT [VERTEX ...]
//! ```
//!
//! Writes to OUT, one list of 64-bit numbers after the other, the exact distances from each vertex named (0 by default), by point of the
//! file; prints a line of JSON with the processor seconds of every step.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

#[path = "clock.rs"]
mod clock;

use std::path::Path;

use clock::processor_seconds;
use morsmooth::geodesic::{ExactGeodesic, SurfacePoint};
use morsmooth::io::{MaskSources, domain, mask, read};

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().unwrap();
    let mut arguments = std::env::args().skip(1);
    let (mesh, out) = (arguments.next().expect("MESH"), arguments.next().expect("OUT"));
    let mut sources: Vec<usize> = arguments.map(|number| number.parse().expect("a point number")).collect();
    if sources.is_empty() {
        sources.push(0);
    }
    let dataset = read(Path::new(&mesh)).unwrap();
    let domain = domain(&dataset, &mask(&dataset, &MaskSources::default()).unwrap()).unwrap();

    let timed = |what: &str, seconds: f64| format!("\"{what}\": {seconds:.6}");
    let begin = processor_seconds();
    let exact = ExactGeodesic::new(&domain.complex).unwrap();
    let mut said = vec![timed("layout", processor_seconds() - begin)];
    let mut bytes = Vec::new();
    let mut each = Vec::new();
    for &source in &sources {
        let vertex = domain.vertex_of_point()[source].expect("a point of the domain");
        let begin = processor_seconds();
        let distances = exact.distances(&[SurfacePoint::Vertex(vertex)]).unwrap();
        each.push(format!("{:.6}", processor_seconds() - begin));
        let mut on_points = vec![f64::NAN; domain.point_count()];
        domain.extend(&distances, &mut on_points);
        bytes.extend(on_points.iter().flat_map(|distance| distance.to_le_bytes()));
    }
    said.push(format!("\"exact\": [{}]", each.join(", ")));
    std::fs::write(out, bytes).unwrap();
    println!("{{{}}}", said.join(", "));
}
