//! The discrete gradient: every cell of a complex paired with a facet, with a cofacet, or critical.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::field::{VertexId, VertexOrder};
use crate::mesh::{Cell, EdgeId, Triangulation};

use super::error::MorseError;
use super::lattice_gradient::lattice_places;
use super::lower_star::LowerStar;
use super::mask_star::MaskStar;
use super::partners::{CRITICAL, DOWN, OUTSIDE, Partners};
use super::small_star::SmallStar;

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

const LIMIT: usize = (DOWN - 2) as usize;

/// A discrete gradient field of a vertex order (Forman 1998), on vertices, edges, triangles and tetrahedra.
///
/// Every pair lies in one lower star, so along every V-path the highest vertex of the cells never rises. This no
/// longer holds where [`cancel`](Self::cancel) has reversed a V-path; that there is no closed V-path still does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DiscreteGradient {
    dimension: usize,
    partners: Partners,
}

/// Pairs the cells of every lower star; the cells left over are critical.
///
/// On a 2-complex the critical cells of dimension 0, 1, 2 are minima, saddles and maxima, but for maxima on the
/// boundary: they are seen only by the gradient of the reversed order, as its critical vertices.
///
/// # Arguments
/// * `complex`: `n` vertices, dimension 1, 2 or 3, explicit or implicit. Vertices without neighbours are left out.
/// * `order`: total order of the `n` vertices; ties were broken by index.
///
/// # Errors
/// [`MorseError::OrderLength`] if `order` does not cover `n` vertices; [`MorseError::TooManyCells`] from 2^31 cells
/// of one dimension on, on an explicit complex.
///
/// # Cost
/// O(s log s) for a lower star of s cells; 4 bytes a cell kept, 8 more a triangle or tetrahedron while it runs. On an
/// implicit grid linear, and one byte a number of a cell: 26 bytes a vertex in dimension 3, 6 in dimension 2. Lower
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
pub fn discrete_gradient<T: Triangulation>(complex: &T, order: &VertexOrder) -> Result<DiscreteGradient, MorseError> {
    let vertices = complex.vertex_count();
    if order.len() != vertices {
        return Err(MorseError::OrderLength { expected: vertices, found: order.len() });
    }
    let partners = match complex.lattice() {
        Some(lattice) => Partners::Places(lattice, lattice_places(&lattice, order)),
        None => Partners::Numbers(partner_numbers(complex, order)?),
    };
    Ok(DiscreteGradient { dimension: complex.dimension(), partners })
}

fn partner_numbers<T: Triangulation>(complex: &T, order: &VertexOrder) -> Result<[Vec<u32>; 4], MorseError> {
    let counts = [0, 1, 2, 3].map(|dimension| complex.cell_bound(dimension));
    if let Some(dimension) = counts.iter().position(|&count| count > LIMIT) {
        return Err(MorseError::TooManyCells { dimension, found: counts[dimension], limit: LIMIT });
    }
    let triangles = Owned::new(complex, order, 2);
    let tetrahedra = Owned::new(complex, order, 3);
    let partners = counts.map(|count| (0..count).map(|_| AtomicU32::new(CRITICAL)).collect::<Vec<_>>());
    // Relaxed is enough: every cell is written by its one lower star, and read only after all threads have joined.
    let write = |cell: Cell, value: u32| {
        partners[cell.dimension as usize][cell.index as usize].store(value, Ordering::Relaxed);
    };
    let paired = |lower: Cell, upper: Cell| {
        write(lower, upper.index);
        write(upper, lower.index | DOWN);
    };
    let work_space = || (SmallStar::new(&paired), MaskStar::default(), LowerStar::default());
    (0..counts[0]).into_par_iter().with_min_len(256).for_each_init(work_space, |(small, masks, large), vertex| {
        let vertex = VertexId::from(vertex);
        if complex.neighbours(vertex).next().is_none() {
            write(Cell::vertex(vertex), OUTSIDE);
            return;
        }
        let owned = [triangles.at(vertex), tetrahedra.at(vertex)];
        match small.turn_to(complex, order, vertex, owned) {
            Some(0) => {}
            Some(count) => masks.pair(count, small),
            None => {
                large.collect(complex, order, vertex, owned);
                large.pair(vertex, paired);
            }
        }
    });
    Ok(partners.map(|cells| cells.into_iter().map(AtomicU32::into_inner).collect()))
}

