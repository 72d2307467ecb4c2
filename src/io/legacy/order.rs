//! Higher-order hexahedra, whose points changed their order between versions of the formats.

use crate::io::dataset::Geometry;

/// The version of the XML format from which points stand as in legacy files from 5.1 on.
pub(super) const POINTS_MOVED: [u32; 2] = [2, 1];

/// VTK's numbers for the Lagrange and the Bézier hexahedron.
const MOVED: [u8; 2] = [72, 79];

/// Whether the version of a file says where points of its cells stand.
pub(super) fn has_moved_points(geometry: &Geometry) -> bool {
    matches!(geometry, Geometry::UnstructuredGrid { types, .. } if types.iter().any(|kind| MOVED.contains(kind)))
}
