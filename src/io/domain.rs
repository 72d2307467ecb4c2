//! From a data set to the domain of a computation: which points and cells take part, and their shapes.

use crate::mesh::{CellList, CellShape, Domain, DomainError, Grid, GridGeometry, Mask};

use super::array::{ArrayData, DataArray};
use super::dataset::{Attributes, CellArray, DataSet, Extent, Geometry};

/// VTK's name of the array that marks ghosts and hidden parts.
const GHOST_TYPE: &str = "vtkGhostType";
/// Bit of `vtkGhostType` that hides a point.
const HIDDEN_POINT: u64 = 2;
/// Bit of `vtkGhostType` that hides a cell.
const HIDDEN_CELL: u64 = 32;

/// What decides which points and cells of a data set are in the domain. All sources count together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MaskSources {
    /// Name of a point array, of a cell array, or of both: 0 and NaN are outside, everything else is inside.
    pub array: Option<String>,
    /// Names of point arrays whose NaN values, in any component, are holes.
    pub holes: Vec<String>,
    /// Whether `vtkGhostType` counts: hidden points (bit 2) and hidden cells (bit 32) are outside. Duplicates (bit 1)
    /// stay inside, and so does everything that the older `vtkGhostLevels` marks, because it marks duplicates only.
    pub ghosts: bool,
}

impl Default for MaskSources {
    fn default() -> Self {
        Self { array: None, holes: Vec::new(), ghosts: true }
    }
}

/// Why a data set gives no mask or no domain.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DomainIoError {
    /// No array has the name that was asked for.
    #[error("found no {what} array \"{name}\"; expected one of: {}", known.join(", "))]
    NoArray {
        /// `point`, or `point or cell`.
        what: &'static str,
        /// The name asked for.
        name: String,
        /// The names that are there.
        known: Vec<String>,
    },
    /// The array cannot be a mask.
    #[error("found {components} components of type {value_type} in mask \"{name}\"; expected one number each")]
    NoMask {
        /// The array.
        name: String,
        /// Its components.
        components: usize,
        /// Its type, as in VTK XML.
        value_type: &'static str,
    },
    /// A cell is of a kind that cannot be subdivided into simplices.
    #[error(
        "found cell {cell} of VTK type {vtk_type} ({name}); expected linear cells (types 1 to 14): \
         linearise or tetrahedralise it, or mask it"
    )]
    UnsupportedCell {
        /// The cell.
        cell: usize,
        /// Its type.
        vtk_type: u8,
        /// What VTK calls the type.
        name: &'static str,
    },
    /// The data set is no domain for another reason.
    #[error(transparent)]
    Domain(DomainError),
}

impl From<DomainError> for DomainIoError {
    fn from(error: DomainError) -> Self {
        match error {
            DomainError::UnsupportedCell { cell, vtk_type } => {
                Self::UnsupportedCell { cell, vtk_type, name: cell_type_name(vtk_type) }
            }
            other => Self::Domain(other),
        }
    }
}

/// Flags for the points and cells of a data set.
///
/// # Errors
/// [`DomainIoError::NoArray`] and [`DomainIoError::NoMask`].
///
/// # Cost
/// O(points + cells) for the sources that are there; without any, nothing is allocated.
pub fn mask(dataset: &DataSet, sources: &MaskSources) -> Result<Mask, DomainIoError> {
    let mut mask = Mask::none();
    if let Some(name) = &sources.array {
        let (point, cell) = (dataset.point_array(name), dataset.cell_array(name));
        if point.is_none() && cell.is_none() {
            let known = names(&dataset.point_data).chain(names(&dataset.cell_data)).collect();
            return Err(DomainIoError::NoArray { what: "point or cell", name: name.clone(), known });
        }
        for (array, keep) in [(point, &mut mask.keep_points), (cell, &mut mask.keep_cells)] {
            if let Some(array) = array {
                let flags = flags(array)?;
                also(keep, &flags);
            }
        }
    }
    for name in &sources.holes {
        let Some(array) = dataset.point_array(name) else {
            return Err(DomainIoError::NoArray { what: "point", name: name.clone(), known: names(&dataset.point_data).collect() });
        };
        for component in 0..array.components {
            let values = array.to_f64(component);
            if values.iter().any(|value| value.is_nan()) {
                let whole: Vec<bool> = values.iter().map(|value| !value.is_nan()).collect();
                also(&mut mask.keep_points, &whole);
            }
        }
    }
    if sources.ghosts {
        for (attributes, bit, keep) in [
            (&dataset.point_data, HIDDEN_POINT, &mut mask.keep_points),
            (&dataset.cell_data, HIDDEN_CELL, &mut mask.keep_cells),
        ] {
            let Some(ArrayData::U8(kinds)) = attributes.array(GHOST_TYPE).map(|array| &array.data) else { continue };
            if kinds.iter().any(|&kind| u64::from(kind) & bit != 0) {
                let shown: Vec<bool> = kinds.iter().map(|&kind| u64::from(kind) & bit == 0).collect();
                also(keep, &shown);
            }
        }
    }
    Ok(mask)
}

