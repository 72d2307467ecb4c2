//! The Morse–Smale complex as a picture shows it: critical points, lines between them, regions of the vertices.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::{Cell, Triangulation};

use super::ascent::{self, Summit};
use super::gradient::DiscreteGradient;
use super::hierarchy::MorseHierarchy;
use super::segmentation::{MorseSmaleSegmentation, Segmentation};
use super::star::{cofacets, key, on_boundary};
use super::v_paths::{path_down, separatrices_below};

/// A critical cell, or a maximum on the boundary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CriticalPoint {
    /// The critical cell. For a maximum on the boundary, which has none, the highest top cell at it.
    pub cell: Cell,
    /// The highest vertex of the cell: the extremum, or the saddle as a vertex.
    pub vertex: VertexId,
    /// Whether that vertex lies on the boundary of the domain.
    pub is_on_boundary: bool,
    /// Number of vertices in the basin of an extremum; 0 for a saddle.
    pub region_size: usize,
}

/// Which critical points a line connects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LineKind {
    /// From an edge down to a minimum.
    Descending,
    /// From a facet of the top cells up to a maximum.
    Ascending,
    /// From a 1-saddle up to a 2-saddle, in dimension 3.
    Connector,
}

/// A 1-separatrix: one V-path from a saddle to another critical point.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SeparatrixLine {
    /// What it connects.
    pub kind: LineKind,
    /// Place of the saddle in [`MorseSmaleComplex::points`]; of a connector, the 1-saddle.
    pub source: usize,
    /// Place of the other end.
    pub destination: usize,
    /// The cells of the V-path, both ends included.
    pub cells: Vec<Cell>,
}

/// The Morse–Smale complex of a field, simplified as far as the hierarchy is from which it is taken.
///
/// Where an ascending V-path leaves the domain through its boundary, the line goes on from the highest vertex of that
/// facet along the V-path of vertices and edges of `-h` to a maximum. So a maximum on the boundary, which has no critical
/// cell, is a point, a region and, mostly, an end of lines. The critical cells alone, without these maxima, alternate to
/// the Euler characteristic.
#[derive(Debug, Clone, PartialEq)]
pub struct MorseSmaleComplex {
    /// By dimension; minima by rising vertex, saddles by rising cell, maxima by rising vertex. The `k`-th minimum
    /// (maximum) has label `k` in [`minima`](Self::minima) ([`maxima`](Self::maxima)). Critical top cells that are no
    /// maxima, as non-manifold meshes have them, come last.
    pub points: Vec<CriticalPoint>,
    /// Number of points of each dimension.
    pub counts: [usize; 4],
    /// How many of the points of top dimension are maxima on the boundary, without a critical cell.
    pub boundary_maxima: usize,
    /// Descending lines by source, then ascending ones, then connectors.
    pub lines: Vec<SeparatrixLine>,
    /// Pairs of a 1-saddle and a 2-saddle with more than two V-paths between them, for which no line is listed.
    pub tangled: usize,
    /// Every vertex with its minimum: ascending manifolds.
    pub minima: Segmentation,
    /// Every vertex with its maximum: descending manifolds.
    pub maxima: Segmentation,
    /// Every vertex with both.
    pub regions: MorseSmaleSegmentation,
}

impl MorseSmaleComplex {
    /// Lists critical points, lines and regions.
    ///
    /// # Cost
    /// Linear in the cells and in the lengths of all lines; in dimension 3 also in the cells that V-paths from each 2-saddle
    /// down reach, summed over the 2-saddles. Parallel; the result does not depend on the number of threads.
    pub fn new<T: Triangulation>(hierarchy: &MorseHierarchy<'_, T>) -> Self {
        let (complex, gradient) = (hierarchy.complex(), hierarchy.gradient());
        let (minima, maxima) = (hierarchy.minimum_segmentation(), hierarchy.maximum_segmentation());
        let Points { points, counts, boundary_maxima } = Points::new(hierarchy, &minima, &maxima);
        let tracer = Tracer {
            complex,
            gradient,
            order: hierarchy.order(),
            uphill: hierarchy.maximum_successors(),
            place: points.iter().enumerate().map(|(place, point)| (point.cell, place)).collect(),
            first_maximum: points.len() - counts[complex.dimension()],
            maxima: &maxima,
        };
        let (lines, tangled) = tracer.lines(&points, counts);
        let regions = MorseSmaleSegmentation::new(&minima, &maxima);
        Self { points, counts, boundary_maxima, lines, tangled, minima, maxima, regions }
    }
}

