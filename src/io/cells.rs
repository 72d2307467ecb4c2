//! Checks of the lists of point numbers that a file holds, so that nothing behind the reader meets a number out of range.

use super::array::{ArrayData, DataArray};
use super::dataset::{CellArray, IndexWidth, Polyhedra};
use super::error::{Fault, Place};

/// The integers of an array and the width in which a file may store them.
pub(super) fn indices(array: DataArray) -> Result<(Vec<i64>, IndexWidth), Fault> {
    match array.data {
        ArrayData::I64(values) => Ok((values, IndexWidth::Bits64)),
        ArrayData::I32(values) => Ok((values.into_iter().map(i64::from).collect(), IndexWidth::Bits32)),
        other => match other.to_i64() {
            Ok(values) => Ok((values, IndexWidth::Bits64)),
            Err(_) => {
                let found = format!("{} in array \"{}\"", other.value_type().xml_name(), array.name);
                Err(Fault::new(Place::File, found, "integers within 64 signed bits"))
            }
        },
    }
}

/// Refuses offsets that fall, and a last one that is not `length` if that is known.
pub(super) fn check_offsets(offsets: &[i64], length: Option<usize>) -> Result<(), Fault> {
    if offsets.first() != Some(&0) {
        return Err(Fault::new(Place::File, format!("{:?} as first offset", offsets.first()), "0"));
    }
    if let Some(cell) = offsets.windows(2).position(|pair| pair[1] < pair[0]) {
        let found = format!("cell {cell} from {} to {}", offsets[cell], offsets[cell + 1]);
        return Err(Fault::new(Place::File, found, "offsets that do not fall"));
    }
    let last = offsets[offsets.len() - 1];
    match length {
        Some(length) if i64::try_from(length) != Ok(last) => {
            Err(Fault::new(Place::File, format!("a last offset of {last}"), format!("{length}")))
        }
        _ => Ok(()),
    }
}

/// Refuses a cell that names a point out of range.
pub(super) fn check_points(cells: &CellArray, points: usize) -> Result<(), Fault> {
    let outside = |&id: &i64| usize::try_from(id).map_or(true, |id| id >= points);
    let Some(place) = cells.connectivity.iter().position(outside) else { return Ok(()) };
    let cell = cells.offsets.partition_point(|&offset| offset <= place as i64).saturating_sub(1);
    let found = format!("number {} in cell {cell}", cells.connectivity[place]);
    Err(Fault::new(Place::File, found, format!("numbers from 0, less than {points}")))
}

impl Polyhedra {
    /// Refuses runs that leave the list of faces or name points out of range. Lists are checked as cells.
    pub(super) fn check(&self, points: usize) -> Result<(), Fault> {
        let Self::Stream { faces, offsets, .. } = self else { return Ok(()) };
        let mut start = 0;
        for (cell, &end) in offsets.iter().enumerate() {
            if end < 0 {
                continue;
            }
            let run = usize::try_from(end).ok().and_then(|end| faces.get(start..end));
            if !run.is_some_and(|run| is_face_run(run, points)) {
                return Err(Fault::new(Place::File, format!("broken faces of polyhedron {cell}"), "counts and point numbers"));
            }
            start = end as usize;
        }
        Ok(())
    }
}

/// Whether a list reads `faces, (points, point ...) ...`, with points in range.
pub(super) fn is_face_run(run: &[i64], points: usize) -> bool {
    let Some((&count, mut rest)) = run.split_first() else { return false };
    for _ in 0..count {
        let Some((&length, tail)) = rest.split_first() else { return false };
        let Some(length) = usize::try_from(length).ok().filter(|&length| length <= tail.len()) else { return false };
        let (face, tail) = tail.split_at(length);
        if face.iter().any(|&point| usize::try_from(point).map_or(true, |point| point >= points)) {
            return false;
        }
        rest = tail;
    }
    rest.is_empty()
}

impl Polyhedra {
    /// The faces and, for each cell, its faces.
    pub(super) fn to_lists(&self) -> (CellArray, CellArray) {
        match self {
            Self::Lists { faces, cells } => (faces.clone(), cells.clone()),
            Self::Stream { faces: stream, offsets, width } => {
                let mut faces = CellArray { width: *width, ..CellArray::default() };
                let mut cells = CellArray { width: *width, ..CellArray::default() };
                let mut start = 0;
                for &end in offsets {
                    let run = usize::try_from(end).ok().and_then(|end| stream.get(start..end)).unwrap_or_default();
                    let first = faces.len() as i64;
                    for face in faces_of_run(run) {
                        faces.push(face.iter().copied());
                    }
                    cells.push(first..faces.len() as i64);
                    start = start.max(usize::try_from(end).unwrap_or(start));
                }
                (faces, cells)
            }
        }
    }

    /// The run `faces, (points, point ...) ...` of a cell, empty if it is no polyhedron.
    pub(super) fn runs(&self) -> Vec<Vec<i64>> {
        let (faces, cells) = self.to_lists();
        cells
            .iter()
            .map(|cell| {
                if cell.is_empty() {
                    return Vec::new();
                }
                let mut run = vec![cell.len() as i64];
                for &face in cell {
                    let points = faces.cell(face as usize);
                    run.push(points.len() as i64);
                    run.extend_from_slice(points);
                }
                run
            })
            .collect()
    }
}

/// The faces in a run that [`is_face_run`] accepts.
pub(super) fn faces_of_run(run: &[i64]) -> impl Iterator<Item = &[i64]> {
    let mut rest = run.get(1..).unwrap_or_default();
    std::iter::from_fn(move || {
        let (&length, tail) = rest.split_first()?;
        let (face, tail) = tail.split_at_checked(usize::try_from(length).ok()?)?;
        rest = tail;
        Some(face)
    })
}
