//! The heat method: near the truth, and nearer on finer meshes.

use morsmooth::field::VertexId;
use morsmooth::geodesic::{GeodesicError, HeatBoundary, HeatGeodesic, HeatOptions, HeatTriangles, SurfacePoint};
use morsmooth::mesh::{Domain, Grid, Mask, SimplicialComplex};

use super::{Random, at, distance, from, grid};

fn worst(mesh: &SimplicialComplex, source: usize) -> f64 {
    let found = HeatGeodesic::new(mesh, HeatOptions::default()).unwrap().distances(&[at(source)]).unwrap();
    let truth = |vertex: usize| distance(mesh.points()[source], mesh.points()[vertex]);
    (0..found.len()).map(|vertex| (found[vertex] - truth(vertex)).abs()).fold(0.0, f64::max)
}

fn box_grid(side: usize, dimension: usize) -> SimplicialComplex {
    let step = 1.0 / (side - 1) as f64;
    let dims = [side, side, if dimension == 3 { side } else { 1 }];
    Domain::from_grid(&Grid::image(dims, [0.0; 3], [step; 3]), &Mask::none()).unwrap().complex
}

#[test]
fn errors_fall_with_the_mesh_size_on_squares_and_cubes() {
    for (dimension, sides, most) in [(2, [11, 21, 41], 0.08), (3, [5, 9, 17], 0.2)] {
        let errors = sides.map(|side: usize| {
            let mesh = box_grid(side, dimension);
            worst(&mesh, mesh.vertex_count() / 2)
        });
        assert!(errors.is_sorted_by(|a, b| a > b) && errors[2] < most, "{dimension}: {errors:?}");
    }
}

#[test]
fn a_line_is_measured_exactly() {
    let points = (0..30).map(|k| [f64::from(k) * f64::from(k), 0.0, 0.0]).collect();
    let line = SimplicialComplex::new(1, points, (0..29).flat_map(|k| [k, k + 1]).collect()).unwrap();
    let found = HeatGeodesic::new(&line, HeatOptions::default()).unwrap().distances(&[at(7)]).unwrap();
    for (vertex, found) in found.iter().enumerate() {
        assert!((found - distance(line.points()[7], line.points()[vertex])).abs() < 1e-9, "{vertex}: {found}");
    }
}

#[test]
fn factors_serve_many_sources_and_parts_without_source_are_infinitely_far() {
    let mut points = box_grid(9, 2).points().to_vec();
    let n = points.len() as u32;
    let corners = box_grid(9, 2).simplices().to_vec();
    points.extend(points.clone().iter().map(|point| [point[0] + 5.0, point[1], 0.0]));
    let both = corners.iter().copied().chain(corners.iter().map(|vertex| vertex + n)).collect();
    let mesh = SimplicialComplex::new(2, points, both).unwrap();
    let mut heat = HeatGeodesic::new(&mesh, HeatOptions::default()).unwrap();
    let first = heat.distances(&[at(40)]).unwrap();
    assert!(first[..n as usize].iter().all(|distance| distance.is_finite()) && first[40].abs() < 1e-12);
    assert!(first[n as usize..].iter().all(|distance| *distance == f64::INFINITY));
    let second = heat.distances(&[at(40), at(n as usize)]).unwrap();
    assert!(second.iter().all(|distance| distance.is_finite()) && second[n as usize].abs() < 1e-12);
    assert_eq!(heat.distances(&[at(40)]).unwrap(), first, "nothing is left of other sources");
}

