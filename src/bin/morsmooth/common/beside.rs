//! Data sets written beside their place: made to fit the format, with what it cannot hold, and read back to be judged.

use std::path::Path;

use morsmooth::io::{DataSet, GeometryKind, PendingFile, image_dataset, losses, read, reshape, write_temporary};
use morsmooth::mesh::Domain;

use crate::failure::Failure;

/// The data set as the kind of geometry that a file of this name holds.
pub fn fitting(dataset: DataSet, output: &Path) -> Result<DataSet, Failure> {
    let extension = output.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    match GeometryKind::of_extension(extension) {
        // Gmsh and Medit hold surfaces as well as volumes, and both come as unstructured grids.
        Some(kind) => reshape(dataset, kind).map_err(|error| Failure::file(output, error)),
        None => Ok(dataset),
    }
}

/// Writes a fitting data set beside `output`; also says what the format has no room for.
pub fn write_beside(output: &Path, dataset: &DataSet) -> Result<(PendingFile, Vec<String>), Failure> {
    let fail = |error: morsmooth::io::IoError| Failure::usage(error.to_string());
    let lost = losses(output, dataset).map_err(fail)?;
    Ok((write_temporary(output, dataset).map_err(fail)?, lost))
}

/// What is in the file now, in its own precision.
pub fn read_back(pending: &PendingFile) -> Result<DataSet, Failure> {
    read(pending.path()).map_err(|error| Failure::usage(format!("the file just written cannot be read back: {error}")))
}

/// Writes an image beside `output` and reads it back: nothing is kept but what is in the file.
///
/// # Arguments
/// * `pixels`: `width x height x 4` bytes, rows from the top.
pub fn write_image(output: &Path, (width, height): (u32, u32), pixels: &[u8]) -> Result<PendingFile, Failure> {
    let dataset = image_dataset(width, height, pixels);
    let pending = write_temporary(output, &dataset).map_err(|error| Failure::usage(error.to_string()))?;
    match read_back(&pending)?.point_data.arrays == dataset.point_data.arrays {
        true => Ok(pending),
        false => Err(Failure::file(output, "the image read back differs from the one written; expected the same pixels")),
    }
}

/// Places of all points, those of the domain moved; points of no element stay.
pub fn with_vertices(mut places: Vec<[f64; 3]>, domain: &Domain, vertices: &[[f64; 3]]) -> Vec<[f64; 3]> {
    for (&point, place) in domain.point_of_vertex().iter().zip(vertices) {
        places[point as usize] = *place;
    }
    places
}