impl DiscreteGradient {
    /// Dimension of the complex.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// What happens to a cell.
    pub fn pairing(&self, cell: Cell) -> Pairing {
        self.partners.pairing(cell)
    }

    /// Whether a cell is paired with nothing.
    pub fn is_critical(&self, cell: Cell) -> bool {
        self.partners.is_critical(cell)
    }

    /// The critical cells of one dimension by rising number; none above the dimension of the complex.
    pub fn critical_cells(&self, dimension: usize) -> impl Iterator<Item = Cell> {
        self.partners.critical(dimension)
    }

    /// Number of critical cells by dimension.
    pub fn critical_counts(&self) -> [usize; 4] {
        [0, 1, 2, 3].map(|dimension| self.critical_cells(dimension).count())
    }

    /// Number of cells by dimension; vertices of no simplex are not counted.
    pub fn cell_counts(&self) -> [usize; 4] {
        [0, 1, 2, 3].map(|dimension| self.partners.cell_count(dimension))
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
    pub fn descent<T: Triangulation>(&self, complex: &T, vertex: VertexId) -> Vec<VertexId> {
        let mut path = vec![vertex];
        let mut last = vertex;
        while let Some((_, next)) = self.step(complex, last) {
            path.push(next);
            last = next;
        }
        path
    }

    /// The edge with which a vertex is paired, and its other end.
    pub(super) fn step<T: Triangulation>(&self, complex: &T, vertex: VertexId) -> Option<(EdgeId, VertexId)> {
        let Pairing::Up(edge) = self.partners.pairing(Cell::vertex(vertex)) else {
            return None;
        };
        let ends = complex.cell_vertices(edge);
        Some((EdgeId(edge.index), if ends[0] == vertex { ends[1] } else { ends[0] }))
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
    pub fn cancel<T: Triangulation>(
        &mut self,
        complex: &T,
        saddle: EdgeId,
        extremum: VertexId,
    ) -> Result<(), MorseError> {
        if !self.is_critical(Cell::edge(saddle)) {
            return Err(MorseError::NotCritical { edge: saddle });
        }
        let reaches: Vec<VertexId> = complex
            .cell_vertices(Cell::edge(saddle))
            .into_iter()
            .filter(|&end| self.descent_end(complex, end) == extremum)
            .collect();
        let &[end] = reaches.as_slice() else {
            return Err(MorseError::PathCount { saddle, extremum, found: reaches.len() });
        };
        let (mut vertex, mut edge) = (end, saddle);
        loop {
            let onward = self.step(complex, vertex);
            self.pair(Cell::vertex(vertex), Cell::edge(edge));
            match onward {
                Some((next_edge, next_vertex)) => (edge, vertex) = (next_edge, next_vertex),
                None => return Ok(()),
            }
        }
    }

    /// Pairs a cell with one of its cofacets.
    pub(super) fn pair(&mut self, lower: Cell, upper: Cell) {
        self.partners.pair(lower, upper);
    }

    /// Makes a cell critical; whoever was paired with it must be given another partner.
    pub(super) fn release(&mut self, cell: Cell) {
        self.partners.release(cell);
    }

    /// The critical vertex at the end of [`descent`](Self::descent).
    pub fn descent_end<T: Triangulation>(&self, complex: &T, vertex: VertexId) -> VertexId {
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

/// The cells of one dimension, grouped by lower star.
struct Owned {
    offsets: Vec<u32>,
    cells: Vec<u32>,
}

impl Owned {
    fn new<T: Triangulation>(complex: &T, order: &VertexOrder, dimension: u8) -> Self {
        let count = complex.cell_bound(dimension.into()) as u32;
        let highest = |index: u32| Cell { dimension, index }.highest_vertex(complex, order).0;
        let owners: Vec<u32> = (0..count).into_par_iter().map(highest).collect();
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
