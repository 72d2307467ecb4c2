//! Subdivision of one cell into simplices, so that neighbouring cells agree on their common faces.
//!
//! A volume cell is *pulled* at its smallest point number: it becomes the cone from that point over the faces that do
//! not contain it, and every quadrilateral face is cut at its own smallest point number. A face looks the same from
//! both sides, so the tetrahedra of neighbours conform, whatever the shapes.
//!
//! Literature: Dompierre, Labbé, Vallet, Camarero 1999, *How to subdivide pyramids, prisms and hexahedra into
//! tetrahedra* (the rule for the faces; the pulling here gives six tetrahedra where theirs saves one); De Loera, Rambau,
//! Santos 2010, *Triangulations* (pulling).

use super::measure::{cross, dot, minus};
use super::polygon::{Outline, triangulate};
use super::CellShape;

/// What is to be said about a cell that was cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Remarks {
    /// A simplex was left out since it names a point twice, or the cell has too few corners.
    pub collapsed: bool,
    /// The outline crosses itself.
    pub tangled: bool,
}

const HEXAHEDRON: [&[usize]; 6] = [&[0, 1, 2, 3], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];
const VOXEL: [&[usize]; 6] = [&[0, 1, 3, 2], &[4, 5, 7, 6], &[0, 1, 5, 4], &[1, 3, 7, 5], &[3, 2, 6, 7], &[2, 0, 4, 6]];
const WEDGE: [&[usize]; 5] = [&[0, 1, 2], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]];
const PYRAMID: [&[usize]; 5] = [&[0, 1, 2, 3], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]];

/// Appends the simplices of highest dimension of a cell to `simplices`, flat.
///
/// Triangles run round as the cell does; tetrahedra cut from other volume cells have positive volume where the cell is
/// convex, since files number wedges both ways. Shapes of dimension 0 and unknown ones give nothing.
///
/// # Arguments
/// * `corners`: as many as the shape has, all below the number of `points`.
pub(super) fn subdivide(shape: CellShape, corners: &[u32], points: &[[f64; 3]], simplices: &mut Vec<u32>) -> Remarks {
    let mut remarks = Remarks::default();
    match shape {
        CellShape::Vertex | CellShape::PolyVertex | CellShape::Other(_) => {}
        CellShape::Line | CellShape::PolyLine => {
            remarks.collapsed |= corners.len() < 2;
            for ends in corners.windows(2) {
                remarks.collapsed |= !push_distinct(simplices, ends);
            }
        }
        CellShape::TriangleStrip => {
            remarks.collapsed |= corners.len() < 3;
            for (position, triple) in corners.windows(3).enumerate() {
                let [a, b, c] = [triple[0], triple[1], triple[2]];
                let turned = if position % 2 == 0 { [a, b, c] } else { [b, a, c] };
                remarks.collapsed |= !push_distinct(simplices, &turned);
            }
        }
        CellShape::Triangle | CellShape::Tetrahedron => remarks.collapsed |= !push_distinct(simplices, corners),
        CellShape::Polygon | CellShape::Quad => cut_polygon(corners, points, simplices, &mut remarks),
        CellShape::Pixel => {
            let outline = [corners[0], corners[1], corners[3], corners[2]];
            cut_polygon(&outline, points, simplices, &mut remarks);
        }
        CellShape::Voxel => pull(&VOXEL, corners, points, simplices, &mut remarks),
        CellShape::Hexahedron => pull(&HEXAHEDRON, corners, points, simplices, &mut remarks),
        CellShape::Wedge => pull(&WEDGE, corners, points, simplices, &mut remarks),
        CellShape::Pyramid => pull(&PYRAMID, corners, points, simplices, &mut remarks),
    }
    remarks
}

fn push_distinct(simplices: &mut Vec<u32>, corners: &[u32]) -> bool {
    let distinct = corners.iter().enumerate().all(|(position, corner)| !corners[..position].contains(corner));
    if distinct {
        simplices.extend_from_slice(corners);
    }
    distinct
}

fn cut_polygon(outline: &[u32], points: &[[f64; 3]], simplices: &mut Vec<u32>, remarks: &mut Remarks) {
    let stutters = outline.iter().zip(outline.iter().cycle().skip(1)).any(|(a, b)| a == b);
    let without_stutter;
    let mut outline = outline;
    if stutters || outline.len() < 3 {
        remarks.collapsed = true;
        let mut kept = outline.to_vec();
        kept.dedup();
        while kept.len() > 1 && kept.first() == kept.last() {
            kept.pop();
        }
        without_stutter = kept;
        outline = &without_stutter;
    }
    if outline.len() < 3 {
        return;
    }
    let mut complete = true;
    let result = triangulate(outline, points, |triangle| complete &= push_distinct(simplices, &triangle));
    remarks.collapsed |= !complete;
    remarks.tangled |= result == Outline::Tangled;
}

/// The cone from the smallest corner over the faces that do not contain it.
fn pull(faces: &[&[usize]], corners: &[u32], points: &[[f64; 3]], simplices: &mut Vec<u32>, remarks: &mut Remarks) {
    let apex = corners.iter().copied().min().unwrap_or(0);
    let mut cone = |a: usize, b: usize, c: usize| {
        let mut tetrahedron = [apex, corners[a], corners[b], corners[c]];
        if is_turned(tetrahedron, points) {
            tetrahedron.swap(2, 3);
        }
        remarks.collapsed |= !push_distinct(simplices, &tetrahedron);
    };
    for face in faces {
        if face.iter().any(|&corner| corners[corner] == apex) {
            continue;
        }
        let count = face.len();
        let start = (0..count).min_by_key(|&position| corners[face[position]]).unwrap_or(0);
        for step in 1..count - 1 {
            cone(face[start], face[(start + step) % count], face[(start + step + 1) % count]);
        }
    }
}

fn is_turned(tetrahedron: [u32; 4], points: &[[f64; 3]]) -> bool {
    let [a, b, c, d] = tetrahedron.map(|corner| points[corner as usize]);
    dot(cross(minus(b, a), minus(c, a)), minus(d, a)) < 0.0
}