/// Builds the domain of a data set.
///
/// Cells are numbered as VTK numbers them: in poly data vertices, lines, polygons, strips.
///
/// # Errors
/// [`DomainIoError::UnsupportedCell`] names the first kept cell that has no subdivision, [`DomainIoError::Domain`]
/// everything else that [`Domain::from_cells`] and [`Domain::from_grid`] refuse.
///
/// # Cost
/// That of building the domain, and 24 bytes a point and 4 a corner on the way.
///
/// # Example
/// ```
/// use morsmooth::io::{DataSet, Extent, Geometry, domain, mask, MaskSources};
/// let image = DataSet::new(Geometry::ImageData {
///     extent: Extent([0, 2, 0, 1, 0, 0]),
///     origin: [0.0; 3],
///     spacing: [1.0; 3],
///     direction: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
/// });
/// let domain = domain(&image, &mask(&image, &MaskSources::default())?)?;
/// assert_eq!(domain.complex.simplex_count(), 4);
/// # Ok::<(), morsmooth::io::DomainIoError>(())
/// ```
pub fn domain(dataset: &DataSet, mask: &Mask) -> Result<Domain, DomainIoError> {
    if let Some(grid) = grid(dataset) {
        return Ok(Domain::from_grid(&grid, mask)?);
    }
    let mut list = CellList::new();
    match &dataset.geometry {
        Geometry::PolyData { verts, lines, polys, strips, .. } => {
            append(&mut list, verts, |_, _| CellShape::PolyVertex);
            append(&mut list, lines, |_, _| CellShape::PolyLine);
            append(&mut list, polys, |_, corners| match corners {
                3 => CellShape::Triangle,
                4 => CellShape::Quad,
                _ => CellShape::Polygon,
            });
            append(&mut list, strips, |_, _| CellShape::TriangleStrip);
        }
        Geometry::UnstructuredGrid { cells, types, .. } => {
            append(&mut list, cells, |cell, _| CellShape::from_vtk(types.get(cell).copied().unwrap_or(0)));
        }
        Geometry::ImageData { .. } | Geometry::RectilinearGrid { .. } | Geometry::StructuredGrid { .. } => {}
    }
    Ok(Domain::from_cells(&dataset.points_f64(), &list, mask)?)
}

/// The grid of a structured data set; `None` for cells listed one by one.
///
/// # Cost
/// Constant for an image; 8 bytes a coordinate of a rectilinear grid, 24 bytes a point of a curvilinear one.
pub fn grid(dataset: &DataSet) -> Option<Grid> {
    let (dims, geometry) = match &dataset.geometry {
        Geometry::ImageData { extent, origin, spacing, direction } => {
            let dims = extent.dimensions();
            // All empty extents are the same.
            let first_last = if dims[0] == 0 { Extent([0, -1, 0, -1, 0, -1]) } else { *extent };
            let extent = first_last.0.map(i64::from);
            (dims, GridGeometry::Image { origin: *origin, spacing: *spacing, direction: *direction, extent })
        }
        Geometry::RectilinearGrid { extent, coordinates } => {
            let [x, y, z] = [0, 1, 2].map(|axis| coordinates[axis].to_f64(0));
            (extent.dimensions(), GridGeometry::Rectilinear { x, y, z })
        }
        Geometry::StructuredGrid { extent, .. } => {
            (extent.dimensions(), GridGeometry::Curvilinear { points: dataset.points_f64() })
        }
        Geometry::PolyData { .. } | Geometry::UnstructuredGrid { .. } => return None,
    };
    Some(Grid { dims, geometry })
}

/// Adds cells; numbers that do not fit into 32 bits become one that is out of range, which the domain refuses.
fn append(list: &mut CellList, cells: &CellArray, shape: impl Fn(usize, usize) -> CellShape) {
    list.shapes.reserve(cells.len());
    list.offsets.reserve(cells.len());
    list.connectivity.reserve(cells.connectivity.len());
    let mut corners = Vec::new();
    for (number, cell) in cells.iter().enumerate() {
        corners.clear();
        corners.extend(cell.iter().map(|&point| u32::try_from(point).unwrap_or(u32::MAX)));
        list.push(shape(number, cell.len()), &corners);
    }
}

fn names(attributes: &Attributes) -> impl Iterator<Item = String> {
    attributes.arrays.iter().map(|array| array.name.clone())
}

fn flags(array: &DataArray) -> Result<Vec<bool>, DomainIoError> {
    if array.components != 1 || matches!(array.data, ArrayData::String(_)) {
        return Err(DomainIoError::NoMask {
            name: array.name.clone(),
            components: array.components,
            value_type: array.data.value_type().xml_name(),
        });
    }
    Ok(array.to_f64(0).iter().map(|&value| value != 0.0 && !value.is_nan()).collect())
}

/// Keeps what was kept before and is kept now.
fn also(keep: &mut Option<Vec<bool>>, flags: &[bool]) {
    match keep {
        None => *keep = Some(flags.to_vec()),
        Some(keep) => keep.iter_mut().zip(flags).for_each(|(keep, &flag)| *keep &= flag),
    }
}

/// VTK's names of the cell types beyond the linear ones.
fn cell_type_name(vtk_type: u8) -> &'static str {
    match vtk_type {
        15 => "pentagonal prism",
        16 => "hexagonal prism",
        21 => "quadratic edge",
        22 => "quadratic triangle",
        23 => "quadratic quad",
        24 => "quadratic tetrahedron",
        25 => "quadratic hexahedron",
        26 => "quadratic wedge",
        27 => "quadratic pyramid",
        28 => "biquadratic quad",
        29 => "triquadratic hexahedron",
        30 => "quadratic linear quad",
        31 => "quadratic linear wedge",
        32 => "biquadratic quadratic wedge",
        33 => "biquadratic quadratic hexahedron",
        34 => "biquadratic triangle",
        35 => "cubic line",
        36 => "quadratic polygon",
        37 => "triquadratic pyramid",
        41 => "convex point set",
        42 => "polyhedron",
        68..=74 => "Lagrange cell",
        75..=81 => "Bezier cell",
        _ => "unknown",
    }
}
