//! New places for the points of a data set.

use super::array::{ArrayData, DataArray};
use super::dataset::{DataSet, Geometry};

/// Moves the points of a data set; 32-bit coordinates stay 32-bit ones, everything else becomes 64-bit.
///
/// # Arguments
/// * `positions`: a place for every point.
///
/// # Errors
/// What was found and what was expected, in words: another number of places, or a grid whose points are not listed one by one.
pub fn set_positions(dataset: &mut DataSet, positions: &[[f64; 3]]) -> Result<(), String> {
    if positions.len() != dataset.point_count() {
        return Err(format!("found {} places; expected one for each of {} points", positions.len(), dataset.point_count()));
    }
    let name = dataset.geometry.name();
    match &mut dataset.geometry {
        Geometry::PolyData { points, .. } | Geometry::UnstructuredGrid { points, .. } | Geometry::StructuredGrid { points, .. } => {
            let numbers = positions.iter().flatten();
            let data = match points.data {
                ArrayData::F32(_) => ArrayData::F32(numbers.map(|&number| number as f32).collect()),
                _ => ArrayData::F64(numbers.copied().collect()),
            };
            *points = DataArray { data, components: 3, ..points.clone() };
            Ok(())
        }
        Geometry::ImageData { .. } | Geometry::RectilinearGrid { .. } => {
            Err(format!("found {name}, whose points cannot move one by one; expected a mesh (morsmooth convert makes one: .vtu)"))
        }
    }
}
