//! The explicit complex as a triangulation: incidences that its lists do not hold are looked up in sorted groups.

use super::triangulation::{Cell, Corners, Triangulation};
use super::{EdgeId, SimplicialComplex};
use crate::field::VertexId;

/// Corners of a tetrahedron without one, the last first.
const FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];

impl Triangulation for SimplicialComplex {
    fn dimension(&self) -> usize {
        self.dimension()
    }

    fn vertex_count(&self) -> usize {
        self.vertex_count()
    }

    fn cell_bound(&self, dimension: usize) -> usize {
        self.cell_count(dimension)
    }

    fn is_cell(&self, cell: Cell) -> bool {
        (cell.index as usize) < self.cell_count(cell.dimension.into())
    }

    fn cell_count(&self, dimension: usize) -> usize {
        match dimension {
            0 => self.vertex_count(),
            1 => self.edges().len(),
            2 => self.triangles().len(),
            3 if self.dimension() == 3 => self.simplex_count(),
            _ => 0,
        }
    }

    fn cell_vertices(&self, cell: Cell) -> Corners {
        let index = cell.index as usize;
        let none = VertexId(u32::MAX);
        match cell.dimension {
            0 => Corners::rising([VertexId(cell.index), none, none, none], 1),
            1 => {
                let [a, b] = self.edges()[index];
                Corners::rising([a, b, none, none], 2)
            }
            2 => {
                let [a, b, c] = self.triangles()[index];
                Corners::rising([a, b, c, none], 3)
            }
            _ => {
                let corners = self.simplex(index);
                Corners::sorted([0, 1, 2, 3].map(|corner| VertexId(corners[corner])), 4)
            }
        }
    }

    fn cell_of(&self, vertices: &[VertexId]) -> Option<Cell> {
        match *vertices {
            [vertex] if vertex.index() < self.vertex_count() => Some(Cell::vertex(vertex)),
            [a, b] => self.edge(a, b).map(Cell::edge),
            [a, b, c] => self.triangle([a, b, c]).map(Cell::triangle),
            [a, b, c, d] if self.dimension() == 3 => tops_with(self, a, &[b, c, d]).next(),
            _ => None,
        }
    }

    fn facets(&self, cell: Cell) -> impl Iterator<Item = Cell> {
        let mut facets = [None; 4];
        match (cell.dimension, &*self.cell_vertices(cell)) {
            (1, &[a, b]) => facets[..2].copy_from_slice(&[a, b].map(|vertex| Some(Cell::vertex(vertex)))),
            (2, &[a, b, c]) => {
                facets[..3].copy_from_slice(&[[a, b], [a, c], [b, c]].map(|[a, b]| self.edge(a, b).map(Cell::edge)));
            }
            (3, corners) => {
                facets = FACES.map(|face| self.triangle(face.map(|corner| corners[corner])).map(Cell::triangle));
            }
            _ => {}
        }
        facets.into_iter().flatten()
    }

    fn cofacets(&self, cell: Cell) -> impl Iterator<Item = Cell> {
        let corners = self.cell_vertices(cell);
        let edges: &[EdgeId] = if cell.dimension == 0 { self.incident_edges(corners[0]) } else { &[] };
        // Triangles on an edge come by rising number as their third vertex rises.
        let third: &[VertexId] = if cell.dimension == 1 { self.neighbours(corners[0]) } else { &[] };
        let triangles = third
            .iter()
            .filter(move |&&vertex| self.edge(corners[1], vertex).is_some())
            .filter_map(move |&vertex| self.triangle([corners[0], corners[1], vertex]));
        let is_face = cell.dimension == 2 && self.dimension() == 3;
        let tetrahedra = is_face.then(|| {
            let [a, b, c] = self.triangles()[cell.index as usize];
            self.star(a).iter().copied().filter(move |&top| {
                let corners = self.simplex(top as usize);
                corners.contains(&b.0) && corners.contains(&c.0)
            })
        });
        let tetrahedra = tetrahedra.into_iter().flatten().map(|index| Cell { dimension: 3, index });
        edges.iter().map(|&edge| Cell::edge(edge)).chain(triangles.map(Cell::triangle)).chain(tetrahedra)
    }

    fn star_cells(&self, vertex: VertexId) -> impl Iterator<Item = Cell> {
        let edges = self.incident_edges(vertex).iter().map(|&edge| Cell::edge(edge));
        let mut triangles = Vec::new();
        if self.dimension() > 1 {
            for &top in self.star(vertex) {
                let corners = self.simplex(top as usize);
                for (place, &a) in corners.iter().enumerate().filter(|&(_, &corner)| corner != vertex.0) {
                    let pairs = corners[place + 1..].iter().filter(|&&b| b != vertex.0);
                    triangles.extend(pairs.filter_map(|&b| self.triangle([vertex, VertexId(a), VertexId(b)])));
                }
            }
            triangles.sort_unstable();
            triangles.dedup();
        }
        let tops = if self.dimension() == 3 { self.star(vertex) } else { &[] };
        let tetrahedra = tops.iter().map(|&index| Cell { dimension: 3, index });
        std::iter::once(Cell::vertex(vertex)).chain(edges).chain(triangles.into_iter().map(Cell::triangle)).chain(tetrahedra)
    }

    fn neighbours(&self, vertex: VertexId) -> impl Iterator<Item = VertexId> {
        self.neighbours(vertex).iter().copied()
    }

    fn link_edges(&self, vertex: VertexId) -> impl Iterator<Item = [VertexId; 2]> {
        let stride = self.dimension() + 1;
        self.star(vertex).iter().flat_map(move |&top| {
            let corners = self.simplex(top as usize);
            let places = (0..stride).filter(move |&place| corners[place] != vertex.0);
            places.flat_map(move |place| {
                let later = corners[place + 1..].iter().filter(move |&&other| other != vertex.0);
                later.map(move |&other| [VertexId(corners[place]), VertexId(other)])
            })
        })
    }

    fn is_on_boundary(&self, cell: Cell) -> bool {
        let corners = self.cell_vertices(cell);
        let stride = self.dimension() + 1;
        let around = self.star(corners[0]);
        let holds = |top: u32, vertices: &[u32]| {
            let found = self.simplex(top as usize);
            vertices.iter().all(|vertex| found.contains(vertex))
        };
        let mut own = [0; 4];
        for (slot, corner) in own.iter_mut().zip(corners.iter()) {
            *slot = corner.0;
        }
        let own = &own[..corners.len()];
        around.iter().filter(|&&top| holds(top, own)).any(|&top| {
            let simplex = self.simplex(top as usize);
            (0..stride).filter(|&omitted| !own.contains(&simplex[omitted])).any(|omitted| {
                let mut facet = [simplex[0]; 4];
                facet[..stride].copy_from_slice(simplex);
                facet.swap(omitted, stride - 1);
                around.iter().filter(|&&other| holds(other, &facet[..stride - 1])).count() == 1
            })
        })
    }

    fn point(&self, vertex: VertexId) -> [f64; 3] {
        self.point(vertex)
    }
}

/// Top simplices of dimension 3 with a vertex and some others.
fn tops_with<'a>(
    complex: &'a SimplicialComplex,
    vertex: VertexId,
    others: &'a [VertexId],
) -> impl Iterator<Item = Cell> + 'a {
    let holds = |top: u32| others.iter().all(|other| complex.simplex(top as usize).contains(&other.0));
    let around = if vertex.index() < complex.vertex_count() { complex.star(vertex) } else { &[] };
    around.iter().copied().filter(move |&top| holds(top)).map(|index| Cell { dimension: 3, index })
}