struct Points {
    points: Vec<CriticalPoint>,
    counts: [usize; 4],
    boundary_maxima: usize,
}

impl Points {
    fn new<T: Triangulation>(hierarchy: &MorseHierarchy<'_, T>, minima: &Segmentation, maxima: &Segmentation) -> Self {
        let (complex, gradient, order) = (hierarchy.complex(), hierarchy.gradient(), hierarchy.order());
        let dimension = complex.dimension();
        let rim = on_boundary(complex);
        let point = |cell: Cell, vertex: VertexId, region_size| CriticalPoint {
            cell,
            vertex,
            is_on_boundary: rim[vertex.index()],
            region_size,
        };
        let mut points: Vec<CriticalPoint> = minima
            .extrema()
            .iter()
            .zip(minima.sizes())
            .map(|(&vertex, size)| point(Cell::vertex(vertex), vertex, size))
            .collect();
        let mut counts = [points.len(), 0, 0, 0];
        for (saddle, count) in (1..dimension).zip(&mut counts[1..]) {
            let before = points.len();
            points.extend(gradient.critical_cells(saddle).map(|cell| point(cell, cell.highest_vertex(complex, order), 0)));
            *count = points.len() - before;
        }
        let mut tops: BTreeMap<(VertexId, Cell), bool> =
            gradient.critical_cells(dimension).map(|cell| ((cell.highest_vertex(complex, order), cell), false)).collect();
        let before = points.len();
        let mut boundary_maxima = 0;
        for (&vertex, size) in maxima.extrema().iter().zip(maxima.sizes()) {
            let first = Cell { dimension: dimension as u8, index: 0 };
            let own = tops.range_mut((vertex, first)..).next().filter(|(key, _)| key.0 == vertex);
            let cell = match own {
                Some((&(_, cell), used)) => {
                    *used = true;
                    cell
                }
                None => {
                    boundary_maxima += 1;
                    highest_top(complex, order, vertex)
                }
            };
            points.push(point(cell, vertex, size));
        }
        points.extend(tops.iter().filter(|&(_, &used)| !used).map(|(&(vertex, cell), _)| point(cell, vertex, 0)));
        counts[dimension] = points.len() - before;
        Self { points, counts, boundary_maxima }
    }
}

/// The highest top cell at a vertex, as the lower-star filtration compares them.
fn highest_top<T: Triangulation>(complex: &T, order: &VertexOrder, vertex: VertexId) -> Cell {
    let mut cells = vec![Cell::vertex(vertex)];
    let mut around = Vec::new();
    // Greedy is right: cells compare by their vertices from the highest on, and every face is one of a top cell.
    for _ in 0..complex.dimension() {
        let last = cells[cells.len() - 1];
        cofacets(complex, last, &mut around);
        cells.extend(around.iter().copied().max_by_key(|&cell| key(complex, order, cell)));
    }
    cells[cells.len() - 1]
}

/// Follows V-paths from saddles.
struct Tracer<'a, T> {
    complex: &'a T,
    gradient: &'a DiscreteGradient,
    order: &'a VertexOrder,
    /// The successor of every vertex on its V-path of `-h`.
    uphill: Vec<u32>,
    /// Place of every critical point.
    place: BTreeMap<Cell, usize>,
    first_maximum: usize,
    maxima: &'a Segmentation,
}

