//! The discrete gradient: every cell of a complex paired with a facet, with a cofacet, or critical.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::{Cell, EdgeId, SimplicialComplex};

use super::error::MorseError;
use super::lower_star::LowerStar;

/// What a discrete gradient does with a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pairing {
    /// Paired with nothing.
    Critical,
    /// Paired with this cofacet: the arrow leaves the cell.
    Up(Cell),
    /// Paired with this facet: the arrow ends in the cell.
    Down(Cell),
    /// A vertex of no simplex, which is no part of the pure complex.
    Outside,
}

const CRITICAL: u32 = u32::MAX;
const OUTSIDE: u32 = u32::MAX - 1;
const DOWN: u32 = 1 << 31;
const LIMIT: usize = (DOWN - 2) as usize;

/// A discrete gradient field of a vertex order (Forman 1998), on vertices, edges, triangles and tetrahedra.
///
/// Every pair lies in one lower star, so along every V-path the highest vertex of the cells never rises. This no
/// longer holds where [`cancel`](Self::cancel) has reversed a V-path; that there is no closed V-path still does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DiscreteGradient {
    dimension: usize,
    /// By dimension and cell: the partner, with the bit `DOWN` if it is a facet; or `CRITICAL`; or `OUTSIDE`.
    partners: [Vec<u32>; 4],
}

/// Pairs the cells of every lower star; the cells left over are critical.
///
/// On a 2-complex the critical cells of dimension 0, 1, 2 are minima, saddles and maxima, but for maxima on the
/// boundary: they are seen only by the gradient of the reversed order, as its critical vertices.
///
/// # Arguments
/// * `complex`: `n` vertices, dimension 1, 2 or 3. Vertices without neighbours are left out.
/// * `order`: total order of the `n` vertices; ties were broken by index.
///
/// # Errors
/// [`MorseError::OrderLength`] if `order` does not cover `n` vertices; [`MorseError::TooManyCells`] from 2^31 cells
/// of one dimension on.
///
/// # Cost
/// O(s log s) for a lower star of s cells; 4 bytes a cell kept, 8 more a triangle or tetrahedron while it runs. Lower
/// stars run in parallel; each cell is in one of them, so the result does not depend on the number of threads.
///
/// # Source
/// Robins, Wood, Sheppard 2011, algorithm *ProcessLowerStars*.
///
/// # Example
/// ```
/// use morsmooth::field::VertexOrder;
/// use morsmooth::mesh::SimplicialComplex;
/// use morsmooth::morse::discrete_gradient;
/// let line = SimplicialComplex::new(1, vec![[0.0; 3]; 4], vec![0, 1, 1, 2, 2, 3])?;
/// let gradient = discrete_gradient(&line, &VertexOrder::of_values(&[0.0, 3.0, 1.0, 2.0])?)?;
/// assert_eq!(gradient.critical_counts(), [2, 1, 0, 0]); // two minima, one edge between their basins
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn discrete_gradient(complex: &SimplicialComplex, order: &VertexOrder) -> Result<DiscreteGradient, MorseError> {
    let vertices = complex.vertex_count();
    if order.len() != vertices {
        return Err(MorseError::OrderLength { expected: vertices, found: order.len() });
    }
    let counts = cell_counts(complex);
    if let Some(dimension) = counts.iter().position(|&count| count > LIMIT) {
        return Err(MorseError::TooManyCells { dimension, found: counts[dimension], limit: LIMIT });
    }
    let triangles = Owned::new(order, complex.triangles().len(), |triangle| {
        complex.triangles()[triangle].into_iter().map(|vertex| vertex.0)
    });
    let tetrahedra = Owned::new(order, counts[3], |simplex| complex.simplex(simplex).iter().copied());
    let partners = counts.map(|count| (0..count).map(|_| AtomicU32::new(CRITICAL)).collect::<Vec<_>>());
    // Relaxed is enough: every cell is written by its one lower star, and read only after all threads have joined.
    let write = |cell: Cell, value: u32| {
        partners[cell.dimension as usize][cell.index as usize].store(value, Ordering::Relaxed);
    };
    (0..vertices).into_par_iter().with_min_len(256).for_each_init(LowerStar::default, |star, vertex| {
        let vertex = VertexId::from(vertex);
        if complex.neighbours(vertex).is_empty() {
            write(Cell::vertex(vertex), OUTSIDE);
            return;
        }
        star.collect(complex, order, vertex, triangles.at(vertex), tetrahedra.at(vertex));
        star.pair(vertex, |lower, upper| {
            write(lower, upper.index);
            write(upper, lower.index | DOWN);
        });
    });
    let partners = partners.map(|cells| cells.into_iter().map(AtomicU32::into_inner).collect());
    Ok(DiscreteGradient { dimension: complex.dimension(), partners })
}

