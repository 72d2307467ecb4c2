//! Functions from boundary values, and skinning weights.

mod functions;
mod near;
mod plateaus;
mod refusals;
mod weights;

use crate::mesh::shapes::{Noise, grid, mapped};
use morsmooth::field::VertexId;
use morsmooth::interpolate::BoundaryValues;
use morsmooth::mesh::{Domain, Grid, Mask, SimplicialComplex};

/// A comb with teeth, its inner points moved: obtuse angles and appendages.
pub fn comb() -> SimplicialComplex {
    let dims = [34, 22, 1];
    let keep = (0..dims[0] * dims[1]).map(|point| point / dims[0] < 5 || point % dims[0] % 10 < 4).collect();
    let mask = Mask { keep_points: Some(keep), keep_cells: None };
    let flat = Domain::from_grid(&Grid::image(dims, [0.0; 3], [1.0, 0.4, 1.0]), &mask).unwrap().complex;
    let mut noise = Noise(5);
    let shifts: Vec<[f64; 2]> = flat.points().iter().map(|_| [0.15 * (noise.next() - 0.5), 0.15 * (noise.next() - 0.5)]).collect();
    let points = flat.points().iter().zip(shifts).map(|(p, shift)| [p[0] + shift[0], p[1] + shift[1], 0.0]).collect();
    SimplicialComplex::new(2, points, flat.simplices().to_vec()).unwrap()
}

/// A block of tetrahedra.
pub fn block() -> SimplicialComplex {
    mapped(&grid([7, 6, 5]), |p| [p[0] + 0.1 * p[1] * p[2], p[1], 0.7 * p[2]])
}

/// The vertex nearest to a place.
pub fn nearest(complex: &SimplicialComplex, place: [f64; 3]) -> VertexId {
    let distance = |p: &[f64; 3]| (0..3).map(|axis| (p[axis] - place[axis]).powi(2)).sum::<f64>();
    let vertices = (0..complex.vertex_count()).map(VertexId::from);
    vertices.min_by(|&a, &b| distance(&complex.point(a)).total_cmp(&distance(&complex.point(b)))).unwrap()
}

/// Boundary values of handles that are sets of vertices: 1 on the own ones, 0 on the others'.
pub fn of_handles(handles: &[Vec<VertexId>]) -> Vec<BoundaryValues> {
    let values = |own: usize| {
        let all = handles.iter().enumerate();
        let values = all.flat_map(|(handle, vertices)| vertices.iter().map(move |&vertex| (vertex, f64::from(u8::from(handle == own)))));
        BoundaryValues::from(values.collect::<Vec<_>>())
    };
    (0..handles.len()).map(values).collect()
}

/// A point handle at the tip of each tooth.
pub fn tips_of_comb(complex: &SimplicialComplex) -> Vec<Vec<VertexId>> {
    [1.0, 11.0, 21.0, 31.0].map(|x| vec![nearest(complex, [x, 8.0, 0.0])]).to_vec()
}

/// Three handles on the comb: a point, a bone of joined vertices, a region with inner vertices.
pub fn handles_of_comb(complex: &SimplicialComplex) -> Vec<Vec<VertexId>> {
    let point = vec![nearest(complex, [1.0, 8.0, 0.0])];
    let bone: Vec<VertexId> = (8..14).map(|x| nearest(complex, [f64::from(x), 0.8, 0.0])).collect();
    let near = |p: [f64; 3]| (p[0] - 31.5).abs() < 2.2 && p[1] > 6.5;
    let region = (0..complex.vertex_count()).map(VertexId::from).filter(|&vertex| near(complex.point(vertex))).collect();
    vec![point, bone, region]
}