impl<T: Triangulation> Tracer<'_, T> {
    fn lines(&self, points: &[CriticalPoint], counts: [usize; 4]) -> (Vec<SeparatrixLine>, usize) {
        let dimension = self.complex.dimension();
        let of_dimension = |wanted: usize| {
            let begin: usize = counts[..wanted].iter().sum();
            begin..begin + counts[wanted]
        };
        let is_critical = |source: &usize| self.gradient.is_critical(points[*source].cell);
        let gather = |sources: std::ops::Range<usize>, trace: &(dyn Fn(usize) -> Vec<SeparatrixLine> + Sync)| {
            let traced: Vec<Vec<SeparatrixLine>> = sources.into_par_iter().filter(is_critical).map(trace).collect();
            traced.into_iter().flatten()
        };
        let mut lines: Vec<SeparatrixLine> =
            gather(of_dimension(1), &|source| self.descending(source, points[source].cell)).collect();
        if dimension > 1 {
            lines.extend(gather(of_dimension(dimension - 1), &|source| {
                self.ascending(source, points[source].cell, points)
            }));
        }
        let mut tangled = 0;
        if dimension == 3 {
            let connected: Vec<(Vec<SeparatrixLine>, usize)> = of_dimension(2)
                .into_par_iter()
                .map(|upper| self.connectors(upper, points[upper].cell))
                .collect();
            for (connectors, left_out) in connected {
                lines.extend(connectors);
                tangled += left_out;
            }
        }
        (lines, tangled)
    }

    fn descending(&self, source: usize, edge: Cell) -> Vec<SeparatrixLine> {
        let trace = |start: VertexId| {
            let mut cells = vec![edge];
            cells.extend(path_down(self.complex, self.gradient, start));
            let destination = *self.place.get(cells.last()?)?;
            Some(SeparatrixLine { kind: LineKind::Descending, source, destination, cells })
        };
        self.complex.cell_vertices(edge).into_iter().filter_map(trace).collect()
    }

    fn ascending(&self, source: usize, facet: Cell, points: &[CriticalPoint]) -> Vec<SeparatrixLine> {
        let mut around = Vec::new();
        cofacets(self.complex, facet, &mut around);
        let trace = |&top: &Cell| {
            let (mut cells, summit) = ascent::path(self.complex, self.gradient, facet, top);
            let destination = match summit {
                Summit::Critical(cell) => *self.place.get(&cell)?,
                Summit::Boundary(rim) => self.along_the_boundary(rim, points, &mut cells)?,
                Summit::Branching => return None,
            };
            Some(SeparatrixLine { kind: LineKind::Ascending, source, destination, cells })
        };
        around.iter().filter_map(trace).collect()
    }

    /// Goes on from a facet of the boundary to a maximum, over vertices and edges.
    fn along_the_boundary(&self, facet: Cell, points: &[CriticalPoint], cells: &mut Vec<Cell>) -> Option<usize> {
        let mut vertex = facet.highest_vertex(self.complex, self.order);
        cells.push(Cell::vertex(vertex));
        let destination = self.first_maximum + self.maxima.label(vertex)? as usize;
        loop {
            let next = VertexId(self.uphill[vertex.index()]);
            if next == vertex {
                break;
            }
            cells.extend(self.complex.cell_of(&[vertex, next]));
            cells.push(Cell::vertex(next));
            vertex = next;
        }
        cells.push(points[destination].cell);
        Some(destination)
    }

    /// Lines from 1-saddles up to a 2-saddle, and the number of 1-saddles with too many V-paths to list.
    fn connectors(&self, destination: usize, triangle: Cell) -> (Vec<SeparatrixLine>, usize) {
        let mut tangled = 0;
        let mut lines = Vec::new();
        for (edge, separatrix) in separatrices_below(self.complex, self.gradient, triangle) {
            if separatrix.multiplicity > 1 {
                tangled += 1;
            } else if let Some(&source) = self.place.get(&edge) {
                let cells = separatrix.cells.into_iter().rev().collect();
                lines.push(SeparatrixLine { kind: LineKind::Connector, source, destination, cells });
            }
        }
        (lines, tangled)
    }
}