impl DiscreteGradient {
    /// Dimension of the complex.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// What happens to a cell.
    pub fn pairing(&self, cell: Cell) -> Pairing {
        match self.partners[cell.dimension as usize][cell.index as usize] {
            CRITICAL => Pairing::Critical,
            OUTSIDE => Pairing::Outside,
            partner if partner & DOWN != 0 => {
                Pairing::Down(Cell { dimension: cell.dimension - 1, index: partner & !DOWN })
            }
            partner => Pairing::Up(Cell { dimension: cell.dimension + 1, index: partner }),
        }
    }

    /// Whether a cell is paired with nothing.
    pub fn is_critical(&self, cell: Cell) -> bool {
        self.partners[cell.dimension as usize][cell.index as usize] == CRITICAL
    }

    /// The critical cells of one dimension by rising number; none above the dimension of the complex.
    pub fn critical_cells(&self, dimension: usize) -> impl Iterator<Item = Cell> {
        let cells = self.partners.get(dimension).map_or(&[][..], Vec::as_slice);
        cells
            .iter()
            .enumerate()
            .filter(|&(_, &partner)| partner == CRITICAL)
            .map(move |(index, _)| Cell { dimension: dimension as u8, index: index as u32 })
    }

    /// Number of critical cells by dimension.
    pub fn critical_counts(&self) -> [usize; 4] {
        [0, 1, 2, 3].map(|dimension| self.critical_cells(dimension).count())
    }

    /// Number of cells by dimension; vertices of no simplex are not counted.
    pub fn cell_counts(&self) -> [usize; 4] {
        [0, 1, 2, 3].map(|dimension| self.partners[dimension].iter().filter(|&&partner| partner != OUTSIDE).count())
    }

    /// Checks that the critical cells alternate to the Euler characteristic, as in every discrete gradient.
    ///
    /// # Errors
    /// [`MorseError::Euler`].
    ///
    /// # Source
    /// Forman 1998, corollary 3.7 (Morse inequalities, the equality).
    pub fn check_euler(&self) -> Result<(), MorseError> {
        let counts = self.critical_counts();
        let (found, expected) = (alternating_sum(counts), alternating_sum(self.cell_counts()));
        if found == expected { Ok(()) } else { Err(MorseError::Euler { counts, found, expected }) }
    }

    /// The V-path from a vertex down the vertex–edge pairs, that vertex first, a critical vertex last.
    ///
    /// # Returns
    /// Only the vertex itself for one that is critical or in no simplex.
    ///
    /// # Cost
    /// Linear in the length of the path.
    pub fn descent(&self, complex: &SimplicialComplex, vertex: VertexId) -> Vec<VertexId> {
        let mut path = vec![vertex];
        let mut last = vertex;
        while let Some((_, next)) = self.step(complex, last) {
            path.push(next);
            last = next;
        }
        path
    }

    /// The edge with which a vertex is paired, and its other end.
    pub(super) fn step(&self, complex: &SimplicialComplex, vertex: VertexId) -> Option<(EdgeId, VertexId)> {
        let edge = self.partners[0][vertex.index()];
        if edge == CRITICAL || edge == OUTSIDE {
            return None;
        }
        let [a, b] = complex.edges()[edge as usize];
        Some((EdgeId(edge), if a == vertex { b } else { a }))
    }