/// Largest error against a truth, on the Delaunay triangulation and on the given one, and how many edges were flipped.
fn both(mesh: &SimplicialComplex, source: usize, truth: &[f64]) -> ([f64; 2], usize) {
    let mut flips = 0;
    let errors = [HeatTriangles::IntrinsicDelaunay, HeatTriangles::Given].map(|triangles| {
        let mut heat = HeatGeodesic::new(mesh, HeatOptions { triangles, ..HeatOptions::default() }).unwrap();
        flips = flips.max(heat.flips());
        let found = heat.distances(&[at(source)]).unwrap();
        found.iter().zip(truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    });
    (errors, flips)
}

#[test]
fn flipped_edges_make_up_for_a_bad_mesh() {
    // A rectangle of slivers: sheared by twice its height, cut along random diagonals, its points moved a little.
    let sheared = |i: f64, j: f64, random: &mut Random| {
        let (x, y) = (i / 30.0 + 0.01 * random.next(), j / 30.0 + 0.01 * random.next());
        [x + 2.0 * y, y, 0.0]
    };
    let flat = grid([61, 31], &mut Random(1), sheared, |_, _| true);
    let truth = |mesh: &SimplicialComplex, source: usize| from(mesh, source);
    let (errors, flips) = both(&flat, 945, &truth(&flat, 945));
    assert!(flips > 300 && errors[0] < 0.1 * errors[1], "{errors:?} after {flips} flips");
    // A bumpy sheet of stretched triangles.
    let bumpy = |i: f64, j: f64, random: &mut Random| {
        let (x, y) = (i / 8.0 + 0.05 * random.next(), j / 2.0);
        [x + 0.8 * y, y, 0.6 * (1.3 * x).sin() * (0.9 * y).cos()]
    };
    let sheet = grid([60, 24], &mut Random(7), bumpy, |i, j| i < 50 || j > 3);
    let (errors, flips) = both(&sheet, 700, &truth(&sheet, 700));
    assert!(flips > 300 && errors[0] < 0.3 * errors[1], "{errors:?} after {flips} flips");
    // Scale and place of the mesh change nothing but the unit.
    let scaled: Vec<[f64; 3]> = sheet.points().iter().map(|point| point.map(|part| part * 1e-90)).collect();
    let small = SimplicialComplex::new(2, scaled, sheet.simplices().to_vec()).unwrap();
    let of = |mesh: &SimplicialComplex| HeatGeodesic::new(mesh, HeatOptions::default()).unwrap().distances(&[at(700)]).unwrap();
    for (large, small) in of(&sheet).iter().zip(of(&small)) {
        // Points of no triangle are infinitely far.
        assert!(*large == small || (large - small * 1e90).abs() < 1e-6, "{large} {small}");
    }
}

#[test]
fn insulated_walls_serve_narrow_parts_and_change_nothing_without_a_wall() {
    let mean_error = |mesh: &SimplicialComplex, source: usize, boundary| {
        let mut heat = HeatGeodesic::new(mesh, HeatOptions { boundary, ..HeatOptions::default() }).unwrap();
        let found = heat.distances(&[at(source)]).unwrap();
        found.iter().zip(from(mesh, source)).map(|(a, b)| (a - b).abs()).sum::<f64>() / found.len() as f64
    };
    let place = |i: f64, j: f64, random: &mut Random| [i + 0.2 * random.next(), j + 0.2 * random.next(), 0.0];
    let strip = grid([121, 9], &mut Random(5), place, |_, _| true);
    let [mean, insulated] = [HeatBoundary::Mean, HeatBoundary::Insulated].map(|boundary| mean_error(&strip, 4 * 121 + 30, boundary));
    assert!(insulated < 0.9 * mean, "{insulated} {mean}");
    let octahedron = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let faces = [0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5];
    let closed = SimplicialComplex::new(2, octahedron.to_vec(), faces.to_vec()).unwrap();
    let of = |boundary| HeatGeodesic::new(&closed, HeatOptions { boundary, ..HeatOptions::default() }).unwrap().distances(&[at(0)]).unwrap();
    assert_eq!(of(HeatBoundary::Mean), of(HeatBoundary::Insulated));
}

#[test]
fn a_mesh_of_acute_triangles_is_taken_as_it_is() {
    let place = |i: f64, j: f64, _: &mut Random| [i + 0.5 * j, 0.75f64.sqrt() * j, 0.0];
    // Every square cut along the shorter diagonal: equilateral triangles.
    let mut mesh = grid([15, 15], &mut Random(3), place, |_, _| true);
    let corners = (0..14 * 14u32).flat_map(|square| {
        let a = square / 14 * 15 + square % 14;
        [a, a + 1, a + 15, a + 1, a + 16, a + 15]
    });
    mesh = SimplicialComplex::new(2, mesh.points().to_vec(), corners.collect()).unwrap();
    let of = |triangles| {
        let mut heat = HeatGeodesic::new(&mesh, HeatOptions { triangles, ..HeatOptions::default() }).unwrap();
        (heat.flips(), heat.distances(&[at(112)]).unwrap())
    };
    assert_eq!(of(HeatTriangles::IntrinsicDelaunay), of(HeatTriangles::Given));
    assert_eq!(of(HeatTriangles::IntrinsicDelaunay).0, 0);
}

#[test]
fn surfaces_that_are_turned_glued_or_one_sided_are_flipped_where_they_can_be() {
    // A Möbius strip of slivers, triangles in random orientation; and three sheets at one edge.
    let mut random = Random(11);
    let (around, across) = (40usize, 4usize);
    let points: Vec<[f64; 3]> = (0..around * across)
        .map(|at| {
            let angle = std::f64::consts::TAU * (at / across) as f64 / around as f64;
            let (out, (sine, cosine)) = (0.3 * ((at % across) as f64 - 1.5), angle.sin_cos());
            let (half_sine, half_cosine) = (0.5 * angle).sin_cos();
            let radius = 2.0 + out * half_cosine;
            [radius * cosine, radius * sine, out * half_sine]
        })
        .collect();
    let number = |i: usize, j: usize| if i < around { i * across + j } else { across - 1 - j } as u32;
    let mut corners = Vec::new();
    for i in 0..around {
        for j in 0..across - 1 {
            let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
            for [p, q, r] in if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] } {
                corners.extend(if random.next() < 0.5 { [p, q, r] } else { [q, p, r] });
            }
        }
    }
    let strip = SimplicialComplex::new(2, points, corners).unwrap();
    let truth = from(&strip, 5);
    let (errors, flips) = both(&strip, 5, &truth);
    assert!(flips > 0 && errors[0] < 0.65 && errors[0] < errors[1], "{errors:?} after {flips} flips");
    let mut fan = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    let mut corners = Vec::new();
    for (y, z) in [(0.2, 0.0), (-0.2, 0.1), (0.0, 0.3)] {
        let at = fan.len() as u32;
        fan.extend([[0.4, y, z], [0.6, 1.5 * y, 1.5 * z]]);
        corners.extend([0, 1, at, 1, at + 1, at]);
    }
    let fan = SimplicialComplex::new(2, fan, corners).unwrap();
    assert!(HeatGeodesic::new(&fan, HeatOptions::default()).unwrap().distances(&[at(0)]).unwrap().iter().all(|d| d.is_finite()));
    // The same bits for any number of threads.
    let bits = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| HeatGeodesic::new(&strip, HeatOptions::default()).unwrap().distances(&[at(5)]).unwrap())
    };
    assert!(bits(1) == bits(3));
}

