//! The faces of polyhedra, from version 2.5 of the format.

use std::ops::Range;

use crate::io::array::DataArray;
use crate::io::cells::{check_offsets, check_points, indices};
use crate::io::dataset::{CellArray, Polyhedra};
use crate::io::error::{Fault, Place};

use super::lists::at;
use super::steps::{Step, counts};
use super::store::{Node, Stored};

/// VTK's number of a cell that has faces.
const POLYHEDRON: u8 = 42;

/// Faces of all parts, one part behind the other.
pub(super) struct Faces {
    face_offsets: Stored,
    face_connectivity: Stored,
    offsets: Stored,
    members: Stored,
    /// For each part with faces: faces, points of faces, faces of cells.
    sizes: Vec<Option<[u64; 3]>>,
    /// Where the next part begins in `face_offsets`, `face_connectivity`, `offsets`, `members`.
    next: [u64; 4],
}

impl Faces {
    /// # Arguments
    /// * `parts`: the numbers of the parts that are read; `types`: their cells.
    pub fn open(node: &Node, step: Option<&Step>, parts: &Range<u64>, types: &[Vec<u8>]) -> Result<Option<Self>, Fault> {
        let Some(faces) = node.array("NumberOfFaces")? else {
            let first = types.iter().position(|types| types.contains(&POLYHEDRON));
            return match first {
                None => Ok(None),
                Some(part) => Err(Fault::new(Place::File, format!("polyhedra in part {part} of {} without faces", node.path), "NumberOfFaces")),
            };
        };
        let has_faces = |types: &Vec<u8>| types.contains(&POLYHEDRON);
        let whole = node.needed("NumberOfPoints")?.shape[0];
        // VTK 9.7 leaves parts without polyhedra out of the lists, if they were never any.
        let is_dense = faces.shape[0] == whole;
        if !is_dense && (step.is_some() || types.iter().filter(|types| has_faces(types)).count() as u64 != faces.shape[0]) {
            let found = format!("{} numbers for {whole} parts in {}", faces.shape[0], faces.path);
            return Err(Fault::new(Place::File, found, "one a part"));
        }
        let range = if is_dense { parts.clone() } else { 0..faces.shape[0] };
        let list = |name: &str| {
            let stored = node.needed(name)?;
            counts(&stored.integers(range.clone())?, &stored.path)
        };
        let lists = [list("NumberOfFaces")?, list("NumberOfFaceConnectivityIds")?, list("NumberOfPolyhedronToFaceIds")?];
        let mut rows = (0..lists[0].len()).map(|row| [lists[0][row], lists[1][row], lists[2][row]]);
        let sizes = types.iter().map(|types| if is_dense || has_faces(types) { rows.next() } else { None }).collect();
        let start = |name: &str| match step {
            None => Ok::<_, Fault>(0),
            Some(step) => Ok(step.number([name, ""])?.unwrap_or(0)),
        };
        // Every part before has one offset more than cells, and than faces.
        let [cells, first_faces] = [start("CellOffsets")?, start("FaceOffsetsOffsets")?].map(|start| start.saturating_add(parts.start));
        Ok(Some(Self {
            face_offsets: node.needed("FaceOffsets")?,
            face_connectivity: node.needed("FaceConnectivity")?,
            offsets: node.needed("PolyhedronOffsets")?,
            members: node.needed("PolyhedronToFaces")?,
            sizes,
            next: [first_faces, start("FaceConnectivityOffsets")?, cells, start("PolyhedronToFaceIdOffsets")?],
        }))
    }

    /// The faces of a part; parts are asked for in turn.
    pub fn part(&mut self, part: usize, cells: u64, points: u64) -> Result<Option<Polyhedra>, Fault> {
        let Some([faces, face_points, members]) = self.sizes[part] else { return Ok(None) };
        let bound = |count: u64| usize::try_from(count).unwrap_or(usize::MAX);
        let faces_of = |stored: &Stored| stored.path.clone();
        let paths = (faces_of(&self.face_connectivity), faces_of(&self.members));
        let face_list = lists(&self.face_offsets, &self.face_connectivity, &mut self.next[..2], [faces, face_points])?;
        check_points(&face_list, bound(points)).map_err(|fault| at(fault, &paths.0))?;
        let cell_list = lists(&self.offsets, &self.members, &mut self.next[2..], [cells, members])?;
        check_points(&cell_list, face_list.len()).map_err(|fault| at(fault, &paths.1))?;
        Ok((!cell_list.connectivity.is_empty()).then_some(Polyhedra::Lists { faces: face_list, cells: cell_list }))
    }
}

/// Lists from where `next` says, which then says where they end.
fn lists(offsets: &Stored, members: &Stored, next: &mut [u64], [count, length]: [u64; 2]) -> Result<CellArray, Fault> {
    let ends = [next[0].saturating_add(count).saturating_add(1), next[1].saturating_add(length)];
    let numbers = offsets.integers(next[0]..ends[0])?;
    let list = DataArray::new("", 1, members.rows(next[1]..ends[1])?);
    next.copy_from_slice(&ends);
    check_offsets(&numbers, usize::try_from(length).ok()).map_err(|fault| at(fault, &offsets.path))?;
    let (connectivity, width) = indices(list).map_err(|fault| at(fault, &members.path))?;
    Ok(CellArray { offsets: numbers, connectivity, width })
}
