//! Stereolithography `.stl`, ascii and binary, through the crate `stl_io`: triangles whose equal corners become one point.

use std::io::{BufWriter, Cursor, Write};

use crate::io::array::{ArrayData, DataArray};
use crate::io::dataset::{CellArray, DataSet};
use crate::io::error::{Fault, Place};

use super::parts::{kind, poly_data};
use super::shapes::Shapes;

/// Reads the triangles; points are numbered as they first come, compared bit for bit.
pub(super) fn read(bytes: &[u8]) -> Result<DataSet, Fault> {
    let told = |error: std::io::Error| Fault::new(Place::File, error.to_string(), "the triangles of an .stl file");
    let mesh = stl_io::read_stl(&mut Cursor::new(bytes)).map_err(told)?;
    let points: Vec<f32> = mesh.vertices.iter().flat_map(|point| point.0).collect();
    let mut cells = CellArray::default();
    for face in &mesh.faces {
        cells.push(face.vertices.map(|vertex| vertex as i64));
    }
    let types = vec![kind::TRIANGLE; mesh.faces.len()];
    Ok(poly_data(DataArray::new("Points", 3, ArrayData::F32(points)), &cells, &types, Vec::new(), Vec::new()))
}

/// Writes binary triangles, in single precision as the format has it.
pub(super) fn write<W: Write>(shapes: &Shapes<'_>, out: &mut BufWriter<W>) -> std::io::Result<()> {
    let triangles: Vec<stl_io::Triangle> = shapes
        .cells()
        .map(|(_, corners)| {
            let at = |corner: usize| shapes.point(corners[corner] as usize);
            let [a, b, c] = [at(0), at(1), at(2)];
            let edge = |from: [f64; 3], to: [f64; 3]| [0, 1, 2].map(|axis| to[axis] - from[axis]);
            let (u, v) = (edge(a, b), edge(a, c));
            let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            let length = cross.iter().map(|x| x * x).sum::<f64>().sqrt();
            let normal = if length > 0.0 { cross.map(|x| (x / length) as f32) } else { [0.0; 3] };
            let vertices = [a, b, c].map(|point| stl_io::Vertex::new(point.map(|x| x as f32)));
            stl_io::Triangle { normal: stl_io::Normal::new(normal), vertices }
        })
        .collect();
    stl_io::write_stl(out, triangles.iter())
}
