//! The link of an inner point of a Freudenthal lattice, as masks: what lower stars on a grid are processed with.

use std::sync::LazyLock;

use crate::field::VertexId;
use crate::mesh::{Cell, Grid, ImplicitGrid, Triangulation};

use super::partners::{down, up};

/// Room for the neighbours of a point, of which there are 14 at most.
pub(super) const SLOTS: usize = 16;

/// Triangles at a point of a 3-dimensional lattice.
const TRIANGLES: usize = 36;

/// How a cell of the star is stored as one half of a pair.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Codes {
    /// Number of the upper cell among the cells of its dimension in the star.
    pub upper: u8,
    /// What the lower cell keeps: the way up.
    pub up: u8,
    /// What the upper cell keeps: the way down.
    pub down: u8,
}

/// Neighbours are numbered by rising index, from 0; sets of them are masks. Cells of the star are named by their vertices
/// but for the point itself, and numbered in their dimension by rising number.
#[derive(Debug)]
pub(super) struct Link {
    /// Number of neighbours: 2, 6 or 14.
    pub slots: usize,
    /// Neighbours of each neighbour within the link.
    pub adjacent: [u16; SLOTS],
    /// By two adjacent neighbours: those adjacent to both, as faces of the link.
    pub thirds: [[u16; SLOTS]; SLOTS],
    /// The point with the edge to a neighbour.
    pub of_edge: [Codes; SLOTS],
    /// The edge to the first neighbour with the triangle of both.
    pub of_triangle: [[Codes; SLOTS]; SLOTS],
    /// By number of a triangle: that triangle with the tetrahedron of it and a third neighbour.
    pub of_tetrahedron: [[Codes; SLOTS]; TRIANGLES],
    /// By set of neighbours: the first one of each of its components.
    pub firsts: Vec<u16>,
    /// By dimension: steps back from the point to the anchor of each cell of the star, and its type.
    pub anchors: [Vec<(u8, u32)>; 4],
}

/// The link in lattices of dimension 1, 2 or 3.
pub(super) fn link(dimension: usize) -> &'static Link {
    static LINKS: LazyLock<[Link; 3]> = LazyLock::new(|| [1, 2, 3].map(|dimension| Link::new(dimension).unwrap_or_default()));
    &LINKS[dimension - 1]
}

impl Default for Link {
    fn default() -> Self {
        Self {
            slots: 0,
            adjacent: [0; SLOTS],
            thirds: [[0; SLOTS]; SLOTS],
            of_edge: [Codes::default(); SLOTS],
            of_triangle: [[Codes::default(); SLOTS]; SLOTS],
            of_tetrahedron: [[Codes::default(); SLOTS]; TRIANGLES],
            firsts: Vec::new(),
            anchors: Default::default(),
        }
    }
}

impl Link {
    /// Read off the middle of a grid so large that all cells beside those of its star are there.
    fn new(dimension: usize) -> Option<Self> {
        let mut sizes = [1; 3];
        sizes[..dimension].fill(5);
        let grid = ImplicitGrid::new(Grid::image(sizes, [0.0; 3], [1.0; 3])).ok()?;
        let lattice = grid.lattice()?;
        let point = VertexId::from(grid.vertex_count() / 2);
        let neighbours: Vec<VertexId> = grid.neighbours(point).collect();
        let mut link = Self { slots: neighbours.len(), ..Self::default() };
        let mut numbers: [Vec<Cell>; 4] = Default::default();
        for cell in grid.star_cells(point) {
            let (anchor, kind) = lattice.anchor(cell);
            let back = (0..8).find(|&set| lattice.steps()[set as usize] == point.0 - anchor.0)?;
            link.anchors[cell.dimension as usize].push((back, kind as u32));
            numbers[cell.dimension as usize].push(cell);
        }
        let slots_of = |cell: Cell| -> Vec<usize> {
            let others = grid.cell_vertices(cell).into_iter().filter(|&corner| corner != point);
            others.filter_map(|corner| neighbours.iter().position(|&neighbour| neighbour == corner)).collect()
        };
        let codes = |lower: Cell, upper: Cell| {
            let among = &numbers[upper.dimension as usize];
            let upper_number = among.iter().position(|&cell| cell == upper)?;
            let way_up = grid.cofacets(lower).position(|cell| cell == upper)?;
            let way_down = grid.facets(upper).position(|cell| cell == lower)?;
            Some(Codes { upper: upper_number as u8, up: up(way_up), down: down(way_down) })
        };
        for &edge in &numbers[1] {
            link.of_edge[slots_of(edge)[0]] = codes(Cell::vertex(point), edge)?;
        }
        for &triangle in &numbers[2] {
            let [a, b] = slots_of(triangle)[..] else { return None };
            for (from, to) in [(a, b), (b, a)] {
                link.adjacent[from] |= 1 << to;
                link.of_triangle[from][to] = codes(grid.cell_of(&[point, neighbours[from]])?, triangle)?;
            }
        }
        for &tetrahedron in &numbers[3] {
            let slots = slots_of(tetrahedron);
            for third in 0..3 {
                let (a, b) = (slots[(third + 1) % 3], slots[(third + 2) % 3]);
                link.thirds[a][b] |= 1 << slots[third];
                link.thirds[b][a] |= 1 << slots[third];
                let triangle = grid.cell_of(&[point, neighbours[a], neighbours[b]])?;
                let number = numbers[2].iter().position(|&cell| cell == triangle)?;
                link.of_tetrahedron[number][slots[third]] = codes(triangle, tetrahedron)?;
            }
        }
        link.firsts = (0..1 << link.slots).map(|set| link.firsts_of(set)).collect();
        Some(link)
    }

    fn firsts_of(&self, mut rest: u16) -> u16 {
        let mut firsts = 0;
        while rest != 0 {
            let mut component = rest & rest.wrapping_neg();
            firsts |= component;
            loop {
                let mut grown = component;
                for slot in (0..self.slots).filter(|slot| component >> slot & 1 == 1) {
                    grown |= self.adjacent[slot] & rest;
                }
                if grown == component {
                    break;
                }
                component = grown;
            }
            rest &= !component;
        }
        firsts
    }
}
