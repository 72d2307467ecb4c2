//! Points and cells of a data set as the writers of mesh files see them, and what they cannot hold.

use std::io::{BufWriter, Write};

use crate::io::array::{ArrayData, DataArray};
use crate::io::dataset::{CellArray, DataSet, Geometry};
use crate::io::write::Objection;

use super::MeshFormat;
use super::parts::kind;

/// The cells of a data set in its order, with VTK's number of their kind.
pub(in crate::io) struct Shapes<'a> {
    points: &'a DataArray,
    runs: Vec<(&'a CellArray, Kinds<'a>)>,
}

#[derive(Clone, Copy)]
enum Kinds<'a> {
    Listed(&'a [u8]),
    /// By number of corners.
    Polygons,
    Lines,
    Vertices,
    Strips,
}

impl<'a> Shapes<'a> {
    /// The points and cells of a data set.
    ///
    /// # Errors
    /// A grid, whose cells are not listed: it must be made into a mesh first.
    pub fn of(dataset: &'a DataSet) -> Result<Self, Objection> {
        match &dataset.geometry {
            Geometry::PolyData { points, verts, lines, polys, strips } => Ok(Self {
                points,
                runs: vec![
                    (verts, Kinds::Vertices),
                    (lines, Kinds::Lines),
                    (polys, Kinds::Polygons),
                    (strips, Kinds::Strips),
                ],
            }),
            Geometry::UnstructuredGrid { points, cells, types, .. } => {
                Ok(Self { points, runs: vec![(cells, Kinds::Listed(types))] })
            }
            grid => Err((grid.name().to_owned(), "points with listed cells (poly data or an unstructured grid)".to_owned())),
        }
    }

    pub fn point_count(&self) -> usize {
        self.points.tuples()
    }

    pub fn point(&self, index: usize) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.points.data.number(3 * index + axis).unwrap_or(f64::NAN))
    }

    /// Kind and points of each cell.
    pub fn cells(&self) -> impl Iterator<Item = (u8, &'a [i64])> {
        self.runs.iter().flat_map(|&(cells, kinds)| {
            (0..cells.len()).map(move |cell| {
                let corners = cells.cell(cell);
                let kind = match (kinds, corners.len()) {
                    (Kinds::Listed(types), _) => types[cell],
                    (Kinds::Vertices, 1) => kind::VERTEX,
                    (Kinds::Vertices, _) => 2,
                    (Kinds::Lines, 2) => kind::LINE,
                    (Kinds::Lines, _) => kind::POLYLINE,
                    (Kinds::Polygons, 3) => kind::TRIANGLE,
                    (Kinds::Polygons, 4) => kind::QUAD,
                    (Kinds::Polygons, _) => kind::POLYGON,
                    (Kinds::Strips, _) => kind::STRIP,
                };
                (kind, corners)
            })
        })
    }

    /// Refuses cells that a format does not know.
    pub fn check(&self, format: MeshFormat) -> Result<(), Objection> {
        let (known, words): (&[u8], &str) = match format {
            MeshFormat::Stl => (&[kind::TRIANGLE], "triangles"),
            MeshFormat::Off | MeshFormat::Ply => (&[3, 5, 7, 9], "lines, triangles, quads and polygons"),
            MeshFormat::Obj => (&[1, 2, 3, 4, 5, 7, 9], "points, lines, triangles, quads and polygons"),
            MeshFormat::Medit => (&[1, 3, 5, 9, 10, 12], "points, lines, triangles, quads, tetrahedra and hexahedra"),
            // Cells of any kind are left out of tables.
            MeshFormat::Png | MeshFormat::Npy | MeshFormat::Table(_) => return Ok(()),
            MeshFormat::Gmsh => {
                (&[1, 3, 5, 9, 10, 12, 13, 14], "points, lines, triangles, quads, tetrahedra, hexahedra, wedges and pyramids")
            }
        };
        match self.cells().enumerate().find(|(_, (kind, _))| !known.contains(kind)) {
            Some((cell, (kind, corners))) => {
                Err((format!("cell {cell} of VTK type {kind} with {} points", corners.len()), words.to_owned()))
            }
            None => Ok(()),
        }
    }

    /// What the format has no room for, in words.
    pub fn losses(&self, format: MeshFormat, dataset: &DataSet) -> Vec<String> {
        let mut lost = Vec::new();
        let keeps = |array: &DataArray| !matches!(array.data, ArrayData::String(_));
        let kept: fn(MeshFormat, &DataArray) -> bool = |format, array| match format {
            MeshFormat::Gmsh => true,
            MeshFormat::Ply => array.components == 1 || super::ply::group(array).is_some(),
            MeshFormat::Medit => array.name == super::medit::LABEL && array.components == 1,
            _ => false,
        };
        for (what, attributes) in [("point", &dataset.point_data), ("cell", &dataset.cell_data)] {
            for array in attributes.arrays.iter().filter(|array| !(keeps(array) && kept(format, array))) {
                lost.push(format!("{what} array \"{}\"", array.name.escape_debug()));
            }
        }
        lost.extend(dataset.field_data.iter().map(|array| format!("field array \"{}\"", array.name.escape_debug())));
        if format == MeshFormat::Stl {
            if !matches!(self.points.data, ArrayData::F32(_)) {
                lost.push("coordinates beyond single precision".to_owned());
            }
            lost.push("numbers of points (equal corners become one point)".to_owned());
        }
        lost
    }

    /// Writes a line a point, with the digits that give back the same number.
    pub fn write_points<W: Write>(&self, out: &mut BufWriter<W>, before: &str, after: &str) -> std::io::Result<()> {
        for point in 0..self.point_count() {
            out.write_all(before.as_bytes())?;
            for axis in 0..3 {
                if axis > 0 {
                    out.write_all(b" ")?;
                }
                self.write_coordinate(out, 3 * point + axis)?;
            }
            writeln!(out, "{after}")?;
        }
        Ok(())
    }

    fn write_coordinate<W: Write>(&self, out: &mut BufWriter<W>, index: usize) -> std::io::Result<()> {
        match &self.points.data {
            ArrayData::F32(values) => write!(out, "{:?}", values[index]),
            other => write!(out, "{:?}", other.number(index).unwrap_or(f64::NAN)),
        }
    }

    pub fn points(&self) -> &DataArray {
        self.points
    }
}