    /// Cancels a critical edge and a critical vertex by reversing the one V-path between them.
    ///
    /// Afterwards both are paired, all other cells are critical or not as before, and there is still no closed
    /// V-path.
    ///
    /// # Errors
    /// [`MorseError::NotCritical`] if the edge is paired; [`MorseError::PathCount`] unless exactly one of its two
    /// V-paths ends at `extremum`.
    ///
    /// # Cost
    /// Linear in the lengths of the two V-paths.
    ///
    /// # Source
    /// Forman 1998, theorem 11.1.
    pub fn cancel(
        &mut self,
        complex: &SimplicialComplex,
        saddle: EdgeId,
        extremum: VertexId,
    ) -> Result<(), MorseError> {
        if !self.is_critical(Cell::edge(saddle)) {
            return Err(MorseError::NotCritical { edge: saddle });
        }
        let reaches: Vec<VertexId> = complex.edges()[saddle.0 as usize]
            .into_iter()
            .filter(|&end| self.descent_end(complex, end) == extremum)
            .collect();
        let &[end] = reaches.as_slice() else {
            return Err(MorseError::PathCount { saddle, extremum, found: reaches.len() });
        };
        let (mut vertex, mut edge) = (end, saddle);
        loop {
            let onward = self.step(complex, vertex);
            self.partners[0][vertex.index()] = edge.0;
            self.partners[1][edge.0 as usize] = vertex.0 | DOWN;
            match onward {
                Some((next_edge, next_vertex)) => (edge, vertex) = (next_edge, next_vertex),
                None => return Ok(()),
            }
        }
    }

    /// Pairs a cell with one of its cofacets.
    pub(super) fn pair(&mut self, lower: Cell, upper: Cell) {
        self.partners[lower.dimension as usize][lower.index as usize] = upper.index;
        self.partners[upper.dimension as usize][upper.index as usize] = lower.index | DOWN;
    }

    /// Makes a cell critical; whoever was paired with it must be given another partner.
    pub(super) fn release(&mut self, cell: Cell) {
        self.partners[cell.dimension as usize][cell.index as usize] = CRITICAL;
    }

    /// The critical vertex at the end of [`descent`](Self::descent).
    pub fn descent_end(&self, complex: &SimplicialComplex, vertex: VertexId) -> VertexId {
        let mut last = vertex;
        while let Some((_, next)) = self.step(complex, last) {
            last = next;
        }
        last
    }
}

fn alternating_sum(counts: [usize; 4]) -> i64 {
    let [vertices, edges, triangles, tetrahedra] = counts.map(|count| count as i64);
    vertices - edges + triangles - tetrahedra
}

fn cell_counts(complex: &SimplicialComplex) -> [usize; 4] {
    let tetrahedra = if complex.dimension() == 3 { complex.simplex_count() } else { 0 };
    [complex.vertex_count(), complex.edges().len(), complex.triangles().len(), tetrahedra]
}

/// The cells of one dimension, grouped by lower star.
struct Owned {
    offsets: Vec<u32>,
    cells: Vec<u32>,
}

impl Owned {
    fn new<I: Iterator<Item = u32>>(order: &VertexOrder, count: usize, corners: impl Fn(usize) -> I + Sync) -> Self {
        let ranks = order.ranks();
        let highest = |cell| corners(cell).max_by_key(|&corner| ranks[corner as usize]);
        let owners: Vec<u32> = (0..count).into_par_iter().filter_map(highest).collect();
        let mut offsets = vec![0u32; order.len() + 1];
        for &owner in &owners {
            offsets[owner as usize + 1] += 1;
        }
        for vertex in 0..order.len() {
            offsets[vertex + 1] += offsets[vertex];
        }
        let mut next = offsets.clone();
        let mut cells = vec![0u32; owners.len()];
        for (cell, &owner) in owners.iter().enumerate() {
            let slot = &mut next[owner as usize];
            cells[*slot as usize] = cell as u32;
            *slot += 1;
        }
        Self { offsets, cells }
    }

    fn at(&self, vertex: VertexId) -> &[u32] {
        &self.cells[self.offsets[vertex.index()] as usize..self.offsets[vertex.index() + 1] as usize]
    }
}
