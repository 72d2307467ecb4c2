//! Numbers of points and cells of a Freudenthal lattice.

use super::stencil::{Place, Stencil, stencil};
use super::triangulation::{Cell, Corners};
use crate::field::VertexId;

/// The Freudenthal (Kuhn) subdivision of a lattice of points: every cell an anchor and a type, nothing stored but sizes.
///
/// Axes with a single point do not count; the others are numbered 0, 1, 2 in their order. Point (i, j, k) has number
/// `i + n0 (j + n1 k)`, and an edge leads from it to every point that lies one step further on some of the axes. A cell
/// with lowest vertex `a` and type `t` of `T` has number `a T + t`; there are 1, 3, 7 types of edges in dimension 1, 2, 3,
/// 2 and 12 of triangles, 6 of tetrahedra. Numbers of cells that would leave the lattice are gaps.
#[derive(Debug, Clone, Copy)]
pub struct FreudenthalLattice {
    dimension: usize,
    sizes: [u32; 3],
    /// By set of axes: the difference of the numbers of two points that lie a step along all of them apart.
    steps: [u32; 8],
    stencil: &'static Stencil,
}

impl PartialEq for FreudenthalLattice {
    fn eq(&self, other: &Self) -> bool {
        self.sizes == other.sizes
    }
}

impl Eq for FreudenthalLattice {}

impl FreudenthalLattice {
    /// The lattice with these numbers of points; at least one axis has two, all products fit into 32 bits.
    pub(super) fn new(points: [usize; 3]) -> Self {
        let mut sizes = [1; 3];
        let axes = points.iter().filter(|&&count| count > 1);
        for (size, &count) in sizes.iter_mut().zip(axes.clone()) {
            *size = count as u32;
        }
        let strides = [1, sizes[0], sizes[0] * sizes[1]];
        let mut steps = [0; 8];
        let dimension = axes.count();
        for (set, step) in steps.iter_mut().enumerate().take(1 << dimension) {
            *step = (0..dimension).filter(|axis| set >> axis & 1 == 1).map(|axis| strides[axis]).sum();
        }
        Self { dimension, sizes, steps, stencil: stencil(dimension) }
    }

    /// Number of axes with more than one point: 1, 2 or 3.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Points along each axis, 1 beyond the dimension.
    pub fn sizes(&self) -> [u32; 3] {
        self.sizes
    }

    /// Number of points.
    pub fn vertex_count(&self) -> usize {
        self.sizes.iter().map(|&size| size as usize).product()
    }

    /// By set of axes (bit `a` for axis `a`): how far apart the numbers of two points are that lie a step along all of
    /// them apart. 0 for sets with axes beyond the dimension.
    pub fn steps(&self) -> [u32; 8] {
        self.steps
    }

    /// Number of types of cells of a dimension; 0 above that of the lattice.
    pub fn kinds(&self, dimension: usize) -> usize {
        kinds(self.dimension, dimension) as usize
    }

    /// The steps of the axes from the lowest vertex of a cell of some type to its others, as sets; padded with 0.
    pub fn chain(&self, dimension: usize, kind: usize) -> [u8; 3] {
        self.stencil.chains[dimension][kind]
    }

    /// Lowest vertex and type of a cell.
    pub fn anchor(&self, cell: Cell) -> (VertexId, usize) {
        let split = |kinds: u32| (VertexId(cell.index / kinds), (cell.index % kinds) as usize);
        // Division by a constant is a multiplication.
        match kinds(self.dimension, cell.dimension.into()) {
            1 => (VertexId(cell.index), 0),
            2 => split(2),
            3 => split(3),
            6 => split(6),
            7 => split(7),
            _ => split(12),
        }
    }

    /// The cell with a lowest vertex and type, in the lattice or not.
    pub fn cell(&self, dimension: usize, anchor: VertexId, kind: usize) -> Cell {
        Cell { dimension: dimension as u8, index: anchor.0 * kinds(self.dimension, dimension) + kind as u32 }
    }

    /// Place of a point along each axis.
    pub fn coordinates(&self, vertex: VertexId) -> [u32; 3] {
        let [width, height, _] = self.sizes;
        match self.dimension {
            1 => [vertex.0, 0, 0],
            2 => [vertex.0 % width, vertex.0 / width, 0],
            _ => {
                let row = vertex.0 / width;
                [vertex.0 % width, row % height, row / height]
            }
        }
    }

    /// The rims on which a point lies: bit `a` for the first point of axis `a`, bit `3 + a` for the last.
    pub fn rims(&self, vertex: VertexId) -> u8 {
        let coordinates = self.coordinates(vertex);
        let mut rims = 0;
        for (axis, (&place, &size)) in coordinates.iter().zip(&self.sizes).enumerate().take(self.dimension) {
            rims |= u8::from(place == 0) << axis | u8::from(place + 1 == size) << (3 + axis);
        }
        rims
    }

    /// The cell that is the facet of another with this place among its facets.
    pub fn facet(&self, cell: Cell, place: usize) -> Cell {
        let (anchor, kind) = self.anchor(cell);
        self.at(anchor, &self.stencil.facets[cell.dimension as usize][kind][place])
    }

    /// The cell that has this place among the cofacets of another, counted with those that leave the lattice.
    pub fn cofacet(&self, cell: Cell, place: usize) -> Cell {
        let (anchor, kind) = self.anchor(cell);
        self.at(anchor, &self.stencil.cofacets[cell.dimension as usize][kind][place])
    }

    /// Places among the cofacets of a cell at which there is one in the lattice.
    pub fn cofacet_places(&self, cell: Cell) -> impl Iterator<Item = usize> {
        let (anchor, kind) = self.anchor(cell);
        let rims = self.rims(anchor);
        let places = self.stencil.cofacets[cell.dimension as usize][kind].iter().enumerate();
        places.filter(move |(_, place)| place.not_at & rims == 0).map(|(place, _)| place)
    }

    pub(super) fn at(&self, point: VertexId, place: &Place) -> Cell {
        let anchor = point.0 - self.steps[place.back as usize] + self.steps[place.forward as usize];
        self.cell(place.dimension.into(), VertexId(anchor), place.kind.into())
    }

    pub(super) fn stencil(&self) -> &'static Stencil {
        self.stencil
    }

    /// The steps of a cell along all axes in which it extends.
    pub(super) fn extent(&self, dimension: usize, kind: usize) -> u8 {
        if dimension == 0 { 0 } else { self.stencil.chains[dimension][kind][dimension - 1] }
    }

    pub(super) fn corners(&self, cell: Cell) -> Corners {
        let (anchor, kind) = self.anchor(cell);
        let chain = self.stencil.chains[cell.dimension as usize][kind];
        let [a, b, c] = chain.map(|step| VertexId(anchor.0 + self.steps[step as usize]));
        Corners::rising([anchor, a, b, c], cell.dimension as usize + 1)
    }
}

const fn kinds(lattice: usize, cell: usize) -> u32 {
    const KINDS: [[u32; 4]; 4] = [[1, 0, 0, 0], [1, 1, 0, 0], [1, 3, 2, 0], [1, 7, 12, 6]];
    if cell > 3 { 0 } else { KINDS[lattice][cell] }
}
