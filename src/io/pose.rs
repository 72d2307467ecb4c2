//! Poses from files: `.json`, and `.dmat` with a quaternion a bone as libigl's tutorial has it.

use std::path::Path;

use crate::mesh::{HandleSet, HandleShape, HandleTransform, Pose, Rotation, SimplicialComplex};

use super::dmat;
use super::error::{Fault, IoError, Place, quoted};
use super::json::{self, Coordinates, Entries};

/// Reads a pose.
///
/// * `.json`: `{"handles": {"head": {"rotation_degrees": 90, "axis": [0, 0, 1], "translation": [1, 0, 0], "scale": 1, "pivot": [0, 0, 0]}}}`. All
///   entries may be left out; `"quaternion": [w, x, y, z]` may take the place of `rotation_degrees` and `axis`. The axis is z unless
///   given, and then any number of turns counts. The pivot is [`HandleSet::pivot`] unless given. Handles that are not named stay where they are.
/// * `.dmat`: four numbers x, y, z, w a bone, in the order of the bones: the rotation of the bone against the one at whose tip it starts,
///   about its own root. Other handles stay where they are.
///
/// # Arguments
/// * `handles`: their names and, for `.dmat`, their bones; regions of them in vertices of `complex`.
///
/// # Returns
/// A transform a handle, in the order of the handles.
///
/// # Errors
/// [`IoError`] with line, or with the name of the handle.
///
/// # Cost
/// Linear in the size of the file, and O(h²).
pub fn read_pose(path: impl AsRef<Path>, handles: &HandleSet, complex: &SimplicialComplex) -> Result<Pose, IoError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| IoError::Read { path: path.to_owned(), source })?;
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_ascii_lowercase();
    let pose = match extension.as_str() {
        "json" => json::parse(&bytes).and_then(|file| of_entries(file, handles, complex)),
        "dmat" => dmat::read(&bytes).and_then(|matrix| of_matrix(&matrix, handles)),
        _ => Err(Fault::unsupported(Place::File, format!("a file .{extension}"), "a pose in a .json or .dmat file")),
    };
    pose.map_err(|fault| fault.in_file(path))
}

/// Reads the poses of a file of keys: `{"keys": [{"time": 0, "handles": {...}}, ...]}`, each with handles as in [`read_pose`].
///
/// # Returns
/// Times, rising, and poses.
///
/// # Errors
/// As [`read_pose`]; also for fewer than two keys, and for times that do not rise.
pub fn read_keys(path: impl AsRef<Path>, handles: &HandleSet, complex: &SimplicialComplex) -> Result<Vec<(f64, Pose)>, IoError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| IoError::Read { path: path.to_owned(), source })?;
    let keys = json::parse(&bytes).and_then(|file| of_keys(file, handles, complex));
    keys.map_err(|fault| fault.in_file(path))
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct PoseFile {
    handles: Entries<TransformEntry>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct KeyFile {
    keys: Vec<KeyEntry>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct KeyEntry {
    time: f64,
    handles: Entries<TransformEntry>,
}

#[derive(Debug, Clone, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct TransformEntry {
    rotation_degrees: Option<f64>,
    axis: Option<[f64; 3]>,
    quaternion: Option<[f64; 4]>,
    translation: Option<Coordinates>,
    scale: Option<f64>,
    pivot: Option<Coordinates>,
}

fn of_keys(file: KeyFile, handles: &HandleSet, complex: &SimplicialComplex) -> Result<Vec<(f64, Pose)>, Fault> {
    if file.keys.len() < 2 {
        return Err(Fault::new(Place::File, format!("{} keys", file.keys.len()), "at least two"));
    }
    let mut keys: Vec<(f64, Pose)> = Vec::with_capacity(file.keys.len());
    for KeyEntry { time, handles: entries } in file.keys {
        if let Some(&(before, _)) = keys.last()
            && time <= before
        {
            return Err(Fault::new(Place::File, format!("time {time} after time {before}"), "times that rise"));
        }
        keys.push((time, of_entries(PoseFile { handles: entries }, handles, complex)?));
    }
    Ok(keys)
}

fn of_entries(file: PoseFile, handles: &HandleSet, complex: &SimplicialComplex) -> Result<Pose, Fault> {
    let mut pose = Pose::rest(handles.len());
    for (name, entry) in file.handles.0 {
        let Some(place) = handles.handles.iter().position(|handle| handle.name == name) else {
            let known: Vec<String> = handles.handles.iter().map(|handle| quoted(&handle.name)).collect();
            return Err(Fault::new(Place::File, format!("a pose for {}", quoted(&name)), format!("one of the handles {}", known.join(", "))));
        };
        let pivot = match entry.pivot {
            Some(pivot) => pivot.0,
            None => handles.pivot(place, complex).map_err(|error| Fault::new(Place::File, error.to_string(), "a handle of this mesh"))?,
        };
        let fault = |found: String, expected: &str| Fault::new(Place::File, format!("{found} at handle {}", quoted(&name)), expected);
        let scale = entry.scale.unwrap_or(1.0);
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(fault(format!("scale {scale}"), "a positive number"));
        }
        let rotation = rotation(&entry).map_err(|(found, expected)| fault(found, expected))?;
        let translation = entry.translation.map_or([0.0; 3], |translation| translation.0);
        pose.transforms[place] = HandleTransform { rotation, translation, scale, pivot };
    }
    Ok(pose)
}