#[test]
fn what_cannot_be_done_is_refused() {
    let mesh = box_grid(5, 2);
    let time = |time| HeatGeodesic::new(&mesh, HeatOptions { time, ..HeatOptions::default() }).err();
    assert_eq!(time(0.0), Some(GeodesicError::Number { what: "time of the heat flow", found: 0.0 }));
    assert!(matches!(time(f64::NAN), Some(GeodesicError::Number { .. })));
    let mut heat = HeatGeodesic::new(&mesh, HeatOptions::default()).unwrap();
    assert_eq!(heat.distances(&[]), Err(GeodesicError::NoSource));
    let beyond = SurfacePoint::Vertex(VertexId(25));
    assert_eq!(heat.distances(&[beyond]), Err(GeodesicError::SourceVertex { source_number: 0, vertex: VertexId(25), vertices: 25 }));
    // Heat falls by a factor each edge, until no number is left.
    let points = (0..1500).map(|k| [f64::from(k), 0.0, 0.0]).collect();
    let line = SimplicialComplex::new(1, points, (0..1499).flat_map(|k| [k, k + 1]).collect()).unwrap();
    let mut heat = HeatGeodesic::new(&line, HeatOptions::default()).unwrap();
    assert!(matches!(heat.distances(&[at(0)]), Err(GeodesicError::HeatVanished { .. })));
    assert!(HeatGeodesic::new(&line, HeatOptions { time: 100.0, ..HeatOptions::default() }).unwrap().distances(&[at(0)]).is_ok());
}