fn rotation(entry: &TransformEntry) -> Result<Rotation, (String, &'static str)> {
    match (entry.quaternion, entry.rotation_degrees, entry.axis) {
        (Some(parts), None, None) => {
            let length = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
            // Files have few digits; a length far from 1 is a mistake, perhaps in the order of the parts.
            match (length - 1.0).abs() <= 1e-3 {
                true => Ok(Rotation::Quaternion(parts.map(|part| part / length))),
                false => Err((format!("a quaternion of length {length:.4}"), "length 1")),
            }
        }
        (Some(_), _, _) => Err(("a quaternion and a rotation".into(), "one of them")),
        (None, Some(degrees), axis) => {
            let axis = axis.unwrap_or([0.0, 0.0, 1.0]);
            Rotation::about(axis, degrees.to_radians()).ok_or_else(|| (format!("the axis {axis:?}"), "an axis with a direction"))
        }
        (None, None, Some(_)) => Err(("an axis without \"rotation_degrees\"".into(), "both")),
        (None, None, None) => Ok(Rotation::IDENTITY),
    }
}

/// Rotations of bones against their parents, put together from the roots down.
fn of_matrix(matrix: &[f64], handles: &HandleSet) -> Result<Pose, Fault> {
    let bones: Vec<(usize, [[f64; 3]; 2])> = handles
        .handles
        .iter()
        .enumerate()
        .filter_map(|(place, handle)| if let HandleShape::Bone(ends) = handle.shape { Some((place, ends)) } else { None })
        .collect();
    if matrix.len() != 4 * bones.len() {
        return Err(Fault::new(Place::File, format!("{} numbers", matrix.len()), format!("4 for each of {} bones", bones.len())));
    }
    let mut pose = Pose::rest(handles.len());
    for (bone, &(place, ends)) in bones.iter().enumerate() {
        // From the bone up to the root of its skeleton; a circle of bones has none.
        let mut chain = vec![bone];
        let mut root = ends[0];
        while let Some(parent) = bones.iter().position(|(_, ends)| ends[1] == root) {
            if chain.contains(&parent) {
                let name = quoted(&handles.handles[place].name);
                return Err(Fault::new(Place::File, format!("a circle of bones above {name}"), "bones that start at a root"));
            }
            chain.push(parent);
            root = bones[parent].1[0];
        }
        let mut total = HandleTransform::REST;
        for &bone in chain.iter().rev() {
            let [x, y, z, w] = [0, 1, 2, 3].map(|part| matrix[4 * bone + part]);
            let local = Rotation::Quaternion([w, x, y, z]).quaternion();
            if !local.iter().all(|part| part.is_finite()) {
                return Err(Fault::new(Place::File, format!("the quaternion [{x}, {y}, {z}, {w}] of bone {}", bone + 1), "one that is not zero"));
            }
            let pivot = bones[bone].1[0];
            // The parent moves the root; the bone turns about it.
            let moved = total.apply(pivot);
            let translation = std::array::from_fn(|axis| moved[axis] - pivot[axis]);
            let rotation = Rotation::Quaternion(times(total.rotation.quaternion(), local));
            total = HandleTransform { rotation, translation, scale: 1.0, pivot };
        }
        pose.transforms[place] = total;
    }
    Ok(pose)
}

/// The Hamilton product: the rotation `second`, then `first`.
fn times([a, b, c, d]: [f64; 4], [e, f, g, h]: [f64; 4]) -> [f64; 4] {
    [
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    ]
}
